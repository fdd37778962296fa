//! Slows certificates whose requests the run refuses. The run keeps a refused connection for a second in one of eight
//! places (docs/neighbours.md "Security"): a client that retries without a pause would fill them and block all others.

use std::{
    collections::BTreeMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::address::Name;

/// Pause after the first refusal; it doubles with each further one.
const SHORTEST: Duration = Duration::from_millis(100);
const LONGEST: Duration = Duration::from_secs(2);
/// Refusals expire after this time without a request.
const EXPIRY: Duration = Duration::from_secs(10);
/// Greatest number of requests of one certificate that wait for the run. The last one waits for four of the longest
/// pauses, less than the 12 s for which a client waits.
const WAITING: u32 = 4;

#[derive(Clone, Copy, Debug)]
struct Requests {
    waiting: u32,
    refusals: u32,
    next: Instant, // the next request reaches the run at this time or later
}

#[derive(Debug, Default)]
pub struct Pace(Mutex<BTreeMap<Name, Requests>>);

impl Pace {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<Name, Requests>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wait before a request may reach the run; `None` if too many wait. After `Some`, call [`Pace::answered`].
    #[must_use]
    pub fn ask(&self, name: &Name, now: Instant) -> Option<Duration> {
        let mut all = self.lock();
        let own = all.entry(name.clone()).or_insert(Requests { waiting: 0, refusals: 0, next: now });
        if own.waiting >= WAITING {
            return None;
        }
        if now.saturating_duration_since(own.next) >= EXPIRY {
            own.refusals = 0;
        }
        own.waiting += 1;
        let at = own.next.max(now);
        own.next = at + pause(own.refusals);
        Some(at - now)
    }

    pub fn answered(&self, name: &Name, is_refused: bool, now: Instant) {
        let mut all = self.lock();
        let Some(own) = all.get_mut(name) else { return };
        own.waiting = own.waiting.saturating_sub(1);
        if is_refused {
            own.refusals = own.refusals.saturating_add(1);
            own.next = own.next.max(now + pause(own.refusals));
        } else {
            (own.refusals, own.next) = (0, now);
        }
    }
}

fn pause(refusals: u32) -> Duration {
    let Some(doublings) = refusals.checked_sub(1) else { return Duration::ZERO };
    SHORTEST.saturating_mul(2_u32.saturating_pow(doublings)).min(LONGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_of_a_refused_certificate_grow_and_end_with_an_admission() {
        let (pace, name) = (Pace::default(), "hwsc-2".parse().unwrap());
        let (start, mut now, mut waits) = (Instant::now(), Instant::now(), Vec::new());
        for _ in 0..7 {
            let wait = pace.ask(&name, now).unwrap();
            waits.push(wait.as_millis());
            now += wait;
            pace.answered(&name, true, now);
        }
        assert_eq!(waits, [0, 100, 200, 400, 800, 1600, 2000]);
        assert!(now - start > Duration::from_secs(5));
        let other = "hwsc-3".parse().unwrap();
        assert_eq!(pace.ask(&other, now), Some(Duration::ZERO), "another certificate does not wait");
        now += pace.ask(&name, now).unwrap();
        pace.answered(&name, false, now);
        assert_eq!(pace.ask(&name, now), Some(Duration::ZERO));
    }

    #[test]
    fn refusals_are_forgotten_after_a_time_without_requests() {
        let (pace, name, now) = (Pace::default(), "hwsc-2".parse().unwrap(), Instant::now());
        for _ in 0..3 {
            assert!(pace.ask(&name, now).is_some());
            pace.answered(&name, true, now);
        }
        assert!(pace.ask(&name, now).unwrap() > Duration::ZERO);
        pace.answered(&name, true, now);
        let later = now + LONGEST + EXPIRY;
        assert_eq!(pace.ask(&name, later), Some(Duration::ZERO));
        pace.answered(&name, true, later);
        assert_eq!(pace.ask(&name, later), Some(SHORTEST));
    }

    #[test]
    fn parallel_requests_of_a_refused_certificate_wait_one_after_the_other() {
        let (pace, name, now) = (Pace::default(), "hwsc-2".parse().unwrap(), Instant::now());
        assert_eq!(pace.ask(&name, now), Some(Duration::ZERO));
        pace.answered(&name, true, now);
        let waits: Vec<_> = (0..WAITING + 1).map(|_| pace.ask(&name, now)).collect();
        let expected = (1..=WAITING).map(|count| Some(SHORTEST * count)).chain([None]);
        assert!(waits.iter().copied().eq(expected), "{waits:?}");
    }
}
