//! The controller's end of the line: waits for neighbours, lets in who may, and reads what they send.
//!
//! Over sockets one thread waits for connections; each connection has a thread that says hello and then reads. Who is let in: at a socket in
//! the file system, processes of the same user; at a TCP port, who knows the secret. Everybody else is told why and
//! refused, and the controller is told.

use std::{
    fs, io,
    net::TcpListener,
    os::unix::{
        fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _},
        net::UnixListener,
    },
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use rustix::{
    net::{Shutdown, shutdown, sockopt},
    process::geteuid,
};

#[cfg(feature = "zenoh")]
use super::over_zenoh;
use super::{
    Address, Desk, News, Parting, Secret,
    door::{self, Door},
    frame::{Frame, FrameError},
    hello::{ANSWER, Agreement, Challenge, ClockKind, welcome},
    office::{Counter, Outlet as _},
    peer::Inlet as _,
    stream::{Receiver, Sender, Stream, is_timeout},
};

/// A neighbour that does not answer a pulse for so long is gone.
const PATIENCE: Duration = Duration::from_secs(10);
/// In fast clock nothing stands still but the run, and a machine may be busy with other things.
const FAST_PATIENCE: Duration = Duration::from_secs(60);

/// What is said to those for whom there is no place at the door.
pub(super) const CROWDED: &str = "too many connect at once";

/// Why nobody can connect.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// The address cannot be had.
    #[error("{address}: {source}")]
    Address {
        /// The address.
        address: Address,
        /// Why.
        source: io::Error,
    },
    /// Another run has it.
    #[error("{0}: another run waits for its neighbours there")]
    InUse(Address),
    /// Anybody on the network could command the robot.
    #[error("{0}: a network needs a secret that the neighbours know; name a file with --secret")]
    NoSecret(Address),
    /// Zenoh is left out of this program.
    #[cfg(not(feature = "zenoh"))]
    #[error("{0}: {NO_ZENOH}")]
    NoZenoh(Address),
}

/// What a program without Zenoh says.
#[cfg(not(feature = "zenoh"))]
pub(super) const NO_ZENOH: &str = "this program was built without Zenoh; cargo build --release --workspace --features zenoh \
                                   builds it with Zenoh";

enum Socket {
    Unix(UnixListener),
    Tcp(TcpListener),
}

/// Waits for neighbours.
pub struct Listener {
    /// Where they can connect: with the port that the system has chosen, if it was to.
    address: Address,
    _line: Line,
}

/// What it waits at.
enum Line {
    Sockets {
        _sockets: Sockets,
    },
    #[cfg(feature = "zenoh")]
    Zenoh {
        _reception: over_zenoh::controller::Reception,
    },
}

/// Waits at a socket.
struct Sockets {
    socket: Arc<Socket>,
    file: Option<SocketFile>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The file of a Unix socket. Another program may have put its own at the same path since.
struct SocketFile {
    path: PathBuf,
    /// Device and inode.
    identity: (u64, u64),
}

impl SocketFile {
    fn at(path: &Path) -> io::Result<Self> {
        let found = fs::symlink_metadata(path)?;
        Ok(Self { path: path.to_owned(), identity: (found.dev(), found.ino()) })
    }

    /// Remove the file, if it is still this one.
    fn remove(&self) {
        if Self::at(&self.path).is_ok_and(|found| found.identity == self.identity) {
            // It may have been removed just now.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// What the threads work with.
struct Reception {
    counters: Vec<Counter>,
    secret: Option<Secret>,
    clock: ClockKind,
    door: Door,
}

impl Listener {
    /// Wait for the neighbours of some desks at an address.
    ///
    /// # Errors
    /// [`ListenError`].
    ///
    /// # Panics
    /// If there are no desks.
    pub fn start<'a>(
        address: &Address,
        secret: Option<Secret>,
        desks: impl IntoIterator<Item = &'a Desk>,
    ) -> Result<Self, ListenError> {
        let counters: Vec<_> = desks.into_iter().map(Desk::counter).collect();
        let clock = counters.first().expect("a network has neighbours").clock();
        let failed = |source| ListenError::Address { address: address.clone(), source };
        let (socket, bound) =
            match (address, secret.clone()) {
                (Address::Unix(path), _) => (Socket::Unix(unix(path, address)?), address.clone()),
                (_, None) => return Err(ListenError::NoSecret(address.clone())),
                (Address::Tcp(place), Some(_)) => {
                    let listener = TcpListener::bind(place).map_err(failed)?;
                    let bound = listener.local_addr().map_err(failed)?;
                    (Socket::Tcp(listener), Address::Tcp(bound))
                }
                #[cfg(not(feature = "zenoh"))]
                (Address::Zenoh(_), Some(_)) => return Err(ListenError::NoZenoh(address.clone())),
                #[cfg(feature = "zenoh")]
                (Address::Zenoh(station), Some(secret)) => {
                    let _reception = over_zenoh::controller::Reception::open(station, secret, counters)
                        .map_err(|error| match error.kind() {
                            io::ErrorKind::AddrInUse => ListenError::InUse(address.clone()),
                            _ => failed(error),
                        })?;
                    return Ok(Self { address: address.clone(), _line: Line::Zenoh { _reception } });
                }
            };
        let reception = Arc::new(Reception { counters, secret, clock, door: Door::default() });
        let _sockets = Sockets::listen(socket, &bound, reception).map_err(failed)?;
        Ok(Self { address: bound, _line: Line::Sockets { _sockets } })
    }

    /// Where neighbours can connect.
    #[must_use]
    pub const fn address(&self) -> &Address {
        &self.address
    }
}

impl Sockets {
    fn listen(socket: Socket, address: &Address, reception: Arc<Reception>) -> io::Result<Self> {
        let file = match address {
            Address::Unix(path) => Some(SocketFile::at(path)?),
            Address::Tcp(_) | Address::Zenoh(_) => None,
        };
        let (socket, over) = (Arc::new(socket), Arc::new(AtomicBool::new(false)));
        let (waiting, flag) = (Arc::clone(&socket), Arc::clone(&over));
        let thread = Some(thread::spawn(move || listen(&waiting, &flag, &reception)));
        Ok(Self { socket, file, over, thread })
    }
}

impl Drop for Sockets {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        // Wakes the thread that waits for a connection, whatever stands at the address by now.
        let woken = match &*self.socket {
            Socket::Unix(listener) => shutdown(listener, Shutdown::Both),
            Socket::Tcp(listener) => shutdown(listener, Shutdown::Both),
        };
        if let Some(thread) = self.thread.take().filter(|_| woken.is_ok()) {
            // It has nothing to return, and a panic in it was reported.
            let _ = thread.join();
        }
        if let Some(file) = &self.file {
            file.remove();
        }
    }
}

/// How long a neighbour may take to answer a pulse.
pub(crate) const fn patience(clock: ClockKind) -> Duration {
    match clock {
        ClockKind::Real => PATIENCE,
        ClockKind::Fast => FAST_PATIENCE,
    }
}

/// A socket that a killed run has left is taken over.
fn unix(path: &Path, address: &Address) -> Result<UnixListener, ListenError> {
    let failed = |source| ListenError::Address { address: address.clone(), source };
    let listener = match UnixListener::bind(path) {
        Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
            if std::os::unix::net::UnixStream::connect(path).is_ok() {
                return Err(ListenError::InUse(address.clone()));
            }
            if !fs::symlink_metadata(path).map_err(failed)?.file_type().is_socket() {
                return Err(failed(error));
            }
            fs::remove_file(path).map_err(failed)?;
            UnixListener::bind(path).map_err(failed)?
        }
        bound => bound.map_err(failed)?,
    };
    fs::set_permissions(path, fs::Permissions::from_mode(0o600)).map_err(failed)?;
    Ok(listener)
}

fn listen(socket: &Socket, over: &AtomicBool, reception: &Arc<Reception>) {
    let mut crowded: Option<Instant> = None;
    while !over.load(Ordering::Acquire) {
        let accepted = match socket {
            Socket::Unix(listener) => listener.accept().map(|(stream, _)| Stream::Unix(stream)),
            Socket::Tcp(listener) => listener.accept().map(|(stream, _)| Stream::Tcp(stream)),
        };
        let Ok(stream) = accepted else {
            if over.load(Ordering::Acquire) {
                return;
            }
            // Out of file descriptors, perhaps: it must not become a busy loop.
            thread::sleep(Duration::from_millis(100));
            continue;
        };
        if over.load(Ordering::Acquire) {
            return;
        }
        let reception = Arc::clone(reception);
        if let Ok(Some(ticket)) = reception.door.enter(&stream) {
            thread::spawn(move || receive(stream, &reception, ticket));
        } else {
            send_away(stream, reception.clock);
            if crowded.is_none_or(|since| since.elapsed() >= door::SAFE) {
                crowded = Some(Instant::now());
                reception.tell(News::Refused(CROWDED.to_owned()));
            }
        }
    }
}

/// Say that there is no place. What is new holds so many bytes, so nobody is waited for.
fn send_away(mut stream: Stream, clock: ClockKind) {
    if let Ok(challenge) = Challenge::new(clock)
        && io::Write::write_all(&mut stream, challenge.bytes()).is_ok()
    {
        let mut sender = Sender::new(stream);
        // He may be gone already.
        let _ = sender.send(&Frame::last_words(CROWDED));
    }
}

impl Reception {
    fn tell(&self, news: News) {
        if let Some(counter) = self.counters.first() {
            counter.tell(news);
        }
    }

    /// Say hello; whose desk it is, and what was agreed upon. Who is refused has said his hello before, so that he can hear why.
    fn greet(&self, stream: &mut Stream) -> Result<(&Counter, Option<Agreement>), String> {
        let said = |error: &dyn std::fmt::Display| error.to_string();
        stream.prepare(patience(self.clock)).map_err(|error| said(&error))?;
        let challenge = Challenge::new(self.clock).map_err(|error| said(&error))?;
        io::Write::write_all(stream, challenge.bytes()).map_err(|error| said(&error))?;
        let mut answer = [0; ANSWER];
        io::Read::read_exact(stream, &mut answer).map_err(|error| match error {
            error if is_timeout(&error) => format!("no hello within {} s", patience(self.clock).as_secs()),
            error => format!("no hello: {error}"),
        })?;
        if let Stream::Unix(socket) = stream {
            let peer = sockopt::socket_peercred(socket).map_err(|error| said(&error))?;
            if peer.uid != geteuid() {
                return Err(format!(
                    "user {} was expected, found user {}",
                    geteuid().as_raw(),
                    peer.uid.as_raw()
                ));
            }
        }
        let (role, agreement) =
            challenge.judge(&answer, self.secret.as_ref()).map_err(|error| said(&error))?;
        let counter = self.counters.iter().find(|counter| counter.role() == role);
        counter
            .map(|counter| (counter, agreement))
            .ok_or_else(|| format!("no {role} was expected in another process"))
    }
}

/// A connection, from the hello to its end.
fn receive(mut stream: Stream, reception: &Reception, ticket: u64) {
    let place = reception.door.place(ticket);
    match admit(&mut stream, reception) {
        Ok((counter, agreement)) => {
            drop(place);
            let mut receiver = Receiver::new(stream);
            receiver.seal(agreement.as_ref().map(Agreement::up));
            let (limit, clerk) = (patience(reception.clock), counter.clone());
            counter.detach(match receiver.wait_until(move || clerk.is_late(limit)) {
                Ok(()) => read(&mut receiver, counter, limit),
                Err(error) => Parting::Left(error.to_string()),
            });
        }
        Err(why) => {
            reception.tell(News::Refused(why));
            thread::sleep(door::SAFE);
        }
    }
}

/// Let a neighbour in, or tell him why not.
fn admit<'a>(
    stream: &mut Stream,
    reception: &'a Reception,
) -> Result<(&'a Counter, Option<Agreement>), String> {
    let mut sender = Sender::new(stream.try_clone().map_err(|error| error.to_string())?);
    match reception.greet(stream) {
        Ok((counter, agreement)) => {
            let welcome = Frame::welcome(&welcome(agreement.as_ref()));
            sender.seal_behind_first(agreement.as_ref().map(Agreement::down));
            counter.attach(Box::new(sender), Some(&welcome)).map_err(|error| error.to_string())?;
            Ok((counter, agreement))
        }
        Err(why) => {
            // He may be gone already.
            let _ = sender.send(&Frame::last_words(&why));
            sender.close();
            Err(why)
        }
    }
}

/// Read until the connection ends; why it did.
fn read(receiver: &mut Receiver, counter: &Counter, limit: Duration) -> Parting {
    loop {
        match receiver.receive() {
            Ok(frame) => {
                if let Err(error) = counter.deliver(&frame) {
                    return Parting::Dismissed(error.to_string());
                }
                // He may talk without end, and answer nothing.
                if counter.is_late(limit) {
                    return Parting::silent(limit);
                }
            }
            Err(FrameError::Stream(error)) if is_timeout(&error) => return Parting::silent(limit),
            Err(FrameError::Stream(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Parting::closed();
            }
            Err(FrameError::Stream(error)) => return Parting::Left(error.to_string()),
            Err(error) => return Parting::Dismissed(error.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Peer, Role, hello::HELLO};

    #[test]
    fn a_socket_that_was_left_behind_is_taken_over_and_no_other_file_is() {
        let place = tempfile::tempdir().unwrap();
        let (socket, file) = (place.path().join("rcs.sock"), place.path().join("notes"));
        let desk = Desk::new(Role::Workstation, ClockKind::Real);
        drop(UnixListener::bind(&socket).unwrap());
        let listener = Listener::start(&Address::Unix(socket.clone()), None, [&desk]).unwrap();
        let second = Listener::start(&Address::Unix(socket.clone()), None, [&desk]);
        assert!(matches!(second, Err(ListenError::InUse(_))));
        drop(listener);
        assert!(!socket.exists());
        fs::write(&file, "not to be lost").unwrap();
        let refused = Listener::start(&Address::Unix(file.clone()), None, [&desk]);
        assert!(matches!(refused, Err(ListenError::Address { .. })));
        assert_eq!(fs::read_to_string(file).unwrap(), "not to be lost");
    }

    #[test]
    fn a_listener_whose_path_was_taken_by_another_ends_and_leaves_the_other_alone() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("rcs.sock");
        let desk = Desk::new(Role::Workstation, ClockKind::Real);
        let first = Listener::start(&Address::Unix(socket.clone()), None, [&desk]).unwrap();
        fs::remove_file(&socket).unwrap();
        let _second = UnixListener::bind(&socket).unwrap();
        drop(first);
        assert!(socket.exists());
    }

    #[test]
    fn for_whom_there_is_no_place_is_told_so() {
        let (ours, mut theirs) = std::os::unix::net::UnixStream::pair().unwrap();
        send_away(Stream::Unix(ours), ClockKind::Real);
        let mut bytes = [0; HELLO];
        io::Read::read_exact(&mut theirs, &mut bytes).unwrap();
        assert!(Challenge::from_bytes(bytes).is_ok());
        assert_eq!(Frame::read(&mut theirs).unwrap(), Frame::last_words(CROWDED));
    }

    #[test]
    fn strangers_that_say_nothing_keep_nobody_out() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("rcs.sock");
        let address = Address::Unix(socket.clone());
        let desk = Desk::new(Role::Workstation, ClockKind::Fast);
        let _listener = Listener::start(&address, None, [&desk]).unwrap();
        let _silent: Vec<_> = (0..door::PLACES * 2)
            .map(|_| std::os::unix::net::UnixStream::connect(&socket).unwrap())
            .collect();
        Peer::connect_within(FAST_PATIENCE / 2, &address, Role::Workstation, None).unwrap();
    }

    /// Everybody gets the same answer, but the run hears of no more than it can take, and is open again soon.
    #[test]
    fn who_tries_again_and_again_fills_no_log_and_locks_nobody_out() {
        let place = tempfile::tempdir().unwrap();
        let address = Address::Unix(place.path().join("rcs.sock"));
        let desk = Desk::new(Role::Workstation, ClockKind::Real);
        let _listener = Listener::start(&address, None, [&desk]).unwrap();
        let started = Instant::now();
        let mut tried = 0_u32;
        while started.elapsed() < door::SAFE * 3 {
            assert!(Peer::connect(&address, Role::DataSystem, None).is_err(), "nobody expects one");
            tried += 1;
        }
        Peer::connect_within(FAST_PATIENCE, &address, Role::Workstation, None).unwrap();
        let heard = std::iter::from_fn(|| desk.news()).filter(|news| matches!(news, News::Refused(_)));
        let heard = u32::try_from(heard.count()).unwrap();
        // A place at the door once in a penalty, and a word about the crowd; time goes on behind the loop as well.
        let most = (started.elapsed().as_secs_f64() / door::SAFE.as_secs_f64()).ceil() as u32 + 1;
        assert!(heard <= most * (door::PLACES as u32 + 1), "{heard} of {tried} in {most} s");
    }
}
