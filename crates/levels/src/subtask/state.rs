use geometry::pose::Pose;
use interfaces::subtask::Regrip;
use rcs_core::{Plain, handshake::Commander};
use taskdata::files::PedPara;

use super::{
    aims::Aims,
    tables::{Step, SubtaskRecipient},
};
use crate::execution::Execution;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub ordered: SubtaskRecipient,
    pub emove: Commander,
    pub pedestal: Commander,
    pub regrip: Option<Regrip>, // the part in the pedestal's hand
    /// Location pose of the last LOCATE-OBJ. All sectors of an array have the same records; only the pose
    /// distinguishes them. `None` after a restart.
    pub located_at: Option<Pose>,
    /// Location pose of the last motion to an object, or with one. `None` after a restart.
    pub gone_to: Option<Pose>,
    pub aims: Aims, // the targets that Task does not name
    pub ped_para: PedPara,
    pub last_pose: u32, // record number given last to a pose of `aims`
}
