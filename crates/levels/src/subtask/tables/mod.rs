//! Decision tables of Subtask: needs of a new command, result of its last order, and one file per command.

pub mod accept;
pub mod acquire_tool;
pub mod by_hand;
pub mod fix_grip;
pub mod get_endeff;
pub mod get_object;
pub mod goto;
pub mod insert_tool;
pub mod interlock;
pub mod move_obj_to_dest;
pub mod ordered;
pub mod place_obj;
pub mod position;
pub mod release;
pub mod release_tool;
pub mod remove_tool;
pub mod s_pause;
pub mod variables;

use interfaces::{Reason, emove::Seat, subtask::SubtaskVerb};
use rcs_core::{
    Actions, Variables, commands,
    handshake::{Arrival, Lower},
};

use self::by_hand::ManualOrder;
pub use self::variables::{
    Flip, GripHeld, HandOpening, Leaving, Named, PedestalData, PedestalLoad, SubtaskDrum, SubtaskExchange,
    SubtaskGripper, SubtaskHolster, SubtaskPart, SubtaskPedestal, SubtaskRecipient, SubtaskRobot,
    SubtaskVision, Turn, Where,
};
use super::goals;
use crate::{
    confirm::{CONFIRM, Proof},
    execution::{Asked, EXECUTE, Ending, Work},
    halt::{Commanding, EFFECT, HALT, Replaced, Stopping},
    held::Held,
    places::Missing,
};

/// The needs of a new command, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// A new command is looked up in this tick.
    pub asked: Asked,
    /// The command.
    pub verb: SubtaskVerb,
    /// The command names an object.
    pub named: Named,
    /// The pedestal data of the object.
    pub pedestal: PedestalData,
    /// The data that the task data lack.
    pub missing: Missing,
}

/// A part in the pedestal's hand, for [`interlock::INTERLOCK`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Interlock {
    /// A new command is looked up in this tick.
    pub asked: Asked,
    /// The part.
    pub pedestal: PedestalLoad,
    /// The command.
    pub verb: SubtaskVerb,
    /// End effector state.
    pub gripper: SubtaskGripper,
    /// Whether the robot may leave.
    pub robot: Leaving,
}

/// The status of the last order, for [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// The recipient of the order.
    pub ordered: SubtaskRecipient,
    /// Status of E-move.
    pub emove: Lower,
    /// Status of the pedestal.
    pub pedestal: SubtaskPedestal,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The status of the last order.
    pub work: Work,
    /// The held object, compared with the commanded one.
    pub held: Held,
    /// The grip of the held object.
    pub grip: GripHeld,
    /// The position of the object along the fingers.
    pub seat: Seat,
    /// The need for vision.
    pub vision: SubtaskVision,
    /// End effector state.
    pub gripper: SubtaskGripper,
    /// An interrupted exchange.
    pub exchange: SubtaskExchange,
    /// The robot at the object of the command, in the source grip.
    pub station: Where,
    /// The last release of the object at the destination of the command.
    pub placed: Where,
    /// The robot relative to the tool drum.
    pub drum: SubtaskDrum,
    /// The kind of name of the position.
    pub named: Named,
    /// The holder of the part during a regrip.
    pub part: SubtaskPart,
    /// The rotary table.
    pub table: Turn,
    /// The hand of the pedestal.
    pub hand: HandOpening,
    /// The robot's place.
    pub robot: SubtaskRobot,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    /// A new command is accepted or refused in this tick.
    pub asked: Asked,
    /// The work that a new command replaces.
    pub replaced: Replaced,
    /// The command in the buffer.
    pub verb: SubtaskVerb,
    pub request: Request,
    pub interlock: Interlock,
    pub manual: ManualOrder,
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the statuses from below.
    pub proof: Proof,
    /// The state variables of the command's table; [`Subordinates`] decide on `work`.
    pub situation: Situation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// E-PAUSE to E-move, and PAUSE to a pedestal that has a command.
    Pause,
    /// MOV-TO-VU to E-move.
    MovToVu,
    /// LOCATE-OBJ to E-move.
    LocateObj,
    /// MOV-TO-OBJ to E-move.
    MovToObj,
    /// GRASP-OBJ to E-move.
    GraspObj,
    /// GRASP-OBJ to E-move, in the grip of the held object.
    GraspAgain,
    /// MOV-OBJ-TO to E-move.
    MovObjTo,
    /// MOV-TO-LOC to E-move.
    MovToLoc,
    /// RELEASE to E-move.
    Release,
    /// MOV-TO-HOL to E-move.
    MovToHol(SubtaskHolster),
    /// QC-DETACH to E-move, in the own holster.
    QcDetach,
    /// QC-ATTACH to E-move, in the wanted gripper's holster.
    QcAttach,
    /// PRE-GRIP to the pedestal.
    PedPreGrip,
    /// MOV-OBJ-TO to E-move: move the object, in the source grip, to the pedestal.
    MovObjToPed,
    /// GRIP to the pedestal.
    PedGrip,
    /// RELEASE to E-move, with the object in the pedestal's hand.
    ReleaseAtPed,
    /// MOV-TO-LOC to E-move: move to PED-SAFE.
    MovToPedSafe,
    /// FLIP to the pedestal.
    PedFlip(Flip),
    /// MOV-TO-OBJ to E-move: the object in the pedestal's hand, in the destination grip.
    MovToObjAtPed,
    /// GRASP-OBJ to E-move, in the destination grip.
    GraspObjAtPed,
    /// RELEASE to the pedestal.
    PedRelease,
    /// INSERT-TOOL to E-move.
    InsertTool,
    /// RELEASE-TOOL to E-move.
    ReleaseTool,
    /// ACQUIRE-TOOL to E-move.
    AcquireTool,
    /// REMOVE-TOOL to E-move.
    RemoveTool,
    /// Report done.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report the failure that E-move reports.
    PassUp,
    /// Report the pedestal's reason, or this one if it gives none.
    PassUpPedestal(Reason),
}

impl Ending for Action {
    const WAIT: Self = Self::Wait;

    fn fail(reason: Reason) -> Self {
        Self::Fail(reason)
    }

    fn ends(&self) -> bool {
        matches!(self, Self::Finish)
    }
}

impl Stopping for Action {
    const STOP: Self = Self::Pause;
}

impl Commanding for Action {
    fn is_order(&self) -> bool {
        !matches!(
            self,
            Self::Wait | Self::Pause | Self::Finish | Self::Fail(_) | Self::PassUp | Self::PassUpPedestal(_)
        )
    }
}

commands! {
    /// Consult the table of a command.
    pub fn of_command(SubtaskVerb, enum Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, HALT, EFFECT, interlock::INTERLOCK, ordered::ORDERED, CONFIRM,
                by_hand::BY_HAND;
        before: EXECUTE, HALT, ACCEPT(request), INTERLOCK(interlock), ORDERED(subordinates -> situation.work);
        after: EFFECT, CONFIRM;
        None | Pause: goals::REST               => s_pause::s_pause;
        GetEndeff: goals::ATTACHED              => get_endeff::get_endeff;
        GetObject: goals::HELD                  => get_object::get_object;
        FixGrip: goals::REGRIPPED               => fix_grip::at_pedestal then fix_grip::fix_grip;
        PlaceObj: goals::PLACED                 => place_obj::place_obj;
        MoveObjToDest: goals::BROUGHT           => move_obj_to_dest::move_obj_to_dest;
        GotoEndpt | GotoDest: goals::PLACE      => goto::goto;
        Position: goals::PLACE                  => position::position;
        Release: goals::RELEASED                => release::release;
        InsertTool: goals::INSERTED             => insert_tool::insert_tool;
        ReleaseTool: goals::TOOL_RELEASED       => release_tool::release_tool;
        AcquireTool: goals::ACQUIRED            => acquire_tool::acquire_tool;
        RemoveTool: goals::REMOVED              => remove_tool::remove_tool;
    }
}
