//! The controller's end of connections: each is served by its own thread, from the hello to its end.

use std::{
    fmt, io,
    os::unix::net::UnixStream,
    sync::{Arc, Mutex},
    thread,
    time::Instant,
};

use super::{
    ClockKind, ControllerKeys, Disconnect, NetEvent, Operators, Role,
    accept_queue::{AcceptQueue, SAFE},
    channel::Channel,
    operators::{SILENCE, carry},
    session::{Event, Session, SessionError},
    shared::{EndpointHandle, Link, OVER, Outgoing, locked},
    socket::Socket,
};

/// Reason for refusing a connection when the accept queue has no free slot.
const CROWDED: &str = "too many connect at once";

/// State that the threads of all connections share.
pub(super) struct Server {
    handles: Vec<EndpointHandle>,
    operators: Option<Operators>,
    keys: Option<ControllerKeys>,
    clock: ClockKind,
    queue: AcceptQueue,
    /// Time of the last report of "too many connect".
    crowded: Mutex<Option<Instant>>,
}

/// A connection.
struct Connection {
    channel: Channel,
    session: Session,
}

impl Server {
    pub fn new(
        handles: Vec<EndpointHandle>,
        operators: Option<Operators>,
        keys: Option<ControllerKeys>,
        clock: ClockKind,
    ) -> Self {
        Self { handles, operators, keys, clock, queue: AcceptQueue::default(), crowded: Mutex::default() }
    }

    /// Serve a connection in a new thread if the accept queue has a free slot; otherwise close it.
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
        match (self.handles.first(), &self.operators) {
            (Some(handle), _) => handle.tell(NetEvent::Refused(why)),
            (None, Some(operators)) => operators.tell(NetEvent::Refused(why)),
            (None, None) => {}
        }
    }

    /// Serve a connection from the hello to its end.
    fn serve(&self, socket: Socket, ticket: u64) {
        let slot = self.queue.slot(ticket);
        let mut connection = match self.open(socket) {
            Ok(connection) => connection,
            Err(why) => return self.refused(why),
        };
        match connection.greet(self) {
            Ok(Admitted::Neighbour(mut link)) => {
                drop(slot);
                let why = connection.run(&mut link);
                connection.finish();
                link.handle.detach(why);
                connection.channel.drain(Instant::now() + SAFE);
            }
            Ok(Admitted::Operator(operators, run)) => {
                drop(slot);
                operators.tell(NetEvent::Connected(Role::Operator));
                let why = connection.carry(&run);
                // The run sees the end of the session at once, even if the network is slow.
                drop(run);
                connection.finish();
                operators.tell(NetEvent::Disconnected(Role::Operator, why));
                connection.channel.drain(Instant::now() + SAFE);
            }
            Err(why) => {
                // Send the reason, unless the session is closed already.
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

    /// Admit a client in the role that its hello names; the error is the reason for refusing it.
    fn admit(&self, role: Role, channel: &Channel) -> Result<Admitted<'_>, String> {
        if let Some(keys) = &self.keys {
            let certificate = channel.certificate().ok_or("the neighbour has no certificate")?;
            keys.check(certificate, role)?;
        }
        if role == Role::Operator {
            let operators = self.operators.as_ref();
            let operators = operators
                .ok_or("the run takes no operator over the network; one with --operator network does")?;
            return Ok(Admitted::Operator(operators, operators.enter().map_err(said)?));
        }
        let handle = self.handles.iter().find(|handle| handle.role() == role);
        let handle = handle.ok_or_else(|| format!("no {role} was expected in another process"))?;
        handle.attach().map(Admitted::Neighbour).map_err(said)
    }
}

/// An admitted client.
enum Admitted<'a> {
    Neighbour(Link),
    /// An operator, with the stream that connects it to the run.
    Operator(&'a Operators, UnixStream),
}

impl Connection {
    /// Receive until the other side is admitted; the error is the reason for refusing it.
    fn greet<'a>(&mut self, server: &'a Server) -> Result<Admitted<'a>, String> {
        self.channel.check_user().map_err(said)?;
        loop {
            self.channel.send(&mut self.session).map_err(said)?;
            self.session.check_time(Instant::now()).map_err(said)?;
            let ready = self.channel.wait(None, self.session.deadline()).map_err(said)?;
            let open = !ready || self.channel.receive(&mut self.session, Instant::now()).map_err(refusal)?;
            if let Some(Event::Hello(role)) = self.session.event(Instant::now()).map_err(said)? {
                let admitted = server.admit(role, &self.channel)?;
                self.session.admit();
                return Ok(admitted);
            }
            if !open {
                return Err("no hello: the connection was closed".to_owned());
            }
        }
    }

    /// Carry an operator's lines between its connection and the run until one of them ends; returns why it has ended.
    fn carry(&mut self, run: &UnixStream) -> Disconnect {
        let unread = self.session.take_unread();
        let sent = self.channel.send(&mut self.session);
        let lost = |error: io::Error| Disconnect::Lost(error.to_string());
        sent.map_err(lost).map_or_else(|why| why, |()| carry(&mut self.channel, run, unread, Some(SILENCE)))
    }

    /// Run the session until it ends; returns why it has ended.
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

    /// Send changes, wait, and receive.
    fn turn(&mut self, link: &mut Link) -> Result<(), Disconnect> {
        let lost = |error: io::Error| Disconnect::Lost(error.to_string());
        let now = Instant::now();
        // A neighbour that reads slowly gets the latest values only.
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

/// As text: why a connection has ended before its hello.
fn refusal(error: io::Error) -> String {
    if error.kind() == io::ErrorKind::InvalidData {
        format!("TLS: {error}")
    } else {
        format!("no hello: {error}")
    }
}

/// The disconnect reason for an error of the session.
fn ended(error: SessionError) -> Disconnect {
    match error {
        SessionError::Silent(limit) => Disconnect::Silent(limit),
        other => Disconnect::Violation(other.to_string()),
    }
}
