//! The moving bodies of the cell except parts, with the names of their links and joints.

use geometry::kinematics::JOINT_NAMES;

use super::ROOT;
use crate::hand::{HANDS, Hand};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moving {
    /// A link of the arm by its joint, 0 for the turret.
    Arm(usize),
    QuickChange,
    Hand(Hand),
    Finger(Hand, Finger),
    Vise,
    Jaw,
}

/// A finger, by the side of the hand that it is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Finger {
    Left,
    Right,
}

impl Finger {
    /// Its side along the Y of the hand.
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

const ARM: [&str; 6] = ["turret", "upper_arm", "forearm", "wrist_pitch", "wrist_yaw", "end_plate"];

impl Moving {
    /// All moving bodies, each after its parent.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let hand =
            |hand| [Self::Hand(hand), Self::Finger(hand, Finger::Left), Self::Finger(hand, Finger::Right)];
        let arm = (0..ARM.len()).map(Self::Arm);
        arm.chain([Self::QuickChange]).chain(HANDS.into_iter().flat_map(hand)).chain([Self::Vise, Self::Jaw])
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Arm(joint) => ARM[joint],
            Self::QuickChange => "quick_change",
            Self::Hand(hand) => hand.link(),
            Self::Finger(hand, finger) => finger_names(hand, finger)[0],
            Self::Vise => "vise",
            Self::Jaw => "movable_jaw",
        }
    }

    /// Name of the link in whose frame its pose is given.
    pub(crate) const fn parent(self) -> &'static str {
        match self {
            Self::Arm(0) | Self::Hand(_) | Self::Vise => ROOT,
            Self::Arm(joint) => ARM[joint - 1],
            Self::QuickChange => ARM[ARM.len() - 1],
            Self::Finger(hand, _) => hand.link(),
            Self::Jaw => Self::Vise.name(),
        }
    }

    /// Name of its revolute or prismatic joint; `None` if it is fixed or moves freely.
    pub(crate) const fn joint(self) -> Option<&'static str> {
        match self {
            Self::Arm(joint) => Some(JOINT_NAMES[joint]),
            Self::Hand(Hand::Pedestal) => Some("pedestal_table_turn"),
            Self::Finger(hand, finger) => Some(finger_names(hand, finger)[1]),
            Self::Jaw => Some("jaw_slide"),
            Self::QuickChange | Self::Hand(_) | Self::Vise => None,
        }
    }
}

/// Names of the link and the joint of a finger.
const fn finger_names(hand: Hand, finger: Finger) -> [&'static str; 2] {
    match (hand, finger) {
        (Hand::Parts, Finger::Left) => ["left_finger", "left_finger_slide"],
        (Hand::Parts, Finger::Right) => ["right_finger", "right_finger_slide"],
        (Hand::V, Finger::Left) => ["v_left_finger", "v_left_finger_slide"],
        (Hand::V, Finger::Right) => ["v_right_finger", "v_right_finger_slide"],
        (Hand::Tool, Finger::Left) => ["tool_left_finger", "tool_left_finger_slide"],
        (Hand::Tool, Finger::Right) => ["tool_right_finger", "tool_right_finger_slide"],
        (Hand::Pedestal, Finger::Left) => ["pedestal_left_finger", "pedestal_left_finger_slide"],
        (Hand::Pedestal, Finger::Right) => ["pedestal_right_finger", "pedestal_right_finger_slide"],
    }
}
