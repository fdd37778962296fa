//! E-move and the grippers that open and close: V-Grip and Tool-Grip (VI.4.2, VI.5).
//!
//! TG-LEVEL is VG-LEVEL with other parameters and "TG" for "VG", so that both have the same buffers.

use crate::{
    coded_enum,
    handshake::Lower,
    interface::{Header, Reason, device::JawValves},
    record,
};

coded_enum! {
    /// Commands of V-Grip and Tool-Grip (VI.4.1), without the prefix VG or TG.
    pub enum JawsVerb {
        /// None yet.
        None = "",
        /// VG-PAUSE, TG-PAUSE: leave the valves as they are and read the potentiometer.
        Pause = "PAUSE",
        /// VG-GRASP, TG-GRASP: close.
        Grasp = "GRASP",
        /// VG-RELEASE, TG-RELEASE: open.
        Release = "RELEASE",
        /// VGRIP-POSE, TGRIP-POSE: open, as RELEASE.
        Pose = "POSE",
    }
}

record! {
    /// Command from E-move to V-Grip or Tool-Grip.
    pub struct JawsCommand {
        /// `command-#-in`.
        pub number: u32,
        /// `"command"`.
        pub command: JawsVerb,
        /// `commanded-force`: lb; not used by the device.
        pub force: i32,
        /// `commanded-size`: opening, 0.01 in (contradiction 27).
        pub size: i32,
        /// `commanded-vel`: 0.01 in/s; not used by the device.
        pub velocity: i32,
        /// `endeff-id`.
        pub end_effector_id: u8,
    }
}

coded_enum! {
    /// `status-report` of V-Grip and Tool-Grip: the manual's words without the prefix `vgrip-`, `tgrip-`.
    pub enum JawsReport {
        /// Nothing was commanded yet (extension).
        Idle = "idle",
        /// The fingers are moving.
        Executing = "executing",
        /// They stand open, or where a RELEASE wanted them.
        Opened = "opened",
        /// They stand closed, or where a GRASP wanted them.
        Closed = "closed",
        /// They stand where nothing wanted them.
        Stuck = "jaws-stuck",
        /// They stand at the commanded position (PAUSE only).
        AtPosition = "at-position",
    }
}

impl JawsReport {
    /// The report as a state variable of E-move.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Opened | Self::Closed | Self::AtPosition => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::Stuck => Lower::Error,
        }
    }
}

record! {
    /// Status from V-Grip or Tool-Grip to E-move.
    pub struct JawsStatus {
        /// `command-#-echo`.
        pub echo: u32,
        /// `status-report`.
        pub report: JawsReport,
        /// `status-para-out`.
        pub reason: Reason,
        /// `vgrip-size`: opening, 0.01 in.
        pub size: i32,
        /// `vgrip-left-force`: there is no sensor, always 0.
        pub left_force: i32,
        /// `vgrip-right-force`: there is no sensor, always 0.
        pub right_force: i32,
        /// `vgrip-vel`: 0.01 in/s, positive opening.
        pub velocity: i32,
    }
}

record! {
    /// Output buffers of V-Grip or Tool-Grip.
    pub struct JawsOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To E-move.
        pub status: JawsStatus,
        /// To the valves.
        pub valves: JawValves,
    }
}
