//! Keys and switches of the controller's console and of the teach pendant, and the emergency stops.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The emergency stops (III.6): one circuit with five buttons, each of which stays in until it is pulled out.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum EStop {
    /// On the front panel of the controller.
    ControlPanel,
    /// On the teach pendant.
    TeachPendant,
    /// Near the terminals of RCS-II/T3.
    Terminals,
    /// On the joystick box.
    JoystickBox,
    /// Near the Active Pedestal.
    Pedestal,
}

impl EStop {
    /// All five.
    pub const ALL: [Self; 5] =
        [Self::ControlPanel, Self::TeachPendant, Self::Terminals, Self::JoystickBox, Self::Pedestal];

    /// Its name as a word of a command.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::ControlPanel => "control-panel",
            Self::TeachPendant => "teach-pendant",
            Self::Terminals => "terminals",
            Self::JoystickBox => "joystick-box",
            Self::Pedestal => "pedestal",
        }
    }

    /// The button with a name.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|site| site.word() == word)
    }

    pub(super) const fn index(self) -> usize {
        match self {
            Self::ControlPanel => 0,
            Self::TeachPendant => 1,
            Self::Terminals => 2,
            Self::JoystickBox => 3,
            Self::Pedestal => 4,
        }
    }
}

impl fmt::Display for EStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ControlPanel => "the E-stop on the control panel",
            Self::TeachPendant => "the E-stop on the teach pendant",
            Self::Terminals => "the E-stop near the terminals",
            Self::JoystickBox => "the E-stop on the joystick box",
            Self::Pedestal => "the E-stop near the pedestal",
        })
    }
}

/// An action at the controller's console, keyboard or teach pendant, or at the emergency stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Turn control power on or off (IV.3.3 step 4).
    ControlPower(bool),
    /// FAULT RESET (step 5).
    FaultReset,
    /// HYDRAULICS keyswitch (step 7).
    Hydraulics(bool),
    /// MANUAL ON/OFF (step 8).
    Manual(bool),
    /// Teach pendant: move an axis, counted from 1, to its arrow (step 9); `None` moves all of them.
    Align(Option<u8>),
    /// Teach pendant: turn an axis, counted from 1, by some degrees (IV.3.4).
    Jog {
        /// The axis.
        axis: u8,
        /// The degrees.
        degrees: i8,
    },
    /// AUTO (step 10).
    Auto,
    /// CYCLE START (step 12).
    CycleStart,
    /// INTERRUPT (step 12, A 2.3).
    Interrupt,
    /// CANCEL on the keyboard (step 12, A 2.4).
    Cancel,
    /// ENTER on the keyboard (A 2.4).
    Enter,
    /// Turn hold on or off (A 2.3).
    Hold(bool),
    /// Press an E-stop (III.6).
    Press(EStop),
    /// Pull an E-stop out again.
    Release(EStop),
    /// Put the RS232 board in, or take it out (A 2.3, D0).
    Board(bool),
    /// Repair the transmitter of the RS232 board, or break it (A 2.3, D5).
    Transmitter(bool),
    /// Power of the Prim Interface Box on or off (IV.1 steps 2 and 5).
    PrimBox(bool),
}

impl Key {
    /// The action as text of a command.
    #[must_use]
    pub fn text(self) -> String {
        let on = |on| if on { "on" } else { "off" };
        match self {
            Self::ControlPower(to) => format!("control power {}", on(to)),
            Self::FaultReset => "fault reset".into(),
            Self::Hydraulics(to) => format!("hydraulics {}", if to { "enable" } else { "disable" }),
            Self::Manual(to) => format!("manual {}", on(to)),
            Self::Align(None) => "align".into(),
            Self::Align(Some(axis)) => format!("align {axis}"),
            Self::Jog { axis, degrees } => format!("jog {axis} {degrees}"),
            Self::Auto => "auto".into(),
            Self::CycleStart => "cycle start".into(),
            Self::Interrupt => "interrupt".into(),
            Self::Cancel => "cancel".into(),
            Self::Enter => "enter".into(),
            Self::Hold(to) => format!("hold {}", on(to)),
            Self::Press(site) => format!("estop {}", site.word()),
            Self::Release(site) => format!("release {}", site.word()),
            Self::Board(to) => format!("board {}", if to { "in" } else { "out" }),
            Self::PrimBox(to) => format!("prim box {}", on(to)),
            Self::Transmitter(to) => format!("transmitter {}", if to { "good" } else { "broken" }),
        }
    }
}

/// Causes of the loss of pressure.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum Cut {
    /// An emergency stop was pressed.
    EStop(EStop),
    /// The pump, or a line, has failed.
    PressureLost,
    /// MANUAL ON/OFF was pressed.
    ManualOff,
    /// The HYDRAULICS keyswitch was turned.
    KeySwitch,
    /// Control power was turned off.
    ControlPower,
    /// The Prim Interface Box has lost its power.
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
            Self::EStop(site) => write!(f, "{site} was pressed"),
            Self::PressureLost => f.write_str("the hydraulics have lost their pressure"),
            Self::ManualOff => f.write_str("MANUAL ON/OFF was pressed"),
            Self::KeySwitch => f.write_str("the HYDRAULICS keyswitch was turned off"),
            Self::ControlPower => f.write_str("the controller has no power"),
            Self::PrimBox => f.write_str("the Prim Interface Box has no power"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_five_buttons_have_their_words_and_places() {
        for (index, site) in EStop::ALL.into_iter().enumerate() {
            assert_eq!((EStop::from_word(site.word()), site.index()), (Some(site), index));
            assert!(site.to_string().starts_with("the E-stop "));
        }
        assert_eq!(EStop::from_word("joystick"), None);
    }
}
