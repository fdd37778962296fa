//! The neighbour's end of the line.

use std::{
    io,
    os::unix::net::UnixStream,
    thread,
    time::{Duration, Instant},
};

use super::{
    Address, ClockKind, Role,
    session::{Event, NEIGHBOUR_LIMIT, Session, SessionError},
    shared::OVER,
};
use neighbours::mailbox::{Mailbox, MailboxError, Place};
use sockets::Line;

const PAUSE: Duration = Duration::from_millis(50); // time between two attempts to connect
const CLOSING_LIMIT: Duration = Duration::from_secs(1); // time limit for the end of a connection

#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    #[error("{address}: {source}")]
    Line { address: Address, source: io::Error },
    #[error("{address}: {source}")]
    Session { address: Address, source: SessionError },
    #[error("nothing was received from the controller for {} s", .0.as_secs())]
    Silent(Duration),
    #[error("the controller has closed the connection")]
    Closed,
    #[error(transparent)]
    Mailbox(#[from] MailboxError),
    #[error("the controller says: {0}")]
    Disconnected(String),
}

impl PeerError {
    /// True if a later attempt may succeed, because the controller is missing or has just ended.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Line { source, .. } => source.kind() != io::ErrorKind::PermissionDenied,
            Self::Silent(_) | Self::Closed => true,
            Self::Disconnected(reason) => reason == OVER,
            _ => false,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    /// A mailgram was received and stored in its mailbox.
    Mailgram(Place),
    /// The pulse of a tick, all of whose mailboxes have been received. Answer it with [`Peer::pulse`].
    Pulse(u64),
}

struct Connection {
    address: Address,
    line: Line,
    session: Session,
    is_open: bool, // true until the controller closes the connection
}

pub struct Peer {
    connection: Connection,
    role: Role,
    clock: ClockKind,
    incoming: Vec<Mailbox>,
}

/// The stream of an operator's session, for [`Client::over`](crate::operator::Client::over).
pub fn connect_operator(address: &Address) -> Result<UnixStream, PeerError> {
    let (connection, _) = Connection::open(address, Role::Operator)?;
    connection.line.into_stream().map_err(|source| PeerError::Line { address: address.clone(), source })
}

impl Peer {
    pub fn connect(address: &Address, role: Role) -> Result<Self, PeerError> {
        Self::connect_within(Duration::ZERO, address, role)
    }

    /// Connect, and repeat the attempt within `limit` if no controller answers. Fails with the last [`PeerError`].
    pub fn connect_within(limit: Duration, address: &Address, role: Role) -> Result<Self, PeerError> {
        let until = Instant::now() + limit;
        let (connection, clock) = loop {
            match Connection::open(address, role) {
                Err(error) if error.is_passing() && Instant::now() < until => thread::sleep(PAUSE),
                other => break other?,
            }
        };
        let incoming = role.from_controller().iter().map(|&place| Mailbox::initialized(place)).collect();
        Ok(Self { connection, role, clock, incoming })
    }

    #[must_use]
    pub const fn clock(&self) -> ClockKind {
        self.clock
    }

    /// A mailbox from the controller. Panics if this neighbour does not receive it.
    #[must_use]
    pub fn mailbox(&self, place: Place) -> &Mailbox {
        let mailbox = self.incoming.iter().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not go to {}", self.role))
    }

    pub fn receive(&mut self) -> Result<Received, PeerError> {
        loop {
            match self.connection.event()? {
                Some(Event::Mailgram(place, used)) => {
                    let mailbox = self.incoming.iter_mut().find(|mailbox| mailbox.place() == place);
                    mailbox.map_or(Ok(()), |mailbox| mailbox.receive(used))?;
                    return Ok(Received::Mailgram(place));
                }
                Some(Event::Pulse(tick)) => return Ok(Received::Pulse(tick)),
                Some(Event::Hello(_) | Event::Welcome(_)) => {}
                None => self.connection.turn()?,
            }
        }
    }

    /// Answer all pulses up to that of a tick.
    pub fn pulse(&mut self, tick: u64) -> Result<(), PeerError> {
        self.connection.session.pulse(tick, Instant::now());
        self.flush()
    }

    pub fn send(&mut self, mailbox: &Mailbox) -> Result<(), PeerError> {
        self.connection.session.send(mailbox);
        self.flush()
    }

    /// Wait until the system has accepted all bytes to send.
    fn flush(&mut self) -> Result<(), PeerError> {
        let until = Instant::now() + NEIGHBOUR_LIMIT;
        loop {
            let Connection { line, session, .. } = &mut self.connection;
            match line.send(session.output()) {
                Ok(()) if line.is_flushed() => return Ok(()),
                Ok(()) if Instant::now() >= until => return Err(PeerError::Silent(NEIGHBOUR_LIMIT)),
                Ok(()) => drop(line.wait(None, Some(until)).map_err(|error| self.connection.failed(error))?),
                Err(error) if is_end(&error) => return Err(self.reason()),
                Err(error) => return Err(self.connection.failed(error)),
            }
        }
    }

    /// The reason why the controller has closed the connection, after the remaining data.
    fn reason(&mut self) -> PeerError {
        loop {
            if let Err(error) = self.receive() {
                return error;
            }
        }
    }
}

impl Connection {
    /// Connect, and wait for the welcome; returns the clock of the controller.
    fn open(address: &Address, role: Role) -> Result<(Self, ClockKind), PeerError> {
        let failed = |source| PeerError::Line { address: address.clone(), source };
        let line = UnixStream::connect(address.path()).and_then(Line::new).map_err(failed)?;
        line.check_user().map_err(failed)?;
        let session = Session::neighbour(role, Instant::now());
        let mut connection = Self { address: address.clone(), line, session, is_open: true };
        loop {
            if let Some(Event::Welcome(clock)) = connection.event()? {
                return Ok((connection, clock));
            }
            connection.turn()?;
        }
    }

    fn event(&mut self) -> Result<Option<Event<'_>>, PeerError> {
        self.session.event(Instant::now()).map_err(broken(&self.address))
    }

    /// Send, and wait for more bytes.
    fn turn(&mut self) -> Result<(), PeerError> {
        if !self.is_open {
            return Err(PeerError::Closed);
        }
        match self.line.send(self.session.output()) {
            // The reason can still be read.
            Err(error) if is_end(&error) => {}
            sent => sent.map_err(|error| self.failed(error))?,
        }
        self.session.check_time(Instant::now()).map_err(broken(&self.address))?;
        let ready = self.line.wait(None, self.session.deadline()).map_err(|error| self.failed(error))?;
        if ready {
            let session = &mut self.session;
            let received = self.line.receive(|bytes| session.receive(bytes, Instant::now()));
            self.is_open = received.map_err(|error| self.failed(error))?;
        }
        Ok(())
    }

    fn failed(&self, source: io::Error) -> PeerError {
        if is_end(&source) {
            PeerError::Closed
        } else {
            PeerError::Line { address: self.address.clone(), source }
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let Connection { line, session, .. } = &mut self.connection;
        line.finish(session.output(), Instant::now() + CLOSING_LIMIT);
    }
}

fn broken(address: &Address) -> impl FnOnce(SessionError) -> PeerError {
    move |error| match error {
        SessionError::Reason(reason) => PeerError::Disconnected(reason),
        SessionError::Silent(limit) | SessionError::NoHello(limit) => PeerError::Silent(limit),
        source => PeerError::Session { address: address.clone(), source },
    }
}

/// True if the other side has closed the connection, perhaps with bytes in transit.
fn is_end(error: &io::Error) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
    matches!(error.kind(), BrokenPipe | ConnectionReset | UnexpectedEof)
}
