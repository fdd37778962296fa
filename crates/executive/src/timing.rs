//! Times of the parts of a tick.
//!
//! The code that has finished a part calls [`StageTimes::mark`]: one read of the clock per part. The times are summed
//! up at the end of the tick ([`StageTimes::finish`]).

use std::{fmt, time::Instant};

use levels::ladder::{PROCESS_COUNT, ProcessId};

use crate::histogram::{Histogram, Summary};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Receive from a serial line, exchange of task data, and log entries before the controller runs.
    Inputs,
    Process(ProcessId),
    /// Common memory: carried over from the previous tick, and published.
    Buffers,
    Bookkeeping,
    Line,
    Log,
    Cell,
    Workstation,
}

/// Parts that are not control processes.
const OTHERS: [Stage; 7] = [
    Stage::Inputs,
    Stage::Buffers,
    Stage::Bookkeeping,
    Stage::Line,
    Stage::Log,
    Stage::Cell,
    Stage::Workstation,
];
pub const PARTS: usize = PROCESS_COUNT + OTHERS.len();

impl Stage {
    /// All parts: control processes first, in their order.
    pub fn all() -> impl Iterator<Item = Self> {
        ProcessId::ALL.iter().map(|&process| Self::Process(process)).chain(OTHERS)
    }

    const fn index(self) -> usize {
        match self {
            Self::Process(process) => process as usize,
            Self::Inputs => PROCESS_COUNT,
            Self::Buffers => PROCESS_COUNT + 1,
            Self::Bookkeeping => PROCESS_COUNT + 2,
            Self::Line => PROCESS_COUNT + 3,
            Self::Log => PROCESS_COUNT + 4,
            Self::Cell => PROCESS_COUNT + 5,
            Self::Workstation => PROCESS_COUNT + 6,
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Process(process) => process.text(),
            Self::Inputs => "inputs",
            Self::Buffers => "buffers",
            Self::Bookkeeping => "bookkeeping",
            Self::Line => "serial line",
            Self::Log => "log",
            Self::Cell => "cell",
            Self::Workstation => "workstation",
        })
    }
}

pub struct StageTimes {
    last: Instant,
    tick: [u64; PARTS],
    times: Box<[Histogram]>,
}

impl Default for StageTimes {
    fn default() -> Self {
        Self { last: Instant::now(), tick: [0; PARTS], times: vec![Histogram::default(); PARTS].into() }
    }
}

impl StageTimes {
    pub fn begin(&mut self) {
        self.tick = [0; PARTS];
        self.last = Instant::now();
    }

    /// End a part, which began at the end of the previous one; returns its ns. A part can occur several times in a
    /// tick.
    pub fn mark(&mut self, part: Stage) -> u64 {
        let now = Instant::now();
        let taken = u64::try_from(now.duration_since(self.last).as_nanos()).unwrap_or(u64::MAX);
        self.last = now;
        self.tick[part.index()] += taken;
        taken
    }

    pub fn finish(&mut self) {
        for (time, &taken) in self.times.iter_mut().zip(&self.tick) {
            time.add(taken);
        }
    }

    /// The part that took longest in this tick, its time and that of the whole tick, nanoseconds.
    #[must_use]
    pub fn worst(&self) -> (Stage, u64, u64) {
        let all = Stage::all().map(|part| (part, self.tick[part.index()]));
        let (part, taken) = all.max_by_key(|(_, taken)| *taken).unwrap_or((Stage::Inputs, 0));
        (part, taken, self.tick.iter().sum())
    }

    #[must_use]
    pub fn summary(&self, part: Stage) -> Summary {
        self.times[part.index()].summary()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{thread, time::Duration};

    #[test]
    fn every_part_has_its_own_index() {
        let places: Vec<_> = Stage::all().map(Stage::index).collect();
        assert_eq!(places, (0..PARTS).collect::<Vec<_>>());
        assert_eq!(Stage::Process(ProcessId::QuickChange).to_string(), "Quick Change");
    }

    #[test]
    fn worst_part_is_the_longest() {
        let mut stage_times = StageTimes::default();
        stage_times.begin();
        stage_times.mark(Stage::Process(ProcessId::Task));
        thread::sleep(Duration::from_millis(3));
        let before = stage_times.mark(Stage::Process(ProcessId::Prim));
        thread::sleep(Duration::from_millis(2));
        let again = stage_times.mark(Stage::Process(ProcessId::Prim));
        stage_times.mark(Stage::Cell);
        stage_times.finish();
        let (part, taken, all) = stage_times.worst();
        assert_eq!((part, taken), (Stage::Process(ProcessId::Prim), before + again));
        assert!(taken >= 5_000_000 && taken <= all);
        assert!(stage_times.summary(part).max >= 5_000.0);
        stage_times.begin();
        assert!(stage_times.worst().2 == 0, "the next tick begins at nothing");
    }
}
