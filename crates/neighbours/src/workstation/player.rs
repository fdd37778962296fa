//! The workstation controller (HWSC), emulated: plays a job.
//!
//! A job is a list of steps: commands for Task, and actions of the workstation itself (vise, machining)
//! between them. The emulator first sends PAUSE, as the startup sequence does (V.4.1), and then one step
//! after the other: a command is over when Task answers its number with `finished`, an action when the
//! workstation is no longer busy. A command that is not answered is sent once more, as it was. An error, a lost Task, a fault of
//! the workstation or a step that takes too long end the job with a [`JobFailure`]. While the workstation does something, the operator may have the
//! robot: a joystick box that is on ends only a command.
//!
//! ```text
//!           PAUSE           command finished, or workstation idle
//!  Waiting -------> Sent ----------------------------------------> next step ... -> Over
//!                     |
//!                     +---- error, lost, fault, time limit -------------------------> Failed
//! ```
//!
//! An emergency ([`Workstation::emergency`]) ends the job at once, unless the job itself resets it further down, by a line with
//! `** panel fault-reset`: then a command that comes to nothing meanwhile is noted as failed, and the job goes on. It must
//! finish when the job sends it again, or the job has failed.
//!
//! A command whose line ends with `expect error` must fail: the job goes on when it has, and ends when it finishes.
//!
//! Actions that are to happen while the robot executes a command stand in the job before that command. They
//! are kept until it is sent, and begun when their time comes, whatever step is going on then. A job is not
//! over before they are.
//!
//! The emulator knows Task by its mailboxes only: it reads a [`Status`], and writes a command ([`Hwsc::mailgram`]). So it can run in
//! the controller's process or in one of its own, and whoever speaks the same mailboxes can take its place.

use rcs_core::{
    handshake::{Commander, ECHO_LIMIT, Lower},
    interface::{Header, HwsCommand, Reason, hws::HwsReport},
    name::Name16,
    tick::{TICK_MS, Tick},
};
use taskdata::load::job::{JobLine, Panel, Step, Workstation as Action};

use super::status::{Status, TaskState};
use crate::fields::command_number;

/// What the workstation can do by itself.
pub trait Workstation {
    /// Begin an action; `line` is how the job says it, without the asterisks.
    ///
    /// # Errors
    /// A sentence, if the workstation cannot do it.
    fn begin(&mut self, action: &Action, line: &str) -> Result<(), String>;

    /// True while an action goes on.
    fn busy(&self) -> bool;

    /// What is wrong with the workstation, in a sentence; `None` if nothing is.
    fn fault(&self) -> Option<String>;

    /// The emergency that has stopped the robot, in a sentence; `None` while there is none.
    fn emergency(&self) -> Option<String> {
        None
    }
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is going on.
    Executing,
    /// As it should.
    Finished,
    /// It failed.
    Failed,
    /// It failed, as its line says.
    FailedAsExpected,
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
    /// The operator has the robot.
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
    /// Whoever commands from another process is lost.
    #[error("{0}")]
    Commander(String),
}

/// Where the job stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Going on.
    Running,
    /// All steps are finished.
    Over,
    /// It ended in failure.
    Failed(JobFailure),
}

/// Ticks that a step may take: five minutes, three times the longest step of the linkbar.
pub const TIME_LIMIT: u64 = 5 * 60 * 1000 / TICK_MS;

/// The emulator of the workstation controller.
#[derive(Debug)]
pub struct Hwsc {
    steps: Vec<JobLine>,
    /// The step that is going on: 0 is the first PAUSE, `n` is `steps[n - 1]`.
    current: usize,
    began: Option<Tick>,
    commander: Commander,
    command: HwsCommand,
    /// Ticks in which a command must be echoed.
    answer_ticks: u64,
    /// The command has been sent twice.
    repeated: bool,
    /// The command is to be sent.
    to_send: bool,
    begun_steps: Vec<BegunStep>,
    /// Commands that have failed while the job went on.
    failed: Vec<FailedCommand>,
    progress: Progress,
    time_limit: u64,
    later: Vec<Later>,
}

/// A command that has failed while the job went on.
#[derive(Debug)]
struct FailedCommand {
    /// Which one of the steps that were begun.
    step: usize,
    tick: Tick,
    reason: Reason,
}

/// An action that waits for its time.
#[derive(Debug)]
struct Later {
    /// Ticks from the command.
    ticks: u64,
    action: Action,
    /// The line without what says when.
    line: String,
    /// When the command was sent; `None` as long as it was not.
    since: Option<Tick>,
}

impl Later {
    fn is_due(&self, tick: Tick) -> bool {
        self.since.is_some_and(|since| tick.since(since) >= self.ticks)
    }
}

impl Hwsc {
    /// An emulator that will play `steps`, each within `time_limit` ticks.
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
            failed: Vec::new(),
            progress: Progress::Running,
            time_limit,
            later: Vec::new(),
        }
    }

    /// Wait so many ticks for the echo of a command before it is sent again, instead of the three of a neighbour in the same
    /// process: a network takes its time.
    #[must_use]
    pub const fn with_answer_ticks(mut self, ticks: u64) -> Self {
        self.answer_ticks = ticks;
        self
    }

    /// The command that was sent last.
    #[must_use]
    pub const fn command(&self) -> &HwsCommand {
        &self.command
    }

    /// The command that is to be written into the mailbox now, if there is one: each is given once.
    pub fn mailgram(&mut self) -> Option<&HwsCommand> {
        std::mem::take(&mut self.to_send).then_some(&self.command)
    }

    /// All steps that were begun, the first PAUSE included.
    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        &self.begun_steps
    }

    /// Where the job stands.
    #[must_use]
    pub const fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Number of steps, the first PAUSE included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len() + 1
    }

    /// A job has one step at least.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Once a tick, after the controller: read what Task wrote in `tick`, write what it will read in the next
    /// one.
    pub fn step(&mut self, tick: Tick, task: &Status<'_>, workstation: &mut impl Workstation) -> &Progress {
        if self.progress != Progress::Running {
            return &self.progress;
        }
        self.commander.start(u32::from(task.echo));
        let emergency = workstation.emergency();
        if let Some(emergency) = emergency.clone().filter(|_| !self.resets()) {
            self.fail(JobFailure::Emergency(emergency));
            return &self.progress;
        }
        if let Err(refused) = self.begin_later(tick, workstation) {
            self.fail(JobFailure::Workstation(refused));
            return &self.progress;
        }
        if self.current > self.steps.len() {
            self.end(workstation);
            return &self.progress;
        }
        let ended = match self.began {
            None => Some(Ok(())),
            Some(began) => self.end_of_step(tick, began, task, workstation),
        };
        match ended {
            None => {}
            Some(Err(JobFailure::Command(_) | JobFailure::Joystick)) if self.expects_error() => {
                self.finish(Outcome::FailedAsExpected);
                self.next(tick, workstation);
            }
            Some(Err(JobFailure::Command(reason))) if emergency.is_some() => {
                self.finish(Outcome::Failed);
                self.failed.push(FailedCommand { step: self.begun_steps.len() - 1, tick, reason });
                self.next(tick, workstation);
            }
            Some(Err(failure)) => self.fail(failure),
            Some(Ok(())) if self.expects_error() => self.fail(JobFailure::Unexpected),
            Some(Ok(())) => {
                if self.began.is_some() {
                    self.finish(Outcome::Finished);
                    self.next(tick, workstation);
                } else {
                    self.begin(tick, workstation);
                }
            }
        }
        &self.progress
    }

    /// The step that is going on, or one behind it, resets a fault of the robot controller.
    fn resets(&self) -> bool {
        let reset = Step::Workstation(Action::Panel(Panel::FaultReset));
        self.steps.iter().skip(self.current.saturating_sub(1)).any(|line| line.step == reset)
    }

    fn next(&mut self, tick: Tick, workstation: &mut impl Workstation) {
        self.current += 1;
        self.begin(tick, workstation);
    }

    /// The command that is going on has to fail.
    fn expects_error(&self) -> bool {
        self.step_at(self.current).is_some_and(|line| line.expects_error)
    }

    /// How the step that is going on ended; `None` while it goes on.
    fn end_of_step(
        &mut self,
        tick: Tick,
        began: Tick,
        task: &Status<'_>,
        workstation: &impl Workstation,
    ) -> Option<Result<(), JobFailure>> {
        let ticks = tick.since(began);
        if let Some(step) = self.begun_steps.last_mut() {
            step.ticks = ticks;
        }
        if let Some(fault) = workstation.fault() {
            return Some(Err(JobFailure::Workstation(fault)));
        }
        let lower = self.read(tick, task);
        let step = self.step_at(self.current).map(|line| line.step);
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
            (Some(Step::Workstation(_) | Step::After { .. }), _) => !workstation.busy(),
            (_, Lower::Error) => return Some(Err(JobFailure::Command(task.code))),
            (_, Lower::Joystick) => return Some(Err(JobFailure::Joystick)),
            (_, Lower::Pending | Lower::Executing) => false,
            (_, Lower::Done) => true,
        };
        if finished {
            Some(Ok(()))
        } else if ticks >= self.time_limit {
            Some(Err(JobFailure::TimeLimit(self.time_limit)))
        } else {
            None
        }
    }

    /// What Task makes of the last command.
    fn read(&self, tick: Tick, task: &Status<'_>) -> Lower {
        // The mailbox has the lower part of the number.
        let last = self.commander.number;
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

    /// Begin the actions whose time has come.
    fn begin_later(&mut self, tick: Tick, workstation: &mut impl Workstation) -> Result<(), String> {
        for later in self.later.extract_if(.., |later| later.is_due(tick)) {
            workstation.begin(&later.action, &later.line)?;
        }
        Ok(())
    }

    /// After the last step: the last actions may still wait for their time.
    fn end(&mut self, workstation: &impl Workstation) {
        if self.later.is_empty() && !workstation.busy() {
            self.progress = self.unfinished().map_or(Progress::Over, Progress::Failed);
        }
    }

    /// The first command whose last attempt has failed.
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

    /// Begin the current step; after the last one the job is over.
    fn begin(&mut self, tick: Tick, workstation: &mut impl Workstation) {
        self.began = Some(tick);
        let (text, command, refused) = match self.step_at(self.current) {
            None if self.current == 0 => {
                let pause = HwsCommand { command: Name16::clipped("PAUSE"), ..HwsCommand::default() };
                ("PAUSE".to_owned(), Some(pause), None)
            }
            None => {
                self.end(workstation);
                return;
            }
            Some(JobLine { step: Step::Command(command), text, .. }) => (text.clone(), Some(*command), None),
            Some(JobLine { step: Step::Workstation(Action::Wait { .. }), text, .. }) => {
                (text.clone(), None, None)
            }
            Some(JobLine { step: Step::Workstation(action), text, .. }) => {
                (text.clone(), None, workstation.begin(action, spoken(text)).err())
            }
            Some(JobLine { step: Step::After { ticks, action }, text, .. }) => {
                let line = after(spoken(text)).to_owned();
                let later = Later { ticks: u64::from(*ticks), action: *action, line, since: None };
                let text = text.clone();
                self.later.push(later);
                (text, None, None)
            }
        };
        self.begun_steps.push(BegunStep {
            text,
            is_command: command.is_some(),
            began: tick,
            outcome: Outcome::Executing,
            ticks: 0,
        });
        if let Some(command) = command {
            self.later.iter_mut().for_each(|later| later.since = later.since.or(Some(tick)));
            self.command = HwsCommand { number: self.commander.send(tick.next()), ..command };
            (self.to_send, self.repeated) = (true, false);
        }
        if let Some(refused) = refused {
            self.fail(JobFailure::Workstation(refused));
        }
    }

    fn fail(&mut self, failure: JobFailure) {
        self.finish(Outcome::Failed);
        self.progress = Progress::Failed(failure);
    }

    fn finish(&mut self, outcome: Outcome) {
        if let Some(step) = self.begun_steps.last_mut() {
            step.outcome = outcome;
        }
    }
}

/// A line for the workstation without the asterisks in front of it.
fn spoken(line: &str) -> &str {
    line.trim_start().trim_start_matches('*').trim_start()
}

/// A line without the `after` and the number in front of it.
fn after(line: &str) -> &str {
    let words = |line| str::split_once(line, char::is_whitespace).map_or("", |(_, rest)| rest.trim_start());
    words(words(line))
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
