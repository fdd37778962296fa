//! The protocol between controller and neighbour, without I/O: bytes and time in, bytes and events out.
//!
//! ```text
//!   controller                                          neighbour
//!     52 43 53 32 "RCS2"  03 00 version  cc 00 clock  -->
//!                    <--  52 43 53 32 "RCS2"  03 00 version  rr 00 number of its Role
//!     frame: welcome, or disconnect reason            -->
//!     frames: mailboxes and pulses                    <->
//! ```
//!
//! ```text
//!             hello of the other side          admit, or welcome
//!   Hello ------------------------> Admission -------------------> Open
//!     |                                 |                            |
//!     '---------------------------------+---- violation, silence, ---'--> Closed
//!                                             close
//! ```
//!
//! The caller passes received bytes to [`Session::receive`], calls [`Session::event`] until it returns `None`, then
//! sends [`Session::output`]. [`Session::deadline`] is the time of the next [`Session::check_time`]. The socket (user)
//! or TLS (certificate) authenticates the peer.

use std::{
    fmt,
    ops::Range,
    time::{Duration, Instant},
};

use super::{
    ClockKind, Role,
    clock::answer_limit,
    frame::{self, DISCONNECT, Frame, FrameError, WELCOME},
};
use crate::mailbox::{Mailbox, Place};

pub const HELLO: usize = 8; // bytes
const MARK: [u8; 4] = *b"RCS2"; // begins both hellos
pub const VERSION: u16 = 3;

/// A neighbour's time limit for hello and welcome. On the 40 ms grid it also applies to the next byte.
pub const NEIGHBOUR_LIMIT: Duration = Duration::from_secs(10);

#[derive(Debug, PartialEq, Eq)]
pub enum Event<'a> {
    Hello(Role),               // to the controller: a neighbour asks for admission
    Welcome(ClockKind),        // to the neighbour: admission
    Mailgram(Place, &'a [u8]), // head and data of a mailbox
    Pulse(u64),                // of a tick, or the answer to it
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SessionError {
    #[error("a hello was expected, found {0:02X?}")]
    Mark([u8; 4]), // another protocol
    #[error("version {VERSION} of the protocol was expected, found {0}")]
    Version(u16), // another version of the protocol
    #[error("the number of a neighbour was expected, found {0}")]
    Role(u16),
    #[error("0 (real) or 1 (fast) was expected for the clock, found {0}")]
    Clock(u16),
    #[error("a welcome was expected, found a frame with the address {0:05X}")]
    Welcome(u32), // another frame before the welcome
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The neighbour has answered a pulse that was not sent.
    #[error("an answer to a pulse up to {sent} was expected, found one to {found}")]
    Early {
        sent: u64, // the last pulse
        found: u64,
    },
    #[error("no hello within {} s", .0.as_secs())]
    NoHello(Duration), // neither hello nor welcome in time
    #[error("no answer for {} s", .0.as_secs())]
    Silent(Duration), // no data for this time
    #[error("{0}")]
    Reason(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Controller { clock: ClockKind, role: Option<Role> },
    Neighbour { role: Role, clock: ClockKind },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Hello,
    Admission,
    Open,
    Closed,
}

#[derive(Clone, Copy, Debug)]
struct Pulses {
    sent: u64,
    answered: u64,
    due: Instant, // since which an answer is due
}

pub struct Session {
    side: Side,
    state: State,
    input: Vec<u8>, // processed up to `read`
    read: usize,
    output: Vec<u8>,
    pulses: Pulses,
    began: Instant, // start of the session, and time of the last received bytes
    heard: Instant,
}

/// Start, time limit, and the error after it.
type Limit = (Instant, Duration, fn(Duration) -> SessionError);

enum Step {
    Hello(Role),
    Welcome(ClockKind),
    Mailgram(Place, Range<usize>),
    Pulse(u64),
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session")
            .field("side", &self.side)
            .field("state", &self.state)
            .finish_non_exhaustive()
    }
}

impl Session {
    fn new(side: Side, now: Instant) -> Self {
        Self {
            side,
            state: State::Hello,
            input: Vec::new(),
            read: 0,
            output: Vec::new(),
            pulses: Pulses { sent: 0, answered: 0, due: now },
            began: now,
            heard: now,
        }
    }

    #[must_use]
    pub fn controller(clock: ClockKind, now: Instant) -> Self {
        let mut session = Self::new(Side::Controller { clock, role: None }, now);
        session.put_hello(clock as u16);
        session
    }

    #[must_use]
    pub fn neighbour(role: Role, now: Instant) -> Self {
        Self::new(Side::Neighbour { role, clock: ClockKind::Real }, now)
    }

    /// Process all events before adding more bytes.
    pub fn receive(&mut self, bytes: &[u8], now: Instant) {
        if self.state == State::Closed {
            return;
        }
        self.input.drain(..self.read);
        self.read = 0;
        self.input.extend_from_slice(bytes);
        if !bytes.is_empty() {
            self.heard = now;
        }
    }

    /// `None` if more bytes are required. Fails once, and closes the session, after a violation or a close.
    pub fn event(&mut self, now: Instant) -> Result<Option<Event<'_>>, SessionError> {
        let step = match self.step(now) {
            Ok(step) => step,
            Err(error) => return Err(self.fail(error)),
        };
        Ok(step.map(|step| match step {
            Step::Hello(role) => Event::Hello(role),
            Step::Welcome(clock) => Event::Welcome(clock),
            Step::Mailgram(place, bytes) => Event::Mailgram(place, &self.input[bytes]),
            Step::Pulse(tick) => Event::Pulse(tick),
        }))
    }

    fn step(&mut self, now: Instant) -> Result<Option<Step>, SessionError> {
        match (self.state, self.side) {
            (State::Hello, _) => self.hello(),
            (State::Admission, Side::Neighbour { clock, .. }) => self.welcome(clock),
            (State::Open, Side::Controller { role: Some(role), .. }) => self.frame(role.to_controller(), now),
            (State::Open, Side::Neighbour { role, .. }) => self.frame(role.from_controller(), now),
            (State::Admission | State::Open, Side::Controller { .. }) | (State::Closed, _) => Ok(None),
        }
    }

    fn hello(&mut self) -> Result<Option<Step>, SessionError> {
        let unread = &self.input[self.read..];
        let prefix = unread.len().min(MARK.len());
        if unread[..prefix] != MARK[..prefix] {
            let mut found = [0; MARK.len()];
            found[..prefix].copy_from_slice(&unread[..prefix]);
            return Err(SessionError::Mark(found));
        }
        let Some(&[.., a, b, c, d]) = unread.first_chunk::<HELLO>() else { return Ok(None) };
        self.read += HELLO;
        let (version, number) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
        if version != VERSION {
            return Err(SessionError::Version(version));
        }
        self.state = State::Admission;
        match &mut self.side {
            Side::Controller { role, .. } => {
                let found = Role::from_number(number).ok_or(SessionError::Role(number))?;
                *role = Some(found);
                Ok(Some(Step::Hello(found)))
            }
            Side::Neighbour { role, clock } => {
                let kinds = [ClockKind::Real, ClockKind::Fast];
                let found = kinds.into_iter().find(|&kind| kind as u16 == number);
                let found = found.ok_or(SessionError::Clock(number))?;
                *clock = found;
                let number = *role as u16;
                self.put_hello(number);
                // The welcome may have arrived with the hello.
                self.welcome(found)
            }
        }
    }

    fn welcome(&mut self, clock: ClockKind) -> Result<Option<Step>, SessionError> {
        let Some(frame) = Frame::first(&self.input[self.read..])? else { return Ok(None) };
        let (address, length) = (frame.address(), frame.bytes().len());
        match address {
            WELCOME => {
                self.read += length;
                self.state = State::Open;
                Ok(Some(Step::Welcome(clock)))
            }
            DISCONNECT => Err(SessionError::Reason(plain(frame.data()))),
            address => Err(SessionError::Welcome(address)),
        }
    }

    /// Handles a frame. The other side may write only the `expected` mailboxes.
    fn frame(&mut self, expected: &'static [Place], now: Instant) -> Result<Option<Step>, SessionError> {
        let Some(frame) = Frame::first(&self.input[self.read..])? else { return Ok(None) };
        let (start, end) = (self.read + frame::ADDRESS, self.read + frame.bytes().len());
        let (pulse, address) = (frame.as_pulse()?, frame.address());
        if let (DISCONNECT, Side::Neighbour { .. }) = (address, self.side) {
            return Err(SessionError::Reason(plain(frame.data())));
        }
        self.read = end;
        if let Some(tick) = pulse {
            self.pulse_came(tick, now)?;
            return Ok(Some(Step::Pulse(tick)));
        }
        let place = expected.iter().find(|place| place.address == address);
        let place = place.ok_or(FrameError::Address { expected, found: address })?;
        Ok(Some(Step::Mailgram(*place, start..end)))
    }

    /// Repeated answers have no effect.
    fn pulse_came(&mut self, found: u64, now: Instant) -> Result<(), SessionError> {
        let Side::Controller { .. } = self.side else { return Ok(()) };
        let sent = self.pulses.sent;
        if found > sent {
            return Err(SessionError::Early { sent, found });
        }
        if found > self.pulses.answered {
            (self.pulses.answered, self.pulses.due) = (found, now);
        }
        Ok(())
    }

    pub fn admit(&mut self) {
        if self.state == State::Admission {
            frame::put(&mut self.output, WELCOME, &[]);
            self.state = State::Open;
        }
    }

    pub fn send(&mut self, mailbox: &Mailbox) {
        if self.state == State::Open {
            frame::put_mailbox(&mut self.output, mailbox);
        }
    }

    /// One pulse follows the controller's mailgrams of a tick; the neighbour answers all pulses up to it.
    pub fn pulse(&mut self, tick: u64, now: Instant) {
        if self.state != State::Open {
            return;
        }
        frame::put_pulse(&mut self.output, tick);
        if self.pulses.answered >= self.pulses.sent {
            self.pulses.due = now;
        }
        self.pulses.sent = tick;
    }

    pub fn close(&mut self, reason: &dyn fmt::Display) {
        if self.state != State::Closed && matches!(self.side, Side::Controller { .. }) {
            frame::put(&mut self.output, DISCONNECT, reason.to_string().as_bytes());
        }
        self.state = State::Closed;
        self.input.clear();
        self.read = 0;
    }

    fn fail(&mut self, error: SessionError) -> SessionError {
        self.close(&error);
        error
    }

    #[must_use]
    pub fn deadline(&self) -> Option<Instant> {
        self.limit().and_then(|(since, limit, _)| since.checked_add(limit))
    }

    fn limit(&self) -> Option<Limit> {
        match (self.state, self.side) {
            (State::Hello | State::Admission, Side::Controller { clock, .. }) => {
                Some((self.began, answer_limit(clock), SessionError::NoHello))
            }
            (State::Hello | State::Admission, Side::Neighbour { .. }) => {
                Some((self.began, NEIGHBOUR_LIMIT, SessionError::NoHello))
            }
            (State::Open, Side::Controller { clock, .. }) if self.pulses.answered < self.pulses.sent => {
                Some((self.pulses.due, answer_limit(clock), SessionError::Silent))
            }
            // In fast clock the controller may be silent for any time.
            (State::Open, Side::Neighbour { clock: ClockKind::Real, .. }) => {
                Some((self.heard, NEIGHBOUR_LIMIT, SessionError::Silent))
            }
            (State::Open | State::Closed, _) => None,
        }
    }

    /// Closes the session after a silence. Fails once, with [`SessionError::NoHello`] or [`SessionError::Silent`].
    pub fn check_time(&mut self, now: Instant) -> Result<(), SessionError> {
        match self.limit() {
            Some((since, limit, error)) if now.saturating_duration_since(since) >= limit => {
                Err(self.fail(error(limit)))
            }
            _ => Ok(()),
        }
    }

    /// Bytes after the admission, which are not part of this protocol.
    pub fn take_unread(&mut self) -> Vec<u8> {
        let unread = self.input.split_off(self.read);
        self.input.clear();
        self.read = 0;
        unread
    }

    /// Bytes to send; the caller removes them.
    pub const fn output(&mut self) -> &mut Vec<u8> {
        &mut self.output
    }

    fn put_hello(&mut self, number: u16) {
        self.output.extend_from_slice(&MARK);
        self.output.extend_from_slice(&VERSION.to_le_bytes());
        self.output.extend_from_slice(&number.to_le_bytes());
    }
}

/// The text without control characters, because a terminal would execute them.
fn plain(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace(char::is_control, "?")
}

#[cfg(test)]
mod tests;
