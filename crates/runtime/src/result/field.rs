//! The couplers in the result of a run.

use std::fmt;

use closed_loop::field::SimulatedField;
use interfaces::point::Group;
use serde::Serialize;

#[derive(Clone, Debug, Serialize)]
pub struct FieldResult {
    pub devices: Vec<FieldDevice>,
    /// The simulated groups of devices: all of them, since the couplers are emulated.
    pub simulated: Vec<&'static str>,
}

#[derive(Clone, Debug, Serialize)]
pub struct FieldDevice {
    pub name: String,
    pub exchanges: u32,
    pub failures: u32,
    /// Number of times that its outputs were made safe until a release.
    pub trips: u32,
}

impl From<&SimulatedField> for FieldResult {
    fn from(field: &SimulatedField) -> Self {
        let devices = field.counters().map(|(name, counters)| FieldDevice {
            name: name.to_owned(),
            exchanges: counters.exchanges,
            failures: counters.failures,
            trips: counters.trips,
        });
        Self { devices: devices.collect(), simulated: Group::ALL.map(Group::name).to_vec() }
    }
}

impl fmt::Display for FieldResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for FieldDevice { name, exchanges, failures, trips } in &self.devices {
            write!(f, "{name}: {exchanges} exchanges, {failures} failed, {trips} trips; ")?;
        }
        f.write_str("simulated: all devices")
    }
}
