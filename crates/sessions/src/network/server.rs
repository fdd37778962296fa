//! One thread serves each connection, from the hello to its end.

use std::{
    fmt, io,
    os::unix::net::UnixStream,
    sync::{Arc, Mutex},
    thread,
    time::Instant,
};

use sockets::Line;

use super::{
    ClockKind, Disconnect, NetEvent, Operators, Role,
    accept_queue::{AcceptQueue, SAFE},
    session::{Event, Session, SessionError},
    shared::{EndpointHandle, Link, OVER, Outgoing, locked},
};

const CROWDED: &str = "too many connect at once";

pub(super) struct Server {
    handles: Vec<EndpointHandle>,
    operators: Option<Operators>,
    clock: ClockKind,
    queue: AcceptQueue,
    crowded: Mutex<Option<Instant>>, // time of the last report of "too many connect"
}

struct Connection {
    line: Line,
    session: Session,
}

impl Server {
    pub fn new(handles: Vec<EndpointHandle>, operators: Option<Operators>, clock: ClockKind) -> Self {
        Self { handles, operators, clock, queue: AcceptQueue::default(), crowded: Mutex::default() }
    }

    /// Serve a connection in a new thread if the accept queue has a free slot; otherwise close it.
    pub fn enter(self: &Arc<Self>, stream: UnixStream) {
        if let Ok(Some(ticket)) = self.queue.enter(&stream) {
            let server = Arc::clone(self);
            thread::spawn(move || server.serve(stream, ticket));
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

    fn serve(&self, stream: UnixStream, ticket: u64) {
        let slot = self.queue.slot(ticket);
        let mut connection = match Line::new(stream) {
            Ok(line) => Connection { line, session: Session::controller(self.clock, Instant::now()) },
            Err(error) => return self.refused(said(error)),
        };
        match connection.greet(self) {
            Ok(Admitted::Neighbour(mut link)) => {
                drop(slot);
                let why = connection.run(&mut link);
                connection.finish();
                link.handle.detach(why);
                connection.line.drain(Instant::now() + SAFE);
            }
            Ok(Admitted::Operator(operators)) => {
                drop(slot);
                if let Err(error) = connection.hand_over(operators) {
                    self.refused(said(error));
                }
            }
            Err(why) => {
                // Send the reason unless the session is already closed.
                connection.session.close(&why);
                connection.finish();
                self.refused(why);
                let until = Instant::now() + SAFE;
                connection.line.drain(until);
                thread::sleep(until.saturating_duration_since(Instant::now()));
            }
        }
    }

    /// Admit a client in the role that its hello names. The error is the reason of a refusal.
    fn admit(&self, role: Role) -> Result<Admitted<'_>, String> {
        if role == Role::Operator {
            let operators = self.operators.as_ref();
            let operators = operators
                .ok_or("the run takes no operator at its network; one with --operator network does")?;
            operators.check_open()?;
            return Ok(Admitted::Operator(operators));
        }
        let handle = self.handles.iter().find(|handle| handle.role() == role);
        let handle = handle.ok_or_else(|| format!("no {role} was expected in another process"))?;
        handle.attach().map(Admitted::Neighbour).map_err(said)
    }
}

enum Admitted<'a> {
    Neighbour(Link),
    Operator(&'a Operators),
}

impl Connection {
    /// Receive until the other side is admitted. The error is the reason of a refusal.
    fn greet<'a>(&mut self, server: &'a Server) -> Result<Admitted<'a>, String> {
        self.line.check_user().map_err(said)?;
        loop {
            self.line.send(self.session.output()).map_err(said)?;
            self.session.check_time(Instant::now()).map_err(said)?;
            let ready = self.line.wait(None, self.session.deadline()).map_err(said)?;
            let open =
                !ready || self.receive(Instant::now()).map_err(|error| format!("no hello: {error}"))?;
            if let Some(Event::Hello(role)) = self.session.event(Instant::now()).map_err(said)? {
                let admitted = server.admit(role)?;
                self.session.admit();
                return Ok(admitted);
            }
            if !open {
                return Err("no hello: the connection was closed".to_owned());
            }
        }
    }

    /// Pass received bytes to the session. Returns false if the other side has closed the connection.
    fn receive(&mut self, now: Instant) -> io::Result<bool> {
        let session = &mut self.session;
        self.line.receive(|bytes| session.receive(bytes, now))
    }

    /// Send the welcome to an operator, and pass its connection to the run.
    fn hand_over(mut self, operators: &Operators) -> io::Result<()> {
        let until = Instant::now() + SAFE;
        self.line.send(self.session.output())?;
        while !self.line.is_flushed() && Instant::now() < until {
            self.line.wait(None, Some(until))?;
            self.line.send(self.session.output())?;
        }
        let unread = self.session.take_unread();
        operators.enter(self.line.into_stream()?, unread)
    }

    /// Run the session until it ends. Returns the reason.
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

    fn turn(&mut self, link: &mut Link) -> Result<(), Disconnect> {
        let lost = |error: io::Error| Disconnect::Lost(error.to_string());
        let now = Instant::now();
        // A neighbour that reads slowly receives only the latest values.
        if self.line.is_flushed() {
            link.collect(|outgoing| match outgoing {
                Outgoing::Mailbox(mailbox) => self.session.send(mailbox),
                Outgoing::Pulse(tick) => self.session.pulse(tick, now),
            });
        }
        self.line.send(self.session.output()).map_err(lost)?;
        self.session.check_time(now).map_err(ended)?;
        let wake = self.line.is_flushed().then(|| link.wake());
        let ready = self.line.wait(wake, self.session.deadline()).map_err(lost)?;
        let now = Instant::now();
        let received = if ready { self.receive(now) } else { Ok(true) };
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
        self.line.finish(self.session.output(), Instant::now() + SAFE);
    }
}

fn said(error: impl fmt::Display) -> String {
    error.to_string()
}

fn ended(error: SessionError) -> Disconnect {
    match error {
        SessionError::Silent(limit) => Disconnect::Silent(limit),
        other => Disconnect::Violation(other.to_string()),
    }
}
