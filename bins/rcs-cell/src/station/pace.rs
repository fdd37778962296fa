//! Steps of a cell in real time: their times, and how late they were.

use std::{fmt, time::Duration};

use executive::{
    clock::{Clock, Monotonic, Time as _},
    histogram::Histogram,
};
use os_io::{stdout_line, text::amount};
use rcs_core::tick::TICK_MS;

pub const STEPS_PER_TICK: u8 = 2;
const STEP: Duration = Duration::from_millis(TICK_MS / 2);
const MOST_BEHIND: u64 = 10; // of the steps that were missed, so many are made up for; further ones are left out
/// A step that begins later than this may reach a controller one exchange later.
const LATE: Duration = Duration::from_millis(10);

pub struct Pace {
    clock: Clock,
    late: Box<Histogram>,  // how late steps began, ns
    steps: Box<Histogram>, // how long they took, ns
    begun: Duration,
    late_steps: u64,
    left_out: u64,
}

impl Pace {
    pub fn new() -> Self {
        Self {
            clock: Clock::times(STEPS_PER_TICK),
            late: Box::default(),
            steps: Box::default(),
            begun: Duration::ZERO,
            late_steps: 0,
            left_out: 0,
        }
    }

    /// Waits until the next step is due. Returns the number of steps to make, with those that were missed.
    pub fn wait(&mut self) -> u64 {
        let missed = self.clock.wait();
        self.begun = Monotonic.now();
        let late = self.clock.late() + STEP * u32::try_from(missed).unwrap_or(u32::MAX);
        self.late.add(nanoseconds(late));
        self.late_steps += u64::from(late > LATE);
        if missed > MOST_BEHIND {
            self.left_out += missed - MOST_BEHIND;
            stdout_line!("[station] the cell is {} ms late: this machine is too busy", late.as_millis());
        }
        1 + missed.min(MOST_BEHIND)
    }

    pub fn end_step(&mut self) {
        self.steps.add(nanoseconds(Monotonic.now().saturating_sub(self.begun)));
    }
}

impl fmt::Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [late, steps] = [&self.late, &self.steps].map(|times| times.summary());
        write!(
            f,
            "{} of 20 ms, {} of them late by more than 10 ms; worst begin {:.1} ms late, longest {:.1} ms (p99 {:.1} \
             ms)",
            amount(self.steps.count(), "step"),
            self.late_steps,
            late.max / 1000.0,
            steps.max / 1000.0,
            steps.p99 / 1000.0
        )?;
        if self.left_out > 0 {
            write!(f, "; {} left out", amount(self.left_out, "step"))?;
        }
        Ok(())
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}
