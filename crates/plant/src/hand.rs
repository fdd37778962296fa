//! The four pairs of fingers of the cell: the robot's grippers, and the hand of the Active Pedestal.

use interfaces::device::DeviceOutputs;
use serde::{Deserialize, Serialize};

use crate::{
    description::{CellDescription, Gripper},
    jaws::Supply,
};

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub(crate) enum Hand {
    Parts, // end effector 1
    V,     // end effector 2
    Tool,  // end effector 3
    Pedestal,
}

/// The grippers of the robot, in the order of their end effector ids.
pub(crate) const ROBOT_HANDS: [Hand; 3] = [Hand::Parts, Hand::V, Hand::Tool];

pub(crate) const HANDS: [Hand; 4] = [Hand::Parts, Hand::V, Hand::Tool, Hand::Pedestal];

impl Hand {
    pub(crate) fn others(self) -> impl Iterator<Item = Self> {
        HANDS.into_iter().filter(move |hand| *hand != self)
    }

    /// Index among the robot's grippers, from 0; `None` for the pedestal's hand.
    pub(crate) const fn slot(self) -> Option<usize> {
        match self {
            Self::Parts => Some(0),
            Self::V => Some(1),
            Self::Tool => Some(2),
            Self::Pedestal => None,
        }
    }

    /// `endeff-id#`, if it is a gripper of the robot.
    pub(crate) const fn end_effector_id(self) -> Option<u8> {
        match self {
            Self::Parts => Some(1),
            Self::V => Some(2),
            Self::Tool => Some(3),
            Self::Pedestal => None,
        }
    }

    pub(crate) const fn link(self) -> &'static str {
        match self {
            Self::Parts => "parts_gripper",
            Self::V => "v_gripper",
            Self::Tool => "tool_gripper",
            Self::Pedestal => "pedestal_hand",
        }
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Parts => "the fingers",
            Self::V => "the v-gripper",
            Self::Tool => "the tool gripper",
            Self::Pedestal => "the pedestal's hand",
        }
    }

    pub(crate) const fn description(self, cell: &CellDescription) -> &Gripper {
        match self {
            Self::Parts => &cell.gripper.parts,
            Self::V => &cell.gripper.v,
            Self::Tool => &cell.gripper.tool,
            Self::Pedestal => &cell.pedestal.hand,
        }
    }

    pub(crate) fn supply(self, cell: &CellDescription, outputs: &DeviceOutputs) -> Supply {
        let speed = cell.gripper.jaw_speed;
        match self {
            Self::Parts => Supply::of_bits(outputs.grip.bits),
            Self::V => Supply::of_jaws(&outputs.v_grip, speed),
            Self::Tool => Supply::of_jaws(&outputs.tool_grip, speed),
            Self::Pedestal => Supply::of_bits(outputs.pedestal_hand.bits),
        }
    }
}
