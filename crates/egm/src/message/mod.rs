//! The messages of `egm.proto` (package `abb.egm`, proto2), one per file.
//!
//! `merge` takes one field: a message that occurs twice is merged, and the last value of a repeated scalar field is
//! used. `check` finds missing fields at the end. `write` encodes the message. Unknown fields are skipped, and an
//! unknown enum value is undefined.

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

/// Length of the longest message, bytes.
pub const MOST_BYTES: usize = 1400;
