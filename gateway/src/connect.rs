//! `rcs-gateway connect`: the other end of a claim, beside a neighbour or an operator.
//!
//! It listens at a Unix socket. Each program that connects there gets its own Zenoh session and claim, so that nothing
//! of an earlier connection is left.

use std::{
    io,
    os::unix::net::UnixStream,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use neighbours::line::{ClockKind, Role, Session as LineSession, session::Event};
use sockets::{Acceptor, Line};
use zenoh::{
    Session, Wait as _,
    liveliness::LivelinessToken,
    pubsub::{Publisher, Subscriber},
    qos::{CongestionControl, Priority},
    query::ConsolidationMode,
    sample::{Sample, SampleKind},
};

use crate::{
    address::{CellAddress, Name, Right},
    cli::ConnectArguments,
    config,
    end::{CLOSING, End},
    error::{Error, words},
    inbox::Inbox,
    keys::Keys,
    keyspace::{ANY, CellKeys, ClaimId},
    lines,
    refusal::Refusal,
    relay::{Admitted, Relay, Side},
    sample::State,
    say, signals,
};

/// Time limit of the answer to a claim: longer than the 10 s of the run.
const ANSWER: Duration = Duration::from_secs(12);
const PROGRAMS: usize = 8; // greatest number of programs at the socket

struct Neighbourhood {
    address: CellAddress,
    role: Role,
    keys: Keys,
    open: AtomicUsize,
    inboxes: Mutex<Vec<Arc<Inbox>>>,
}

/// Carries a role until a signal arrives. Fails if the keys, the socket or the options cannot be used.
pub fn connect(arguments: &ConnectArguments) -> Result<(), Error> {
    let ConnectArguments { cell, role, socket, keys, name } = arguments;
    let Right::Claim(role) = *role else { return Err(Error::Monitor(cell.clone())) };
    let keys = Keys::named_or_only(keys, name.as_ref())?;
    let signals = signals::receive()?;
    let near = Arc::new(Neighbourhood {
        address: cell.clone(),
        role,
        keys,
        open: AtomicUsize::new(0),
        inboxes: Mutex::default(),
    });
    let accepting = Arc::clone(&near);
    let started = Acceptor::start(socket.path(), "programs", move |stream| accepting.accept(stream));
    let acceptor = started.map_err(|source| match source.kind() {
        io::ErrorKind::AddrInUse => Error::InUse(socket.clone()),
        _ => Error::Socket { address: socket.clone(), source },
    })?;
    say!("{role} of {cell} as {}: waits for a program at {socket}", near.keys.name);
    // The first attempt reports wrong keys and addresses at once.
    if let Err(refusal) = near.open_session() {
        say!("{refusal}; the next program at {socket} tries again");
    }
    signals::wait(signals);
    drop(acceptor);
    near.stop();
    Ok(())
}

struct Claim {
    clock: ClockKind,
    inbox: Arc<Inbox>,
    publisher: Publisher<'static>,
    _token: LivelinessToken, // fields are dropped in this order
    _subscribers: [Subscriber<()>; 2],
}

impl Neighbourhood {
    fn inboxes(&self) -> MutexGuard<'_, Vec<Arc<Inbox>>> {
        self.inboxes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn accept(self: &Arc<Self>, stream: UnixStream) {
        if self.open.fetch_add(1, Ordering::AcqRel) >= PROGRAMS {
            self.open.fetch_sub(1, Ordering::AcqRel);
            return;
        }
        let near = Arc::clone(self);
        thread::spawn(move || {
            near.serve(stream);
            near.open.fetch_sub(1, Ordering::AcqRel);
        });
    }

    fn stop(&self) {
        self.inboxes().iter().for_each(|inbox| inbox.stop());
        let until = Instant::now() + CLOSING;
        while self.open.load(Ordering::Acquire) > 0 && Instant::now() < until {
            thread::sleep(crate::end::GRACE);
        }
    }

    fn serve(&self, stream: UnixStream) {
        let role = self.role;
        let session = match self.open_session() {
            Ok(session) => session,
            // The program gets no reason, so it tries again, as if no run listened.
            Err(refusal) => return say!("{refusal}"),
        };
        let end = match self.claim(&session) {
            Ok(claim) => self.carry(stream, &claim),
            Err(refusal) => {
                say!("{role}: {refusal}");
                if let Refusal::Refused(reason) = refusal {
                    self.turn_away(stream, &reason);
                }
                None
            }
        };
        if let Some(end) = end {
            say!("{role} has disconnected: {end}");
        }
        let _ = session.close().wait();
    }

    fn open_session(&self) -> Result<Session, Refusal> {
        let Self { address, role, keys, .. } = self;
        let absent = |error: zenoh::Error| {
            Refusal::Absent(format!(
                "{address} cannot be reached: {} (is rcs-gateway serve running, and does it accept the \
                 certificate of {}?)",
                words(&error),
                keys.name
            ))
        };
        let config = config::neighbour(&address.cell, address.endpoint, *role, keys).map_err(absent)?;
        zenoh::open(config).wait().map_err(absent)
    }

    fn claim(&self, session: &Session) -> Result<Claim, Refusal> {
        let Self { role, keys: Keys { name, .. }, address, .. } = self;
        let cell = CellKeys::of(address.cell.as_str());
        let failed = |error: zenoh::Error| Refusal::Absent(words(&error));
        let system = |error: io::Error| Refusal::Absent(error.to_string());
        let id = ClaimId::random().map_err(|error| Refusal::Absent(error.to_string()))?;
        let keys = cell.claim(*role, name, id.as_str());
        let inbox = Arc::new(Inbox::new(*role != Role::Operator).map_err(system)?);
        let delivered = Arc::clone(&inbox);
        let deliver = move |sample: Sample| delivered.deliver(sample.payload().to_bytes().into_owned());
        let subscriber =
            session.declare_subscriber(keys.outward()).callback(deliver).wait().map_err(failed)?;
        let watched = Arc::clone(&inbox);
        let gone = move |token: Sample| {
            if token.kind() == SampleKind::Delete {
                watched.set_gone();
            }
        };
        let liveliness = session.liveliness();
        let watcher = liveliness.declare_subscriber(cell.alive(ANY)).history(true).callback(gone);
        let watcher = watcher.wait().map_err(failed)?;
        let publisher = session
            .declare_publisher(keys.inward())
            .priority(Priority::InteractiveHigh)
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait()
            .map_err(failed)?;
        let token = liveliness.declare_token(keys.alive()).wait().map_err(failed)?;
        let clock = ask(session, &cell.open(*role, name), &id, *role, name)?;
        Ok(Claim { clock, inbox, publisher, _token: token, _subscribers: [subscriber, watcher] })
    }

    /// Sends a program the reason of its refusal.
    fn turn_away(&self, stream: UnixStream, reason: &str) {
        if let Ok((mut session, mut line)) = self.greet(stream, ClockKind::Real) {
            session.close(&reason);
            close(&mut line, &mut session);
        }
    }

    fn greet(&self, stream: UnixStream, clock: ClockKind) -> Result<(LineSession, Line), String> {
        fn said(error: impl ToString) -> String {
            error.to_string()
        }
        let mut line = Line::new(stream).map_err(said)?;
        line.check_user().map_err(said)?;
        let mut session = LineSession::controller(clock, Instant::now());
        loop {
            line.send(session.output()).map_err(said)?;
            session.check_time(Instant::now()).map_err(said)?;
            if line.wait(None, session.deadline()).map_err(said)? {
                let now = Instant::now();
                let is_open = line.receive(|bytes| session.receive(bytes, now)).map_err(said)?;
                let event = session.event(now);
                let wrong = match event {
                    Ok(Some(Event::Hello(role))) if role == self.role => return Ok((session, line)),
                    Ok(Some(Event::Hello(role))) => format!("expected {}, found {role}", self.role),
                    Err(error) => error.to_string(),
                    Ok(_) if is_open => continue,
                    Ok(_) => "the program has closed the connection".to_owned(),
                };
                session.close(&wrong);
                close(&mut line, &mut session);
                return Err(wrong);
            }
        }
    }

    fn carry(&self, stream: UnixStream, claim: &Claim) -> Option<End> {
        let Claim { clock, inbox, publisher, .. } = claim;
        let (mut session, line) = match self.greet(stream, *clock) {
            Ok(greeted) => greeted,
            Err(wrong) => {
                say!("{}: {wrong}", self.role);
                return None;
            }
        };
        say!("{} has connected", self.role);
        self.inboxes().push(Arc::clone(inbox));
        session.admit();
        let end = if self.role == Role::Operator {
            let mut line = line;
            let sent = line.send(session.output());
            let unread = session.take_unread();
            match sent {
                Ok(()) => {
                    lines::relay(line, unread, None, inbox, &mut |bytes| put(publisher, bytes.to_vec()))
                }
                Err(error) => End::Local(error.to_string()),
            }
        } else {
            let admitted = Admitted { line, session, clock: *clock };
            let mut publish = |state: &State, end: Option<&str>| put(publisher, state.encode(end));
            Relay::new(admitted, self.role, Side::Neighbour, inbox, &mut publish).run()
        };
        self.inboxes().retain(|other| !Arc::ptr_eq(other, inbox));
        Some(end)
    }
}

fn close(line: &mut Line, session: &mut LineSession) {
    let until = Instant::now() + CLOSING;
    line.finish(session.output(), until);
    line.drain(until);
}

/// Send a sample. A sample that cannot be sent is lost, like one lost in transit.
fn put(publisher: &Publisher<'_>, sample: Vec<u8>) {
    let _ = publisher.put(sample).wait();
}

fn ask(session: &Session, key: &str, id: &ClaimId, role: Role, name: &Name) -> Result<ClockKind, Refusal> {
    let failed = |error: zenoh::Error| Refusal::Absent(words(&error));
    let replies =
        session.get(key).payload(id.as_str()).timeout(ANSWER).consolidation(ConsolidationMode::None);
    let replies = replies.wait().map_err(failed)?;
    let silent = || {
        Refusal::Refused(format!(
            "the gateway gives no answer: does its --allow have {role}={name}, and is it the gateway of this cell?"
        ))
    };
    match replies.into_iter().next().map(zenoh::query::Reply::into_result) {
        Some(Ok(sample)) => Refusal::clock(&sample.payload().to_bytes()),
        Some(Err(error)) => Err(Refusal::decode(&error.payload().to_bytes()).unwrap_or_else(silent)),
        None => Err(silent()),
    }
}
