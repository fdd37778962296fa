//! Decision tables of Task: a file a command, and one for the joystick box.

pub mod acquire;
pub mod acquire_tool;
pub mod insert_tool;
pub mod joystick;
pub mod mov;
pub mod pause;
pub mod position;
pub mod refixture;
pub mod release_tool;
pub mod remove_tool;
pub mod shutdown;
pub mod startup;
pub mod transfer;

use rcs_core::{Plain, handshake::Lower, interface::Reason};

use super::plan::TaskVerb;

/// Is an object to be handled (V.4.1)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Handling {
    /// The command names no object.
    #[text = "no object"]
    NoObject,
    /// It does.
    Object,
}

/// Object status (V.4.1): does the gripper hold something?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Holding {
    /// Nothing.
    #[text = "not held"]
    NotHeld,
    /// The object of the command.
    Held,
    /// Something else.
    Other,
}

/// Source and destination grip numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grips {
    /// The object stays as it is gripped.
    Same,
    /// It must be regripped on the way.
    Different,
}

/// Where the robot is to be at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ends {
    /// Where the command leaves it.
    Here,
    /// At the end-at location, where it is now.
    There,
    /// At the end-at location, where it is not.
    Elsewhere,
}

/// State of the data base (V.4.1): what the Data System makes of the last command to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum DataBase {
    /// It is done.
    Done,
    /// It is executing, or not answered yet.
    Executing,
    /// It was refused.
    Refused,
    /// It is not done in time, and can be written again.
    Overdue,
    /// It is not done in time, however often it was written.
    Silent,
}

/// What the Data System is to be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Books {
    /// Nothing: the object is not moved from or to the MBD, it has been told, or no Data System is
    /// connected (DB-DONE, IV.3.2).
    Closed,
    /// The move of this command.
    Open,
    /// An update that was written and is not taken yet.
    Owed,
}

/// The tool gripper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tool {
    /// It is not on, or it holds another tool than the command names.
    None,
    /// It holds nothing.
    Free,
    /// It holds the tool.
    Held,
}

/// Where the robot is, for the tool commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Station {
    /// At none of the following.
    Elsewhere,
    /// Near the drum: at TOOL-SAFE, or at the source location that the command names.
    Safe,
    /// In the transfer location of the drum.
    Transfer,
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
    /// Is there an end-at location, and is the robot there?
    pub ends: Ends,
    /// State of the data base.
    pub data_base: DataBase,
    /// What it is to be told.
    pub books: Books,
    /// The tool gripper.
    pub tool: Tool,
    /// Where the robot is.
    pub station: Station,
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
    /// FIX-GRIP to Subtask.
    FixGrip,
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
    /// INSERT-TOOL to Subtask.
    InsertTool,
    /// RELEASE-TOOL to Subtask.
    ReleaseTool,
    /// ACQUIRE-TOOL to Subtask.
    AcquireTool,
    /// REMOVE-TOOL to Subtask.
    RemoveTool,
    /// Abort to the Data System.
    Abort,
    /// Initiate to the Data System.
    Initiate,
    /// Startup to the Data System.
    Startup,
    /// Abort to the Data System, which is no longer connected from now on.
    Disconnect,
    /// The Data System is connected: report finished.
    Connect,
    /// The Data System is connected; tell it the update that it has not taken.
    ConnectAndTell,
    /// Tell the Data System the update that it has not taken.
    TellOwed,
    /// Write the last command to the Data System again.
    AskAgain,
    /// Tell the Data System where the object now is.
    Update,
    /// Tell the Data System where the object now is, and GOTO-ENDPT to Subtask.
    UpdateAndGotoEndpt,
    /// Report finished.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report what Subtask reports.
    PassUp,
}

/// What the table of the current command decided.
pub type Choice = crate::old_execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: TaskVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        TaskVerb::None | TaskVerb::Pause => pause::consult(step, s),
        TaskVerb::Transfer => transfer::consult(step, s),
        TaskVerb::Move => mov::consult(step, s),
        TaskVerb::Position => position::consult(step, s),
        TaskVerb::Acquire => acquire::consult(step, s),
        TaskVerb::Refixture => refixture::consult(step, s),
        TaskVerb::InsertTool => insert_tool::consult(step, s),
        TaskVerb::ReleaseTool => release_tool::consult(step, s),
        TaskVerb::AcquireTool => acquire_tool::consult(step, s),
        TaskVerb::RemoveTool => remove_tool::consult(step, s),
        TaskVerb::Startup => startup::consult(step, s),
        TaskVerb::Shutdown => shutdown::consult(step, s),
    }
}
