use std::{
    fmt,
    path::{Path, PathBuf},
    str::FromStr,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address(PathBuf); // `unix:PATH`, for processes of the same user on this machine

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unix:PATH was expected, found {found}{}", if *.is_remote { TO_OTHER_MACHINES } else { "" })]
pub struct AddressError {
    found: String,
    is_remote: bool, // an address on a network, as in earlier versions
}

const TO_OTHER_MACHINES: &str =
    "; to other machines rcs-gateway carries the connection, with TLS (docs/several-machines.md)";
const REMOTE: [&str; 4] = ["tcp", "tls", "zenoh", "quic"]; // on a network

impl Address {
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl From<PathBuf> for Address {
    fn from(path: PathBuf) -> Self {
        Self(path)
    }
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let path = text.strip_prefix("unix:").filter(|path| !path.is_empty());
        path.map(|path| Self(path.into())).ok_or_else(|| AddressError {
            found: text.to_owned(),
            is_remote: REMOTE.iter().any(|scheme| {
                let rest = text.strip_prefix(scheme);
                rest.is_some_and(|rest| rest.starts_with([':', '/']))
            }),
        })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unix:{}", self.0.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_an_address_parses_to_the_same_address() {
        for text in ["unix:/run/rcs.sock", "unix:here"] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn network_addresses_are_refused_with_the_alternative() {
        for text in ["tcp:127.0.0.1:7400", "zenoh:t3", "zenoh:t3@tcp/10.0.0.1:7447", "tls/10.0.0.1:7447"] {
            let error = text.parse::<Address>().unwrap_err().to_string();
            assert_eq!(
                error,
                format!(
                    "unix:PATH was expected, found {text}; to other machines rcs-gateway carries the \
                     connection, with TLS (docs/several-machines.md)"
                )
            );
        }
        for text in ["", "unix:", "/run/rcs.sock", "tcp"] {
            let error = text.parse::<Address>().unwrap_err().to_string();
            assert_eq!(error, format!("unix:PATH was expected, found {text}"));
        }
    }
}
