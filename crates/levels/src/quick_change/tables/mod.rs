//! Decision tables of Quick Change: a file a command.

mod qc_pause;

use rcs_core::{coded_enum, interface::quick_change::QuickChangeReport};

pub use self::qc_pause::{QC_PAUSE, Step, qc_pause};

coded_enum! {
    /// What the id pins of the mated gripper are worth.
    pub enum Id {
        /// The id of a gripper, or of none.
        Legal = "legal",
        /// An id that no gripper has.
        Illegal = "illegal",
    }
}

/// What a row wants of the valves and the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Leave the ring as it is and report.
    Report(QuickChangeReport),
}
