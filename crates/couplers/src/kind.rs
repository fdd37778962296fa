//! Kinds of couplers, as data: addresses of their process data, their watchdog, and their limits. A session interprets
//! the data. SPECNOTES.md of the repository lists what the manuals leave open.

use std::ops::RangeInclusive;

use modbus::request::{MOST_WRITTEN_BITS, MOST_WRITTEN_WORDS};
use rcs_core::Plain;

/// A kind of coupler. A new kind needs its [`Facts`], its watchdog in [`crate::emulated`], and tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Kind {
    /// Beckhoff BK9000 and relatives: infosys.beckhoff.com, bc9000/2802219403.
    Bk9000,
    /// Beckhoff EK9000: infosys.beckhoff.com, ek9000/2743153419, 2743146507 and 2743155979.
    Ek9000,
    /// WAGO 750 with Modbus TCP: manual 750-3xx ETHERNET TCP/IP, sections 4.2.4 and 6.5.1.
    Wago,
    /// Turck FGEN, TBEN and relatives: manual D301271, sections 9.3 and 9.5.
    Turck,
    /// A device whose watchdog and safe values are set with the tool of its maker, such as Moxa ioThinx 4510.
    Values,
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
    /// Each output gets the value that is set in the device.
    Values,
}

#[derive(Debug)]
pub struct Facts {
    /// Addresses of the input registers of the process data.
    pub inputs: RangeInclusive<u16>,
    /// Addresses at which the output registers are both written and read back.
    pub outputs: RangeInclusive<u16>,
    /// Addresses at which the coils of outputs are both written and read back.
    pub coils: RangeInclusive<u16>,
    /// Most output registers and coils that one request can write.
    pub most_written: (u16, u16),
    /// One request can write outputs and read inputs (function 23), and restarts the watchdog.
    pub has_read_write: bool,
    /// Only the connection that wrote last may write, until half the time of the watchdog has passed.
    pub has_write_lock: bool,
    /// Possible behaviours when the watchdog fires; without a watchdog only [`Fallback::Hold`].
    pub fallbacks: &'static [Fallback],
    pub watchdog: Option<Watchdog>,
    /// First of four registers with the lengths of the process data, bits: analog outputs, analog inputs, digital
    /// outputs, digital inputs.
    pub lengths: Option<u16>,
    pub status: Option<Status>,
    /// First register and number of registers of a text by which the coupler identifies itself.
    pub identity: Option<(u16, u16)>,
}

/// A register in which a coupler reports errors of its terminals.
#[derive(Debug)]
pub struct Status {
    pub register: u16,
    /// The bits that report errors, and their value without one.
    pub mask: u16,
    pub good: u16,
}

#[derive(Debug)]
pub struct Watchdog {
    /// The times that can be set, ms.
    pub times_ms: RangeInclusive<u16>,
    /// The times are multiples of this; a register of the time counts in it.
    pub step_ms: u16,
    /// Registers that a session sets and reads back while the watchdog is not running.
    pub settings: &'static [Setting],
    /// Registers and values that reset a watchdog that has fired.
    pub reset: &'static [(u16, u16)],
    /// A register that starts the watchdog when its value changes. Without one the first write of outputs starts it.
    pub start: Option<u16>,
    /// Register of its state: 0 when stopped, 1 while it is running.
    pub running: Option<u16>,
    /// Register that counts how often it has fired.
    pub count: Option<u16>,
    /// A register, and its value once the watchdog has fired.
    pub fired: Option<(u16, u16)>,
    /// A coupler whose watchdog has fired refuses every request but the reset, reading as well.
    pub refuses_all: bool,
}

/// A register that a session sets.
#[derive(Debug)]
pub struct Setting {
    pub register: u16,
    pub value: Value,
    /// The value as delivered, for the emulated coupler.
    pub delivered: u16,
}

#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// The time of the watchdog, in its step.
    Time,
    /// 0 for [`Fallback::Zero`], 1 for [`Fallback::Hold`].
    Fallback,
    Fixed(u16),
}

impl Watchdog {
    /// The registers that a session sets, with their values.
    pub fn settings(&self, time_ms: u16, fallback: Fallback) -> impl Iterator<Item = (u16, u16)> {
        self.settings.iter().map(move |setting| {
            let value = match setting.value {
                Value::Time => time_ms / self.step_ms,
                Value::Fallback => u16::from(fallback == Fallback::Hold),
                Value::Fixed(value) => value,
            };
            (setting.register, value)
        })
    }
}

/// The words BECF and AFFE, one after the other, reset a watchdog that has fired.
const BECKHOFF_RESET: &[(u16, u16)] = &[(0x1121, 0xBECF), (0x1121, 0xAFFE)];
/// Only writes of outputs restart the watchdog, so that a client that only reads does not keep outputs on.
const WRITES_ONLY: Setting = Setting { register: 0x1122, value: Value::Fixed(0), delivered: 1 };
const ANY: RangeInclusive<u16> = 0..=u16::MAX;
/// Most registers and coils that the protocol permits.
const MOST_WRITTEN: (u16, u16) = (MOST_WRITTEN_WORDS, MOST_WRITTEN_BITS);

const BK9000: Facts = Facts {
    inputs: 0x0000..=0x00FF,
    outputs: 0x0800..=0x08FF,
    coils: ANY,
    most_written: MOST_WRITTEN,
    has_read_write: true,
    has_write_lock: false,
    fallbacks: &[Fallback::Zero],
    watchdog: Some(Watchdog {
        // 0 would switch the watchdog off.
        times_ms: 1..=u16::MAX,
        step_ms: 1,
        settings: &[Setting { register: 0x1120, value: Value::Time, delivered: 1000 }, WRITES_ONLY],
        reset: BECKHOFF_RESET,
        start: None,
        running: None,
        count: None,
        fired: Some((0x1020, 0)),
        refuses_all: false,
    }),
    lengths: Some(0x1010),
    status: Some(Status { register: 0x100C, mask: u16::MAX, good: 0 }),
    identity: Some((0x1000, 7)),
};

const EK9000: Facts = Facts {
    has_write_lock: true,
    fallbacks: &[Fallback::Zero, Fallback::Hold],
    watchdog: Some(Watchdog {
        // The maker advises against less than 500 ms.
        times_ms: 500..=60_000,
        step_ms: 1,
        settings: &[
            Setting { register: 0x1120, value: Value::Time, delivered: 1000 },
            WRITES_ONLY,
            Setting { register: 0x1123, value: Value::Fallback, delivered: 0 },
            // Without the lock, only the writes of the first connection would restart the watchdog.
            Setting { register: 0x1124, value: Value::Fixed(1), delivered: 1 },
        ],
        reset: BECKHOFF_RESET,
        start: None,
        running: None,
        count: Some(0x1021),
        fired: Some((0x1020, 0)),
        refuses_all: false,
    }),
    // State of the bus: 1 without an error.
    status: Some(Status { register: 0x1040, mask: u16::MAX, good: 1 }),
    ..BK9000
};

const WAGO: Facts = Facts {
    inputs: 0x0000..=0x00FF,
    // Outputs can be written from 0 as well, but there the inputs are read.
    outputs: 0x0200..=0x02FF,
    coils: 0x0200..=0x03FF,
    most_written: (100, 800),
    // Function 23 does not restart the watchdog of old firmware.
    has_read_write: false,
    has_write_lock: false,
    fallbacks: &[Fallback::Zero],
    watchdog: Some(Watchdog {
        times_ms: 100..=65_500,
        step_ms: 100,
        settings: &[
            Setting { register: 0x1000, value: Value::Time, delivered: 100 },
            // Functions that restart it, bit 0 for function 1: only 15 and 16. Then functions 17 to 32: none.
            Setting { register: 0x1001, value: Value::Fixed(0xC000), delivered: 0xFFFF },
            Setting { register: 0x1002, value: Value::Fixed(0), delivered: 0xFFFF },
        ],
        // Stops a running watchdog, too.
        reset: &[(0x1008, 0xAA55)],
        start: Some(0x1003),
        running: Some(0x1006),
        count: None,
        fired: Some((0x1006, 2)),
        refuses_all: true,
    }),
    lengths: Some(0x1022),
    // Code of the error that the coupler's lamp shows: 0 without one.
    status: Some(Status { register: 0x1020, mask: u16::MAX, good: 0 }),
    identity: Some((0x2020, 16)),
};

const TURCK: Facts = Facts {
    inputs: 0x0000..=0x01FF,
    outputs: 0x0800..=0x09FF,
    watchdog: Some(Watchdog {
        // As delivered it is 0: off, and the outputs hold their values.
        times_ms: 1..=u16::MAX,
        step_ms: 1,
        settings: &[Setting { register: 0x1120, value: Value::Time, delivered: 0 }],
        reset: &[],
        start: None,
        running: None,
        count: None,
        fired: Some((0x1020, 0)),
        refuses_all: false,
    }),
    // Block devices differ in the registers that they have.
    lengths: None,
    // Forced outputs (14), configuration (11), module bus (10), supply of the system (9) and of the outputs (7). Bit 0
    // only announces messages.
    status: Some(Status { register: 0x100C, mask: 0x4E80, good: 0 }),
    ..BK9000
};

const VALUES: Facts = Facts {
    fallbacks: &[Fallback::Values, Fallback::Hold],
    watchdog: Some(Watchdog {
        times_ms: 1000..=65_000,
        step_ms: 1000,
        settings: &[],
        reset: &[],
        start: None,
        running: None,
        count: None,
        fired: None,
        refuses_all: false,
    }),
    ..PLAIN
};

const PLAIN: Facts = Facts {
    inputs: ANY,
    outputs: ANY,
    coils: ANY,
    most_written: MOST_WRITTEN,
    has_read_write: false,
    has_write_lock: false,
    fallbacks: &[Fallback::Hold],
    watchdog: None,
    lengths: None,
    status: None,
    identity: None,
};

impl Kind {
    #[must_use]
    pub const fn facts(self) -> &'static Facts {
        match self {
            Self::Bk9000 => &BK9000,
            Self::Ek9000 => &EK9000,
            Self::Wago => &WAGO,
            Self::Turck => &TURCK,
            Self::Values => &VALUES,
            Self::Plain => &PLAIN,
        }
    }
}
