use std::fmt;

use interfaces::{Reason, Unconfirmed, hws::HwsReport};
use rcs_core::tick::{TICK_MS, Tick};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Executing,
    Finished,
    Failed,
    FailedAsExpected, // as its line expects
    Interrupted,      // replaced by a command of the operator
}

impl Outcome {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Executing => HwsReport::Executing.text(),
            Self::Finished => HwsReport::Finished.text(),
            Self::Failed => HwsReport::Error.text(),
            Self::FailedAsExpected => "error as expected",
            Self::Interrupted => "interrupted",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct BegunStep {
    pub text: String,     // as in the job; `PAUSE` for the first step
    pub is_command: bool, // for Task, not an action of the workstation
    pub began: Tick,      // the tick after which the step was begun
    pub outcome: Outcome,
    pub unconfirmed: Unconfirmed, // the part of the goal of a finished command that no sensor confirms
    pub ticks: u64,               // until the end was detected
}

impl BegunStep {
    #[must_use]
    pub fn ending(&self) -> String {
        format!("{}{}", self.outcome.text(), self.unconfirmed.suffix())
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JobFailure {
    #[error("{}", .0.text())]
    Command(Reason),
    #[error("Task does not answer")]
    Lost, // Task does not answer
    #[error("the controller refuses the command: {0}")]
    Refused(String), // by the controller
    #[error("the joystick box is on")]
    Joystick, // the operator moves the robot
    #[error("finished, but its line expects an error")]
    Unexpected, // finished despite `expect error`
    #[error("{why}; the command has not finished since (`expect error` marks a line that has to fail)")]
    Unfinished { line: String, tick: Tick, why: &'static str },
    #[error("not finished within {} s", .0 * TICK_MS / 1000)]
    TimeLimit(u64), // ticks
    #[error("{0}")]
    Workstation(String), // impossible action, or a fault
    #[error("{0}")]
    Emergency(String), // the robot is stopped
    #[error("{0}")]
    Commander(String), // the workstation controller is disconnected
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Progress {
    Running,
    Over,
    Failed(JobFailure),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Retry {
    pub tick: Tick, // when the failure was detected
    pub line: String,
    pub reason: Reason,
    pub number: u32, // from 1, per line
    pub of: u32,     // at most, per line
}

impl fmt::Display for Retry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, reason, number, of, .. } = self;
        write!(
            f,
            "`{line}` failed: {}; PAUSE and the same command again, retry {number} of {of}",
            reason.text()
        )
    }
}

impl JobFailure {
    /// The operator's action before the job can continue. `None` if not needed, or if the failure's text contains it.
    #[must_use]
    pub const fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Command(reason) => reason.remedy(),
            Self::Joystick => Reason::JoystickOn.remedy(),
            Self::Lost => Reason::NeighbourLost.remedy(),
            Self::Emergency(_) => Reason::LinkOff.remedy(),
            Self::Refused(_) => Reason::UnknownCommand.remedy(),
            Self::TimeLimit(_)
            | Self::Workstation(_)
            | Self::Commander(_)
            | Self::Unexpected
            | Self::Unfinished { .. } => None,
        }
    }
}
