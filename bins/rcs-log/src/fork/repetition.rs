//! A run that repeats a log and compares itself with it, bit for bit.

use interfaces::{CommonMemory, ExternalInputs};
use rcs_core::{Plain, plain::Writer, tick::Tick};
use record::{
    layout::{self, Leaf},
    reader::LoggedTick,
};
use runtime::Run;

use super::ForkError;
use crate::{difference::Trace, story::Moment};

pub struct Repetition {
    pub run: Run,
    pub trace: Trace,
    before: CommonMemory,
    external: Vec<Leaf>,
    memory: Vec<Leaf>,
}

impl Repetition {
    pub fn new(run: Run) -> Self {
        Self {
            run,
            trace: Trace::default(),
            before: CommonMemory::default(),
            external: layout::leaves(ExternalInputs::STRUCT),
            memory: layout::leaves(CommonMemory::STRUCT),
        }
    }

    /// Executes a tick; returns false if the run is over.
    pub fn step(&mut self) -> bool {
        let last = self.run.last_tick();
        let has_next = self.run.step();
        let tick = self.run.last_tick();
        if tick != last {
            let after = *self.run.memory();
            self.trace.note(&Moment {
                tick,
                gap: 0,
                external: *self.run.external_inputs(),
                before: self.before,
                after,
                timing: None,
                world: None,
            });
            self.before = after;
        }
        has_next
    }

    /// Runs up to a tick of the log and compares it with the log.
    pub fn follow(&mut self, logged: &LoggedTick) -> Result<(), ForkError> {
        let mut cell = 0;
        while self.run.last_tick() < logged.tick {
            cell = self.run.cell_digest();
            if !self.step() && self.run.last_tick() < logged.tick {
                return Err(ForkError::Over(self.run.last_tick().0));
            }
        }
        self.compare(logged.tick, logged, cell)
    }

    fn compare(&self, tick: Tick, logged: &LoggedTick, cell: u64) -> Result<(), ForkError> {
        let mut memory = vec![0; CommonMemory::SIZE];
        self.run.memory().encode(&mut Writer::new(&mut memory));
        let mut external = vec![0; ExternalInputs::SIZE];
        self.run.external_inputs().encode(&mut Writer::new(&mut external));
        let differs =
            |field: String, was: String, is: String| Err(ForkError::Differs { tick: tick.0, field, was, is });
        let images = [
            (&self.external, "external.", &logged.external, &external),
            (&self.memory, "", &logged.memory, &memory),
        ];
        for (leaves, prefix, was, is) in images {
            if let Some(leaf) = layout::first_difference(leaves, was, is) {
                return differs(format!("{prefix}{}", leaf.path), leaf.text(was), leaf.text(is));
            }
        }
        match logged.world {
            Some(world) if world != cell => {
                differs("the cell's fingerprint".to_owned(), format!("{world:016x}"), format!("{cell:016x}"))
            }
            _ => Ok(()),
        }
    }
}
