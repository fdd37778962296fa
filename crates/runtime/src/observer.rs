//! What a run tells the program that it is a part of.

use interfaces::{CommonMemory, HwsCommand};
use neighbours::workstation::player::BegunStep;
use rcs_core::tick::Tick;

use crate::event::Event;

/// A tick that is over.
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

/// Hears messages and events and sees each tick. It is called between the ticks, and delays the next one for as long as it
/// takes. `()` ignores everything.
pub trait Observer {
    /// A message for the person at the run: one line, without its end.
    fn message(&mut self, text: &str) {
        let _ = text;
    }

    /// Something has happened in a tick; what a person at the run is to read of it comes as a message, too.
    fn event(&mut self, tick: Tick, event: &Event) {
        let _ = (tick, event);
    }

    /// A tick is over.
    fn tick(&mut self, report: &TickReport<'_>) {
        let _ = report;
    }
}

impl Observer for () {}
