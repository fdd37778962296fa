//! Cells, endpoints, names and roles, as they appear on the command line.

use std::{
    fmt, io,
    net::{SocketAddr, TcpListener},
    str::FromStr,
};

use neighbours::line::Role;

const LONGEST: usize = 48; // greatest length of the name of a cell or of a certificate

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    #[error("expected a name of 1 to {LONGEST} letters, digits, -, _ and ., found {0:?}")]
    Name(String),
    #[error("expected tls/IP:PORT, as in tls/10.0.0.1:7447, found {0:?}")]
    Endpoint(String),
    #[error("expected CELL@tls/IP:PORT, as in t3@tls/10.0.0.1:7447, found {0:?}")]
    Cell(String),
    #[error("expected ROLE=NAME or ROLE=NAME,NAME, as in workstation=hwsc-1, found {0:?}")]
    Allow(String),
    #[error("expected {expected}, found {0:?}", expected = Right::words())]
    Role(String),
}

/// The name of a cell, or the common name of a certificate: one part of a key, without wildcards.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(String);

impl Name {
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for Name {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let legal = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let fits = (1..=LONGEST).contains(&text.len()) && !text.starts_with('.');
        if fits && text.chars().all(legal) {
            Ok(Self(text.to_owned()))
        } else {
            Err(AddressError::Name(text.to_owned()))
        }
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// An endpoint: `tls/IP:PORT`. Host names are not accepted, because resolving them can block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Endpoint(pub SocketAddr);

impl Endpoint {
    /// Checks that this process can listen there.
    pub fn check_free(self) -> io::Result<()> {
        TcpListener::bind(self.0).map(drop)
    }
}

impl FromStr for Endpoint {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let socket = text.strip_prefix("tls/").and_then(|socket| socket.parse().ok());
        socket.map(Self).ok_or_else(|| AddressError::Endpoint(text.to_owned()))
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tls/{}", self.0)
    }
}

/// A cell and the endpoint of its gateway: `CELL@tls/IP:PORT`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellAddress {
    pub cell: Name,
    pub endpoint: Endpoint,
}

impl FromStr for CellAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let (cell, endpoint) = text.split_once('@').ok_or_else(|| AddressError::Cell(text.to_owned()))?;
        Ok(Self { cell: cell.parse()?, endpoint: endpoint.parse()? })
    }
}

impl fmt::Display for CellAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.cell, self.endpoint)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Right {
    Claim(Role),
    Monitor, // read the status of the cell
}

impl Right {
    const MONITOR: &str = "monitor";

    fn words() -> String {
        let roles: Vec<_> = Role::ALL.iter().map(|role| role.text()).collect();
        format!("{} or {}", roles.join(", "), Self::MONITOR)
    }
}

impl FromStr for Right {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        match text.parse() {
            Ok(role) => Ok(Self::Claim(role)),
            Err(_) if text == Self::MONITOR => Ok(Self::Monitor),
            Err(_) => Err(AddressError::Role(text.to_owned())),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allow {
    pub right: Right,
    pub names: Vec<Name>,
}

impl FromStr for Allow {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let (role, names) = text.split_once('=').ok_or_else(|| AddressError::Allow(text.to_owned()))?;
        let right = role.parse()?;
        Ok(Self { right, names: names.split(',').map(str::parse).collect::<Result<_, _>>()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_parse_and_print_as_typed() {
        let cell: CellAddress = "t3@tls/10.0.0.1:7447".parse().unwrap();
        assert_eq!(cell.to_string(), "t3@tls/10.0.0.1:7447");
        for wrong in ["t3", "t3@", "t3@tcp/10.0.0.1:7447", "t3@tls/localhost:7447", "@tls/10.0.0.1:7447"] {
            assert!(wrong.parse::<CellAddress>().is_err(), "{wrong}");
        }
    }

    /// Names become parts of keys and of file names, so wildcards and slashes are refused.
    #[test]
    fn names_contain_no_wildcards_and_no_separators() {
        for wrong in ["", "*", "**", "a/b", "a$*", "a?b", "..", "a b", "ä", &"n".repeat(49)] {
            assert!(wrong.parse::<Name>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn permissions_name_a_role_and_its_certificates() {
        let allow: Allow = "data-system=a,b".parse().unwrap();
        assert_eq!(allow.right, Right::Claim(Role::DataSystem));
        assert_eq!(allow.names, ["a".parse().unwrap(), "b".parse().unwrap()]);
        assert_eq!("monitor=mes".parse::<Allow>().unwrap().right, Right::Monitor);
        let error = "foreman=a".parse::<Allow>().unwrap_err().to_string();
        let expected =
            "expected workstation, data-system, pedestal, vision, operator or monitor, found \"foreman\"";
        assert_eq!(error, expected);
        for wrong in ["workstation", "workstation=", "workstation=a,", "=a"] {
            assert!(wrong.parse::<Allow>().is_err(), "{wrong}");
        }
    }
}
