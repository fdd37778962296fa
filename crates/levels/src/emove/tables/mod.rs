//! Decision tables of E-move: preconditions of a new command, rows common to all commands, and one file per command.
//! The motion commands share MOTION; each command has a table of its own, which is consulted before MOTION.

pub mod accept;
pub mod acquire_tool;
pub mod attend;
pub mod carried;
pub mod drum;
pub mod e_pause;
pub mod exchange;
pub mod fingers;
pub mod grasp_obj;
pub mod insert_tool;
pub mod locate_obj;
pub mod motion;
pub mod mov_obj_to;
pub mod mov_to_hol;
pub mod mov_to_obj;
pub mod mov_to_vu;
pub mod ordered;
pub mod qc_attach;
pub mod qc_detach;
pub mod records;
pub mod release;
pub mod release_tool;
pub mod remove_tool;
pub mod resume;
pub mod returning;
pub mod search;
pub mod slide;
pub mod track;
mod variables;
pub mod withdraw;

use interfaces::{
    Reason,
    emove::{CalibratedAt, EmoveVerb},
};
use rcs_core::{
    Actions, Variables, commands,
    handshake::{Arrival, Lower},
};

pub(super) use self::variables::known;
pub use self::{
    accept::{Attached, CommandClass, Coupling, EmoveTarget, ExchangeWork, Request, ToolWork},
    drum::{AtDrum, Bias},
    records::{EmoveRecord, HolsterData, Records},
    variables::{
        At, Departure, EmoveCalibration, EmoveContact, EmoveHolster, EmoveLink, EmoveLoad, EmoveOpening,
        EmoveReach, EmoveRecipient, ExchangePosition, FingerMotion, Fingers, Initialization, Knowledge, Lock,
        Mate, Pause, PlaceKnowledge, Readiness, ReleaseWork, Ring, Shut, Sight, Spread, Tooling, Tries,
        VisionAnswer,
    },
};
use super::{
    goals,
    motion::relative::Relative,
    senses::{__Senses, Senses},
};
pub use crate::held::Held;
use crate::{
    confirm::{CONFIRM, Proof},
    execution::{Asked, EXECUTE, Ending, Outcome},
    halt::{Advance, Commanding, EFFECT, HALT, Replaced, Stopping},
};

/// State variables independent of the command, for [`attend::ATTEND`] and [`search::SEARCH`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Watch {
    /// Progress of `.R`.
    pub initialization: Initialization,
    /// Progress of E-PAUSE, if it is the command.
    pub pause: Pause,
    /// Progress of the command.
    pub outcome: Outcome,
    /// Knowledge of the robot's place.
    pub place: PlaceKnowledge,
    /// Knowledge of the robot's frame, by the resolvers.
    pub resolvers: Knowledge,
}

/// The held object and the status of the last order, for [`carried::CARRIED`] and [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// The command.
    pub verb: EmoveVerb,
    /// The held object, compared with that at the start of the command.
    pub load: EmoveLoad,
    /// The process that has the last order.
    pub ordered: EmoveRecipient,
    /// Status of Prim; done if the command does not need it.
    pub prim: Lower,
    /// The condition of a guarded move.
    pub contact: EmoveContact,
    /// The opening of the fingers for the goal.
    pub opening: EmoveOpening,
    /// Status of the attached gripper.
    pub gripper: Lower,
    /// The locking ring, by the answer of Quick Change.
    pub ring: Ring,
    /// The answer of vision.
    pub vision: VisionAnswer,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// Contents of the command buffer.
    pub arrival: Arrival,
    pub verb: EmoveVerb,
    /// The decision on a new command is due.
    pub asked: Asked,
    /// The activities that the command replaces.
    pub replaced: Replaced,
    /// For EFFECT: whether the command has sent another point since its last order.
    pub advance: Advance,
    /// A new command and the state of the robot.
    pub request: Request,
    /// The records of the command in the task data.
    pub records: Records,
    /// State variables independent of the command.
    pub watch: Watch,
    /// Status of the last order.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the sensors.
    pub proof: Proof,
    /// State variables of the command's tables; ORDERED sets `work`.
    pub situation: Situation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// No new order.
    Wait,
    /// ROBOT-INIT to Prim.
    RobotInit,
    /// PAUSE to Prim and the gripper, QC-PAUSE to Quick Change.
    Pause,
    /// PAUSE to Prim, QC-PAUSE to Quick Change; moving fingers finish their order.
    StopRobot,
    /// Report joystick-on: the operator controls the robot.
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
    /// CAL-SENSOR to Prim; the argument is the robot's place.
    CalSensor(CalibratedAt),
    /// QC-LOCK to Quick Change.
    Lock,
    /// QC-UNLOCK to Quick Change.
    Unlock,
    /// Bring the fingers to the opening for the goal.
    Open,
    /// Bring the fingers to the approach size of the object.
    OpenToApproach,
    /// Bring the fingers to the opening for the path through the holster.
    CloseForHolster,
    /// Close on the object.
    Close,
    /// Open to the depart size.
    OpenToDepart,
    /// Open as far as the gripper can.
    OpenFully,
    /// UP-INIT to the gripper.
    Calibrate,
    /// Report done: the robot is at the goal.
    Arrive,
    /// Report done: the robot is at rest at the end of the command's relative moves.
    Stand,
    /// Report an error: the bare robot is clear of the holster, and may move elsewhere.
    Leave(Reason),
    /// Report done: the fingers are around a tool in the drum.
    StandInDrum,
    /// Report done: the object is held.
    Grasped,
    /// Report done: the tool in the drum is held.
    Acquired,
    /// Request the first picture.
    Flood,
    /// Request the first picture again with other parameters.
    FloodAgain,
    /// GOTO-PT to Prim: camera over the centroid.
    Centre,
    /// Request the second picture.
    Precise,
    /// Request the second picture again with other parameters.
    PreciseAgain,
    /// GOTO-PT to Prim: camera over the part, turned with it.
    Align,
    /// Report done: the object is located.
    Located,
    /// Report done.
    Finish,
    /// Report an error before any order.
    Refuse(Reason),
    /// Stop the robot and report an error.
    Fail(Reason),
    /// Stop the robot and report the error of the gripper.
    FailGrip,
    /// Stop the robot and report the error of Quick Change.
    FailRing,
    /// Report the error of Prim.
    PassUp,
}

impl Ending for Action {
    const WAIT: Self = Self::Wait;

    fn fail(reason: Reason) -> Self {
        Self::Fail(reason)
    }

    fn ends(&self) -> bool {
        matches!(
            self,
            Self::Arrive
                | Self::Stand
                | Self::StandInDrum
                | Self::Grasped
                | Self::Acquired
                | Self::Located
                | Self::Finish
        )
    }
}

impl Stopping for Action {
    const STOP: Self = Self::StopRobot;
}

impl Commanding for Action {
    fn is_order(&self) -> bool {
        matches!(
            self,
            Self::GoThru
                | Self::GotoPt
                | Self::DeltaMove(_)
                | Self::GoUntil(_)
                | Self::GoWhile(_)
                | Self::CalSensor(_)
                | Self::Lock
                | Self::Unlock
                | Self::Open
                | Self::OpenToApproach
                | Self::CloseForHolster
                | Self::Close
                | Self::OpenToDepart
                | Self::OpenFully
                | Self::Calibrate
        )
    }
}

commands! {
    /// Consult the tables of a command.
    pub fn of_command(EmoveVerb, enum Step, enum Situation of Senses) -> Action {
        others: EXECUTE, accept::ACCEPT, HALT, EFFECT, attend::ATTEND, search::SEARCH, resume::RESUME,
            drum::DRUM, carried::CARRIED, ordered::ORDERED, CONFIRM, returning::RETURN, track::TRACK,
            resume::STANCE, records::RECORDS;
        before: EXECUTE, HALT, ATTEND by attend, ACCEPT(request), RECORDS(records),
            CARRIED(subordinates), ORDERED(subordinates -> situation);
        after: EFFECT(advance), CONFIRM;
        None | Pause: goals::REST           => e_pause::standing then e_pause::e_pause;
        MovToLoc: goals::PLACE              => fingers::fingers then motion::motion;
        MovToObj: goals::PLACE              => mov_to_obj::mov_to_obj then fingers::fingers then motion::motion;
        MovObjTo: goals::BROUGHT            => mov_obj_to::mov_obj_to then fingers::fingers then motion::motion;
        MovToHol: goals::PLACE              => mov_to_hol::mov_to_hol then fingers::fingers then motion::motion;
        MovToVu: goals::PLACE               => mov_to_vu::mov_to_vu then fingers::fingers then motion::motion;
        LocateObj: goals::LOCATED           => locate_obj::locate_obj;
        GraspObj: goals::HELD               => grasp_obj::grasp_obj;
        Release: goals::RELEASED            => release::release;
        QcDetach: goals::DETACHED           => exchange::exchange then qc_detach::qc_leave then qc_detach::qc_detach;
        QcAttach: goals::ATTACHED           => exchange::exchange then qc_attach::qc_lift then qc_attach::qc_attach;
        Withdraw: goals::WITHDRAWN          => withdraw::withdraw;
        InsertTool: goals::INSERTED         => insert_tool::insert_tool;
        ReleaseTool: goals::TOOL_RELEASED   => slide::slide then release_tool::release_tool;
        AcquireTool: goals::HELD            => slide::slide then acquire_tool::acquire_tool;
        RemoveTool: goals::REMOVED          => remove_tool::remove_tool;
    }
}
