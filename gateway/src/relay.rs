//! Moves mailboxes between a Unix socket and samples. It is the same at both ends of a claim:
//!
//! ```text
//!   run -- socket -- Relay (Side::Run) == samples == Relay (Side::Neighbour) -- socket -- neighbour
//! ```
//!
//! Each pulse from the socket, and each mailgram without one, makes a sample. Each sample is written to the socket as
//! the mailboxes that have changed and the pulse.

use std::{
    io,
    os::fd::AsFd as _,
    time::{Duration, Instant},
};

use neighbours::line::{
    ClockKind, Role, Session,
    session::{Event, NEIGHBOUR_LIMIT, SessionError},
};

use sockets::Line;

use crate::{
    end::{CLOSING, End, GRACE},
    inbox::Inbox,
    sample::State,
};

/// In fast clock the run waits for the answer to each pulse. A sample without an answer is repeated after this time.
const REPEAT: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Run,       // the run: this process is the gateway
    Neighbour, // a neighbour: this process is at the other machine
}

#[derive(Debug)]
pub struct Admitted {
    pub line: Line,
    pub session: Session,
    pub clock: ClockKind,
}

pub struct Relay<'a> {
    line: Line,
    session: Session,
    side: Side,
    clock: ClockKind,
    inbox: &'a Inbox,
    publish: &'a mut dyn FnMut(&State, Option<&str>),
    outgoing: State, // from the socket to the network
    passed: State,   // from the network to the socket, as far as written
    published: Instant,
    heard: Instant, // when the last sample was received, and when the other side has gone
    gone: Option<Instant>,
}

impl<'a> Relay<'a> {
    /// A relay for a session that is open. `publish` sends a state and, at the end of the claim, the reason.
    pub fn new(
        admitted: Admitted,
        role: Role,
        side: Side,
        inbox: &'a Inbox,
        publish: &'a mut dyn FnMut(&State, Option<&str>),
    ) -> Self {
        let (outgoing, passed) = match side {
            Side::Run => (role.from_controller(), role.to_controller()),
            Side::Neighbour => (role.to_controller(), role.from_controller()),
        };
        let Admitted { line, session, clock } = admitted;
        let now = Instant::now();
        Self {
            line,
            session,
            side,
            clock,
            inbox,
            publish,
            outgoing: State::initialized(outgoing),
            passed: State::initialized(passed),
            published: now,
            heard: now,
            gone: None,
        }
    }

    /// Runs until the claim ends, and informs the other end if possible.
    pub fn run(mut self) -> End {
        let end = loop {
            if let Err(end) = self.turn() {
                break end;
            }
        };
        match (&end, self.side) {
            (End::Network(reason), Side::Neighbour) if !reason.is_empty() => self.session.close(reason),
            (End::Local(reason) | End::Violation(reason), _) => (self.publish)(&self.outgoing, Some(reason)),
            (End::Network(_) | End::Gone | End::Silent | End::Stopped, _) => {}
        }
        let until = Instant::now() + CLOSING;
        self.line.finish(self.session.output(), until);
        self.line.drain(until);
        end
    }

    fn turn(&mut self) -> Result<(), End> {
        // A socket that is read slowly gets only the latest values.
        if self.line.is_flushed() {
            self.take_sample(Instant::now())?;
        }
        self.line.send(self.session.output()).or_else(until_read)?;
        let now = Instant::now();
        self.check(now)?;
        let wake = self.line.is_flushed().then(|| self.inbox.as_fd());
        let until = [self.session.deadline(), self.deadline()].into_iter().flatten().min();
        let ready = self.line.wait(wake, until).map_err(lost)?;
        if ready { self.read_line(Instant::now()) } else { Ok(()) }
    }

    fn take_sample(&mut self, now: Instant) -> Result<(), End> {
        let Some(payload) = self.inbox.take() else { return Ok(()) };
        self.heard = now;
        let mut next = self.passed.clone();
        let end = next.decode(&payload).map_err(|error| End::Violation(error.to_string()))?;
        for (new, old) in next.mailboxes().iter().zip(self.passed.mailboxes()) {
            if new != old {
                self.session.send(new);
            }
        }
        match next.pulse {
            Some(pulse) if self.passed.pulse != Some(pulse) => self.session.pulse(pulse, now),
            // The run repeats a pulse because the answer was lost.
            Some(pulse) if self.side == Side::Neighbour && self.outgoing.pulse == Some(pulse) => {
                self.send(now)
            }
            Some(_) | None => {}
        }
        self.passed = next;
        end.map_or(Ok(()), |reason| Err(End::Network(reason)))
    }

    fn read_line(&mut self, now: Instant) -> Result<(), End> {
        let session = &mut self.session;
        let is_open = self.line.receive(|bytes| session.receive(bytes, now)).map_err(lost)?;
        let mut is_new = false;
        loop {
            match self.session.event(now).map_err(ended)? {
                Some(Event::Mailgram(place, used)) => {
                    let stored = self.outgoing.receive(place.address, used);
                    stored.map_err(|error| End::Local(error.to_string()))?;
                    is_new = true;
                }
                Some(Event::Pulse(tick)) => {
                    self.outgoing.pulse = Some(tick);
                    self.send(now);
                    is_new = false;
                }
                Some(Event::Hello(_) | Event::Welcome(_)) => {}
                None => break,
            }
        }
        if is_new {
            self.send(now);
        }
        if is_open { Ok(()) } else { Err(End::Local(String::new())) }
    }

    fn send(&mut self, now: Instant) {
        self.published = now;
        (self.publish)(&self.outgoing, None);
    }

    fn check(&mut self, now: Instant) -> Result<(), End> {
        self.session.check_time(now).map_err(ended)?;
        if self.inbox.is_stopped() {
            return Err(End::Stopped);
        }
        if self.inbox.is_gone() {
            // The token can overtake the last sample.
            let since = *self.gone.get_or_insert(now);
            if now.saturating_duration_since(since) >= GRACE {
                return Err(End::Gone);
            }
        }
        if self.is_bounded() && now.saturating_duration_since(self.heard) >= NEIGHBOUR_LIMIT {
            return Err(End::Silent);
        }
        if self.is_unanswered() && now.saturating_duration_since(self.published) >= REPEAT {
            self.send(now);
        }
        Ok(())
    }

    fn deadline(&self) -> Option<Instant> {
        let gone = self.gone.map(|since| since + GRACE);
        let silent = self.is_bounded().then(|| self.heard + NEIGHBOUR_LIMIT);
        let repeat = self.is_unanswered().then(|| self.published + REPEAT);
        [gone, silent, repeat].into_iter().flatten().min()
    }

    /// On the 40 ms grid the run sends something in each tick.
    fn is_bounded(&self) -> bool {
        self.side == Side::Neighbour && self.clock == ClockKind::Real
    }

    /// The run waits for the answer to a pulse.
    fn is_unanswered(&self) -> bool {
        self.side == Side::Run && self.clock == ClockKind::Fast && self.outgoing.pulse > self.passed.pulse
    }
}

/// A socket whose other end has closed may still have bytes to read, among them the reason.
fn until_read(error: io::Error) -> Result<(), End> {
    match error.kind() {
        io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => Ok(()),
        _ => Err(lost(error)),
    }
}

fn lost(error: io::Error) -> End {
    End::Local(error.to_string())
}

fn ended(error: SessionError) -> End {
    End::Local(error.to_string())
}

#[cfg(test)]
mod tests;
