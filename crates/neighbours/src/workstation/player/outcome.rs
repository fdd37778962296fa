//! Outcome of a job: its steps, its retries, and why it failed.

use std::fmt;

use interfaces::{Reason, hws::HwsReport};
use rcs_core::tick::{TICK_MS, Tick};

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is executed.
    Executing,
    /// It has finished.
    Finished,
    /// It failed.
    Failed,
    /// It failed, as its line says.
    FailedAsExpected,
    /// An operator's command took its place.
    Interrupted,
}

impl Outcome {
    /// The word in reports.
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

/// A step that was begun.
#[derive(Clone, Debug, PartialEq)]
pub struct BegunStep {
    /// The line as it stands in the job; `PAUSE` for the first one.
    pub text: String,
    /// It was a command for Task, not an action of the workstation.
    pub is_command: bool,
    /// The tick after which it was begun.
    pub began: Tick,
    /// How it ended.
    pub outcome: Outcome,
    /// Ticks from the one in which it was begun to the one in which its end was seen.
    pub ticks: u64,
}

/// Why a job ended before its last step.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JobFailure {
    /// Task reports an error.
    #[error("{}", .0.text())]
    Command(Reason),
    /// Task does not answer.
    #[error("Task does not answer")]
    Lost,
    /// The mailbox of the command is refused.
    #[error("the controller refuses the command: {0}")]
    Refused(String),
    /// The joystick box is on: the operator moves the robot.
    #[error("the joystick box is on")]
    Joystick,
    /// A command has finished that should have failed.
    #[error("finished, but its line expects an error")]
    Unexpected,
    /// A command has failed, and was not sent again with success.
    #[error("{why}; the command has not finished since (`expect error` marks a line that has to fail)")]
    Unfinished {
        /// Its line.
        line: String,
        /// When it ended.
        tick: Tick,
        /// Why it failed.
        why: &'static str,
    },
    /// A step took too long.
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

/// Progress of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Progress {
    /// It is played.
    Running,
    /// All steps are finished.
    Over,
    /// It ended in failure.
    Failed(JobFailure),
}

/// A command that had failed and was sent again, after a PAUSE.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Retry {
    /// The tick in which its failure was seen.
    pub tick: Tick,
    /// The line of the job.
    pub line: String,
    /// Why it had failed.
    pub reason: Reason,
    /// Which retry of the line this is, from 1.
    pub number: u32,
    /// Retries that a line has.
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
    /// What a person has to do before the job can go on, as far as it is known; `None` if PAUSE and the same
    /// command may be enough, or if the failure says it itself.
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
