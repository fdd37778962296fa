//! Decision tables of Subtask: a file a command.

pub mod acquire_tool;
pub mod fix_grip;
pub mod get_endeff;
pub mod get_object;
pub mod goto;
pub mod insert_tool;
pub mod move_obj;
pub mod pause;
pub mod place_obj;
pub mod position;
pub mod release;
pub mod release_tool;
pub mod remove_tool;

use rcs_core::{
    coded_enum,
    handshake::Lower,
    interface::{Reason, subtask::SubtaskVerb},
};

coded_enum! {
    /// Is the object held (V.3.1)?
    pub enum Held {
        /// The gripper holds nothing.
        Nothing = "nothing",
        /// It holds the object of the command.
        Right = "right",
        /// It holds another object.
        Other = "other",
    }
}

coded_enum! {
    /// With which grip the object of the command is held.
    pub enum GripHeld {
        /// Subtask has not seen how it was taken.
        Unknown = "unknown",
        /// The grip for the source location.
        Source = "source",
        /// The grip for the destination location, which may be the same.
        Destination = "destination",
        /// Neither of the two.
        Neither = "neither",
    }
}

coded_enum! {
    /// Must the object be found by vision (VII.7.6, en)?
    pub enum Vision {
        /// Its location is known well enough.
        NotNeeded = "not needed",
        /// It must be found.
        Needed = "needed",
    }
}

coded_enum! {
    /// End effector state (V.3.1): right, wrong, none.
    pub enum Gripper {
        /// No gripper is attached.
        None = "none",
        /// The gripper for the object is attached.
        Right = "right",
        /// Another one is attached.
        Wrong = "wrong",
    }
}

coded_enum! {
    /// What a position is named by.
    pub enum Named {
        /// The location alone.
        Location = "location",
        /// An object, real or virtual, at the location.
        Object = "object",
    }
}

coded_enum! {
    /// Pedestal status (V.3.1): what the Active Pedestal makes of the last command.
    pub enum Pedestal {
        /// Hand or table are moving, or the command is not echoed yet.
        Moving = "moving",
        /// The command is done.
        Done = "done",
        /// It cannot be executed.
        Cannot = "can't-do",
        /// An error prevents it from finishing.
        Faulty = "error",
        /// The pedestal does not answer.
        Silent = "silent",
    }
}

coded_enum! {
    /// The hand of the pedestal, by its opening.
    pub enum Hand {
        /// It stands at the grasp size or below it: nothing is between its fingers.
        Empty = "empty",
        /// It stands above.
        Gripping = "gripping",
    }
}

/// Which holster is moved to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holster {
    /// That of the attached gripper.
    Own,
    /// That of the wanted gripper.
    Wanted,
}

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// Status of E-move.
    pub emove: Lower,
    /// Is the object held?
    pub held: Held,
    /// With which grip?
    pub grip: GripHeld,
    /// Is vision needed?
    pub vision: Vision,
    /// End effector state.
    pub gripper: Gripper,
    /// What the position is named by.
    pub named: Named,
    /// Pedestal status.
    pub pedestal: Pedestal,
    /// Hand of the pedestal.
    pub hand: Hand,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    PedFlip,
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

/// What the table of the current command decided.
pub type Choice = crate::execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: SubtaskVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        SubtaskVerb::None | SubtaskVerb::Pause => pause::consult(step, s),
        SubtaskVerb::GetEndeff => get_endeff::consult(step, s),
        SubtaskVerb::GetObject => get_object::consult(step, s),
        SubtaskVerb::FixGrip => fix_grip::consult(step, s),
        SubtaskVerb::PlaceObj => place_obj::consult(step, s),
        SubtaskVerb::GotoEndpt | SubtaskVerb::GotoDest => goto::consult(step, s),
        SubtaskVerb::MoveObjToDest => move_obj::consult(step, s),
        SubtaskVerb::Position => position::consult(step, s),
        SubtaskVerb::Release => release::consult(step, s),
        SubtaskVerb::InsertTool => insert_tool::consult(step, s),
        SubtaskVerb::ReleaseTool => release_tool::consult(step, s),
        SubtaskVerb::AcquireTool => acquire_tool::consult(step, s),
        SubtaskVerb::RemoveTool => remove_tool::consult(step, s),
    }
}
