//! What the attached gripper holds, as the tables of Task, Subtask and E-move ask for it.

use interfaces::emove::Holding;
use rcs_core::{Plain, name::Name16};

/// Is the object of the command held (V.3.1)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Held {
    /// The gripper holds nothing.
    Nothing,
    /// It holds the object of the command.
    Right,
    /// It holds another object.
    Other,
    /// It holds something, and nothing says what it is.
    Something,
    /// Its sensors do not tell: counts as held.
    NotKnown,
}

impl Held {
    /// What is held, seen from a command about `object`.
    #[must_use]
    pub fn of(holding: Holding, object: Option<Name16>) -> Self {
        match holding {
            Holding::Nothing => Self::Nothing,
            Holding::Object(held) if Some(held.object) == object => Self::Right,
            Holding::Object(_) => Self::Other,
            Holding::Something => Self::Something,
            Holding::NotKnown => Self::NotKnown,
        }
    }
}
