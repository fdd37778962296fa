//! Decision tables of Task: a file a command.

pub mod acquire;
pub mod mov;
pub mod pause;
pub mod position;
pub mod transfer;

use rcs_core::{coded_enum, handshake::Lower, interface::Reason};

use super::plan::TaskVerb;

coded_enum! {
    /// Is an object to be handled (V.4.1)?
    pub enum Handling {
        /// The command names no object.
        NoObject = "no object",
        /// It does.
        Object = "object",
    }
}

coded_enum! {
    /// Does the gripper hold something?
    pub enum Holding {
        /// Nothing.
        NotHeld = "not held",
        /// Something.
        Held = "held",
    }
}

coded_enum! {
    /// Source and destination grip numbers.
    pub enum Grips {
        /// The object stays as it is gripped.
        Same = "same",
        /// It must be regripped on the way.
        Different = "different",
    }
}

coded_enum! {
    /// Where the robot is to be at the end.
    pub enum Ends {
        /// Where the command leaves it.
        Here = "here",
        /// At the end-at location.
        Elsewhere = "elsewhere",
    }
}

coded_enum! {
    /// State of the data base; `Done` while no Data System is connected (DB-DONE, IV.3.2).
    pub enum DataBase {
        /// It has taken the update, or there is none to take it.
        Done = "done",
        /// It is taking the update.
        Executing = "executing",
        /// It refused.
        Error = "error",
    }
}

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// Status of Subtask.
    pub subtask: Lower,
    /// Is an object to be handled?
    pub handling: Handling,
    /// Does the gripper hold something?
    pub holding: Holding,
    /// Source and destination grips.
    pub grips: Grips,
    /// Is there an end-at location?
    pub ends: Ends,
    /// State of the data base.
    pub data_base: DataBase,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// S-PAUSE to Subtask.
    Pause,
    /// GET-ENDEFF to Subtask.
    GetEndeff,
    /// GET-OBJECT to Subtask.
    GetObject,
    /// PLACE-OBJ to Subtask.
    PlaceObj,
    /// MOVE-OBJ>D to Subtask.
    MoveObjToDest,
    /// GOTO-DEST to Subtask.
    GotoDest,
    /// GOTO-ENDPT to Subtask.
    GotoEndpt,
    /// >POSITION to Subtask.
    Position,
    /// RELEASE to Subtask.
    Release,
    /// Tell the Data System what was moved.
    UpdateDataBase,
    /// Report finished.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report what Subtask reports.
    PassUp,
}

/// What the table of the current command decided.
pub type Choice = crate::execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: TaskVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        TaskVerb::None | TaskVerb::Pause => pause::consult(step, s),
        TaskVerb::Transfer => transfer::consult(step, s),
        TaskVerb::Move => mov::consult(step, s),
        TaskVerb::Position => position::consult(step, s),
        TaskVerb::Acquire => acquire::consult(step, s),
    }
}

#[cfg(test)]
mod tests {
    use rcs_core::process::Process;
    use taskdata::files::TaskData;

    use crate::task::Task;

    #[test]
    fn no_row_is_dead() {
        for table in <Task as Process<TaskData<'_>>>::TABLES {
            table.dead_rows(|row| panic!("{}: row {row} can never fire", table.name));
        }
    }
}
