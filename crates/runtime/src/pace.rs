//! Keeps the ticks of a run on their grid, and measures their lateness.

use std::{collections::BTreeMap, fmt::Write as _, time::Duration};

use executive::{
    clock::Clock,
    histogram::Histogram,
    machine::Machine,
    overrun::{Overrun, Overruns, Policy},
    realtime::{self, RealTime},
    timing::{Stage, StageTimes},
};
use interfaces::CommonMemory;

use crate::{event::Event, result::TickTimes};

const PROCESSES_SHOWN: usize = 3; // number of processes in the result, which have the longest times

pub struct Pace {
    clock: Clock,
    policy: Policy,
    overruns: Overruns,
    late: Box<Histogram>,
    granted: Option<RealTime>,
    verdict: Option<String>,
    was_holding: bool,
}

impl Pace {
    /// A clock without waiting between ticks.
    #[must_use]
    pub fn fast(policy: Policy) -> Self {
        Self {
            clock: Clock::Fast,
            policy,
            overruns: Overruns::new(policy),
            late: Box::default(),
            granted: None,
            verdict: None,
            was_holding: false,
        }
    }

    /// Runs a tick every 40 ms, or `speed` ticks. Start log and progress threads first: they keep ordinary priority.
    pub fn ask_for_real_time(&mut self, core: Option<usize>, speed: u8) -> Event {
        let granted = realtime::acquire(core);
        let verdict = format!("{}; {}", granted.verdict, Machine::look());
        let event = Event::RealTime { verdict, complete: granted.verdict.complete() };
        self.granted = Some(granted);
        self.verdict = Some(event.to_string());
        self.clock = Clock::times(speed);
        event
    }

    /// Sleep until shortly before the next tick. Returns true if there is time for a warm-up.
    pub fn wake_early(&mut self) -> bool {
        self.clock.wake_early()
    }

    /// Wait until the tick is due. Returns events for skipped slots and the reaction to them.
    pub fn wait(&mut self, stage_times: &StageTimes) -> Vec<Event> {
        let slots = self.clock.wait();
        let late = self.clock.late();
        self.late.add(u64::try_from(late.as_nanos()).unwrap_or(u64::MAX));
        let overrun = self.overruns.observe(slots, stage_times, late);
        let holding = self.overruns.is_holding();
        let (stops, changed) = (matches!(self.policy, Policy::Stop(_)), holding != self.was_holding);
        self.was_holding = holding;
        // An empty vector does not allocate.
        let mut events: Vec<Event> = overrun.map(Event::Overrun).into_iter().collect();
        events.extend(changed.then_some(match holding {
            true if stops => Event::Stops,
            true => Event::Holds,
            false => Event::Punctual,
        }));
        events
    }

    /// The velocity knob for the controller: at zero while the robot holds.
    #[must_use]
    pub const fn knob(&self, knob: u16) -> u16 {
        self.overruns.knob(knob)
    }

    /// After a tick: the overrun that ends the run now, if any.
    pub fn ends(&mut self, memory: &CommonMemory) -> Option<Overrun> {
        self.overruns.ends(memory)
    }

    #[must_use]
    pub const fn policy(&self) -> Policy {
        self.policy
    }

    /// True if ticks are on the 40 ms grid, false in fast clock.
    #[must_use]
    pub const fn is_real(&self) -> bool {
        matches!(self.clock, Clock::Real(_))
    }

    /// Start of slot 0, of `CLOCK_MONOTONIC`; `None` in fast clock.
    #[must_use]
    pub const fn start(&self) -> Option<Duration> {
        self.clock.start()
    }

    #[must_use]
    pub const fn skipped(&self) -> u64 {
        self.clock.skipped()
    }

    /// The real-time settings that the system has granted; `None` in fast clock.
    #[must_use]
    pub fn verdict(&self) -> Option<String> {
        self.verdict.clone()
    }

    /// Lateness of the last tick.
    #[must_use]
    pub const fn last_late(&self) -> Duration {
        self.clock.late()
    }

    /// Lateness of all ticks; `None` in fast clock.
    #[must_use]
    pub fn late(&self) -> Option<TickTimes> {
        self.verdict.is_some().then(|| self.late.summary().into())
    }

    /// Number of skipped slots by cause: a part of a tick, or `waking`.
    #[must_use]
    pub fn overruns(&self) -> BTreeMap<String, u64> {
        let name = |part: Option<Stage>| part.map_or_else(|| "waking".to_owned(), |part| part.to_string());
        self.overruns.by_part().map(|(part, slots)| (name(part), slots)).collect()
    }
}

#[must_use]
pub fn times(stage_times: &StageTimes) -> BTreeMap<String, TickTimes> {
    Stage::all().map(|part| (part.to_string(), stage_times.summary(part).into())).collect()
}

#[must_use]
pub fn slowest(stage_times: &StageTimes) -> String {
    let mut processes: Vec<_> = Stage::all()
        .filter(|part| matches!(part, Stage::Process(_)))
        .map(|part| (stage_times.summary(part).p99, part))
        .collect();
    processes.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let mut text = String::new();
    for (p99, part) in processes.into_iter().take(PROCESSES_SHOWN) {
        let separator = if text.is_empty() { "" } else { ", " };
        // Writing to a String cannot fail.
        let _ = write!(text, "{separator}{part} p99 {p99:.1} us");
    }
    text
}
