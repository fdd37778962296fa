//! Limits for what iceoryx2 sets up or opens.
//!
//! It follows indices and flags in shared memory. If another program damages these while a run is set up, iceoryx2
//! 0.10.0 can panic, which becomes an error here, or wait for a flag that never comes. Such a call cannot be cancelled:
//! only the whole process can be ended.

use std::{
    panic::{self, AssertUnwindSafe},
    sync::mpsc::{self, RecvTimeoutError},
    thread,
    time::Duration,
};

use super::{error::SharedMemoryError, place::root};

/// Longest time that shared memory may take to set up or to open: it usually takes some milliseconds, on a busy machine
/// up to a second.
pub const SET_UP_LIMIT: Duration = Duration::from_secs(20);

/// Called with the limit, on a separate thread, when it has passed. It should end the process, because the other call
/// does not return.
pub type OnStuck = fn(Duration);

/// Set up or open something. If this takes longer than `limit`, `on_stuck` is called; without it there is no limit.
///
/// # Errors
/// Those of `work`, [`SharedMemoryError::Damaged`] if it panics, and [`SharedMemoryError::Io`] if there is no
/// thread to watch it.
pub fn within_limit<T, E: From<SharedMemoryError>>(
    limit: Duration,
    on_stuck: Option<OnStuck>,
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    // What a panic leaves half done belongs to `work`, and is dropped with it.
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
