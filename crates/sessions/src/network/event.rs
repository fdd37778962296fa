use std::{fmt, time::Duration};

use super::Role;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Disconnect {
    Closed,
    Lost(String),
    /// The controller has closed the connection, because the neighbour has answered no pulse for this time.
    Silent(Duration),
    /// The controller has closed the connection, because the neighbour has violated the protocol in this way.
    Violation(String),
}

impl Disconnect {
    /// True if the controller has ended the session.
    #[must_use]
    pub const fn is_by_controller(&self) -> bool {
        matches!(self, Self::Silent(_) | Self::Violation(_))
    }
}

impl fmt::Display for Disconnect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Closed => f.write_str("the connection was closed"),
            Self::Lost(why) | Self::Violation(why) => f.write_str(why),
            Self::Silent(limit) => write!(f, "no answer for {} s", limit.as_secs()),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NetEvent {
    Connected(Role),
    Disconnected(Role, Disconnect),
    Refused(String),
}

impl NetEvent {
    /// Stable short name of its kind.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Connected(_) => "network.connected",
            Self::Disconnected(..) => "network.disconnected",
            Self::Refused(_) => "network.refused",
        }
    }
}

impl fmt::Display for NetEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Connected(role) => write!(f, "{role} has connected"),
            Self::Disconnected(role, why) => write!(f, "{role} has disconnected: {why}"),
            Self::Refused(why) => write!(f, "a connection was refused: {why}"),
        }
    }
}
