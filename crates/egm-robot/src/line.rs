//! The link to a robot, as the bridge sees it: orders go in, samples come out.

use egm::{Error, Host, Pose, Sample};

use crate::{simulated::SimulatedLine, udp::UdpLine};

/// What the bridge asks of the host. Times are nanoseconds of the line's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Begin a path at rest.
    Begin {
        /// When.
        at: u64,
        /// Where.
        from: Pose,
    },
    /// The next point of the path.
    Point {
        /// When it was commanded.
        at: u64,
        /// The point.
        to: Pose,
    },
    /// Come to rest.
    Stop {
        /// When.
        at: u64,
    },
}

impl Order {
    /// Do as ordered. What the host refuses shows in its samples.
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

/// What the host knows after a message, with the times of that message.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// What is known.
    pub sample: Sample,
    /// From the message before to this one, ns; `None` without one.
    pub cycle: Option<u64>,
    /// From the message to its answer, ns.
    pub answered: u64,
}

/// The link to a robot.
pub enum Line {
    /// Over UDP, with a thread of its own.
    Udp(Box<UdpLine>),
    /// To an emulated robot, in simulated time.
    Simulated(Box<SimulatedLine>),
}

impl Line {
    /// The time of this line for a tick that begins now, ns. A simulated line is where it was advanced to.
    #[must_use]
    pub fn now(&self) -> u64 {
        match self {
            Self::Udp(line) => line.now(),
            Self::Simulated(line) => line.now(),
        }
    }

    /// Give an order.
    pub fn order(&mut self, order: &Order) {
        match self {
            Self::Udp(line) => line.order(order),
            Self::Simulated(line) => line.order(order),
        }
    }

    /// Let simulated time pass, ns; real time passes by itself.
    pub fn advance(&mut self, by: u64) {
        if let Self::Simulated(line) = self {
            line.advance(by);
        }
    }

    /// What has come since the last call, each message once.
    pub fn reports(&mut self, take: impl FnMut(&Report)) {
        match self {
            Self::Udp(line) => line.reports(take),
            Self::Simulated(line) => line.reports(take),
        }
    }

    /// What was known last.
    #[must_use]
    pub fn sample(&self) -> Sample {
        match self {
            Self::Udp(line) => line.sample(),
            Self::Simulated(line) => line.sample(),
        }
    }
}
