//! The controller's end of a Zenoh network: lets in who may, and reads what they publish.
//!
//! A connection begins with two queries of the neighbour at the key of his hello. The first brings him a challenge; the second
//! has this challenge and his answer to it, and brings the welcome, or last words:
//!
//! ```text
//!   neighbour                                    controller
//!      get  rcs2/t3/workstation/hello              reply  challenge, 40 bytes
//!      get  the same, challenge and answer         reply  a frame: welcome or last words
//! ```
//!
//! Frames are read where Zenoh's threads bring them: that takes microseconds and waits for nobody. All that may take longer (to let
//! somebody in, to send last words) is left to a thread of the reception's own.

use std::{
    io,
    sync::{
        Arc, Mutex,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use zenoh::{
    Session, Wait as _,
    liveliness::LivelinessToken,
    query::Query,
    sample::{Sample, SampleKind},
};

use super::{
    Posts, Side,
    envelope::{self, EnvelopeError},
    failed,
    keys::{self, Keys},
};
use crate::network::{
    News, Parting, Secret,
    frame::{Frame, PULSE},
    hello::{ANSWER, Agreement, Challenge, HELLO, HelloError, welcome},
    listener::patience,
    office::{Counter, Outlet, locked},
    seal::Seal,
    station::Station,
};

/// Challenges that wait for their answer, at most, and for how long.
const CHALLENGES: usize = 64;
const CHALLENGE_TIME: Duration = Duration::from_secs(10);
/// Queries and calls for the reception's thread that wait, at most.
const WAITING: usize = 64;
/// How often it looks after its connections unasked.
const ROUND: Duration = Duration::from_millis(250);
/// Strangers are told of one by one, so many in such a time; more are counted: they may be many, and the log is finite.
const REPORTS: u32 = 8;
const REPORT_TIME: Duration = Duration::from_secs(1);

/// What the reception's thread is called for.
enum Call {
    /// A hello, at the booth with a number.
    Hello(usize, Query),
    /// A connection is over.
    Look,
    /// The run is over.
    End,
}

/// Waits for neighbours.
pub struct Reception {
    calls: SyncSender<Call>,
    thread: Option<JoinHandle<()>>,
    session: Session,
}

/// Where one neighbour is received.
struct Booth {
    counter: Counter,
    posts: Posts,
    connection: Mutex<Option<Connection>>,
}

/// A neighbour that was let in.
struct Connection {
    id: String,
    seal: Seal,
    state: State,
    /// Tells the neighbour that the controller lives. It stays until the next connection: it would be gone before last words
    /// have come.
    _here: LivelinessToken,
}

/// ```text
///   Lives --what ends it--> Over --the reception's thread--> Parted
/// ```
enum State {
    Lives,
    /// It is to be taken leave of, and why.
    Over(Parting),
    /// Last words were sent.
    Parted,
}

impl Connection {
    const fn lives(&self) -> bool {
        matches!(self.state, State::Lives)
    }

    /// Only the first reason counts.
    fn end(&mut self, why: Parting) {
        if self.lives() {
            self.state = State::Over(why);
        }
    }
}

/// What was heard of strangers of late.
struct Strangers {
    /// Since when they are counted.
    since: Instant,
    told: u32,
    untold: u64,
}

/// What the threads of Zenoh and that of the reception have in common.
struct Shared {
    booths: Vec<Booth>,
    strangers: Mutex<Strangers>,
    calls: SyncSender<Call>,
}

impl Reception {
    /// Wait for the neighbours of some counters.
    ///
    /// # Errors
    /// If the session cannot be opened; [`io::ErrorKind::AddrInUse`] if another run has the station.
    pub fn open(station: &Station, secret: Secret, counters: Vec<Counter>) -> io::Result<Self> {
        let session = super::open(station, Side::Controller)?;
        let keys = Keys::new(station);
        let others = session.liveliness().get(keys.run()).wait().map_err(failed)?;
        if others.into_iter().any(|reply| reply.result().is_ok()) {
            return Err(io::ErrorKind::AddrInUse.into());
        }
        let run = session.liveliness().declare_token(keys.run()).wait().map_err(failed)?;
        let (calls, called) = sync_channel(WAITING);
        let booth = |counter: Counter| {
            let posts = Posts::declare(&session, &keys, counter.role(), Side::Controller)?;
            Ok(Booth { counter, posts, connection: Mutex::new(None) })
        };
        let booths = counters.into_iter().map(booth).collect::<io::Result<_>>()?;
        let strangers = Mutex::new(Strangers { since: Instant::now(), told: 0, untold: 0 });
        let shared = Arc::new(Shared { booths, strangers, calls: calls.clone() });
        for number in 0..shared.booths.len() {
            listen(&session, &keys, &shared, number).map_err(failed)?;
        }
        let receptionist = Receptionist {
            session: session.clone(),
            keys,
            secret,
            shared,
            challenges: Vec::new(),
            _run: run,
        };
        let thread = Some(thread::spawn(move || receptionist.receive(&called)));
        Ok(Self { calls, thread, session })
    }
}

impl Drop for Reception {
    fn drop(&mut self) {
        // If it is gone already, there is nothing to end.
        let _ = self.calls.send(Call::End);
        if let Some(thread) = self.thread.take() {
            // It has nothing to return, and a panic in it was reported.
            let _ = thread.join();
        }
        // A neighbour that cannot be reached needs no farewell.
        let _ = self.session.close().wait();
    }
}

/// Listen to all keys of a neighbour, as long as the session lasts.
fn listen(session: &Session, keys: &Keys, shared: &Arc<Shared>, number: usize) -> zenoh::Result<()> {
    let role = shared.booths[number].counter.role();
    for address in role.to_controller().iter().map(|place| place.address).chain([PULSE]) {
        let theirs = Arc::clone(shared);
        let callback = move |sample: Sample| theirs.read(number, address, &sample);
        session.declare_subscriber(keys.of(role, false, address)).callback(callback).background().wait()?;
    }
    let theirs = Arc::clone(shared);
    let gone = move |token: Sample| {
        if token.kind() == SampleKind::Delete {
            theirs.leave(number, |id| token.key_expr().as_str().ends_with(id));
        }
    };
    let everybody = keys.neighbour_here(role, "*");
    session.liveliness().declare_subscriber(everybody).callback(gone).background().wait()?;
    let theirs = Arc::clone(shared);
    let hello = move |query: Query| {
        // Who is not heard asks again; a queue without an end would be worse.
        if theirs.calls.try_send(Call::Hello(number, query)).is_err() {
            theirs.tell(number, News::Refused("too many connect at once".to_owned()));
        }
    };
    session.declare_queryable(keys.hello(role)).callback(hello).background().wait()
}

impl Shared {
    /// What has come under a key of a neighbour.
    fn read(&self, number: usize, address: u32, sample: &Sample) {
        let booth = &self.booths[number];
        let key = sample.key_expr();
        let mut connection = locked(&booth.connection);
        let Some(connection) = connection.as_mut().filter(|connection| connection.lives()) else {
            return self.stray(number, format!("{key}: nobody is connected who may write it"));
        };
        let opened = match sample.kind() {
            SampleKind::Put => envelope::open(&mut connection.seal, address, &sample.payload().to_bytes()),
            SampleKind::Delete => Err(EnvelopeError::Short(0)),
        };
        let over = match opened {
            Ok(frame) => {
                booth.counter.deliver(&frame).err().map(|error| Parting::Dismissed(error.to_string()))
            }
            Err(EnvelopeError::Broken(error)) => Some(Parting::Dismissed(error.to_string())),
            Err(error) => return self.stray(number, format!("{key}: {error}")),
        };
        if let Some(why) = over {
            connection.end(why);
            self.look();
        }
    }

    /// A neighbour has left; nothing if his name is not meant.
    fn leave(&self, number: usize, is_meant: impl FnOnce(&str) -> bool) {
        let mut connection = locked(&self.booths[number].connection);
        if let Some(connection) = connection.as_mut().filter(|connection| is_meant(&connection.id)) {
            connection.end(Parting::closed());
            self.look();
        }
    }

    fn look(&self) {
        // If there is no room, the thread is awake.
        let _ = self.calls.try_send(Call::Look);
    }

    /// What came was a stranger's.
    fn stray(&self, number: usize, what: String) {
        self.tell(number, News::Stray(what));
    }

    /// Tell of a stranger, or count him if enough were told of just now.
    fn tell(&self, number: usize, news: News) {
        self.report(false);
        let mut strangers = locked(&self.strangers);
        if strangers.told < REPORTS {
            strangers.told += 1;
            drop(strangers);
            self.booths[number].counter.tell(news);
        } else {
            strangers.untold += 1;
        }
    }

    /// Tell of those that were only counted, when it is time.
    fn report(&self, at_once: bool) {
        let mut strangers = locked(&self.strangers);
        if !at_once && strangers.since.elapsed() < REPORT_TIME {
            return;
        }
        let untold = strangers.untold;
        *strangers = Strangers { since: Instant::now(), told: 0, untold: 0 };
        drop(strangers);
        if let Some(booth) = self.booths.first().filter(|_| untold > 0) {
            booth.counter.tell(News::Stray(format!("{untold} more, of the last second")));
        }
    }
}

/// The reception's thread.
struct Receptionist {
    session: Session,
    keys: Keys,
    secret: Secret,
    shared: Arc<Shared>,
    /// That wait for their answer, the oldest first.
    challenges: Vec<(Challenge, Instant)>,
    /// Tells other runs that the station is taken.
    _run: LivelinessToken,
}

impl Receptionist {
    fn receive(mut self, called: &Receiver<Call>) {
        loop {
            match called.recv_timeout(ROUND) {
                Ok(Call::Hello(number, query)) => self.greet(number, &query),
                Ok(Call::Look) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Call::End) | Err(RecvTimeoutError::Disconnected) => break,
            }
            self.challenges.retain(|(_, made)| made.elapsed() < CHALLENGE_TIME);
            self.shared.report(false);
            self.shared.booths.iter().for_each(look_after);
        }
        self.shared.report(true);
    }

    /// A query at the hello of a neighbour.
    fn greet(&mut self, number: usize, query: &Query) {
        let role = self.shared.booths[number].counter.role();
        let said = query.payload().map(|payload| payload.to_bytes().into_owned()).unwrap_or_default();
        let reply = if said.is_empty() {
            self.challenge(number).map(|challenge| challenge.bytes().to_vec())
        } else {
            self.admit(number, &said).map(|welcome| welcome.bytes().to_vec())
        };
        let reply = reply.unwrap_or_else(|why| {
            let last_words = Frame::last_words(&why).bytes().to_vec();
            self.shared.tell(number, News::Refused(why));
            last_words
        });
        // Who has asked may be gone: a connection that nobody knows of ends by its silence.
        let _ = query.reply(self.keys.hello(role), reply).wait();
    }

    fn challenge(&mut self, number: usize) -> Result<Challenge, String> {
        let clock = self.shared.booths[number].counter.clock();
        let challenge = Challenge::new(clock).map_err(|error| error.to_string())?;
        if self.challenges.len() == CHALLENGES {
            self.challenges.remove(0);
        }
        self.challenges.push((challenge, Instant::now()));
        Ok(challenge)
    }

    /// Let in who has answered a challenge, or say why not.
    fn admit(&mut self, number: usize, said: &[u8]) -> Result<Frame, String> {
        let booth = &self.shared.booths[number];
        let expected = || format!("a challenge and its answer, {} bytes, were expected", HELLO + ANSWER);
        let found = || format!("{}, found {} bytes", expected(), said.len());
        let (challenge, answer) = said.split_first_chunk::<HELLO>().ok_or_else(found)?;
        let answer: &[u8; ANSWER] = answer.try_into().map_err(|_| found())?;
        let known = self.challenges.iter().position(|(known, _)| known.bytes() == challenge);
        // Each is good for one answer.
        let (challenge, _) =
            self.challenges.remove(known.ok_or("the answer is to no challenge of this run")?);
        let (role, agreement) =
            challenge.judge(answer, Some(&self.secret)).map_err(|error| error.to_string())?;
        let agreement = agreement.ok_or_else(|| HelloError::Proof.to_string())?;
        if role != booth.counter.role() {
            return Err(format!("{} was expected at this key, found {role}", booth.counter.role()));
        }
        if booth.counter.is_connected() {
            return Err(format!("{role} is connected already"));
        }
        self.connect(number, keys::id(answer), &agreement).map_err(|error| error.to_string())?;
        Ok(Frame::welcome(&welcome(Some(&agreement))))
    }

    fn connect(&self, number: usize, id: String, agreement: &Agreement) -> io::Result<()> {
        let booth = &self.shared.booths[number];
        let here = self.session.liveliness().declare_token(self.keys.controller_here(&id)).wait();
        let _here = here.map_err(failed)?;
        let shared = Arc::clone(&self.shared);
        let outlet = Publishing { shared, number, id: id.clone(), seal: agreement.down() };
        booth.counter.attach(Box::new(outlet), None).map_err(io::Error::other)?;
        *locked(&booth.connection) =
            Some(Connection { id, seal: agreement.up(), state: State::Lives, _here });
        Ok(())
    }
}

/// End the connection of a booth if it is over, or dead.
fn look_after(booth: &Booth) {
    let mut locked = locked(&booth.connection);
    let Some(connection) = locked.as_mut() else { return };
    let limit = patience(booth.counter.clock());
    if booth.counter.is_late(limit) {
        connection.end(Parting::silent(limit));
    }
    match std::mem::replace(&mut connection.state, State::Parted) {
        State::Over(why) => {
            // Sending last words needs nobody to wait.
            drop(locked);
            booth.counter.detach(why);
        }
        before => connection.state = before,
    }
}

/// Frames to a neighbour.
struct Publishing {
    shared: Arc<Shared>,
    number: usize,
    id: String,
    seal: Seal,
}

impl Outlet for Publishing {
    fn send(&mut self, frame: &Frame) -> io::Result<()> {
        self.shared.booths[self.number].posts.put(&mut self.seal, frame)
    }

    fn close(&mut self) {
        self.shared.leave(self.number, |id| id == self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::Role;

    #[test]
    fn every_neighbour_has_keys() {
        let keys = Keys::new(&"t3".parse().unwrap());
        for role in Role::ALL {
            let hello = keys.hello(role);
            assert!(zenoh::key_expr::keyexpr::new(hello.as_str()).is_ok_and(|key| !key.is_wild()), "{hello}");
        }
    }
}
