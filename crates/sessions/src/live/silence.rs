//! Measures the time for which a client has not read.

use std::time::{Duration, Instant};

/// A longer gap between two checks means that this program was stopped, so it is not counted as the client's silence.
const GAP: Duration = Duration::from_millis(100);

#[derive(Debug)]
pub struct Silence {
    looked: Instant,
    silent: Duration,
}

impl Silence {
    pub const fn new(now: Instant) -> Self {
        Self { looked: now, silent: Duration::ZERO }
    }

    /// Records that the client has read something.
    pub const fn end(&mut self) {
        self.silent = Duration::ZERO;
    }

    /// The time for which the client has not read. Call it often.
    pub fn length(&mut self, now: Instant) -> Duration {
        self.silent = self.silent.saturating_add(now.saturating_duration_since(self.looked).min(GAP));
        self.looked = now;
        self.silent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_excludes_time_of_a_stopped_program() {
        let begin = Instant::now();
        let mut silence = Silence::new(begin);
        let at = |milliseconds| begin + Duration::from_millis(milliseconds);
        assert_eq!(silence.length(at(90)), Duration::from_millis(90));
        assert_eq!(silence.length(at(60_090)), Duration::from_millis(190));
        assert_eq!(silence.length(at(60_100)), Duration::from_millis(200));
        silence.end();
        assert_eq!(silence.length(at(60_130)), Duration::from_millis(30));
    }
}
