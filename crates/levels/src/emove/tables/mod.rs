//! Decision tables of E-move: preconditions of a new command, rows common to all commands, and one file per command.
//! The motion commands share one table, each with its own above it.

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

/// What goes on whatever the command, for [`attend::ATTEND`] and [`search::SEARCH`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Watch {
    /// Was `.R` entered?
    pub initialization: Initialization,
    /// Is the command E-PAUSE?
    pub pause: Pause,
    /// How far it has come.
    pub outcome: Outcome,
    /// Is it known where the robot is?
    pub place: PlaceKnowledge,
    /// Where the resolvers say that it is.
    pub resolvers: Knowledge,
}

/// What the command carries and how its last order stands, for [`carried::CARRIED`] and [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// The command.
    pub verb: EmoveVerb,
    /// Is still held what was held?
    pub load: EmoveLoad,
    /// The process that has the last order.
    pub ordered: EmoveRecipient,
    /// Status of Prim; done as long as the command does not need it.
    pub prim: Lower,
    /// The condition of a guarded move.
    pub contact: EmoveContact,
    /// The opening of the fingers for the goal.
    pub opening: EmoveOpening,
    /// Status of the attached gripper.
    pub gripper: Lower,
    /// The locking ring.
    pub ring: Ring,
    /// Vision.
    pub vision: VisionAnswer,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// The command in it.
    pub verb: EmoveVerb,
    /// Is the command to be accepted or refused in this tick?
    pub asked: Asked,
    /// What it replaces.
    pub replaced: Replaced,
    /// Whether it has sent another point since its last order, for EFFECT.
    pub advance: Advance,
    /// A new command and the state of the robot.
    pub request: Request,
    /// The records of the command in the task data.
    pub records: Records,
    /// What goes on whatever the command.
    pub watch: Watch,
    /// How the last order of the command stands.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the sensors.
    pub proof: Proof,
    /// The state variables of the command's tables; ORDERED passes `work` on.
    pub situation: Situation,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// ROBOT-INIT to Prim.
    RobotInit,
    /// PAUSE to Prim and the gripper, QC-PAUSE to Quick Change.
    Pause,
    /// PAUSE to Prim, QC-PAUSE to Quick Change; fingers that move do what they were told.
    StopRobot,
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
    /// CAL-SENSOR to Prim, and where the robot is then.
    CalSensor(CalibratedAt),
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
    /// Open as far as the gripper does.
    OpenFully,
    /// UP-INIT to the gripper.
    Calibrate,
    /// Report done: the robot is at the goal.
    Arrive,
    /// Report done: the robot is at the location of the command, at rest where it was told to stand.
    Stand,
    /// Report an error: the bare robot stands clear of the holster, and may go elsewhere.
    Leave(Reason),
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
    /// Report an error before anything has been ordered.
    Refuse(Reason),
    /// Stop the robot and report an error.
    Fail(Reason),
    /// Stop the robot and report what the gripper reports.
    FailGrip,
    /// Stop the robot and report what Quick Change reports.
    FailRing,
    /// Report what Prim reports.
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
        ReleaseTool: goals::TOOL_RELEASED   => release_tool::release_tool;
        AcquireTool: goals::HELD            => acquire_tool::acquire_tool;
        RemoveTool: goals::REMOVED          => remove_tool::remove_tool;
    }
}
