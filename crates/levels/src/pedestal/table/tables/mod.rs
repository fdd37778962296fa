//! Decision tables of the table process: preconditions of a new command, the calibration, rows common to all
//! commands, and one file per command.

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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// No turn ordered yet: the table comes to rest, or the command waits for the calibration.
    Start,
    /// The turn is ordered.
    Turning,
}

/// Step of CALIBRATE: progress of the calibration. It outlasts the commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TablePhase {
    /// Not calibrated: the calibration begins at once, since the system has just started (IV.5.1 step 10).
    Missing,
    /// Not calibrated since the process was started in the middle of a job: the table may be next to the robot, so
    /// the calibration waits for a command that turns it.
    Deferred,
    /// The process was started in the middle of a job: the table comes to rest. Its last calibration is adopted if
    /// counter and potentiometer agree.
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

/// Whether the commanded angle is within the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableAngle {
    /// Within the limits, or no angle is commanded.
    Within,
    /// Beyond a limit.
    Beyond,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableActivity {
    /// No command has arrived, or the last one has ended.
    Nothing,
    /// The command was refused, or found at the start and not executed.
    Refused,
    /// PAUSE.
    Pause,
    /// CALIBRATE.
    Calibrate,
    /// TURN.
    Turn,
}

impl TableActivity {
    /// The command in execution, after EXECUTE and ACCEPT.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Motor {
    /// The motor's controller has not taken the last order yet.
    Pending,
    /// The motor turns.
    Turning,
    /// The motor has just stopped.
    Settling,
    /// The motor is at rest.
    Standing,
    /// The motor's controller does not take the last order in time.
    Silent,
}

/// Whether counter and potentiometer agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Counter {
    /// Counter and potentiometer agree.
    Agrees,
    /// Counter and potentiometer differ: steps were lost, the counter was never set, or the potentiometer fails.
    Disagrees,
}

/// The place of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Turned {
    /// At the goal of the current step: at the + limit, with the counter set, parked, or at the angle.
    There,
    /// Anywhere else.
    Elsewhere,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The command.
    pub verb: TableVerb,
    /// Whether the commanded angle is within the limits.
    pub angle: TableAngle,
}

/// The state variables of a tick, for the tables of calibration and commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The command in execution.
    pub command: TableActivity,
    /// The state of the motor.
    pub motor: Motor,
    /// Whether counter and potentiometer agree.
    pub counter: Counter,
    /// Whether the table is at the goal of the current step.
    pub place: Turned,
    /// Time of the command.
    pub clock: Clock,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    pub request: Request,
    /// The state variables; EXECUTE and ACCEPT set `command`.
    pub situation: Situation,
    /// The angle by the counter, 0.1 degree; none if the potentiometer contradicts it.
    pub angle: Option<i32>,
}

/// The remaining decision after [`calibrate::CALIBRATE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TableDuty {
    /// No decision remains.
    Nothing,
    /// The table of the command decides.
    Command,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// No new order.
    Wait,
    /// The calibration begins: turn towards the + limit.
    SeekLimit,
    /// The table is at the + limit: set the counter to zero.
    SetCounter,
    /// Turn to -20.00.
    Park,
    /// The calibration has ended: the time limit of a waiting command begins.
    EndWait,
    /// Turn to the commanded angle.
    Turn,
    /// Stop.
    Stop,
    /// Report done.
    Finish,
    /// Stop; report an error. The angle is no longer known.
    Lose(Reason),
    /// Stop: the calibration has failed, but no command with it. The time limit of a waiting command begins.
    GiveUp,
}

commands! {
    pub fn of_command(TableVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, calibrate::CALIBRATE;
        Turn: goals::TURNED             => rest::rest then turn::turn;
        None | Pause: goals::REST       => rest::rest then pause::pause;
        Calibrate: goals::CALIBRATED    => rest::rest then pause::pause;
    }
}
