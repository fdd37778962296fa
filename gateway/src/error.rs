//! Errors that end a gateway.

use std::io;

use neighbours::line::Address;

use crate::{
    address::{CellAddress, Endpoint, Name},
    keys::KeysError,
    page::people::PeopleError,
};

/// Why a gateway cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Keys or certificates cannot be used.
    #[error(transparent)]
    Keys(#[from] KeysError),
    /// The file of persons cannot be used.
    #[error(transparent)]
    People(#[from] PeopleError),
    /// The key and the certificate do not serve TLS.
    #[error(
        "{}: the certificate cannot be used for TLS: {reason}; tools/keys.sh makes keys and certificates",
        .certificate.display()
    )]
    Tls {
        /// The certificate.
        certificate: std::path::PathBuf,
        /// The reason of the TLS library.
        reason: String,
    },
    /// The endpoint cannot be used.
    #[error("{endpoint}: {source}")]
    Endpoint {
        /// The endpoint.
        endpoint: Endpoint,
        /// Error of the system.
        source: io::Error,
    },
    /// The socket cannot be used.
    #[error("{address}: {source}")]
    Socket {
        /// The socket.
        address: Address,
        /// Error of the system.
        source: io::Error,
    },
    /// Another program listens at the socket.
    #[error("{0}: another program listens there: choose another path")]
    InUse(Address),
    /// A monitor has no Unix socket.
    #[error("{0}: a monitor reads keys of Zenoh and has no mailboxes: see examples/fleet.py")]
    Monitor(CellAddress),
    /// A monitor cannot connect.
    #[error(
        "{}: {reason} (is a router or gateway running there, and does it accept the certificate of {name}?)",
        list(.endpoints)
    )]
    Unreachable {
        /// The endpoints.
        endpoints: Vec<Endpoint>,
        /// Name of the certificate.
        name: Name,
        /// Error of Zenoh.
        reason: String,
    },
    /// Zenoh reports an error.
    #[error("zenoh: {0}")]
    Zenoh(String),
    /// The system reports an error.
    #[error(transparent)]
    System(#[from] io::Error),
}

fn list(endpoints: &[Endpoint]) -> String {
    endpoints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

impl Error {
    /// An error of Zenoh, which has only one kind.
    #[must_use]
    #[expect(clippy::needless_pass_by_value, reason = "used as an argument of map_err")]
    pub fn zenoh(error: zenoh::Error) -> Self {
        Self::Zenoh(words(&error))
    }
}

/// An error of Zenoh in one sentence.
#[must_use]
pub fn words(error: &zenoh::Error) -> String {
    without_places(&error.to_string()).trim_end_matches(['.', '!', ' ']).to_owned()
}

/// A text of Zenoh without the files and lines of its source code, ` at /…/tcp.rs:105.`, which it appends.
#[must_use]
pub fn without_places(text: &str) -> String {
    let (mut words, mut rest) = (String::new(), text);
    while let Some((before, place)) = rest.split_once(" at /") {
        words.push_str(before);
        rest = &place[place.find([' ', ']']).unwrap_or(place.len())..];
    }
    words + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_in_the_source_code_are_left_out() {
        let text = "no link: [refused (os error 111) at /a/b-1.0/tcp.rs:105.] at /a/c.rs:133. at /a/d.rs:1";
        assert_eq!(without_places(text), "no link: [refused (os error 111)]");
        assert_eq!(without_places("look at this"), "look at this");
    }
}
