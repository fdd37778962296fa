//! The tick's side of the mailboxes of one neighbour.
//!
//! Once per tick, [`Endpoint::exchange`] copies the mailboxes both ways. On the 40 ms grid it takes a lock only if it
//! is free, and otherwise tries again in the next tick; it neither waits nor allocates. In fast clock it waits for the
//! answer to the pulse. On connection, the mailboxes that the neighbour writes are initialized (IX), and all others are
//! sent.

use std::{
    fmt, io,
    sync::{
        Arc, Mutex, PoisonError, TryLockError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    time::Duration,
};

use super::{
    ClockKind, NetEvent, Role,
    shared::{EndpointHandle, Shared, initialized, locked},
};
use neighbours::mailbox::{Mailbox, Place};

/// Time between two checks for an interruption while a tick waits for a neighbour.
const LOOK: Duration = Duration::from_millis(50);
/// Time for which the end of a run waits for its last session to send the disconnect reason.
const CLOSING_LIMIT: Duration = Duration::from_secs(2);

pub struct Endpoint {
    shared: Arc<Shared>,
    outgoing: Vec<Mailbox>,
    incoming: Vec<Mailbox>,
    session: u32, // number of the last session known to the tick
    events: (Sender<NetEvent>, Receiver<NetEvent>),
    /// Set when the run is to end. The tick then no longer waits for a neighbour.
    interrupted: Arc<AtomicBool>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Presence {
    pub connected: bool,
    /// True if the neighbour has connected since the last exchange. Its mailboxes were then initialized.
    pub new: bool,
    /// True if the neighbour has been connected at some time, even if only between two exchanges.
    pub was_connected: bool,
}

impl Endpoint {
    /// An unconnected endpoint with initialized mailboxes. Fails if the system has no descriptor left.
    pub fn new(role: Role, clock: ClockKind) -> io::Result<Self> {
        Ok(Self {
            shared: Arc::new(Shared::new(role, clock)?),
            outgoing: initialized(role.from_controller()),
            incoming: initialized(role.to_controller()),
            session: 0,
            events: channel(),
            interrupted: Arc::default(),
        })
    }

    /// Stops waiting when `interrupted` is set. An exchange then uses the mailboxes that have arrived.
    #[must_use]
    pub fn until(mut self, interrupted: Arc<AtomicBool>) -> Self {
        self.interrupted = interrupted;
        self
    }

    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    #[must_use]
    pub fn handle(&self) -> EndpointHandle {
        EndpointHandle { shared: Arc::clone(&self.shared), events: self.events.0.clone() }
    }

    /// A handle that stops the endpoint from another thread.
    #[must_use]
    pub fn stop_handle(&self) -> StopHandle {
        StopHandle { shared: Arc::clone(&self.shared) }
    }

    #[must_use]
    pub fn clock(&self) -> ClockKind {
        self.shared.clock
    }

    #[must_use]
    pub fn role(&self) -> Role {
        self.shared.role
    }

    /// A mailbox to the neighbour, for writing. Panics if the neighbour has no such mailbox.
    pub fn outgoing(&mut self, place: Place) -> &mut Mailbox {
        let mailbox = self.outgoing.iter_mut().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not go to {}", self.shared.role))
    }

    /// A mailbox from the neighbour, as it was at the last exchange. Panics if the neighbour has no such mailbox.
    #[must_use]
    pub fn incoming(&self, place: Place) -> &Mailbox {
        let mailbox = self.incoming.iter().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not come from {}", self.shared.role))
    }

    /// The oldest event that has not been returned.
    pub fn event(&self) -> Option<NetEvent> {
        self.events.1.try_recv().ok()
    }

    /// Once per tick: send the written mailboxes, and fetch the arrived ones. In fast clock it waits for the neighbour.
    pub fn exchange(&mut self, tick: u64) -> Presence {
        let session = self.shared.session.load(Ordering::Acquire);
        let waits = self.shared.clock == ClockKind::Fast && session != 0;
        for (ours, shared) in self.outgoing.iter().zip(&self.shared.outgoing) {
            with(shared, waits, |theirs| {
                if theirs != ours {
                    theirs.clone_from(ours);
                }
            });
        }
        self.shared.pulse.store(tick, Ordering::Release);
        self.shared.wake();
        let answered = waits && self.wait(tick, session);
        let new = session != 0 && session != self.session;
        self.session = session;
        for (ours, shared) in self.incoming.iter_mut().zip(&self.shared.incoming) {
            with(shared, waits, |theirs| {
                if theirs != ours {
                    ours.clone_from(theirs);
                }
            });
        }
        let now = self.shared.session.load(Ordering::Acquire);
        if now != session && now != 0 {
            // A session that has begun meanwhile is used from the next tick on.
            self.incoming.iter_mut().for_each(Mailbox::initialize);
        }
        // A neighbour that has answered the pulse is treated as connected, so that a run ends in the same tick every
        // time. After an interruption the session decides.
        let asked = waits && !self.is_interrupted();
        let connected = answered || (!asked && session != 0 && now == session);
        let connected = connected && !self.shared.is_over();
        Presence { connected, new, was_connected: self.shared.sessions.load(Ordering::Acquire) != 0 }
    }

    /// Wait until the neighbour has answered or disconnected, or the run is to end. Returns true if it has answered. A
    /// neighbour that does not answer in time loses its session.
    fn wait(&self, tick: u64, session: u32) -> bool {
        let mut answered = locked(&self.shared.answered);
        while *answered < tick
            && self.shared.session.load(Ordering::Acquire) == session
            && !self.shared.is_over()
            && !self.is_interrupted()
        {
            // A signal does not wake this thread, so it checks for an interruption at intervals.
            let look = self.shared.changed.wait_timeout(answered, LOOK);
            (answered, _) = look.unwrap_or_else(PoisonError::into_inner);
        }
        *answered >= tick
    }
}

/// Use a shared mailbox. If it is locked and the tick does not wait, skip it in this tick.
fn with(shared: &Mutex<Mailbox>, waits: bool, look: impl FnOnce(&mut Mailbox)) {
    if waits {
        look(&mut locked(shared));
        return;
    }
    match shared.try_lock() {
        Ok(mut mailbox) => look(&mut mailbox),
        Err(TryLockError::Poisoned(poisoned)) => look(&mut poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => {}
    }
}

impl Drop for Endpoint {
    fn drop(&mut self) {
        self.shared.end();
        let connected = |_: &mut u64| self.shared.session.load(Ordering::Acquire) != 0;
        let answered = locked(&self.shared.answered);
        drop(self.shared.changed.wait_timeout_while(answered, CLOSING_LIMIT, connected));
    }
}

/// Stops an endpoint, even while a thread waits in it. The neighbour is disconnected, and no other one is admitted.
#[derive(Clone)]
pub struct StopHandle {
    shared: Arc<Shared>,
}

impl StopHandle {
    pub fn stop(&self) {
        self.shared.end();
    }
}

impl fmt::Debug for StopHandle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StopHandle").field("role", &self.shared.role).finish_non_exhaustive()
    }
}

#[cfg(test)]
pub(crate) mod tests;
