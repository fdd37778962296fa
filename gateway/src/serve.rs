//! `rcs-gateway serve`: the gateway of a cell, on the machine of its run.

use std::{
    io,
    os::unix::net::UnixStream,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread,
    time::Instant,
};

use neighbours::line::{
    Role, Session as LineSession,
    session::{Event, SessionError},
};
use sockets::Line;
use zenoh::{
    Session, Wait as _,
    qos::{CongestionControl, Priority},
    query::Query,
    sample::{Sample, SampleKind},
};

use crate::{
    address::{Name, Right},
    cli::ServeArguments,
    config,
    end::End,
    error::{Error, words},
    inbox::Inbox,
    keys::Keys,
    keyspace::{CellKeys, ClaimId},
    lines,
    pace::Pace,
    refusal::Refusal,
    relay::{Admitted, Relay, Side},
    sample::State,
    say, say_refused, signals,
    status::Board,
};

const CLAIMS: usize = 64; // greatest number of claims that are open or being opened

struct Request {
    role: Role,
    name: Name,
    query: Query,
}

struct Gateway {
    cell: CellKeys,
    run: std::path::PathBuf,
    session: Session,
    board: Board,
    open: AtomicUsize,
    pace: Pace,
    inboxes: Mutex<Vec<Arc<Inbox>>>,
}

/// Serves a cell until a signal arrives. Fails if the keys, the address or the options cannot be used.
pub fn serve(arguments: &ServeArguments) -> Result<(), Error> {
    let ServeArguments { cell, endpoint, run, router, keys, allow } = arguments;
    let own = Keys::load(keys, cell)?;
    let signals = signals::receive()?;
    endpoint.check_free().map_err(|source| Error::Endpoint { endpoint: *endpoint, source })?;
    let config = config::gateway(cell, *endpoint, *router, &own, allow).map_err(Error::zenoh)?;
    let session = zenoh::open(config).wait().map_err(Error::zenoh)?;
    let space = CellKeys::of(cell.as_str());
    let token = session.liveliness().declare_token(space.alive(&session.zid().to_string()));
    let token = token.wait().map_err(Error::zenoh)?;
    let board = Board::start(&session, &space, run.path().to_owned()).map_err(Error::zenoh)?;
    let gateway = Arc::new(Gateway {
        cell: space,
        run: run.path().to_owned(),
        session,
        board,
        open: AtomicUsize::new(0),
        pace: Pace::default(),
        inboxes: Mutex::default(),
    });
    let (requests, asked) = sync_channel(CLAIMS);
    for permission in allow {
        if let Right::Claim(role) = permission.right {
            for name in &permission.names {
                gateway.listen(role, name, requests.clone()).map_err(Error::zenoh)?;
            }
        }
    }
    let answering = Arc::clone(&gateway);
    thread::spawn(move || answering.answer(&asked));
    say!("{cell} at {endpoint}, for the run at {run}");
    if !gateway.board.is_there() {
        say!("no run listens at {run} yet; claims wait for one with --network {run}");
    }
    signals::wait(signals);
    gateway.stop();
    drop(token);
    let _ = gateway.session.close().wait();
    Ok(())
}

impl Gateway {
    /// Receive a certificate's requests for claims of a role. Zenoh's thread only passes them on.
    fn listen(&self, role: Role, name: &Name, requests: SyncSender<Request>) -> Result<(), zenoh::Error> {
        let owner = name.clone();
        let take = move |query: Query| {
            // If too many wait, the request is not answered, and the neighbour asks again.
            let _ = requests.try_send(Request { role, name: owner.clone(), query });
        };
        self.session.declare_queryable(self.cell.open(role, name)).callback(take).background().wait()
    }

    fn answer(self: Arc<Self>, asked: &Receiver<Request>) {
        for request in asked {
            if self.open.fetch_add(1, Ordering::AcqRel) >= CLAIMS {
                self.open.fetch_sub(1, Ordering::AcqRel);
                refuse(&request, &Refusal::Refused("too many claims are open".to_owned()));
                continue;
            }
            let gateway = Arc::clone(&self);
            thread::spawn(move || {
                gateway.claim(request);
                gateway.open.fetch_sub(1, Ordering::AcqRel);
            });
        }
    }

    fn stop(&self) {
        self.inboxes().iter().for_each(|inbox| inbox.stop());
        let until = Instant::now() + crate::end::CLOSING;
        while self.open.load(Ordering::Acquire) > 0 && Instant::now() < until {
            thread::sleep(crate::end::GRACE);
        }
    }

    fn inboxes(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Inbox>>> {
        self.inboxes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn claim(&self, request: Request) {
        let payload = request.query.payload().map(|payload| payload.to_bytes().into_owned());
        let Some(claim) = payload.as_deref().and_then(ClaimId::received) else {
            refuse(&request, &Refusal::Refused("expected 32 hexadecimal digits for the claim".to_owned()));
            return;
        };
        let Some(wait) = self.pace.ask(&request.name, Instant::now()) else {
            refuse(&request, &Refusal::Refused(format!("too many requests of {} wait", request.name)));
            return;
        };
        thread::sleep(wait);
        let entered = self.enter(request.role);
        let is_refused = matches!(entered, Err(Refusal::Refused(_)));
        self.pace.answered(&request.name, is_refused, Instant::now());
        let admitted = match entered {
            Ok(admitted) => admitted,
            Err(refusal) => return refuse(&request, &refusal),
        };
        let Request { role, name, query } = request;
        match self.carry(role, &name, query, &claim, admitted) {
            Ok(end) => say!("{role} {name} has disconnected: {end}"),
            Err(error) => say!("{role} {name}: {}", words(&error)),
        }
    }

    /// Connect to the run in a role. The run decides whether the role is free.
    fn enter(&self, role: Role) -> Result<Admitted, Refusal> {
        let absent =
            |error: io::Error| Refusal::Absent(format!("no run listens at {}: {error}", self.run.display()));
        let refused = |error: SessionError| Refusal::Refused(error.to_string());
        let mut line = UnixStream::connect(&self.run).and_then(Line::new).map_err(absent)?;
        line.check_user().map_err(absent)?;
        let mut session = LineSession::neighbour(role, Instant::now());
        let clock = loop {
            let now = Instant::now();
            if let Some(Event::Welcome(clock)) = session.event(now).map_err(refused)? {
                break clock;
            }
            line.send(session.output()).map_err(absent)?;
            session.check_time(now).map_err(refused)?;
            if line.wait(None, session.deadline()).map_err(absent)? {
                let now = Instant::now();
                if !line.receive(|bytes| session.receive(bytes, now)).map_err(absent)? {
                    // The reason may be in the last bytes.
                    session.event(now).map_err(refused)?;
                    return Err(Refusal::Absent("the run has closed the connection".to_owned()));
                }
            }
        };
        Ok(Admitted { line, session, clock })
    }

    fn carry(
        &self,
        role: Role,
        name: &Name,
        query: Query,
        claim: &ClaimId,
        mut admitted: Admitted,
    ) -> Result<End, zenoh::Error> {
        let keys = self.cell.claim(role, name, claim.as_str());
        let inbox = Arc::new(Inbox::new(role != Role::Operator)?);
        let delivered = Arc::clone(&inbox);
        let deliver = move |sample: Sample| delivered.deliver(sample.payload().to_bytes().into_owned());
        let _subscriber = self.session.declare_subscriber(keys.inward()).callback(deliver).wait()?;
        let watched = Arc::clone(&inbox);
        let gone = move |token: Sample| {
            if token.kind() == SampleKind::Delete {
                watched.set_gone();
            }
        };
        let liveliness = self.session.liveliness();
        let _watcher = liveliness.declare_subscriber(keys.alive()).history(true).callback(gone).wait()?;
        let publisher = self
            .session
            .declare_publisher(keys.outward())
            .priority(Priority::InteractiveHigh)
            .congestion_control(CongestionControl::Drop)
            .express(true)
            .wait()?;
        self.inboxes().push(Arc::clone(&inbox));
        query.reply(query.key_expr(), Refusal::clock_word(admitted.clock)).wait()?;
        // The answer is complete when the query is dropped.
        drop(query);
        self.board.connected(role, name.as_str());
        say!("{role} {name} has connected");
        let end = if role == Role::Operator {
            let unread = admitted.session.take_unread();
            lines::relay(admitted.line, unread, Some(name), &inbox, &mut |bytes| {
                // A sample that cannot be sent is lost, like one lost in transit.
                let _ = publisher.put(bytes).wait();
            })
        } else {
            let mut publish = |state: &State, end: Option<&str>| {
                let _ = publisher.put(state.encode(end)).wait();
                self.board.update(state);
            };
            Relay::new(admitted, role, Side::Run, &inbox, &mut publish).run()
        };
        self.board.disconnected(role);
        self.inboxes().retain(|other| !Arc::ptr_eq(other, &inbox));
        Ok(end)
    }
}

fn refuse(request: &Request, refusal: &Refusal) {
    let Request { role, name, query } = request;
    say_refused!("{role} {name} was refused: {refusal}");
    // A neighbour that does not get the answer times out.
    let _ = query.reply_err(refusal.encode()).wait();
}
