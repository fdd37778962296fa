//! E-move and Grip, the parts gripper (VI.3.2).

use crate::{
    coded_enum,
    handshake::Lower,
    interface::{Header, Reason, device::GripValves},
    record,
};

coded_enum! {
    /// Commands of Grip (VI.3.1).
    pub enum GripVerb {
        /// None yet.
        None = "",
        /// Leave the valves as they are.
        Pause = "PAUSE",
        /// Open or close to an opening.
        Position = "POSITION",
        /// The same, where "open" says better what is meant.
        OpenGrip = "OPEN-GRIP",
        /// Close with a commanded force.
        CloseGrip = "CLOSE-GRIP",
        /// Calibrate position and force sensors.
        UpInit = "UP-INIT",
    }
}

record! {
    /// Command from E-move to Grip.
    pub struct GripCommand {
        /// `sincr-cmnd#`.
        pub number: u32,
        /// `scommand`.
        pub command: GripVerb,
        /// `sforce`: lb.
        pub force: i32,
        /// `sposition`: opening, 0.01 in (contradiction 27).
        pub position: i32,
        /// `svelocity`: 0.01 in/s; 0 means full speed.
        pub velocity: i32,
        /// `send-effector`.
        pub end_effector_id: u8,
    }
}

coded_enum! {
    /// `status` of Grip.
    pub enum GripReport {
        /// Nothing was commanded yet (extension).
        Idle = "idle",
        /// The command is executing.
        Executing = "executing",
        /// The command is finished: desired force or position attained.
        Done = "done",
        /// Waiting for both fingers to touch.
        Paused = "paused",
        /// An unattainable command has been sent.
        Serror = "serror",
    }
}

impl GripReport {
    /// The report as a state variable of E-move.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing | Self::Paused => Lower::Executing,
            Self::Serror => Lower::Error,
        }
    }
}

record! {
    /// Status from Grip to E-move.
    pub struct GripStatus {
        /// `incr-cmnd#-echo`.
        pub echo: u32,
        /// `status`.
        pub report: GripReport,
        /// Why it failed (extension).
        pub reason: Reason,
        /// `initialized-?`.
        pub initialized: bool,
        /// `pos`: opening, 0.01 in.
        pub position: i32,
        /// `l-force`: lb.
        pub left_force: i32,
        /// `r-force`: lb.
        pub right_force: i32,
        /// `vel`: 0.01 in/s.
        pub velocity: i32,
        /// `finger-hgt`: 0.01 in.
        pub finger_height: i32,
        /// `grip`: command bits to the air valves.
        pub valves: u8,
    }
}

record! {
    /// Output buffers of Grip.
    pub struct GripOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To E-move.
        pub status: GripStatus,
        /// To the valves.
        pub valves: GripValves,
    }
}
