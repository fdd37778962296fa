//! The times at which ticks run (docs/design/tick.md "Grid").
//!
//! The controller itself has no clock. [`Clock::Fast`] begins a tick at once; the simulated cell advances 40 ms per
//! tick. [`Clock::Real`] uses an absolute [`Grid`]: slot `n` starts 40 ms x `n` after the start of the run. A late
//! wake-up does not shift later slots. A slot whose start has passed is skipped and counted. At every wake-up:
//!
//! ```text
//! ticks run + slots skipped = time elapsed / 40 ms    (rounded down)
//! ```
//!
//! The system wakes a thread some ten microseconds late, and within 40 ms other programs evict its data from the
//! caches. So call [`Grid::wake_early`], warm up, and then [`Grid::wait`], which stays awake until the slot.

use std::time::Duration;

use rcs_core::tick::TICK_MS;
use rustix::{
    io::Errno,
    thread::{ClockId, clock_nanosleep_absolute},
    time::{Timespec, clock_gettime},
};

pub const SLOT: Duration = Duration::from_millis(TICK_MS);
/// Lead of [`Grid::wake_early`]: enough for a late wake-up and a warm-up with cold caches (some 0.1 ms), and short
/// compared with a slot: a core stays awake for at most 1.25 % of the time.
pub const LEAD: Duration = Duration::from_micros(500);

/// Source of time; tests implement their own.
pub trait Time {
    /// Time since some fixed moment; it never decreases.
    fn now(&mut self) -> Duration;

    /// Return as soon as [`now`](Self::now) is at least `at`; may return late, and early if a signal comes.
    fn sleep_until(&mut self, at: Duration);

    /// Return as soon as [`now`](Self::now) is at least `at`, without yielding the processor.
    fn spin_until(&mut self, at: Duration) {
        while self.now() < at {
            std::hint::spin_loop();
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Monotonic; // `CLOCK_MONOTONIC`; it sleeps with `TIMER_ABSTIME`

impl Time for Monotonic {
    fn now(&mut self) -> Duration {
        Duration::try_from(clock_gettime(ClockId::Monotonic)).unwrap_or_default()
    }

    fn sleep_until(&mut self, at: Duration) {
        let Ok(request) = Timespec::try_from(at) else { return };
        // EINTR is the only error of a valid request: a signal, after which the caller checks the time again.
        match clock_nanosleep_absolute(ClockId::Monotonic, &request) {
            Ok(()) | Err(Errno::INTR) => {}
            Err(error) => debug_assert!(false, "clock_nanosleep: {error}"),
        }
    }
}

#[derive(Debug)]
pub struct Grid<T> {
    time: T,
    start: Duration,
    length: Duration,
    slot: u64,
    ticks: u64,
    skipped: u64,
    ready_for: Option<u64>, // the slot for which the thread was woken early
    late: Duration,
}

impl<T: Time> Grid<T> {
    /// A grid that starts now; slot 1, the first with a tick, begins 40 ms from now.
    pub fn new(time: T) -> Self {
        Self::with_slots_of(time, SLOT)
    }

    /// A grid whose slots have another length: simulated time goes faster than real time.
    fn with_slots_of(mut time: T, length: Duration) -> Self {
        let start = time.now();
        Self { time, start, length, slot: 0, ticks: 0, skipped: 0, ready_for: None, late: Duration::ZERO }
    }

    /// Sleep until [`LEAD`] before the next slot begins; the next [`wait`](Self::wait) is for this slot.
    pub fn wake_early(&mut self) {
        let next = self.slot_now() + 1;
        let early = self.begin(next).saturating_sub(LEAD);
        while self.time.now() < early {
            self.time.sleep_until(early);
        }
        self.ready_for = Some(next);
    }

    /// Waits asleep, or awake after [`wake_early`](Self::wake_early). Returns the number of slots skipped.
    pub fn wait(&mut self) -> u64 {
        let begins = if let Some(next) = self.ready_for.take() {
            let begins = self.begin(next);
            self.time.spin_until(begins);
            begins
        } else {
            let next = self.slot_now() + 1;
            let begins = self.begin(next);
            while self.time.now() < begins {
                self.time.sleep_until(begins);
            }
            begins
        };
        self.late = self.time.now().saturating_sub(begins);
        let arrived = self.slot_now();
        let skipped = arrived - self.slot - 1;
        self.slot = arrived;
        self.ticks += 1;
        self.skipped += skipped;
        skipped
    }

    fn begin(&self, slot: u64) -> Duration {
        self.start + self.length * u32::try_from(slot).unwrap_or(u32::MAX)
    }

    fn slot_now(&mut self) -> u64 {
        let elapsed = self.time.now().saturating_sub(self.start);
        u64::try_from(elapsed.as_nanos() / self.length.as_nanos()).unwrap_or(u64::MAX)
    }

    /// Start of slot 0: threads that keep the same grid need it.
    #[must_use]
    pub const fn start(&self) -> Duration {
        self.start
    }

    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }

    #[must_use]
    pub const fn skipped(&self) -> u64 {
        self.skipped
    }

    /// The present slot: time elapsed at the last wake-up, in units of 40 ms.
    #[must_use]
    pub const fn slot(&self) -> u64 {
        self.slot
    }

    /// Delay of the return of the last [`wait`](Self::wait) after the beginning of its slot.
    #[must_use]
    pub const fn late(&self) -> Duration {
        self.late
    }
}

#[derive(Debug)]
pub enum Clock {
    Fast,                  // one tick immediately after the other
    Real(Grid<Monotonic>), // one tick every 40 ms
}

impl Clock {
    /// A clock that runs `speed` ticks in the time of one, for a simulated robot; a slot has at least 1 ms.
    #[must_use]
    pub fn times(speed: u8) -> Self {
        let length = (SLOT / u32::from(speed.max(1))).max(Duration::from_millis(1));
        Self::Real(Grid::with_slots_of(Monotonic, length))
    }

    /// Returns true if there is time left until the tick is due; always false with [`Clock::Fast`].
    pub fn wake_early(&mut self) -> bool {
        match self {
            Self::Fast => false,
            Self::Real(grid) => {
                grid.wake_early();
                true
            }
        }
    }

    #[must_use]
    pub const fn late(&self) -> Duration {
        match self {
            Self::Fast => Duration::ZERO,
            Self::Real(grid) => grid.late(),
        }
    }

    /// Wait until the next tick is due; returns the number of slots that were skipped before it.
    pub fn wait(&mut self) -> u64 {
        match self {
            Self::Fast => 0,
            Self::Real(grid) => grid.wait(),
        }
    }

    /// Start of slot 0, of `CLOCK_MONOTONIC`; `None` with [`Clock::Fast`].
    #[must_use]
    pub const fn start(&self) -> Option<Duration> {
        match self {
            Self::Fast => None,
            Self::Real(grid) => Some(grid.start()),
        }
    }

    #[must_use]
    pub const fn skipped(&self) -> u64 {
        match self {
            Self::Fast => 0,
            Self::Real(grid) => grid.skipped(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::time::Instant;

    /// Each sleep of this test clock ends late by the next entry of `late`, or early by a signal if it is `None`.
    struct Scripted {
        now: Duration,
        late: Vec<Option<Duration>>,
    }

    impl Time for Scripted {
        fn now(&mut self) -> Duration {
            self.now
        }

        fn sleep_until(&mut self, at: Duration) {
            match self.late.pop() {
                None => self.now = at,
                Some(Some(late)) => self.now = at + late,
                Some(None) => self.now += (at - self.now) / 2,
            }
        }

        fn spin_until(&mut self, at: Duration) {
            self.now = self.now.max(at);
        }
    }

    proptest! {
        #[test]
        fn ticks_and_skipped_slots_are_the_time_elapsed(
            late in prop::collection::vec(prop::option::of(0_u64..200_000_000), 0..60),
            work in prop::collection::vec((0_u64..150_000_000, prop::option::of(0_u64..60_000_000)), 1..80),
        ) {
            let late = late.into_iter().map(|n| n.map(Duration::from_nanos)).collect();
            let mut grid = Grid::new(Scripted { now: Duration::from_secs(7), late });
            for (work, warm_up) in work {
                if let Some(warm_up) = warm_up {
                    grid.wake_early();
                    grid.time.now += Duration::from_nanos(warm_up);
                }
                grid.wait();
                prop_assert!(grid.begin(grid.slot()) <= grid.time.now, "a slot begins before it is run");
                let elapsed = grid.time.now - Duration::from_secs(7);
                prop_assert_eq!(u128::from(grid.ticks() + grid.skipped()), elapsed.as_nanos() / 40_000_000);
                grid.time.now += Duration::from_nanos(work);
            }
        }
    }

    #[test]
    fn only_work_longer_than_a_slot_skips_slots() {
        let mut grid = Grid::new(Scripted { now: Duration::ZERO, late: Vec::new() });
        assert_eq!(grid.wait(), 0);
        grid.time.now += Duration::from_millis(39);
        assert_eq!((grid.wait(), grid.slot()), (0, 2));
        grid.time.now += Duration::from_millis(81);
        assert_eq!((grid.wait(), grid.slot()), (2, 5));
        assert_eq!((grid.ticks(), grid.skipped()), (3, 2));
    }

    #[test]
    fn whoever_wakes_early_is_there_when_the_slot_begins() {
        let us = |n| Some(Duration::from_micros(n));
        let mut grid = Grid::new(Scripted { now: Duration::ZERO, late: vec![us(700), us(30)] });
        grid.wake_early();
        assert_eq!(grid.time.now, SLOT - LEAD + Duration::from_micros(30));
        assert_eq!((grid.wait(), grid.slot(), grid.late()), (0, 1, Duration::ZERO));
        // A wake-up that is later than the lead does not lose the slot.
        grid.wake_early();
        assert_eq!((grid.wait(), grid.slot(), grid.late()), (0, 2, Duration::from_micros(200)));
        // Neither does a warm-up that takes too long.
        grid.wake_early();
        grid.time.now += Duration::from_millis(41);
        assert_eq!((grid.wait(), grid.slot()), (1, 4));
    }

    #[test]
    fn the_identity_holds_on_the_real_clock_with_a_stall() {
        let before = Instant::now();
        let mut grid = Grid::new(Monotonic);
        let after = Instant::now();
        for tick in 0..6 {
            grid.wait();
            let (least, most) = (after.elapsed(), before.elapsed());
            let sum = u128::from(grid.ticks() + grid.skipped());
            // The test reads the time slightly later than the grid; a slot may begin in between.
            assert!(sum <= most.as_nanos() / 40_000_000, "{sum} slots in {most:?}");
            assert!(u128::from(grid.slot()) * 40_000_000 <= most.as_nanos());
            assert_eq!(sum, u128::from(grid.slot()));
            if tick == 2 {
                std::thread::sleep(Duration::from_millis(100));
                assert!(least < most);
            }
        }
        assert!(
            grid.skipped() >= 2,
            "a stall of 100 ms covers two slots at least, {} were skipped",
            grid.skipped()
        );
    }
}
