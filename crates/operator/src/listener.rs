//! The side of the run.

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

/// Sessions at a time.
const SESSIONS: usize = 8;
/// Events that wait for the next tick. A session that sends more waits.
const QUEUE: usize = 64;
/// Time limit for the first line of a session, with its name.
const HELLO: Duration = Duration::from_secs(2);

/// An event of a session, as the run gets it.
#[derive(Debug)]
pub struct Given {
    /// Who.
    pub source: Name,
    /// What.
    pub event: Event,
    /// Where the answer to a request goes.
    reply: Option<(u32, Arc<UnixStream>)>,
}

impl Given {
    /// Answer the request, if it is one. This does not wait: a session that does not take its answers ends.
    pub fn answer(self, verdict: Result<String, String>) {
        let Some((number, stream)) = self.reply else { return };
        let line = format!("{}\n", Answer { number, verdict });
        if say(&stream, &line).is_err() {
            end(&stream);
        }
    }
}

/// Lets operators connect to a run, until it is dropped.
pub struct Listener {
    path: PathBuf,
    events: Receiver<Given>,
    sessions: Arc<Sessions>,
}

/// The sessions that are open.
type Streams = Mutex<Vec<Arc<UnixStream>>>;

impl Listener {
    /// Listen at a path, which only this user may use. Its directory must be this user's alone.
    ///
    /// # Errors
    /// If the socket or the thread cannot be made.
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

    /// Where operators of a network come in.
    #[must_use]
    pub fn entrance(&self) -> Entrance {
        Entrance { sessions: Arc::clone(&self.sessions) }
    }

    /// The next event, if one has come.
    #[must_use]
    pub fn try_next(&self) -> Option<Given> {
        self.events.try_recv().ok()
    }

    /// Where it listens.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.sessions.stop.store(true, Ordering::Relaxed);
        lock(&self.sessions.streams).iter().for_each(|stream| end(stream));
        // The thread sees `stop` with the next connection.
        let _ = UnixStream::connect(&self.path);
        let _ = fs::remove_file(&self.path);
    }
}

fn lock(streams: &Streams) -> std::sync::MutexGuard<'_, Vec<Arc<UnixStream>>> {
    streams.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Send a line whole and at once, or not at all.
fn say(stream: &UnixStream, line: &str) -> io::Result<()> {
    let sent = send(stream, line.as_bytes(), SendFlags::DONTWAIT | SendFlags::NOSIGNAL)?;
    if sent == line.len() { Ok(()) } else { Err(io::ErrorKind::WriteZero.into()) }
}

/// End reading and writing; the stream may be closed already.
fn end(stream: &UnixStream) {
    let _ = stream.shutdown(std::net::Shutdown::Both);
}

/// Opens sessions for operators that were authenticated otherwise than by their user, as by a certificate.
#[derive(Clone)]
pub struct Entrance {
    sessions: Arc<Sessions>,
}

impl Entrance {
    /// Begin a session, and return the other end of its stream. In the log its name begins with `netN.`, N counted from
    /// 1, so that no other session has the same name.
    ///
    /// # Errors
    /// What the system says, or that the run is over.
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
    /// How many are open.
    open: AtomicUsize,
    /// How many have come by an entrance.
    entered: AtomicU32,
}

impl Sessions {
    /// The thread that lets sessions in.
    fn accept(self: Arc<Self>, socket: &UnixListener) {
        for stream in socket.incoming() {
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            // A client that has left again is no reason to refuse the next one.
            let Ok(stream) = stream else {
                thread::sleep(SILENCE);
                continue;
            };
            // If the thread cannot be started, the client sees the end of its session.
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

/// A line without a number: no request is answered by it.
fn refusal(why: &str) -> String {
    format!("{}\n", Answer { number: 0, verdict: Err(why.to_owned()) })
}

/// Refuse a session of another user.
fn check_user(stream: &UnixStream) -> io::Result<()> {
    let (expected, found) = (geteuid(), sockopt::socket_peercred(stream)?.uid);
    if expected == found {
        return Ok(());
    }
    let why = format!("user {} was expected, found user {}", expected.as_raw(), found.as_raw());
    Err(io::Error::new(io::ErrorKind::PermissionDenied, why))
}

/// A session, in a thread of its own.
struct Session {
    stream: Arc<UnixStream>,
    lines: Lines,
    sender: SyncSender<Given>,
    greeting: String,
    /// What stands in front of its name.
    origin: String,
}

/// Why a session ends.
enum End {
    /// It or the run has ended.
    Closed,
    /// It has broken the protocol.
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
            // The client may have gone.
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

    /// The next line. `silent` is called when nothing has come within the time limit.
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
