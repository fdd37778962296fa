//! The address of a controller in a Zenoh network: its name, and optionally an endpoint.
//!
//! `t3` finds it by multicast, `t3@tcp/10.0.0.1:7447` at an address of its own: there the controller
//! listens, there neighbours connect, and there is no multicast. A file of Zenoh's own configuration adds
//! the rest.

use std::{
    fmt,
    path::{Path, PathBuf},
    str::FromStr,
};

/// Letters of a name at most: it is a part of every key.
const MAX_NAME: usize = 32;
/// Transports that Zenoh is built with here.
const LINKS: [&str; 2] = ["tcp/", "tls/"];

/// A controller in a Zenoh network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ZenohAddress {
    name: String,
    endpoint: Option<String>,
    configuration: Option<PathBuf>,
}

/// Why a text is not such an address.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ZenohAddressError {
    /// Its name cannot be a part of a key.
    #[error("a name of 1 to {MAX_NAME} letters, digits, - or _ was expected behind zenoh:, found {0:?}")]
    Name(String),
    /// Zenoh cannot listen there.
    #[error("an endpoint was expected behind @, as in tcp/10.0.0.1:7447 or tls/robot.shop:7447, found {0:?}")]
    Endpoint(String),
}

impl ZenohAddress {
    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the controller listens; `None` if it is found by multicast.
    #[must_use]
    pub fn endpoint(&self) -> Option<&str> {
        self.endpoint.as_deref()
    }

    /// A file of Zenoh's configuration.
    #[must_use]
    pub fn configuration(&self) -> Option<&Path> {
        self.configuration.as_deref()
    }

    /// With a file of Zenoh's configuration.
    #[must_use]
    pub fn configured(self, file: PathBuf) -> Self {
        Self { configuration: Some(file), ..self }
    }
}

impl FromStr for ZenohAddress {
    type Err = ZenohAddressError;

    fn from_str(text: &str) -> Result<Self, ZenohAddressError> {
        let (name, endpoint) =
            text.split_once('@').map_or((text, None), |(name, endpoint)| (name, Some(endpoint)));
        let fits = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_');
        if !(1..=MAX_NAME).contains(&name.len()) || !name.chars().all(fits) {
            return Err(ZenohAddressError::Name(name.to_owned()));
        }
        // It becomes a text of a JSON document.
        let plain =
            |text: &str| text.chars().all(|letter| letter.is_ascii_graphic() && !"\"\\".contains(letter));
        let is_endpoint = |text: &&str| {
            let place = LINKS.iter().find_map(|link| text.strip_prefix(link));
            place.is_some_and(|place| place.contains(':') && plain(place))
        };
        if let Some(found) = endpoint.filter(|text| !is_endpoint(text)) {
            return Err(ZenohAddressError::Endpoint(found.to_owned()));
        }
        Ok(Self { name: name.to_owned(), endpoint: endpoint.map(str::to_owned), configuration: None })
    }
}

impl fmt::Display for ZenohAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        self.endpoint.as_ref().map_or(Ok(()), |endpoint| write!(f, "@{endpoint}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_come_back() {
        for text in ["t3", "t3@tcp/10.0.0.1:7447", "cell_2-b@tls/robot.shop:7447", "t3@tcp/[::1]:7447"] {
            assert_eq!(text.parse::<ZenohAddress>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn what_is_no_address_is_said() {
        let long = "x".repeat(MAX_NAME + 1);
        for text in ["", "@tcp/10.0.0.1:7447", "t3/F6000", "t*", "$t3", long.as_str()] {
            assert!(matches!(text.parse::<ZenohAddress>(), Err(ZenohAddressError::Name(_))), "{text}");
        }
        for text in
            ["t3@", "t3@10.0.0.1:7447", "t3@tcp/", "t3@tcp/here", "t3@quic/10.0.0.1:7447", "t3@tcp/1:2\"]"]
        {
            assert!(matches!(text.parse::<ZenohAddress>(), Err(ZenohAddressError::Endpoint(_))), "{text}");
        }
    }
}
