//! Part presence between the fingers, by the potentiometer alone. No header names the rows.

use interfaces::device::JawValves;
use rcs_core::{Plain, Variables, decision_table};

use super::Stop;

/// The readings of the potentiometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Settling {
    /// The fingers have stopped, and the gripper has been attached for 0.2 s.
    Settled,
    /// The fingers move, or were attached more recently.
    Unsettled,
}

/// The opening by the potentiometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum JawTravel {
    /// Within the travel of the fingers.
    Within,
    /// Beyond an end.
    Beyond,
}

/// The closing side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Closing {
    /// The closing side has air.
    On,
    /// The closing side has no air.
    Off,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct JawReading {
    /// The readings.
    pub readings: Settling,
    /// The position of the fingers.
    pub stop: Stop,
    /// The opening.
    pub travel: JawTravel,
    /// The closing side.
    pub closing: Closing,
}

impl From<JawValves> for Closing {
    fn from(valves: JawValves) -> Self {
        if valves.close { Self::On } else { Self::Off }
    }
}

decision_table! {
    /// PRESENCE: the part presence (VI.4 has no force sensors). Fingers at an end of travel hold nothing, although
    /// an object as small as the closed opening reads the same. Fingers that seem to rest open while air closes
    /// them have no air, or their potentiometer is stuck: they may close on something at any time.
    pub PRESENCE: fn presence(self::JawReading) -> interfaces::grip::Felt {
        1: readings: Unsettled        => NotKnown;
        2: stop: Opened, closing: On  => NotKnown;
        3: stop: Closed | Opened      => Nothing;
        4: travel: Within             => Something;
        5: travel: Beyond             => NotKnown;
    }
}
