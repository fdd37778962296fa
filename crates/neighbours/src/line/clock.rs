//! The clock of a run, for its neighbours.

use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum ClockKind {
    /// A tick every 40 ms, which does not wait for neighbours.
    Real = 0,
    /// Ticks as fast as possible; each waits for all connected neighbours.
    Fast = 1,
}

/// Time limit of the controller for the answer to a pulse: 10 s on the 40 ms grid, where the robot meanwhile
/// continues; 60 s in fast clock, because the computer may be busy.
#[must_use]
pub const fn answer_limit(clock: ClockKind) -> Duration {
    match clock {
        ClockKind::Real => Duration::from_secs(10),
        ClockKind::Fast => Duration::from_secs(60),
    }
}
