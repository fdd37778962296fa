//! What kinds of sensors have in common; scales and offsets stand with their devices.

use serde::{Deserialize, Serialize};

/// What lies between the truth and the words of the sensors. Delays are in ticks of 40 ms.
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
    /// A proximity sensor sees an ear until it is so much farther away than where it was seen first, in.
    pub proximity_hysteresis: f64,
    /// The same of the ring's reflectance sensors, as a share of its way.
    pub ring_hysteresis: f64,
}
