//! The controller accepts connections: one thread waits at a socket, and another one serves each connection.
//!
//! A socket in the file system admits processes of the same user; a TCP port admits neighbours with a certificate
//! ([`keys`](super::keys)). All others are refused with a reason, and the controller gets an event.

use std::{
    fs, io,
    net::TcpListener,
    os::unix::{
        fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _},
        net::{UnixListener, UnixStream},
    },
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use rustix::net::{Shutdown, shutdown};

#[cfg(feature = "zenoh")]
use super::over_zenoh;
use super::{
    Address, ClockKind, Endpoint, KeysError, Operators, keys::ControllerKeys, server::Server, socket::Socket,
};

/// Why no neighbour can connect.
#[derive(Debug, thiserror::Error)]
pub enum ListenError {
    /// The address cannot be used.
    #[error("{address}: {source}")]
    Address {
        /// The address.
        address: Address,
        /// Error of the system.
        source: io::Error,
    },
    /// Another run listens at the address.
    #[error("{0}: another run waits for its neighbours there")]
    InUse(Address),
    /// The keys do not fit the address.
    #[error(transparent)]
    Keys(#[from] KeysError),
    /// This program was built without Zenoh.
    #[cfg(not(feature = "zenoh"))]
    #[error("{0}: {NO_ZENOH}")]
    NoZenoh(Address),
}

/// Message of a program without Zenoh.
#[cfg(not(feature = "zenoh"))]
pub(super) const NO_ZENOH: &str = "this program was built without Zenoh; cargo build --release --workspace --features zenoh \
                                   builds it with Zenoh";

enum Accepting {
    Unix(UnixListener),
    Tcp(TcpListener),
}

/// Accepts connections until it is dropped.
pub struct Listener {
    /// Address at which neighbours can connect; for port 0, with the port that the system has chosen.
    address: Address,
    _line: Line,
}

/// The kind of address it listens at.
enum Line {
    Socket {
        _socket: ListeningSocket,
    },
    #[cfg(feature = "zenoh")]
    Zenoh {
        _acceptor: over_zenoh::Acceptor,
    },
}

/// A socket, and the thread that waits at it.
struct ListeningSocket {
    socket: Arc<Accepting>,
    file: Option<SocketFile>,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// The file of a Unix socket, with its identity: another program may have replaced the file since.
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
            // It may have been removed in the meantime.
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Listener {
    /// Accept connections for endpoints at an address.
    ///
    /// # Errors
    /// [`ListenError`].
    pub fn start<'a>(
        address: &Address,
        keys: Option<ControllerKeys>,
        endpoints: impl IntoIterator<Item = &'a Endpoint>,
    ) -> Result<Self, ListenError> {
        Self::with_operators(address, keys, endpoints, None)
    }

    /// As [`Listener::start`], and for operators as well.
    ///
    /// # Errors
    /// [`ListenError`].
    pub fn with_operators<'a>(
        address: &Address,
        keys: Option<ControllerKeys>,
        endpoints: impl IntoIterator<Item = &'a Endpoint>,
        operators: Option<Operators>,
    ) -> Result<Self, ListenError> {
        KeysError::check(address, keys.is_some())?;
        let handles: Vec<_> = endpoints.into_iter().map(Endpoint::handle).collect();
        // Without endpoints there are only operators, which need the real clock.
        let clock = handles.first().map_or(ClockKind::Real, |handle| handle.clock());
        let server = Arc::new(Server::new(handles, operators, keys, clock));
        let failed = |source| ListenError::Address { address: address.clone(), source };
        let (socket, bound) = match address {
            Address::Unix(path) => (Accepting::Unix(unix(path, address)?), address.clone()),
            Address::Tcp(place) => {
                let listener = TcpListener::bind(place).map_err(failed)?;
                let bound = listener.local_addr().map_err(failed)?;
                (Accepting::Tcp(listener), Address::Tcp(bound))
            }
            #[cfg(not(feature = "zenoh"))]
            Address::Zenoh(_) => return Err(ListenError::NoZenoh(address.clone())),
            #[cfg(feature = "zenoh")]
            Address::Zenoh(zenoh) => {
                let opened = over_zenoh::Acceptor::open(zenoh, server);
                let _acceptor = opened.map_err(|error| match error.kind() {
                    io::ErrorKind::AddrInUse => ListenError::InUse(address.clone()),
                    _ => failed(error),
                })?;
                return Ok(Self { address: address.clone(), _line: Line::Zenoh { _acceptor } });
            }
        };
        let _socket = ListeningSocket::listen(socket, &bound, server).map_err(failed)?;
        Ok(Self { address: bound, _line: Line::Socket { _socket } })
    }

    /// Address at which neighbours can connect.
    #[must_use]
    pub const fn address(&self) -> &Address {
        &self.address
    }
}

impl ListeningSocket {
    fn listen(socket: Accepting, address: &Address, server: Arc<Server>) -> io::Result<Self> {
        let file = match address {
            Address::Unix(path) => Some(SocketFile::at(path)?),
            Address::Tcp(_) | Address::Zenoh(_) => None,
        };
        let (socket, over) = (Arc::new(socket), Arc::new(AtomicBool::new(false)));
        let (accepting, flag) = (Arc::clone(&socket), Arc::clone(&over));
        let thread = Some(thread::spawn(move || accept(&accepting, &flag, &server)));
        Ok(Self { socket, file, over, thread })
    }
}

impl Drop for ListeningSocket {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Release);
        // Wakes the thread that waits for a connection, even if another program uses the address by now.
        let woken = match &*self.socket {
            Accepting::Unix(listener) => shutdown(listener, Shutdown::Both),
            Accepting::Tcp(listener) => shutdown(listener, Shutdown::Both),
        };
        if let Some(thread) = self.thread.take().filter(|_| woken.is_ok()) {
            // The thread returns nothing, and a panic in it was reported.
            let _ = thread.join();
        }
        if let Some(file) = &self.file {
            file.remove();
        }
    }
}

/// Bind a socket in the file system; one that a killed run has left there is replaced.
fn unix(path: &Path, address: &Address) -> Result<UnixListener, ListenError> {
    let failed = |source| ListenError::Address { address: address.clone(), source };
    let listener = match UnixListener::bind(path) {
        Err(error) if error.kind() == io::ErrorKind::AddrInUse => {
            if UnixStream::connect(path).is_ok() {
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

fn accept(socket: &Accepting, over: &AtomicBool, server: &Arc<Server>) {
    while !over.load(Ordering::Acquire) {
        let accepted = match socket {
            Accepting::Unix(listener) => listener.accept().map(|(stream, _)| Socket::Unix(stream)),
            Accepting::Tcp(listener) => listener.accept().map(|(stream, _)| Socket::Tcp(stream)),
        };
        match accepted {
            _ if over.load(Ordering::Acquire) => return,
            Ok(socket) => server.enter(socket),
            // Possibly out of file descriptors: pause, to avoid a busy loop.
            Err(_) => thread::sleep(Duration::from_millis(100)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::network::{
        NetEvent, Peer, Role,
        accept_queue::{SAFE, SLOTS},
        clock::{ClockKind, answer_limit},
    };

    fn endpoint(clock: ClockKind) -> Endpoint {
        Endpoint::new(Role::Workstation, clock).unwrap()
    }

    #[test]
    fn a_socket_that_was_left_behind_is_taken_over_and_no_other_file_is() {
        let place = tempfile::tempdir().unwrap();
        let (socket, file) = (place.path().join("rcs.sock"), place.path().join("notes"));
        let endpoint = endpoint(ClockKind::Real);
        drop(UnixListener::bind(&socket).unwrap());
        let listener = Listener::start(&Address::Unix(socket.clone()), None, [&endpoint]).unwrap();
        let second = Listener::start(&Address::Unix(socket.clone()), None, [&endpoint]);
        assert!(matches!(second, Err(ListenError::InUse(_))));
        drop(listener);
        assert!(!socket.exists());
        fs::write(&file, "not to be lost").unwrap();
        let refused = Listener::start(&Address::Unix(file.clone()), None, [&endpoint]);
        assert!(matches!(refused, Err(ListenError::Address { .. })));
        assert_eq!(fs::read_to_string(file).unwrap(), "not to be lost");
    }

    #[test]
    fn a_listener_whose_path_was_taken_by_another_ends_and_leaves_the_other_alone() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("rcs.sock");
        let endpoint = endpoint(ClockKind::Real);
        let first = Listener::start(&Address::Unix(socket.clone()), None, [&endpoint]).unwrap();
        fs::remove_file(&socket).unwrap();
        let _second = UnixListener::bind(&socket).unwrap();
        drop(first);
        assert!(socket.exists());
    }

    #[test]
    fn clients_that_send_nothing_keep_no_other_out() {
        let place = tempfile::tempdir().unwrap();
        let socket = place.path().join("rcs.sock");
        let address = Address::Unix(socket.clone());
        let endpoint = endpoint(ClockKind::Fast);
        let _listener = Listener::start(&address, None, [&endpoint]).unwrap();
        let _silent: Vec<_> = (0..SLOTS * 2).map(|_| UnixStream::connect(&socket).unwrap()).collect();
        Peer::connect_within(answer_limit(ClockKind::Fast) / 2, &address, Role::Workstation, None).unwrap();
    }

    /// All attempts are refused, the run gets a limited number of events, and another client is admitted soon.
    #[test]
    fn a_client_that_tries_again_and_again_fills_no_log_and_locks_no_other_out() {
        let place = tempfile::tempdir().unwrap();
        let address = Address::Unix(place.path().join("rcs.sock"));
        let endpoint = endpoint(ClockKind::Real);
        let _listener = Listener::start(&address, None, [&endpoint]).unwrap();
        let started = Instant::now();
        let mut tried = 0_u32;
        while started.elapsed() < SAFE * 3 {
            assert!(Peer::connect(&address, Role::DataSystem, None).is_err(), "none is expected");
            tried += 1;
        }
        Peer::connect_within(answer_limit(ClockKind::Fast), &address, Role::Workstation, None).unwrap();
        let events = std::iter::from_fn(|| endpoint.event());
        let told =
            u32::try_from(events.filter(|event| matches!(event, NetEvent::Refused(_))).count()).unwrap();
        // In each interval of `SAFE`: an event for each slot, and one for the full queue. Time passes after the
        // loop as well.
        let most = (started.elapsed().as_secs_f64() / SAFE.as_secs_f64()).ceil() as u32 + 1;
        assert!(told <= most * (SLOTS as u32 + 1), "{told} of {tried} in {most} s");
    }
}
