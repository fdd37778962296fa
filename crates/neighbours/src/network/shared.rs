//! The mailboxes of one neighbour, between the tick and the threads of the network; and the side of the
//! network.
//!
//! [`EndpointHandle`] puts in what arrives, [`Link`] takes out what is new. The tick's side is an
//! [`Endpoint`](super::Endpoint).

use std::{
    fmt, io,
    os::fd::{AsFd, BorrowedFd, OwnedFd},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
        mpsc::Sender,
    },
};

use rustix::event::{EventfdFlags, eventfd};

use super::{ClockKind, Disconnect, NetEvent, Role};
use crate::mailbox::{Mailbox, MailboxError, Place};

/// Disconnect reason of a run that has ended.
pub const OVER: &str = "the run is over";

/// State that both sides share.
pub(super) struct Shared {
    pub role: Role,
    pub clock: ClockKind,
    /// Written by the tick.
    pub outgoing: Vec<Mutex<Mailbox>>,
    /// Written by the neighbour.
    pub incoming: Vec<Mutex<Mailbox>>,
    /// Number of the session; 0 while there is none.
    pub session: AtomicU32,
    /// Sessions so far.
    pub sessions: AtomicU32,
    /// The last tick that was run.
    pub pulse: AtomicU64,
    /// The last pulse that was answered. Behind a lock, since a tick may wait for it.
    pub answered: Mutex<u64>,
    /// `answered`, `session` or `over` have changed.
    pub changed: Condvar,
    /// No more sessions: the run is over.
    pub over: AtomicBool,
    /// Wakes the thread of the session.
    wake: OwnedFd,
}

/// Lock a mutex, also after a panic in another thread: the data behind the locks of the network are always consistent.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Initialized mailboxes.
pub(super) fn initialized(places: &[Place]) -> Vec<Mailbox> {
    places.iter().map(|&place| Mailbox::initialized(place)).collect()
}

impl Shared {
    pub fn new(role: Role, clock: ClockKind) -> io::Result<Self> {
        let mailboxes = |places| initialized(places).into_iter().map(Mutex::new).collect();
        Ok(Self {
            role,
            clock,
            outgoing: mailboxes(role.from_controller()),
            incoming: mailboxes(role.to_controller()),
            session: AtomicU32::new(0),
            sessions: AtomicU32::new(0),
            pulse: AtomicU64::new(0),
            answered: Mutex::new(0),
            changed: Condvar::new(),
            over: AtomicBool::new(false),
            wake: eventfd(0, EventfdFlags::CLOEXEC | EventfdFlags::NONBLOCK)?,
        })
    }

    /// Wake the thread of the session, if there is one. Does not block or allocate.
    pub fn wake(&self) {
        // The counter is full only if the thread is awake anyway.
        let _ = rustix::io::write(&self.wake, &1_u64.to_ne_bytes());
    }

    /// End the session, and accept no other.
    pub fn end(&self) {
        // The tick that waits looks at the flag behind this lock.
        let answered = locked(&self.answered);
        self.over.store(true, Ordering::Release);
        self.changed.notify_all();
        drop(answered);
        self.wake();
    }

    pub fn is_over(&self) -> bool {
        self.over.load(Ordering::Acquire)
    }
}

/// The side of the network.
#[derive(Clone)]
pub struct EndpointHandle {
    pub(super) shared: Arc<Shared>,
    pub(super) events: Sender<NetEvent>,
}

impl fmt::Debug for EndpointHandle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EndpointHandle").field("role", &self.shared.role).finish_non_exhaustive()
    }
}

/// Why a neighbour gets no session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AttachError {
    /// It has a session already.
    #[error("{0} is connected already")]
    Occupied(Role),
    /// The run is over.
    #[error("{OVER}")]
    Over,
}

impl EndpointHandle {
    /// Which neighbour it is for.
    #[must_use]
    pub fn role(&self) -> Role {
        self.shared.role
    }

    /// The clock of the controller.
    #[must_use]
    pub fn clock(&self) -> ClockKind {
        self.shared.clock
    }

    /// The neighbour is connected.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.shared.session.load(Ordering::Acquire) != 0
    }

    /// The neighbour has been connected at some time.
    #[must_use]
    pub fn was_connected(&self) -> bool {
        self.shared.sessions.load(Ordering::Acquire) != 0
    }

    /// Tell the controller what happened.
    pub(super) fn tell(&self, event: NetEvent) {
        // A run that is over does not listen.
        let _ = self.events.send(event);
    }

    /// Begin a session: the mailboxes that the neighbour writes are initialized (IX).
    ///
    /// # Errors
    /// [`AttachError`].
    pub(super) fn attach(&self) -> Result<Link, AttachError> {
        let mut answered = locked(&self.shared.answered);
        if self.shared.is_over() {
            return Err(AttachError::Over);
        }
        if self.is_connected() {
            return Err(AttachError::Occupied(self.shared.role));
        }
        for mailbox in &self.shared.incoming {
            locked(mailbox).initialize();
        }
        *answered = 0;
        // In front of the session: the tick that finds one waits for the answer to its own pulse.
        let pulse = self.shared.pulse.load(Ordering::Acquire);
        let number = self.shared.sessions.fetch_add(1, Ordering::AcqRel).wrapping_add(1).max(1);
        self.shared.session.store(number, Ordering::Release);
        self.shared.changed.notify_all();
        drop(answered);
        self.tell(NetEvent::Connected(self.shared.role));
        let sent = initialized(self.shared.role.from_controller());
        // What stands in the mailboxes goes out at once.
        self.shared.wake();
        Ok(Link { handle: self.clone(), sent, pulse })
    }

    /// End the session.
    pub(crate) fn detach(&self, why: Disconnect) {
        // In front of the change: a tick that finds no session finds the reason, too.
        self.tell(NetEvent::Disconnected(self.shared.role, why));
        let _answered = locked(&self.shared.answered);
        self.shared.session.store(0, Ordering::Release);
        self.shared.changed.notify_all();
    }

    /// A mailbox has come from the neighbour.
    ///
    /// # Errors
    /// [`MailboxError`] if the mailbox cannot hold it.
    ///
    /// # Panics
    /// If the neighbour has no such mailbox: its session takes no other.
    pub(crate) fn deliver(&self, place: Place, used: &[u8]) -> Result<(), MailboxError> {
        let at = self.shared.role.to_controller().iter().position(|own| *own == place);
        locked(&self.shared.incoming[at.expect("a session takes its neighbour's mailboxes only")])
            .receive(used)
    }

    /// The neighbour has answered all pulses up to one.
    pub(super) fn answer(&self, tick: u64) {
        let mut answered = locked(&self.shared.answered);
        *answered = tick.max(*answered);
        self.shared.changed.notify_all();
    }
}

/// Something to send for the tick.
pub(super) enum Outgoing<'a> {
    /// A mailbox that has changed.
    Mailbox(&'a Mailbox),
    /// The pulse of a tick.
    Pulse(u64),
}

/// The state of a session: which mailboxes were sent already.
pub(super) struct Link {
    pub handle: EndpointHandle,
    sent: Vec<Mailbox>,
    pulse: u64,
}

impl Link {
    /// Readable when there is something to send, or the run is over.
    pub fn wake(&self) -> BorrowedFd<'_> {
        self.handle.shared.wake.as_fd()
    }

    /// The run is over.
    pub fn is_over(&self) -> bool {
        self.handle.shared.is_over()
    }

    /// Send what is new: mailboxes, then the pulse.
    pub fn collect(&mut self, mut send: impl FnMut(Outgoing<'_>)) {
        let shared = &self.handle.shared;
        // A number that is left there wakes the thread once more, for nothing.
        let _ = rustix::io::read(&shared.wake, &mut [0; 8]);
        // The tick first: what it wrote stands in the mailboxes already.
        let tick = shared.pulse.load(Ordering::Acquire);
        for (mailbox, sent) in shared.outgoing.iter().zip(&mut self.sent) {
            let mailbox = locked(mailbox);
            if *mailbox != *sent {
                sent.clone_from(&mailbox);
                drop(mailbox);
                send(Outgoing::Mailbox(sent));
            }
        }
        if tick != self.pulse {
            self.pulse = tick;
            send(Outgoing::Pulse(tick));
        }
    }
}
