//! The first request of a connection: a browser requests the page, a viewer a WebSocket.
//!
//! Only `GET /` has a page. Against DNS rebinding, the host name must be one of this machine.

use std::io::{Read, Write};

use tungstenite::{
    Error,
    error::{CapacityError, ProtocolError},
    handshake::{machine::TryParse as _, server::Request},
    http::{HeaderMap, StatusCode, header},
};

const LONGEST: usize = 16 * 1024; // greatest length of a request with its headers, bytes
/// Names of this machine in the header `Host`.
const HERE: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];
/// Headers of every answer. They forbid frames, in which another site could disguise the page.
const HEADERS: &str = "Connection: close\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
                       Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
                       Content-Security-Policy: frame-ancestors 'none'\r\n";

pub type Refusal = (StatusCode, String);

/// A request, and the bytes that followed it.
pub struct First {
    pub request: Request,
    pub rest: Vec<u8>,
}

/// Reads the first request of a connection. The error is a refusal, or `None` if the connection has ended.
pub fn read(stream: &mut impl Read) -> Result<First, Option<Refusal>> {
    let mut bytes = Vec::new();
    let mut part = [0; 4096];
    loop {
        let length = stream.read(&mut part).map_err(|_| None)?;
        let read = part.get(..length).filter(|read| !read.is_empty()).ok_or(None)?;
        bytes.extend_from_slice(read);
        if bytes.len() > LONGEST {
            return Err(Some(too_large()));
        }
        if let Some((length, request)) = Request::try_parse(&bytes).map_err(|error| Some(refused(&error)))? {
            let rest = bytes.split_off(length);
            return Ok(First { request, rest });
        }
    }
}

fn too_large() -> Refusal {
    let why = format!("a request of at most {LONGEST} bytes and 124 headers was expected\n");
    (StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, why)
}

fn refused(error: &Error) -> Refusal {
    match error {
        Error::Protocol(ProtocolError::WrongHttpMethod) => {
            (StatusCode::METHOD_NOT_ALLOWED, "only GET is answered\n".to_owned())
        }
        Error::Capacity(CapacityError::TooManyHeaders) => too_large(),
        error => (StatusCode::BAD_REQUEST, format!("a request of HTTP 1.1 was expected: {error}\n")),
    }
}

/// Returns true if a request asks for a WebSocket.
pub fn is_upgrade(headers: &HeaderMap) -> bool {
    headers.contains_key(header::UPGRADE)
}

/// Checks a request for the page. The error is a refusal: another address, or a host that is not this machine.
pub fn check(request: &Request, has_page: bool) -> Result<(), Refusal> {
    if host(request.headers()).is_none() {
        let why = "this page has the name 127.0.0.1 or localhost: open it under one of them\n";
        return Err((StatusCode::MISDIRECTED_REQUEST, why.to_owned()));
    }
    match request.uri().path() {
        "/" if has_page => Ok(()),
        "/" => {
            let why = "there is no page here; a viewer of Foxglove's protocol connects by WebSocket\n";
            Err((StatusCode::NOT_FOUND, why.to_owned()))
        }
        _ => Err((StatusCode::NOT_FOUND, "only the address / has a page\n".to_owned())),
    }
}

/// The header `Host` of a request, if it names this machine. Any port is valid, because a tunnel may use another one.
pub fn host(headers: &HeaderMap) -> Option<&str> {
    let host = headers.get(header::HOST)?.to_str().ok()?;
    let name = match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => name,
        _ => host,
    };
    HERE.iter().any(|here| here.eq_ignore_ascii_case(name)).then_some(host)
}

/// Answers with the page. The time limits of `stream` limit the wait for a client that does not read.
pub fn send_page(stream: &mut impl Write, page: &str) {
    send(stream, StatusCode::OK, "text/html; charset=utf-8", "", page);
}

pub fn send_refusal(stream: &mut impl Write, (status, why): &Refusal) {
    let allow = if *status == StatusCode::METHOD_NOT_ALLOWED { "Allow: GET\r\n" } else { "" };
    send(stream, *status, "text/plain; charset=utf-8", allow, why);
}

fn send(stream: &mut impl Write, status: StatusCode, kind: &str, extra: &str, body: &str) {
    // The answer is sent in one piece, because some clients read a refusal's body only if it arrives with the head.
    let answer = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n{extra}{HEADERS}\r\n{body}",
        body.len()
    );
    let _ = stream.write_all(answer.as_bytes());
    let _ = stream.flush();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(text: &str) -> Result<Request, Option<Refusal>> {
        read(&mut text.as_bytes()).map(|first| first.request)
    }

    fn status(text: &str) -> Option<u16> {
        let refusal = request(text).and_then(|request| check(&request, true).map_err(Some)).err()?;
        refusal.map(|(status, _)| status.as_u16())
    }

    #[test]
    fn only_the_page_of_this_machine_is_served() {
        let get = |path: &str, host: &str| format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n");
        for good in ["127.0.0.1:8765", "localhost:9000", "LOCALHOST", "[::1]:80", "[::1]"] {
            assert_eq!(status(&get("/", good)), None, "{good}");
            assert_eq!(status(&get("/?x=1", good)), None, "{good}");
        }
        for foreign in
            ["evil.example:8765", "127.0.0.1.evil.example", "localhost.evil.example", "", "10.0.0.1"]
        {
            assert_eq!(status(&get("/", foreign)), Some(421), "{foreign}");
        }
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), Some(421));
        assert_eq!(status(&get("/favicon.ico", "localhost")), Some(404));
        assert_eq!(status("POST / HTTP/1.1\r\nHost: localhost\r\n\r\n"), Some(405));
        assert_eq!(status("\0\u{1}\r\n\r\n"), Some(400));
    }

    #[test]
    fn requests_are_bounded() {
        assert_eq!(status(&format!("GET /{} HTTP/1.1\r\n", "a".repeat(LONGEST))), Some(431));
        let headers: String = (0..200).map(|number| format!("a{number}: b\r\n")).collect();
        assert_eq!(status(&format!("GET / HTTP/1.1\r\n{headers}\r\n")), Some(431));
        assert!(matches!(request("GET / HTTP/1.1\r\n"), Err(None)), "the client has disconnected");
    }

    #[test]
    fn bytes_after_a_request_are_kept() {
        let first = read(&mut &b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\nrest"[..]).ok().unwrap();
        assert_eq!(first.rest, b"rest");
    }
}
