//! The run's side of the sessions.

use std::{
    fs, io,
    io::Read as _,
    os::unix::{
        fs::PermissionsExt as _,
        net::{UnixListener, UnixStream},
    },
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread,
    time::Duration,
};

use rustix::{
    net::{SendFlags, send, sockopt},
    process::geteuid,
};

use crate::protocol::{self, Answer, Event, GREETING, Lines, Name, ProtocolError, SILENCE};

/// Greatest number of open sessions.
const SESSIONS: usize = 8;
/// Number of events that can wait for the next tick. A session that sends more is blocked.
const QUEUE: usize = 64;
/// Time limit for the first line of a session, which contains its name.
const HELLO: Duration = Duration::from_secs(2);

/// An event of a session, as delivered to the run.
#[derive(Debug)]
pub struct Given {
    /// Name of the session.
    pub source: Name,
    /// The event.
    pub event: Event,
    /// Number of the request and stream for its answer; `None` if the event is not a request.
    reply: Option<(u32, Arc<UnixStream>)>,
}

impl Given {
    /// Answers the request, if the event is one. Does not wait: a session that does not read its answers is ended.
    pub fn answer(self, verdict: Result<String, String>) {
        let Some((number, stream)) = self.reply else { return };
        let line = format!("{}\n", Answer { number, verdict });
        if say(&stream, &line).is_err() {
            end(&stream);
        }
    }
}

/// Accepts operators of a run until it is dropped.
pub struct Listener {
    path: PathBuf,
    events: Receiver<Given>,
    sessions: Arc<Sessions>,
}

/// The streams of the open sessions.
type Streams = Mutex<Vec<Arc<UnixStream>>>;

impl Listener {
    /// Listens at a path, with access for this user only. Its directory must belong to this user alone.
    ///
    /// # Errors
    /// The error of the operating system if the socket or the thread cannot be created.
    pub fn start(path: &Path, run: &str) -> io::Result<Self> {
        let socket = UnixListener::bind(path)?;
        fs::set_permissions(path, fs::Permissions::from_mode(0o600))?;
        let (sender, events) = sync_channel(QUEUE);
        let sessions = Arc::new(Sessions {
            run: run.to_owned(),
            sender,
            stop: AtomicBool::new(false),
            streams: Streams::default(),
            open: AtomicUsize::new(0),
            entered: AtomicU32::new(0),
        });
        let admitting = Arc::clone(&sessions);
        thread::Builder::new().name("operators".into()).spawn(move || admitting.accept(&socket))?;
        Ok(Self { path: path.to_owned(), events, sessions })
    }

    /// The entrance for operators from a network.
    #[must_use]
    pub fn entrance(&self) -> Entrance {
        Entrance { sessions: Arc::clone(&self.sessions) }
    }

    /// Returns the next event if there is one. Does not wait.
    #[must_use]
    pub fn try_next(&self) -> Option<Given> {
        self.events.try_recv().ok()
    }

    /// Path of the socket.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.sessions.stop.store(true, Ordering::Relaxed);
        lock(&self.sessions.streams).iter().for_each(|stream| end(stream));
        // The thread checks `stop` at the next connection.
        let _ = UnixStream::connect(&self.path);
        let _ = fs::remove_file(&self.path);
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

/// Opens sessions for operators that were authenticated by other means than their user, for example by a certificate.
#[derive(Clone)]
pub struct Entrance {
    sessions: Arc<Sessions>,
}

impl Entrance {
    /// Begins a session and returns the other end of its stream. The run sees its name with the prefix `netN.`, N
    /// counted from 1, so that no two sessions have the same name.
    ///
    /// # Errors
    /// The error of the operating system, or an error if the run is over.
    pub fn enter(&self) -> io::Result<UnixStream> {
        if self.sessions.stop.load(Ordering::Relaxed) {
            return Err(io::Error::other("the run is over"));
        }
        let (ours, theirs) = UnixStream::pair()?;
        let number = self.sessions.entered.fetch_add(1, Ordering::Relaxed).wrapping_add(1);
        self.sessions.admit(Arc::new(ours), format!("net{number}."))?;
        Ok(theirs)
    }
}

/// The sessions of a run.
struct Sessions {
    run: String,
    sender: SyncSender<Given>,
    stop: AtomicBool,
    streams: Streams,
    /// Number of open sessions.
    open: AtomicUsize,
    /// Number of sessions begun through an entrance.
    entered: AtomicU32,
}

impl Sessions {
    /// Accepts sessions; runs in its own thread.
    fn accept(self: Arc<Self>, socket: &UnixListener) {
        for stream in socket.incoming() {
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            // A client that disconnects early must not stop the listener.
            let Ok(stream) = stream else {
                thread::sleep(SILENCE);
                continue;
            };
            // If the thread cannot start, the session is closed.
            let stream = Arc::new(stream);
            let _ = match check_user(&stream) {
                Ok(()) => self.admit(stream, String::new()),
                Err(why) => say(&stream, &refusal(&why.to_string())),
            };
        }
    }

    fn admit(self: &Arc<Self>, stream: Arc<UnixStream>, origin: String) -> io::Result<()> {
        if self.open.load(Ordering::Relaxed) >= SESSIONS {
            let why = format!("{SESSIONS} operators are connected: end another session first");
            return say(&stream, &refusal(&why));
        }
        let session = Session {
            stream: stream.clone(),
            lines: Lines::default(),
            sender: self.sender.clone(),
            greeting: format!("{GREETING} {}\n", self.run),
            origin,
        };
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

/// An answer with number 0, which belongs to no request.
fn refusal(why: &str) -> String {
    format!("{}\n", Answer { number: 0, verdict: Err(why.to_owned()) })
}

/// Refuses sessions of other users.
fn check_user(stream: &UnixStream) -> io::Result<()> {
    let (expected, found) = (geteuid(), sockopt::socket_peercred(stream)?.uid);
    if expected == found {
        return Ok(());
    }
    let why = format!("user {} was expected, found user {}", expected.as_raw(), found.as_raw());
    Err(io::Error::new(io::ErrorKind::PermissionDenied, why))
}

/// A session, which runs in its own thread.
struct Session {
    stream: Arc<UnixStream>,
    lines: Lines,
    sender: SyncSender<Given>,
    greeting: String,
    /// Prefix of the session's name.
    origin: String,
}

/// Why a session ends.
enum End {
    /// The client or the run has ended the session.
    Closed,
    /// The client has violated the protocol.
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
            self.give(&name, Event::Connected, None)?;
            let ended = self.listen(&name);
            let _ = self.give(&name, Event::Disconnected, None);
            ended
        });
        if let End::Wrong(why) = end_of_session {
            // The client may already have disconnected.
            let _ = say(&self.stream, &refusal(&why.to_string()));
        }
        end(&self.stream);
    }

    fn greet(&mut self) -> Result<Name, End> {
        let limit = self.stream.set_read_timeout(Some(HELLO));
        limit.map_err(|_| End::Closed)?;
        let line = self.line(|| Err(End::Wrong(ProtocolError::NoHello(String::new()))))?;
        let name = protocol::hello(&line)?.from(&self.origin);
        say(&self.stream, &self.greeting).map_err(|_| End::Closed)?;
        Ok(name)
    }

    fn listen(&mut self, name: &Name) -> Result<std::convert::Infallible, End> {
        self.stream.set_read_timeout(Some(SILENCE)).map_err(|_| End::Closed)?;
        let mut is_silent = false;
        loop {
            let (sender, name_again) = (self.sender.clone(), name.clone());
            let line = self.line(|| {
                if is_silent {
                    return Ok(());
                }
                is_silent = true;
                let given = Given { source: name_again.clone(), event: Event::Silent, reply: None };
                sender.send(given).map_err(|_| End::Closed)
            })?;
            is_silent = false;
            if let Some((number, text)) = protocol::request(&line)? {
                self.give(name, Event::Line(text.to_owned()), Some(number))?;
            }
        }
    }

    /// Reads the next line. Calls `silent` whenever nothing has arrived within the time limit.
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

    fn give(&self, name: &Name, event: Event, number: Option<u32>) -> Result<(), End> {
        let reply = number.map(|number| (number, self.stream.clone()));
        let given = Given { source: name.clone(), event, reply };
        self.sender.send(given).map_err(|_| End::Closed)
    }
}
