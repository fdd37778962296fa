//! The messages of `egm.proto` (package `abb.egm`, proto2), one a file.
//!
//! Each message knows three things: how its fields are taken over one by one (`merge`: as protocol buffers
//! have it, a message that comes twice is merged, and of a value that comes twice the last counts), what is
//! missing when all have come (`check`), and how it is written (`write`). Fields that a newer schema adds are
//! skipped. An enum value that the schema does not know counts as undefined.

mod geometry;
mod header;
mod motion;
mod robot;
mod sensor;
mod values;

pub use self::{
    geometry::{Cartesian, Euler, Orientation, WirePose},
    header::{Header, MessageType},
    motion::{Clock, Motion, Timestamp},
    robot::{MciState, MotorState, RapidState, Robot},
    sensor::{Sensor, SpeedRef},
    values::{MOST_VALUES, Values},
};

/// Bytes that the longest of the messages needs.
pub const MOST_BYTES: usize = 1400;
