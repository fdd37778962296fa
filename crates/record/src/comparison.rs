//! Compares the ticks of a replay with those of the log, up to the first difference.

use interfaces::CommonMemory;
use levels::ladder::LadderState;
use rcs_core::tick::Tick;

use crate::{
    channels::{HeaderPlace, headers},
    layout::{self, Leaf},
    reader::LoggedTick,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    pub tick: Tick,
    pub buffer: String, // or `state.prim`
    pub field: String,
    pub was: String,
    pub is: String,
    /// The row by which the process decided in the replay.
    pub row: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { tick, buffer, field, was, is, row } = self;
        write!(f, "tick {tick}, buffer {buffer}, field {field}: was {was}, is {is}; {row}")
    }
}

pub struct Comparison {
    memory_leaves: Vec<Leaf>,
    state_leaves: Vec<Leaf>,
    headers: Vec<HeaderPlace>,
}

impl Comparison {
    /// With `by_name`, records are compared by name instead of number, because the task data differ from the log's.
    pub fn new(by_name: bool) -> Self {
        let leaves = |record| {
            let mut leaves = layout::leaves(record);
            leaves.retain(|leaf| !by_name || !leaf.is_record_number());
            leaves
        };
        Self {
            memory_leaves: leaves(CommonMemory::STRUCT),
            state_leaves: leaves(LadderState::STRUCT),
            headers: headers(),
        }
    }

    /// The first difference of a recorded tick from the byte images of common memory and, if recorded, of the states.
    pub fn difference(
        &self,
        logged: &LoggedTick,
        memory: &[u8],
        states: Option<&[u8]>,
    ) -> Option<Difference> {
        let difference = |leaf: &Leaf, buffer: String, field: &str, was: &[u8], is: &[u8]| {
            let (tick, field) = (logged.tick, field.to_owned());
            Difference {
                tick,
                buffer,
                field,
                was: leaf.text(was),
                is: leaf.text(is),
                row: self.row(leaf, memory),
            }
        };
        if let Some(leaf) = layout::first_difference(&self.memory_leaves, &logged.memory, memory) {
            let (buffer, field) = split(&leaf.path);
            return Some(difference(leaf, buffer, &field, &logged.memory, memory));
        }
        let (recorded, states) = logged.state.as_deref().zip(states)?;
        let leaf = layout::first_difference(&self.state_leaves, recorded, states)?;
        let (process, field) = leaf.path.split_once('.').unwrap_or((&leaf.path, ""));
        Some(difference(leaf, format!("state.{process}"), field, recorded, states))
    }

    fn row(&self, leaf: &Leaf, memory: &[u8]) -> String {
        let process = leaf.path.split('.').next().unwrap_or_default();
        let Some(place) = self.headers.iter().find(|place| place.field == process) else {
            return String::new();
        };
        match place.fired(&place.read(memory)) {
            Some(fired) => format!("{} decided by {fired}", place.process.name),
            None => format!("{} decided by no row", place.process.name),
        }
    }
}

/// The first two names of a path, and the rest: `prim.status`, `distance`.
fn split(path: &str) -> (String, String) {
    let mut parts = path.splitn(3, '.');
    let buffer: Vec<&str> = parts.by_ref().take(2).collect();
    (buffer.join("."), parts.next().unwrap_or_default().to_owned())
}
