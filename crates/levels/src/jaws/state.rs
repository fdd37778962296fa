//! What V-Grip and Tool-Grip remember from tick to tick.

use rcs_core::{
    Plain,
    interface::{
        device::JawValves,
        jaws::{JawsReport, JawsVerb},
    },
    tick::Tick,
};

use crate::old_execution::Execution;

/// Readings that are kept: fingers that stand still read the same in all of them.
pub(super) const WINDOW: usize = 4;

/// Everything that V-Grip or Tool-Grip remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command number, its outcome and its step.
    pub execution: Execution,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub verb: JawsVerb,
    /// `commanded-size` of the last command that had one, 0.01 in; 0 before.
    pub size: i32,
    /// When the current command began.
    pub since: Tick,
    /// How the current command ended, or the status while it executes.
    pub report: JawsReport,
    /// The gripper was attached in the last tick.
    pub attached: bool,
    /// Potentiometer readings of the last ticks, the newest first.
    pub window: [u16; WINDOW],
    /// Air.
    pub valves: JawValves,
    /// Ticks for which the valves have been as they are.
    pub air_ticks: u8,
}
