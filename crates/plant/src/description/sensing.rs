//! Common values of kinds of sensors; scales and offsets are with their devices.

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
    /// Hysteresis of a proximity sensor: an ear is seen until it is this much farther away than where it was first
    /// seen, in.
    pub proximity_hysteresis: f64,
    /// The same of the ring's reflectance sensors, as a share of its way.
    pub ring_hysteresis: f64,
}
