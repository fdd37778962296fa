//! Causes of the loss of pressure.

use std::fmt;

use interfaces::station::EStop;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum Cut {
    EStop(#[serde(with = "crate::image::word")] EStop),
    PressureLost,
    ManualOff,
    KeySwitch,
    ControlPower,
    PrimBox,
}

impl Cut {
    /// True if it is not part of normal operation: an emergency stop, or a failure.
    #[must_use]
    pub const fn is_emergency(self) -> bool {
        matches!(self, Self::EStop(_) | Self::PressureLost)
    }
}

impl fmt::Display for Cut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EStop(site) => write!(f, "the E-stop {} was pressed", site.place()),
            Self::PressureLost => f.write_str("the hydraulics have lost their pressure"),
            Self::ManualOff => f.write_str("MANUAL ON/OFF was pressed"),
            Self::KeySwitch => f.write_str("the HYDRAULICS keyswitch was turned off"),
            Self::ControlPower => f.write_str("the controller has no power"),
            Self::PrimBox => f.write_str("the Prim Interface Box has no power"),
        }
    }
}
