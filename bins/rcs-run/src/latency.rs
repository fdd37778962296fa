//! `rcs-run latency`: measures how late this machine wakes a thread that sleeps on the 40 ms grid.
//!
//! The thread has the settings of the ticks of a run (locked memory, SCHED_FIFO, one core). The result is the operating
//! system's share of a tick's jitter. Measure under the load of normal operation.

use std::{
    fmt,
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use executive::{
    clock::{Monotonic, Time},
    histogram::{Histogram, Summary},
    machine::Machine,
    realtime,
};
use os_io::text::amount;
use rcs_core::tick::TICK_MS;
use serde::Serialize;

use crate::rcs_run::{answer::answer, arguments::LatencyArguments, error::Error, interrupt::interruption};

const SLOT: Duration = Duration::from_millis(TICK_MS);
/// Upper limit of the p99 wake-up latency for `good`, µs: a hundredth of a frame's time on the line.
const GOOD_US: f64 = 200.0;
/// Upper limit for `usable`, µs. The frame of a tick is then on the line within the first half of the tick.
const USABLE_US: f64 = 2_000.0;
/// Edges of the printed histogram, microseconds.
const EDGES: [u64; 10] = [10, 20, 50, 100, 200, 500, 1_000, 2_000, 5_000, 40_000];

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Fitness {
    Good,
    Usable,
    Poor,
}

impl Fitness {
    fn of(summary: &Summary, skipped: u64) -> Self {
        if skipped > 0 || summary.p99 > USABLE_US {
            Self::Poor
        } else if summary.p99 > GOOD_US {
            Self::Usable
        } else {
            Self::Good
        }
    }

    const fn text(self) -> &'static str {
        match self {
            Self::Good => "good: 99 of 100 wake-ups are within 0.2 ms",
            Self::Usable => {
                "usable: every frame is on the line within its tick, but not always at the same time in it"
            }
            Self::Poor => {
                "poor: slots are skipped, or wake-ups are milliseconds late; the robot will wait for points"
            }
        }
    }
}

#[derive(Debug, Serialize)]
struct Measurement {
    seconds: f64,
    wakeups: u64,
    skipped: u64,
    late_us: Late,
    histogram: Vec<(u64, u64)>, // Histogram: upper edge in microseconds, and number of wake-ups up to it
    machine: String,
    realtime: String,
    verdict: Fitness,
    meaning: &'static str,
}

#[derive(Debug, Serialize)]
struct Late {
    p50: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

/// Measure and print. Fails with [`Error`] if signals cannot be caught, or the result cannot be printed.
pub fn latency(arguments: &LatencyArguments) -> Result<ExitCode, Error> {
    let interrupted = interruption()?;
    let machine = Machine::look();
    let granted = realtime::acquire(arguments.cpu);
    let slots = u64::from(arguments.seconds) * 1000 / TICK_MS;
    let mut watch = Watch::new();
    watch.run(&mut Monotonic, slots, &interrupted);
    let measurement = watch.measurement(&machine.to_string(), &granted.verdict.to_string());
    answer(&measurement, arguments.json)?;
    Ok(ExitCode::SUCCESS)
}

struct Watch {
    late: Box<Histogram>,
    counts: [u64; EDGES.len()],
    slots: u64,
    skipped: u64,
}

impl Watch {
    fn new() -> Self {
        Self { late: Box::default(), counts: [0; EDGES.len()], slots: 0, skipped: 0 }
    }

    fn run(&mut self, time: &mut impl Time, slots: u64, interrupted: &AtomicBool) {
        let start = time.now();
        let mut slot = 0;
        while slot < slots && !interrupted.load(Ordering::Relaxed) {
            slot += 1;
            let begins = start + SLOT * u32::try_from(slot).unwrap_or(u32::MAX);
            let mut now = time.now();
            while now < begins {
                time.sleep_until(begins);
                now = time.now();
            }
            let late = now - begins;
            self.note(late);
            let missed = u64::try_from(late.as_nanos() / SLOT.as_nanos()).unwrap_or(u64::MAX);
            self.skipped += missed;
            slot += missed;
        }
        self.slots = slot;
    }

    fn note(&mut self, late: Duration) {
        let nanoseconds = u64::try_from(late.as_nanos()).unwrap_or(u64::MAX);
        self.late.add(nanoseconds);
        if let Some(at) = EDGES.iter().position(|edge| nanoseconds <= edge * 1000) {
            self.counts[at] += 1;
        }
    }

    fn measurement(&self, machine: &str, realtime: &str) -> Measurement {
        let summary = self.late.summary();
        let p999 = self.late.quantile(999) as f64 / 1000.0;
        let verdict = Fitness::of(&summary, self.skipped);
        Measurement {
            seconds: (SLOT * u32::try_from(self.slots).unwrap_or(u32::MAX)).as_secs_f64(),
            wakeups: self.late.count(),
            skipped: self.skipped,
            late_us: Late { p50: summary.p50, p99: summary.p99, p999, max: summary.max },
            histogram: EDGES.into_iter().zip(self.counts).collect(),
            machine: machine.to_owned(),
            realtime: realtime.to_owned(),
            verdict,
            meaning: verdict.text(),
        }
    }
}

impl fmt::Display for Measurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "machine    {}", self.machine)?;
        writeln!(f, "real time  {}", self.realtime)?;
        writeln!(
            f,
            "wake-ups   {} in {:.1} s, {} of 40 ms skipped",
            self.wakeups,
            self.seconds,
            amount(self.skipped, "slot")
        )?;
        let Late { p50, p99, p999, max } = self.late_us;
        writeln!(f, "late by    p50 {p50:.1} us, p99 {p99:.1} us, p99.9 {p999:.1} us, max {max:.1} us")?;
        let most = self.histogram.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1);
        for (edge, count) in &self.histogram {
            let bar = "#".repeat(usize::try_from(count * 40 / most).unwrap_or(0));
            writeln!(f, "  <= {edge:>6} us {count:>8} {bar}")?;
        }
        writeln!(f, "verdict    {}", self.meaning)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock that advances only during a sleep. Each sleep ends late by the next entry.
    struct Made {
        now: Duration,
        late: Vec<Duration>,
    }

    impl Time for Made {
        fn now(&mut self) -> Duration {
            self.now
        }

        fn sleep_until(&mut self, at: Duration) {
            self.now = at + self.late.pop().unwrap_or_default();
        }
    }

    fn watched(late_us: &[u64], slots: u64) -> Measurement {
        let late = late_us.iter().rev().map(|us| Duration::from_micros(*us)).collect();
        let mut watch = Watch::new();
        watch.run(&mut Made { now: Duration::from_secs(7), late }, slots, &AtomicBool::new(false));
        watch.measurement("made", "not asked for")
    }

    #[test]
    fn lateness_is_relative_to_the_start_of_each_slot() {
        let measured = watched(&[5, 15, 150], 3);
        assert_eq!((measured.wakeups, measured.skipped, measured.verdict), (3, 0, Fitness::Good));
        assert!((measured.late_us.max - 150.0).abs() < 1e-9);
        assert_eq!(measured.histogram[0], (10, 1));
        assert_eq!(measured.histogram[4], (200, 1));
    }

    #[test]
    fn missed_slots_are_counted_and_judged() {
        let measured = watched(&[5, 85_000, 5], 5);
        assert_eq!((measured.wakeups, measured.skipped), (3, 2));
        assert_eq!(measured.verdict, Fitness::Poor);
        assert!(measured.to_string().contains("2 slots of 40 ms skipped"));
    }

    #[test]
    fn latency_verdict_follows_the_limits() {
        assert_eq!(watched(&[1_500; 10], 10).verdict, Fitness::Usable);
        assert_eq!(watched(&[2_500; 10], 10).verdict, Fitness::Poor);
    }
}
