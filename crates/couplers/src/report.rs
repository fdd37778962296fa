//! Orders to a session, and its state.

use std::fmt;

use rcs_core::Plain;

use crate::{
    MS,
    link::Fault,
    plan::{InWords, OutWords},
};

/// Mode of a device, as ordered by the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Mode {
    /// Connect, set up and read; write nothing.
    Watch,
    /// Write the outputs.
    Run,
    /// Write the safe outputs. The device is tripped until it is released.
    Safe,
    /// Write the final outputs, read them back, and disconnect.
    End,
}

/// Orders of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Orders {
    /// Number of the tick. If it does not change, the session has lost its controller.
    pub tick: u64,
    /// Mode of the device.
    pub mode: Mode,
    /// Number of releases so far: a change releases a tripped device.
    pub go: u32,
    /// The outputs, for [`Mode::Run`].
    pub words: OutWords,
}

/// State of a device.
///
/// ```text
///   Starting ──setup──► Running ◄──back in time── Stale
///                        │   └──stale_ms──────────►│
///                   trip ▼                         ▼ trip
///                     Tripped ──released──► Running
///   no orders: any ──► Silent ──orders──► Tripped
///   Mode::End: any ──► Ended
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum State {
    /// Not set up yet; nothing has been written.
    Starting,
    /// The outputs of the orders are written.
    Running,
    /// No answer for the plan's `stale_ms`.
    Stale,
    /// The safe outputs are written until an operator releases the device.
    Tripped(Trip),
    /// No orders for three ticks: the safe outputs were written once.
    Silent,
    /// The run has ended. True if the outputs were read back as written.
    Ended(bool),
}

impl State {
    /// The state as a word, in logs and messages.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Running => "running",
            Self::Stale => "stale",
            Self::Tripped(_) => "tripped",
            Self::Silent => "silent",
            Self::Ended(_) => "ended",
        }
    }
}

/// Why a device is tripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Trip {
    /// It was not written for this many ms, so its watchdog has fired or another limit has passed.
    Gap(u32),
    /// Its outputs are not those that were written last.
    Outputs,
    /// Its settings, or the state of its watchdog, are not those that the session left.
    Settings,
    /// It refused a request that it had accepted before, with this exception code.
    Refused(u8),
    /// Its terminals report an error, with this status word.
    Terminals(u16),
    /// The counter of its program no longer changes.
    Frozen,
    /// The controller gave no orders for three ticks.
    NoOrders,
    /// An operator, or the safety circuit, asked for the safe outputs.
    Ordered,
}

/// Why a device is not set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Refusal {
    /// An output is on that may not be on at rest: a bit of `acknowledged` outside of the plan's `rest`.
    OutputsOn,
    /// A register does not have the expected value.
    Register(RegisterFault),
    /// It has fewer bits of inputs or outputs than the plan needs.
    Lengths(Lengths),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutputsOn => f.write_str("outputs are on that may not be on at rest"),
            Self::Register(RegisterFault { address, expected, found }) => {
                write!(f, "register {address:#06x} is {found}, and {expected} was expected")
            }
            Self::Lengths(lengths) => write!(
                f,
                "it has {} bits of inputs and {} of outputs, and the mapping needs {} and {}",
                lengths.inputs_found,
                lengths.outputs_found,
                lengths.inputs_expected,
                lengths.outputs_expected
            ),
        }
    }
}

/// A register with another value than expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct RegisterFault {
    /// Address of the register.
    pub address: u16,
    /// Value expected.
    pub expected: u16,
    /// Value found.
    pub found: u16,
}

/// Lengths of the process data, bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Lengths {
    /// Inputs that the plan reads.
    pub inputs_expected: u32,
    /// Inputs of the device.
    pub inputs_found: u32,
    /// Outputs that the plan writes.
    pub outputs_expected: u32,
    /// Outputs of the device.
    pub outputs_found: u32,
}

/// Counters since the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Counters {
    /// Exchanges of process data that succeeded.
    pub exchanges: u32,
    /// Requests and connections that failed; each is counted once.
    pub failures: u32,
    /// Connections.
    pub connections: u32,
    /// Connections after which the device continued without a trip.
    pub returns: u32,
    /// Trips.
    pub trips: u32,
    /// Releases that were refused, because an output was on that may not be on at rest, or the device was absent.
    pub refused_releases: u32,
}

/// State of a session.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Report {
    /// State of the device.
    pub state: State,
    /// Why it is not set up.
    pub refusal: Option<Refusal>,
    /// Earliest time at which the inputs can have been sampled, ns: the time of their request. `None` before an answer.
    pub read_at: Option<u64>,
    /// The newest inputs.
    pub inputs: InWords,
    /// The outputs that the device acknowledged last, or had at the start.
    pub acknowledged: OutWords,
    /// The last fault of the connection.
    pub fault: Option<Fault>,
    /// Counters.
    pub counters: Counters,
}

impl Report {
    /// The report of a session that has not connected yet.
    pub const STARTING: Self = Self {
        state: State::Starting,
        refusal: None,
        read_at: None,
        inputs: InWords::ZERO,
        acknowledged: OutWords::ZERO,
        fault: None,
        counters: Counters::ZERO,
    };

    /// Age of the inputs at the time `now`, ns; `None` before the first answer.
    #[must_use]
    pub fn age(&self, now: u64) -> Option<u64> {
        self.read_at.map(|read_at| now.saturating_sub(read_at))
    }

    /// True if inputs with the limit `stale_ms` may be used at the time `now`.
    #[must_use]
    pub fn is_valid(&self, now: u64, stale_ms: u16) -> bool {
        let stands = matches!(self.state, State::Tripped(Trip::Frozen | Trip::Terminals(_)));
        !stands && self.age(now).is_some_and(|age| age <= u64::from(stale_ms) * MS)
    }
}
