//! Time limits for the set-up and opening of iceoryx2 services.
//!
//! If another program damages the shared memory during the set-up, iceoryx2 0.10.0 can panic, which becomes an error
//! here, or wait forever for a flag. Such a call cannot be cancelled: only the process can be ended.

use std::{
    panic::{self, AssertUnwindSafe},
    sync::mpsc::{self, RecvTimeoutError},
    thread,
    time::Duration,
};

use super::{error::SharedMemoryError, place::root};

/// Longest time for setting up or opening shared memory, which can take a second on a busy machine.
pub const SET_UP_LIMIT: Duration = Duration::from_secs(20);

/// Called with the limit, on another thread. It should end the process: the other call does not return.
pub type OnTimeout = fn(Duration);

/// Run `work`; after `limit`, if any, `on_stuck` is called. A panic becomes [`SharedMemoryError::Damaged`].
pub fn within_limit<T, E: From<SharedMemoryError>>(
    limit: Duration,
    on_stuck: Option<OnTimeout>,
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    // Data that a panic leaves incomplete belong to `work`, and are dropped with it.
    let work =
        || panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or(Err(SharedMemoryError::Damaged.into()));
    let Some(on_stuck) = on_stuck else { return work() };
    let (done, waits) = mpsc::channel::<()>();
    let watch = move || {
        if waits.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
            on_stuck(limit);
        }
    };
    let watch = thread::Builder::new().name("set-up limit".into()).spawn(watch);
    watch.map_err(|source| SharedMemoryError::Io { path: root(), source })?;
    let result = work();
    drop(done);
    result
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    static STUCK: AtomicU32 = AtomicU32::new(0);

    fn on_stuck(limit: Duration) {
        assert_eq!(limit, Duration::from_millis(1));
        STUCK.fetch_add(1, Ordering::SeqCst);
    }

    #[test]
    fn a_set_up_that_never_ends_is_noticed_and_one_that_ends_is_not() {
        let soon = || Ok::<_, SharedMemoryError>(7);
        assert_eq!(within_limit(Duration::MAX, Some(on_stuck), soon).unwrap(), 7);
        assert_eq!(STUCK.load(Ordering::SeqCst), 0);
        let never = || {
            while STUCK.load(Ordering::SeqCst) == 0 {
                thread::yield_now();
            }
            soon()
        };
        assert_eq!(within_limit(Duration::from_millis(1), Some(on_stuck), never).unwrap(), 7);
        assert_eq!(STUCK.load(Ordering::SeqCst), 1, "it is called once");
    }

    #[test]
    fn a_set_up_that_panics_is_an_error() {
        let damaged = || -> Result<(), SharedMemoryError> { panic!("an index of another program") };
        assert!(matches!(within_limit(Duration::MAX, None, damaged), Err(SharedMemoryError::Damaged)));
    }
}
