//! The link between the bridge and a robot: takes orders, gives samples.

use egm::{Error, Host, Pose, Sample};

use crate::{simulated::SimulatedLine, udp::UdpLine};

/// An order of the bridge to the host. Times are ns of the line's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Begin a path from rest.
    Begin {
        /// Time of the order, ns of the line's clock.
        at: u64,
        /// Start pose of the path.
        from: Pose,
    },
    /// The next point of the path.
    Point {
        /// Time of the command, ns of the line's clock.
        at: u64,
        /// Target pose.
        to: Pose,
    },
    /// Come to rest.
    Stop {
        /// Time of the order, ns of the line's clock.
        at: u64,
    },
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
        }
    }
}

/// State of the host after a message, with the times of that message.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// State of the host.
    pub sample: Sample,
    /// Time since the previous message, ns; `None` if there is none.
    pub cycle: Option<u64>,
    /// Time from the message to its answer, ns.
    pub answered: u64,
}

/// The link to a robot: real or emulated.
pub enum Line {
    /// Over UDP, with its own thread.
    Udp(Box<UdpLine>),
    /// To an emulated robot, in simulated time.
    Simulated(Box<SimulatedLine>),
}

impl Line {
    /// The time of the line's clock for a tick that begins now, ns. The clock of a simulated line stands still between
    /// calls of [`Self::advance`].
    #[must_use]
    pub fn now(&self) -> u64 {
        match self {
            Self::Udp(line) => line.now(),
            Self::Simulated(line) => line.now(),
        }
    }

    /// Gives an order to the host.
    pub fn order(&mut self, order: &Order) {
        match self {
            Self::Udp(line) => line.order(order),
            Self::Simulated(line) => line.order(order),
        }
    }

    /// Advances simulated time, ns; has no effect on a UDP line.
    pub fn advance(&mut self, by: u64) {
        if let Self::Simulated(line) = self {
            line.advance(by);
        }
    }

    /// Calls `take` once for each report since the last call.
    pub fn reports(&mut self, take: impl FnMut(&Report)) {
        match self {
            Self::Udp(line) => line.reports(take),
            Self::Simulated(line) => line.reports(take),
        }
    }

    /// The newest sample.
    #[must_use]
    pub fn sample(&self) -> Sample {
        match self {
            Self::Udp(line) => line.sample(),
            Self::Simulated(line) => line.sample(),
        }
    }
}
