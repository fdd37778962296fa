//! Decision tables of E-move: a file a command, MOV-TO-VU with MOV-TO-OBJ.

pub mod acquire_tool;
pub mod grasp_obj;
pub mod insert_tool;
pub mod locate_obj;
pub mod mov_obj_to;
pub mod mov_to_hol;
pub mod mov_to_loc;
pub mod mov_to_obj;
pub mod pause;
pub mod qc_attach;
pub mod qc_detach;
pub mod release;
pub mod release_tool;
pub mod remove_tool;
mod variables;
pub mod withdraw;

use rcs_core::interface::{Reason, emove::EmoveVerb};

pub use self::variables::{
    Fingers, Held, Holster, Link, Load, Mate, Motion, Opening, Readiness, Ring, Sight, Situation, Spread,
    Station, Tooling, Travel, Tries, Whereabouts,
};
use super::{relative::Relative, route::Ahead};

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// ROBOT-INIT to Prim.
    RobotInit,
    /// PAUSE to Prim and the gripper, QC-PAUSE to Quick Change.
    Pause,
    /// Report joystick-on: the operator has the robot.
    Manual,
    /// Open the fingers for the operator.
    OpenByHand,
    /// Close the fingers for the operator.
    CloseByHand,
    /// GO-THRU to Prim with the next point.
    GoThru,
    /// GOTO-PT to Prim with the goal.
    GotoPt,
    /// DELTA-MOVE to Prim.
    DeltaMove(Relative),
    /// GO-UNTIL to Prim, with the sensor that task data name.
    GoUntil(Relative),
    /// GO-WHILE to Prim, with the sensor that task data name.
    GoWhile(Relative),
    /// CAL-SENSOR to Prim.
    CalSensor,
    /// QC-LOCK to Quick Change.
    Lock,
    /// QC-UNLOCK to Quick Change.
    Unlock,
    /// Bring the fingers to the opening for the goal.
    Open,
    /// Bring the fingers to the approach size of the object.
    OpenToApproach,
    /// Bring the fingers to the opening with which the gripper goes through its holster.
    CloseForHolster,
    /// Close on the object.
    Close,
    /// Open to the depart size.
    OpenToDepart,
    /// UP-INIT to the gripper.
    Calibrate,
    /// Report done: the robot is at the goal.
    Arrive,
    /// Report done: the robot is at the location of the command, at rest where it was told to stand.
    Stand,
    /// Report done: the fingers are around a tool in the drum.
    StandInDrum,
    /// Report done: the object is held.
    Grasped,
    /// Report done: the tool in the drum is held.
    Acquired,
    /// Ask vision for the first picture.
    Flood,
    /// Ask for it again with other parameters.
    FloodAgain,
    /// GOTO-PT to Prim: camera over the centroid.
    Centre,
    /// Ask vision for the second picture.
    Precise,
    /// Ask for it again with other parameters.
    PreciseAgain,
    /// GOTO-PT to Prim: camera over the part, turned with it.
    Align,
    /// Report done: the object is located.
    Located,
    /// Report done.
    Finish,
    /// Stop the robot and report an error.
    Fail(Reason),
    /// Stop the robot and report how the object was lost: from the fingers, or with the gripper.
    FailLost,
    /// Stop the robot and report what the gripper reports.
    FailGrip,
    /// Stop the robot and report what Quick Change reports.
    FailRing,
    /// Report what Prim reports.
    PassUp,
}

/// What the table of the current command decided.
pub type Choice = crate::old_execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: EmoveVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        EmoveVerb::None | EmoveVerb::Pause => pause::consult(step, s),
        EmoveVerb::MovToLoc => mov_to_loc::consult(step, s),
        EmoveVerb::MovToObj | EmoveVerb::MovToVu => mov_to_obj::consult(step, s),
        EmoveVerb::MovObjTo => mov_obj_to::consult(step, s),
        EmoveVerb::MovToHol => mov_to_hol::consult(step, s),
        EmoveVerb::LocateObj => locate_obj::consult(step, s),
        EmoveVerb::GraspObj => grasp_obj::consult(step, s),
        EmoveVerb::Release => release::consult(step, s),
        EmoveVerb::QcDetach => qc_detach::consult(step, s),
        EmoveVerb::QcAttach => qc_attach::consult(step, s),
        EmoveVerb::Withdraw => withdraw::consult(step, s),
        EmoveVerb::InsertTool => insert_tool::consult(step, s),
        EmoveVerb::ReleaseTool => release_tool::consult(step, s),
        EmoveVerb::AcquireTool => acquire_tool::consult(step, s),
        EmoveVerb::RemoveTool => remove_tool::consult(step, s),
    }
}
