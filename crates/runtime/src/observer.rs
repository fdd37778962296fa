//! Reports of a run to the program that contains it.

use interfaces::{CommonMemory, HwsCommand};
use neighbours::workstation::player::BegunStep;
use rcs_core::tick::Tick;

use crate::event::Event;

/// A finished tick.
#[non_exhaustive]
pub struct TickReport<'a> {
    /// The tick.
    pub tick: Tick,
    /// Number of lines of the job; the PAUSE with which the player begins is a step more.
    pub lines: usize,
    /// Steps of the job that have begun, in their order.
    pub steps: &'a [BegunStep],
    /// The command to Task.
    pub hws: &'a HwsCommand,
    /// All buffers.
    pub memory: &'a CommonMemory,
}

/// Receives messages, events and each tick. Calls are made between ticks and delay the next one. `()` ignores
/// everything.
pub trait Observer {
    /// A message for the person at the run: one line, without its end.
    fn message(&mut self, text: &str) {
        let _ = text;
    }

    /// An event of a tick; if a person at the run should read it, it also comes as a message.
    fn event(&mut self, tick: Tick, event: &Event) {
        let _ = (tick, event);
    }

    /// A tick is over.
    fn tick(&mut self, report: &TickReport<'_>) {
        let _ = report;
    }
}

impl Observer for () {}
