//! What happens on the network: who comes, who goes and why, who is refused.

use std::{fmt, time::Duration};

use super::Role;

/// Why a neighbour is there no longer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Parting {
    /// He has closed the connection, or it broke.
    Left(String),
    /// He was disconnected: what he sent was none of his, or nothing came from him for too long.
    Dismissed(String),
}

impl Parting {
    /// He has closed the connection.
    #[must_use]
    pub fn closed() -> Self {
        Self::Left("the connection was closed".to_owned())
    }

    /// He has answered no pulse for so long.
    #[must_use]
    pub fn silent(limit: Duration) -> Self {
        Self::Dismissed(format!("no answer for {} s", limit.as_secs()))
    }
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Left(why) | Self::Dismissed(why)) = self;
        f.write_str(why)
    }
}

/// What happened on the network.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum News {
    /// A neighbour has come.
    Came(Role),
    /// A neighbour has gone, and why.
    Gone(Role, Parting),
    /// Somebody was not let in, and why.
    Refused(String),
    /// What came was from nobody who is connected, and what.
    Stray(String),
}

impl fmt::Display for News {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Came(role) => write!(f, "{role} has connected"),
            Self::Gone(role, why) => write!(f, "{role} has gone: {why}"),
            Self::Refused(why) => write!(f, "a connection was refused: {why}"),
            Self::Stray(what) => write!(f, "a frame was refused: {what}"),
        }
    }
}
