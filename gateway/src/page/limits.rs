//! Limits per address and in total: on connections without a login, and on attempts to log in.

use std::{
    collections::BTreeMap,
    net::IpAddr,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::budget::Budget;

const CONNECTIONS: usize = 64; // greatest number of connections without a login, and of one address
const OF_ADDRESS: usize = 8;
const TRIES: u32 = 5; // failed tries of an address at once, and the time after which it may try once more
const AGAIN: Duration = Duration::from_secs(30);
const ALL_TRIES: u32 = 30;
const ALL_AGAIN: Duration = Duration::from_secs(2);
const ADDRESSES: usize = 1024; // greatest number of addresses whose failed tries are remembered

/// The address of a client. An IPv6 client has many addresses with the same first half, so only this half is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Source(IpAddr);

impl From<IpAddr> for Source {
    fn from(address: IpAddr) -> Self {
        Self(match address.to_canonical() {
            IpAddr::V6(address) => IpAddr::from((u128::from(address) >> 64 << 64).to_be_bytes()),
            address @ IpAddr::V4(_) => address,
        })
    }
}

#[derive(Clone, Default)]
pub struct PeerCounts(Arc<Mutex<BTreeMap<Source, usize>>>);

/// A connection without a login. It is counted until it is dropped.
pub struct Stranger {
    all: PeerCounts,
    source: Source,
}

impl PeerCounts {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<Source, usize>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Admits a connection; `None` if there are too many.
    #[must_use]
    pub fn admit(&self, source: Source) -> Option<Stranger> {
        let mut all = self.lock();
        let total: usize = all.values().sum();
        let own = all.get(&source).copied().unwrap_or(0);
        (total < CONNECTIONS && own < OF_ADDRESS).then(|| {
            all.insert(source, own + 1);
            Stranger { all: self.clone(), source }
        })
    }
}

impl Drop for Stranger {
    fn drop(&mut self) {
        let mut all = self.all.lock();
        match all.get_mut(&self.source) {
            Some(own) if *own > 1 => *own -= 1,
            Some(_) => drop(all.remove(&self.source)),
            None => {}
        }
    }
}

pub struct Tries(Mutex<(Budget, BTreeMap<Source, Budget>)>);

impl Default for Tries {
    fn default() -> Self {
        Self(Mutex::new((Budget::new(ALL_TRIES, ALL_AGAIN), BTreeMap::new())))
    }
}

impl Tries {
    fn lock(&self) -> MutexGuard<'_, (Budget, BTreeMap<Source, Budget>)> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if an address may try. The try is a failed one until [`Tries::succeeded`].
    #[must_use]
    pub fn may_try(&self, source: Source, now: Instant) -> bool {
        let (total, own) = &mut *self.lock();
        if own.len() >= ADDRESSES {
            own.retain(|_, budget| !budget.is_full(now));
        }
        if own.len() >= ADDRESSES && !own.contains_key(&source) {
            return false;
        }
        let own = own.entry(source).or_insert_with(|| Budget::new(TRIES, AGAIN));
        if own.take(now).is_none() {
            return false;
        }
        let is_allowed = total.take(now).is_some();
        if !is_allowed {
            own.give_back();
        }
        is_allowed
    }

    pub fn succeeded(&self, source: Source) {
        let (total, own) = &mut *self.lock();
        total.give_back();
        own.get_mut(&source).into_iter().for_each(Budget::give_back);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        text.parse::<IpAddr>().unwrap().into()
    }

    fn numbered(number: u32) -> Source {
        IpAddr::from(number.to_be_bytes()).into()
    }

    #[test]
    fn addresses_of_one_client_are_one_source() {
        assert_eq!(source("fd00::1"), source("fd00::2"));
        assert_ne!(source("fd00::1"), source("fd00:0:0:1::1"));
        assert_ne!(source("10.0.0.1"), source("10.0.0.2"));
        assert_eq!(source("::ffff:10.0.0.1"), source("10.0.0.1"));
    }

    #[test]
    fn connections_of_strangers_are_bounded_per_address_and_in_total() {
        let strangers = PeerCounts::default();
        let mut open: Vec<_> = (0..OF_ADDRESS).map(|_| strangers.admit(numbered(0)).unwrap()).collect();
        assert!(strangers.admit(numbered(0)).is_none());
        open.extend((OF_ADDRESS..CONNECTIONS).map(|at| strangers.admit(numbered(at as u32)).unwrap()));
        assert!(strangers.admit(numbered(1000)).is_none());
        open.pop();
        open.push(strangers.admit(numbered(1000)).unwrap());
        drop(open);
        assert!(strangers.lock().is_empty());
    }

    #[test]
    fn failed_tries_are_bounded_per_address_and_in_total() {
        let (tries, now) = (Tries::default(), Instant::now());
        let try_all = |source, now| (0..100).filter(|_| tries.may_try(source, now)).count();
        assert_eq!(try_all(numbered(0), now), TRIES as usize);
        assert_eq!(try_all(numbered(0), now + AGAIN), 1);
        for _ in 0..100 {
            assert!(tries.may_try(numbered(1), now + AGAIN), "a success does not count");
            tries.succeeded(numbered(1));
        }
        let later = now + 1000 * AGAIN;
        let total: usize = (0..100).map(|number| try_all(numbered(number), later)).sum();
        assert_eq!(total, ALL_TRIES as usize);
        assert_eq!(try_all(numbered(99), later + ALL_AGAIN), 1);
        // Expired addresses are removed, so that the list is bounded.
        for number in 0..5000 {
            let _ = tries.may_try(numbered(number), later + ALL_AGAIN);
        }
        assert!(tries.lock().1.len() <= ADDRESSES);
    }
}
