//! The accept queue: connections that have not yet sent a hello.
//!
//! It is short, so that unknown clients cost little. When it is full, the oldest connection without a hello is closed
//! after a minimum time: silent clients cannot block others. A refused connection keeps its slot for that time, so that
//! clients can neither guess quickly nor fill the log.

use std::{
    io,
    net::Shutdown,
    os::unix::net::UnixStream,
    sync::Mutex,
    time::{Duration, Instant},
};

use super::shared::locked;

pub(super) const SLOTS: usize = 8;
/// Minimum time in a slot. It is enough for a hello, and it is the penalty for a wrong hello.
pub(super) const SAFE: Duration = Duration::from_secs(1);

#[derive(Default)]
pub(super) struct AcceptQueue {
    inner: Mutex<Inner>,
}

#[derive(Default)]
struct Inner {
    last: u64,
    slots: [Option<Waiting>; SLOTS],
}

struct Waiting {
    ticket: u64,
    since: Instant,
    stream: UnixStream,
}

/// A slot, released on drop, unless another connection has already taken it.
pub(super) struct Slot<'a> {
    queue: &'a AcceptQueue,
    ticket: u64,
}

impl AcceptQueue {
    /// Give a connection a slot, if necessary the slot of the oldest connection. Returns its ticket, if a slot is free.
    pub fn enter(&self, stream: &UnixStream) -> io::Result<Option<u64>> {
        let stream = stream.try_clone()?;
        let mut inner = locked(&self.inner);
        let now = Instant::now();
        let waited = |slot: &Option<Waiting>| slot.as_ref().map_or(Duration::MAX, |other| now - other.since);
        let Some(longest) = inner.slots.iter().map(waited).max().filter(|longest| *longest >= SAFE) else {
            return Ok(None);
        };
        inner.last += 1;
        let ticket = inner.last;
        let slot = inner.slots.iter_mut().find(|slot| waited(slot) == longest);
        if let Some(before) = slot.and_then(|slot| slot.replace(Waiting { ticket, since: now, stream })) {
            let _ = before.stream.shutdown(Shutdown::Both);
        }
        Ok(Some(ticket))
    }

    pub const fn slot(&self, ticket: u64) -> Slot<'_> {
        Slot { queue: self, ticket }
    }
}

impl Drop for Slot<'_> {
    fn drop(&mut self) {
        let mut inner = locked(&self.queue.inner);
        for slot in &mut inner.slots {
            slot.take_if(|waiting| waiting.ticket == self.ticket);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    fn connection() -> (UnixStream, UnixStream) {
        UnixStream::pair().unwrap()
    }

    fn wait(queue: &AcceptQueue, time: Duration) {
        locked(&queue.inner).slots.iter_mut().flatten().for_each(|waiting| waiting.since -= time);
    }

    #[test]
    fn oldest_connection_is_closed_for_a_new_one() {
        let queue = AcceptQueue::default();
        let mut silent: Vec<_> = (0..SLOTS)
            .map(|_| {
                wait(&queue, Duration::from_millis(1));
                let (ours, theirs) = connection();
                assert!(queue.enter(&ours).unwrap().is_some());
                (ours, theirs)
            })
            .collect();
        assert_eq!(queue.enter(&connection().0).unwrap(), None, "all slots are safe");
        wait(&queue, SAFE);
        assert!(queue.enter(&connection().0).unwrap().is_some());
        assert_eq!(silent[0].1.read(&mut [0]).unwrap(), 0, "the first was closed");
        silent[1].1.set_nonblocking(true).unwrap();
        assert_eq!(silent[1].1.read(&mut [0]).unwrap_err().kind(), io::ErrorKind::WouldBlock);
    }

    #[test]
    fn slot_is_released_only_by_its_own_ticket() {
        let queue = AcceptQueue::default();
        let tickets: Vec<_> = (0..SLOTS).filter_map(|_| queue.enter(&connection().0).unwrap()).collect();
        drop(queue.slot(tickets[3]));
        assert!(queue.enter(&connection().0).unwrap().is_some());
        drop(queue.slot(tickets[3]));
        assert_eq!(queue.enter(&connection().0).unwrap(), None, "another connection has it now");
    }
}
