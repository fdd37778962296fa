//! The clock of a run, by which it judges the time limits of requests.
//!
//! Clocks of different machines cannot be compared. Each line of the run carries the time of the run's clock, and a
//! client states the limit of a request in it: the time of the last line, plus the time since it was read, plus its
//! time limit. A delay makes the limit too early, never too late.

use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// A time of the run's clock: milliseconds since the run began to listen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunTime(pub u64);

impl RunTime {
    #[must_use]
    pub fn after(self, duration: Duration) -> Self {
        Self(self.0.saturating_add(millis(duration)))
    }
}

fn millis(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

/// The run's side of its clock. It continues while the process is stopped, and while the machine sleeps.
#[derive(Clone, Copy, Debug)]
pub struct RunClock {
    start: Duration,
}

impl RunClock {
    #[must_use]
    pub fn start() -> Self {
        Self { start: since_boot() }
    }

    #[must_use]
    pub fn now(&self) -> RunTime {
        RunTime::default().after(since_boot().saturating_sub(self.start))
    }
}

fn since_boot() -> Duration {
    let time = clock_gettime(ClockId::Boottime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or_default())
}

/// Age after which a client replaces its estimate in any case, since the two clocks drift.
const DRIFT: Duration = Duration::from_secs(60);

/// An estimate of the run's clock: a received time and the local time of its reading. It is fast at most by the drift.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    time: RunTime,
    read: Instant,
}

impl Estimate {
    /// An estimate from a line: the run's clock showed `time` at the moment `read` or earlier.
    #[must_use]
    pub const fn new(time: RunTime, read: Instant) -> Self {
        Self { time, read }
    }

    #[must_use]
    pub fn at(&self, now: Instant) -> RunTime {
        self.time.after(now.saturating_duration_since(self.read))
    }

    /// Takes another line into account. Of two estimates, the one with the later time has the smaller delay.
    pub fn hear(&mut self, time: RunTime, read: Instant) {
        if time >= self.at(read) || read.saturating_duration_since(self.read) > DRIFT {
            *self = Self { time, read };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimate_is_never_ahead_of_the_run_clock() {
        let start = Instant::now();
        let at = |millis: u64| start + Duration::from_millis(millis);
        // The run sent 100 when its clock showed 100. The line took 30 ms, so the client reads it at 130.
        let mut estimate = Estimate::new(RunTime(100), at(130));
        assert_eq!(estimate.at(at(200)), RunTime(170));
        // A line with a delay of 5 s leaves the estimate unchanged; a faster one improves it.
        estimate.hear(RunTime(300), at(5300));
        assert_eq!(estimate.at(at(5300)), RunTime(5270));
        estimate.hear(RunTime(5310), at(5320));
        assert_eq!(estimate.at(at(5400)), RunTime(5390));
        // After a minute the last line is used.
        estimate.hear(RunTime(80_000), at(80_050));
        assert_eq!(estimate.at(at(80_060)), RunTime(80_010));
    }

    #[test]
    fn run_clock_is_monotonic() {
        let clock = RunClock::start();
        let first = clock.now();
        std::thread::sleep(Duration::from_millis(5));
        assert!(clock.now() > first && first < RunTime(1000));
    }
}
