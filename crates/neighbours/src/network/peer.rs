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
    Address, Role, Secret,
    frame::{Frame, FrameError, LAST_WORDS, WELCOME},
    hello::{Agreement, Challenge, ClockKind, HELLO, HelloError, check_welcome},
    listener::CROWDED,
    office::{OVER, Outlet},
    stream::{Receiver, Sender, Stream, is_timeout},
};
use crate::mailbox::{Mailbox, MailboxError, Place};

/// How long the other side may take for a hello or a frame.
pub(super) const LIMIT: Duration = Duration::from_secs(10);
/// Between two attempts to connect.
pub(super) const PAUSE: Duration = Duration::from_millis(50);

/// Why a connection does not come about, or ends.
#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    /// Nobody is there, or the line broke.
    #[error("{address}: {source}")]
    Line {
        /// Where.
        address: Address,
        /// Why.
        source: io::Error,
    },
    /// The other side is no controller.
    #[error("{address}: {source}")]
    Hello {
        /// Where.
        address: Address,
        /// Why.
        source: HelloError,
    },
    /// The line is dead.
    #[error("nothing has come from the controller for {} s", LIMIT.as_secs())]
    Silent,
    /// The controller has gone without a word.
    #[error("the controller has closed the connection")]
    Closed,
    /// What came is no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// What came fits no mailbox.
    #[error(transparent)]
    Mailbox(#[from] MailboxError),
    /// The controller has closed the connection, and said why.
    #[error("the controller says: {0}")]
    LastWords(String),
    /// The other side has closed the connection, and said why, before it has proved that it knows the secret.
    #[error("the controller says: {0} (unverified: it has not proved that it knows the secret)")]
    Unverified(String),
    /// Anybody on the network could pose as the controller.
    #[error("{0}: a network needs the secret that the controller knows; name a file with --secret")]
    NoSecret(Address),
    /// Zenoh is left out of this program.
    #[cfg(not(feature = "zenoh"))]
    #[error("{0}: {NO_ZENOH}")]
    NoZenoh(Address),
}

impl PeerError {
    /// True if a later attempt may do better: nobody is there, or he has just gone.
    #[must_use]
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Line { .. } | Self::Silent | Self::Closed => true,
            Self::Frame(FrameError::Stream(_) | FrameError::Number(_)) => true,
            Self::LastWords(text) | Self::Unverified(text) => [OVER, CROWDED].contains(&text.as_str()),
            _ => false,
        }
    }

    /// True if the neighbour was started in a way in which it can never connect.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::NoSecret(_) => true,
            #[cfg(not(feature = "zenoh"))]
            Self::NoZenoh(_) => true,
            _ => false,
        }
    }
}

/// What the controller sends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    /// A mailgram has come: the mailbox holds it.
    Mailgram(Place),
    /// A tick is over, and all that was written in it has come. It is to be answered by [`Peer::pulse`].
    Pulse(u64),
}

/// Where frames come in from the controller.
pub(super) trait Inlet: Send {
    /// The next one.
    ///
    /// # Errors
    /// [`FrameError`]; [`io::ErrorKind::TimedOut`] or [`io::ErrorKind::WouldBlock`] if nothing comes for too long,
    /// [`io::ErrorKind::UnexpectedEof`] if the controller has gone.
    fn receive(&mut self) -> Result<Frame, FrameError>;
}

/// A connection, whatever it goes over.
pub(super) struct Connection {
    pub sender: Box<dyn Outlet>,
    pub receiver: Box<dyn Inlet>,
    pub clock: ClockKind,
}

/// A connection to the controller.
pub struct Peer {
    sender: Box<dyn Outlet>,
    receiver: Box<dyn Inlet>,
    role: Role,
    clock: ClockKind,
    incoming: Vec<Mailbox>,
}

impl Peer {
    /// Connect as a neighbour.
    ///
    /// # Errors
    /// [`PeerError`]; [`PeerError::LastWords`] if one is not let in.
    pub fn connect(address: &Address, role: Role, secret: Option<&Secret>) -> Result<Self, PeerError> {
        Self::connect_within(Duration::ZERO, address, role, secret)
    }

    /// Connect, and try again for a while as long as nobody is there.
    ///
    /// # Errors
    /// The last [`PeerError`].
    pub fn connect_within(
        limit: Duration,
        address: &Address,
        role: Role,
        secret: Option<&Secret>,
    ) -> Result<Self, PeerError> {
        let until = Instant::now() + limit;
        let Connection { sender, receiver, clock } = match address {
            Address::Unix(_) | Address::Tcp(_) => loop {
                match over_socket(address, role, secret) {
                    Err(error) if error.is_passing() && Instant::now() < until => thread::sleep(PAUSE),
                    other => break other?,
                }
            },
            #[cfg(not(feature = "zenoh"))]
            Address::Zenoh(_) => return Err(PeerError::NoZenoh(address.clone())),
            #[cfg(feature = "zenoh")]
            Address::Zenoh(station) => {
                let secret = secret.ok_or_else(|| PeerError::NoSecret(address.clone()))?;
                over_zenoh::neighbour::connect(address, station, role, secret, until)?
            }
        };
        let incoming = role.from_controller().iter().map(|&place| Mailbox::initialized(place)).collect();
        Ok(Self { sender, receiver, role, clock, incoming })
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

    /// What comes next.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn receive(&mut self) -> Result<Received, PeerError> {
        let frame = receive(self.receiver.as_mut())?;
        if let Some(tick) = frame.as_pulse()? {
            return Ok(Received::Pulse(tick));
        }
        let expected = self.role.from_controller();
        let mailbox = self.incoming.iter_mut().find(|mailbox| mailbox.place().address == frame.address());
        let mailbox = mailbox.ok_or(FrameError::Address { expected, found: frame.address() })?;
        mailbox.receive(frame.mailbox())?;
        Ok(Received::Mailgram(mailbox.place()))
    }

    /// Answer all pulses up to the one of a tick.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn pulse(&mut self, tick: u64) -> Result<(), PeerError> {
        self.frame(&Frame::pulse(tick))
    }

    /// Send what stands in a mailbox.
    ///
    /// # Errors
    /// [`PeerError`] if the connection ends.
    pub fn send(&mut self, mailbox: &Mailbox) -> Result<(), PeerError> {
        self.frame(&Frame::of(mailbox))
    }

    fn frame(&mut self, frame: &Frame) -> Result<(), PeerError> {
        match self.sender.send(frame) {
            Err(error) if is_end(&error) => Err(self.last()),
            sent => sent.map_err(|error| FrameError::Stream(error).into()),
        }
    }

    /// Why the controller has closed the connection: what it said last stands behind what was not read yet.
    fn last(&mut self) -> PeerError {
        loop {
            if let Err(error) = receive(self.receiver.as_mut()) {
                return error;
            }
        }
    }
}

/// Connect at a socket.
fn over_socket(address: &Address, role: Role, secret: Option<&Secret>) -> Result<Connection, PeerError> {
    let failed = |source| PeerError::Line { address: address.clone(), source };
    let mistrusted = |source| PeerError::Hello { address: address.clone(), source };
    let mut stream = match address {
        Address::Unix(path) => UnixStream::connect(path).map(Stream::Unix),
        Address::Tcp(place) => TcpStream::connect_timeout(place, LIMIT).map(Stream::Tcp),
        Address::Zenoh(_) => Err(io::ErrorKind::Unsupported.into()),
    }
    .map_err(failed)?;
    stream.prepare(LIMIT).map_err(failed)?;
    let mut bytes = [0; HELLO];
    io::Read::read_exact(&mut stream, &mut bytes).map_err(failed)?;
    let challenge = Challenge::from_bytes(bytes).map_err(mistrusted)?;
    let (answer, agreement) = challenge.answer(role, secret).map_err(failed)?;
    let answered = io::Write::write_all(&mut stream, &answer);
    let mut sender = Sender::new(stream.try_clone().map_err(failed)?);
    let mut receiver = Receiver::new(stream.try_clone().map_err(failed)?);
    // Who is not let in may be told why before he has answered.
    let welcome = match (receive(&mut receiver), answered) {
        (Err(error @ PeerError::LastWords(_)), _) if secret.is_some() => return Err(unverified(error)),
        (Err(error @ PeerError::LastWords(_)), _) => return Err(error),
        (_, Err(error)) => return Err(failed(error)),
        (welcome, Ok(())) => welcome?,
    };
    if welcome.address() != WELCOME {
        return Err(mistrusted(HelloError::Impostor));
    }
    check_welcome(welcome.data(), agreement.as_ref()).map_err(mistrusted)?;
    sender.seal(agreement.as_ref().map(Agreement::up));
    receiver.seal(agreement.as_ref().map(Agreement::down));
    if challenge.clock() == ClockKind::Fast {
        // Its time may stand still for as long as it likes; on the grid there is a pulse every 40 ms.
        stream.unlimited().map_err(failed)?;
    }
    Ok(Connection { sender: Box::new(sender), receiver: Box::new(receiver), clock: challenge.clock() })
}

/// The next frame, if it is not the last.
fn receive(receiver: &mut dyn Inlet) -> Result<Frame, PeerError> {
    let frame = receiver.receive().map_err(|error| match error {
        FrameError::Stream(error) if is_timeout(&error) => PeerError::Silent,
        FrameError::Stream(error) if is_end(&error) => PeerError::Closed,
        error => error.into(),
    })?;
    if frame.address() == LAST_WORDS { Err(last_words(&frame)) } else { Ok(frame) }
}

/// The other side has closed the connection, with or without what was still on its way.
fn is_end(error: &io::Error) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset, UnexpectedEof};
    matches!(error.kind(), BrokenPipe | ConnectionReset | UnexpectedEof)
}

/// The same reason, from a side that has not proved that it knows the secret.
pub(super) fn unverified(error: PeerError) -> PeerError {
    if let PeerError::LastWords(why) = error { PeerError::Unverified(why) } else { error }
}

/// Why the controller ends the connection.
pub(super) fn last_words(frame: &Frame) -> PeerError {
    let text = String::from_utf8_lossy(frame.data());
    // They may end on a terminal, which obeys some characters.
    PeerError::LastWords(text.replace(char::is_control, "?"))
}
