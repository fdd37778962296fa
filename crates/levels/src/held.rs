use interfaces::emove::Holding;
use rcs_core::{Plain, name::Name16};

/// Whether the object of the command is held (V.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Held {
    /// The gripper holds no object.
    Nothing,
    /// The gripper holds the object of the command.
    Right,
    /// The gripper holds another object.
    Other,
    /// The gripper holds an unidentified object.
    Something,
    /// The sensors do not show whether something is held; treated as held.
    NotKnown,
}

impl Held {
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
