//! The couplers in the result of a run.

use std::fmt;

use closed_loop::field::FieldController;
use couplers::State;
use serde::Serialize;

use super::TickTimes;
use crate::field::FieldPort;

#[derive(Clone, Debug, Serialize)]
pub struct FieldResult {
    pub devices: Vec<FieldDevice>,
    pub simulated: Vec<&'static str>, // the simulated parts of the run: groups of devices, and the robot
    pub is_real: bool, // the devices are real: places of parts, contacts and confirmations are not judged
    #[serde(skip_serializing_if = "Option::is_none")]
    pub age_us: Option<TickTimes>, // greatest age of the inputs at a tick; `None` in simulated time
    /// Time of a tick for reading and writing the devices; `None` in simulated time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tick_us: Option<TickTimes>,
}

#[derive(Clone, Debug, Serialize)]
pub struct FieldDevice {
    pub name: String,
    pub exchanges: u32,
    pub failures: u32,
    pub trips: u32,      // number of times that its outputs were made safe until a release
    pub confirmed: bool, // it has confirmed that its outputs are safe at the end
}

impl FieldResult {
    /// The result of couplers, with the measurements of couplers over TCP.
    #[must_use]
    pub fn new(desk: &FieldController, simulated: Vec<&'static str>, port: Option<&FieldPort>) -> Self {
        let devices = desk.mapping().devices.iter().zip(desk.reports()).map(|(device, report)| FieldDevice {
            name: device.name.clone(),
            exchanges: report.counters.exchanges,
            failures: report.counters.failures,
            trips: report.counters.trips,
            confirmed: report.state == State::Ended(true),
        });
        Self {
            devices: devices.collect(),
            simulated,
            is_real: port.is_some(),
            age_us: port.map(|port| port.ages().into()),
            tick_us: port.map(|port| port.shares().into()),
        }
    }
}

impl fmt::Display for FieldResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for FieldDevice { name, exchanges, failures, trips, confirmed } in &self.devices {
            let safe = if *confirmed { "confirmed" } else { "NOT confirmed" };
            write!(
                f,
                "{name}: {exchanges} exchanges, {failures} failed, {trips} trips, safe outputs {safe}; "
            )?;
        }
        if let Some(TickTimes { p50, p99, max }) = self.age_us {
            let [p50, p99, max] = [p50, p99, max].map(|us| us / 1000.0);
            write!(f, "inputs were {p50:.1} ms old (p99 {p99:.1} ms, max {max:.1} ms); ")?;
        }
        let simulated =
            if self.simulated.is_empty() { "nothing".to_owned() } else { self.simulated.join(", ") };
        write!(f, "simulated: {simulated}")
    }
}
