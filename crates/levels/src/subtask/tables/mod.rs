//! Decision tables of Subtask: a file a command.

pub mod get_endeff;
pub mod get_object;
pub mod goto;
pub mod move_obj;
pub mod pause;
pub mod place_obj;
pub mod position;
pub mod release;

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

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// Status of E-move.
    pub emove: Lower,
    /// Is the object held?
    pub held: Held,
    /// Is vision needed?
    pub vision: Vision,
    /// End effector state.
    pub gripper: Gripper,
    /// What the position is named by.
    pub named: Named,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// E-PAUSE to E-move.
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
    /// Report done.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report what E-move reports.
    PassUp,
}

/// What the table of the current command decided.
pub type Choice = crate::execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: SubtaskVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        SubtaskVerb::None
        | SubtaskVerb::Pause
        | SubtaskVerb::FixGrip
        | SubtaskVerb::InsertTool
        | SubtaskVerb::ReleaseTool
        | SubtaskVerb::AcquireTool
        | SubtaskVerb::RemoveTool => pause::consult(step, s),
        SubtaskVerb::GetEndeff => get_endeff::consult(s),
        SubtaskVerb::GetObject => get_object::consult(step, s),
        SubtaskVerb::PlaceObj => place_obj::consult(step, s),
        SubtaskVerb::GotoEndpt | SubtaskVerb::GotoDest => goto::consult(step, s),
        SubtaskVerb::MoveObjToDest => move_obj::consult(step, s),
        SubtaskVerb::Position => position::consult(step, s),
        SubtaskVerb::Release => release::consult(step, s),
    }
}

#[cfg(test)]
mod tests {
    use rcs_core::process::Process;
    use taskdata::files::TaskData;

    use crate::subtask::Subtask;

    #[test]
    fn no_row_is_dead() {
        for table in <Subtask as Process<TaskData<'_>>>::TABLES {
            table.dead_rows(|row| panic!("{}: row {row} can never fire", table.name));
        }
    }
}
