//! A browser on the network of the cell: requests and WebSockets by TLS, with or without a login.

use std::{
    io::{self, Read as _, Write as _},
    net::{Ipv4Addr, SocketAddr, TcpStream},
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use rustix::net::{AddressFamily, SocketFlags, SocketType, bind, connect, socket_with};
use rustls::{
    ClientConfig, ClientConnection, RootCertStore, StreamOwned,
    crypto::ring,
    pki_types::{CertificateDer, ServerName, pem::PemObject as _},
};
use serde_json::{Value, json};
use tungstenite::{
    Error, HandshakeError, Message, WebSocket, client::IntoClientRequest as _, http::HeaderValue,
};

use crate::shop::TIME_LIMIT;

pub const HERE: Ipv4Addr = Ipv4Addr::LOCALHOST;
const REQUEST: u32 = 9; // the service that takes any line of an operator

pub type Stream = StreamOwned<ClientConnection, TcpStream>;

pub struct Browser {
    config: Arc<ClientConfig>,
    pub port: u16,    // where it connects, which may be a line that can be cut
    pub host: String, // host and port of the page
    from: Ipv4Addr,
    pub cookie: String,
}

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Browser {
    pub fn new(keys: &Path, port: u16) -> Self {
        Self::from(keys, port, HERE)
    }

    pub fn from(keys: &Path, port: u16, from: Ipv4Addr) -> Self {
        let mut roots = RootCertStore::empty();
        roots.add(CertificateDer::from_pem_file(keys.join("ca.pem")).unwrap()).unwrap();
        let builder = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()));
        let builder = builder.with_safe_default_protocol_versions().unwrap();
        let config = Arc::new(builder.with_root_certificates(roots).with_no_client_auth());
        Self { config, port, host: format!("127.0.0.1:{port}"), from, cookie: String::new() }
    }

    pub fn tls(&self) -> io::Result<Stream> {
        let tcp = tcp(self.from, self.port)?;
        let name = ServerName::try_from("127.0.0.1").unwrap();
        let session = ClientConnection::new(Arc::clone(&self.config), name).unwrap();
        Ok(StreamOwned::new(session, tcp))
    }

    pub fn exchange(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.tls().unwrap();
        stream.write_all(bytes).unwrap();
        let mut text = Vec::new();
        // A gateway that refuses may end before it has read everything.
        let _ = stream.read_to_end(&mut text);
        let text = String::from_utf8_lossy(&text).into_owned();
        let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
        Answer { status, head: head.to_owned(), body: body.to_owned() }
    }

    fn headers(&self) -> String {
        let cookie = if self.cookie.is_empty() {
            String::new()
        } else {
            format!("Cookie: theme=dark; __Host-rcs={}\r\n", self.cookie)
        };
        format!("Host: {}\r\n{cookie}", self.host)
    }

    pub fn get(&self, path: &str) -> Answer {
        self.exchange(format!("GET {path} HTTP/1.1\r\n{}\r\n", self.headers()).as_bytes())
    }

    pub fn post(&self, path: &str, origin: &str, form: &str) -> Answer {
        let (headers, length) = (self.headers(), form.len());
        let head =
            format!("POST {path} HTTP/1.1\r\n{headers}Origin: {origin}\r\nContent-Length: {length}\r\n\r\n");
        self.exchange((head + form).as_bytes())
    }

    pub fn origin(&self) -> String {
        format!("https://{}", self.host)
    }

    /// Tries to log in; the cookie is kept.
    pub fn log_in(&mut self, name: &str, secret: &str) -> Answer {
        let answer = self.post("/login", &self.origin(), &format!("name={name}&secret={secret}"));
        if let Some((_, cookie)) = answer.head.split_once("Set-Cookie: __Host-rcs=") {
            cookie.split(';').next().unwrap().clone_into(&mut self.cookie);
        }
        answer
    }

    /// A WebSocket with headers, among them its origin; the status if it is refused.
    pub fn upgrade(&self, headers: &[(&'static str, &str)]) -> Result<Live, u16> {
        let mut request = format!("wss://{}/", self.host).into_client_request().unwrap();
        let mut own = vec![("sec-websocket-protocol", "foxglove.sdk.v1".to_owned())];
        if !self.cookie.is_empty() {
            own.push(("cookie", format!("__Host-rcs={}", self.cookie)));
        }
        own.extend(headers.iter().map(|(name, value)| (*name, (*value).to_owned())));
        for (name, value) in own {
            request.headers_mut().append(name, HeaderValue::from_str(&value).unwrap());
        }
        match tungstenite::client(request, self.tls().unwrap()) {
            Ok((socket, _)) => Ok(Live { socket, call: 0 }),
            Err(HandshakeError::Failure(Error::Http(response))) => Err(response.status().as_u16()),
            Err(error) => panic!("{error}"),
        }
    }

    pub fn live(&self) -> Result<Live, u16> {
        self.upgrade(&[("origin", &self.origin())])
    }
}

pub fn tcp(from: Ipv4Addr, port: u16) -> io::Result<TcpStream> {
    let socket = socket_with(AddressFamily::INET, SocketType::STREAM, SocketFlags::CLOEXEC, None)?;
    bind(&socket, &SocketAddr::from((from, 0)))?;
    connect(&socket, &SocketAddr::from((HERE, port)))?;
    let stream = TcpStream::from(socket);
    stream.set_read_timeout(Some(TIME_LIMIT))?;
    Ok(stream)
}

#[derive(Debug)]
pub struct Live {
    pub socket: WebSocket<Stream>,
    call: u32,
}

impl Live {
    /// The next text for which `wanted` returns a value; the error if the connection ends before.
    pub fn next<T>(&mut self, mut wanted: impl FnMut(&Message) -> Option<T>) -> Result<T, Error> {
        loop {
            if let Some(found) = wanted(&self.socket.read()?) {
                return Ok(found);
            }
        }
    }

    fn text<T>(&mut self, wanted: impl Fn(&Value) -> Option<T>) -> Result<T, Error> {
        self.next(|message| match message {
            Message::Text(text) => wanted(&serde_json::from_str(text).unwrap()),
            _ => None,
        })
    }

    pub fn say(&mut self, message: &Value) {
        self.socket.send(Message::text(message.to_string())).unwrap();
    }

    pub fn parameter(&mut self, name: &str) -> Value {
        self.say(&json!({ "op": "getParameters", "parameterNames": [name], "id": name }));
        let values = self.text(|text| (text["op"] == "parameterValues").then(|| text["parameters"].clone()));
        values.unwrap()[0]["value"].clone()
    }

    pub fn refusal(&mut self, message: &Value) -> String {
        self.say(message);
        let status =
            |text: &Value| (text["op"] == "status" && text["level"] == 2).then(|| text["message"].clone());
        self.text(status).unwrap().as_str().unwrap().to_owned()
    }

    /// Sends a line as an operator; the answer, or the refusal.
    pub fn ask(&mut self, line: &str) -> Result<String, String> {
        self.call += 1;
        let call = self.call;
        let head = [2].into_iter().chain(REQUEST.to_le_bytes()).chain(call.to_le_bytes());
        let payload = json!({ "line": line }).to_string();
        let bytes = head.chain(4_u32.to_le_bytes()).chain(*b"json").chain(payload.into_bytes());
        self.socket.send(Message::binary(bytes.collect::<Vec<u8>>())).unwrap();
        let answer = self.next(|message| match message {
            Message::Binary(bytes) if bytes[0] == 3 && bytes[5..9] == call.to_le_bytes() => {
                let answer: Value = serde_json::from_slice(&bytes[17..]).unwrap();
                Some(Ok(answer["answer"].as_str().unwrap().to_owned()))
            }
            Message::Text(text) => {
                let text: Value = serde_json::from_str(text).unwrap();
                (text["op"] == "serviceCallFailure")
                    .then(|| Err(text["message"].as_str().unwrap().to_owned()))
            }
            _ => None,
        });
        answer.unwrap()
    }

    /// Reads for a time, which also answers pings.
    pub fn watch(&mut self, time: Duration) {
        let start = Instant::now();
        while start.elapsed() < time {
            self.socket.read().unwrap();
        }
    }

    /// Returns true if the run continues to send its time, in each tick, on this connection.
    pub fn sees_run(&mut self) -> bool {
        let is_time = |message: &Message| matches!(message, Message::Binary(bytes) if bytes[0] == 2);
        (0..5).all(|_| self.next(|message| is_time(message).then_some(())).is_ok())
    }

    /// Reads until the connection ends. Returns false if it stays.
    pub fn ends(&mut self) -> bool {
        let start = Instant::now();
        while start.elapsed() < TIME_LIMIT {
            match self.socket.read() {
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => return false,
                Err(_) => return true,
            }
        }
        false
    }
}
