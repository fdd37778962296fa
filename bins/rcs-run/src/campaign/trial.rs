//! Interrupts one branch, and lets an operator follow the recovery procedure until the branch can be judged.
//!
//! [`judgement`] decides when, and gives the verdict.

mod judgement;

use std::sync::Arc;

use closed_loop::failure;
use closed_loop::truth::Confirmation;
use interfaces::HwsCommand;
use levels::ladder::{Ladder, ProcessId};
use neighbours::workstation::player::pause;
use rcs_core::{digest::Digest, name::Name16, tick::Tick};

use super::{
    branch::{Branch, Facility},
    disturbance::{DisturbanceKind, Follow},
    harm::HarmMonitor,
    interruption::Kind,
    invariants::Invariants,
    known::{End, Known, Passed, Rest},
    motion::Motion,
    operator::{NextStep, Operator, Recovery, Watching},
    outage::{self, OutageMonitor},
    parent::Parent,
    script::Script,
    series::Series,
    verdict::{BranchResult, Verdict},
};
use crate::rcs_run::error::Error;

const MISSPELT: &str = "NOWHERRE"; // a location that is not in the task data

/// When a branch is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Until {
    /// When the command after the interrupted one has ended
    Next,
    /// At the end of the job
    Job,
    /// At rest: the last interruption is a stop, and no command follows it
    Rest,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Procedure {
    pub recovery: Recovery,
    /// Number of times that the interrupted command is repeated.
    pub tries: u32,
    pub until: Until,
}

pub trait Observer {
    fn tick(&mut self, branch: &Branch<'_>);
    fn say(&mut self, tick: Tick, text: &str);
}

pub struct NoObserver;

impl Observer for NoObserver {
    fn tick(&mut self, _: &Branch<'_>) {}
    fn say(&mut self, _: Tick, _: &str) {}
}

struct Trial<'f, 'p> {
    parent: &'p Parent,
    branch: Branch<'f>,
    operator: Operator<'f>,
    monitor: HarmMonitor,
    outages: OutageMonitor,
    invariants: Invariants,
    series: &'p Series,
    interruption: usize, // index of the present or last interruption
    over: Option<Tick>,  // tick in which the present or last interruption ended
    /// True while the job is played: the interrupted command continues, or the operator recovers it.
    following: bool,
    until: Until,
    begun_at: Tick,
    line: usize,
    goal: usize,                // the line at whose end the branch is judged
    ended: Vec<(Tick, String)>, // the commands that have ended, with their ticks
    path: Vec<Passed>,          // the states in which it was compared with others
    mismatch: Option<(String, String)>,
    tears: bool, // true if the operator has moved the robot away with a part that the vise also holds
    motion: Option<Motion>, // motion since the last interruption, if the branch is judged at rest
    untrue: Vec<Confirmation>, // the confirmations since the fork that are not true
    judged_before: u64, // number of confirmations that were judged before the fork
    /// Number of confirmations judged after the known state in which the branch has ended.
    judged_behind: u64,
    has_failed_line: bool, // true if devices have not executed a line of the workstation
    remedied: bool,        // true if the remedy was applied and the disturbance undone
}

/// Interrupt a fork after its last tick, and judge the branch. It stops at a known state. If it is done, its states
/// become known.
pub fn run(
    facility: &Facility,
    parent: &Parent,
    fork: &Branch<'_>,
    series: &Series,
    procedure: Procedure,
    known: Option<&Known>,
    observer: &mut impl Observer,
) -> Result<BranchResult, Error> {
    let branch = fork.clone();
    let at = branch.at();
    let (line, began) = parent.line_at(at);
    let operator = Operator::new(&facility.job.steps, line, began, branch.closed.command(), procedure.tries)
        .with_recovery(procedure.recovery);
    let (monitor, invariants) = (HarmMonitor::from_now(&branch), Invariants::from_now(&branch));
    let (doing, judged_before) = (present(&branch), branch.judged());
    let trial = Trial {
        parent,
        branch,
        operator,
        monitor,
        outages: OutageMonitor::default(),
        invariants,
        series,
        interruption: 0,
        over: None,
        following: false,
        until: procedure.until,
        begun_at: at,
        line,
        goal: usize::MAX,
        ended: Vec::new(),
        path: Vec::new(),
        mismatch: None,
        tears: false,
        motion: None,
        untrue: Vec::new(),
        judged_before,
        judged_behind: 0,
        has_failed_line: false,
        remedied: false,
    };
    trial.play(doing, known, observer)
}

fn present(branch: &Branch<'_>) -> Vec<String> {
    let (hws, memory) = (&branch.closed.external().hws, branch.memory());
    let lines = ProcessId::ALL.iter().zip(Ladder::processes()).filter_map(|(id, process)| {
        let command = failure::command(*id, hws, memory);
        let header = memory.header(*id);
        let (table, row) = header.decided.map_or(("no table", 0), |decided| {
            (process.table(decided.table).map_or("no table", |table| table.name), decided.row)
        });
        let said = memory.said(*id).report;
        let step = header.step.map_or_else(String::new, |step| format!(", {step}"));
        (!command.is_empty())
            .then(|| format!("{}: {command}: {said} ({table} row {row}{step})", process.name))
    });
    lines.collect()
}

impl Trial<'_, '_> {
    fn play(
        mut self,
        doing: Vec<String>,
        known: Option<&Known>,
        observer: &mut impl Observer,
    ) -> Result<BranchResult, Error> {
        let mut script = self.begin(observer);
        loop {
            // A stop continues: the later steps of its script, which would release it, are skipped.
            if self.motion.as_ref().is_none_or(Motion::has_just_begun)
                && let Some(refused) = script.step(&mut self.branch)
            {
                observer.say(self.branch.at(), &format!("the cell refuses: {refused}"));
            }
            let over = script.is_over();
            self.operator.is_waiting = !over;
            if over && !self.following && self.motion.is_none() {
                self.following = true;
                self.follow(observer);
            }
            if self.following {
                self.branch.step(&mut self.operator);
            } else {
                self.branch.step(&mut Watching(&mut self.operator));
            }
            for confirmation in &self.branch.untrue {
                observer.say(self.branch.at(), &confirmation.to_string());
            }
            self.untrue.extend(self.branch.untrue.iter().cloned());
            let at_box = self.is_of_a_person(over);
            self.tears |= self.takes_from_vise();
            self.monitor.look(&self.branch, at_box || (self.tears && self.operator.has_replaced()));
            if self.branch.field().is_some() {
                for broken in self.outages.look(&self.branch) {
                    self.monitor.note(self.branch.at(), broken);
                }
                for (tick, text) in outage::told(&self.branch) {
                    observer.say(tick, &text);
                }
            }
            if let Some(broken) = self.invariants.broken(&self.branch, !over) {
                self.monitor.note(self.branch.at(), broken);
            }
            observer.tick(&self.branch);
            if let Some(motion) = &mut self.motion {
                motion.look(&self.branch);
            }
            if let Some(remedy) = self.remedy(&script) {
                observer.say(self.branch.at(), "a person undoes the disturbance");
                script = remedy;
                self.operator.retry();
                self.following = false;
                continue;
            }
            if let Some(verdict) = self.verdict(observer) {
                let end = Arc::new(self.end()?);
                if let (Verdict::Done, true, Some(known)) = (verdict, self.untrue.is_empty(), known) {
                    known.add(&self.path, &end, self.judged());
                }
                return Ok(self.result(verdict, &end, doing));
            }
            if over
                && let Some(known) = known.filter(|_| self.is_comparable())
                && let Some(end) = self.known_end(known)?
            {
                known.add(&self.path, &end, self.judged());
                return Ok(self.result(Verdict::Done, &end, doing));
            }
            if over && self.motion.is_none() {
                let now = self.branch.at();
                let since = now.since(*self.over.get_or_insert(now));
                if self.next().is_some_and(|after| since >= after) {
                    self.interruption += 1;
                    script = self.begin(observer);
                }
            }
        }
    }

    /// The interruption is over: the operator continues.
    fn follow(&mut self, observer: &mut impl Observer) {
        let at = self.branch.at();
        let then = self.kind().disturbance().filter(|_| !self.remedied).map(|disturbance| disturbance.then);
        let before = self.operator.command_before().filter(|_| then == Some(Follow::Again));
        if let Some(command) = before {
            observer.say(at, &format!("the operator sends {command} again"));
            return self.operator.interject(at, &command, NextStep::SameCommand);
        }
        if then == Some(Follow::Next) {
            self.operator.give_up();
        }
        // PAUSE is the interruption, or the operator's first action after working at box or panel.
        self.operator.pause(at);
    }

    /// True if a person causes the contacts of this tick, at the joystick box or by placing parts.
    fn is_of_a_person(&self, over: bool) -> bool {
        match self.kind() {
            Kind::Nudge | Kind::Away => !over,
            Kind::Disturbed(disturbance) => !over || !matches!(disturbance.what, DisturbanceKind::Jog(_)),
            _ => false,
        }
    }

    /// The remedy of a command that failed because of a disturbance, once, in a branch that runs to the end.
    fn remedy(&mut self, script: &Script) -> Option<Script> {
        let what = &self.kind().disturbance()?.what;
        if self.remedied || self.until != Until::Job || self.operator.stranded().is_none() {
            return None;
        }
        let remedy = script.undone(what)?;
        self.remedied = true;
        Some(remedy)
    }

    /// True if the state may be compared with known states. A branch without interruption runs to its end.
    fn is_comparable(&self) -> bool {
        let was_interrupted = *self.kind() != Kind::None && self.next().is_none();
        let has_next = self.following && self.motion.is_none();
        let harmless = self.monitor.has_seen_nothing()
            && self.mismatch.is_none()
            && !self.tears
            && self.untrue.is_empty();
        Known::compares(self.branch.at()) && was_interrupted && has_next && harmless && self.invariants.hold()
    }

    fn state(&mut self) -> Result<Digest, Error> {
        self.branch.forget_past_faults();
        let operator = self.operator.state(self.branch.at(), self.branch.closed.command().number);
        self.branch.state(&(operator, self.goal))
    }

    fn known_end(&mut self, known: &Known) -> Result<Option<Arc<End>>, Error> {
        let (tick, state) = (self.branch.at(), self.state()?);
        self.path.push(Passed { tick, state, judged: self.judged() });
        let rest = known.rest(tick, state).filter(|rest| {
            let next = rest.end.ended.iter().find(|(ended, _)| *ended > tick);
            next.is_none_or(|(ended, _)| self.operator.waits_until(*ended))
        });
        let Some(Rest { end, judged }) = rest else { return Ok(None) };
        self.ended.extend(end.ended.iter().filter(|(ended, _)| *ended > tick).cloned());
        self.judged_behind = judged;
        Ok(Some(end))
    }

    fn end(&mut self) -> Result<End, Error> {
        Ok(End { until: self.branch.at(), state: self.state()?, ended: self.ended.clone() })
    }

    /// Number of confirmations judged since the fork, including those after a known state.
    const fn judged(&self) -> u64 {
        self.branch.judged() - self.judged_before + self.judged_behind
    }

    fn kind(&self) -> &Kind {
        &self.series.interruptions()[self.interruption].kind
    }

    /// Ticks before the next interruption, if any.
    fn next(&self) -> Option<u64> {
        self.series.interruptions().get(self.interruption + 1).map(|next| next.after)
    }

    fn begin(&mut self, observer: &mut impl Observer) -> Script {
        let (at, kind) = (self.branch.at(), self.kind().clone());
        if self.interruption > 0 {
            observer.say(at, &format!("interrupted again: {kind}"));
        }
        self.over = None;
        if self.until == Until::Rest && self.next().is_none() {
            self.motion = Some(Motion::from_now(&self.branch));
        }
        self.goal = match self.until {
            Until::Job | Until::Rest => usize::MAX,
            Until::Next => {
                let steps = self.branch.facility().job.steps.len();
                let commands = self.operator.current()..=steps;
                // The interrupted command or the next one, and the command after it.
                let commands = commands.filter(|line| self.operator.command_at(*line).is_some());
                commands.take(2).last().unwrap_or(usize::MAX)
            }
        };
        // The delay differs between branches, but not between runs.
        self.operator.interrupt((kind == Kind::PauseTwice).then_some(1 + at.0 * 37 % 120));
        self.following = kind.leaves_command() && self.motion.is_none();
        self.send(&kind, observer);
        kind.script()
    }

    /// True if the operator moves the robot away while both fingers and vise hold a part.
    fn takes_from_vise(&self) -> bool {
        self.operator.has_replaced()
            && self.branch.closed.workstation.cell.parts().iter().any(|part| part.held && part.clamped)
    }

    fn send(&mut self, kind: &Kind, observer: &mut impl Observer) {
        let at = self.branch.at();
        let current = self.operator.command_at(self.operator.current());
        let (command, then) = match kind {
            Kind::Refused => {
                let known = current.filter(|command| command.destination.is_some());
                let known = known.unwrap_or_else(|| go("HOME"));
                (HwsCommand { destination: Some(Name16::clipped(MISSPELT)), ..known }, NextStep::Recovery)
            }
            Kind::Replaced => (go("HOME"), NextStep::SameCommand),
            Kind::Pause if self.motion.is_some() => (pause(), NextStep::Nothing),
            _ => return,
        };
        observer.say(at, &format!("the operator sends {command}"));
        self.operator.interject(at, &command, then);
        self.following = true;
    }
}

fn go(location: &str) -> HwsCommand {
    HwsCommand {
        command: Name16::clipped("MOVE"),
        destination: Some(Name16::clipped(location)),
        ..HwsCommand::default()
    }
}
