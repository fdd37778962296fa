//! What the bridge and the host of a robot exchange: orders, reports, and the datagrams that the host refused.

use std::{fmt, net::SocketAddr};

use egm::{Error, Host, Pose, Sample};

/// An order of the bridge to the host. Times are ns of the line's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    Begin {
        /// Time of the order, ns of the line's clock.
        at: u64,
        from: Pose,
    },
    /// The next point of the path.
    Point {
        /// Time of the command, ns of the line's clock.
        at: u64,
        to: Pose,
    },
    /// Come to rest on the path.
    Stop {
        /// Time of the order, ns of the line's clock.
        at: u64,
    },
    /// Stay where the robot is: it has left its path.
    Hold,
}

impl Order {
    /// Passes the order to the host. The samples show whether the host refused it.
    pub fn carry_out(&self, host: &mut Host) -> Result<(), Error> {
        match self {
            Self::Begin { at, from } => host.begin(*at, from),
            Self::Point { at, to } => host.push(*at, to),
            Self::Stop { at } => {
                host.stop(*at);
                Ok(())
            }
            Self::Hold => {
                host.hold();
                Ok(())
            }
        }
    }
}

/// State of the host after a message, with the times of that message.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    pub sample: Sample,
    /// Time since the previous message, ns; `None` if there is none.
    pub cycle: Option<u64>,
    /// Time from the message to its answer, ns.
    pub answered: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// It is not a valid message of a robot.
    Message(Error),
    /// It is not from the address that `from=` names.
    NotAllowed,
    /// A robot at another address was heard first.
    OtherRobot(SocketAddr),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    pub from: SocketAddr,
    pub cause: Cause,
}

/// The refused datagrams since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Refusals {
    /// Number of datagrams that are not valid messages of a robot.
    pub invalid: u64,
    /// Number of datagrams from other addresses than that of the robot.
    pub elsewhere: u64,
    /// The last one; `None` without any, and for an emulated robot in this process.
    pub last: Option<Refused>,
}

impl Refusals {
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.invalid.saturating_add(self.elsewhere)
    }
}

/// `from 10.0.0.7:6510: the field ... is missing`.
impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "from {}: ", self.from)?;
        match &self.cause {
            Cause::Message(error) => error.fmt(f),
            Cause::NotAllowed => f.write_str("not the address that from= names"),
            Cause::OtherRobot(robot) => write!(f, "the robot is the one at {robot}, which was heard first"),
        }
    }
}

/// `12 datagrams refused, the last from 10.0.0.7:6510: the field ... is missing`.
impl fmt::Display for Refusals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.count() {
            1 => f.write_str("1 datagram refused")?,
            count => write!(f, "{count} datagrams refused")?,
        }
        self.last.map_or(Ok(()), |last| write!(f, ", the last {last}"))
    }
}
