//! A number of events that are allowed at once, and that refills with time.

use std::time::{Duration, Instant};

#[derive(Clone, Copy, Debug)]
pub struct Budget {
    burst: u32,
    refill: Duration,
    left: u32,
    since: Option<Instant>,
    omitted: u64,
}

impl Budget {
    /// Allows `burst` events at once, and one more after each `refill`.
    #[must_use]
    pub const fn new(burst: u32, refill: Duration) -> Self {
        Self { burst, refill, left: burst, since: None, omitted: 0 }
    }

    /// Asks for an event: the number of events that were refused before it, or `None` if it is refused, too.
    pub fn take(&mut self, now: Instant) -> Option<u64> {
        self.refill(now);
        if self.left == 0 {
            self.omitted += 1;
            return None;
        }
        self.left -= 1;
        Some(std::mem::take(&mut self.omitted))
    }

    pub fn give_back(&mut self) {
        self.left = self.left.saturating_add(1).min(self.burst);
    }

    /// True if nothing was taken that has not refilled.
    pub fn is_full(&mut self, now: Instant) -> bool {
        self.refill(now);
        self.left == self.burst
    }

    fn refill(&mut self, now: Instant) {
        let since = *self.since.get_or_insert(now);
        let periods = now.saturating_duration_since(since).as_millis() / self.refill.as_millis().max(1);
        if periods > 0 {
            let periods = u32::try_from(periods).unwrap_or(self.burst);
            self.left = self.left.saturating_add(periods).min(self.burst);
            self.since = Some(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REFILL: Duration = Duration::from_secs(2);

    #[test]
    fn budget_limits_a_flood_and_counts_omitted_events() {
        let (mut budget, start) = (Budget::new(10, REFILL), Instant::now());
        let taken = (0..1000).filter(|_| budget.take(start).is_some()).count();
        assert_eq!(taken, 10);
        assert_eq!(budget.take(start + REFILL), Some(990));
        assert_eq!(budget.take(start + REFILL), None);
        assert_eq!(budget.take(start + 1000 * REFILL), Some(1));
        let taken = (0..1000).filter(|_| budget.take(start + 1000 * REFILL).is_some()).count();
        assert_eq!(taken, 9);
        assert!(!budget.is_full(start + 1000 * REFILL));
        budget.give_back();
        assert!(budget.take(start + 1000 * REFILL).is_some() && budget.is_full(start + 1020 * REFILL));
    }
}
