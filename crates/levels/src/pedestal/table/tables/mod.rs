//! Decision tables of the table process: what a new command needs, the calibration, what commands have in common, and
//! one file per command.

pub mod accept;
pub mod calibrate;
pub mod pause;
pub mod rest;
pub mod turn;

pub use crate::variables::Clock;
use interfaces::{Reason, pedestal::TableVerb};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use super::goals;
use crate::execution::{Asked, Course, EXECUTE};

/// Step of all commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// No turn ordered yet: the table comes to rest, or the command waits for the calibration.
    Start,
    /// The turn is ordered.
    Turning,
}

/// Step of CALIBRATE: how far the calibration has come. It outlasts the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TablePhase {
    /// Never done: begins at once, since the table was booted just now (IV.5.1 step 10).
    Missing,
    /// Not done since the process was started in the middle of a job: the table may stand beside the robot,
    /// so it waits for a command that turns it.
    Deferred,
    /// The process was started in the middle of a job: the table comes to rest, and the calibration from
    /// before counts if counter and potentiometer agree.
    Adopting,
    /// The table turns towards its + limit.
    Seeking,
    /// The counter is being set.
    Setting,
    /// The table turns to -20.00, clear of the + limit.
    Parking,
    /// The counter shows the angle.
    Valid,
    /// The last attempt failed, or steps were lost; the next command that turns the table tries again.
    Failed,
}

/// Can the table turn to the commanded angle?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableAngle {
    /// Yes, or none is commanded.
    Within,
    /// It is beyond a limit.
    Beyond,
}

/// The command that is being executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableActivity {
    /// None: nothing was commanded yet, or it has ended.
    Nothing,
    /// None: it was refused, or found at the start and not executed.
    Refused,
    /// PAUSE.
    Pause,
    /// CALIBRATE.
    Calibrate,
    /// TURN.
    Turn,
}

impl TableActivity {
    /// What EXECUTE and ACCEPT leave of a command.
    #[must_use]
    pub const fn of(course: Course, accepted: bool, verb: TableVerb) -> Self {
        match course {
            Course::Rest => Self::Nothing,
            Course::Begin | Course::Continue if accepted => match verb {
                TableVerb::None => Self::Refused,
                TableVerb::Pause => Self::Pause,
                TableVerb::Calibrate => Self::Calibrate,
                TableVerb::Turn => Self::Turn,
            },
            Course::Refuse | Course::Begin | Course::Continue => Self::Refused,
        }
    }
}

/// What the motor does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Motor {
    /// Its controller has not taken the last order yet.
    Pending,
    /// It turns.
    Turning,
    /// It has come to rest only just now.
    Settling,
    /// It stands.
    Standing,
    /// Its controller does not take the last order.
    Silent,
}

/// Do counter and potentiometer agree where the table is?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Counter {
    /// Yes.
    Agrees,
    /// No: steps were lost, the counter was never set, or the potentiometer fails.
    Disagrees,
}

/// Where the table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Turned {
    /// Where the step that is under way wants it: at the + limit, with the counter set, parked, at the angle.
    There,
    /// Anywhere else.
    Elsewhere,
}

/// What a new command needs, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: TableVerb,
    /// Can the table turn to the angle?
    pub angle: TableAngle,
}

/// The state variables of a tick, for the tables of calibration and commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The command that is being executed.
    pub command: TableActivity,
    /// What the motor does.
    pub motor: Motor,
    /// Do counter and potentiometer agree?
    pub counter: Counter,
    /// Is the table where it should be?
    pub place: Turned,
    /// Time of the command.
    pub clock: Clock,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// What a new command needs.
    pub request: Request,
    /// The state variables; EXECUTE and ACCEPT decide on `command`.
    pub situation: Situation,
    /// What the counter shows, 0.1 degree, unless the table stands elsewhere by its potentiometer.
    pub angle: Option<i32>,
}

/// What [`calibrate::CALIBRATE`] leaves to decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableDuty {
    /// Nothing.
    Nothing,
    /// The table of the command decides.
    Command,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// No new order.
    Wait,
    /// The calibration begins: turn towards the + limit.
    SeekLimit,
    /// The table stands at the + limit: set the counter to zero.
    SetCounter,
    /// Turn to -20.00.
    Park,
    /// The calibration is over: the time of a command that has waited begins.
    EndWait,
    /// Turn to the commanded angle.
    Turn,
    /// Stop.
    Stop,
    /// Report done.
    Finish,
    /// Stop; report an error. The angle is not known any more.
    Lose(Reason),
    /// Stop: there is no calibration, and no command that fails with it. The time of one that has waited
    /// begins.
    GiveUp,
}

commands! {
    /// Consult the table of a command.
    pub fn of_command(TableVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, calibrate::CALIBRATE;
        Turn: goals::TURNED             => rest::rest then turn::turn;
        None | Pause: goals::REST       => rest::rest then pause::pause;
        Calibrate: goals::CALIBRATED    => rest::rest then pause::pause;
    }
}
