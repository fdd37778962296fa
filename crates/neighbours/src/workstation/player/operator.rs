//! Interventions of an operator in a job: stop it between two lines, command Task meanwhile, and let it go on (IV.3).
//!
//! ```text
//!            wait: at the end of the line; a command: at once;
//!            a failure while an operator is there
//!   plays ────────────────────────────────────────────────────► waits ──┐ commands of the operator
//!     ▲                                                           │ ▲───┘
//!     └──── go: PAUSE, then the line that was interrupted ◄───────┤
//!     └──── skip: PAUSE, then the line behind it ◄────────────────┘
//! ```
//!
//! There is one sequence of command numbers: commands of the operator and of the job take theirs from the same
//! [`Commander`](rcs_core::handshake::Commander). While an operator is connected, a command that fails, a joystick box
//! that is on, an emergency, and a refused action do not end the job: it waits.

use std::fmt;

use interfaces::HwsCommand;
use rcs_core::{handshake::Lower, tick::Tick};
use taskdata::load::job::{JobLine, Step};

use super::{BegunStep, Hwsc, JobFailure, Outcome, Progress};
use crate::workstation::status::Status;

/// State of an operator's intervention.
#[derive(Debug, Default)]
pub(super) struct Intervention {
    /// An operator is connected.
    attended: bool,
    state: State,
    /// Why the job waits, if it was not reported yet.
    news: Option<WaitReason>,
}

/// Why a job waits for an operator.
#[derive(Clone, Debug, PartialEq)]
pub enum WaitReason {
    /// The operator commands the robot.
    Commanded,
    /// The operator has asked for it.
    Asked,
    /// A line has failed.
    Failed(JobFailure),
}

impl fmt::Display for WaitReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Commanded => f.write_str("an operator commands: the job waits for `job go`"),
            Self::Asked => f.write_str("the job waits for `job go`, as requested"),
            Self::Failed(failure) => write!(f, "{failure}: the job waits for `job go`"),
        }
    }
}

/// Whether the job plays.
#[derive(Debug, Default)]
enum State {
    /// It does.
    #[default]
    Plays,
    /// It waits when the present line has ended.
    Asked,
    /// It waits.
    Waits {
        /// Why the line has failed, if it has.
        failure: Option<JobFailure>,
        /// The line has not been begun.
        before_line: bool,
        /// The operator's command that is executed: which one of the steps that were begun.
        command: Option<usize>,
    },
}

/// Why an operator's request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OperatorError {
    /// The job plays.
    #[error(
        "the job plays already; `job wait` stops it at the end of its line, any command stops it at once"
    )]
    Plays,
    /// A command of the operator is executed.
    #[error("{0} is still executed: wait for its end, or send PAUSE")]
    Executes(String),
    /// There is nothing to skip.
    #[error("the job has no line left to skip; `job go` ends it")]
    NoLine,
    /// The job has ended.
    #[error("the job has ended")]
    Ended,
}

impl Hwsc {
    /// The job waits for an operator before its first line.
    #[must_use]
    pub fn on_stand_by(mut self) -> Self {
        self.intervention.state = State::Asked;
        self
    }

    /// An operator has connected, or the last one has disconnected. Then a job that waits because a line has failed
    /// ends with that failure.
    pub fn attend(&mut self, is_there: bool) {
        self.intervention.attended = is_there;
        if let (false, State::Waits { failure, .. }) = (is_there, &mut self.intervention.state)
            && let Some(failure) = failure.take()
        {
            self.progress = Progress::Failed(failure);
        }
    }

    /// The job waits for an operator.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        matches!(self.intervention.state, State::Waits { .. })
    }

    /// Why the job has begun to wait; each reason is given once.
    pub fn operator_news(&mut self) -> Option<WaitReason> {
        self.intervention.news.take()
    }

    /// Make the job wait when the present line has ended, or before its first line.
    ///
    /// # Errors
    /// [`OperatorError::Ended`].
    pub fn wait_for_operator(&mut self) -> Result<(), OperatorError> {
        self.not_ended()?;
        if matches!(self.intervention.state, State::Plays) {
            self.intervention.state = State::Asked;
        }
        Ok(())
    }

    /// The job goes on with the line that was interrupted or has failed: PAUSE comes first, as after every
    /// interruption. An action of the workstation that has not ended is not begun again.
    ///
    /// # Errors
    /// [`OperatorError`].
    pub fn go_on(&mut self, tick: Tick) -> Result<(), OperatorError> {
        self.resume(tick, false)
    }

    /// The job goes on with the line behind the one that was interrupted or has failed. The caller must make sure that
    /// the cell is as if that line had finished.
    ///
    /// # Errors
    /// [`OperatorError`].
    pub fn skip(&mut self, tick: Tick) -> Result<(), OperatorError> {
        self.resume(tick, true)
    }

    /// Play other lines instead of the rest of the job, which waits: PAUSE, then the first of them. Waiting actions and
    /// noted failures of the job are dropped, too.
    ///
    /// # Errors
    /// [`OperatorError`].
    pub fn play(&mut self, tick: Tick, steps: Vec<JobLine>) -> Result<(), OperatorError> {
        self.not_ended()?;
        let State::Waits { failure, before_line, command } = &self.intervention.state else {
            return Err(OperatorError::Plays);
        };
        if let Some(step) = command.and_then(|entry| self.begun_steps.get(entry)) {
            return Err(OperatorError::Executes(step.text.clone()));
        }
        let (has_failed, before_line) = (failure.is_some(), *before_line);
        if !has_failed && !before_line && !self.is_commanding() {
            self.finish(Outcome::Interrupted);
        }
        let kept = if before_line { self.current.saturating_sub(1) } else { self.current };
        self.steps.truncate(kept);
        self.current = self.steps.len().saturating_add(1);
        self.steps.extend(steps);
        self.later.clear();
        self.failed.clear();
        self.intervention.state = State::Plays;
        self.tried = 0;
        self.pause(tick);
        Ok(())
    }

    /// An emulator without a job, for commands of an operator instead of a workstation controller, whose last command
    /// had this number.
    #[must_use]
    pub fn stand_alone(last: u32, time_limit: u64) -> Self {
        let mut hwsc = Self::new(Vec::new(), time_limit);
        // The last command may not be echoed yet: its number is known, and the next one follows it.
        (hwsc.commander.number, hwsc.commander.started) = (last, true);
        hwsc.attend(true);
        hwsc.wait_without_job();
        hwsc
    }

    /// The played job is over, or has failed: the emulator waits for an operator.
    pub fn wait_without_job(&mut self) {
        self.steps.clear();
        self.later.clear();
        self.failed.clear();
        (self.current, self.began, self.pausing) = (0, None, false);
        self.progress = Progress::Running;
        self.intervention.state = State::Waits { failure: None, before_line: true, command: None };
    }

    /// Send a command of the operator; the job waits from now on.
    ///
    /// # Errors
    /// [`OperatorError::Ended`].
    pub fn command_by_operator(
        &mut self,
        tick: Tick,
        text: String,
        command: HwsCommand,
    ) -> Result<u32, OperatorError> {
        self.not_ended()?;
        let entry = self.begun_steps.len();
        match &mut self.intervention.state {
            State::Waits { command, .. } => {
                let before = command.replace(entry);
                self.end_operators(tick, before, Outcome::Interrupted);
            }
            State::Plays | State::Asked => {
                let is_command = self.is_commanding();
                let before_line = self.began.is_none();
                if is_command && !before_line {
                    self.took(tick);
                    self.finish(Outcome::Interrupted);
                }
                self.intervention.state = State::Waits { failure: None, before_line, command: Some(entry) };
                self.intervention.news = Some(WaitReason::Commanded);
            }
        }
        self.begun_steps.push(BegunStep {
            text,
            is_command: true,
            began: tick,
            outcome: Outcome::Executing,
            ticks: 0,
        });
        let number = self.commander.send(tick.next());
        self.command = HwsCommand { number, ..command };
        (self.to_send, self.repeated) = (true, false);
        Ok(number)
    }

    const fn not_ended(&self) -> Result<(), OperatorError> {
        match self.progress {
            Progress::Running => Ok(()),
            Progress::Over | Progress::Failed(_) => Err(OperatorError::Ended),
        }
    }

    /// A command of the job is executed, or the PAUSE before its line.
    fn is_commanding(&self) -> bool {
        let line = self.step_at(self.current).map(|line| line.step);
        self.pausing || self.current == 0 || matches!(line, Some(Step::Command(_)))
    }

    /// At the end of a line: the job waits if it was asked to.
    pub(super) fn waits_here(&mut self) -> bool {
        if !matches!(self.intervention.state, State::Asked) {
            return false;
        }
        self.intervention.state = State::Waits { failure: None, before_line: true, command: None };
        self.intervention.news = Some(WaitReason::Asked);
        true
    }

    /// The present line has failed: true if the job waits for an operator instead of ending.
    pub(super) fn waits_for_operator(&mut self, failure: &JobFailure) -> bool {
        let can_be_mended = match failure {
            JobFailure::Command(_)
            | JobFailure::Joystick
            | JobFailure::Unexpected
            | JobFailure::TimeLimit(_)
            | JobFailure::Workstation(_)
            | JobFailure::Emergency(_) => true,
            JobFailure::Lost
            | JobFailure::Refused(_)
            | JobFailure::Unfinished { .. }
            | JobFailure::Commander(_) => false,
        };
        let waits = can_be_mended && self.intervention.attended;
        if waits {
            let failure = failure.clone();
            self.intervention.news = Some(WaitReason::Failed(failure.clone()));
            self.intervention.state =
                State::Waits { failure: Some(failure), before_line: false, command: None };
        }
        waits
    }

    /// Once a tick while the job waits: follow the operator's command.
    pub(super) fn follow_operator(&mut self, tick: Tick, task: &Status<'_>) {
        let State::Waits { command: Some(entry), .. } = self.intervention.state else { return };
        let outcome = match self.read(tick, task) {
            Lower::Pending if task.verdict == 0 => return,
            Lower::Executing => return,
            Lower::Lost if !self.repeated => {
                (self.repeated, self.to_send) = (true, true);
                self.commander.sent = tick.next();
                return;
            }
            Lower::Done => Outcome::Finished,
            Lower::Pending | Lower::Lost | Lower::Error | Lower::Joystick => Outcome::Failed,
        };
        if let State::Waits { command, .. } = &mut self.intervention.state {
            *command = None;
        }
        self.end_operators(tick, Some(entry), outcome);
    }

    /// A command of the operator has ended.
    fn end_operators(&mut self, tick: Tick, entry: Option<usize>, outcome: Outcome) {
        if let Some(step) = entry.and_then(|entry| self.begun_steps.get_mut(entry)) {
            step.ticks = tick.since(step.began);
            step.outcome = outcome;
        }
    }

    fn resume(&mut self, tick: Tick, skips: bool) -> Result<(), OperatorError> {
        self.not_ended()?;
        let State::Waits { failure, before_line, command } = &self.intervention.state else {
            if matches!(self.intervention.state, State::Asked) && !skips {
                self.intervention.state = State::Plays;
                return Ok(());
            }
            return Err(OperatorError::Plays);
        };
        if let Some(step) = command.and_then(|entry| self.begun_steps.get(entry)) {
            return Err(OperatorError::Executes(step.text.clone()));
        }
        let (failed, before_line) = (failure.is_some(), *before_line);
        let is_last = self.current > self.steps.len();
        if skips && is_last {
            return Err(OperatorError::NoLine);
        }
        let line_goes_on = !failed && !before_line && !self.is_commanding();
        self.intervention.state = State::Plays;
        if skips && self.current == 0 {
            self.current = 1;
        } else if skips {
            if line_goes_on {
                self.finish(Outcome::Interrupted);
            }
            self.current += 1;
        } else if is_last || line_goes_on {
            return Ok(());
        }
        self.tried = 0;
        self.pause(tick);
        Ok(())
    }
}
