//! The run's side of the sessions.

use std::{
    io,
    io::Read as _,
    os::unix::net::UnixStream,
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread,
    time::Duration,
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    net::{SendFlags, send},
};
use sockets::{Acceptor, check_user};

use crate::operator::{
    clock::{RunClock, RunTime},
    protocol::{self, Answer, Event, Greeting, Lines, Name, ProtocolError, Request, SILENCE},
};

const SESSIONS: usize = 8;
/// Number of events that can wait for the next tick. A session that sends more is blocked.
const QUEUE: usize = 64;
/// Time limit for the first line of a session, which contains its name.
const HELLO: Duration = Duration::from_secs(2);

/// An event of a session, as delivered to the run.
#[derive(Debug)]
pub struct Given {
    pub source: Name,
    pub event: Event,
    request: Option<Received>, // the request, if the event has one
}

#[derive(Debug)]
struct Received {
    number: u32,
    limit: Option<RunTime>,
    stream: Arc<UnixStream>, // stream of its session, for the answer
    clock: RunClock,
}

impl Given {
    /// Answers the request, if the event has one, without waiting. A session that does not read its answers is ended.
    pub fn answer(self, verdict: Result<String, String>) {
        let Some(Received { number, stream, clock, .. }) = self.request else { return };
        let line = format!("{}\n", Answer { number, time: clock.now(), verdict });
        if say(&stream, &line).is_err() {
            end(&stream);
        }
    }

    /// Marks a request as late if its sender no longer waits.
    #[must_use]
    pub fn judged(mut self) -> Self {
        if let (Event::Line(text), Some(received)) = (&self.event, &self.request) {
            let Received { number, limit, stream, clock } = received;
            let request = Request { number: *number, limit: *limit, text };
            if let Some(late) = request.late(clock.now(), is_open(stream)) {
                self.event = Event::Late(late, text.clone());
            }
        }
        self
    }
}

/// False if the other end of a stream is closed, even if some of its lines are unread.
fn is_open(stream: &UnixStream) -> bool {
    let mut ends = [PollFd::new(stream, PollFlags::RDHUP)];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    // An interrupted call has no result. The session itself reports its end.
    let polled = poll(&mut ends, Some(&at_once));
    let [end] = ends;
    polled.is_err() || !end.revents().intersects(PollFlags::RDHUP | PollFlags::HUP | PollFlags::ERR)
}

pub struct Listener {
    acceptor: Acceptor,
    events: Receiver<Given>,
    sessions: Arc<Sessions>,
}

type Streams = Mutex<Vec<Arc<UnixStream>>>;

impl Listener {
    /// Listens at a path that only this user can access.
    pub fn start(path: &Path, run: &str) -> io::Result<Self> {
        let (sender, events) = sync_channel(QUEUE);
        let sessions = Arc::new(Sessions {
            run: run.to_owned(),
            clock: RunClock::start(),
            names: Mutex::default(),
            sender,
            stop: AtomicBool::new(false),
            streams: Streams::default(),
            open: AtomicUsize::new(0),
            entered: AtomicU32::new(0),
        });
        let admitting = Arc::clone(&sessions);
        let acceptor = Acceptor::start(path, "operators", move |stream| admitting.accept(stream))?;
        Ok(Self { acceptor, events, sessions })
    }

    /// The entrance for operators from a network.
    #[must_use]
    pub fn entrance(&self) -> Entrance {
        Entrance { sessions: Arc::clone(&self.sessions) }
    }

    /// Returns the next event, if any, without waiting. A request whose sender no longer waits is marked as late.
    #[must_use]
    pub fn try_next(&self) -> Option<Given> {
        self.events.try_recv().ok().map(Given::judged)
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        self.acceptor.path()
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.sessions.stop.store(true, Ordering::Relaxed);
        lock(&self.sessions.streams).iter().for_each(|stream| end(stream));
    }
}

fn lock(streams: &Streams) -> std::sync::MutexGuard<'_, Vec<Arc<UnixStream>>> {
    streams.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sends a line completely without waiting, or fails.
fn say(stream: &UnixStream, line: &str) -> io::Result<()> {
    let sent = send(stream, line.as_bytes(), SendFlags::DONTWAIT | SendFlags::NOSIGNAL)?;
    if sent == line.len() { Ok(()) } else { Err(io::ErrorKind::WriteZero.into()) }
}

/// Ends reading and writing; the stream may already be closed.
fn end(stream: &UnixStream) {
    let _ = stream.shutdown(std::net::Shutdown::Both);
}

/// Opens sessions for operators that were authenticated other than by their user, for example by a certificate.
#[derive(Clone)]
pub struct Entrance {
    sessions: Arc<Sessions>,
}

impl Entrance {
    /// Begins a session over a stream from which `unread` was already received. Its name gets the prefix `netN.`, N
    /// from 1.
    pub fn enter(&self, stream: UnixStream, unread: &[u8]) -> io::Result<()> {
        if self.sessions.stop.load(Ordering::Relaxed) {
            return Err(io::Error::other("the run is over"));
        }
        let number = self.sessions.entered.fetch_add(1, Ordering::Relaxed).wrapping_add(1);
        self.sessions.admit(Arc::new(stream), format!("net{number}."), unread)
    }
}

struct Sessions {
    run: String,
    clock: RunClock,
    /// Names of the sessions that have begun, until their end was reported to the run.
    names: Mutex<Vec<Name>>,
    sender: SyncSender<Given>,
    stop: AtomicBool,
    streams: Streams,
    open: AtomicUsize,
    entered: AtomicU32, // number of sessions begun through an entrance
}

impl Sessions {
    fn accept(self: &Arc<Self>, stream: UnixStream) {
        let stream = Arc::new(stream);
        let _ = match check_user(&stream) {
            Ok(()) => self.admit(stream, String::new(), &[]),
            Err(why) => say(&stream, &refusal(&why.to_string())),
        };
    }

    fn admit(self: &Arc<Self>, stream: Arc<UnixStream>, origin: String, unread: &[u8]) -> io::Result<()> {
        if self.open.load(Ordering::Relaxed) >= SESSIONS {
            let why = format!("{SESSIONS} operators are connected: end another session first");
            return say(&stream, &refusal(&why));
        }
        let mut lines = Lines::default();
        lines.push(unread);
        let session = Session { stream: stream.clone(), lines, sessions: Arc::clone(self), origin };
        self.open.fetch_add(1, Ordering::Relaxed);
        lock(&self.streams).push(stream.clone());
        let sessions = Arc::clone(self);
        let thread = thread::Builder::new().name("operator".into()).spawn(move || {
            session.run();
            lock(&sessions.streams).retain(|open| !Arc::ptr_eq(open, &stream));
            sessions.open.fetch_sub(1, Ordering::Relaxed);
        });
        thread.map(|_| ()).inspect_err(|_| {
            self.open.fetch_sub(1, Ordering::Relaxed);
        })
    }
}

impl Sessions {
    /// Gives a session the requested name, with a number if another session has it.
    fn take_name(&self, asked: Name) -> Name {
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let name = asked.unlike(|name| names.contains(name));
        names.push(name.clone());
        name
    }

    fn free_name(&self, name: &Name) {
        self.names.lock().unwrap_or_else(PoisonError::into_inner).retain(|taken| taken != name);
    }
}

/// An answer with number 0, which belongs to no request.
fn refusal(why: &str) -> String {
    format!("{}\n", Answer { number: 0, time: RunTime::default(), verdict: Err(why.to_owned()) })
}

struct Session {
    stream: Arc<UnixStream>,
    lines: Lines,
    sessions: Arc<Sessions>,
    origin: String,
}

enum End {
    Closed,
    Wrong(ProtocolError),
}

impl From<ProtocolError> for End {
    fn from(error: ProtocolError) -> Self {
        Self::Wrong(error)
    }
}

impl Session {
    fn run(mut self) {
        let Err(end_of_session) = self.greet().and_then(|name| {
            let ended = self.give(&name, Event::Connected, None).and_then(|()| {
                let ended = self.welcome(&name).and_then(|()| self.listen(&name));
                let _ = self.give(&name, Event::Disconnected, None);
                ended
            });
            // The run is notified of the end before another session can have the name.
            self.sessions.free_name(&name);
            ended
        });
        if let End::Wrong(why) = end_of_session {
            let _ = say(&self.stream, &refusal(&why.to_string()));
        }
        end(&self.stream);
    }

    fn greet(&mut self) -> Result<Name, End> {
        let limit = self.stream.set_read_timeout(Some(HELLO));
        limit.map_err(|_| End::Closed)?;
        let line = self.line(|| Err(End::Wrong(ProtocolError::NoHello(String::new()))))?;
        let name = protocol::hello(&line)?.from(&self.origin);
        Ok(self.sessions.take_name(name))
    }

    fn welcome(&self, name: &Name) -> Result<(), End> {
        let Sessions { run, clock, .. } = &*self.sessions;
        let greeting = Greeting { run: run.clone(), name: name.clone(), time: clock.now() };
        say(&self.stream, &format!("{greeting}\n")).map_err(|_| End::Closed)
    }

    fn listen(&mut self, name: &Name) -> Result<std::convert::Infallible, End> {
        self.stream.set_read_timeout(Some(SILENCE)).map_err(|_| End::Closed)?;
        let mut is_silent = false;
        loop {
            let (sender, name_again) = (self.sessions.sender.clone(), name.clone());
            let line = self.line(|| {
                if is_silent {
                    return Ok(());
                }
                is_silent = true;
                let given = Given { source: name_again.clone(), event: Event::Silent, request: None };
                sender.send(given).map_err(|_| End::Closed)
            })?;
            is_silent = false;
            if let Some(Request { number, limit, text }) = protocol::request(&line)? {
                let (stream, clock) = (self.stream.clone(), self.sessions.clock);
                let received = Received { number, limit, stream, clock };
                self.give(name, Event::Line(text.to_owned()), Some(received))?;
            }
        }
    }

    /// Reads the next line. Calls `silent` whenever the time limit passes without data.
    fn line(&mut self, mut silent: impl FnMut() -> Result<(), End>) -> Result<String, End> {
        let mut bytes = [0; 512];
        loop {
            if let Some(line) = self.lines.next_line()? {
                return Ok(line);
            }
            match (&*self.stream).read(&mut bytes) {
                Ok(0) => return Err(End::Closed),
                Ok(count) => self.lines.push(bytes.get(..count).unwrap_or_default()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => {
                    silent()?;
                }
                Err(_) => return Err(End::Closed),
            }
        }
    }

    fn give(&self, name: &Name, event: Event, request: Option<Received>) -> Result<(), End> {
        let given = Given { source: name.clone(), event, request };
        self.sessions.sender.send(given).map_err(|_| End::Closed)
    }
}
