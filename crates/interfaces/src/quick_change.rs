//! E-move and Quick Change (VI.2.2).

use core::fmt;

use rcs_core::{Plain, handshake::Lower};

use crate::{Header, Reason, device::QuickChangeValves};

/// Commands of Quick Change (VI.2.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum QuickChangeVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing; sensors and id are still read.
    #[text = "QC-PAUSE"]
    Pause,
    /// Lock, check, disable the port.
    #[text = "QC-LOCK"]
    Lock,
    /// Unlock and check.
    #[text = "QC-UNLOCK"]
    Unlock,
}

/// Command from E-move to Quick Change.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command"`.
    pub command: QuickChangeVerb,
}

/// `status-report` of Quick Change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum QuickChangeReport {
    /// No reading yet (extension).
    Idle,
    /// The command is executing.
    Executing,
    /// Locked, with or without an end effector.
    #[text = "qc-locked"]
    Locked,
    /// Unlocked, with or without an end effector.
    #[text = "qc-unlocked"]
    Unlocked,
    /// The sensors contradict each other.
    #[text = "qc-sens-malf"]
    SensorMalfunction,
    /// The locking ring is neither fully locked nor unlocked.
    #[text = "qc-stuck"]
    Stuck,
}

impl QuickChangeReport {
    /// The report as a state variable of E-move.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Locked | Self::Unlocked => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::SensorMalfunction | Self::Stuck => Lower::Error,
        }
    }
}

/// Position of the locking ring by its two sensors (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum RingPosition {
    /// Not read yet.
    Unread,
    /// Locked.
    Locked,
    /// Unlocked.
    Unlocked,
    /// Seen by neither sensor: in motion or stuck half open.
    Between,
    /// Seen by both sensors, which is impossible.
    Implausible,
}

/// Status from Quick Change to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeStatus {
    /// `command-#-echo`.
    pub echo: u32,
    /// `status-report`.
    pub report: QuickChangeReport,
    /// `status-para-out`.
    pub reason: Reason,
    /// `endeff-id#`: the mated gripper, locked or not.
    pub end_effector_id: Option<u8>,
    /// Position of the ring in this tick, independent of the last command (extension).
    pub ring: RingPosition,
}

/// Output buffers of Quick Change.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct QuickChangeOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To E-move.
    pub status: QuickChangeStatus,
    /// To the valves.
    pub valves: QuickChangeValves,
}

/// `QC-LOCK`.
impl fmt::Display for QuickChangeCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.command.fmt(f)
    }
}
