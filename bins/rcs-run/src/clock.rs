//! The clock of a run on the command line.

use std::str::FromStr;

use runtime::{ClockKind, config::MOST_SPEED};

/// When ticks are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    pub kind: ClockKind,
    /// Ticks in 40 ms.
    pub speed: u8,
}

impl FromStr for Clock {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let speed = || text.strip_suffix('x')?.parse().ok().filter(|speed| (1..=MOST_SPEED).contains(speed));
        let (kind, speed) = match text {
            "fast" => (ClockKind::Fast, 1),
            "real" => (ClockKind::Real, 1),
            _ => (
                ClockKind::Real,
                speed()
                    .ok_or_else(|| format!("fast, real or 1x to {MOST_SPEED}x was expected; found {text}"))?,
            ),
        };
        Ok(Self { kind, speed })
    }
}
