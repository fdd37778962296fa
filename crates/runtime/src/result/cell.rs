//! The cell in the result: parts, faults, emergencies, items and events.

use std::fmt;

use neighbours::data_system::Item;
use plant::{PartState, fault::Struck};
use rcs_core::tick::Tick;
use serde::Serialize;

use crate::{event::Event, workstation::Emergency};

/// A fault of the cell that happened.
#[derive(Clone, Debug, Serialize)]
pub struct CellFaultResult {
    /// Which one of its file, from 1.
    pub number: usize,
    /// In words.
    pub text: String,
    /// How often it began.
    pub times: u64,
    /// The tick in which it began first.
    pub first: u64,
    /// The last tick in which it was present.
    pub last: u64,
}

impl From<Struck> for CellFaultResult {
    fn from(Struck { number, text, times, first, last }: Struck) -> Self {
        Self { number, text, times, first, last }
    }
}

impl fmt::Display for CellFaultResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}, ", self.number, self.text)?;
        match self.times {
            1 if self.first == self.last => write!(f, "in tick {}", self.first),
            1 => write!(f, "ticks {} to {}", self.first, self.last),
            times => write!(f, "{times} times, ticks {} to {}", self.first, self.last),
        }
    }
}

/// Two things that have run into each other.
#[derive(Clone, Debug, Serialize)]
pub struct ContactResult {
    /// What moved.
    pub mover: String,
    /// What it has met.
    pub obstacle: String,
    /// How deep at the most, inches.
    pub depth_in: f64,
}

/// The last loss of hydraulic pressure in an emergency, and where the arm came to rest.
#[derive(Clone, Debug, Serialize)]
pub struct EmergencyResult {
    /// Tick in which the pressure went.
    pub tick: u64,
    /// Who stopped the robot, or what failed.
    pub cause: String,
    /// Where the tool point was, inches.
    pub position_in: [f64; 3],
    /// The arm has come to rest.
    pub at_rest: bool,
    /// The shot pin has stopped the shoulder.
    pub on_shot_pin: bool,
    /// Contacts of the sagging arm, the deepest first.
    pub touched: Vec<ContactResult>,
}

impl From<&Emergency> for EmergencyResult {
    fn from(Emergency { tick, droop }: &Emergency) -> Self {
        let touched = droop.touched.iter().map(|contact| ContactResult {
            mover: contact.mover.clone(),
            obstacle: contact.obstacle.clone(),
            depth_in: contact.depth,
        });
        Self {
            tick: tick.0,
            cause: droop.cause.to_string(),
            position_in: droop.position,
            at_rest: droop.at_rest,
            on_shot_pin: droop.on_shot_pin,
            touched: touched.collect(),
        }
    }
}

/// Where a part ended.
#[derive(Clone, Debug, Serialize)]
pub struct PartResult {
    /// Its name at the end.
    pub name: String,
    /// A unit, the vise's location, `gripper`, `floor` or `elsewhere`.
    pub location: String,
    /// Sector of the unit, 0 elsewhere.
    pub sector: u16,
    /// The gripper holds it.
    pub held: bool,
    /// Its middle in world coordinates, inches.
    pub position_in: [f64; 3],
    /// From the centre of its sector, or from its seat in the vise, inches.
    pub error_in: Option<f64>,
}

impl From<PartState> for PartResult {
    fn from(part: PartState) -> Self {
        Self {
            name: part.name,
            location: part.location,
            sector: part.sector,
            held: part.held,
            position_in: part.position,
            error_in: part.error,
        }
    }
}

impl fmt::Display for PartResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} at {}", self.name, self.location)?;
        if self.sector > 0 {
            write!(f, " sector {}", self.sector)?;
        }
        if let Some(error) = self.error_in {
            let from = if self.sector > 0 { "the sector's centre" } else { "its seat" };
            write!(f, ", {error:.2} in from {from}")?;
        }
        let [x, y, z] = self.position_in;
        write!(f, " ({x:.2} {y:.2} {z:.2})")
    }
}

/// Where the Data System believes that an item is.
#[derive(Clone, Debug, Serialize)]
pub struct ItemResult {
    /// Its name.
    pub item: String,
    /// Its serial number; empty if the commands gave none.
    pub serial: String,
    /// A location, or `H_ROBOT` while the robot holds it.
    pub position: String,
    /// Sector there, 0 for none.
    pub sector: u8,
}

impl From<Item> for ItemResult {
    fn from(item: Item) -> Self {
        Self { item: item.name, serial: item.number, position: item.position, sector: item.sector }
    }
}

impl fmt::Display for ItemResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.item)?;
        if !self.serial.is_empty() {
            write!(f, " {}", self.serial)?;
        }
        write!(f, " at {}", self.position)?;
        if self.sector == 0 { Ok(()) } else { write!(f, " sector {}", self.sector) }
    }
}

/// An event and its tick.
#[derive(Clone, Debug, Serialize)]
pub struct EventResult {
    /// The tick.
    pub tick: u64,
    /// Stable short name of its kind, such as `cell.dropped`.
    pub code: &'static str,
    /// In words.
    pub text: String,
}

impl fmt::Display for EventResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tick {}: {}", self.tick, self.text)
    }
}

/// Events that a run remembers; the log has all. A run of a year must not fill the memory.
const REMEMBERED: usize = 1000;

/// Events of a run in the cell and with the neighbours.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Events {
    /// How many events there were.
    pub count: usize,
    /// The first thousand of them.
    pub first: Vec<EventResult>,
}

impl Events {
    /// Something has happened in a tick.
    pub fn push(&mut self, tick: Tick, event: &Event) {
        self.count += 1;
        if self.first.len() < REMEMBERED {
            self.first.push(EventResult { tick: tick.0, code: event.code(), text: event.to_string() });
        }
    }
}
