//! A server with an emulated coupler, in real time: for tests, and for a controller and a cell in two programs.

use std::{
    io::{self, ErrorKind, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use couplers::Emulated;
use modbus::{MOST_FRAME_BYTES, mbap};

use crate::clock::{Monotonic, Time};

/// Longest wait for a request before a thread looks at faults and at the end.
const WAIT: Duration = Duration::from_millis(2);
/// Connections that a coupler accepts at a time; it closes further ones. CHOSEN.
pub const MOST_CONNECTIONS: usize = 3;
/// A connection without a byte for this time is closed: its client may have lost its power. CHOSEN.
const IDLE: Duration = Duration::from_secs(10);

#[derive(Debug, thiserror::Error)]
#[error("a station cannot listen at TCP {address}: {source}")]
pub struct StationError {
    address: SocketAddr,
    source: io::Error,
}

impl StationError {
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        self.source.kind()
    }
}

struct Shared {
    coupler: Mutex<Emulated>,
    is_cut: AtomicBool, // the network is down: nothing arrives, and nothing is answered
    /// Number of restarts, changed while the coupler is locked. Connections older than the last restart are closed.
    restarts: AtomicU64,
    stop: AtomicBool,
    traffic: Traffic,
}

#[derive(Debug, Default)]
struct Traffic {
    connections: AtomicUsize, // those that are open
    accepted: AtomicU64,      // all so far
    refused: AtomicU64,
    garbled: AtomicU64, // connections that were closed because of bytes that are not a request
    requests: AtomicU64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clients {
    pub connections: usize,
    pub refused: u64,
    pub garbled: u64,
    pub requests: u64,
}

impl Shared {
    fn coupler(&self) -> MutexGuard<'_, Emulated> {
        // A thread that panicked has left no partial change, because the tables consist of words.
        self.coupler.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A server with an emulated coupler. Dropping it closes all connections.
pub struct Station {
    shared: Arc<Shared>,
    address: SocketAddr,
    thread: Option<JoinHandle<()>>,
}

impl Station {
    /// Listens at `address`; port 0 chooses a free one. Fails if the address cannot be used.
    pub fn open(address: SocketAddr, coupler: Emulated) -> Result<Self, StationError> {
        Self::open_with(address, coupler, || {})
    }

    /// Like [`Self::open`]. Each thread of the server calls `prepare` first, for example to request real-time
    /// scheduling.
    pub fn open_with(address: SocketAddr, coupler: Emulated, prepare: fn()) -> Result<Self, StationError> {
        let failed = |source| StationError { address, source };
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let shared = Arc::new(Shared {
            coupler: Mutex::new(coupler),
            is_cut: AtomicBool::new(false),
            restarts: AtomicU64::new(0),
            stop: AtomicBool::new(false),
            traffic: Traffic::default(),
        });
        let served = Arc::clone(&shared);
        let thread = thread::Builder::new()
            .name("station".into())
            .spawn(move || {
                prepare();
                accept(&listener, &served);
            })
            .map_err(failed)?;
        Ok(Self { shared, address, thread: Some(thread) })
    }

    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// Uses the coupler as it is now: its inputs, outputs and faults.
    pub fn with<T>(&self, action: impl FnOnce(&mut Emulated) -> T) -> T {
        let mut coupler = self.shared.coupler();
        coupler.advance(now());
        action(&mut coupler)
    }

    #[must_use]
    pub fn clients(&self) -> Clients {
        let traffic = &self.shared.traffic;
        Clients {
            connections: traffic.connections.load(Ordering::Relaxed),
            refused: traffic.refused.load(Ordering::Relaxed),
            garbled: traffic.garbled.load(Ordering::Relaxed),
            requests: traffic.requests.load(Ordering::Relaxed),
        }
    }

    /// Cuts or restores the network. Requests sent in between arrive later, unless their connection was reset.
    pub fn cut(&self, is_cut: bool) {
        self.shared.is_cut.store(is_cut, Ordering::Relaxed);
    }

    pub fn restart(&self) {
        self.with(|coupler| {
            coupler.restart();
            self.shared.restarts.fetch_add(1, Ordering::Relaxed);
        });
    }
}

impl Drop for Station {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has already reported it.
            let _ = thread.join();
        }
    }
}

fn now() -> u64 {
    u64::try_from(Monotonic.now().as_nanos()).unwrap_or(u64::MAX)
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    let mut threads: Vec<JoinHandle<()>> = Vec::new();
    while !shared.stop.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((stream, _)) => {
                threads.retain(|thread| !thread.is_finished());
                if threads.len() >= MOST_CONNECTIONS {
                    shared.traffic.refused.fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                let shared = Arc::clone(shared);
                let spawned = thread::Builder::new().name("connection".into()).spawn(move || {
                    shared.traffic.connections.fetch_add(1, Ordering::Relaxed);
                    let ended = serve(stream, &shared);
                    // An error ends the connection, as the coupler would.
                    if ended.is_err_and(|error| error.kind() == ErrorKind::InvalidData) {
                        shared.traffic.garbled.fetch_add(1, Ordering::Relaxed);
                    }
                    shared.traffic.connections.fetch_sub(1, Ordering::Relaxed);
                });
                threads.extend(spawned);
            }
            Err(_) => thread::sleep(WAIT),
        }
    }
    for thread in threads {
        let _ = thread.join();
    }
}

fn serve(mut stream: TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(WAIT))?;
    // A client that reads no answers loses its connection.
    stream.set_write_timeout(Some(IDLE))?;
    let restarts = shared.restarts.load(Ordering::Relaxed);
    let client = shared.traffic.accepted.fetch_add(1, Ordering::Relaxed);
    let (mut received, mut filled) = ([0; MOST_FRAME_BYTES], 0);
    let mut answer = [0; MOST_FRAME_BYTES];
    let mut heard = Monotonic.now();
    while !shared.stop.load(Ordering::Relaxed) && shared.restarts.load(Ordering::Relaxed) == restarts {
        match stream.read(&mut received[filled..]) {
            Ok(0) => return Ok(()),
            Ok(read) => (filled, heard) = (filled + read, Monotonic.now()),
            Err(_) if Monotonic.now().saturating_sub(heard) > IDLE => return Ok(()),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(error) => return Err(error),
        }
        if shared.is_cut.load(Ordering::Relaxed) {
            continue;
        }
        while let Some(frame) = mbap::first_frame(&received[..filled]).map_err(invalid)? {
            let used = frame.len();
            let mut coupler = shared.coupler();
            if shared.restarts.load(Ordering::Relaxed) != restarts {
                return Ok(());
            }
            let length = coupler.answer(now(), client, frame, &mut answer).map_err(invalid)?;
            shared.traffic.requests.fetch_add(1, Ordering::Relaxed);
            drop(coupler);
            stream.write_all(&answer[..length])?;
            received.copy_within(used..filled, 0);
            filled -= used;
        }
    }
    Ok(())
}

fn invalid(error: modbus::Error) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, error)
}
