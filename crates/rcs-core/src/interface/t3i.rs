//! Prim and the T3 Interface (VI.1.2).

use crate::{
    coded_enum,
    interface::{Header, device::LinkBytes},
    pose::WireFrame,
    record,
    tick::Tick,
};

coded_enum! {
    /// Commands of T3I (VI.1.1).
    pub enum T3iVerb {
        /// None yet.
        None = "",
        /// Clear errors and initialize the link.
        Restart = "RESTART",
        /// Move to a frame.
        Point = "POINT",
        /// Repeat the last position.
        Pause = "PAUSE",
    }
}

record! {
    /// Command from Prim to T3I.
    pub struct T3iCommand {
        /// `cycle-cnt-#-in`: tick in which the command was written.
        pub cycle: Tick,
        /// `inc-command-#-in`.
        pub number: u32,
        /// `input-command`.
        pub command: T3iVerb,
        /// `frame-command-in`.
        pub frame: WireFrame,
    }
}

coded_enum! {
    /// `status-report` of T3I; the code is the manual's value.
    pub enum T3iReport {
        /// 0: finished, output position equals input position.
        Finished = "finished",
        /// 1: executing; no new point is wanted.
        Executing = "executing",
        /// 2: an error has occurred.
        Error = "error",
        /// 3: ready for a new point.
        Ready = "ready",
    }
}

coded_enum! {
    /// `status-arg-out` of T3I; the code is the manual's value.
    pub enum LinkFault {
        /// 0: no error.
        None = "no error",
        /// 1: the DEPC link is not responding.
        NotResponding = "not responding",
        /// 2: DEPC detected an error.
        DepcError = "DEPC detected an error",
        /// 3: a message from DEPC contained a checksum error.
        Checksum = "checksum error",
        /// 4: the message to DEPC was not transmitted.
        NotTransmitted = "not transmitted",
        /// 5: an invalid command has been sent.
        InvalidCommand = "invalid command",
    }
}

record! {
    /// Counters of the link since the start (extension).
    pub struct LinkCounters {
        /// Data commands sent, repetitions included.
        pub frames: u32,
        /// Data commands acknowledged.
        pub acknowledged: u32,
        /// NAKs received.
        pub naks: u32,
        /// Data commands sent again after a NAK.
        pub retries: u32,
        /// Frames that got no answer in time.
        pub timeouts: u32,
        /// Re-start commands sent.
        pub restarts: u32,
        /// Reports received with a wrong checksum.
        pub checksum_errors: u32,
        /// Points that were scaled back to the velocity limits.
        pub limited: u32,
    }
}

record! {
    /// Status from T3I to Prim.
    pub struct T3iStatus {
        /// `cycle-cnt-#-status-out`.
        pub cycle: Tick,
        /// `cycle-cnt-#-echo-out`.
        pub cycle_echo: Tick,
        /// `inc-command-#-echo`.
        pub echo: u32,
        /// `input-command-echo`.
        pub command: T3iVerb,
        /// `status-report`.
        pub report: T3iReport,
        /// `status-arg-out`.
        pub fault: LinkFault,
        /// `frame-feedback`: resolver frame until the link runs, commanded frame afterwards (contradiction 14).
        pub frame_feedback: WireFrame,
        /// `scale-factor-out`: resolver scale, counts per turn.
        pub scale_factor: i32,
        /// `joint-limit-dummy`: always 0. VI.1.2 has it for joint limits and does not use it; the line does not tell of them (A 2.3).
        pub joint_limit: i32,
        /// Tool frame from the resolvers (extension).
        pub resolver_frame: WireFrame,
        /// The resolver frame can be believed (extension).
        pub resolver_valid: bool,
        /// The link runs: the last report was received and commands are acknowledged (extension).
        pub link_running: bool,
        /// Counters (extension).
        pub counters: LinkCounters,
    }
}

record! {
    /// Output buffers of T3I.
    pub struct T3iOutputs {
        /// Stamp and row.
        pub header: Header,
        /// To Prim.
        pub status: T3iStatus,
        /// To the DEPC line.
        pub link_tx: LinkBytes,
    }
}
