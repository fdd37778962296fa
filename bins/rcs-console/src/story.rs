//! The history of a run, stored by change: rows, commands, reports, failures, restarts, messages.

use closed_loop::{
    account::{Account, Alarms, has_worked},
    failure::{Failure, Watch},
};
use executive::histogram::Histogram;
use interfaces::{Decided, Fault, ProcessId};
use levels::ladder::{Ladder, PROCESS_COUNT};
use rcs_core::{name::Name16, tick::Tick};
use record::{
    Level,
    channels::{HeaderPlace, headers},
    reader::LogLine,
    remarks,
};

use crate::rcs_console::picture::Picture;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessState {
    pub tick: u64,   // the first one of the state
    pub number: u32, // of its command; 0 for T3 Interface, which gets a new one in every tick
    /// The row that decided last.
    pub decided: Option<Decided>,
    pub step: Option<Name16>, // of the command after that row
    /// `executing`, `done`, `not-detected` ...
    pub report: &'static str,
    pub fault: Fault,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trouble {
    /// Tick in which Task first reported it.
    pub tick: u64,
    /// The lowest process that reported it, with tick and row.
    pub failure: Failure,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restart {
    pub tick: u64,
    pub reason: String,
}

pub struct Story {
    doings: [Vec<ProcessState>; PROCESS_COUNT],
    troubles: Vec<Trouble>,
    restarts: Vec<Restart>,
    lines: Vec<LogLine>,
    times: Histogram,
    watch: Box<Watch>,
    worked: Vec<Tick>, // ticks in which a command other than PAUSE finished
    last: u64,
    /// The account that the run made at its end; `None` during the run, or if it was killed.
    ended: Option<Option<Account>>,
    headers: Vec<HeaderPlace>,
    limit: usize,
}

impl Story {
    /// A history that keeps at least the last `limit` entries of each kind.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        Self {
            doings: Default::default(),
            troubles: Vec::new(),
            restarts: Vec::new(),
            lines: Vec::new(),
            times: Histogram::default(),
            watch: Box::default(),
            worked: Vec::new(),
            last: 0,
            ended: None,
            headers: headers(),
            limit,
        }
    }

    /// Add a tick. `before` is the picture of the tick before.
    pub fn note(&mut self, before: &Picture, now: &Picture) {
        self.last = now.tick.0;
        for process in ProcessId::ALL.iter().copied() {
            let doing = doing(process, now);
            let known = &mut self.doings[process.position()];
            if known.last().is_none_or(|last| ProcessState { tick: last.tick, ..doing } != *last) {
                keep(known, doing, self.limit);
            }
        }
        self.watch.observe(now.tick, &now.external, &before.memory, &now.memory);
        let failed = |picture: &Picture| picture.fault(ProcessId::Task);
        if failed(now).is_some()
            && failed(now) != failed(before)
            && let Some(failure) = self.watch.failure(Ladder::processes())
        {
            keep(&mut self.troubles, Trouble { tick: now.tick.0, failure }, self.limit);
        }
        if has_worked(&before.memory.task.status, &now.memory.task.status) {
            keep(&mut self.worked, now.tick, self.limit);
        }
        let counters = |picture: &Picture| picture.memory.t3i.status.counters.restarts;
        if counters(now) > counters(before) {
            keep(&mut self.restarts, Restart { tick: now.tick.0, reason: restart(before, now) }, self.limit);
        }
        if let Some(timing) = now.timing {
            self.times.add(timing.controller_ns);
        }
    }

    /// Add messages derived from two successive ticks, for a source without lines on `/log`.
    pub fn remark(&mut self, before: &Picture, now: &Picture) {
        let said = remarks::remarks(&self.headers, &now.external.hws, &before.memory, &now.memory);
        self.tell(said.into_iter().map(|remark| LogLine {
            tick: now.tick,
            level: remark.level,
            source: remark.source,
            text: remark.text,
            code: remark.file.to_owned(),
        }));
    }

    pub fn tell(&mut self, lines: impl IntoIterator<Item = LogLine>) {
        let mut is_new = false;
        for line in lines {
            keep(&mut self.lines, line, self.limit);
            is_new = true;
        }
        if is_new {
            self.lines.sort_by_key(|line| line.tick);
        }
    }

    /// Store the account that the run made at its end; `None` if it did not fail.
    pub fn end(&mut self, account: Option<Account>) {
        self.ended = Some(account);
    }

    /// State of a process in a tick, with its first tick.
    #[must_use]
    pub fn doing(&self, process: ProcessId, tick: u64) -> Option<&ProcessState> {
        self.doings(process, tick).last()
    }

    /// States of a process up to a tick, oldest first.
    #[must_use]
    pub fn doings(&self, process: ProcessId, tick: u64) -> &[ProcessState] {
        until(&self.doings[process.position()], tick, |doing| doing.tick)
    }

    /// The rows that decided in a process up to a tick, oldest first. Changes of its reports alone are left out.
    #[must_use]
    pub fn rows(&self, process: ProcessId, tick: u64) -> Vec<ProcessState> {
        let mut rows: Vec<ProcessState> = Vec::new();
        for doing in self.doings(process, tick) {
            let key = |doing: &ProcessState| (doing.decided, doing.step, doing.number);
            if rows.last().is_none_or(|last| key(last) != key(doing)) {
                rows.push(*doing);
            }
        }
        rows
    }

    /// The next or previous tick in which something changed in one of the processes.
    #[must_use]
    pub fn change(&self, processes: &[ProcessId], tick: u64, forward: bool) -> Option<u64> {
        let ticks = |process: &ProcessId| self.doings[process.position()].iter().map(|doing| doing.tick);
        nearest(processes.iter().flat_map(ticks), tick, forward)
    }

    /// The next or previous tick with a new failure or warning, and the lowest process that failed in it, if any.
    #[must_use]
    pub fn trouble(&self, tick: u64, forward: bool) -> Option<(u64, Option<ProcessId>)> {
        let failed = ProcessId::ALL.iter().flat_map(|process| {
            self.doings[process.position()]
                .windows(2)
                .filter_map(|pair| <&[ProcessState; 2]>::try_from(pair).ok())
                .filter(|[was, is]| !is.fault.is_none() && was.fault != is.fault)
                .map(|[_, is]| (is.tick, *process))
        });
        let failed: Vec<_> = failed.collect();
        let warned = self.lines.iter().filter(|line| line.level >= Level::Warning).map(|line| line.tick.0);
        let found = nearest(failed.iter().map(|(tick, _)| *tick).chain(warned), tick, forward)?;
        let lowest = ProcessId::upward()
            .find(|process| failed.iter().any(|(tick, of)| *tick == found && of == process));
        Some((found, lowest))
    }

    /// The failure that belongs to a picture: the failure of Task, or one that reaches Task in the next ticks of a log.
    #[must_use]
    pub fn present_trouble(&self, picture: &Picture) -> Option<&Trouble> {
        let tick = picture.tick.0;
        let is_told = picture.fault(ProcessId::Task).is_some();
        let begun = until(&self.troubles, tick, |trouble| trouble.failure.tick.0);
        begun.last().filter(|trouble| is_told || tick < trouble.tick)
    }

    /// The first failure and its consequences; `None` without a failure, or if the robot has continued to work.
    #[must_use]
    pub fn account(&self) -> Option<Account> {
        self.ended.clone().unwrap_or_else(|| self.account_until(u64::MAX))
    }

    /// The first failure at a tick, unless a command has finished since.
    #[must_use]
    pub fn failure(&self, tick: u64) -> Option<Failure> {
        match &self.ended {
            Some(Some(Account { first, .. })) if self.shown_at(first) <= tick => Some(first.clone()),
            _ => self.account_until(tick).map(|account| account.first),
        }
    }

    /// The tick whose picture shows a failure: the next one, if any, because the cell shows events one tick late.
    #[must_use]
    pub fn shown_at(&self, failure: &Failure) -> u64 {
        failure.shown_at().min(self.last)
    }

    /// True if the run ended because of this failure.
    #[must_use]
    pub fn is_ended_by(&self, failure: &Failure) -> bool {
        matches!(&self.ended, Some(Some(account)) if account.first == *failure)
    }

    /// The account of everything up to a tick.
    fn account_until(&self, tick: u64) -> Option<Account> {
        let mut alarms = Alarms::default();
        for line in self.lines(tick) {
            alarms.line(line.tick, &line.source, &line.code, &line.text);
        }
        for trouble in until(&self.troubles, tick, |trouble| trouble.tick) {
            alarms.failed(trouble.failure.clone());
        }
        if let Some(worked) = until(&self.worked, tick, |worked| worked.0).last() {
            alarms.worked(*worked);
        }
        alarms.account()
    }

    /// The restarts of the link up to a tick, oldest first.
    #[must_use]
    pub fn restarts(&self, tick: u64) -> &[Restart] {
        until(&self.restarts, tick, |restart| restart.tick)
    }

    /// Messages up to a tick, oldest first.
    #[must_use]
    pub fn lines(&self, tick: u64) -> &[LogLine] {
        until(&self.lines, tick, |line| line.tick.0)
    }

    /// Times of the controller in all observed ticks.
    #[must_use]
    pub const fn times(&self) -> &Histogram {
        &self.times
    }
}

#[must_use]
pub fn process_named(name: &str) -> Option<ProcessId> {
    let named = Ladder::processes().iter().zip(ProcessId::ALL).find(|(process, _)| process.name == name);
    named.map(|(_, process)| *process)
}

fn doing(process: ProcessId, picture: &Picture) -> ProcessState {
    let (header, said) = (picture.memory.header(process), picture.memory.said(process));
    let number = if process == ProcessId::T3i { 0 } else { picture.command_number(process) };
    ProcessState {
        tick: picture.tick.0,
        number,
        decided: header.decided,
        step: header.step,
        report: said.report,
        fault: said.fault,
    }
}

/// Reason of a restart of the link.
fn restart(before: &Picture, now: &Picture) -> String {
    if remarks::is_restart_ordered(&before.memory) {
        return format!("Prim ordered it, as {} asks: no fault", before.command(ProcessId::Prim));
    }
    let fault = [now, before].into_iter().find_map(|picture| picture.fault(ProcessId::T3i));
    match fault {
        Some(fault) => fault.text().to_owned(),
        None => "T3 Interface restarted the link".to_owned(),
    }
}

/// Add an entry. At twice the required number of entries, the oldest half is removed.
fn keep<T>(entries: &mut Vec<T>, entry: T, limit: usize) {
    if entries.len() >= limit.saturating_mul(2) {
        entries.drain(..entries.len() - limit);
    }
    entries.push(entry);
}

fn until<T>(entries: &[T], tick: u64, tick_of: impl Fn(&T) -> u64) -> &[T] {
    &entries[..entries.partition_point(|entry| tick_of(entry) <= tick)]
}

/// The nearest tick after or before one.
fn nearest(ticks: impl Iterator<Item = u64>, tick: u64, forward: bool) -> Option<u64> {
    match forward {
        true => ticks.filter(|other| *other > tick).min(),
        false => ticks.filter(|other| *other < tick).max(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs, Reason, t3i::LinkFault};

    fn story(changes: &[fn(&mut CommonMemory)]) -> (Story, Picture) {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        let mut now = Picture { tick: Tick(0), external, memory, timing: None };
        let mut story = Story::new(usize::MAX);
        for change in changes {
            let before = now.clone();
            now.tick = before.tick.next();
            change(&mut now.memory);
            story.note(&before, &now);
            story.remark(&before, &now);
        }
        (story, now)
    }

    fn failing() -> (Story, Picture) {
        story(&[
            |_| {},
            |memory| memory.emove.header.decided = Some(Decided { table: 1, row: 1 }),
            |memory| memory.emove.status.reason = Reason::NothingSeen,
            |memory| memory.subtask.status.reason = Reason::NothingSeen,
            |memory| memory.task.status.reason = Reason::NothingSeen,
            |_| {},
        ])
    }

    #[test]
    fn only_changes_are_kept() {
        let (story, _) = failing();
        let ticks: Vec<_> = story.doings(ProcessId::Emove, 99).iter().map(|doing| doing.tick).collect();
        assert_eq!(ticks, [1, 2, 3]);
        assert_eq!(story.rows(ProcessId::Emove, 99).len(), 2, "a change of the report alone is not a row");
        assert_eq!(story.doing(ProcessId::Emove, 2).map(|doing| doing.tick), Some(2));
        assert_eq!(story.change(&[ProcessId::Emove], 1, true), Some(2));
        assert_eq!(story.change(&[ProcessId::Emove, ProcessId::Task], 6, false), Some(5));
        assert_eq!(story.change(&[ProcessId::Emove], 3, true), None);
    }

    #[test]
    fn failure_has_its_cause_below() {
        let (story, picture) = failing();
        let trouble = story.present_trouble(&picture).expect("Task reports a failure");
        assert_eq!((trouble.tick, trouble.failure.tick), (5, Tick(3)));
        let at = |tick| {
            let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
            story.present_trouble(&Picture { tick: Tick(tick), external, memory, timing: None })
        };
        assert_eq!(at(2), None);
        assert_eq!(at(3), Some(trouble), "it is on its way to Task");
        let account = story.account().expect("there is a failure");
        assert_eq!(
            (account.first.shown_at(), process_named(&account.first.process)),
            (3, Some(ProcessId::Emove))
        );
        assert_eq!(story.trouble(0, true), Some((3, Some(ProcessId::Emove))));
        assert_eq!(story.trouble(99, false), Some((5, Some(ProcessId::Task))));
    }

    #[test]
    fn earlier_cell_event_is_the_cause_of_a_failure() {
        let (mut story, _) = failing();
        let line = |tick, source: &str| LogLine {
            tick: Tick(tick),
            level: Level::Error,
            source: source.to_owned(),
            text: "contact".to_owned(),
            code: "contact.begins".to_owned(),
        };
        story.tell([line(9, "cell")]);
        let first = |story: &Story| story.account().expect("there is a failure").first;
        assert_eq!(first(&story).tick, Tick(3), "the contact came later");
        story.tell([line(3, "cell")]);
        let contact = first(&story);
        assert_eq!((contact.tick, contact.shown_at(), contact.text.as_str()), (Tick(2), 3, "contact"));
        story.end(None);
        assert_eq!(story.account(), None, "the run knows that it has finished");
    }

    #[test]
    fn a_restart_has_its_reason() {
        let (story, _) = story(&[
            |memory| memory.t3i.status.fault = LinkFault::Checksum,
            |memory| memory.t3i.status.counters.restarts = 1,
        ]);
        let restart = story.restarts(9).first().expect("the link was started again");
        assert_eq!((restart.tick, restart.reason.as_str()), (2, "checksum error"));
        assert!(story.restarts(1).is_empty());
    }

    #[test]
    fn long_history_keeps_its_end() {
        let mut entries = Vec::new();
        (0..100).for_each(|entry| keep(&mut entries, entry, 10));
        assert!((10..=20).contains(&entries.len()), "{}", entries.len());
        assert_eq!(entries.last(), Some(&99));
    }
}
