//! The neighbour's end of a Zenoh network.

use std::{
    io,
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread,
    time::{Duration, Instant},
};

use zenoh::{
    Session, Wait as _,
    liveliness::LivelinessToken,
    query::{ConsolidationMode, QueryTarget},
    sample::{Sample, SampleKind},
};

use super::{
    Posts, Side,
    envelope::{self, EnvelopeError},
    failed,
    keys::{self, Keys},
};
use crate::network::{
    Address, PeerError, Role, Secret,
    frame::{Frame, FrameError, LAST_WORDS, PULSE, WELCOME},
    hello::{Agreement, Challenge, ClockKind, HELLO, HelloError, check_welcome},
    office::Outlet,
    peer::{Connection, Inlet, LIMIT, PAUSE, last_words, unverified},
    seal::Seal,
    station::Station,
};

/// What has come and was not read yet, at most. What is more is lost, and seen to be by its number.
const UNREAD: usize = 4096;
/// Challenges that are answered, at most: strangers can send some too, and only the controller's leads to a welcome.
const CHALLENGES: usize = 4;

/// What has come.
enum Event {
    /// Something under the key of an address.
    Envelope(u32, Vec<u8>),
    /// The controller's token has gone.
    Gone,
}

/// Connect to the controller of a station; as long as nobody is there, try again until a time.
pub fn connect(
    address: &Address,
    station: &Station,
    role: Role,
    secret: &Secret,
    until: Instant,
) -> Result<Connection, PeerError> {
    let broken = |source| PeerError::Line { address: address.clone(), source };
    let session = super::open(station, Side::Neighbour).map_err(broken)?;
    let keys = Keys::new(station);
    let (events, unread) = sync_channel(UNREAD);
    subscribe(&session, &keys, role, &events).map_err(|error| broken(failed(error)))?;
    let posts = Posts::declare(&session, &keys, role, Side::Neighbour).map_err(broken)?;
    let greeting = Greeting { session: &session, keys: &keys, role, secret, events: &events };
    loop {
        match greeting.greet(address) {
            Ok(Welcomed { agreement, clock, here }) => {
                let sender = Publishing { posts, seal: agreement.up() };
                let limit = (clock == ClockKind::Real).then_some(LIMIT);
                let receiver =
                    Reading { unread, seal: agreement.down(), limit, _here: here, _session: session };
                return Ok(Connection { sender: Box::new(sender), receiver: Box::new(receiver), clock });
            }
            Err(error) if error.is_passing() && Instant::now() < until => thread::sleep(PAUSE),
            Err(error) => return Err(error),
        }
    }
}

/// Listen to all that the controller publishes for a neighbour, as long as the session lasts.
fn subscribe(session: &Session, keys: &Keys, role: Role, events: &SyncSender<Event>) -> zenoh::Result<()> {
    let addresses = role.from_controller().iter().map(|place| place.address).chain([PULSE, LAST_WORDS]);
    for address in addresses {
        let events = events.clone();
        let callback = move |sample: Sample| {
            // Without room it is lost.
            let _ = events.try_send(Event::Envelope(address, sample.payload().to_bytes().into_owned()));
        };
        session.declare_subscriber(keys.of(role, true, address)).callback(callback).background().wait()?;
    }
    Ok(())
}

/// Who was let in.
struct Welcomed {
    agreement: Agreement,
    clock: ClockKind,
    here: LivelinessToken,
}

/// A hello.
struct Greeting<'a> {
    session: &'a Session,
    keys: &'a Keys,
    role: Role,
    secret: &'a Secret,
    events: &'a SyncSender<Event>,
}

impl Greeting<'_> {
    /// Answer what challenges there are, until one leads to a welcome.
    fn greet(&self, address: &Address) -> Result<Welcomed, PeerError> {
        let broken = |source| PeerError::Line { address: address.clone(), source };
        let mistrusted = |source| PeerError::Hello { address: address.clone(), source };
        let mut refused = broken(io::Error::new(io::ErrorKind::NotFound, "no controller answers"));
        for said in self.ask(Vec::new()).map_err(broken)?.into_iter().take(CHALLENGES) {
            // Last words have the place of a challenge as well.
            let told = || read_refusal(&said).unwrap_or_else(|| mistrusted(HelloError::Impostor));
            let challenge = <[u8; HELLO]>::try_from(said.as_slice())
                .map_err(|_| told())
                .and_then(|bytes| Challenge::from_bytes(bytes).map_err(mistrusted));
            match challenge.and_then(|challenge| self.answer(&challenge, address)) {
                Err(error) => refused = error,
                welcomed => return welcomed,
            }
        }
        Err(refused)
    }

    /// Answer a challenge.
    fn answer(&self, challenge: &Challenge, address: &Address) -> Result<Welcomed, PeerError> {
        let broken = |source| PeerError::Line { address: address.clone(), source };
        let mistrusted = |source| PeerError::Hello { address: address.clone(), source };
        let (answer, agreement) = challenge.answer(self.role, Some(self.secret)).map_err(broken)?;
        let agreement = agreement.ok_or_else(|| mistrusted(HelloError::Proof))?;
        let here = self.declare(&keys::id(&answer)).map_err(|error| broken(failed(error)))?;
        let replies = self.ask([challenge.bytes().as_slice(), &answer].concat()).map_err(broken)?;
        let is_welcome = |reply: &Vec<u8>| {
            let frame = Frame::from_bytes(reply).ok().filter(|frame| frame.address() == WELCOME);
            frame.is_some_and(|frame| check_welcome(frame.data(), Some(&agreement)).is_ok())
        };
        if replies.iter().any(is_welcome) {
            return Ok(Welcomed { agreement, clock: challenge.clock(), here });
        }
        let told = replies.iter().find_map(|reply| read_refusal(reply));
        Err(told.unwrap_or_else(|| mistrusted(HelloError::Impostor)))
    }

    /// Ask whoever answers hellos.
    fn ask(&self, payload: Vec<u8>) -> io::Result<Vec<Vec<u8>>> {
        let query = self.session.get(self.keys.hello(self.role));
        let replies = query
            .payload(payload)
            .target(QueryTarget::All)
            .consolidation(ConsolidationMode::None)
            .timeout(LIMIT)
            .wait()
            .map_err(failed)?;
        let bytes = |sample: &Sample| sample.payload().to_bytes().into_owned();
        Ok(replies.into_iter().filter_map(|reply| reply.result().ok().map(bytes)).collect())
    }

    /// Show that this neighbour is there, and see that the controller is.
    fn declare(&self, id: &str) -> zenoh::Result<LivelinessToken> {
        let events = self.events.clone();
        let gone = move |token: Sample| {
            if token.kind() == SampleKind::Delete {
                // A reader so far behind that there is no room has lost frames as well, and notices that.
                let _ = events.try_send(Event::Gone);
            }
        };
        let controller = self.keys.controller_here(id);
        self.session.liveliness().declare_subscriber(controller).callback(gone).background().wait()?;
        self.session.liveliness().declare_token(self.keys.neighbour_here(self.role, id)).wait()
    }
}

/// Why one is refused, if these are last words.
fn read_refusal(reply: &[u8]) -> Option<PeerError> {
    let frame = Frame::from_bytes(reply).ok()?;
    (frame.address() == LAST_WORDS).then(|| unverified(last_words(&frame)))
}

/// Frames to the controller.
struct Publishing {
    posts: Posts,
    seal: Seal,
}

impl Outlet for Publishing {
    fn send(&mut self, frame: &Frame) -> io::Result<()> {
        self.posts.put(&mut self.seal, frame)
    }

    /// The connection ends with its session.
    fn close(&mut self) {}
}

/// Frames from the controller.
struct Reading {
    unread: Receiver<Event>,
    seal: Seal,
    /// How long nothing may come; `None` for ever, as long as the controller is there.
    limit: Option<Duration>,
    _here: LivelinessToken,
    _session: Session,
}

impl Inlet for Reading {
    fn receive(&mut self) -> Result<Frame, FrameError> {
        let until = self.limit.map(|limit| Instant::now() + limit);
        loop {
            let event = match until {
                Some(until) => self.unread.recv_timeout(until.saturating_duration_since(Instant::now())),
                None => self.unread.recv().map_err(RecvTimeoutError::from),
            };
            let (address, bytes) = match event {
                Ok(Event::Envelope(address, bytes)) => (address, bytes),
                Ok(Event::Gone) | Err(RecvTimeoutError::Disconnected) => {
                    return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
                }
                Err(RecvTimeoutError::Timeout) => return Err(io::Error::from(io::ErrorKind::TimedOut).into()),
            };
            match envelope::open(&mut self.seal, address, &bytes) {
                Ok(frame) => return Ok(frame),
                Err(EnvelopeError::Broken(error)) => return Err(error),
                // A stranger's, or of a connection before this one: it changes nothing.
                Err(EnvelopeError::Short(_) | EnvelopeError::Strange(_)) => {}
            }
        }
    }
}
