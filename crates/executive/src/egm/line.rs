//! The link between the bridge and a robot.

use egm::Sample;

use crate::egm::{
    exchange::{Order, Refusals, Report},
    simulated::SimulatedLine,
    udp::UdpLine,
};

pub enum Line {
    /// Over UDP, with its own thread.
    Udp(Box<UdpLine>),
    /// To an emulated robot, in simulated time.
    Simulated(Box<SimulatedLine>),
}

impl Line {
    /// The time of the line's clock for a tick that begins now, ns. The clock of a simulated line moves only in
    /// [`Self::advance`].
    #[must_use]
    pub fn now(&self) -> u64 {
        match self {
            Self::Udp(line) => line.now(),
            Self::Simulated(line) => line.now(),
        }
    }

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

    pub fn reports(&mut self, take: impl FnMut(&Report)) {
        match self {
            Self::Udp(line) => line.reports(take),
            Self::Simulated(line) => line.reports(take),
        }
    }

    #[must_use]
    pub fn sample(&self) -> Sample {
        match self {
            Self::Udp(line) => line.sample(),
            Self::Simulated(line) => line.sample(),
        }
    }
    #[must_use]
    pub fn refusals(&self) -> Refusals {
        match self {
            Self::Udp(line) => line.refusals(),
            Self::Simulated(line) => {
                Refusals { invalid: line.sample().counters.refused, ..Refusals::default() }
            }
        }
    }
}
