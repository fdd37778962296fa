//! Decision tables of Task: the joystick box, what a new command needs, what has become of its last order, and one file
//! per command.

pub mod accept;
pub mod acquire;
pub mod acquire_tool;
pub mod insert_tool;
pub mod item;
pub mod joystick;
pub mod load;
pub mod mov;
pub mod ordered;
pub mod pause;
pub mod pending;
pub mod position;
pub mod precondition;
pub mod refixture;
pub mod release_tool;
pub mod remove_tool;
pub mod shutdown;
pub mod startup;
pub mod transfer;
pub mod variables;

use interfaces::{Reason, hws::Checked};
use rcs_core::{
    Actions, Plain, Variables, commands,
    handshake::{Arrival, Lower},
};

use self::joystick::Control;
pub use self::variables::{
    DataBase, Destination, Ends, SiteData, Station, TaskDrum, TaskRecipient, TaskRegrip, TaskRoute, TaskTool,
    ToolData, Update, WayOut,
};
use super::{
    goals,
    ledger::{Placed, TaskPart},
    plan::{Grips, Handling, Plan, Resumed, TaskGripper, TaskVerb},
    support::TaskSupport,
};
use crate::{
    confirm::{CONFIRM, Proof},
    execution::{Asked, EXECUTE, Ending, Outcome, Work},
    halt::{HALT, Replaced, Stopping},
    held::Held,
    places::Missing,
};

/// What is done about the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Takeover {
    /// Nothing: the operator does not have the robot.
    None,
    /// The operator takes it: S-PAUSE to Subtask, and the command that is executing ends.
    Interrupt,
    /// The operator takes it: S-PAUSE to Subtask, and the finished command is reported no longer.
    Clear,
    /// The operator takes it: S-PAUSE to Subtask.
    Pause,
    /// The operator has it: no command but PAUSE is accepted.
    Refuse,
    /// The operator gives it back: the next command is awaited.
    Resume,
}

/// Does the operator take the robot or give it back? For [`joystick::JOYSTICK`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct TaskOperator {
    /// Status of Subtask.
    pub subtask: Lower,
    /// How far the current command has come.
    pub outcome: Outcome,
}

/// What a new command names, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: TaskVerb,
    /// Which name the task data lack: the object's, or that of the first location.
    pub missing: Missing,
    /// `endeff-id#` of the gripper for the object.
    pub gripper: TaskGripper,
}

/// What a new command needs, for [`precondition::PRECONDITION`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Preconditions {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: TaskVerb,
    /// Is an object named?
    pub handling: Handling,
    /// The source location.
    pub source: SiteData,
    /// The location to which the command goes: the destination; for POSITION the source, or the destination if the
    /// source is null.
    pub goal: SiteData,
    /// Where the destination is.
    pub destination: Destination,
    /// The object as a tool.
    pub tool: ToolData,
    /// Must the object be regripped on the pedestal?
    pub regrip: TaskRegrip,
    /// The way from the tool drum to the end-at location.
    pub way_out: WayOut,
    /// Verdict of the check against the task data.
    pub checked: Checked,
    /// What has the robot.
    pub control: Control,
}

/// How the last order of the command stands, for [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// What is done about the joystick box.
    pub takeover: Takeover,
    /// The neighbour that has it.
    pub ordered: TaskRecipient,
    /// Status of Subtask.
    pub subtask: Lower,
    /// State of the data base.
    pub data_base: DataBase,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The last order.
    pub work: Work,
    /// Is an object to be handled?
    pub handling: Handling,
    /// Object status (V.4.1): what the gripper holds.
    pub held: Held,
    /// Are the source and destination grips the same?
    pub grips: Grips,
    /// Is there an end-at location, and is the robot there?
    pub ends: Ends,
    /// Pending update of the data base.
    pub update: Update,
    /// The tool gripper.
    pub tool: TaskTool,
    /// Where the robot is.
    pub station: Station,
    /// The tool drum.
    pub drum: TaskDrum,
    /// The way to the position.
    pub way: TaskRoute,
    /// What keeps the object from falling when the gripper opens.
    pub support: TaskSupport,
    /// Was the command sent before and not finished?
    pub resumed: Resumed,
    /// Has it placed its object already?
    pub placed: Placed,
    /// Is the part in the pedestal's hand?
    pub part: TaskPart,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// Is the command to be accepted or refused?
    pub asked: Asked,
    /// What a new command replaces; [`joystick::JOYSTICK`] decides on `joystick`.
    pub replaced: Replaced,
    /// Its verb, or that of the current one.
    pub verb: TaskVerb,
    /// The new command looked up, or the current one.
    pub plan: Plan,
    /// What a new command names.
    pub request: Request,
    /// What it needs; [`joystick::JOYSTICK`] decides on `control`.
    pub preconditions: Preconditions,
    /// How the last order of the command stands; [`joystick::JOYSTICK`] decides on `takeover`.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the statuses from below.
    pub proof: Proof,
    /// The state variables of the command's table; [`ordered::ORDERED`] decides on `work`.
    pub situation: Situation,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
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
    /// >POSITION to Subtask: back to the object at the destination.
    Return,
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
    /// The Data System is connected; send it the oldest pending update.
    ConnectAndSend,
    /// Send the oldest pending update to the Data System.
    SendPending,
    /// Send the last command to the Data System again.
    SendAgain,
    /// Send to the Data System where the object now is.
    Update,
    /// Send to the Data System where the object now is, and GOTO-ENDPT to Subtask.
    UpdateAndGotoEndpt,
    /// Send the oldest pending update to the Data System, and >POSITION to Subtask.
    SendPendingAndPosition,
    /// Wait for the Data System, which has the update.
    AwaitUpdate,
    /// Report finished.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report what Subtask reports.
    PassUp,
}

impl Ending for Action {
    const WAIT: Self = Self::Wait;

    fn fail(reason: Reason) -> Self {
        Self::Fail(reason)
    }

    fn ends(&self) -> bool {
        matches!(self, Self::Finish | Self::Connect)
    }
}

impl Stopping for Action {
    const STOP: Self = Self::Pause;
}

commands! {
    /// Consult the table of a command.
    pub fn of_command(TaskVerb, enum Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, HALT, joystick::JOYSTICK, ordered::ORDERED, CONFIRM,
            precondition::PRECONDITION, item::UPDATE_DUE, item::FOLLOW, item::TAKE, item::RELEASED,
            load::PICK_UP, load::CARRY, pending::QUEUE, pending::UPDATE;
        before: EXECUTE, JOYSTICK by joystick, HALT, ACCEPT(request), PRECONDITION(preconditions),
            ORDERED(subordinates -> situation.work);
        after: CONFIRM;
        None | Pause: goals::REST           => pause::pause;
        Transfer: goals::TRANSFERRED        => transfer::transfer;
        Move: goals::MOVED                  => mov::r#move;
        Position: goals::POSITIONED         => position::position;
        Acquire: goals::HELD                => acquire::acquire;
        Refixture: goals::REFIXTURED        => refixture::refixture;
        InsertTool: goals::INSERTED         => insert_tool::insert_tool;
        ReleaseTool: goals::TOOL_RELEASED   => release_tool::release_tool;
        AcquireTool: goals::ACQUIRED        => acquire_tool::acquire_tool;
        RemoveTool: goals::REMOVED          => remove_tool::remove_tool;
        Startup: goals::CONNECTED           => startup::startup;
        Shutdown: goals::DISCONNECTED       => shutdown::shutdown;
    }
}
