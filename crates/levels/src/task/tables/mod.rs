//! Decision tables of Task: joystick box, needs of a new command, result of its last order, and one file per command.

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
    DataBase, Destination, DrumDeparture, Ends, SiteData, Station, TaskDrum, TaskRecipient, TaskRegrip,
    TaskRoute, TaskTool, ToolData, Update,
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

/// The response to the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Takeover {
    /// None: the operator does not control the robot.
    None,
    /// The operator takes control of the robot: S-PAUSE to Subtask, and the executing command ends.
    Interrupt,
    /// The operator takes control of the robot: S-PAUSE to Subtask, and the finished command is no longer reported.
    Clear,
    /// The operator takes control of the robot: S-PAUSE to Subtask.
    Pause,
    /// The operator controls the robot: only PAUSE is accepted.
    Refuse,
    /// The operator returns the robot: Task awaits the next command.
    Resume,
}

/// Changes of the control by the operator, for [`joystick::JOYSTICK`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct TaskOperator {
    /// Status of Subtask.
    pub subtask: Lower,
    /// Progress of the current command.
    pub outcome: Outcome,
}

/// The names in a new command, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// A new command is looked up in this tick.
    pub asked: Asked,
    /// The command.
    pub verb: TaskVerb,
    /// The first name that the task data lack: the object's, or a location's.
    pub missing: Missing,
    /// `endeff-id#` of the gripper for the object.
    pub gripper: TaskGripper,
}

/// The needs of a new command, for [`precondition::PRECONDITION`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Preconditions {
    /// A new command is looked up in this tick.
    pub asked: Asked,
    /// The command.
    pub verb: TaskVerb,
    /// The command names an object.
    pub handling: Handling,
    /// The source location.
    pub source: SiteData,
    /// The location to which the command goes: the destination; for POSITION the source, or the destination if the
    /// source is null.
    pub goal: SiteData,
    /// The kind of destination.
    pub destination: Destination,
    /// The object as a tool.
    pub tool: ToolData,
    /// The regrip on the pedestal.
    pub regrip: TaskRegrip,
    /// The trajectory from the tool drum to the end-at location.
    pub way_out: DrumDeparture,
    /// Result of the check against the task data.
    pub checked: Checked,
    /// Automatic or manual control.
    pub control: Control,
}

/// The status of the last order, for [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// The response to the joystick box.
    pub takeover: Takeover,
    /// The recipient of the order.
    pub ordered: TaskRecipient,
    /// Status of Subtask.
    pub subtask: Lower,
    /// State of the database.
    pub data_base: DataBase,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The status of the last order.
    pub work: Work,
    /// The command names an object.
    pub handling: Handling,
    /// Object status (V.4.1): the content of the gripper.
    pub held: Held,
    /// Source and destination grips: the same or different.
    pub grips: Grips,
    /// The end-at location, and whether the robot is there.
    pub ends: Ends,
    /// The pending update of the database.
    pub update: Update,
    /// The tool gripper and its content.
    pub tool: TaskTool,
    /// The robot's place.
    pub station: Station,
    /// The fingers relative to the tool drum.
    pub drum: TaskDrum,
    /// The route to the position.
    pub way: TaskRoute,
    /// The support of the object when the gripper opens.
    pub support: TaskSupport,
    /// The progress before the command was repeated.
    pub resumed: Resumed,
    /// The object of a repeated command, if it is placed already.
    pub placed: Placed,
    /// The place of the part during a regrip.
    pub part: TaskPart,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    /// A new command is accepted or refused in this tick.
    pub asked: Asked,
    /// The work that a new command replaces; [`joystick::JOYSTICK`] decides on `joystick`.
    pub replaced: Replaced,
    /// The verb of the new command, or of the current one.
    pub verb: TaskVerb,
    /// The new command looked up, or the current one.
    pub plan: Plan,
    pub request: Request,
    /// The needs of a new command; [`joystick::JOYSTICK`] decides on `control`.
    pub preconditions: Preconditions,
    /// The status of the last order; [`joystick::JOYSTICK`] decides on `takeover`.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the statuses from below.
    pub proof: Proof,
    /// The state variables of the command's table; [`ordered::ORDERED`] decides on `work`.
    pub situation: Situation,
}

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
    /// Abort to the Data System, which is disconnected at once.
    Disconnect,
    /// The Data System is connected: report finished.
    Connect,
    /// The Data System is connected; send it the oldest pending update.
    ConnectAndSend,
    /// Send the oldest pending update to the Data System.
    SendPending,
    /// Send the last command to the Data System again.
    SendAgain,
    /// Send the place of the object to the Data System.
    Update,
    /// Send the place of the object to the Data System, and GOTO-ENDPT to Subtask.
    UpdateAndGotoEndpt,
    /// Send the oldest pending update to the Data System, and >POSITION to Subtask.
    SendPendingAndPosition,
    /// Wait until the Data System has answered the update.
    AwaitUpdate,
    /// Report finished.
    Finish,
    /// Report an error.
    Fail(Reason),
    /// Report the failure that Subtask reports.
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
