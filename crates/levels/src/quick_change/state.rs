//! What Quick Change remembers from tick to tick.

use rcs_core::{coded_enum, interface::quick_change::QuickChangeVerb, record, tick::Tick};

use crate::execution::Execution;

coded_enum! {
    /// Where the locking ring is.
    pub enum Ring {
        /// No reading has counted yet.
        Unread = "unread",
        /// Locked.
        Locked = "locked",
        /// Unlocked.
        Unlocked = "unlocked",
        /// Seen by neither sensor: on its way, or stuck.
        Between = "between",
        /// Seen by both sensors, which cannot be.
        Both = "both",
    }
}

record! {
    /// Everything that Quick Change remembers.
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
}
