//! Common values of each kind of sensor; scales and offsets are given with the devices.

use serde::{Deserialize, Serialize};

/// Errors and delays of the sensors. Delays are in ticks of 40 ms.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensorModels {
    pub resolver_noise: f64,  // counts
    pub resolver_delay: u16,  // dead time of the resolvers, ticks
    pub converter_delay: u16, // dead time of potentiometers and strain gages, ticks
    pub force_delay: u16,     // dead time of the force sensor, ticks
    pub switch_delay: u16,    // dead time of proximity sensors, light beams and limit switches, ticks
    /// Hysteresis of a proximity sensor, in: an ear stays detected until it is this much farther away.
    pub proximity_hysteresis: f64,
    /// Hysteresis of the ring's reflectance sensors, as a fraction of the ring's travel.
    pub ring_hysteresis: f64,
}
