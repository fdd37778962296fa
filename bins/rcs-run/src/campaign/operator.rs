//! Plays the job after an interruption: first the operator's recovery procedure, then the rest of the job.
//!
//! The procedure: PAUSE, and the same command again, up to a number of tries; then the job continues with its next
//! line. `** after` lines that have begun do not begin again.
//!
//! ```text
//!   interruption ──► [a command of the operator] ──► PAUSE ──► the same command ──► next lines of the job ──► over
//!                                                      ▲             │ error
//!                                                      └─────────────┘ tries left; else stranded
//! ```

mod lines;

use std::fmt;

use field::Why;
use interfaces::{HwsCommand, Reason, hws::HwsReport};
use neighbours::workstation::{
    Status, TaskState,
    player::{Workstation as _, pause},
};
use rcs_core::{name::Name16, tick::Tick};
use taskdata::load::job::{JobLine, Step, Workstation as Action};

use closed_loop::{Commander, workstation::SimulatedWorkstation};

/// Ticks within which the robot must come to rest after the joystick box is off.
const REST_LIMIT: u64 = 25;
/// Time limit of a command, ticks: five minutes, as in a run.
const TIME_LIMIT: u64 = neighbours::workstation::player::TIME_LIMIT;
/// Ticks from the PAUSE to the look at a machine that may have begun: longer than its cycle of 3 s.
const LOOK: u64 = 125;
const ECHO_LIMIT: u64 = 25; // ticks within which Task must echo a command

#[derive(Clone, Debug, PartialEq)]
enum Activity {
    Own(NextStep),
    Pause,
    Command,
    Failed,
    Action,
    /// A line of the workstation begins again.
    Begin,
    Over,
    /// The command failed, and no try is left.
    Stranded,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NextStep {
    Recovery,
    /// The interrupted command, without recovery.
    SameCommand,
    Nothing,
}

/// The operator's first action when a command was interrupted or has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Recovery {
    /// PAUSE, and the same command again
    Pause,
    /// The same command again, without a PAUSE
    Same,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    pub tick: Tick,
    /// Position in the job: 0 for the first PAUSE.
    pub line: usize,
    /// The command, or the line of the workstation that has failed.
    pub command: String,
    /// True for a line of the job, false for a command of the recovery.
    pub of_job: bool,
    /// Empty for `finished`, else why the command failed.
    pub failure: String,
}

#[derive(Debug)]
struct DelayedAction {
    due: Tick,
    action: Action,
    text: String,
}

pub struct Operator<'f> {
    lines: &'f [JobLine],
    current: usize, // position in the job: 0 is the first PAUSE, `n` is `lines[n - 1]`
    doing: Activity,
    began: Tick, // tick in which the command or the action began
    number: u32,
    replaced: Option<u32>, // number of the job's command that a command of the operator replaces
    /// True if the job's command finished before Task accepted the operator's; it is then not sent again.
    has_finished: bool,
    /// Devices have failed to execute the current line of the workstation. True if they may have executed it.
    failed_line: Option<bool>,
    outgoing: Option<HwsCommand>,
    /// True while the interruption continues: the operator waits.
    pub is_waiting: bool,
    recovery: Recovery,
    tries: u32,
    tried: u32,
    remedied: bool,            // the remedy of the reason was applied to the present line
    second_pause: Option<u64>, // ticks from the first repeated command to its PAUSE; `None` for no PAUSE
    later: Vec<DelayedAction>,
    delayed: Vec<(u64, Action, String)>,
    ended: Vec<Ended>,
    reason: String,
    has_remedied: bool, // a remedy was applied since the start
}

impl<'f> Operator<'f> {
    /// An operator at line `current` of a job, begun at `began`; `last` is Task's present command.
    #[must_use]
    pub fn new(lines: &'f [JobLine], current: usize, began: Tick, last: &HwsCommand, tries: u32) -> Self {
        let mut operator = Self {
            lines,
            current,
            doing: Activity::Over,
            began,
            number: last.number,
            replaced: None,
            has_finished: false,
            failed_line: None,
            outgoing: None,
            is_waiting: false,
            recovery: Recovery::Pause,
            tries,
            tried: 0,
            remedied: false,
            second_pause: None,
            later: Vec::new(),
            delayed: Vec::new(),
            ended: Vec::new(),
            reason: String::new(),
            has_remedied: false,
        };
        operator.doing =
            if operator.command_at(current).is_some() { Activity::Command } else { Activity::Action };
        operator
    }

    #[must_use]
    pub const fn with_recovery(mut self, recovery: Recovery) -> Self {
        self.recovery = recovery;
        self
    }

    /// Record an interruption: all tries are available again. A second PAUSE follows after `second_pause` ticks.
    pub const fn interrupt(&mut self, second_pause: Option<u64>) {
        (self.tried, self.has_finished, self.remedied) = (0, false, false);
        self.second_pause = second_pause;
    }

    /// Give up the present command of the job: PAUSE and the next line follow. Other lines continue.
    pub fn give_up(&mut self) {
        self.has_finished |= self.command_at(self.current).is_some();
    }

    /// A person has applied the remedy of a failed command: all tries are available again, and PAUSE is next.
    pub fn retry(&mut self) {
        self.tried = 0;
        self.doing = Activity::Failed;
    }

    #[must_use]
    pub const fn has_remedied(&self) -> bool {
        self.has_remedied
    }

    #[must_use]
    pub const fn current(&self) -> usize {
        self.current
    }

    /// The command of a line; line 0 is PAUSE.
    #[must_use]
    pub fn command_at(&self, line: usize) -> Option<HwsCommand> {
        match line.checked_sub(1) {
            None => Some(pause()),
            Some(at) => match self.lines.get(at)?.step {
                Step::Command(command) => Some(command),
                _ => None,
            },
        }
    }

    /// The last command of the job before the current line.
    #[must_use]
    pub fn command_before(&self) -> Option<HwsCommand> {
        (0..self.current).rev().find_map(|line| self.command_at(line))
    }

    pub fn recover(&mut self, tick: Tick) {
        match self.recovery {
            Recovery::Pause => self.pause(tick),
            Recovery::Same => self.same(tick),
        }
    }

    pub fn pause(&mut self, tick: Tick) {
        self.replace(Activity::Pause);
        self.send(tick, &pause());
    }

    /// Send a command that is not one of the job.
    pub fn interject(&mut self, tick: Tick, command: &HwsCommand, then: NextStep) {
        self.has_finished = false;
        self.replace(Activity::Own(then));
        self.send(tick, command);
    }

    /// The operator's next command replaces the job's, which may finish before Task accepts it.
    fn replace(&mut self, doing: Activity) {
        self.replaced = (self.doing == Activity::Command).then_some(self.number);
        self.doing = doing;
    }

    /// True if the operator has sent another motion instead of the command of the job.
    #[must_use]
    pub const fn has_replaced(&self) -> bool {
        matches!(self.doing, Activity::Own(NextStep::SameCommand))
    }

    /// The state after tick `now` on which the operator's next action depends. Commands are numbered from `newest`.
    /// After [`Self::waits_until`], the state excludes the start of the command.
    pub fn state(&self, now: Tick, newest: u32) -> impl fmt::Debug {
        let is_echoed = now.since(self.began) > ECHO_LIMIT.max(REST_LIMIT);
        let is_timed = self.doing != Activity::Command || !is_echoed || self.second_pause.is_some();
        let began = is_timed.then_some(self.began);
        let since = |number: u32| number.wrapping_sub(newest);
        let outgoing = self.outgoing.map(|command| HwsCommand { number: since(command.number), ..command });
        let place = (self.current, &self.doing, began, since(self.number), outgoing);
        let replaced = (self.replaced.map(since), self.has_finished, self.is_waiting);
        let tried = (self.tried, self.remedied);
        let tries = (self.recovery, self.tries, tried, self.second_pause, &self.reason);
        (place, replaced, tries, &self.later, &self.delayed)
    }

    /// True if the operator still waits in this tick for the end of the current command.
    pub fn waits_until(&self, tick: Tick) -> bool {
        tick.since(self.began) <= TIME_LIMIT
    }

    pub fn ended(&mut self) -> Vec<Ended> {
        std::mem::take(&mut self.ended)
    }

    #[must_use]
    pub fn is_over(&self) -> bool {
        self.doing == Activity::Over && self.later.is_empty()
    }

    /// The reason why the job does not continue, if any.
    #[must_use]
    pub fn stranded(&self) -> Option<&str> {
        (self.doing == Activity::Stranded).then_some(self.reason.as_str())
    }

    fn send(&mut self, tick: Tick, command: &HwsCommand) {
        // A number takes two bytes in the mailbox, and 0 means none.
        self.number = if self.number >= 0xFFFF { 1 } else { self.number + 1 };
        self.outgoing = Some(HwsCommand { number: self.number, ..*command });
        self.began = tick;
    }

    /// The result of the last command; `None` while Task executes it.
    fn end(&self, tick: Tick, status: &Status<'_>) -> Option<Result<(), String>> {
        let ticks = tick.since(self.began);
        if status.task == TaskState::Held {
            return None;
        }
        if u32::from(status.echo) != self.number {
            if status.verdict != 0 && ticks > 1 {
                return Some(Err(format!("the controller refuses the command: {}", status.reason)));
            }
            return (ticks > ECHO_LIMIT).then(|| Err("Task does not answer".to_owned()));
        }
        match status.report {
            HwsReport::Finished | HwsReport::Idle => Some(Ok(())),
            HwsReport::Error => Some(Err(status.code.text().to_owned())),
            // Task reports this until the stopped processes below it are at rest.
            HwsReport::JoystickOn => (ticks > REST_LIMIT).then(|| Err("the joystick box is on".to_owned())),
            HwsReport::Executing => (ticks > TIME_LIMIT).then(|| Err("not finished within 300 s".to_owned())),
        }
    }

    fn note(&mut self, tick: Tick, command: &HwsCommand, of_job: bool, end: &Result<(), String>) {
        self.ended.push(Ended {
            tick,
            line: self.current,
            command: command.to_string(),
            of_job,
            failure: end.as_ref().err().cloned().unwrap_or_default(),
        });
    }

    /// Repeat the current line, or the line that was being executed.
    fn same(&mut self, tick: Tick) {
        match self.command_at(self.current) {
            Some(command) => {
                self.tried += 1;
                self.doing = Activity::Command;
                self.send(tick, &command);
            }
            None if self.failed_line.is_some() => {
                self.tried += 1;
                self.doing = Activity::Begin;
            }
            None => self.doing = Activity::Action,
        }
    }

    fn fail_recovery(&mut self, reason: String) {
        self.reason = reason;
        self.doing = Activity::Stranded;
    }

    fn failed(&mut self, tick: Tick, reason: String) {
        if self.tried >= self.tries {
            match self.remedy(&reason) {
                Some(command) => {
                    (self.tried, self.remedied, self.has_remedied) = (0, true, true);
                    self.interject(tick, &command, NextStep::Recovery);
                }
                None => self.fail_recovery(reason),
            }
        } else if self.is_waiting {
            self.reason = reason;
            self.doing = Activity::Failed;
        } else {
            self.recover(tick);
        }
    }

    /// The command that the remedy of a reason names (docs/reasons.md), once per line of the job.
    fn remedy(&self, reason: &str) -> Option<HwsCommand> {
        let insert = self.command_at(self.current).filter(|_| !self.remedied)?;
        let is_meant = reason == Reason::ForceUncalibrated.text();
        is_meant.then(|| HwsCommand {
            command: Name16::clipped("REMOVE-TOOL"),
            destination: None,
            destination_sector: None,
            end_at: insert.destination,
            end_at_sector: insert.destination_sector,
            ..insert
        })
    }
}

impl Commander for Operator<'_> {
    fn step(
        &mut self,
        tick: Tick,
        status: &Status<'_>,
        workstation: &mut SimulatedWorkstation,
    ) -> Option<HwsCommand> {
        for later in self.later.extract_if(.., |later| later.due <= tick) {
            // An interruption can delay an action so that the cell refuses it.
            let _ = workstation.begin(&later.action, &later.text);
        }
        if let Some(fault) = workstation.fault() {
            let reason = format!("workstation: {fault}");
            let why = workstation.line_failure().map(|failure| &failure.why);
            if let (Some(why), Activity::Action) = (why, &self.doing) {
                self.failed_line = Some(matches!(why, Why::Unknown(_)));
                self.note_line(tick, &reason);
                self.failed(tick, reason);
            } else {
                self.fail_recovery(reason);
            }
        }
        let echo = u32::from(status.echo);
        self.has_finished |= self.replaced == Some(echo) && status.report == HwsReport::Finished;
        self.replaced = self.replaced.filter(|_| echo != self.number);
        match self.doing.clone() {
            Activity::Over | Activity::Stranded => {}
            Activity::Failed if self.is_waiting => {}
            Activity::Failed => self.recover(tick),
            Activity::Own(then) => {
                if let Some(end) = self.end(tick, status) {
                    self.note(
                        tick,
                        &HwsCommand { command: status.command, ..HwsCommand::default() },
                        false,
                        &end,
                    );
                    match then {
                        NextStep::Recovery => self.recover(tick),
                        NextStep::SameCommand if self.has_finished => self.next(tick, workstation),
                        NextStep::SameCommand => self.same(tick),
                        NextStep::Nothing => self.doing = Activity::Over,
                    }
                }
            }
            Activity::Pause => {
                if let Some(end) = self.end(tick, status) {
                    self.note(tick, &pause(), false, &end);
                    if self.has_finished {
                        self.next(tick, workstation);
                    } else {
                        self.same(tick);
                    }
                }
            }
            Activity::Command => self.follow(tick, status, workstation),
            Activity::Begin if self.failed_line == Some(true) => {
                // A person looks, after the device has had time to end what it may have begun.
                if self.is_machined(workstation) {
                    self.next(tick, workstation);
                } else if tick.since(self.began) >= LOOK {
                    self.begin(workstation);
                }
            }
            Activity::Begin => self.begin(workstation),
            Activity::Action => {
                if self.is_done(tick, workstation) {
                    self.next(tick, workstation);
                }
            }
        }
        self.outgoing.take()
    }
}

impl Operator<'_> {
    /// Advance a command of the job by one tick.
    fn follow(&mut self, tick: Tick, status: &Status<'_>, workstation: &mut SimulatedWorkstation) {
        let paused =
            self.tried == 1 && self.second_pause.is_some_and(|ticks| tick.since(self.began) >= ticks);
        let Some(end) = self.end(tick, status) else {
            if paused {
                self.second_pause = None;
                self.tried = 0;
                self.pause(tick);
            }
            return;
        };
        let command = self.command_at(self.current).unwrap_or_default();
        self.note(tick, &command, true, &end);
        match end {
            Ok(()) => self.next(tick, workstation),
            Err(reason) => self.failed(tick, reason),
        }
    }
}

/// An operator at joystick box or panel without a command: Task continues its command, and may finish it.
pub struct Watching<'o, 'f>(pub &'o mut Operator<'f>);

impl Commander for Watching<'_, '_> {
    fn step(&mut self, _: Tick, status: &Status<'_>, _: &mut SimulatedWorkstation) -> Option<HwsCommand> {
        let Self(operator) = self;
        let is_current = operator.doing == Activity::Command && u32::from(status.echo) == operator.number;
        operator.has_finished |= is_current && status.report == HwsReport::Finished;
        None
    }
}
