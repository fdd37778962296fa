//! Errors of datagrams and targets: small, `Copy`, with the expected and the found value.

use core::fmt;

/// An error of a datagram or a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// The datagram ends within a field.
    Truncated,
    /// A variable-length integer has more than ten bytes.
    LongVarint,
    /// The field number is 0 or greater than 2^29 - 1.
    BadField {
        /// Field number found.
        number: u64,
    },
    /// A field has another wire type than in `egm.proto`, or an obsolete one.
    BadWireType {
        /// Field number.
        field: u32,
        /// Wire type found.
        found: u8,
    },
    /// A repeated field has too many values.
    TooMany {
        /// Greatest number of values.
        most: usize,
    },
    /// A field is missing that the schema or the pose mode requires.
    Missing {
        /// Name of the field, with its path.
        field: &'static str,
    },
    /// The message is of another type than expected.
    BadType {
        /// `mtype` expected.
        expected: u32,
        /// `mtype` found.
        found: u32,
    },
    /// A number is infinite or NaN, or the quaternion is not a rotation.
    NotAPose,
    /// The buffer is too small for the message.
    NoRoom,
    /// A point is farther from the previous one than the limits allow in a period.
    TooFast {
        /// Speed needed, mm/s.
        speed: f64,
        /// Angular speed needed, rad/s.
        turn: f64,
    },
    /// A point is outside the work space.
    Outside {
        /// Axis: 0, 1, 2 for x, y, z.
        axis: usize,
        /// Coordinate of the point, mm.
        found: f64,
    },
    /// The queue of points is full.
    Full,
    /// The robot does not follow, or no path has begun.
    NotReady,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Truncated => f.write_str("the message ends within a field"),
            Self::LongVarint => f.write_str("an integer has more than ten bytes"),
            Self::BadField { number } => write!(f, "field number {number}, expected 1 to 536870911"),
            Self::BadWireType { field, found } => write!(f, "field {field} has wire type {found}"),
            Self::TooMany { most } => write!(f, "more than {most} values in a repeated field"),
            Self::Missing { field } => write!(
                f,
                "the field {field} is missing; is the controller set up for EGM in pose mode, with egm.proto?"
            ),
            Self::BadType { expected, found } => write!(f, "message type {found}, expected {expected}"),
            Self::NotAPose => f.write_str("the pose has a number that is not finite, or no rotation"),
            Self::NoRoom => f.write_str("the buffer is too small for the message"),
            Self::TooFast { speed, turn } => {
                write!(f, "the point would take {speed:.1} mm/s and {turn:.3} rad/s, beyond the limits")
            }
            Self::Outside { axis, found } => {
                let name = ["x", "y", "z"].get(axis).copied().unwrap_or("?");
                write!(f, "{name} = {found:.1} mm is outside of the work space")
            }
            Self::Full => f.write_str("no room for a further point"),
            Self::NotReady => f.write_str("the robot does not follow"),
        }
    }
}

impl core::error::Error for Error {}
