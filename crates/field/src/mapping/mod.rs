//! The mapping file: at which word of which device each point is.
//!
//! ```toml
//! form = 1
//!
//! [device.arm]
//! address = "192.168.10.20:502"       # numeric: resolving a name would allocate
//! unit = 1
//! kind = "bk9000"                     # one of couplers::Kind
//! fallback = "zero"                   # what its outputs do when its watchdog fires
//! watchdog_ms = 500
//!
//! [in]
//! "grip.potentiometer"  = { at = "arm input 0", raw = [0, 32767], counts = [0, 4095] }
//! "quick-change.locked" = { at = "arm input 8.8" }           # bit 8 of register 8
//! "beam.1"              = { fixed = 0 }                      # there is no such sensor
//!
//! [out]
//! "tool.close"          = { at = "arm holding 0x800.11", safe = 0, rest = true }
//!
//! [groups]
//! pedestal = "absent"                 # or "simulated", which is what a group without points is
//!
//! [[line]]                            # how the devices execute a line of a job
//! line = "vise close PFIXTURE"
//! sets = { "vise.PFIXTURE.close" = 1 }
//! done = ["vise.PFIXTURE.clamped", "!vise.PFIXTURE.opened"]
//! within_s = 10
//! ```
//!
//! A group of devices is mapped whole or not at all. Parsing reports all mistakes of a file at once.

mod check;
mod form;
mod place;

use std::{net::SocketAddr, ops::RangeInclusive};

use couplers::{InWords, OutWords, Plan};
use diagnostics::{
    Diagnostics, Source,
    toml::{Document, FileKind},
};
use interfaces::point::{Group, Input, Kind, Output};

use self::form::Sheet;
use crate::{
    lines::Sequence,
    scale::{Format, Line},
};

pub(crate) const KIND: FileKind = FileKind {
    whole: "the file",
    syntax: "field.syntax",
    key: "field.key",
    missing: "field.missing",
    value: "field.value",
    magnitudes: [1e-6, 1e10],
};

const FORM: u32 = 1; // the form of the file that this version reads

#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    pub name: String,
    pub devices: Vec<Device>, // the devices, in the order of their names
    pub inputs: Vec<InPoint>,
    pub outputs: Vec<OutPoint>,
    pub lines: Vec<Sequence>,       // how the devices execute lines of jobs
    pub holds: Vec<(Group, Holds)>, // what keeps a part gripped while the outputs of a group are off
    /// How each group of devices is present, in the order of [`Group::ALL`].
    presence: [Presence; Group::ALL.len()],
}

#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    pub name: String,
    pub address: SocketAddr,
    pub exchange_ms: u16, // time between two exchanges, ms
    pub timeout_ms: u16,  // time for an answer, ms
    pub plan: Plan,       // plan of the connection: address, process data, watchdog
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    Mapped,
    Fixed,  // all its inputs have a fixed value
    Absent, // it does not exist: jobs that need it are refused
    Simulated,
}

impl Presence {
    /// Its word in mapping files and messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mapped => "mapped",
            Self::Fixed => "fixed",
            Self::Absent => "absent",
            Self::Simulated => "simulated",
        }
    }
}

/// What keeps a part gripped while the output is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    TrappedAir,
    CheckValve,
    Bistable,
    Spring,  // closes the fingers
    Nothing, // the fingers open
}

impl Holds {
    pub const ALL: [Self; 5] =
        [Self::TrappedAir, Self::CheckValve, Self::Bistable, Self::Spring, Self::Nothing];

    /// Its word in mapping files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::TrappedAir => "trapped-air",
            Self::CheckValve => "check-valve",
            Self::Bistable => "bistable",
            Self::Spring => "spring",
            Self::Nothing => "nothing",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Slot {
    pub device: usize,
    pub word: usize, // index of the word in its image; of the first one of two
    pub bit: Option<u8>,
    pub format: Format,
    pub low_first: bool, // of two words the low one is first
    pub invert: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<T> {
    Word(T),
    Station,
}

#[derive(Clone, Debug, PartialEq)]
pub struct InPoint {
    pub name: String,
    pub target: Target<Input>,
    pub stale_ms: u16, // age after which it is stale, ms
    pub(crate) group: Group,
    pub(crate) from: Origin,
    pub(crate) range: RangeInclusive<i64>,
    pub(crate) line: Option<Line>,
    pub(crate) by_gripper: [Option<Line>; 3], // the lines of the grippers 1 to 3, where they differ
    pub(crate) then: Option<i64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    Slot(Slot),
    Fixed(i64), // it never changes
}

impl InPoint {
    /// The device that has it; none for a fixed value.
    #[must_use]
    pub const fn device(&self) -> Option<usize> {
        match self.from {
            Origin::Slot(slot) => Some(slot.device),
            Origin::Fixed(_) => None,
        }
    }

    /// Its raw value in the image of its device; `None` for a fixed value.
    #[must_use]
    pub fn raw(&self, image: &InWords) -> Option<i64> {
        match self.from {
            Origin::Slot(slot) => Some(slot.get(&image.words)),
            Origin::Fixed(_) => None,
        }
    }

    /// Its value if it never changes.
    #[must_use]
    pub const fn fixed(&self) -> Option<i64> {
        match self.from {
            Origin::Slot(_) => None,
            Origin::Fixed(value) => Some(value),
        }
    }

    /// The line from raw values to counts, if it has one for all grippers.
    #[must_use]
    pub const fn line(&self) -> Option<Line> {
        self.line
    }

    /// True for an input of vise, machine, drum, trays or supply.
    pub(crate) const fn is_station(&self) -> bool {
        matches!(self.target, Target::Station)
    }

    /// The ends of a converter, which mean a broken wire.
    pub(crate) fn ends(&self) -> Option<&RangeInclusive<i64>> {
        match self.target {
            Target::Word(input) if matches!(input.kind(), Kind::Converter | Kind::Force) => Some(&self.range),
            _ => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct OutPoint {
    pub name: String,
    pub target: Target<Output>,
    pub safe: i64,  // value at the start, at the end, and when the controller is lost
    pub rest: bool, // it may be on while nothing moves
    pub(crate) group: Group,
    pub(crate) slot: Slot,
    pub(crate) range: RangeInclusive<i64>,
}

impl OutPoint {
    #[must_use]
    pub fn is_of(&self, group: Group) -> bool {
        self.group == group
    }

    /// True for an output to vise, machine or drum.
    pub(crate) const fn is_station(&self) -> bool {
        matches!(self.target, Target::Station)
    }

    /// True for a lamp of the joystick box, which moves nothing.
    #[must_use]
    pub fn is_lamp(&self) -> bool {
        self.group == Group::Joystick
    }

    #[must_use]
    pub const fn device(&self) -> usize {
        self.slot.device
    }

    #[must_use]
    pub fn get(&self, image: &OutWords) -> i64 {
        self.slot.get(&image.words)
    }

    pub fn set(&self, value: i64, image: &mut OutWords) {
        self.slot.put(&mut image.words, value);
    }
}

impl Mapping {
    /// Reads a mapping. Errors: all mistakes of the file, each with its line.
    pub fn parse(source: &Source) -> Result<Self, Diagnostics> {
        let mut built = None;
        Document::load(source, KIND, |sheet: &Sheet, stand_ins, problems| {
            built = Some(check::build(sheet, stand_ins, problems));
        })?;
        // Without a problem, `built` is a mapping.
        Ok(built.unwrap_or_else(Self::nothing))
    }

    fn nothing() -> Self {
        Self {
            name: String::new(),
            devices: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            lines: Vec::new(),
            holds: Vec::new(),
            presence: [Presence::Simulated; Group::ALL.len()],
        }
    }

    #[must_use]
    pub fn presence(&self, group: Group) -> Presence {
        let all = Group::ALL.iter().zip(self.presence);
        all.filter(|(one, _)| **one == group)
            .map(|(_, presence)| presence)
            .next()
            .unwrap_or(Presence::Simulated)
    }

    pub fn groups(&self, presence: Presence) -> impl Iterator<Item = Group> {
        Group::ALL.into_iter().filter(move |group| self.presence(*group) == presence)
    }

    #[must_use]
    pub fn device(&self, name: &str) -> Option<usize> {
        self.devices.iter().position(|device| device.name == name)
    }
}

#[cfg(test)]
mod tests;
