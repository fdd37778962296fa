//! The neighbour's end of the line.

use std::{
    io,
    net::TcpStream,
    os::unix::net::UnixStream,
    thread,
    time::{Duration, Instant},
};

#[cfg(not(feature = "zenoh"))]
use super::listener::NO_ZENOH;
#[cfg(feature = "zenoh")]
use super::over_zenoh;
use super::{
    Address, ClockKind, KeysError, NeighbourKeys, Role,
    channel::Channel,
    operators::{Carrier, carry},
    session::{Event, NEIGHBOUR_LIMIT, Session, SessionError},
    shared::OVER,
    socket::Socket,
};
use neighbours::mailbox::{Mailbox, MailboxError, Place};

/// Time between two attempts to connect.
const PAUSE: Duration = Duration::from_millis(50);
/// How long the end of a connection may take.
const CLOSING_LIMIT: Duration = Duration::from_secs(1);

/// Why a connection cannot be made, or ends.
#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    /// No controller listens at the address, or the connection broke.
    #[error("{address}: {source}")]
    Line {
        /// Address of the controller.
        address: Address,
        /// Error of the system.
        source: io::Error,
    },
    /// TLS refuses the other side, or the other side refuses the certificate.
    #[error("{address}: TLS: {source}")]
    Tls {
        /// Address of the controller.
        address: Address,
        /// Error of the TLS library.
        source: Box<rustls::Error>,
    },
    /// The other side is not a controller, or breaks the protocol.
    #[error("{address}: {source}")]
    Session {
        /// Address of the controller.
        address: Address,
        /// Error of the session.
        source: SessionError,
    },
    /// Nothing was received for this time.
    #[error("nothing has come from the controller for {} s", .0.as_secs())]
    Silent(Duration),
    /// The controller has closed the connection without a reason.
    #[error("the controller has closed the connection")]
    Closed,
    /// The received data do not fit a mailbox.
    #[error(transparent)]
    Mailbox(#[from] MailboxError),
    /// The controller has closed the connection, with this reason.
    #[error("the controller says: {0}")]
    Disconnected(String),
    /// The keys do not fit the address.
    #[error(transparent)]
    Keys(#[from] KeysError),
    /// This program was built without Zenoh.
    #[cfg(not(feature = "zenoh"))]
    #[error("{0}: {NO_ZENOH}")]
    NoZenoh(Address),
}

impl PeerError {
    /// True if a later attempt may succeed: there is no controller, or it has just ended.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Line { source, .. } => source.kind() != io::ErrorKind::PermissionDenied,
            Self::Silent(_) | Self::Closed => true,
            Self::Disconnected(reason) => reason == OVER,
            _ => false,
        }
    }

    /// True if the neighbour can never connect with these arguments.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Keys(_) => true,
            #[cfg(not(feature = "zenoh"))]
            Self::NoZenoh(_) => true,
            _ => false,
        }
    }
}

/// A message from the controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    /// A mailgram has been received and stored in its mailbox.
    Mailgram(Place),
    /// The pulse of a tick, all of whose mailboxes have been received. Answer it with [`Peer::pulse`].
    Pulse(u64),
}

/// A connection to the controller.
pub struct Peer {
    address: Address,
    channel: Channel,
    session: Session,
    role: Role,
    clock: ClockKind,
    incoming: Vec<Mailbox>,
    /// The controller has not closed the connection.
    open: bool,
    /// The Zenoh tunnel of the connection, if there is one.
    #[cfg(feature = "zenoh")]
    _tunnel: Option<over_zenoh::Tunnel>,
}

impl Peer {
    /// Connect as a neighbour.
    ///
    /// # Errors
    /// [`PeerError`]; [`PeerError::Disconnected`] if it is refused.
    pub fn connect(address: &Address, role: Role, keys: Option<&NeighbourKeys>) -> Result<Self, PeerError> {
        Self::connect_within(Duration::ZERO, address, role, keys)
    }

    /// Connect; try again for a while if there is no controller.
    ///
    /// # Errors
    /// The last [`PeerError`].
    pub fn connect_within(
        limit: Duration,
        address: &Address,
        role: Role,
        keys: Option<&NeighbourKeys>,
    ) -> Result<Self, PeerError> {
        KeysError::check(address, keys.is_some())?;
        let until = Instant::now() + limit;
        loop {
            match Self::attempt(address, role, keys, until) {
                Err(error) if error.is_passing() && Instant::now() < until => thread::sleep(PAUSE),
                other => return other,
            }
        }
    }

    fn attempt(
        address: &Address,
        role: Role,
        keys: Option<&NeighbourKeys>,
        #[cfg_attr(not(feature = "zenoh"), expect(unused_variables, reason = "Zenoh waits itself"))]
        until: Instant,
    ) -> Result<Self, PeerError> {
        let failed = |source| PeerError::Line { address: address.clone(), source };
        #[cfg(feature = "zenoh")]
        let mut tunnel = None;
        let socket = match address {
            Address::Unix(path) => UnixStream::connect(path).map(Socket::Unix),
            Address::Tcp(place) => TcpStream::connect_timeout(place, NEIGHBOUR_LIMIT).map(Socket::Tcp),
            #[cfg(not(feature = "zenoh"))]
            Address::Zenoh(_) => return Err(PeerError::NoZenoh(address.clone())),
            #[cfg(feature = "zenoh")]
            Address::Zenoh(zenoh) => over_zenoh::Tunnel::open(zenoh, until).map(|(opened, socket)| {
                tunnel = Some(opened);
                Socket::Unix(socket)
            }),
        };
        let socket = socket.map_err(failed)?;
        socket.check_user().map_err(failed)?;
        let tls = keys.map(NeighbourKeys::connection).transpose();
        let tls =
            tls.map_err(|source| PeerError::Tls { address: address.clone(), source: Box::new(source) })?;
        let mut peer = Self {
            address: address.clone(),
            channel: Channel::new(socket, tls.map(Into::into)).map_err(failed)?,
            session: Session::neighbour(role, Instant::now()),
            role,
            clock: ClockKind::Real,
            incoming: role.from_controller().iter().map(|&place| Mailbox::initialized(place)).collect(),
            open: true,
            #[cfg(feature = "zenoh")]
            _tunnel: tunnel,
        };
        peer.clock = loop {
            if let Some(Event::Welcome(clock)) =
                peer.session.event(Instant::now()).map_err(broken(address))?
            {
                break clock;
            }
            peer.turn()?;
        };
        Ok(peer)
    }

    /// The clock of the controller.
    #[must_use]
    pub const fn clock(&self) -> ClockKind {
        self.clock
    }

    /// A mailbox from the controller.
    ///
    /// # Panics
    /// If it does not go to this neighbour.
    #[must_use]
    pub fn mailbox(&self, place: Place) -> &Mailbox {
        let mailbox = self.incoming.iter().find(|mailbox| mailbox.place() == place);
        mailbox.unwrap_or_else(|| panic!("{place} does not go to {}", self.role))
    }

    /// The stream of an operator's session, admitted as [`Role::Operator`], and the carrier of its bytes. Drop the
    /// carrier after the stream.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn into_stream(mut self) -> io::Result<(UnixStream, Carrier)> {
        let (ours, theirs) = UnixStream::pair()?;
        let thread = thread::Builder::new().name("operator".into()).spawn(move || {
            let unread = self.session.take_unread();
            // The client sees only the end of its stream, not the reason.
            let _ = carry(&mut self.channel, &theirs, unread, None);
        })?;
        Ok((ours, Carrier::of(thread)))
    }

    /// Wait for the next message.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn receive(&mut self) -> Result<Received, PeerError> {
        loop {
            match self.session.event(Instant::now()).map_err(broken(&self.address))? {
                Some(Event::Mailgram(place, used)) => {
                    let mailbox = self.incoming.iter_mut().find(|mailbox| mailbox.place() == place);
                    mailbox.map_or(Ok(()), |mailbox| mailbox.receive(used))?;
                    return Ok(Received::Mailgram(place));
                }
                Some(Event::Pulse(tick)) => return Ok(Received::Pulse(tick)),
                Some(Event::Hello(_) | Event::Welcome(_)) => {}
                None => self.turn()?,
            }
        }
    }

    /// Answer all pulses up to the one of a tick.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn pulse(&mut self, tick: u64) -> Result<(), PeerError> {
        self.session.pulse(tick, Instant::now());
        self.flush()
    }

    /// Send the contents of a mailbox.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn send(&mut self, mailbox: &Mailbox) -> Result<(), PeerError> {
        self.session.send(mailbox);
        self.flush()
    }

    /// Wait until the system has accepted all bytes to send.
    fn flush(&mut self) -> Result<(), PeerError> {
        let until = Instant::now() + NEIGHBOUR_LIMIT;
        loop {
            match self.channel.send(&mut self.session) {
                Ok(()) if self.channel.is_flushed() => return Ok(()),
                Ok(()) if Instant::now() >= until => return Err(PeerError::Silent(NEIGHBOUR_LIMIT)),
                Ok(()) => drop(self.channel.wait(None, Some(until)).map_err(|error| self.failed(error))?),
                Err(error) if is_end(&error) => return Err(self.reason()),
                Err(error) => return Err(self.failed(error)),
            }
        }
    }

    /// Why the controller has closed the connection: read the rest up to its reason.
    fn reason(&mut self) -> PeerError {
        loop {
            if let Err(error) = self.receive() {
                return error;
            }
        }
    }

    /// Wait for more bytes.
    fn turn(&mut self) -> Result<(), PeerError> {
        if !self.open {
            return Err(PeerError::Closed);
        }
        match self.channel.send(&mut self.session) {
            // The reason can still be read.
            Err(error) if is_end(&error) => {}
            sent => sent.map_err(|error| self.failed(error))?,
        }
        self.session.check_time(Instant::now()).map_err(broken(&self.address))?;
        let ready = self.channel.wait(None, self.session.deadline()).map_err(|error| self.failed(error))?;
        if ready {
            let received = self.channel.receive(&mut self.session, Instant::now());
            self.open = received.map_err(|error| self.failed(error))?;
        }
        Ok(())
    }

    fn failed(&self, error: io::Error) -> PeerError {
        let address = self.address.clone();
        if is_end(&error) {
            return PeerError::Closed;
        }
        match error.downcast::<rustls::Error>() {
            Ok(source) => PeerError::Tls { address, source: Box::new(source) },
            Err(source) => PeerError::Line { address, source },
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.channel.finish(&mut self.session, Instant::now() + CLOSING_LIMIT);
    }
}

fn broken(address: &Address) -> impl FnOnce(SessionError) -> PeerError {
    move |error| match error {
        SessionError::Reason(reason) => PeerError::Disconnected(reason),
        SessionError::Silent(limit) | SessionError::NoHello(limit) => PeerError::Silent(limit),
        source => PeerError::Session { address: address.clone(), source },
    }
}

/// The other side has closed the connection, maybe with bytes in transit.
fn is_end(error: &io::Error) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
    matches!(error.kind(), BrokenPipe | ConnectionReset | UnexpectedEof)
}
