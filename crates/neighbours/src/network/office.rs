//! The mailboxes of one neighbour, between the tick and the threads of the network.
//!
//! [`Desk`] is the tick's side. [`Desk::exchange`] copies what the controller has written into the shared mailboxes and what the
//! neighbour has written out of them, once a tick. On the 40 ms grid it takes a lock only if nobody has it, and else tries again
//! in the next tick; it does not wait and does not allocate. [`Counter`] is the side of the network: it puts in what arrives,
//! and a thread ([`Desk`] starts it) sends what is new.
//!
//! A neighbour comes and goes. When one comes, the mailboxes that he writes are initialized (IX), and all that he reads are
//! sent.

use std::{
    io,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::{
    News, Parting, Role,
    frame::{Frame, FrameError},
    hello::ClockKind,
};
use crate::mailbox::{Mailbox, Place};

/// Last words of a run that has ended.
pub const OVER: &str = "the run is over";

/// Between two looks at whether the run is interrupted while a tick waits for a neighbour.
const LOOK: Duration = Duration::from_millis(50);

/// Where frames go out to a neighbour.
pub trait Outlet: Send {
    /// Send a frame, and its seal behind it where a secret was agreed upon.
    ///
    /// # Errors
    /// If it cannot be sent: then the neighbour is gone.
    fn send(&mut self, frame: &Frame) -> io::Result<()>;

    /// End the connection, so that whoever reads from it notices.
    fn close(&mut self);
}

/// What both sides see.
struct Shared {
    role: Role,
    /// Written by the tick.
    outgoing: Vec<Mutex<Mailbox>>,
    /// Written by the neighbour.
    incoming: Vec<Mutex<Mailbox>>,
    /// Number of the connection; 0 while there is none.
    connection: AtomicU32,
    /// The last tick that was run.
    pulse: AtomicU64,
    /// What came back of the pulses. Behind a lock, since a tick may wait for it.
    answered: Mutex<Answered>,
    news_of_answer: Condvar,
    outlet: Mutex<Option<Box<dyn Outlet>>>,
    over: AtomicBool,
}

/// What came back of the pulses.
#[derive(Clone, Copy)]
struct Answered {
    /// The last one.
    tick: u64,
    /// When it came, or when the one behind it was sent: since then an answer has been due.
    due: Instant,
}

/// A panic in another thread is reported where it happened; what is behind the locks of the network is whole whatever happens.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The tick's side.
pub struct Desk {
    shared: Arc<Shared>,
    clock: ClockKind,
    outgoing: Vec<Mailbox>,
    incoming: Vec<Mailbox>,
    /// Number of the connection that the tick knows of.
    connection: u32,
    news: (Sender<News>, Receiver<News>),
    /// Connections so far.
    numbers: Arc<AtomicU32>,
    carrier: Option<JoinHandle<()>>,
    /// The run is to end: nobody is waited for any longer.
    interrupted: Arc<AtomicBool>,
}

/// What an exchange found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Presence {
    /// The neighbour is there.
    pub here: bool,
    /// He has come since the last exchange: his mailboxes were initialized.
    pub new: bool,
    /// He has been there at some time, if only between two exchanges.
    pub came: bool,
}

impl Desk {
    /// The mailboxes of a neighbour, initialized; nobody is there yet.
    #[must_use]
    pub fn new(role: Role, clock: ClockKind) -> Self {
        let boxes =
            |places: &[Place]| places.iter().map(|&place| Mailbox::initialized(place)).collect::<Vec<_>>();
        let (outgoing, incoming) = (boxes(role.from_controller()), boxes(role.to_controller()));
        let shared = Arc::new(Shared {
            role,
            outgoing: outgoing.iter().cloned().map(Mutex::new).collect(),
            incoming: incoming.iter().cloned().map(Mutex::new).collect(),
            connection: AtomicU32::new(0),
            pulse: AtomicU64::new(0),
            answered: Mutex::new(Answered { tick: 0, due: Instant::now() }),
            news_of_answer: Condvar::new(),
            outlet: Mutex::new(None),
            over: AtomicBool::new(false),
        });
        let theirs = Arc::clone(&shared);
        let carrier = Some(thread::spawn(move || carry(&theirs)));
        Self {
            shared,
            clock,
            outgoing,
            incoming,
            connection: 0,
            news: channel(),
            numbers: Arc::default(),
            carrier,
            interrupted: Arc::default(),
        }
    }

    /// The same, at which nobody is waited for once the run is `interrupted`: an exchange takes what is there then.
    #[must_use]
    pub fn until(mut self, interrupted: Arc<AtomicBool>) -> Self {
        self.interrupted = interrupted;
        self
    }

    /// The run is to end.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// The network's side.
    #[must_use]
    pub fn counter(&self) -> Counter {
        Counter {
            shared: Arc::clone(&self.shared),
            clock: self.clock,
            news: self.news.0.clone(),
            numbers: Arc::clone(&self.numbers),
        }
    }

    /// Ends the desk from another thread.
    #[must_use]
    pub fn closer(&self) -> Closer {
        Closer { shared: Arc::clone(&self.shared) }
    }

    /// The clock of the run.
    #[must_use]
    pub const fn clock(&self) -> ClockKind {
        self.clock
    }

    /// Who the neighbour is.
    #[must_use]
    pub fn role(&self) -> Role {
        self.shared.role
    }

    /// A mailbox to the neighbour, to be written.
    ///
    /// # Panics
    /// If the neighbour has no such mailbox.
    pub fn outgoing(&mut self, place: Place) -> &mut Mailbox {
        let mailbox = self.outgoing.iter_mut().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not go to {}", self.shared.role))
    }

    /// A mailbox from the neighbour, as it was at the last exchange.
    ///
    /// # Panics
    /// If the neighbour has no such mailbox.
    #[must_use]
    pub fn incoming(&self, place: Place) -> &Mailbox {
        let mailbox = self.incoming.iter().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not come from {}", self.shared.role))
    }

    /// What happened since the last call, the oldest first.
    pub fn news(&self) -> Option<News> {
        self.news.1.try_recv().ok()
    }

    /// Once a tick: the network gets what was written in it, and the tick what has come. In fast clock a neighbour who is there is
    /// waited for.
    pub fn exchange(&mut self, tick: u64) -> Presence {
        let connection = self.shared.connection.load(Ordering::Acquire);
        let waits = self.clock == ClockKind::Fast && connection != 0;
        for (ours, shared) in self.outgoing.iter().zip(&self.shared.outgoing) {
            with(shared, waits, |theirs| {
                if theirs != ours {
                    theirs.clone_from(ours);
                }
            });
        }
        self.shared.pulse.store(tick, Ordering::Release);
        if let Some(carrier) = &self.carrier {
            carrier.thread().unpark();
        }
        let answered = waits && self.wait(tick, connection);
        let new = connection != 0 && connection != self.connection;
        self.connection = connection;
        for (ours, shared) in self.incoming.iter_mut().zip(&self.shared.incoming) {
            with(shared, waits, |theirs| {
                if theirs != ours {
                    ours.clone_from(theirs);
                }
            });
        }
        let now = self.shared.connection.load(Ordering::Acquire);
        if now != connection && now != 0 {
            // Somebody who has come meanwhile is somebody of the next tick.
            self.incoming.iter_mut().for_each(Mailbox::initialize);
        }
        // Who has answered was there, even if he has gone since: so a run ends in the same tick every time. Whether somebody would have
        // who is waited for no longer is not known, and need not be.
        let asked = waits && !self.is_interrupted();
        let here = answered || (!asked && connection != 0 && now == connection);
        let here = here && !self.shared.over.load(Ordering::Acquire);
        Presence { here, new, came: self.numbers.load(Ordering::Acquire) != 0 }
    }

    /// Until the neighbour has answered the pulse, or is gone, or the desk is closed, or the run is to end; true if he has answered.
    /// Whoever reads from him notices if he is silent.
    fn wait(&self, tick: u64, connection: u32) -> bool {
        let mut answered = locked(&self.shared.answered);
        while answered.tick < tick
            && self.shared.connection.load(Ordering::Acquire) == connection
            && !self.shared.over.load(Ordering::Acquire)
            && !self.is_interrupted()
        {
            // A signal wakes nobody here.
            let look = self.shared.news_of_answer.wait_timeout(answered, LOOK);
            (answered, _) = look.unwrap_or_else(PoisonError::into_inner);
        }
        answered.tick >= tick
    }
}

/// Look at a shared mailbox; if somebody else does and the tick does not wait, another time.
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

impl Drop for Desk {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Release);
        if let Some(carrier) = self.carrier.take() {
            carrier.thread().unpark();
            // It has nothing to return, and a panic in it was reported.
            let _ = carrier.join();
        }
    }
}

/// Ends a desk while somebody may be waiting at it: nobody is there any more, and nobody is let in.
#[derive(Clone)]
pub struct Closer {
    shared: Arc<Shared>,
}

impl Closer {
    /// End it.
    pub fn close(&self) {
        // Whoever waits looks at the flag behind this lock.
        let answered = locked(&self.shared.answered);
        self.shared.over.store(true, Ordering::Release);
        self.shared.news_of_answer.notify_all();
        drop(answered);
    }
}

impl std::fmt::Debug for Closer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Closer").field("role", &self.shared.role).finish_non_exhaustive()
    }
}

/// The thread that sends: what is new, and then the pulse.
fn carry(shared: &Shared) {
    let initialized =
        || shared.role.from_controller().iter().map(|&place| Mailbox::initialized(place)).collect();
    let (mut sent, mut connection, mut pulse): (Vec<Mailbox>, _, _) = (initialized(), 0, 0);
    while !shared.over.load(Ordering::Acquire) {
        thread::park_timeout(Duration::from_secs(1));
        let present = shared.connection.load(Ordering::Acquire);
        if present != connection {
            connection = present;
            sent = initialized();
        }
        if connection == 0 {
            continue;
        }
        // The tick first: what it wrote stands in the mailboxes already.
        let tick = shared.pulse.load(Ordering::Acquire);
        let mut outlet = locked(&shared.outlet);
        let Some(line) = outlet.as_mut() else { continue };
        let sending = send_new(shared, &mut sent, line.as_mut()).and_then(|()| {
            if tick == pulse { Ok(()) } else { send_pulse(shared, pulse, tick, line.as_mut()) }
        });
        pulse = tick;
        if sending.is_err() {
            line.close();
        }
    }
    if let Some(line) = locked(&shared.outlet).as_mut() {
        // He may be gone already.
        let _ = line.send(&Frame::last_words(OVER));
        line.close();
    }
}

/// Send a pulse behind the one before. Whoever has answered that one has his whole time for this one.
fn send_pulse(shared: &Shared, before: u64, tick: u64, line: &mut dyn Outlet) -> io::Result<()> {
    let mut answered = locked(&shared.answered);
    if answered.tick >= before {
        answered.due = Instant::now();
    }
    drop(answered);
    line.send(&Frame::pulse(tick))
}

fn send_new(shared: &Shared, sent: &mut [Mailbox], line: &mut dyn Outlet) -> io::Result<()> {
    for (mailbox, sent) in shared.outgoing.iter().zip(sent) {
        let mailbox = locked(mailbox).clone();
        if mailbox != *sent {
            line.send(&Frame::of(&mailbox))?;
            *sent = mailbox;
        }
    }
    Ok(())
}

/// The side of the network.
#[derive(Clone)]
pub struct Counter {
    shared: Arc<Shared>,
    clock: ClockKind,
    news: Sender<News>,
    numbers: Arc<AtomicU32>,
}

/// Why a neighbour does not come to his desk.
#[derive(Debug, thiserror::Error)]
pub enum AttachError {
    /// He is there already.
    #[error("{0} is connected already")]
    Occupied(Role),
    /// He has come too late.
    #[error("{OVER}")]
    Over,
    /// He is gone again.
    #[error(transparent)]
    Line(#[from] io::Error),
}

impl Counter {
    /// Whose it is.
    #[must_use]
    pub fn role(&self) -> Role {
        self.shared.role
    }

    /// The clock of the controller.
    #[must_use]
    pub const fn clock(&self) -> ClockKind {
        self.clock
    }

    /// The neighbour is there.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.shared.connection.load(Ordering::Acquire) != 0
    }

    /// The neighbour has been there at some time.
    #[must_use]
    pub fn has_come(&self) -> bool {
        self.numbers.load(Ordering::Acquire) != 0
    }

    /// Tell the controller what happened.
    pub fn tell(&self, news: News) {
        // A run that is over has no ears.
        let _ = self.news.send(news);
    }

    /// The neighbour comes: he is welcomed, if the outlet is where he waits for it, and his mailboxes are initialized. Whoever comes
    /// too late, or second, is told so instead.
    ///
    /// # Errors
    /// [`AttachError`].
    pub fn attach(&self, mut outlet: Box<dyn Outlet>, welcome: Option<&Frame>) -> Result<(), AttachError> {
        let mut line = locked(&self.shared.outlet);
        // First whether the run is over: then what is still there is on its way out.
        let refusal = if self.shared.over.load(Ordering::Acquire) {
            Some(AttachError::Over)
        } else {
            line.is_some().then_some(AttachError::Occupied(self.shared.role))
        };
        if let Some(refusal) = refusal {
            // He may be gone already.
            let _ = outlet.send(&Frame::last_words(&refusal.to_string()));
            outlet.close();
            return Err(refusal);
        }
        if let Some(welcome) = welcome {
            outlet.send(welcome)?;
        }
        for mailbox in &self.shared.incoming {
            locked(mailbox).initialize();
        }
        *line = Some(outlet);
        let number = self.numbers.fetch_add(1, Ordering::AcqRel).wrapping_add(1).max(1);
        let mut answered = locked(&self.shared.answered);
        *answered = Answered { tick: 0, due: Instant::now() };
        self.shared.connection.store(number, Ordering::Release);
        self.shared.news_of_answer.notify_all();
        drop(answered);
        self.tell(News::Came(self.shared.role));
        Ok(())
    }

    /// The neighbour goes; he is told why, if he still hears it.
    pub fn detach(&self, why: Parting) {
        let mut line = locked(&self.shared.outlet);
        if let Some(mut outlet) = line.take() {
            let _ = outlet.send(&Frame::last_words(&why.to_string()));
            outlet.close();
        }
        // Before the tick can find nobody there: then it finds the reason, too.
        self.tell(News::Gone(self.shared.role, why));
        let _answered = locked(&self.shared.answered);
        self.shared.connection.store(0, Ordering::Release);
        self.shared.news_of_answer.notify_all();
    }

    /// Pulses were sent, and for so long none has come back.
    #[must_use]
    pub fn is_late(&self, limit: Duration) -> bool {
        let Answered { tick, due } = *locked(&self.shared.answered);
        tick < self.shared.pulse.load(Ordering::Acquire) && due.elapsed() >= limit
    }

    /// A frame has come from the neighbour.
    ///
    /// # Errors
    /// [`DeliveryError`] if it is none of his.
    pub fn deliver(&self, frame: &Frame) -> Result<(), DeliveryError> {
        if let Some(tick) = frame.as_pulse()? {
            let sent = self.shared.pulse.load(Ordering::Acquire);
            if tick > sent {
                return Err(DeliveryError::Early { sent, found: tick });
            }
            let mut answered = locked(&self.shared.answered);
            if tick > answered.tick {
                *answered = Answered { tick, due: Instant::now() };
            }
            drop(answered);
            self.shared.news_of_answer.notify_all();
            return Ok(());
        }
        let expected = self.shared.role.to_controller();
        let at = expected.iter().position(|place| place.address == frame.address());
        let Some(mailbox) = at.and_then(|at| self.shared.incoming.get(at)) else {
            return Err(FrameError::Address { expected, found: frame.address() }.into());
        };
        Ok(locked(mailbox).receive(frame.mailbox())?)
    }
}

/// Why a frame is none of a neighbour's.
#[derive(Debug, thiserror::Error)]
pub enum DeliveryError {
    /// It is for no mailbox of his.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// It answers a pulse that was never sent.
    #[error("an answer to a pulse up to {sent} was expected, found one to {found}")]
    Early {
        /// The last one that was sent.
        sent: u64,
        /// The number of the answer.
        found: u64,
    },
    /// The mailbox cannot hold it.
    #[error(transparent)]
    Mailbox(#[from] crate::mailbox::MailboxError),
}

#[cfg(test)]
mod tests;
