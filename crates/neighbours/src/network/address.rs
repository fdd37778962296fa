//! Where the controller's mailboxes can be reached.

use std::{fmt, net::SocketAddr, path::PathBuf, str::FromStr};

/// An address: `unix:PATH` or `tcp:HOST:PORT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// A socket in the file system, for processes of the same user on this machine.
    Unix(PathBuf),
    /// A TCP port, for whoever knows the secret.
    Tcp(SocketAddr),
}

/// Why a text is no address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// No scheme that is known.
    #[error("unix:PATH or tcp:HOST:PORT was expected, found {0}")]
    Scheme(String),
    /// No numbers.
    #[error("an IP address and a port were expected behind tcp:, as in tcp:127.0.0.1:7400, found {0}")]
    Socket(String),
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text.split_once(':') {
            Some(("unix", path)) if !path.is_empty() => Ok(Self::Unix(path.into())),
            Some(("tcp", socket)) => {
                socket.parse().map(Self::Tcp).map_err(|_| AddressError::Socket(socket.to_owned()))
            }
            _ => Err(AddressError::Scheme(text.to_owned())),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
            Self::Tcp(socket) => write!(f, "tcp:{socket}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_come_back() {
        for text in ["unix:/run/rcs.sock", "unix:here", "tcp:127.0.0.1:7400", "tcp:[::1]:7400"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
        for text in ["", "unix:", "/run/rcs.sock", "udp:1.2.3.4:5"] {
            assert!(matches!(text.parse::<Address>(), Err(AddressError::Scheme(_))), "{text}");
        }
        for text in ["tcp:", "tcp:localhost", "tcp:127.0.0.1"] {
            assert!(matches!(text.parse::<Address>(), Err(AddressError::Socket(_))), "{text}");
        }
    }
}
