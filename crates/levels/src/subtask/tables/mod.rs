//! Decision tables of Subtask: what a new command needs, what has become of its last order, and a file a command.

pub mod accept;
pub mod acquire_tool;
pub mod fix_grip;
pub mod get_endeff;
pub mod get_object;
pub mod goto;
pub mod hindrance;
pub mod insert_tool;
pub mod move_obj_to_dest;
pub mod ordered;
pub mod place_obj;
pub mod position;
pub mod release;
pub mod release_tool;
pub mod remove_tool;
pub mod s_pause;

use rcs_core::{
    Actions, Plain, Variables, commands,
    handshake::{Arrival, Lower},
    interface::{Reason, subtask::SubtaskVerb},
    table::Choice,
};

use self::{accept::accept, hindrance::hindrance, ordered::ordered};
use crate::{
    execution::{Asked, EXECUTE, Orders as Commander, Work},
    halt::{EFFECT, Futile, HALT, Halting, Replaced},
    places::Missing,
};

/// Is the object held (V.3.1)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Held {
    /// The gripper holds nothing.
    Nothing,
    /// It holds the object of the command.
    Right,
    /// It holds another object.
    Other,
    /// It holds something, and nothing says what it is.
    Something,
    /// Its sensors do not tell: counts as held.
    NotKnown,
}

/// With which grip the object of the command is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripHeld {
    /// The grip for the source location.
    Source,
    /// The grip for the destination location, which may be the same.
    Destination,
    /// Neither of the two, or the object is not held.
    Neither,
}

/// Must the object be found by vision (VII.7.6, en)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Vision {
    /// Its location is known well enough.
    #[text = "not needed"]
    NotNeeded,
    /// It must be found.
    Needed,
    /// It has been found, and nothing has moved it since.
    Done,
}

/// Is there something where the command wants it?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Where {
    /// At the location of the command, in its grip.
    There,
    /// Elsewhere, or nowhere.
    Elsewhere,
}

/// An exchange of grippers that is half done: the robot stands in a holster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Exchange {
    /// None: the robot is clear of the holsters.
    None,
    /// In the holster of the wanted gripper.
    Wanted,
    /// In that of another one.
    Other,
}

/// End effector state (V.3.1): right, wrong, none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Gripper {
    /// No gripper is attached.
    None,
    /// The gripper for the object is attached.
    Right,
    /// Another one is attached.
    Wrong,
}

/// What a position is named by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Named {
    /// The location alone.
    Location,
    /// An object, real or virtual, at the location.
    Object,
}

/// Pedestal status (V.3.1): what the Active Pedestal makes of the last command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pedestal {
    /// Hand or table are moving, or the command is not echoed yet.
    Moving,
    /// The command is done.
    Done,
    /// It cannot be executed.
    #[text = "can't-do"]
    Cannot,
    /// An error prevents it from finishing.
    #[text = "error"]
    Faulty,
    /// The pedestal does not answer.
    Silent,
}

/// The robot and the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Drum {
    /// The fingers are around a tool in the drum.
    Inside,
    /// The robot stands at a place outside.
    Outside,
    /// It stands at no place: it may be on its way into the drum or out of it.
    Unplaced,
}

/// Who has the part that is regripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Part {
    /// The robot.
    Robot,
    /// Robot and pedestal.
    Both,
    /// The pedestal, and something is between the robot's fingers, which may be the part.
    Touched,
    /// The pedestal.
    Hand,
    /// Neither of them.
    Nobody,
    /// The pedestal has another object.
    Other,
    /// The pedestal has nothing, and the robot something unknown.
    Unknown,
    /// The robot's gripper does not tell.
    NotKnown,
}

/// Where the rotary table stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Turn {
    /// At the angle in which it receives the object.
    Receive,
    /// At the angle to which it turns the object.
    Turned,
    /// Between, or beyond them.
    Between,
}

/// The hand of the pedestal, by its opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Hand {
    /// As wide as the object needs it to come in.
    Open,
    /// Narrower.
    Narrow,
}

/// Where the robot is, for FIX-GRIP.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Robot {
    /// At the pedestal, for the source grip.
    First,
    /// At the pedestal, for the destination grip.
    Third,
    /// At PED-SAFE.
    Safe,
    /// Elsewhere, or on a way.
    Away,
}

/// How far the table turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Flip {
    /// By the whole flip angle of the object.
    Whole,
    /// By what is left of it.
    Rest,
}

/// The part in the pedestal's hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalHand {
    /// There is none.
    Free,
    /// It is there, alone or together with the robot.
    HoldsPart,
}

/// Which holster is moved to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Holster {
    /// That of the attached gripper.
    Own,
    /// That of the wanted gripper.
    Wanted,
}

/// The PED-PARA record of the object (VII.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalData {
    /// There is none, or it is not needed.
    Missing,
    /// It is there.
    Found,
}

/// The process that has the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ordered {
    /// Nothing was ordered yet.
    Nothing,
    /// E-move.
    Emove,
    /// The Active Pedestal.
    Pedestal,
    /// Both: they are pausing.
    Both,
}

/// What a new command needs, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: SubtaskVerb,
    /// Is an object named?
    pub named: Named,
    /// How the pedestal takes the object.
    pub pedestal: PedestalData,
    /// What the task data lack.
    pub missing: Missing,
}

/// A part in the pedestal's hand, for [`hindrance::HINDRANCE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Hindrance {
    /// Is the command new?
    pub asked: Asked,
    /// The part.
    pub pedestal: PedestalHand,
    /// The command.
    pub verb: SubtaskVerb,
    /// End effector state.
    pub gripper: Gripper,
}

/// How the last order of the command stands, for [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Orders {
    /// The process that has it.
    pub ordered: Ordered,
    /// Status of E-move.
    pub emove: Lower,
    /// Status of the pedestal.
    pub pedestal: Pedestal,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The last order.
    pub work: Work,
    /// Is the object held?
    pub held: Held,
    /// With which grip?
    pub grip: GripHeld,
    /// Is vision needed?
    pub vision: Vision,
    /// End effector state.
    pub gripper: Gripper,
    /// An exchange that is half done.
    pub exchange: Exchange,
    /// Where the robot stands: at the object of the command, in its source grip?
    pub station: Where,
    /// Where the object of the command was let go last: at its destination?
    pub placed: Where,
    /// The tool drum.
    pub drum: Drum,
    /// What the position is named by.
    pub named: Named,
    /// Who has the part that is regripped.
    pub part: Part,
    /// The rotary table.
    pub table: Turn,
    /// The hand of the pedestal.
    pub hand: Hand,
    /// Where the robot is.
    pub robot: Robot,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// Is the command to be accepted or refused?
    pub asked: Asked,
    /// What a new command replaces.
    pub replaced: Replaced,
    /// The command in it.
    pub verb: SubtaskVerb,
    /// What a new command needs.
    pub request: Request,
    /// What hinders it.
    pub hindrance: Hindrance,
    /// How the last order of the command stands.
    pub orders: Orders,
    /// The state variables of the command's table; [`Orders`] decide on `work`.
    pub situation: Situation,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// E-PAUSE to E-move, and PAUSE to a pedestal that was commanded.
    Pause,
    /// MOV-TO-VU to E-move.
    MovToVu,
    /// LOCATE-OBJ to E-move.
    LocateObj,
    /// MOV-TO-OBJ to E-move.
    MovToObj,
    /// GRASP-OBJ to E-move.
    GraspObj,
    /// MOV-OBJ-TO to E-move.
    MovObjTo,
    /// MOV-TO-LOC to E-move.
    MovToLoc,
    /// RELEASE to E-move.
    Release,
    /// MOV-TO-HOL to E-move.
    MovToHol(Holster),
    /// QC-DETACH to E-move, in the own holster.
    QcDetach,
    /// QC-ATTACH to E-move, in the wanted gripper's holster.
    QcAttach,
    /// PRE-GRIP to the pedestal.
    PedPreGrip,
    /// MOV-OBJ-TO to E-move: the object, in the source grip, to the pedestal.
    MovObjToPed,
    /// GRIP to the pedestal.
    PedGrip,
    /// RELEASE to E-move, with the object in the pedestal's hand.
    ReleaseAtPed,
    /// MOV-TO-LOC to E-move: out of the pedestal's way.
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
    /// Report what E-move reports.
    PassUp,
    /// Report an error with the pedestal's reason, or with this one if it gives none.
    PassUpPedestal(Reason),
}

impl From<Halting> for Action {
    fn from(halting: Halting) -> Self {
        match halting {
            Halting::Stop => Self::Pause,
            Halting::Wait => Self::Wait,
        }
    }
}

impl From<Futile> for Action {
    fn from(Futile::Fail(reason): Futile) -> Self {
        Self::Fail(reason)
    }
}

impl Commander for Action {
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
        others: EXECUTE, accept::ACCEPT, HALT, EFFECT, hindrance::HINDRANCE, ordered::ORDERED;
        None | Pause            => s_pause::s_pause;
        GetEndeff               => get_endeff::get_endeff;
        GetObject               => get_object::get_object;
        FixGrip                 => fix_grip::fix_grip;
        PlaceObj                => place_obj::place_obj;
        MoveObjToDest           => move_obj_to_dest::move_obj_to_dest;
        GotoEndpt | GotoDest    => goto::goto;
        Position                => position::position;
        Release                 => release::release;
        InsertTool              => insert_tool::insert_tool;
        ReleaseTool             => release_tool::release_tool;
        AcquireTool             => acquire_tool::acquire_tool;
        RemoveTool              => remove_tool::remove_tool;
    }
}

/// Consult the tables in turn until a row decides.
#[must_use]
pub fn decide(step: Step, seen: &Seen) -> Choice<Action, Step> {
    let of_command = |work| of_command(seen.verb, step, &Situation { work, ..seen.situation });
    accept(step, &seen.request).then(number::ACCEPT, |()| {
        hindrance(step, &seen.hindrance)
            .then(number::HINDRANCE, |()| ordered(step, &seen.orders).then(number::ORDERED, of_command))
    })
}
