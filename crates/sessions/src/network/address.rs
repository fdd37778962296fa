//! Where the controller's mailboxes can be reached.

use std::{fmt, net::SocketAddr, path::PathBuf, str::FromStr};

use super::zenoh_address::{ZenohAddress, ZenohAddressError};

/// An address: `unix:PATH`, `tcp:IP:PORT` or `zenoh:NAME[@ENDPOINT]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// A socket in the file system, for processes of the same user on this machine.
    Unix(PathBuf),
    /// A TCP port: TLS with certificates on both sides.
    Tcp(SocketAddr),
    /// A Zenoh network, with the same TLS inside.
    Zenoh(ZenohAddress),
}

/// Why a text is not an address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// An unknown scheme.
    #[error("unix:PATH, tcp:IP:PORT or zenoh:NAME was expected, found {0}")]
    Scheme(String),
    /// No IP address and port.
    #[error("an IP address and a port were expected behind tcp:, as in tcp:127.0.0.1:7400, found {0}")]
    Socket(String),
    /// Not a Zenoh address.
    #[error(transparent)]
    ZenohAddress(#[from] ZenohAddressError),
    /// A configuration of Zenoh for another kind of address.
    #[error("a configuration of Zenoh is for an address that begins with zenoh:, found {0}")]
    NotZenoh(Address),
}

impl Address {
    /// With a file of Zenoh's configuration, if there is one.
    ///
    /// # Errors
    /// [`AddressError::NotZenoh`].
    pub fn configured(self, file: Option<PathBuf>) -> Result<Self, AddressError> {
        match (self, file) {
            (Self::Zenoh(zenoh), Some(file)) => Ok(Self::Zenoh(zenoh.configured(file))),
            (other, None) => Ok(other),
            (other, Some(_)) => Err(AddressError::NotZenoh(other)),
        }
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text.split_once(':') {
            Some(("unix", path)) if !path.is_empty() => Ok(Self::Unix(path.into())),
            Some(("tcp", socket)) => {
                socket.parse().map(Self::Tcp).map_err(|_| AddressError::Socket(socket.to_owned()))
            }
            Some(("zenoh", zenoh)) => Ok(Self::Zenoh(zenoh.parse()?)),
            _ => Err(AddressError::Scheme(text.to_owned())),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
            Self::Tcp(socket) => write!(f, "tcp:{socket}"),
            Self::Zenoh(zenoh) => write!(f, "zenoh:{zenoh}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_come_back() {
        for text in ["unix:/run/rcs.sock", "unix:here", "tcp:127.0.0.1:7400", "tcp:[::1]:7400", "zenoh:t3"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
        for text in ["", "unix:", "/run/rcs.sock", "udp:1.2.3.4:5"] {
            assert!(matches!(text.parse::<Address>(), Err(AddressError::Scheme(_))), "{text}");
        }
        for text in ["tcp:", "tcp:localhost", "tcp:127.0.0.1"] {
            assert!(matches!(text.parse::<Address>(), Err(AddressError::Socket(_))), "{text}");
        }
        assert!(matches!("zenoh:".parse::<Address>(), Err(AddressError::ZenohAddress(_))));
    }

    #[test]
    fn a_configuration_of_zenoh_is_for_zenoh() {
        let of = |text: &str, file: Option<&str>| {
            text.parse::<Address>().unwrap().configured(file.map(PathBuf::from))
        };
        let Address::Zenoh(zenoh) = of("zenoh:t3", Some("tls.json5")).unwrap() else { panic!("it is") };
        assert_eq!(zenoh.configuration(), Some(std::path::Path::new("tls.json5")));
        assert!(of("unix:here", None).is_ok());
        assert!(matches!(of("unix:here", Some("tls.json5")), Err(AddressError::NotZenoh(_))));
    }
}
