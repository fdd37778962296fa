//! The mailboxes of one neighbour, which the tick ([`Endpoint`](super::Endpoint)) and the threads of the network share.
//! [`EndpointHandle`] stores mailboxes that arrive, [`Link`] collects those to send.

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
use neighbours::mailbox::{Mailbox, MailboxError, Place};

pub const OVER: &str = "the run is over";

pub(super) struct Shared {
    pub role: Role,
    pub clock: ClockKind,
    pub outgoing: Vec<Mutex<Mailbox>>,
    pub incoming: Vec<Mutex<Mailbox>>,
    /// Number of the session; 0 while there is none.
    pub session: AtomicU32,
    pub sessions: AtomicU32,
    /// The latest tick whose mailboxes were written.
    pub pulse: AtomicU64,
    /// The last pulse that the neighbour has answered. It is in a mutex, because a tick may wait for its change.
    pub answered: Mutex<u64>,
    /// Notified when `answered`, `session` or `over` changes.
    pub changed: Condvar,
    /// True if the run is over, so that no other session begins.
    pub over: AtomicBool,
    wake: OwnedFd, // event descriptor that wakes the thread of the session
}

/// Lock a mutex, even after a panic in another thread, because the data of the network are always consistent.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

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

    /// Wake the thread of the session, if any. Neither blocks nor allocates.
    pub fn wake(&self) {
        // The write fails only if the counter is full, and then the thread wakes anyway.
        let _ = rustix::io::write(&self.wake, &1_u64.to_ne_bytes());
    }

    /// End the session, and accept no other.
    pub fn end(&self) {
        // A waiting tick checks the flag under this lock.
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

/// Why a neighbour is refused a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AttachError {
    #[error("{0} is connected already")]
    Occupied(Role),
    #[error("{OVER}")]
    Over,
}

impl EndpointHandle {
    #[must_use]
    pub fn role(&self) -> Role {
        self.shared.role
    }

    #[must_use]
    pub fn clock(&self) -> ClockKind {
        self.shared.clock
    }

    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.shared.session.load(Ordering::Acquire) != 0
    }

    #[must_use]
    pub fn was_connected(&self) -> bool {
        self.shared.sessions.load(Ordering::Acquire) != 0
    }

    pub(super) fn tell(&self, event: NetEvent) {
        // This fails only after the run has ended, when nothing reads events.
        let _ = self.events.send(event);
    }

    /// Begin a session: the mailboxes that the neighbour writes are initialized (IX).
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
        // The pulse is read before the session is stored. A tick with this session waits for its own pulse.
        let pulse = self.shared.pulse.load(Ordering::Acquire);
        let number = self.shared.sessions.fetch_add(1, Ordering::AcqRel).wrapping_add(1).max(1);
        self.shared.session.store(number, Ordering::Release);
        self.shared.changed.notify_all();
        drop(answered);
        self.tell(NetEvent::Connected(self.shared.role));
        let sent = initialized(self.shared.role.from_controller());
        self.shared.wake();
        Ok(Link { handle: self.clone(), sent, pulse })
    }

    pub(crate) fn detach(&self, why: Disconnect) {
        // The event precedes the change, so that a tick that finds no session also finds the reason.
        self.tell(NetEvent::Disconnected(self.shared.role, why));
        let _answered = locked(&self.shared.answered);
        self.shared.session.store(0, Ordering::Release);
        self.shared.changed.notify_all();
    }

    /// Store a mailbox from the neighbour; `used` is the used part of its bytes. Panics if the neighbour does not write
    /// this mailbox.
    pub(crate) fn deliver(&self, place: Place, used: &[u8]) -> Result<(), MailboxError> {
        let at = self.shared.role.to_controller().iter().position(|own| *own == place);
        locked(&self.shared.incoming[at.expect("a session takes its neighbour's mailboxes only")])
            .receive(used)
    }

    /// Record that the neighbour has answered all pulses up to that of `tick`.
    pub(super) fn answer(&self, tick: u64) {
        let mut answered = locked(&self.shared.answered);
        *answered = tick.max(*answered);
        self.shared.changed.notify_all();
    }
}

/// Data that the session sends to the neighbour.
pub(super) enum Outgoing<'a> {
    Mailbox(&'a Mailbox),
    Pulse(u64),
}

pub(super) struct Link {
    pub handle: EndpointHandle,
    sent: Vec<Mailbox>,
    pulse: u64,
}

impl Link {
    /// Descriptor that is readable when data are to be sent or the run is over.
    pub fn wake(&self) -> BorrowedFd<'_> {
        self.handle.shared.wake.as_fd()
    }

    pub fn is_over(&self) -> bool {
        self.handle.shared.is_over()
    }

    /// Send changed mailboxes, then the pulse.
    pub fn collect(&mut self, mut send: impl FnMut(Outgoing<'_>)) {
        let shared = &self.handle.shared;
        // If this fails, the thread only wakes once more than necessary.
        let _ = rustix::io::read(&shared.wake, &mut [0; 8]);
        // The pulse is read first. The mailboxes, read after it, then contain everything that its tick has written.
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
