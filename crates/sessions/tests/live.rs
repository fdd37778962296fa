//! Tests a server and its clients over real sockets: admissions, refusals, and disconnections.

use std::{
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpStream},
    os::unix::net::UnixStream,
    sync::mpsc::channel,
    thread,
    time::{Duration, Instant},
};

use record::{Tap, tap::Channel};
use serde_json::{Value, json};
use sessions::live::{
    Feed, Options, Port, Server,
    commands::{Access, Token},
    server::CLIENTS,
};
use tungstenite::{
    Error, HandshakeError, Message, WebSocket,
    client::IntoClientRequest,
    http::{HeaderValue, header},
    protocol::frame::coding::CloseCode,
};

const STRING: Channel<'static> = Channel {
    topic: "/robot_description",
    encoding: "cdr",
    schema_name: "std_msgs/msg/String",
    schema_encoding: "ros2msg",
    schema: b"string data",
};

fn serve(options: Options) -> (Server, Box<dyn Tap>) {
    let feed = Feed::default();
    let mut tap = feed.tap();
    tap.channel(1, &STRING);
    (Server::start(Port::take(0).unwrap(), options, feed).unwrap(), tap)
}

/// Tries a handshake; returns status and body of a refusal.
fn try_connect(
    address: SocketAddr,
    origin: Option<&str>,
    protocols: &str,
) -> Result<WebSocket<TcpStream>, (u16, String)> {
    let mut request = format!("ws://{address}").into_client_request().unwrap();
    let headers = request.headers_mut();
    if !protocols.is_empty() {
        headers.insert(header::SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_str(protocols).unwrap());
    }
    if let Some(origin) = origin {
        headers.insert(header::ORIGIN, HeaderValue::from_str(origin).unwrap());
    }
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    match tungstenite::client(request, stream) {
        Ok((socket, response)) => {
            let agreed = response.headers()[header::SEC_WEBSOCKET_PROTOCOL].to_str().unwrap().to_owned();
            assert!(protocols.contains(&agreed), "{agreed} was not asked for");
            Ok(socket)
        }
        Err(tungstenite::HandshakeError::Failure(Error::Http(response))) => {
            let body = response.body().clone().unwrap_or_default();
            Err((response.status().as_u16(), String::from_utf8_lossy(&body).into_owned()))
        }
        Err(error) => panic!("{error}"),
    }
}

fn connect(address: SocketAddr) -> WebSocket<TcpStream> {
    let mut socket = try_connect(address, None, "foxglove.sdk.v1").unwrap();
    assert_eq!(text(&mut socket)["op"], "serverInfo");
    assert_eq!(text(&mut socket)["op"], "advertise");
    socket
}

fn next(socket: &mut WebSocket<TcpStream>) -> Result<Message, Error> {
    loop {
        let message = socket.read()?;
        if !message.is_ping() {
            return Ok(message);
        }
    }
}

fn text(socket: &mut WebSocket<TcpStream>) -> Value {
    serde_json::from_str(next(socket).unwrap().to_text().unwrap()).unwrap()
}

fn say(socket: &mut WebSocket<TcpStream>, message: Value) {
    socket.send(Message::text(message.to_string())).unwrap();
}

fn close_code(socket: &mut WebSocket<TcpStream>) -> CloseCode {
    loop {
        match socket.read() {
            Ok(Message::Close(frame)) => return frame.unwrap().code,
            Ok(_) => {}
            Err(error) => panic!("a close was expected: {error}"),
        }
    }
}

#[test]
fn unlisted_pages_get_status_403() {
    let origins = vec!["http://localhost:8080".parse().unwrap()];
    let (server, _tap) = serve(Options { origins, ..Options::default() });
    let with = |origin| try_connect(server.address(), origin, "foxglove.websocket.v1, foxglove.sdk.v1");
    for good in [None, Some("https://app.foxglove.dev"), Some("http://localhost:8080")] {
        assert!(with(good).is_ok(), "{good:?}");
    }
    for foreign in [
        "https://evil.example",
        "http://localhost:8081",
        "http://localhost",
        "https://app.foxglove.dev.evil.example",
        "http://app.foxglove.dev",
        "file://",
        "null",
        "",
    ] {
        let (status, body) = with(Some(foreign)).map(|_| ()).unwrap_err();
        assert_eq!(status, 403, "{foreign}");
        assert!(body.contains("--live-origin"), "{body}");
    }
}

fn answer(address: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn browser_gets_only_the_page() {
    let page = Some("<title>run</title>".to_owned());
    let (server, _tap) = serve(Options { page, ..Options::default() });
    let get = |path: &str, host: &str| {
        answer(server.address(), &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"))
    };
    let page = get("/", "127.0.0.1:8765");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("<title>run</title>"), "{page}");
    for header in ["text/html; charset=utf-8", "frame-ancestors 'none'", "no-store", "nosniff"] {
        assert!(page.contains(header), "{header}: {page}");
    }
    assert!(get("/token", "localhost").starts_with("HTTP/1.1 404 "));
    assert!(get("/", "evil.example").starts_with("HTTP/1.1 421 "), "another name of this machine");
    let post = answer(server.address(), "POST / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    assert!(post.starts_with("HTTP/1.1 405 ") && post.contains("Allow: GET"), "{post}");
    let (other, _tap) = serve(Options::default());
    let none = answer(other.address(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    assert!(none.starts_with("HTTP/1.1 404 ") && none.contains("there is no page here"), "{none}");
}

#[test]
fn only_the_page_of_the_same_port_may_connect() {
    let (server, _tap) = serve(Options::default());
    let port = server.address().port();
    let own = format!("http://127.0.0.1:{port}");
    assert!(try_connect(server.address(), Some(&own), "foxglove.sdk.v1").is_ok());
    for foreign in [format!("http://localhost:{port}"), format!("https://127.0.0.1:{port}"), own + "1"] {
        let refused = try_connect(server.address(), Some(&foreign), "foxglove.sdk.v1").map(|_| ());
        assert_eq!(refused.unwrap_err().0, 403, "{foreign}");
    }
}

/// A WebSocket of a gateway with headers; the status if it is refused.
fn enter(
    socket: &std::path::Path,
    headers: &[(&'static str, &'static str)],
) -> Result<WebSocket<UnixStream>, u16> {
    let mut request = "ws://localhost".into_client_request().unwrap();
    request.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static("foxglove.sdk.v1"));
    for (name, value) in headers {
        request.headers_mut().append(*name, HeaderValue::from_static(value));
    }
    let stream = UnixStream::connect(socket).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    match tungstenite::client(request, stream) {
        Ok((socket, _)) => Ok(socket),
        Err(HandshakeError::Failure(Error::Http(response))) => Err(response.status().as_u16()),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn gateway_names_the_person_and_the_role() {
    let place = tempfile::tempdir().unwrap();
    let socket = place.path().join("live.sock");
    let access = Access { socket: place.path().join("none.sock"), token: Token::random().unwrap() };
    let (mut server, _tap) = serve(Options { access: Some(access), ..Options::default() });
    server.admit_gateway(&socket).unwrap();
    let person = |role| [("rcs-person", "anna"), ("rcs-role", role)];
    for (role, access, name) in [("operator", "granted", "page1.anna"), ("viewer", "none", "page2.anna")] {
        let mut socket = enter(&socket, &person(role)).unwrap();
        let mut ask = || {
            let names = ["/viewer/name", "/operator/access"];
            let ask = json!({ "op": "getParameters", "parameterNames": names, "id": "1" }).to_string();
            socket.send(Message::text(ask)).unwrap();
            loop {
                let text: Value = match socket.read().unwrap() {
                    Message::Text(text) => serde_json::from_str(&text).unwrap(),
                    _ => continue,
                };
                if text["op"] == "parameterValues" {
                    return text["parameters"].clone();
                }
            }
        };
        let expected = json!([
            { "name": "/operator/access", "value": access },
            { "name": "/viewer/name", "value": name },
        ]);
        assert_eq!(ask(), expected);
    }
    assert_eq!(enter(&socket, &[]).map(drop), Err(400), "a gateway names the person");
    assert_eq!(enter(&socket, &person("owner")).map(drop), Err(400));
    // A program that connects to the local port needs the token, even with the headers of a gateway.
    let claims = "GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
                  Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\
                  Sec-WebSocket-Protocol: foxglove.sdk.v1\r\nRcs-Person: anna\r\nRcs-Role: operator\r\n\r\n";
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.write_all(claims.as_bytes()).unwrap();
    // A masked text of a client: the access.
    let ask = br#"{"op":"getParameters","parameterNames":["/operator/access"],"id":"1"}"#;
    stream.write_all(&[&[0x81, 0x80 | ask.len() as u8, 0, 0, 0, 0], &ask[..]].concat()).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    let (mut all, mut part) = (String::new(), [0; 4096]);
    while !all.contains("parameterValues") {
        let count = stream.read(&mut part).unwrap();
        all.push_str(&String::from_utf8_lossy(&part[..count]));
    }
    assert!(all.contains(r#""value":"token""#), "{all}");
    drop(server);
    assert!(!socket.exists());
}

#[test]
fn client_without_a_known_subprotocol_is_refused() {
    let (server, _tap) = serve(Options::default());
    for wrong in ["", "foxglove.websocket.v0", "graphql-ws"] {
        let (status, body) = try_connect(server.address(), None, wrong).map(|_| ()).unwrap_err();
        assert_eq!(status, 400, "{wrong}");
        assert!(body.contains("foxglove.sdk.v1"), "{body}");
    }
}

#[test]
fn one_time_messages_are_sent_to_each_new_subscriber() {
    let (server, mut tap) = serve(Options::default());
    tap.message(1, 5, b"<robot/>");
    for _ in 0..2 {
        let mut socket = connect(server.address());
        say(&mut socket, json!({ "op": "subscribe", "subscriptions": [{ "id": 9, "channelId": 1 }] }));
        let Message::Binary(bytes) = next(&mut socket).unwrap() else { panic!("a message was expected") };
        assert_eq!(&bytes[..], [&[1, 9, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0][..], b"<robot/>"].concat());
    }
    let mut socket = connect(server.address());
    tap.message(1, 300, b"other");
    let Message::Binary(bytes) = next(&mut socket).unwrap() else { panic!("the time was expected") };
    assert_eq!(&bytes[..], [2, 44, 1, 0, 0, 0, 0, 0, 0]);
    drop(tap);
    assert_eq!(close_code(&mut socket), CloseCode::Away);
}

#[test]
fn too_many_wrong_messages_close_the_connection() {
    let (server, _tap) = serve(Options::default());
    let mut socket = connect(server.address());
    for wrong in [Message::text("{"), Message::binary(vec![77, 1, 2]), Message::text("{\"op\":\"fly\"}")] {
        socket.send(wrong).unwrap();
        let status = text(&mut socket);
        assert_eq!((&status["op"], &status["level"]), (&json!("status"), &json!(2)), "{status}");
    }
    for _ in 0..40 {
        // The server may already have closed the connection.
        let _ = socket.send(Message::binary(vec![1]));
    }
    assert_eq!(close_code(&mut socket), CloseCode::Policy);
}

#[test]
fn oversized_messages_and_invalid_frames_close_the_connection() {
    let (server, _tap) = serve(Options::default());
    let mut socket = connect(server.address());
    // The server closes the connection before it has read all of the message.
    let _ = socket.send(Message::text(" ".repeat(70_000)));
    assert_eq!(close_code(&mut socket), CloseCode::Size);
    // Reserved bits and codes, no mask, half a frame, text that is not UTF-8.
    let frames: [&[u8]; 5] = [
        &[0xff; 64],
        &[0x81, 0x02, b'h', b'i'],
        &[0x8f, 0x80, 0, 0, 0, 0],
        &[0x81, 0xff],
        &[0x81, 0x82, 0, 0, 0, 0, 0xff, 0xfe],
    ];
    for frame in frames {
        let socket = connect(server.address());
        let mut stream = socket.into_inner();
        stream.write_all(frame).unwrap();
        stream.shutdown(std::net::Shutdown::Write).unwrap();
        ends(&mut stream);
    }
    connect(server.address());
}

fn ends(stream: &mut TcpStream) {
    let mut rest = Vec::new();
    if let Err(error) = stream.read_to_end(&mut rest) {
        assert_eq!(error.kind(), ErrorKind::ConnectionReset, "{error}");
    }
}

#[test]
fn invalid_handshake_ends_the_connection() {
    let (server, _tap) = serve(Options::default());
    for wrong in [
        "GET / HTTP/1.1\r\n\r\n",
        "POST / HTTP/1.1\r\nUpgrade: websocket\r\n\r\n",
        "\0\u{1}\u{2}\r\n\r\n",
        "x",
    ] {
        let mut stream = TcpStream::connect(server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        stream.write_all(wrong.as_bytes()).unwrap();
        ends(&mut stream);
    }
    let mut endless = TcpStream::connect(server.address()).unwrap();
    let sent = (0..).take(1000).try_for_each(|_| endless.write_all(&[b'a'; 4096]));
    assert!(sent.is_err(), "four megabytes of a handshake were taken");
    connect(server.address());
}

#[test]
fn client_above_the_limit_is_refused() {
    let (server, _tap) = serve(Options::default());
    let mut clients: Vec<_> = (0..CLIENTS).map(|_| connect(server.address())).collect();
    let (status, body) = try_connect(server.address(), None, "foxglove.sdk.v1").map(|_| ()).unwrap_err();
    assert_eq!(status, 503);
    assert!(body.contains("16 viewers are connected"), "{body}");
    clients.pop().unwrap().close(None).unwrap();
    let until = Instant::now() + Duration::from_secs(10);
    while try_connect(server.address(), None, "foxglove.sdk.v1").is_err() {
        assert!(Instant::now() < until, "the place of a client that has left is not free");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn only_clients_that_do_not_read_are_disconnected() {
    let patience = Duration::from_millis(400);
    let (server, mut tap) = serve(Options { patience, ..Options::default() });
    let mut reader = connect(server.address());
    let subscribe = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] });
    say(&mut reader, subscribe.clone());
    let mut silent: Vec<_> = (0..10).map(|_| connect(server.address())).collect();
    // Half of these clients have no subscription.
    silent.iter_mut().skip(5).for_each(|socket| say(socket, subscribe.clone()));
    let reading = thread::spawn(move || {
        let is_message = |message: &Message| message.is_binary() && message.len() > 9;
        std::iter::from_fn(|| next(&mut reader).ok()).filter(is_message).count()
    });
    let message = vec![7; 100_000];
    let begin = Instant::now();
    let mut longest = Duration::ZERO;
    for time in 1..=100 {
        let before = Instant::now();
        tap.message(1, time, &message);
        longest = longest.max(before.elapsed());
        thread::sleep(Duration::from_millis(20));
    }
    let sent = begin.elapsed();
    drop(tap);
    assert_eq!(reading.join().unwrap(), 100, "the client that reads gets all");
    for socket in silent {
        let mut stream = socket.into_inner();
        ends(&mut stream);
    }
    assert!(longest < sent / 2, "a message took {longest:?} to be sent");
}

struct Slow(TcpStream); // a connection that reads at most 100 kB/s

impl Read for Slow {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        thread::sleep(Duration::from_millis(100));
        let length = buffer.len().min(10_000);
        self.0.read(&mut buffer[..length])
    }
}

impl Write for Slow {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}

/// The meshes of a run have 1.1 MB. Without pings between their pieces, the answer arrived after all of them.
#[test]
fn slow_viewer_receives_large_messages_and_stays() {
    let (sender, notices) = channel();
    let patience = Duration::from_secs(1);
    let (server, mut tap) = serve(Options { patience, notices: Some(sender), ..Options::default() });
    let large = vec![7; 400_000];
    tap.message(1, 1, &large);
    let mut request = format!("ws://{}", server.address()).into_client_request().unwrap();
    request.headers_mut().insert(header::SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static("foxglove.sdk.v1"));
    let stream = TcpStream::connect(server.address()).unwrap();
    let (mut socket, _) = tungstenite::client(request, Slow(stream)).unwrap();
    let subscribe = json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] });
    socket.send(Message::text(subscribe.to_string())).unwrap();
    let reading = thread::spawn(move || {
        let mut lengths = Vec::new();
        loop {
            match socket.read().unwrap() {
                Message::Binary(bytes) if bytes.len() > 9 => lengths.push(bytes.len()),
                Message::Close(frame) => return (lengths, frame.unwrap().code),
                _ => {}
            }
        }
    });
    for time in 2..=60 {
        thread::sleep(Duration::from_millis(100));
        tap.message(1, time, &[1; 1000]);
    }
    drop(tap);
    let (lengths, code) = reading.join().unwrap();
    assert_eq!((lengths[0], lengths.len(), code), (13 + large.len(), 60, CloseCode::Away));
    assert_eq!(notices.try_iter().collect::<Vec<_>>(), [""; 0]);
    drop(server);
}

#[test]
fn viewer_that_stops_reading_is_disconnected_with_a_reason() {
    let (sender, notices) = channel();
    let patience = Duration::from_millis(400);
    let (server, mut tap) = serve(Options { patience, notices: Some(sender), ..Options::default() });
    let mut socket = connect(server.address());
    say(&mut socket, json!({ "op": "subscribe", "subscriptions": [{ "id": 1, "channelId": 1 }] }));
    for time in 0..200 {
        tap.message(1, time, &[7; 100_000]);
    }
    let notice = notices.recv_timeout(Duration::from_secs(20)).unwrap();
    assert!(notice.starts_with("viewer-1 is disconnected: the viewer has read nothing for 0."), "{notice}");
    // It reads again.
    let reason = loop {
        match socket.read() {
            Ok(Message::Close(frame)) => break frame.unwrap(),
            Ok(_) => {}
            Err(error) => panic!("a reason was expected: {error}"),
        }
    };
    assert_eq!(reason.code, CloseCode::Policy);
    assert!(reason.reason.contains("has read nothing for"), "{}", reason.reason);
}
