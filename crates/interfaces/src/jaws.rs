//! E-move and the grippers that only open and close: V-Grip and Tool-Grip (VI.4.2, VI.5).
//!
//! TG-LEVEL is VG-LEVEL with other parameters and the prefix TG, so both have the same buffers.

use core::fmt;

use rcs_core::{Plain, handshake::Lower};

use super::words::Inches;
use crate::{Header, Reason, device::JawValves, grip::Felt};

/// Commands of V-Grip and Tool-Grip (VI.4.1), without the prefix VG or TG.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum JawsVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// VG-PAUSE, TG-PAUSE: leave the valves as they are and read the potentiometer.
    Pause,
    /// VG-GRASP, TG-GRASP: close.
    Grasp,
    /// VG-RELEASE, TG-RELEASE: open.
    Release,
    /// VGRIP-POSE, TGRIP-POSE: open, as RELEASE.
    Pose,
}

/// Command from E-move to V-Grip or Tool-Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JawsCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command"`.
    pub command: JawsVerb,
    /// `commanded-force`: lb; the device ignores it.
    pub force: i32,
    /// `commanded-size`: opening, 0.01 in (SPECNOTES.md, contradiction 27).
    pub size: i32,
    /// `commanded-vel`: 0.01 in/s; the device ignores it.
    pub velocity: i32,
    /// `endeff-id`; none if any gripper is suitable.
    pub end_effector_id: Option<u8>,
}

/// `status-report` of V-Grip (VI.4.2), and of Tool-Grip, which has the same buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum JawsReport {
    /// No command yet (extension).
    Idle,
    /// The fingers are moving.
    Executing,
    /// Stopped at the open limit, or at the size of a RELEASE.
    #[text = "vgrip-opened"]
    Opened,
    /// Stopped at the closed limit, or at the size of a GRASP.
    #[text = "vgrip-closed"]
    Closed,
    /// Stopped at neither a limit nor the commanded size.
    #[text = "jaws-stuck"]
    Stuck,
    /// Stopped at the commanded position (PAUSE only).
    AtPosition,
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

/// Status from V-Grip or Tool-Grip to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JawsStatus {
    /// `command-#-echo`.
    pub echo: u32,
    /// `status-report`.
    pub report: JawsReport,
    /// `status-para-out`.
    pub reason: Reason,
    /// `vgrip-size`: opening, 0.01 in.
    pub size: i32,
    /// `vgrip-left-force`: always 0, as there is no sensor.
    pub left_force: i32,
    /// `vgrip-right-force`: always 0, as there is no sensor.
    pub right_force: i32,
    /// `vgrip-vel`: 0.01 in/s, positive opening.
    pub velocity: i32,
    /// Content of the gripper by the potentiometer alone (extension).
    pub felt: Felt,
}

/// Output buffers of V-Grip or Tool-Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JawsOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To E-move.
    pub status: JawsStatus,
    /// To the valves.
    pub valves: JawValves,
}

/// `TG-GRASP (size 1.20 in)`. Size 0 commands no size.
impl fmt::Display for JawsCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = if self.end_effector_id == Some(TOOL_GRIPPER) { "TG" } else { "VG" };
        match self.command {
            JawsVerb::None => return Ok(()),
            JawsVerb::Pause => return write!(f, "{prefix}-{}", self.command),
            JawsVerb::Pose => write!(f, "{prefix}RIP-{}", self.command)?,
            JawsVerb::Grasp | JawsVerb::Release => write!(f, "{prefix}-{}", self.command)?,
        }
        if self.size == 0 { Ok(()) } else { write!(f, " (size {})", Inches(self.size)) }
    }
}

/// `endeff-id#` of the tool gripper (VII.7.2).
pub const TOOL_GRIPPER: u8 = 3;
