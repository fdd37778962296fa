//! What Quick Change remembers from tick to tick.

use rcs_core::{Plain, interface::quick_change::QuickChangeVerb, tick::Tick};

use crate::old_execution::Execution;

/// Where the locking ring is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ring {
    /// No reading has counted yet.
    Unread,
    /// Locked.
    Locked,
    /// Unlocked.
    Unlocked,
    /// Seen by neither sensor: on its way, or stuck.
    Between,
    /// Seen by both sensors, which cannot be.
    Both,
}

/// Everything that Quick Change remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command number, its outcome and its step.
    pub execution: Execution,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: QuickChangeVerb,
    /// When it was begun.
    pub since: Tick,
    /// The reading that counts.
    pub ring: Ring,
    /// The reading of the last tick.
    pub reading: Ring,
    /// Ticks for which it has been the same.
    pub reading_ticks: u8,
    /// The last legal id of the mated gripper.
    pub end_effector_id: u8,
    /// Ticks for which the id has been illegal.
    pub illegal_ticks: u8,
}
