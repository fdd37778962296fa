//! Emulator of the workstation controller (HWSC) that plays a job.
//!
//! A job is a list of commands for Task, and actions of the workstation (vise, machining) between them. The first step
//! is PAUSE, as in the startup sequence (V.4.1). A command ends when Task answers its number with `finished`, an
//! action when the workstation is not busy. An unanswered command is sent once more. An error, a lost Task, a fault of
//! the workstation or a time limit end the job with a [`JobFailure`]; [`Hwsc::with_retries`] first sends PAUSE and the
//! same command again. The joystick box ends only a command: during an action the operator may move the robot.
//!
//! ```text
//!           PAUSE           command finished, or workstation idle
//!  Waiting -------> Sent ----------------------------------------> next step ... -> Over
//!                     |
//!                     +---- error, lost, fault, time limit -------------------------> Failed
//!                     |                                            no retry left
//!                     +---- error, a retry is left ----> PAUSE ----> Sent
//! ```
//!
//! An emergency ([`Workstation::emergency`]) ends the job, unless this or a later line is `** panel fault-reset`. A
//! command that fails meanwhile is recorded, and the job fails if no later repetition of it finishes. A command whose
//! line ends with `expect error` must fail.
//!
//! An action during a command precedes it in the job, and starts its number of ticks after the command is sent,
//! whichever step is then current. The job ends after all these actions. An operator can interrupt it ([`operator`]).
//!
//! The emulator uses only Task's mailboxes ([`Status`], [`Hwsc::mailgram`]), so it can run in another process, and a
//! real workstation controller can replace it.

mod operator;
mod outcome;
mod step;

use interfaces::{Header, HwsCommand, Reason, hws::HwsReport, station::Key};
use rcs_core::{
    handshake::{Commander, ECHO_LIMIT, Lower},
    name::Name16,
    tick::{TICK_MS, Tick},
};
use taskdata::load::job::{JobLine, Step, Workstation as Action};

use self::{operator::Intervention, step::DelayedAction};
pub use self::{
    operator::{OperatorError, PlaceInJob, WaitReason},
    outcome::{BegunStep, JobFailure, Outcome, Progress, Retry},
};
use super::status::{Status, TaskState};
use crate::fields::command_number;

pub trait Workstation {
    /// `line` is its line in the job, without the asterisks. The error states why it is impossible.
    fn begin(&mut self, action: &Action, line: &str) -> Result<(), String>;

    fn busy(&self) -> bool; // while an action is in progress

    /// True while an action has a time limit of its own, which replaces that of the job.
    fn has_own_time_limit(&self) -> bool {
        false
    }

    /// The fault of the workstation as a sentence, if any.
    fn fault(&self) -> Option<String>;

    /// The emergency that has stopped the robot, as a sentence, if any.
    fn emergency(&self) -> Option<String> {
        None
    }
}

/// Time limit of a step, ticks: five minutes, three times the longest step of the linkbar job.
pub const TIME_LIMIT: u64 = 5 * 60 * 1000 / TICK_MS;

/// Ticks from the PAUSE after an error to the repeated command, in which the cause may end. CHOSEN: 1 s.
pub const RETRY_TICKS: u64 = 1000 / TICK_MS;

#[derive(Clone, Debug)]
pub struct Hwsc {
    steps: Vec<JobLine>,
    current: usize, // 0: the first PAUSE; `n`: `steps[n - 1]`
    began: Option<Tick>,
    commander: Commander,
    command: HwsCommand,
    answer_ticks: u64, // time limit of an echo
    repeated: bool,    // the command has been sent twice
    to_send: bool,     // the command is not yet in the mailbox
    begun_steps: Vec<BegunStep>,
    entry: usize,               // current step in `begun_steps`
    failed: Vec<FailedCommand>, // while the job continued
    progress: Progress,
    time_limit: u64,
    later: Vec<DelayedAction>,
    retries: u32,  // per line, at most
    tried: u32,    // of the current line so far
    pausing: bool, // before the current step, or before its retry
    retried: Vec<Retry>,
    intervention: Intervention,
}

#[derive(Clone, Debug)]
struct FailedCommand {
    step: usize, // in `begun_steps`
    tick: Tick,
    reason: Reason,
}

impl Hwsc {
    #[must_use]
    pub fn new(steps: Vec<JobLine>, time_limit: u64) -> Self {
        let begun_steps = Vec::with_capacity(steps.len() + 1);
        Self {
            steps,
            current: 0,
            began: None,
            commander: Commander::default(),
            command: HwsCommand::default(),
            answer_ticks: ECHO_LIMIT,
            repeated: false,
            to_send: false,
            begun_steps,
            entry: 0,
            failed: Vec::new(),
            progress: Progress::Running,
            time_limit,
            later: Vec::new(),
            retries: 0,
            tried: 0,
            pausing: false,
            retried: Vec::new(),
            intervention: Intervention::default(),
        }
    }

    /// Repeats a failed command after a PAUSE, at most `retries` times per line; see [`Reason::remedy`].
    #[must_use]
    pub const fn with_retries(mut self, retries: u32) -> Self {
        self.retries = retries;
        self
    }

    #[must_use]
    pub fn retried(&self) -> &[Retry] {
        &self.retried
    }

    /// Sets the ticks until an unanswered command is repeated. The default is for one process; a network is slower.
    #[must_use]
    pub const fn with_answer_ticks(mut self, ticks: u64) -> Self {
        self.answer_ticks = ticks;
        self
    }

    pub fn insert(&mut self, line: JobLine) {
        self.steps.insert(self.current.min(self.steps.len()), line);
    }

    /// Returns false and changes nothing if no command is left.
    #[must_use]
    pub fn replace_command(&mut self, line: JobLine) -> bool {
        let coming = self.steps.iter_mut().skip(self.current);
        let command = coming.into_iter().find(|line| matches!(line.step, Step::Command(_)));
        command.map(|command| *command = line).is_some()
    }

    #[must_use]
    pub const fn command(&self) -> &HwsCommand {
        &self.command
    }

    /// Returns each command to write once.
    pub fn mailgram(&mut self) -> Option<&HwsCommand> {
        std::mem::take(&mut self.to_send).then_some(&self.command)
    }

    /// The last begun line (0 before the first), and the number of lines. Operators' commands are not counted.
    #[must_use]
    pub fn place(&self) -> (usize, usize) {
        let lines = self.steps.len();
        let begun = self.current.saturating_sub(usize::from(self.waits_before_line()));
        (begun.min(lines), lines)
    }

    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        &self.begun_steps
    }

    #[must_use]
    pub fn lines(&self) -> &[JobLine] {
        &self.steps
    }

    #[must_use]
    pub const fn progress(&self) -> &Progress {
        &self.progress
    }

    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len() + 1
    }

    /// A job has at least one step, the first PAUSE.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Call once per tick, after the controller: reads Task's status of `tick`, prepares the next command.
    pub fn step(&mut self, tick: Tick, task: &Status<'_>, workstation: &mut impl Workstation) -> &Progress {
        if self.progress != Progress::Running {
            return &self.progress;
        }
        self.commander.start(u32::from(task.echo));
        if self.is_waiting() {
            self.follow_operator(tick, task);
            return &self.progress;
        }
        let emergency = workstation.emergency();
        if let Some(emergency) = emergency.clone().filter(|_| !self.resets_emergency()) {
            self.fail(JobFailure::Emergency(emergency));
            return &self.progress;
        }
        if let Err(refused) = self.begin_later(tick, workstation) {
            self.fail(JobFailure::Workstation(refused));
            return &self.progress;
        }
        if self.current > self.steps.len() && !self.pausing {
            self.end(workstation);
            return &self.progress;
        }
        let ended = match self.began {
            None => Some(Ok(())),
            Some(began) => self.end_of_step(tick, began, task, workstation),
        };
        let waits = self.pausing && self.tried > 0;
        let early = waits && self.began.is_some_and(|began| tick.since(began) < RETRY_TICKS);
        match ended {
            None => {}
            Some(Ok(()) | Err(JobFailure::Command(_))) if early => {}
            Some(Err(JobFailure::Command(_) | JobFailure::Joystick)) if self.expects_error() => {
                self.finish(Outcome::FailedAsExpected);
                self.next(tick, workstation);
            }
            Some(Err(JobFailure::Command(reason))) if emergency.is_some() => {
                self.finish(Outcome::Failed);
                self.failed.push(FailedCommand { step: self.entry, tick, reason });
                self.next(tick, workstation);
            }
            Some(Err(failure)) => self.failed(tick, failure, workstation),
            Some(Ok(())) if self.expects_error() => self.fail(JobFailure::Unexpected),
            Some(Ok(())) if self.began.is_none() => self.begin(tick, workstation),
            Some(Ok(())) => {
                self.finish(Outcome::Finished);
                self.confirm(task.unconfirmed);
                if self.pausing {
                    self.begin(tick, workstation);
                } else {
                    self.next(tick, workstation);
                }
            }
        }
        &self.progress
    }

    #[must_use]
    pub fn resets_emergency(&self) -> bool {
        let reset = Step::Workstation(Action::Panel(Key::FaultReset));
        self.steps.iter().skip(self.current.saturating_sub(1)).any(|line| line.step == reset)
    }

    /// Handles a failure of the current step or the PAUSE before it: retries, or fails the job.
    fn failed(&mut self, tick: Tick, failure: JobFailure, workstation: &mut impl Workstation) {
        let JobFailure::Command(reason) = failure else { return self.fail(failure) };
        if self.pausing && self.tried > 0 {
            self.finish(Outcome::Failed); // the repeated command shows whether the failed PAUSE matters
            return self.begin(tick, workstation);
        }
        if self.tried >= self.retries || reason.remedy().is_some() {
            return self.fail(failure);
        }
        self.finish(Outcome::Failed);
        self.tried += 1;
        let line = self.begun_steps.get(self.entry).map_or_else(String::new, |step| step.text.clone());
        self.retried.push(Retry { tick, line, reason, number: self.tried, of: self.retries });
        self.pause(tick);
    }

    fn next(&mut self, tick: Tick, workstation: &mut impl Workstation) {
        self.current += 1;
        self.tried = 0;
        if !self.waits_here() {
            self.begin(tick, workstation);
        }
    }

    fn expects_error(&self) -> bool {
        !self.pausing
            && self
                .step_at(self.current)
                .is_some_and(|line| line.expects_error && matches!(line.step, Step::Command(_)))
    }

    fn end_of_step(
        &mut self,
        tick: Tick,
        began: Tick,
        task: &Status<'_>,
        workstation: &impl Workstation,
    ) -> Option<Result<(), JobFailure>> {
        let ticks = tick.since(began);
        self.took(tick);
        if let Some(fault) = workstation.fault() {
            return Some(Err(JobFailure::Workstation(fault)));
        }
        let lower = self.read(tick, task);
        let step = self.step_at(self.current).filter(|_| !self.pausing).map(|line| line.step);
        let commanding = matches!(step, None | Some(Step::Command(_)));
        if commanding && lower == Lower::Pending && task.verdict != 0 {
            return Some(Err(JobFailure::Refused(task.reason.to_owned())));
        }
        let finished = match (step, lower) {
            (_, Lower::Lost) if commanding && !self.repeated => {
                self.repeated = true;
                self.to_send = true;
                self.commander.sent = tick.next();
                return None;
            }
            (_, Lower::Lost) => return Some(Err(JobFailure::Lost)),
            (Some(Step::Workstation(Action::Wait { ticks: wanted })), _) => {
                return (ticks >= u64::from(wanted)).then_some(Ok(()));
            }
            (Some(Step::Workstation(Action::HandOver)), _) => return None,
            (Some(Step::Workstation(_) | Step::After { .. }), _) => !workstation.busy(),
            (_, Lower::Error) => return Some(Err(JobFailure::Command(task.code))),
            (_, Lower::Joystick) => return Some(Err(JobFailure::Joystick)),
            (_, Lower::Pending | Lower::Executing) => false,
            (_, Lower::Done) => true,
        };
        if finished {
            Some(Ok(()))
        } else if ticks >= self.time_limit && (commanding || !workstation.has_own_time_limit()) {
            Some(Err(JobFailure::TimeLimit(self.time_limit)))
        } else {
            None
        }
    }

    fn read(&self, tick: Tick, task: &Status<'_>) -> Lower {
        let last = self.commander.number; // two bytes in the mailbox
        let echo = if command_number(last) == task.echo { last } else { u32::from(task.echo) };
        let lost = task.task == TaskState::Lost;
        let header = Header {
            stamp: if lost { Tick::BEFORE_START } else { tick },
            republished: task.task == TaskState::Held,
            ..Header::default()
        };
        match self.commander.read(tick.next(), &header, echo, lower(task.report)) {
            Lower::Lost if !lost && tick.next().since(self.commander.sent) <= self.answer_ticks => {
                Lower::Pending
            }
            lower => lower,
        }
    }

    fn begin_later(&mut self, tick: Tick, workstation: &mut impl Workstation) -> Result<(), String> {
        for later in self.later.extract_if(.., |later| later.is_due(tick)) {
            workstation.begin(&later.action, &later.line)?;
        }
        Ok(())
    }

    /// Called after the last step; delayed actions may still be waiting.
    fn end(&mut self, workstation: &impl Workstation) {
        if self.later.is_empty() && !workstation.busy() {
            self.progress = self.unfinished().map_or(Progress::Over, Progress::Failed);
        }
    }

    fn unfinished(&self) -> Option<JobFailure> {
        self.failed.iter().find_map(|FailedCommand { step, tick, reason }| {
            let (failed, later) = self.begun_steps.get(*step..)?.split_first()?;
            let again =
                later.iter().any(|later| later.text == failed.text && later.outcome == Outcome::Finished);
            let (line, why) = (failed.text.clone(), reason.text());
            (!again).then_some(JobFailure::Unfinished { line, tick: *tick, why })
        })
    }

    fn step_at(&self, position: usize) -> Option<&JobLine> {
        self.steps.get(position.checked_sub(1)?)
    }

    /// The line `** workstation` has begun. Do not call [`Self::step`] until [`Self::take_back`] or [`Self::refuse`].
    #[must_use]
    pub fn is_handed_over(&self) -> bool {
        let hands_over = |line: &JobLine| line.step == Step::Workstation(Action::HandOver);
        let is_begun = self.progress == Progress::Running && !self.pausing && self.began.is_some();
        is_begun && self.step_at(self.current).is_some_and(hands_over)
    }

    /// After the workstation controller has disconnected: PAUSE, then the next line. `last` is its last command number.
    pub fn take_back(&mut self, tick: Tick, last: u32, commands: Vec<BegunStep>) {
        self.took(tick);
        self.finish(Outcome::Finished);
        self.begun_steps.extend(commands);
        self.current += 1;
        self.commander.number = last;
        self.pause(tick);
    }

    pub fn refuse(&mut self, tick: Tick, why: String) {
        self.took(tick);
        self.fail(JobFailure::Workstation(why));
    }
}

const PAUSE: &str = "PAUSE"; // first, and before every retry

#[must_use]
pub fn pause() -> HwsCommand {
    HwsCommand { command: Name16::clipped(PAUSE), ..HwsCommand::default() }
}

const fn lower(report: HwsReport) -> Lower {
    match report {
        HwsReport::Idle | HwsReport::Finished => Lower::Done,
        HwsReport::Executing => Lower::Executing,
        HwsReport::Error => Lower::Error,
        HwsReport::JoystickOn => Lower::Joystick,
    }
}

#[cfg(test)]
mod tests;
