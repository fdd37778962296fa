use std::fmt;

use closed_loop::workstation::Emergency;
use neighbours::data_system::Item;
use plant::fault::FaultResult;
use rcs_core::tick::Tick;
use serde::Serialize;

use crate::event::Event;

#[derive(Clone, Debug, Serialize)]
pub struct CellFaultResult {
    pub number: usize, // in its file, from 1
    pub text: String,
    pub times: u64, // it began
    pub first: u64, // tick in which it began first
    pub last: u64,  // last tick in which it was active
}

impl From<FaultResult> for CellFaultResult {
    fn from(FaultResult { number, text, times, first, last }: FaultResult) -> Self {
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
    pub tick: u64,             // of the loss of pressure
    pub cause: String,         // a person's action or a failure
    pub position_in: [f64; 3], // position of the tool point, in
    pub at_rest: bool,
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
    pub serial: String, // empty if the commands contained none
    /// A location, or `H_ROBOT` while the robot holds it.
    pub position: String,
    pub sector: u8, // 0 for none
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

#[derive(Clone, Debug, Default, Serialize)]
pub struct Events {
    pub count: usize,
    /// The first thousand events.
    pub first: Vec<EventResult>,
}

impl Events {
    pub fn push(&mut self, tick: Tick, event: &Event) {
        self.count += 1;
        if self.first.len() < REMEMBERED {
            self.first.push(EventResult { tick: tick.0, code: event.code(), text: event.to_string() });
        }
    }
}
