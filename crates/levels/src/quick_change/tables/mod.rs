//! Decision tables of Quick Change: a file a command.

mod qc_lock;
mod qc_pause;
mod qc_unlock;

use rcs_core::{Plain, interface::quick_change::QuickChangeReport};

pub use self::{
    qc_lock::{QC_LOCK, qc_lock},
    qc_pause::{QC_PAUSE, qc_pause},
    qc_unlock::{QC_UNLOCK, qc_unlock},
};

/// Reference action of all commands: it outlasts the command, so that a failure is reported until the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Watching the sensors.
    Watch,
    /// The ring turns.
    Turn,
    /// The ring did not arrive in time.
    Stuck,
    /// The sensors failed on the way.
    Faulty,
}

/// What the id pins of the mated gripper are worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Id {
    /// The id of a gripper, or of none.
    Legal,
    /// An id that no gripper has.
    Illegal,
}

/// Time for which the ring has been turning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// Within the limit.
    Running,
    /// Over the limit.
    Expired,
}

/// What a row wants of the valves and the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Leave the ring as it is and report.
    Report(QuickChangeReport),
    /// Enable the port and turn the ring towards locked.
    Lock,
    /// Enable the port and turn the ring towards unlocked.
    Unlock,
    /// Disable the port: the command has failed with this status.
    Fail(QuickChangeReport),
}
