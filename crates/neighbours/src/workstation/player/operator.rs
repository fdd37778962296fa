//! Interventions of an operator in a job: stop it between two lines, command Task, and continue it (IV.3).
//!
//! ```text
//!            wait: at the end of the line; a command: at once;
//!            a failure while an operator is connected
//!   plays ────────────────────────────────────────────────────► waits ──┐ commands of the operator
//!     ▲                                                           │ ▲───┘
//!     └──── go: PAUSE, then the interrupted line ◄───────────────┤
//!     └──── skip: PAUSE, then the line after it ◄────────────────┘
//! ```
//!
//! The operator's commands and those of the job share the numbers of the
//! [`Commander`](rcs_core::handshake::Commander). While an operator is connected, the job waits instead of ending if a
//! command fails, the joystick box is on, an emergency occurs, or the workstation refuses an action.

mod named_line;

use std::fmt;

use interfaces::{HwsCommand, Unconfirmed};
use rcs_core::{handshake::Lower, tick::Tick};
use taskdata::load::job::{JobLine, Step};

use super::{
    BegunStep, Hwsc, JobFailure, Outcome, Progress,
    step::{is_action_of, later},
};
use crate::workstation::status::Status;

#[derive(Clone, Debug, Default)]
pub(super) struct Intervention {
    attended: bool,
    state: State,
    news: Option<WaitReason>, // until it is reported
    asks_line: bool,          // the present line of a resumed job is not known
    /// A question that a person must see before the line begins again, once.
    question: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum WaitReason {
    Commanded,
    Asked,   // by the operator
    Resumed, // the run has started with the knowledge of an earlier one
    /// The same, and the line of the job is not known; the last recorded one.
    ResumedWithoutLine(u32),
    Failed(JobFailure),
}

impl fmt::Display for WaitReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Commanded => f.write_str("an operator commands: the job waits for `job go`"),
            Self::Asked => f.write_str("the job waits for `job go`, as requested"),
            Self::Resumed => f.write_str(
                "the run is resumed: check what the controller knows, then `job go` sends PAUSE and the interrupted \
                 command",
            ),
            Self::ResumedWithoutLine(last) => write!(
                f,
                "the run is resumed, and the line of the job is not known; the last recorded one is {last}: check what \
                 the controller knows, name the line with `resume line N`, then `job go` sends PAUSE and this line"
            ),
            Self::Failed(failure) => {
                write!(f, "{failure}: the job waits for `job go`")?;
                failure.remedy().map_or(Ok(()), |remedy| write!(f, "; to do: {remedy}"))
            }
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaceInJob {
    pub line: u32,      // the present line, from 1; 0 for the PAUSE before the first
    pub is_begun: bool, // false if the present line has not begun
    /// Lines `** after` before the present one whose actions have not started, one bit each, the nearest first.
    pub delayed: u16,
    pub is_asked: bool, // the line is not known: a person must name it
}

#[derive(Clone, Debug, Default)]
enum State {
    #[default]
    Plays,
    Asked, // will wait at the end of the current line
    Waits {
        failure: Option<JobFailure>, // of the line
        before_line: bool,           // waits before a new line
        command: Option<usize>,      // the operator's, in progress, among the begun steps
    },
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OperatorError {
    #[error(
        "the job plays already; `job wait` stops it at the end of its line, any command stops it at once"
    )]
    Plays,
    #[error("{0} is still executed: wait for its end, or send PAUSE")]
    Executes(String), // a command in progress
    #[error("the job has no line left to skip; `job go` ends it")]
    NoLine, // none left to skip
    #[error("the job has ended")]
    Ended,
    #[error("the line of the job is not known, the last recorded one is {0}: name it with `resume line N`")]
    LineNotKnown(usize),
    #[error("the job has lines 1 to {last}; found {found}")]
    NoSuchLine { found: usize, last: usize },
    #[error("the line of the job is known: `job go` repeats it, `job skip` continues after it")]
    LineKnown,
    #[error("{0}: look, then `job go` again begins the line, or `job skip` continues after it")]
    Unknown(String), // whether a line of the job has begun
}

impl Hwsc {
    #[must_use]
    pub fn on_stand_by(mut self) -> Self {
        self.intervention.state = State::Asked;
        self
    }

    /// The position in the job, for an emulator that continues it later.
    #[must_use]
    pub fn place_in_job(&self) -> PlaceInJob {
        let waits = |line: &&JobLine| self.later.iter().any(|later| is_action_of(later, line));
        let after = |line: &&JobLine| matches!(line.step, Step::After { .. });
        let begun = self.steps.iter().take(self.current.saturating_sub(1)).rev().filter(after);
        let delayed = begun.take(16).enumerate().filter(|(_, line)| waits(line));
        PlaceInJob {
            line: u32::try_from(self.current).unwrap_or(u32::MAX),
            is_begun: self.began.is_some() && !self.waits_before_line(),
            delayed: delayed.fold(0, |all, (place, _)| all | 1 << place),
            is_asked: self.intervention.asks_line,
        }
    }

    /// Makes the job wait for an operator at the position of an earlier emulator, in a run that begins after `tick`.
    /// Delayed actions of that position start with the next command.
    #[must_use]
    pub fn resumed_at(mut self, place: PlaceInJob, tick: Tick) -> Self {
        self.current =
            usize::try_from(place.line).unwrap_or(usize::MAX).min(self.steps.len().saturating_add(1));
        self.began = place.is_begun.then_some(tick);
        let after = |line: &&JobLine| matches!(line.step, Step::After { .. });
        let begun = self.steps.iter().take(self.current.saturating_sub(1)).rev().filter(after).take(16);
        let delayed = begun.enumerate().filter(|(at, _)| place.delayed & 1 << at != 0);
        self.later = delayed.filter_map(|(_, line)| later(line)).collect();
        self.later.reverse();
        let before_line = !place.is_begun;
        self.intervention.state = State::Waits { failure: None, before_line, command: None };
        self.intervention.asks_line = place.is_asked;
        self.intervention.news = Some(if place.is_asked {
            WaitReason::ResumedWithoutLine(place.line)
        } else {
            WaitReason::Resumed
        });
        self
    }

    /// Asks a person this question at the first `job go`.
    #[must_use]
    pub fn with_question(mut self, question: Option<String>) -> Self {
        self.intervention.question = question;
        self
    }

    /// When the operator disconnects, a job that waits because of a failed line ends with that failure.
    pub fn attend(&mut self, is_there: bool) {
        self.intervention.attended = is_there;
        if let (false, State::Waits { failure, .. }) = (is_there, &mut self.intervention.state)
            && let Some(failure) = failure.take()
        {
            self.progress = Progress::Failed(failure);
            self.intervention.state = State::Plays; // a job that has ended does not wait
        }
    }

    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        matches!(self.intervention.state, State::Waits { .. })
    }

    #[must_use]
    pub const fn waits_idle(&self) -> bool {
        matches!(self.intervention.state, State::Waits { command: None, .. })
    }

    pub(super) const fn waits_before_line(&self) -> bool {
        matches!(self.intervention.state, State::Waits { before_line: true, .. })
    }

    /// Returns each reason once.
    pub fn operator_news(&mut self) -> Option<WaitReason> {
        self.intervention.news.take()
    }

    /// Makes the job wait after the current line, or before the first. Fails with [`OperatorError::Ended`].
    pub fn wait_for_operator(&mut self) -> Result<(), OperatorError> {
        self.not_ended()?;
        if matches!(self.intervention.state, State::Plays) {
            self.intervention.state = State::Asked;
        }
        Ok(())
    }

    /// Repeats the interrupted or failed line after a PAUSE. An action in progress is not started again.
    pub fn go_on(&mut self, tick: Tick) -> Result<(), OperatorError> {
        self.resume(tick, false)
    }

    /// Continues after the interrupted or failed line. The caller must bring the cell into the state after it.
    pub fn skip(&mut self, tick: Tick) -> Result<(), OperatorError> {
        self.resume(tick, true)
    }

    /// Replaces the rest of a waiting job: PAUSE, then the new lines. Discards delayed actions and recorded failures.
    pub fn play(&mut self, tick: Tick, steps: Vec<JobLine>) -> Result<(), OperatorError> {
        self.not_ended()?;
        let State::Waits { failure, before_line, command } = &self.intervention.state else {
            return Err(OperatorError::Plays);
        };
        let (command, has_failed, before_line) = (*command, failure.is_some(), *before_line);
        self.replace_pause(tick, command)?;
        self.intervention.asks_line = false;
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

    /// An emulator for an operator's commands, without a job. `last` is the workstation controller's last number.
    #[must_use]
    pub fn stand_alone(last: u32, time_limit: u64) -> Self {
        let mut hwsc = Self::new(Vec::new(), time_limit);
        // Task may not yet have echoed the last command. The next command has the number after it.
        (hwsc.commander.number, hwsc.commander.started) = (last, true);
        hwsc.attend(true);
        hwsc.wait_without_job();
        hwsc
    }

    pub fn wait_without_job(&mut self) {
        self.steps.clear();
        self.later.clear();
        self.failed.clear();
        (self.current, self.began, self.pausing) = (0, None, false);
        self.progress = Progress::Running;
        self.intervention.state = State::Waits { failure: None, before_line: true, command: None };
    }

    /// The job waits from now on. Fails with [`OperatorError::Ended`].
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
            unconfirmed: Unconfirmed::None,
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

    fn is_commanding(&self) -> bool {
        let line = self.step_at(self.current).map(|line| line.step);
        self.pausing || self.current == 0 || matches!(line, Some(Step::Command(_)))
    }

    /// Called at the end of a line: true if the operator has requested a wait.
    pub(super) fn waits_here(&mut self) -> bool {
        if !matches!(self.intervention.state, State::Asked) {
            return false;
        }
        self.intervention.state = State::Waits { failure: None, before_line: true, command: None };
        self.intervention.news = Some(WaitReason::Asked);
        true
    }

    /// Called after a failed line: true if the job waits instead of ending.
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

    fn end_operators(&mut self, tick: Tick, entry: Option<usize>, outcome: Outcome) {
        if let Some(step) = entry.and_then(|entry| self.begun_steps.get_mut(entry)) {
            step.ticks = tick.since(step.began);
            step.outcome = outcome;
        }
    }

    fn not_executed(&self, command: Option<usize>) -> Result<(), OperatorError> {
        let executes = command.and_then(|entry| self.begun_steps.get(entry));
        executes.map_or(Ok(()), |step| Err(OperatorError::Executes(step.text.clone())))
    }

    /// The job's PAUSE may replace only a PAUSE of the operator.
    fn replace_pause(&mut self, tick: Tick, command: Option<usize>) -> Result<(), OperatorError> {
        if command.is_some() && self.command.command == super::pause().command {
            self.end_operators(tick, command, Outcome::Interrupted);
            return Ok(());
        }
        self.not_executed(command)
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
        if self.intervention.asks_line {
            return Err(OperatorError::LineNotKnown(self.current));
        }
        let (command, failed, before_line) = (*command, failure.is_some(), *before_line);
        if let Some(question) = self.intervention.question.take().filter(|_| !skips) {
            return Err(OperatorError::Unknown(question));
        }
        let is_last = self.current > self.steps.len();
        if skips && is_last {
            return Err(OperatorError::NoLine);
        }
        let line_goes_on = !failed && !before_line && !self.is_commanding();
        let sends_pause = skips || !(is_last || line_goes_on);
        if sends_pause {
            self.replace_pause(tick, command)?;
        } else {
            self.not_executed(command)?;
        }
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
