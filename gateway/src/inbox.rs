//! The received payloads of a claim. Zenoh's threads fill it and never wait; the claim's thread empties it.

use std::{
    collections::VecDeque,
    io,
    os::fd::{AsFd, BorrowedFd, OwnedFd},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use rustix::event::{EventfdFlags, eventfd};

const LINES: usize = 16 * 1024; // greatest number of bytes of an operator's lines that wait

#[derive(Debug, Default)]
struct Contents {
    payloads: VecDeque<Vec<u8>>,
    bytes: usize,
    is_gone: bool,       // the other side has gone without an end
    has_overflown: bool, // lines were lost, because the claim's thread did not take them
}

#[derive(Debug)]
pub struct Inbox {
    is_state: bool, // only the latest payload counts
    contents: Mutex<Contents>,
    wake: OwnedFd,
    is_stopped: AtomicBool,
}

impl Inbox {
    /// With `is_state` only the latest payload is kept, as for samples. Otherwise payloads wait in order, as lines do.
    pub fn new(is_state: bool) -> io::Result<Self> {
        let wake = eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?;
        Ok(Self { is_state, contents: Mutex::default(), wake, is_stopped: AtomicBool::new(false) })
    }

    fn contents(&self) -> MutexGuard<'_, Contents> {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wake(&self) {
        // The write fails only if the counter is full, and then the thread wakes anyway.
        let _ = rustix::io::write(&self.wake, &1_u64.to_ne_bytes());
    }

    /// Deliver a payload. Does not wait.
    pub fn deliver(&self, payload: Vec<u8>) {
        let mut contents = self.contents();
        if self.is_state {
            contents.payloads.clear();
            contents.bytes = 0;
        }
        if contents.bytes.saturating_add(payload.len()) > LINES && !contents.payloads.is_empty() {
            contents.has_overflown = true;
        } else {
            contents.bytes = contents.bytes.saturating_add(payload.len());
            contents.payloads.push_back(payload);
        }
        drop(contents);
        self.wake();
    }

    pub fn set_gone(&self) {
        self.contents().is_gone = true;
        self.wake();
    }

    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Release);
        self.wake();
    }

    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Acquire)
    }

    #[must_use]
    pub fn is_gone(&self) -> bool {
        self.contents().is_gone
    }

    #[must_use]
    pub fn has_overflown(&self) -> bool {
        self.contents().has_overflown
    }

    #[must_use]
    pub fn take(&self) -> Option<Vec<u8>> {
        // The read fails if nothing has woken the thread.
        let _ = rustix::io::read(&self.wake, &mut [0; 8]);
        let mut contents = self.contents();
        let payload = contents.payloads.pop_front()?;
        contents.bytes = contents.bytes.saturating_sub(payload.len());
        let is_more = !contents.payloads.is_empty();
        drop(contents);
        if is_more {
            self.wake();
        }
        Some(payload)
    }
}

impl AsFd for Inbox {
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.wake.as_fd()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_inbox_keeps_the_latest_sample_and_line_inbox_keeps_all() {
        for (is_state, expected) in [(true, vec![vec![2]]), (false, vec![vec![1], vec![2]])] {
            let inbox = Inbox::new(is_state).unwrap();
            inbox.deliver(vec![1]);
            inbox.deliver(vec![2]);
            let found: Vec<_> = std::iter::from_fn(|| inbox.take()).collect();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn flooded_line_inbox_stays_small_and_reports_the_loss() {
        let inbox = Inbox::new(false).unwrap();
        (0..10_000).for_each(|_| inbox.deliver(vec![b'x'; 100]));
        assert!(inbox.has_overflown());
        assert!(std::iter::from_fn(|| inbox.take()).map(|line| line.len()).sum::<usize>() <= LINES);
    }
}
