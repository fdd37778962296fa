//! Kinds of couplers: addresses of their process data, and their watchdog.

use std::ops::RangeInclusive;

use rcs_core::Plain;

/// A kind of coupler. A new kind needs its registers, an emulation and tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Kind {
    /// Beckhoff BK9000 and relatives: Modbus TCP interface in infosys.beckhoff.com, bc9000/2802219403.
    Bk9000,
    /// A device without a watchdog: its outputs hold their last value when the controller is lost.
    Plain,
}

/// Behaviour of the outputs of a device when its watchdog fires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Fallback {
    /// All outputs become 0.
    Zero,
    /// All outputs keep their last value.
    Hold,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// Addresses of the input registers of the process data.
    pub inputs: RangeInclusive<u16>,
    /// Addresses of the output registers of the process data.
    pub outputs: RangeInclusive<u16>,
    /// One request can write outputs and read inputs (function 23).
    pub has_read_write: bool,
    /// Possible behaviours when the watchdog fires; without a watchdog only [`Fallback::Hold`].
    pub fallbacks: &'static [Fallback],
    /// The watchdog times that can be set, ms; `None` without a watchdog.
    pub watchdog_ms: Option<RangeInclusive<u16>>,
}

impl Kind {
    /// The kind with the name that mapping files use.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::from_text(name)
    }

    #[must_use]
    pub const fn facts(self) -> Facts {
        match self {
            Self::Bk9000 => Facts {
                inputs: 0x0000..=0x00FF,
                outputs: 0x0800..=0x08FF,
                has_read_write: true,
                fallbacks: &[Fallback::Zero],
                // 0 would switch the watchdog off.
                watchdog_ms: Some(1..=u16::MAX),
            },
            Self::Plain => Facts {
                inputs: 0..=u16::MAX,
                outputs: 0..=u16::MAX,
                has_read_write: false,
                fallbacks: &[Fallback::Hold],
                watchdog_ms: None,
            },
        }
    }
}

/// Registers of a [`Kind::Bk9000`].
pub mod bk9000 {
    /// Identification of the coupler, seven registers: text, two characters per register.
    pub const IDENTITY: u16 = 0x1000;
    /// Status of the coupler's terminals; 0 without an error.
    pub const STATUS: u16 = 0x100C;
    /// Lengths of the process data in bits, four registers: analog outputs, analog inputs, digital outputs, digital
    /// inputs.
    pub const LENGTHS: u16 = 0x1010;
    /// Time that the watchdog has left, ms.
    pub const WATCHDOG_LEFT: u16 = 0x1020;
    /// Time of the watchdog, ms; 0 switches it off. It can be written only while the watchdog is not active.
    pub const WATCHDOG_MS: u16 = 0x1120;
    /// Write the two words of [`RESET`] here, one after the other, to reset a watchdog that has fired.
    pub const WATCHDOG_RESET: u16 = 0x1121;
    /// Telegrams that restart the watchdog: [`ANY_TELEGRAM`] or [`WRITE_TELEGRAMS`].
    pub const WATCHDOG_TYPE: u16 = 0x1122;
    /// The words that reset the watchdog.
    pub const RESET: [u16; 2] = [0xBECF, 0xAFFE];
    /// Value of [`WATCHDOG_TYPE`], as delivered.
    pub const ANY_TELEGRAM: u16 = 1;
    /// Value of [`WATCHDOG_TYPE`] that a session sets, so that a client that only reads does not keep outputs on.
    pub const WRITE_TELEGRAMS: u16 = 0;
    /// Time of the watchdog as delivered, ms.
    pub const DELIVERED_MS: u16 = 1000;
}
