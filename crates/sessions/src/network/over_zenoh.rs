//! Connections between machines through a [Zenoh](https://zenoh.io) network, peer to peer, without a server.
//!
//! Zenoh carries the bytes of a socket pair: at one end a [`Server`] or a [`Peer`](super::Peer) uses TLS, as over TCP;
//! at the other end a thread publishes the bytes. So authentication does not depend on the Zenoh network: routers carry
//! bytes that they cannot decrypt. A client that may publish under the keys of a connection can only break it; Zenoh's
//! own access control keeps other clients out.
//!
//! | key | contents | from |
//! |---|---|---|
//! | `rcs2/t3/open` | a queryable: ID, 32 hexadecimal digits; the reply is the same ID | controller |
//! | `rcs2/t3/ID/up`, `rcs2/t3/ID/down` | bytes to and from the controller; no bytes: the end | neighbour, controller |
//! | `rcs2/t3/ID/neighbour`, `rcs2/t3/ID/controller` | liveliness tokens of a connection | both |
//! | `rcs2/t3/run` | liveliness token of the run: a second run with this name is refused | controller |

use std::{
    fmt::Write as _,
    io::{self, Read as _},
    net::Shutdown,
    os::unix::net::UnixStream,
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use ring::rand::{SecureRandom as _, SystemRandom};
use rustix::net::{SendFlags, send};
use zenoh::{
    Config, Session, Wait as _,
    liveliness::LivelinessToken,
    qos::{CongestionControl, Priority},
    query::Query,
    sample::{Sample, SampleKind},
};

use super::{server::Server, socket::Socket, zenoh_address::ZenohAddress};

/// Time between two attempts to find the controller.
const PAUSE: Duration = Duration::from_millis(50);
/// Time limit of a query.
const QUERY_TIME: Duration = Duration::from_secs(10);
/// Greatest number of queries that wait for an answer.
const WAITING: usize = 64;
/// Time to wait for the last bytes after the end of a liveliness token, which can overtake them.
const GRACE: Duration = Duration::from_millis(500);
/// Longest time that the end of a connection waits until its last bytes are published.
const CLOSING_LIMIT: Duration = Duration::from_secs(2);
/// Length of an ID, bytes.
const ID: usize = 16;
/// Greatest number of bytes that are published at once.
const CHUNK: usize = 16 * 1024;

/// A side of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Controller,
    Neighbour,
}

/// Convert an error of Zenoh, which has only one kind.
fn failed(error: zenoh::Error) -> io::Error {
    io::Error::other(error.to_string())
}

/// Zenoh's configuration: the endpoint of the address, the values of the file, and otherwise defaults for two sides
/// that know each other's address.
fn configuration(address: &ZenohAddress, side: Side) -> Result<Config, zenoh::Error> {
    let mut config = address.configuration().map_or_else(|| Ok(Config::default()), Config::from_file)?;
    let Some(endpoint) = address.endpoint() else { return Ok(config) };
    let (ours, theirs) = match side {
        Side::Controller => ("listen/endpoints", "connect/endpoints"),
        Side::Neighbour => ("connect/endpoints", "listen/endpoints"),
    };
    config.insert_json5(ours, &format!("[\"{endpoint}\"]"))?;
    let usual = Config::default();
    // Scouting is not needed. The controller may start later, or restart: Zenoh's default retry period of
    // one second is too long.
    let retry = "{ period_init_ms: 100, period_max_ms: 1000, period_increase_factor: 2 }";
    let better = [
        (theirs, "[]"),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("connect/retry", retry),
    ];
    for (key, value) in better {
        if config.get_json(key)? == usual.get_json(key)? {
            config.insert_json5(key, value)?;
        }
    }
    Ok(config)
}

fn open(address: &ZenohAddress, side: Side) -> io::Result<Session> {
    configuration(address, side).and_then(|config| zenoh::open(config).wait()).map_err(failed)
}

/// One end of a connection: a thread that publishes the bytes of a socket until it is closed.
struct Carrier {
    thread: JoinHandle<()>,
    _token: LivelinessToken,
}

impl Carrier {
    /// Carry the bytes of a socket pair under the keys `front/ID/...`; returns the socket for the session.
    fn start(session: &Session, front: &str, id: &str, side: Side) -> io::Result<(Self, UnixStream)> {
        let (ours, theirs) = UnixStream::pair()?;
        let (publish, subscribe, own, other) = match side {
            Side::Controller => ("down", "up", "controller", "neighbour"),
            Side::Neighbour => ("up", "down", "neighbour", "controller"),
        };
        let key = |word: &str| format!("{front}/{id}/{word}");
        let socket = ours.try_clone()?;
        let take = move |sample: Sample| deliver(&socket, &sample.payload().to_bytes());
        let subscriber = session.declare_subscriber(key(subscribe)).callback(take).wait().map_err(failed)?;
        let socket = Arc::new(ours.try_clone()?);
        let gone = move |token: Sample| {
            if token.kind() == SampleKind::Delete {
                let socket = Arc::clone(&socket);
                thread::spawn(move || {
                    thread::sleep(GRACE);
                    // It may be closed already.
                    let _ = socket.shutdown(Shutdown::Both);
                });
            }
        };
        let liveliness = session.liveliness();
        let watcher = liveliness.declare_subscriber(key(other)).callback(gone).wait().map_err(failed)?;
        let _token = liveliness.declare_token(key(own)).wait().map_err(failed)?;
        let publisher = session
            .declare_publisher(key(publish))
            .priority(Priority::InteractiveHigh)
            .congestion_control(CongestionControl::Block)
            .express(true)
            .wait()
            .map_err(failed)?;
        let thread = thread::spawn(move || {
            let (mut ours, mut buffer) = (ours, [0; CHUNK]);
            loop {
                let count = ours.read(&mut buffer).unwrap_or(0);
                // No bytes mark the end. If they cannot be published, the other side times out.
                if publisher.put(&buffer[..count]).wait().is_err() || count == 0 {
                    break;
                }
            }
            drop((subscriber, watcher));
        });
        Ok((Self { thread, _token }, theirs))
    }

    /// Wait until the last bytes are published.
    fn finish(self, until: Instant) {
        while !self.thread.is_finished() && Instant::now() < until {
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// Write bytes from the network to the socket. A thread of Zenoh calls this, so that it must not wait for the session.
fn deliver(socket: &UnixStream, bytes: &[u8]) {
    let taken = match bytes {
        [] => Err(rustix::io::Errno::PIPE),
        bytes => send(socket, bytes, SendFlags::DONTWAIT | SendFlags::NOSIGNAL),
    };
    if taken != Ok(bytes.len()) {
        // The end, or the session does not read and the buffer is full. Bytes written before can still be read.
        let _ = socket.shutdown(Shutdown::Write);
    }
}

/// The controller's end: accepts connections until it is dropped.
pub(super) struct Acceptor {
    session: Session,
    ends: SyncSender<Option<Query>>,
    thread: Option<JoinHandle<()>>,
    _run: LivelinessToken,
}

impl Acceptor {
    /// Accept connections for a server.
    ///
    /// # Errors
    /// If the session cannot be opened; [`io::ErrorKind::AddrInUse`] if another run has the name.
    pub fn open(address: &ZenohAddress, server: Arc<Server>) -> io::Result<Self> {
        let session = open(address, Side::Controller)?;
        let front = format!("rcs2/{}", address.name());
        let run = format!("{front}/run");
        let others = session.liveliness().get(&run).wait().map_err(failed)?;
        if others.into_iter().any(|reply| reply.result().is_ok()) {
            return Err(io::ErrorKind::AddrInUse.into());
        }
        let _run = session.liveliness().declare_token(&run).wait().map_err(failed)?;
        let (queries, asked) = sync_channel(WAITING);
        let ends = queries.clone();
        let hear = move |query: Query| {
            // If the queue is full, the query is not answered, and the neighbour asks again.
            let _ = queries.try_send(Some(query));
        };
        session
            .declare_queryable(format!("{front}/open"))
            .callback(hear)
            .background()
            .wait()
            .map_err(failed)?;
        let accepting = session.clone();
        let thread = Some(thread::spawn(move || accept(&accepting, &front, &asked, &server)));
        Ok(Self { session, ends, thread, _run })
    }
}

impl Drop for Acceptor {
    fn drop(&mut self) {
        // This fails only if the thread has ended already.
        let _ = self.ends.send(None);
        if let Some(thread) = self.thread.take() {
            // The thread returns nothing, and a panic in it was reported.
            let _ = thread.join();
        }
        // If the network cannot be reached, the session need not be closed.
        let _ = self.session.close().wait();
    }
}

/// Answer queries until the acceptor is dropped.
fn accept(session: &Session, front: &str, asked: &Receiver<Option<Query>>, server: &Arc<Server>) {
    let mut carriers: Vec<Carrier> = Vec::new();
    loop {
        match asked.recv_timeout(GRACE) {
            Ok(Some(query)) => {
                let said = query.payload().map(|payload| payload.to_bytes().into_owned()).unwrap_or_default();
                let id = str::from_utf8(&said).ok().filter(|id| is_id(id));
                let started = id.map(|id| Carrier::start(session, front, id, Side::Controller));
                if let Some(Ok((carrier, socket))) = started {
                    carriers.push(carrier);
                    server.enter(Socket::Unix(socket));
                    // A neighbour that does not get the answer sends nothing, and its session times out.
                    let _ = query.reply(query.key_expr(), said).wait();
                }
            }
            Err(RecvTimeoutError::Timeout) => carriers.retain(|carrier| !carrier.thread.is_finished()),
            Ok(None) | Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let until = Instant::now() + CLOSING_LIMIT;
    carriers.into_iter().for_each(|carrier| carrier.finish(until));
}

fn is_id(text: &str) -> bool {
    text.len() == ID * 2 && text.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
}

/// The neighbour's end of a connection.
pub(super) struct Tunnel {
    session: Session,
    carrier: Option<Carrier>,
}

impl Tunnel {
    /// Connect to the controller at an address, with retries until `until` if none answers. Returns the tunnel and the
    /// socket whose bytes it carries.
    pub fn open(address: &ZenohAddress, until: Instant) -> io::Result<(Self, UnixStream)> {
        let session = open(address, Side::Neighbour)?;
        let front = format!("rcs2/{}", address.name());
        let mut random = [0; ID];
        SystemRandom::new()
            .fill(&mut random)
            .map_err(|_| io::Error::other("the system has no random bytes"))?;
        let id = random.iter().fold(String::new(), |mut id, byte| {
            // Writing to a `String` does not fail.
            let _ = write!(id, "{byte:02x}");
            id
        });
        let (carrier, socket) = Carrier::start(&session, &front, &id, Side::Neighbour)?;
        let tunnel = Self { session, carrier: Some(carrier) };
        loop {
            let replies =
                tunnel.session.get(format!("{front}/open")).payload(id.as_str()).timeout(QUERY_TIME);
            let replies = replies.wait().map_err(failed)?;
            let mut accepted = replies.into_iter().filter_map(|reply| reply.into_result().ok());
            if accepted.any(|sample| *sample.payload().to_bytes() == *id.as_bytes()) {
                return Ok((tunnel, socket));
            }
            if Instant::now() >= until {
                return Err(io::Error::new(io::ErrorKind::NotFound, "no controller answers"));
            }
            thread::sleep(PAUSE);
        }
    }
}

impl Drop for Tunnel {
    fn drop(&mut self) {
        if let Some(carrier) = self.carrier.take() {
            carrier.finish(Instant::now() + CLOSING_LIMIT);
        }
        // If the network cannot be reached, the session need not be closed.
        let _ = self.session.close().wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_says_which_side_listens() {
        let address: ZenohAddress = "t3@tcp/127.0.0.1:7447".parse().unwrap();
        let asked = |side, key: &str| configuration(&address, side).unwrap().get_json(key).unwrap();
        let place = "[\"tcp/127.0.0.1:7447\"]";
        assert_eq!(asked(Side::Controller, "listen/endpoints"), place);
        assert_eq!(asked(Side::Controller, "connect/endpoints"), "[]");
        assert_eq!(asked(Side::Neighbour, "listen/endpoints"), "[]");
        assert_eq!(asked(Side::Neighbour, "connect/endpoints"), place);
        assert_eq!(asked(Side::Neighbour, "scouting/multicast/enabled"), "false");
        let missing = "t3".parse::<ZenohAddress>().unwrap().configured("no such file".into());
        assert!(configuration(&missing, Side::Neighbour).is_err());
    }

    /// An ID becomes a part of Zenoh keys, so that wildcards and slashes are refused.
    #[test]
    fn an_id_is_32_hexadecimal_digits() {
        assert!(is_id("0123456789abcdef0123456789abcdef"));
        for wrong in
            ["", "**", "0123456789abcdef0123456789abcdeF", "0123456789abcdef0123456789abcde/", "0123"]
        {
            assert!(!is_id(wrong), "{wrong}");
        }
    }

    #[test]
    fn bytes_for_a_session_that_does_not_read_end_it_and_do_not_block() {
        let (ours, mut theirs) = UnixStream::pair().unwrap();
        let chunk = [7; CHUNK];
        (0..1000).for_each(|_| deliver(&ours, &chunk));
        let mut taken = Vec::new();
        theirs.read_to_end(&mut taken).unwrap();
        assert!(taken.len() < 1000 * CHUNK && taken.iter().all(|byte| *byte == 7));
    }
}
