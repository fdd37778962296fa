use std::{fmt, net::SocketAddr};

use egm::{Error, Host, Pose, Sample};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    Begin {
        at: u64, // time of the order, ns of the line's clock
        from: Pose,
    },
    Point {
        at: u64, // time of the command, ns of the line's clock
        to: Pose,
    },
    Stop {
        at: u64, // time of the order, ns of the line's clock
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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    pub sample: Sample,
    /// Time since the previous message, ns; `None` for the first one.
    pub cycle: Option<u64>,
    pub answered: u64, // time from the message to its answer, ns
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Refusals {
    pub invalid: u64,   // not valid messages of a robot
    pub elsewhere: u64, // from other addresses than the robot's
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
