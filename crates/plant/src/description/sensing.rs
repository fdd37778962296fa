//! Common values of each kind of sensor; scales and offsets are given with the devices.

use serde::{Deserialize, Serialize};

/// Errors and delays of the sensors. Delays are in ticks of 40 ms.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensorModels {
    /// Greatest noise of the resolvers, counts.
    pub resolver_noise: f64,
    /// Dead time of the resolvers, ticks.
    pub resolver_delay: u16,
    /// Dead time of potentiometers and strain gages, ticks.
    pub converter_delay: u16,
    /// Dead time of the force sensor, ticks.
    pub force_delay: u16,
    /// Dead time of proximity sensors, light beams and limit switches, ticks.
    pub switch_delay: u16,
    /// Hysteresis of a proximity sensor: it detects an ear until the ear is this much farther away than where the
    /// sensor first detected it, in.
    pub proximity_hysteresis: f64,
    /// Hysteresis of the ring's reflectance sensors, as a fraction of the ring's travel.
    pub ring_hysteresis: f64,
}
