//! Reports of a run to the program that contains it.

use interfaces::{CommonMemory, HwsCommand};
use neighbours::workstation::player::BegunStep;
use rcs_core::tick::Tick;

use crate::event::Event;

/// A finished tick.
#[non_exhaustive]
pub struct TickReport<'a> {
    pub tick: Tick,
    pub line: usize,  // last begun one, 0 before the first
    pub lines: usize, // of the job
    /// Steps that have begun, in order: the first PAUSE, lines of the job and their repetitions, commands of operators.
    pub steps: &'a [BegunStep],
    pub hws: &'a HwsCommand,
    /// Common memory after the tick.
    pub memory: &'a CommonMemory,
}

/// Receives messages, events and each tick, between ticks; it delays the next one. `()` ignores all of them.
pub trait Observer {
    /// A message for the operator: one line, without newline.
    fn message(&mut self, text: &str) {
        let _ = text;
    }

    /// An event of a tick. Events for the operator are also sent as messages.
    fn event(&mut self, tick: Tick, event: &Event) {
        let _ = (tick, event);
    }

    /// Called after each tick.
    fn tick(&mut self, report: &TickReport<'_>) {
        let _ = report;
    }
}

impl Observer for () {}
