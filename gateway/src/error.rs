//! Errors that end a gateway.

use std::io;

use neighbours::line::Address;

use crate::{
    address::{CellAddress, Endpoint, Name},
    keys::KeysError,
    page::people::PeopleError,
};

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Keys(#[from] KeysError),
    #[error(transparent)]
    People(#[from] PeopleError),
    #[error(
        "{}: the certificate cannot be used for TLS: {reason}; tools/keys.sh makes keys and certificates",
        .certificate.display()
    )]
    Tls { certificate: std::path::PathBuf, reason: String },
    #[error("{endpoint}: {source}")]
    Endpoint { endpoint: Endpoint, source: io::Error },
    #[error("{address}: {source}")]
    Socket { address: Address, source: io::Error },
    #[error("{0}: another program listens there: choose another path")]
    InUse(Address),
    #[error("{0}: a monitor reads keys of Zenoh and has no mailboxes: see examples/fleet.py")]
    Monitor(CellAddress),
    #[error(
        "{}: {reason} (is a router or gateway running there, and does it accept the certificate of {name}?)",
        list(.endpoints)
    )]
    Unreachable { endpoints: Vec<Endpoint>, name: Name, reason: String },
    #[error("zenoh: {0}")]
    Zenoh(String),
    #[error(transparent)]
    System(#[from] io::Error),
}

fn list(endpoints: &[Endpoint]) -> String {
    endpoints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

impl Error {
    #[must_use]
    #[expect(clippy::needless_pass_by_value, reason = "used as an argument of map_err")]
    pub fn zenoh(error: zenoh::Error) -> Self {
        Self::Zenoh(words(&error))
    }
}

#[must_use]
pub fn words(error: &zenoh::Error) -> String {
    without_places(&error.to_string()).trim_end_matches(['.', '!', ' ']).to_owned()
}

/// A text of Zenoh without the places in its source code that Zenoh appends, such as ` at /…/tcp.rs:105.`.
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
