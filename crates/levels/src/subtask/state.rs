//! The state of Subtask.

use geometry::pose::Pose;
use interfaces::subtask::Regrip;
use rcs_core::{Plain, handshake::Commander};
use taskdata::files::PedPara;

use super::{
    aims::Aims,
    tables::{Step, SubtaskRecipient},
};
use crate::execution::Execution;

/// State of Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of Task and how far it has come.
    pub execution: Execution,
    pub step: Step,
    /// The process that has its last order.
    pub ordered: SubtaskRecipient,
    pub emove: Commander,
    pub pedestal: Commander,
    /// The part in the pedestal's hand.
    pub regrip: Option<Regrip>,
    /// Location pose for which LOCATE-OBJ was sent last. All sectors of an array have the same records: only the pose
    /// tells them apart. `None` after a restart.
    pub located_at: Option<Pose>,
    /// Location pose for which the robot was sent to an object, or with one, last; `None` after a restart.
    pub gone_to: Option<Pose>,
    /// What the current command names beside the location and the object that Task gave.
    pub aims: Aims,
    /// How the pedestal takes the object of the current FIX-GRIP.
    pub ped_para: PedPara,
    /// Last record number given to a pose of [`Aims`].
    pub last_pose: u32,
}
