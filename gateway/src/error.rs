//! Errors that end a gateway.

use std::io;

use crate::{
    address::{CellAddress, Endpoint, UnixAddress},
    keys::KeysError,
};

/// Why a gateway cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Keys or certificates cannot be used.
    #[error(transparent)]
    Keys(#[from] KeysError),
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
        address: UnixAddress,
        /// Error of the system.
        source: io::Error,
    },
    /// Another program listens at the socket.
    #[error("{0}: another program listens there: choose another path")]
    InUse(UnixAddress),
    /// A monitor has no Unix socket.
    #[error("{0}: a monitor reads keys of Zenoh and has no mailboxes: see examples/fleet.py")]
    Monitor(CellAddress),
    /// Zenoh reports an error.
    #[error("zenoh: {0}")]
    Zenoh(String),
    /// The system reports an error.
    #[error(transparent)]
    System(#[from] io::Error),
}

impl Error {
    /// An error of Zenoh, which has only one kind.
    #[must_use]
    #[expect(clippy::needless_pass_by_value, reason = "used as an argument of map_err")]
    pub fn zenoh(error: zenoh::Error) -> Self {
        Self::Zenoh(words(&error))
    }
}

/// An error of Zenoh without the file and line of its source code, which Zenoh appends.
#[must_use]
pub fn words(error: &zenoh::Error) -> String {
    let text = error.to_string();
    text.split(" at /").next().unwrap_or_default().trim_end_matches('.').to_owned()
}
