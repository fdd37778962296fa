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
    /// The command of Task and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The recipient of the last order.
    pub ordered: SubtaskRecipient,
    /// Commands to E-move.
    pub emove: Commander,
    /// Commands to the Active Pedestal.
    pub pedestal: Commander,
    /// The part in the pedestal's hand.
    pub regrip: Option<Regrip>,
    /// Location pose of the last LOCATE-OBJ. All sectors of an array have the same records; only the pose
    /// distinguishes them. `None` after a restart.
    pub located_at: Option<Pose>,
    /// Location pose of the last motion to an object, or with one; `None` after a restart.
    pub gone_to: Option<Pose>,
    /// The targets of the current command that Task does not name.
    pub aims: Aims,
    /// The pedestal data of the object of the current FIX-GRIP.
    pub ped_para: PedPara,
    /// Last record number given to a pose of [`Aims`].
    pub last_pose: u32,
}
