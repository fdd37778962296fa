//! The clock of a run, for its neighbours.

use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum ClockKind {
    Real = 0, // every 40 ms, without waiting for neighbours
    Fast = 1, // as fast as possible; each tick waits for all neighbours
}

/// Time limit for an answer to a pulse: 10 s on the 40 ms grid, 60 s in fast clock, because the computer may be busy.
#[must_use]
pub const fn answer_limit(clock: ClockKind) -> Duration {
    match clock {
        ClockKind::Real => Duration::from_secs(10),
        ClockKind::Fast => Duration::from_secs(60),
    }
}
