//! The request of a connection, and answers of the gateway. A connection has one request.

use std::{io, time::Instant};

use crate::page::tls::Tls;

const HEAD: usize = 16 * 1024; // greatest length of a request with its headers, and of a form, bytes
const FORM: usize = 1024;
const HEADERS: usize = 64;
/// The cookie of a login. Browsers accept this prefix only from the same host, by TLS, for all paths.
const COOKIE: &str = "__Host-rcs";
/// Headers of every answer. The login page has no script, and is shown in no frame.
const COMMON: &str = "Connection: close\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
                      Referrer-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n\
                      Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'; form-action 'self'; \
                      base-uri 'none'; frame-ancestors 'none'\r\n";

pub type Refusal = (&'static str, String);

pub const BAD: &str = "400 Bad Request";

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Request {
    pub is_post: bool,
    pub path: String,
    pub host: String,
    pub origin: Option<String>,
    pub cookie: Option<String>, // identifier of a login
    pub form: Vec<u8>,
    pub upgrade: Option<String>, // headers of a WebSocket, as the run gets them; `None` for a page
    pub rest: Vec<u8>,           // bytes after the request
}

/// Reads a request, at most until a time. The error is a refusal, or that of the connection.
pub fn read(tls: &mut Tls, until: Instant) -> io::Result<Result<Request, Refusal>> {
    let (mut bytes, mut part) = (Vec::new(), [0; 4096]);
    loop {
        let count = tls.receive_until(&mut part, until)?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes.extend_from_slice(part.get(..count).unwrap_or_default());
        match parse(&bytes) {
            Ok(Some(request)) => return Ok(Ok(request)),
            Ok(None) if bytes.len() > HEAD + FORM => return Ok(Err(too_large())),
            Ok(None) => {}
            Err(refusal) => return Ok(Err(refusal)),
        }
    }
}

fn too_large() -> Refusal {
    let why = format!("a request of at most {HEAD} bytes and {HEADERS} headers was expected");
    ("431 Request Header Fields Too Large", why)
}

/// The request at the start of the bytes; `None` if it is incomplete.
fn parse(bytes: &[u8]) -> Result<Option<Request>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut head = httparse::Request::new(&mut headers);
    let length = match head.parse(bytes) {
        Ok(httparse::Status::Complete(length)) if length <= HEAD => length,
        Ok(httparse::Status::Partial) if bytes.len() <= HEAD => return Ok(None),
        Ok(_) | Err(httparse::Error::TooManyHeaders) => return Err(too_large()),
        Err(error) => return Err((BAD, format!("a request of HTTP 1.1 was expected: {error}"))),
    };
    let is_post = match head.method {
        Some("GET") => false,
        Some("POST") => true,
        _ => return Err(("405 Method Not Allowed", "only GET and POST are answered".to_owned())),
    };
    let one = |name: &str| one(head.headers, name);
    let form_length = match one("Content-Length")? {
        Some(text) => text.parse().map_err(|_| (BAD, "a length was expected".to_owned()))?,
        None => 0,
    };
    if form_length > FORM || one("Transfer-Encoding")?.is_some() {
        return Err(("413 Content Too Large", format!("a form of at most {FORM} bytes was expected")));
    }
    let Some(form) = bytes.get(length..length + form_length) else { return Ok(None) };
    let cookies = head.headers.iter().filter(|header| header.name.eq_ignore_ascii_case("Cookie"));
    let cookie = cookies.filter_map(|header| std::str::from_utf8(header.value).ok()).find_map(login_of);
    let target = head.path.unwrap_or_default();
    Ok(Some(Request {
        is_post,
        path: target.split('?').next().unwrap_or_default().to_owned(),
        host: one("Host")?.unwrap_or_default().to_owned(),
        origin: one("Origin")?.map(str::to_owned),
        cookie: cookie.map(str::to_owned),
        form: form.to_vec(),
        upgrade: one("Upgrade")?.map(|_| upgrade(head.headers)).transpose()?,
        rest: bytes.get(length + form_length..).unwrap_or_default().to_vec(),
    }))
}

fn one<'a>(headers: &[httparse::Header<'a>], name: &str) -> Result<Option<&'a str>, Refusal> {
    let mut found = headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
    let first = found.next().map(|header| std::str::from_utf8(header.value).map(str::trim));
    match (first, found.next()) {
        (None, _) => Ok(None),
        (Some(Ok(value)), None) => Ok(Some(value)),
        _ => Err((BAD, format!("one header {name} was expected"))),
    }
}

/// The identifier of a login in a header `Cookie`.
fn login_of(cookies: &str) -> Option<&str> {
    let pairs = cookies.split(';').filter_map(|pair| pair.trim().split_once('='));
    pairs.into_iter().find_map(|(name, value)| (name == COOKIE).then_some(value))
}

/// The headers of a WebSocket that the run needs, and no others.
fn upgrade(headers: &[httparse::Header<'_>]) -> Result<String, Refusal> {
    let mut text = "Upgrade: websocket\r\nConnection: Upgrade\r\n".to_owned();
    for name in ["Sec-WebSocket-Key", "Sec-WebSocket-Version", "Sec-WebSocket-Protocol"] {
        if let Some(value) = one(headers, name)? {
            text += &format!("{name}: {value}\r\n");
        }
    }
    Ok(text)
}

#[must_use]
pub fn answer(status: &str, extra: &str, body: &str) -> Vec<u8> {
    let length = body.len();
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {length}\r\n\
         {extra}{COMMON}\r\n{body}"
    )
    .into_bytes()
}

/// A redirection to another address, with a new cookie.
#[must_use]
pub fn see(address: &str, login: Option<(&str, u64)>) -> Vec<u8> {
    let cookie = login.map_or_else(String::new, |(id, seconds)| {
        format!("Set-Cookie: {COOKIE}={id}; Path=/; Max-Age={seconds}; HttpOnly; Secure; SameSite=Strict\r\n")
    });
    answer("303 See Other", &format!("Location: {address}\r\n{cookie}"), "")
}

/// The value of a field of a form, as browsers encode it.
#[must_use]
pub fn field(form: &[u8], name: &str) -> Option<String> {
    let form = std::str::from_utf8(form).ok()?;
    let (_, value) =
        form.split('&').filter_map(|pair| pair.split_once('=')).find(|(found, _)| *found == name)?;
    let (mut decoded, mut bytes) = (Vec::new(), value.bytes());
    while let Some(byte) = bytes.next() {
        decoded.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digits = [bytes.next()?, bytes.next()?];
                u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?
            }
            other => other,
        });
    }
    String::from_utf8(decoded).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Option<Request>, &'static str> {
        parse(text.as_bytes()).map_err(|(status, _)| status)
    }

    #[test]
    fn request_has_path_cookie_and_form() {
        let text = "POST /login?x=/../ HTTP/1.1\r\nHost: 10.0.0.1:8443\r\nOrigin: https://10.0.0.1:8443\r\n\
                    Cookie: a=b; __Host-rcs=0123\r\nContent-Length: 6\r\n\r\nname=arest";
        let request = parsed(text).unwrap().unwrap();
        assert_eq!((request.is_post, &*request.path, &*request.host), (true, "/login", "10.0.0.1:8443"));
        assert_eq!(request.cookie.as_deref(), Some("0123"));
        assert_eq!((&*request.form, &*request.rest), (&b"name=a"[..], &b"rest"[..]));
        assert_eq!(request.upgrade, None);
        for end in 0..text.len() - 4 {
            assert_eq!(parsed(&text[..end]), Ok(None), "{end}");
        }
    }

    #[test]
    fn only_headers_of_a_websocket_reach_the_run() {
        let text = "GET / HTTP/1.1\r\nHost: h\r\nUpgrade: websocket\r\nSec-WebSocket-Key: k\r\n\
                    Sec-WebSocket-Extensions: permessage-deflate\r\nRcs-Role: operator\r\n\
                    Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";
        let upgrade = parsed(text).unwrap().unwrap().upgrade.unwrap();
        assert_eq!(
            upgrade,
            "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: k\r\n\
             Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n"
        );
    }

    #[test]
    fn invalid_and_large_requests_are_refused() {
        let with = |headers: &str| parsed(&format!("POST /login HTTP/1.1\r\n{headers}\r\n"));
        assert_eq!(with("Content-Length: 1025\r\n"), Err("413 Content Too Large"));
        assert_eq!(with("Transfer-Encoding: chunked\r\n"), Err("413 Content Too Large"));
        assert_eq!(with("Content-Length: -1\r\n"), Err(BAD));
        assert_eq!(with("Host: a\r\nHost: b\r\n"), Err(BAD));
        assert_eq!(with("Host: \u{1}\r\n"), Err(BAD));
        assert_eq!(with(&"a: b\r\n".repeat(65)), Err("431 Request Header Fields Too Large"));
        assert_eq!(with(&format!("a: {}\r\n", "b".repeat(HEAD))), Err("431 Request Header Fields Too Large"));
        assert_eq!(parsed(&"a".repeat(HEAD + 1)), Err("431 Request Header Fields Too Large"));
        assert_eq!(parsed("PUT / HTTP/1.1\r\n\r\n"), Err("405 Method Not Allowed"));
        assert_eq!(parsed("\0\r\n\r\n"), Err(BAD));
    }

    #[test]
    fn field_of_a_form_is_decoded() {
        let form = b"name=anna&secret=a%2Db+c%C3%BC&wrong=%zz&short=%4";
        assert_eq!(field(form, "name").as_deref(), Some("anna"));
        assert_eq!(field(form, "secret").as_deref(), Some("a-b c\u{fc}"));
        for missing in ["wrong", "short", "none", ""] {
            assert_eq!(field(form, missing), None, "{missing}");
        }
        assert_eq!(field(b"\xff", "name"), None);
    }
}
