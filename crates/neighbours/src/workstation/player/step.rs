//! Start and end of steps, and delayed actions.

use interfaces::{HwsCommand, Unconfirmed};
use rcs_core::tick::Tick;
use taskdata::load::job::{JobLine, Step, Workstation as Action};

use super::{BegunStep, Hwsc, JobFailure, Outcome, PAUSE, Progress, Workstation, pause};

#[derive(Clone, Debug)]
pub struct DelayedAction {
    pub ticks: u64, // from the command to the action
    pub action: Action,
    pub line: String,        // without `after` and the ticks
    pub since: Option<Tick>, // when the command was sent
}

impl DelayedAction {
    pub fn is_due(&self, tick: Tick) -> bool {
        self.since.is_some_and(|since| tick.since(since) >= self.ticks)
    }
}

impl Hwsc {
    pub(super) fn took(&mut self, tick: Tick) {
        if let (Some(step), Some(began)) = (self.begun_steps.get_mut(self.entry), self.began) {
            step.ticks = tick.since(began);
        }
    }

    pub(super) fn pause(&mut self, tick: Tick) {
        self.pausing = true;
        self.send(tick, PAUSE.to_owned(), pause());
    }

    /// Begins the current step. After the last step the job is over.
    pub(super) fn begin(&mut self, tick: Tick, workstation: &mut impl Workstation) {
        self.began = Some(tick);
        self.pausing = false;
        let Some(JobLine { step, text, .. }) = self.step_at(self.current).cloned() else {
            if self.current == 0 {
                self.send(tick, PAUSE.to_owned(), pause());
            } else {
                self.end(workstation);
            }
            return;
        };
        let refused = match step {
            Step::Command(command) => return self.send(tick, text, command),
            Step::Workstation(Action::Wait { .. }) => None,
            Step::Workstation(action) => workstation.begin(&action, without_prefix(&text)).err(),
            Step::After { .. } => {
                self.later.extend(self.step_at(self.current).and_then(later));
                None
            }
        };
        self.begun(tick, text, false);
        if let Some(refused) = refused {
            self.fail(JobFailure::Workstation(refused));
        }
    }

    pub(super) fn send(&mut self, tick: Tick, text: String, command: HwsCommand) {
        self.began = Some(tick);
        self.begun(tick, text, true);
        self.later.iter_mut().for_each(|later| later.since = later.since.or(Some(tick)));
        self.command = HwsCommand { number: self.commander.send(tick.next()), ..command };
        (self.to_send, self.repeated) = (true, false);
    }

    pub(super) fn begun(&mut self, tick: Tick, text: String, is_command: bool) {
        self.entry = self.begun_steps.len();
        self.begun_steps.push(BegunStep {
            text,
            is_command,
            began: tick,
            outcome: Outcome::Executing,
            unconfirmed: Unconfirmed::None,
            ticks: 0,
        });
    }

    pub(super) fn fail(&mut self, failure: JobFailure) {
        self.finish(Outcome::Failed);
        if !self.waits_for_operator(&failure) {
            self.progress = Progress::Failed(failure);
        }
    }

    pub(super) fn confirm(&mut self, unconfirmed: Unconfirmed) {
        if let Some(step) = self.begun_steps.get_mut(self.entry).filter(|step| step.is_command) {
            step.unconfirmed = unconfirmed;
        }
    }

    pub(super) fn finish(&mut self, outcome: Outcome) {
        if let Some(step) = self.begun_steps.get_mut(self.entry) {
            step.outcome = outcome;
        }
    }
}

/// The delayed action of a line `** after`; `None` for other lines.
pub(super) fn later(line: &JobLine) -> Option<DelayedAction> {
    let Step::After { ticks, action } = line.step else { return None };
    let line = after(without_prefix(&line.text)).to_owned();
    Some(DelayedAction { ticks: u64::from(ticks), action, line, since: None })
}

pub(super) fn is_action_of(of: &DelayedAction, line: &JobLine) -> bool {
    later(line).is_some_and(|later| (later.ticks, &later.line) == (of.ticks, &of.line))
}

fn without_prefix(line: &str) -> &str {
    line.trim_start().trim_start_matches('*').trim_start()
}

fn after(line: &str) -> &str {
    let words = |line| str::split_once(line, char::is_whitespace).map_or("", |(_, rest)| rest.trim_start());
    words(words(line))
}
