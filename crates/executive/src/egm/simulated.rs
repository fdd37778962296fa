//! The host and an emulated robot in simulated time, connected by a simulated network.

use egm::{Host, Sample, host::Settings, message::MOST_BYTES};

use crate::egm::{
    emulator::{CYCLE_NS, EgmRobot},
    exchange::{Order, Report},
    network::Network,
};

/// Greatest number of reports kept between two calls: more than the robot has cycles in a tick.
const MOST_REPORTS: usize = 64;

pub struct SimulatedLine {
    host: Host,
    robot: EgmRobot,
    to_host: Network,
    to_robot: Network,
    now: u64,
    next_cycle: u64,
    reports: Vec<Report>,
    heard: Option<u64>,
}

impl SimulatedLine {
    #[must_use]
    pub fn new(settings: Settings, robot: EgmRobot, to_host: Network, to_robot: Network) -> Self {
        let reports = Vec::with_capacity(MOST_REPORTS);
        let host = Host::new(settings);
        Self { host, robot, to_host, to_robot, now: 0, next_cycle: CYCLE_NS, reports, heard: None }
    }

    /// The emulated robot, for example to stop it.
    pub const fn robot(&mut self) -> &mut EgmRobot {
        &mut self.robot
    }

    pub(crate) const fn now(&self) -> u64 {
        self.now
    }

    pub(crate) fn sample(&self) -> Sample {
        self.host.sample()
    }

    pub(crate) fn order(&mut self, order: &Order) {
        let _ = order.carry_out(&mut self.host);
    }

    pub(crate) fn reports(&mut self, take: impl FnMut(&Report)) {
        self.reports.iter().for_each(take);
        self.reports.clear();
    }

    /// Advances the time, ns: executes cycles and delivers datagrams in the order of their times.
    pub(crate) fn advance(&mut self, by: u64) {
        let end = self.now.saturating_add(by);
        loop {
            let to_host = self.to_host.next().unwrap_or(u64::MAX);
            let to_robot = self.to_robot.next().unwrap_or(u64::MAX);
            let next = self.next_cycle.min(to_host).min(to_robot);
            if next > end {
                break;
            }
            self.now = next;
            if next == to_robot {
                self.deliver_to_robot();
            } else if next == to_host {
                self.deliver_to_host();
            } else {
                self.next_cycle = next.saturating_add(CYCLE_NS);
                self.cycle();
            }
        }
        self.now = end;
        self.host.poll(end);
    }

    fn cycle(&mut self) {
        let mut buffer = [0; MOST_BYTES];
        if let Ok(datagram) = self.robot.cycle().encode(&mut buffer) {
            self.to_host.send(self.now, datagram);
        }
    }

    fn deliver_to_robot(&mut self) {
        if let Some((_, datagram)) = self.to_robot.arrived(self.now) {
            let _ = self.robot.receive(&datagram);
        }
    }

    fn deliver_to_host(&mut self) {
        let Some((_, datagram)) = self.to_host.arrived(self.now) else { return };
        let mut buffer = [0; MOST_BYTES];
        if let Ok(Some(answer)) = self.host.receive(self.now, &datagram, &mut buffer) {
            self.to_robot.send(self.now, answer);
            let cycle = self.heard.replace(self.now).map(|before| self.now.saturating_sub(before));
            if self.reports.len() < MOST_REPORTS {
                self.reports.push(Report { sample: self.host.sample(), cycle, answered: 0 });
            }
        }
    }
}
