//! Outcome of a job: its steps, its retries, and the reason of its failure.

use std::fmt;

use interfaces::{Reason, Unconfirmed, hws::HwsReport};
use rcs_core::tick::{TICK_MS, Tick};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Executing,
    Finished,
    Failed,
    /// The command failed, as its line expects.
    FailedAsExpected,
    /// A command of the operator has replaced the step.
    Interrupted,
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
    /// The line as written in the job; `PAUSE` for the first step.
    pub text: String,
    /// True for a command for Task, false for an action of the workstation.
    pub is_command: bool,
    /// The tick after which the step was begun.
    pub began: Tick,
    pub outcome: Outcome,
    /// Part of the command's goal that no sensor confirms, if it has finished.
    pub unconfirmed: Unconfirmed,
    /// Ticks from the start of the step to the detection of its end.
    pub ticks: u64,
}

impl BegunStep {
    /// The ending of the step: the word of its outcome, and its unconfirmed goals.
    #[must_use]
    pub fn ending(&self) -> String {
        format!("{}{}", self.outcome.text(), self.unconfirmed.suffix())
    }
}

/// The reason why a job ended before its last step.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JobFailure {
    #[error("{}", .0.text())]
    Command(Reason),
    /// Task does not answer.
    #[error("Task does not answer")]
    Lost,
    /// The controller refuses the mailbox of the command.
    #[error("the controller refuses the command: {0}")]
    Refused(String),
    /// The joystick box is on: the operator moves the robot.
    #[error("the joystick box is on")]
    Joystick,
    /// A command has finished although its line expects an error.
    #[error("finished, but its line expects an error")]
    Unexpected,
    /// A command has failed, and none of its repetitions has finished.
    #[error("{why}; the command has not finished since (`expect error` marks a line that has to fail)")]
    Unfinished { line: String, tick: Tick, why: &'static str },
    /// A step has exceeded its time limit, ticks.
    #[error("not finished within {} s", .0 * TICK_MS / 1000)]
    TimeLimit(u64),
    /// The workstation cannot do an action, or has a fault.
    #[error("{0}")]
    Workstation(String),
    /// An emergency has stopped the robot.
    #[error("{0}")]
    Emergency(String),
    /// The connection to the workstation controller is lost.
    #[error("{0}")]
    Commander(String),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Progress {
    Running,
    Over,
    Failed(JobFailure),
}

/// A failed command that was repeated after a PAUSE.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Retry {
    /// The tick in which the failure was detected.
    pub tick: Tick,
    pub line: String,
    pub reason: Reason,
    /// Number of this retry of the line, from 1.
    pub number: u32,
    /// Greatest number of retries per line.
    pub of: u32,
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
    /// The operator's action before the job can continue, if known. `None` if PAUSE and the same command may be
    /// enough, or if the text of the failure already contains it.
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
