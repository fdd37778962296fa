//! Events of couplers in a run.

use std::fmt;

use couplers::Trip;

#[derive(Clone, Debug, PartialEq)]
pub struct FieldEvent {
    pub device: String,
    pub what: FieldChange,
    pub held: Vec<(String, i64)>, // the readings of converters that a stale device keeps, by their points
}

#[derive(Clone, Debug, PartialEq)]
pub enum FieldChange {
    Stale(u32),    // the device has not answered for this time, ms
    Back(u32),     // the device answers again after this time, ms, and continues
    Tripped(Trip), // the outputs of the device are safe until an operator releases it
    Released,
    /// An output that must be off at rest is commanded, the device does not answer, or the safety circuit is open.
    Refused,
    Asks(String),    // a line of the job needs a person
    Message(String), // of a simulated device of the workstation
    /// The run has ended.
    Ended {
        is_confirmed: bool, // the device has confirmed its last outputs
        on: Vec<String>,    // outputs that stay on because they may be on at rest
    },
}

impl FieldEvent {
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match &self.what {
            FieldChange::Stale(_) => "io.stale",
            FieldChange::Back(_) => "io.back",
            FieldChange::Tripped(_) => "io.tripped",
            FieldChange::Released => "io.released",
            FieldChange::Refused => "io.refused",
            FieldChange::Asks(_) => "io.asks",
            FieldChange::Message(_) => "io.message",
            FieldChange::Ended { .. } => "io.ended",
        }
    }
}

impl fmt::Display for FieldEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { device, what, held } = self;
        match what {
            FieldChange::Stale(ms) => {
                write!(f, "{device} has not answered for {ms} ms; its inputs keep their values")?;
                for (index, (point, value)) in held.iter().enumerate() {
                    write!(f, "{} {point} {value}", if index == 0 { ":" } else { "," })?;
                }
                Ok(())
            }
            FieldChange::Back(ms) => write!(f, "{device} answers again after {ms} ms"),
            FieldChange::Tripped(Trip::Gap(ms)) => write!(
                f,
                "{device} was not written for {ms} ms: its outputs are safe until an operator sends `io go {device}`"
            ),
            FieldChange::Tripped(trip) => write!(
                f,
                "{device} is tripped, since {}: its outputs are safe until an operator sends `io go {device}`",
                cause(*trip)
            ),
            FieldChange::Released => write!(f, "{device} is released"),
            FieldChange::Refused => write!(
                f,
                "{device} is not released: it does not answer, an output is on that may not be on at rest, or the \
                 safety circuit is open"
            ),
            FieldChange::Asks(request) => write!(f, "the job waits until a person has done this: {request}"),
            FieldChange::Message(text) => f.write_str(text),
            FieldChange::Ended { is_confirmed: true, on } if on.is_empty() => {
                write!(f, "{device} has confirmed that its outputs are safe")
            }
            FieldChange::Ended { is_confirmed: true, on } => write!(
                f,
                "{device} has confirmed that its outputs are safe, except {}, which may be on at rest and keep their \
                 values until its watchdog fires, if it has one",
                on.join(", ")
            ),
            FieldChange::Ended { is_confirmed: false, .. } => write!(
                f,
                "{device} has not confirmed that its outputs are safe: its watchdog makes them so, if it has one"
            ),
        }
    }
}

/// The reason of a trip, as the end of a sentence.
const fn cause(trip: Trip) -> &'static str {
    match trip {
        Trip::Gap(_) => "it was not written in time",
        Trip::Outputs => "its outputs are not those that were written",
        Trip::Settings => "its settings or its watchdog are not as they were left",
        Trip::Refused(_) => "it refused a request that it had accepted before",
        Trip::Terminals(_) => "its terminals report an error",
        Trip::Frozen => "the counter of its program stands still",
        Trip::NoOrders => "the controller gave no orders",
        Trip::Ordered => "an operator, or the safety circuit, asked for it",
    }
}
