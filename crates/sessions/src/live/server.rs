//! A server on this machine for viewers.

use std::{
    io,
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    os::unix::net::UnixStream,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use sockets::{Acceptor, check_user};
use tungstenite::{
    Error, WebSocket,
    handshake::server::{Request, Response, create_response, write_response},
    http::{HeaderMap, HeaderValue, StatusCode, header},
    protocol::{Role, WebSocketConfig},
};

use crate::live::{
    client::Client,
    connection::{Connection, Stream},
    feed::Feed,
    http::{self, First, Refusal},
    options::{self, Options},
    origin::Origin,
    person::Person,
    protocol::SUBPROTOCOLS,
};

pub const PORT: u16 = 8765;
pub const CLIENTS: usize = 16;
pub const MESSAGE: usize = 64 * 1024; // greatest length of a client's message, bytes
const HANDSHAKE: Duration = Duration::from_secs(3);
const LAST: Duration = Duration::from_secs(2); // time at the end during which clients can still read
const AGAIN: Duration = Duration::from_millis(100); // pause after a connection that could not be accepted

/// A bound port on 127.0.0.1. Clients that connect wait for the start of a [`Server`].
#[derive(Debug)]
pub struct Port(TcpListener);

impl Port {
    /// Binds a port; 0 chooses a free one. Fails with the error of the operating system if the port is not available.
    pub fn take(port: u16) -> io::Result<Self> {
        TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map(Self)
    }
}

/// Serves a feed until it is dropped. Clients can then read the rest for at most two seconds.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    admission: Admission,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    gateway: Option<Acceptor>,
}

impl Server {
    /// The threads inherit the priority of the caller. Fails if the thread cannot start.
    pub fn start(port: Port, mut options: Options, feed: Feed) -> io::Result<Self> {
        let info = &mut options.info;
        info.capabilities.push("time");
        if options.knob.is_some() {
            info.capabilities.extend(["parameters", "parametersSubscribe"]);
        }
        if options.access.is_some() {
            info.capabilities.push("services");
            info.supported_encodings.push("json");
        }
        let Port(listener) = port;
        let address = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        let admission =
            Admission { options: Arc::new(options), feed, open: Arc::default(), viewers: Arc::default() };
        let accept = Accept { listener, admission: admission.clone(), stop: stop.clone() };
        let thread = thread::Builder::new().name("live".into()).spawn(move || accept.run())?;
        Ok(Self { address, admission, stop, thread: Some(thread), gateway: None })
    }

    /// Also serves persons whose connections a gateway of this user makes at a Unix socket.
    pub fn admit_gateway(&mut self, path: &Path) -> io::Result<()> {
        let admission = self.admission.clone();
        self.gateway = Some(Acceptor::start(path, "live gateway", move |stream| admission.enter(stream))?);
        Ok(())
    }

    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.gateway = None;
        self.admission.feed.finish();
        self.stop.store(true, Ordering::Relaxed);
        // The thread checks `stop` at the next connection.
        if TcpStream::connect(self.address).is_ok() {
            let _ = self.thread.take().map(JoinHandle::join);
        }
        let until = Instant::now() + LAST;
        while self.admission.open.load(Ordering::Acquire) > 0 && Instant::now() < until {
            thread::sleep(Duration::from_millis(5));
        }
    }
}

struct Accept {
    listener: TcpListener,
    admission: Admission,
    stop: Arc<AtomicBool>,
}

impl Accept {
    fn run(self) {
        loop {
            let accepted = self.listener.accept();
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            match accepted {
                Ok((stream, _)) => self.admission.admit(Stream::Local(stream)),
                // The client has disconnected, or no more files can be opened. The server continues in both cases.
                Err(_) => thread::sleep(AGAIN),
            }
        }
    }
}

/// Opens a thread for each client, up to a limit.
#[derive(Clone, Debug)]
struct Admission {
    options: Arc<Options>,
    feed: Feed,
    open: Arc<AtomicUsize>,
    viewers: Arc<AtomicU64>, // number of viewers so far, without requests for the page
}

impl Admission {
    /// Admits a gateway of this user; a gateway of another user gets no answer.
    fn enter(&self, stream: UnixStream) {
        if check_user(&stream).is_ok() {
            self.admit(Stream::Gateway(stream));
        }
    }

    fn admit(&self, stream: Stream) {
        if self.open.load(Ordering::Acquire) >= CLIENTS {
            return refuse(stream);
        }
        self.open.fetch_add(1, Ordering::AcqRel);
        let (options, feed, open) = (self.options.clone(), self.feed.clone(), Open(self.open.clone()));
        let viewers = self.viewers.clone();
        // If the thread cannot start, the connection is closed.
        let _ = thread::Builder::new().name("live client".into()).spawn(move || {
            let _open = open;
            serve(stream, &options, feed, &viewers);
        });
    }
}

struct Open(Arc<AtomicUsize>);

impl Drop for Open {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::AcqRel);
    }
}

fn refuse(mut stream: Stream) {
    let why = format!("{CLIENTS} viewers are connected: close one first\n");
    // The answer is small and usually fits into the socket. Otherwise the client gets none.
    if stream.set_nonblocking().is_ok() {
        http::send_refusal(&mut stream, &(StatusCode::SERVICE_UNAVAILABLE, why));
    }
}

fn serve(stream: Stream, options: &Options, feed: Feed, viewers: &AtomicU64) {
    let is_gateway = matches!(stream, Stream::Gateway(_));
    let Ok(mut connection) = Connection::new(stream, HANDSHAKE) else { return };
    let First { request, rest } = match http::read(&mut connection) {
        Ok(first) => first,
        Err(Some(refusal)) => return http::send_refusal(&mut connection, &refusal),
        Err(None) => return,
    };
    if !http::is_upgrade(request.headers()) {
        let page = options.page.as_deref();
        return match http::check(&request, page.is_some()) {
            Ok(()) => http::send_page(&mut connection, page.unwrap_or_default()),
            Err(refusal) => http::send_refusal(&mut connection, &refusal),
        };
    }
    let person = is_gateway.then(|| Person::of(request.headers())).transpose();
    let shaken = person.and_then(|person| Ok((person, shake_hands(&request, &options.origins)?)));
    let (person, response) = match shaken {
        Ok(shaken) => shaken,
        Err(refusal) => return http::send_refusal(&mut connection, &refusal),
    };
    if write_response(&mut connection, &response).is_err() {
        return;
    }
    let limits = WebSocketConfig::default()
        .read_buffer_size(16 * 1024)
        .max_message_size(Some(MESSAGE))
        .max_frame_size(Some(MESSAGE));
    let socket = WebSocket::from_partially_read(connection, rest, Role::Server, Some(limits));
    let number = viewers.fetch_add(1, Ordering::Relaxed).saturating_add(1);
    let requests = options.requests(person.as_ref());
    let Some(name) = options::name(number, person) else { return };
    let (queue, channels) = feed.join();
    Client::new(socket, feed, queue, options, name, requests).run(vec![options.info.encode(), channels]);
}

/// Checks the origin of a client, and chooses the subprotocol.
fn shake_hands(request: &Request, origins: &[Origin]) -> Result<Response, Refusal> {
    check_origin(request.headers(), origins)?;
    let subprotocol = agree(request.headers())?;
    let wrong = |error: Error| (StatusCode::BAD_REQUEST, format!("{error}\n"));
    let mut response = create_response(request).map_err(wrong)?;
    response.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(subprotocol));
    Ok(response)
}

/// Checks the origin header: pages in a browser always send one, programs do not. The page of this server may connect.
fn check_origin(headers: &HeaderMap, origins: &[Origin]) -> Result<(), Refusal> {
    let foxglove = Origin::foxglove();
    let own = http::host(headers).and_then(|host| format!("http://{host}").parse::<Origin>().ok());
    let is_allowed = |origin: &&HeaderValue| {
        origins.iter().chain([&foxglove]).chain(&own).any(|known| known.is(origin.as_bytes()))
    };
    match headers.get_all(header::ORIGIN).iter().find(|origin| !is_allowed(origin)) {
        None => Ok(()),
        Some(origin) => {
            let origin = origin.to_str().unwrap_or("bytes that are not text");
            let why = format!(
                "pages of {origin} may not connect; to allow them, start with --live-origin ORIGIN\n"
            );
            Err((StatusCode::FORBIDDEN, why))
        }
    }
}

fn agree(headers: &HeaderMap) -> Result<&'static str, Refusal> {
    let asked = headers.get_all(header::SEC_WEBSOCKET_PROTOCOL).iter();
    let asked: Vec<&str> =
        asked.filter_map(|text| text.to_str().ok()).flat_map(|text| text.split(',')).map(str::trim).collect();
    SUBPROTOCOLS.into_iter().find(|known| asked.contains(known)).ok_or_else(|| {
        let why = format!("one of the subprotocols {} was expected\n", SUBPROTOCOLS.join(", "));
        (StatusCode::BAD_REQUEST, why)
    })
}
