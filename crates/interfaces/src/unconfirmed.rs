//! The part of a goal that no sensor confirms, reported with `done` and `finished` (docs/design/tables.md "Goals").

use core::fmt;

use rcs_core::Plain;

/// Part of a completed command's goal for which the machine has no sensor (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(doc)]
pub enum Unconfirmed {
    /// The sensors confirm the whole goal.
    #[text = ""]
    None,
    /// The grasp force (the gripper has no force sensor).
    GraspForce,
    /// The tool in the drum (the drum has no sensor).
    ToolInDrum,
    /// The robot's position (the resolvers give none).
    Position,
    /// The part's place in the fingers (the robot was moved with it by hand or without pressure).
    PartInFingers,
}

impl Unconfirmed {
    /// True if the sensors confirm the whole goal.
    #[must_use]
    pub const fn is_none(self) -> bool {
        matches!(self, Self::None)
    }

    /// The suffix of the report: `, unconfirmed: the tool in the drum (the drum has no sensor)`, or empty.
    #[must_use]
    pub const fn suffix(self) -> Suffix {
        Suffix(self)
    }
}

/// Text of [`Unconfirmed::suffix`].
#[derive(Clone, Copy, Debug)]
pub struct Suffix(Unconfirmed);

impl fmt::Display for Suffix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Unconfirmed::None => Ok(()),
            what => write!(f, ", unconfirmed: {what}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffix_names_the_unconfirmed_goals() {
        assert_eq!(format!("finished{}", Unconfirmed::None.suffix()), "finished");
        assert_eq!(
            format!("finished{}", Unconfirmed::GraspForce.suffix()),
            "finished, unconfirmed: the grasp force (the gripper has no force sensor)"
        );
    }
}
