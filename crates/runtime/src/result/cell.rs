//! The cell in the result: parts, faults, emergencies, items and events.

use std::fmt;

use closed_loop::workstation::Emergency;
use neighbours::data_system::Item;
use plant::fault::Struck;
use rcs_core::tick::Tick;
use serde::Serialize;

use crate::event::Event;

/// A fault of the cell that has occurred.
#[derive(Clone, Debug, Serialize)]
pub struct CellFaultResult {
    /// Number in its file, from 1.
    pub number: usize,
    pub text: String,
    /// Number of times that it began.
    pub times: u64,
    /// The tick in which it began for the first time.
    pub first: u64,
    /// The last tick in which it was active.
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

#[derive(Clone, Debug, Serialize)]
pub struct ContactResult {
    pub mover: String,
    pub obstacle: String,
    pub depth_in: f64,
}

/// The last loss of hydraulic pressure in an emergency, and the place where the arm came to rest.
#[derive(Clone, Debug, Serialize)]
pub struct EmergencyResult {
    /// Tick in which the pressure was lost.
    pub tick: u64,
    /// Cause of the stop: a person's action or a failure.
    pub cause: String,
    /// Position of the tool point, in.
    pub position_in: [f64; 3],
    /// True if the arm is at rest.
    pub at_rest: bool,
    /// True if the shot pin has stopped the shoulder.
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

/// Position of an item according to the Data System.
#[derive(Clone, Debug, Serialize)]
pub struct ItemResult {
    pub item: String,
    /// Its serial number; empty if the commands contained none.
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
    pub tick: u64,
    /// Stable short name of its kind, such as `cell.dropped`.
    pub code: &'static str,
    pub text: String,
}

impl fmt::Display for EventResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tick {}: {}", self.tick, self.text)
    }
}

/// Number of stored events, so that a run of a year does not exhaust the memory. The log has all of them.
const REMEMBERED: usize = 1000;

/// Events of a run in the cell and with the neighbours.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Events {
    pub count: usize,
    /// The first thousand events.
    pub first: Vec<EventResult>,
}

impl Events {
    /// Add an event of a tick.
    pub fn push(&mut self, tick: Tick, event: &Event) {
        self.count += 1;
        if self.first.len() < REMEMBERED {
            self.first.push(EventResult { tick: tick.0, code: event.code(), text: event.to_string() });
        }
    }
}
