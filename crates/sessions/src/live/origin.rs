//! Origins of the web pages that may connect.
//!
//! Without this check, any page open on the machine could watch and command the robot.

use std::{fmt, str::FromStr};

/// The origin of a page: `https://app.foxglove.dev`, `http://localhost:8080`, `file://`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin(String);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("SCHEME://HOST or SCHEME://HOST:PORT was expected, such as http://localhost:8080; found {0}")]
pub struct OriginError(String);

impl Origin {
    #[must_use]
    pub fn foxglove() -> Self {
        Self("https://app.foxglove.dev".to_owned())
    }

    /// Returns true if a browser's header has this origin, in upper or lower case.
    #[must_use]
    pub fn is(&self, header: &[u8]) -> bool {
        self.0.as_bytes().eq_ignore_ascii_case(header)
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for Origin {
    type Err = OriginError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let legal = |(scheme, host): (&str, &str)| {
            let word = scheme.starts_with(|c: char| c.is_ascii_alphabetic())
                && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
            let place = host.chars().all(|c| c.is_ascii_alphanumeric() || ".-:[]_".contains(c));
            word && place && (!host.is_empty() || scheme == "file")
        };
        // The address of a page ends with a slash, but an origin does not.
        let bare = if text.ends_with("://") { text } else { text.strip_suffix('/').unwrap_or(text) };
        match bare.split_once("://") {
            Some(parts) if legal(parts) => Ok(Self(bare.to_owned())),
            _ => Err(OriginError(text.to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_has_scheme_host_and_port() {
        for good in ["http://localhost:8080", "https://app.foxglove.dev", "file://", "http://[::1]:80"] {
            assert_eq!(good.parse::<Origin>().map(|origin| origin.to_string()).as_deref(), Ok(good));
        }
        let slash: Origin = "http://localhost:8080/".parse().unwrap();
        assert!(slash.is(b"http://LOCALHOST:8080") && !slash.is(b"http://localhost:80"));
        for wrong in ["", "null", "localhost:8080", "http://", "http://a b", "http://a/b", "://x", "*"] {
            assert!(wrong.parse::<Origin>().is_err(), "{wrong}");
        }
    }
}
