//! The messages of `egm.proto` (package `abb.egm`, proto2), one a file.
//!
//! Each message has three functions: `merge` takes one field (as in protocol buffers, a message that comes twice is
//! merged, and the last of repeated values counts), `check` finds missing fields at the end, and `write` encodes it.
//! Unknown fields of a newer schema are skipped. An unknown enum value counts as undefined.

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
