//! E-move and Quick Change (VI.2.2).

use crate::{
    coded_enum,
    handshake::Lower,
    interface::{Header, Reason, device::QuickChangeValves},
    record,
};

coded_enum! {
    /// Commands of Quick Change (VI.2.1).
    pub enum QuickChangeVerb {
        /// None yet.
        None = "",
        /// Do nothing; sensors and id are read.
        Pause = "QC-PAUSE",
        /// Lock, check, disable the port.
        Lock = "QC-LOCK",
        /// Unlock and check.
        Unlock = "QC-UNLOCK",
    }
}

record! {
    /// Command from E-move to Quick Change.
    pub struct QuickChangeCommand {
        /// `command-#-in`.
        pub number: u32,
        /// `"command"`.
        pub command: QuickChangeVerb,
    }
}

coded_enum! {
    /// `status-report` of Quick Change.
    pub enum QuickChangeReport {
        /// Nothing was read yet (extension).
        Idle = "idle",
        /// The command is executing.
        Executing = "executing",
        /// Locked; there may or may not be an end effector.
        Locked = "qc-locked",
        /// Unlocked; there may or may not be an end effector.
        Unlocked = "qc-unlocked",
        /// The sensors contradict each other.
        SensorMalfunction = "qc-sens-malf",
        /// The locking ring is neither fully locked nor unlocked.
        Stuck = "qc-stuck",
    }
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

record! {
    /// Status from Quick Change to E-move.
    pub struct QuickChangeStatus {
        /// `command-#-echo`.
        pub echo: u32,
        /// `status-report`.
        pub report: QuickChangeReport,
        /// `status-para-out`.
        pub reason: Reason,
        /// `endeff-id#`: gripper mated, locked or not; 0 for none.
        pub end_effector_id: u8,
    }
}

record! {
    /// Output buffers of Quick Change.
    pub struct QuickChangeOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To E-move.
        pub status: QuickChangeStatus,
        /// To the valves.
        pub valves: QuickChangeValves,
    }
}
