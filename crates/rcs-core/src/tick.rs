//! Time inside the controller is a count of 40 ms cycles (II.2.3), never a clock.

use core::fmt;

use crate::{
    Plain,
    plain::{DecodeError, Reader, Schema, Writer},
};

/// Length of one tick in milliseconds (II.2.3 "cyclic execution").
pub const TICK_MS: u64 = 40;
/// Length of one tick in seconds.
pub const TICK_S: f64 = 0.040;

/// Number of a 40 ms cycle since the start of the run. Tick 0 is the state before the first cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Tick(pub u64);

impl Tick {
    /// The tick before the first cycle, which is the stamp of unwritten buffers.
    pub const BEFORE_START: Self = Self(0);

    /// The next cycle.
    #[must_use]
    #[inline]
    pub const fn next(self) -> Self {
        Self(self.0.saturating_add(1))
    }

    /// The previous cycle; tick 0 stays tick 0.
    #[must_use]
    #[inline]
    pub const fn previous(self) -> Self {
        Self(self.0.saturating_sub(1))
    }

    /// Cycles from `earlier` to `self`, 0 if `earlier` is later.
    #[must_use]
    #[inline]
    pub const fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }

    /// Milliseconds since the start of the run.
    #[must_use]
    #[inline]
    pub const fn milliseconds(self) -> u64 {
        self.0.saturating_mul(TICK_MS)
    }
}

impl fmt::Display for Tick {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Plain for Tick {
    const SCHEMA: Schema = Schema::U64;
    const ZERO: Self = Self::BEFORE_START;

    #[inline]
    fn encode(&self, w: &mut Writer<'_>) {
        self.0.encode(w);
    }

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        u64::decode(r).map(Self)
    }
}
