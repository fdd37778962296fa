use interfaces::quick_change::{QuickChangeVerb, RingPosition};
use rcs_core::{Plain, tick::Tick};

use super::tables::Step;
use crate::execution::Execution;

/// State of Quick Change.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of E-move and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: QuickChangeVerb,
    /// When it came.
    pub since: Tick,
    /// The valid reading.
    pub ring: RingPosition,
    /// The sensor reading of this tick.
    pub reading: RingPosition,
    /// Ticks for which it has been the same.
    pub reading_ticks: u8,
    /// The last legal `endeff-id#` of a mated gripper.
    pub end_effector_id: Option<u8>,
    /// Ticks for which the id has been illegal.
    pub illegal_ticks: u8,
}
