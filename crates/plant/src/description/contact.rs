//! The entries `[[contact]]` of a cell description: permitted contacts. An entry names movers and obstacles by names,
//! by the groups of their kinds, or by patterns with one `*`. Any other contact is a collision.

use std::fmt;

use interfaces::{emove::EmoveVerb, subtask::SubtaskVerb};
use serde::{Deserialize, Serialize};

use super::CellDescription;

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum Kind {
    /// A link of the arm: `turret`, `upper_arm`, `forearm`, `wrist`.
    Arm,
    /// A body on the arm that is not a finger: `quick_change`, `camera`, `gripper_body`.
    Gripper,
    /// A finger of the gripper on the robot: `left_finger`, `right_finger`.
    Finger,
    HeldPart,
    Fixture,
    /// Floor or wall of a tray: `UNIT_1_floor`, `UNIT_1_near_wall` and so on.
    Tray,
    /// A body of the vise: `vise_body`, `fixed_jaw`, `movable_jaw`.
    Vise,
    Holster,
    /// A gripper that is not on the robot: `parts_gripper`, `v_gripper`, `tool_gripper`.
    StoredGripper,
    Drum,
    /// The hand of the pedestal without its fingers: `pedestal_hand`.
    PedestalHand,
    /// A finger of the pedestal's hand: `pedestal_left_finger`, `pedestal_right_finger`.
    PedestalFinger,
    Part,
}

impl Kind {
    pub const ALL: [Self; 13] = [
        Self::Arm,
        Self::Gripper,
        Self::Finger,
        Self::HeldPart,
        Self::Fixture,
        Self::Tray,
        Self::Vise,
        Self::Holster,
        Self::StoredGripper,
        Self::Drum,
        Self::PedestalHand,
        Self::PedestalFinger,
        Self::Part,
    ];

    #[must_use]
    pub const fn groups(self) -> &'static [&'static str] {
        match self {
            Self::Arm => &["arm", "robot"],
            Self::Gripper => &["gripper", "robot"],
            Self::Finger => &["fingers", "robot"],
            Self::HeldPart => &["held_part"],
            Self::Fixture => &["fixtures"],
            Self::Tray => &["trays"],
            Self::Vise => &["vise"],
            Self::Holster => &["holsters"],
            Self::StoredGripper => &["stored_grippers"],
            Self::Drum => &["strike_plates"],
            Self::PedestalHand => &["pedestal"],
            Self::PedestalFinger => &["pedestal", "pedestal_fingers"],
            Self::Part => &["parts"],
        }
    }

    #[must_use]
    pub const fn is_mover(self) -> bool {
        matches!(self, Self::Arm | Self::Gripper | Self::Finger | Self::HeldPart)
    }

    #[must_use]
    pub const fn is_obstacle(self) -> bool {
        !matches!(self, Self::Gripper | Self::Finger | Self::HeldPart)
    }

    /// True if it is rigid metal, and not a part.
    #[must_use]
    pub const fn is_robot(self) -> bool {
        matches!(self, Self::Arm | Self::Gripper | Self::Finger)
    }
}

/// A name, a group, or either with one `*` for any characters.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Pattern(pub String);

impl Pattern {
    #[must_use]
    pub fn matches(&self, name: &str, kind: Kind) -> bool {
        self.means_kind(kind) || self.means_name(name)
    }

    #[must_use]
    pub fn means_kind(&self, kind: Kind) -> bool {
        self.0 == "*" || kind.groups().contains(&self.0.as_str())
    }

    fn means_name(&self, name: &str) -> bool {
        match self.0.split_once('*') {
            None => self.0 == name,
            Some((head, tail)) => {
                let least = head.len() + tail.len();
                name.len() >= least && name.starts_with(head) && name.ends_with(tail)
            }
        }
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Permit {
    pub mover: Vec<Pattern>,
    pub obstacle: Vec<Pattern>,
    /// Commands of E-move or Subtask during which the contact is permitted. If the list is empty, it is always
    /// permitted.
    #[serde(default)]
    pub during: Vec<String>,
    /// Greatest depth, in; without it any depth.
    pub depth: Option<f64>,
    pub why: String,
}

impl Permit {
    /// The permitted depth of two bodies at any time, in; 0 if none.
    fn always(&self, mover: (&str, Kind), obstacle: (&str, Kind)) -> f64 {
        if self.during.is_empty() && self.covers(mover, obstacle) { self.limit() } else { 0.0 }
    }

    fn limit(&self) -> f64 {
        self.depth.unwrap_or(f64::INFINITY)
    }

    fn covers(&self, mover: (&str, Kind), obstacle: (&str, Kind)) -> bool {
        self.mover.iter().any(|pattern| pattern.matches(mover.0, mover.1))
            && self.obstacle.iter().any(|pattern| pattern.matches(obstacle.0, obstacle.1))
    }
}

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Permits(pub Vec<Permit>);

impl Permits {
    /// Permitted depth of a mover in an obstacle during every command, in; 0 if none.
    #[must_use]
    pub fn always(&self, mover: (&str, Kind), obstacle: (&str, Kind)) -> f64 {
        self.0.iter().map(|permit| permit.always(mover, obstacle)).fold(0.0, f64::max)
    }

    /// Permitted depth of a mover in an obstacle while E-move and Subtask execute these commands, in; 0 if none.
    #[must_use]
    pub fn during(&self, mover: (&str, Kind), obstacle: (&str, Kind), commands: [&str; 2]) -> f64 {
        let now = self.0.iter().filter(|permit| {
            permit.during.is_empty() || permit.during.iter().any(|verb| commands.contains(&verb.as_str()))
        });
        now.filter(|permit| permit.covers(mover, obstacle)).map(Permit::limit).fold(0.0, f64::max)
    }

    /// Greatest permitted depth of a mover in an obstacle over all commands, in; 0 if none.
    #[must_use]
    pub fn at_most(&self, mover: (&str, Kind), obstacle: (&str, Kind)) -> f64 {
        let covering = self.0.iter().filter(|permit| permit.covers(mover, obstacle));
        covering.map(Permit::limit).fold(0.0, f64::max)
    }

    /// True if every body of one kind may always touch every body of another to any depth, so that no check is needed.
    #[must_use]
    pub fn ignores(&self, mover: Kind, obstacle: Kind) -> bool {
        self.0.iter().any(|permit| {
            permit.during.is_empty()
                && permit.depth.is_none()
                && permit.mover.iter().any(|pattern| pattern.means_kind(mover))
                && permit.obstacle.iter().any(|pattern| pattern.means_kind(obstacle))
        })
    }
}

/// The names of the commands that an entry can list: those of E-move and of Subtask.
pub fn commands() -> impl Iterator<Item = &'static str> {
    let emove = EmoveVerb::ALL.iter().map(|verb| verb.text());
    let subtask = SubtaskVerb::ALL.iter().map(|verb| verb.text());
    emove.chain(subtask).filter(|text| !text.is_empty())
}

/// Names and kinds of all bodies that can collide in a cell.
#[must_use]
pub fn known(cell: &CellDescription) -> Vec<(String, Kind)> {
    let own = [
        ("turret", Kind::Arm),
        ("upper_arm", Kind::Arm),
        ("forearm", Kind::Arm),
        ("wrist", Kind::Arm),
        ("quick_change", Kind::Gripper),
        ("camera", Kind::Gripper),
        ("gripper_body", Kind::Gripper),
        ("left_finger", Kind::Finger),
        ("right_finger", Kind::Finger),
        ("movable_jaw", Kind::Vise),
        ("parts_gripper", Kind::StoredGripper),
        ("v_gripper", Kind::StoredGripper),
        ("tool_gripper", Kind::StoredGripper),
        ("pedestal_hand", Kind::PedestalHand),
        ("pedestal_left_finger", Kind::PedestalFinger),
        ("pedestal_right_finger", Kind::PedestalFinger),
    ];
    let parts =
        cell.part.iter().flat_map(|part| [Kind::HeldPart, Kind::Part].map(|kind| (part.name.clone(), kind)));
    let standing = crate::scene::furniture(cell).into_iter().map(|block| (block.name, block.kind));
    own.into_iter().map(|(name, kind)| (name.to_owned(), kind)).chain(parts).chain(standing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(text: &str) -> Pattern {
        Pattern(text.into())
    }

    #[test]
    fn pattern_is_a_name_a_group_or_has_one_star() {
        let (name, kind) = ("UNIT_1_floor", Kind::Tray);
        for good in ["UNIT_1_floor", "trays", "*", "UNIT_1*", "*_floor", "UNIT_*_floor", "UNIT_1_floor*"] {
            assert!(pattern(good).matches(name, kind), "{good}");
        }
        for other in ["UNIT_1", "fixtures", "UNIT_2*", "*_wall", "UNIT_1_f*_floor", ""] {
            assert!(!pattern(other).matches(name, kind), "{other}");
        }
    }

    fn permits() -> Permits {
        let permit = |mover: &str, obstacle: &str, during: &[&str], depth| Permit {
            mover: vec![pattern(mover)],
            obstacle: vec![pattern(obstacle)],
            during: during.iter().map(|verb| (*verb).to_owned()).collect(),
            depth,
            why: "a test".into(),
        };
        Permits(vec![
            permit("fingers", "held_part", &[], None),
            permit("held_part", "trays", &[], Some(0.02)),
            permit("fingers", "parts", &["GRASP-OBJ"], Some(0.1)),
            permit("left_finger", "parts", &["FIX-GRIP"], Some(0.3)),
        ])
    }

    #[test]
    fn most_permissive_entry_applies_during_its_command() {
        let permits = permits();
        let finger = ("left_finger", Kind::Finger);
        let part = ("BAR", Kind::Part);
        assert_eq!(permits.always(finger, part), 0.0);
        assert_eq!(permits.during(finger, part, ["MOV-TO-LOC", "GOTO-DEST"]), 0.0);
        assert_eq!(permits.during(finger, part, ["GRASP-OBJ", "GET-OBJECT"]), 0.1);
        assert_eq!(permits.during(finger, part, ["GRASP-OBJ", "FIX-GRIP"]), 0.3, "a command of either");
        assert_eq!(permits.during(("right_finger", Kind::Finger), part, ["GRASP-OBJ", "FIX-GRIP"]), 0.1);
        assert_eq!(permits.always(("BAR", Kind::HeldPart), ("UNIT_1_floor", Kind::Tray)), 0.02);
        assert_eq!((permits.at_most(finger, part), permits.at_most(("wrist", Kind::Arm), part)), (0.3, 0.0));
        assert!(permits.ignores(Kind::Finger, Kind::HeldPart));
        assert!(!permits.ignores(Kind::HeldPart, Kind::Tray), "it has a depth");
        assert!(!permits.ignores(Kind::Finger, Kind::Part), "it has commands");
    }

    #[test]
    fn every_group_can_be_a_mover_or_an_obstacle() {
        assert!(Kind::ALL.iter().all(|kind| kind.is_mover() || kind.is_obstacle()));
        assert!(Kind::ALL.iter().all(|kind| !kind.groups().is_empty()));
    }
}
