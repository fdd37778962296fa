//! The controller's end of connections: each is served by a thread of its own, from the hello to its end.

use std::{
    fmt, io,
    sync::{Arc, Mutex},
    thread,
    time::Instant,
};

use super::{
    ClockKind, ControllerKeys, Disconnect, NetEvent, Role,
    accept_queue::{AcceptQueue, SAFE},
    channel::Channel,
    session::{Event, Session, SessionError},
    shared::{EndpointHandle, Link, OVER, Outgoing, locked},
    socket::Socket,
};

/// Why a connection is refused for which there is no slot in the accept queue.
const CROWDED: &str = "too many connect at once";

/// What the threads work with.
pub(super) struct Server {
    handles: Vec<EndpointHandle>,
    keys: Option<ControllerKeys>,
    clock: ClockKind,
    queue: AcceptQueue,
    /// When it was said last that too many connect.
    crowded: Mutex<Option<Instant>>,
}

/// A connection.
struct Connection {
    channel: Channel,
    session: Session,
}

impl Server {
    pub fn new(handles: Vec<EndpointHandle>, keys: Option<ControllerKeys>, clock: ClockKind) -> Self {
        Self { handles, keys, clock, queue: AcceptQueue::default(), crowded: Mutex::default() }
    }

    /// Serve a connection, if there is a slot for it in the accept queue; else it is closed.
    pub fn enter(self: &Arc<Self>, socket: Socket) {
        if let Ok(Some(ticket)) = self.queue.enter(&socket) {
            let server = Arc::clone(self);
            thread::spawn(move || server.serve(socket, ticket));
            return;
        }
        let mut crowded = locked(&self.crowded);
        if crowded.is_none_or(|since| since.elapsed() >= SAFE) {
            *crowded = Some(Instant::now());
            self.refused(CROWDED.to_owned());
        }
    }

    fn refused(&self, why: String) {
        if let Some(handle) = self.handles.first() {
            handle.tell(NetEvent::Refused(why));
        }
    }

    /// A connection, from the hello to its end.
    fn serve(&self, socket: Socket, ticket: u64) {
        let slot = self.queue.slot(ticket);
        let mut connection = match self.open(socket) {
            Ok(connection) => connection,
            Err(why) => return self.refused(why),
        };
        match connection.greet(self) {
            Ok(mut link) => {
                drop(slot);
                let why = connection.run(&mut link);
                connection.finish();
                link.handle.detach(why);
                connection.channel.drain(Instant::now() + SAFE);
            }
            Err(why) => {
                // It closes by its reason, if it is not closed already.
                connection.session.close(&why);
                connection.finish();
                self.refused(why);
                let until = Instant::now() + SAFE;
                connection.channel.drain(until);
                thread::sleep(until.saturating_duration_since(Instant::now()));
            }
        }
    }

    fn open(&self, socket: Socket) -> Result<Connection, String> {
        let tls = self.keys.as_ref().map(ControllerKeys::connection).transpose().map_err(said)?;
        let channel = Channel::new(socket, tls.map(Into::into)).map_err(said)?;
        Ok(Connection { channel, session: Session::controller(self.clock, Instant::now()) })
    }

    /// A session for the neighbour that asks for admission, if it may have one.
    fn admit(&self, role: Role, channel: &Channel) -> Result<Link, String> {
        if let Some(keys) = &self.keys {
            let certificate = channel.certificate().ok_or("the neighbour has no certificate")?;
            keys.check(certificate, role)?;
        }
        let handle = self.handles.iter().find(|handle| handle.role() == role);
        let handle = handle.ok_or_else(|| format!("no {role} was expected in another process"))?;
        handle.attach().map_err(said)
    }
}

impl Connection {
    /// Until the neighbour is admitted; else why it is not.
    fn greet(&mut self, server: &Server) -> Result<Link, String> {
        self.channel.check_user().map_err(said)?;
        loop {
            self.channel.send(&mut self.session).map_err(said)?;
            self.session.check_time(Instant::now()).map_err(said)?;
            let ready = self.channel.wait(None, self.session.deadline()).map_err(said)?;
            let open = !ready || self.channel.receive(&mut self.session, Instant::now()).map_err(refusal)?;
            if let Some(Event::Hello(role)) = self.session.event(Instant::now()).map_err(said)? {
                let link = server.admit(role, &self.channel)?;
                self.session.admit();
                return Ok(link);
            }
            if !open {
                return Err("no hello: the connection was closed".to_owned());
            }
        }
    }

    /// Until the session ends; why it did.
    fn run(&mut self, link: &mut Link) -> Disconnect {
        loop {
            match self.turn(link) {
                Ok(()) if link.is_over() => {
                    self.session.close(&OVER);
                    return Disconnect::Closed;
                }
                Ok(()) => {}
                Err(why) => {
                    self.session.close(&why);
                    return why;
                }
            }
        }
    }

    /// Send what is new, wait, and take in what has come.
    fn turn(&mut self, link: &mut Link) -> Result<(), Disconnect> {
        let lost = |error: io::Error| Disconnect::Lost(error.to_string());
        let now = Instant::now();
        // A neighbour that does not read gets the latest values when it does, not all of them.
        if self.channel.is_flushed() {
            link.collect(|outgoing| match outgoing {
                Outgoing::Mailbox(mailbox) => self.session.send(mailbox),
                Outgoing::Pulse(tick) => self.session.pulse(tick, now),
            });
        }
        self.channel.send(&mut self.session).map_err(lost)?;
        self.session.check_time(now).map_err(ended)?;
        let wake = self.channel.is_flushed().then(|| link.wake());
        let ready = self.channel.wait(wake, self.session.deadline()).map_err(lost)?;
        let now = Instant::now();
        let received = if ready { self.channel.receive(&mut self.session, now) } else { Ok(true) };
        while let Some(event) = self.session.event(now).map_err(ended)? {
            match event {
                Event::Mailgram(place, used) => {
                    let delivered = link.handle.deliver(place, used);
                    delivered.map_err(|error| Disconnect::Violation(error.to_string()))?;
                }
                Event::Pulse(tick) => link.handle.answer(tick),
                Event::Hello(_) | Event::Welcome(_) => {}
            }
        }
        if received.map_err(lost)? { Ok(()) } else { Err(Disconnect::Closed) }
    }

    fn finish(&mut self) {
        self.channel.finish(&mut self.session, Instant::now() + SAFE);
    }
}

fn said(error: impl fmt::Display) -> String {
    error.to_string()
}

/// Why a connection ends in front of its hello.
fn refusal(error: io::Error) -> String {
    if error.kind() == io::ErrorKind::InvalidData {
        format!("TLS: {error}")
    } else {
        format!("no hello: {error}")
    }
}

/// Why a session has ended by itself.
fn ended(error: SessionError) -> Disconnect {
    match error {
        SessionError::Silent(limit) => Disconnect::Silent(limit),
        other => Disconnect::Violation(other.to_string()),
    }
}
