//! Prim and the T3 Interface (VI.1.2).

use core::fmt;

use geometry::{
    frame::Distance,
    pose::WireFrame,
    units::{Point, inches},
};
use rcs_core::{Plain, handshake::Lower, tick::Tick};

pub use depc::link::{LinkCounters, LinkFault};

use crate::{Header, device::LinkBytes};

/// Commands of T3I (VI.1.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum T3iVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Clear errors and initialize the link.
    Restart,
    /// Move to a frame.
    Point,
    /// Repeat the last position.
    Pause,
}

/// Command from Prim to T3I.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
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

/// `status-report` of T3I; the code is the manual's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum T3iReport {
    /// 0: finished, output position equals input position.
    Finished,
    /// 1: executing; no new point is accepted.
    Executing,
    /// 2: an error has occurred.
    Error,
    /// 3: ready for a new point.
    Ready,
}

/// Comparison of the robot controller's report with the sent positions (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ReportCheck {
    /// No report since the loss of the link or the last RESTART.
    #[text = "no report"]
    NoReport,
    /// The robot is at the sent position within 2 counts per word, or between it and the one before. Also before the
    /// first position is sent.
    #[text = "as sent"]
    AsSent,
    /// The robot is elsewhere, or the controller's DTR was off meanwhile. The state lasts until the next point is
    /// sent.
    Elsewhere,
}

/// Comparison of the resolvers with the commanded path while the link runs (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Following {
    /// The link is starting, and the resolvers have not been near the reported position yet.
    Joining,
    /// The robot is on its path, or the resolvers are invalid.
    #[text = "on path"]
    OnPath,
    /// The robot left its path and was stopped: T3I sends no position until RESTART.
    #[text = "off path"]
    OffPath,
}

/// Place of a robot that left its path (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PathLeft {
    /// Tool frame of the last sent position.
    pub commanded: WireFrame,
    /// Tool frame of the resolvers.
    pub fed_back: WireFrame,
    /// Distance of the resolvers from the path within the expected lag, 0.01 in; one radian equals 14 in.
    pub deviation: i32,
}

/// The last two sent positions in words of the line: X, Y, Z in 0.01 in, D, E, R in 0.01 degree (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct SentWords {
    /// The last one.
    pub last: [i16; 6],
    /// The one before.
    pub before: [i16; 6],
}

/// Status from T3I to Prim.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
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
    /// `frame-feedback`: resolver frame until the link runs, then the commanded frame (SPECNOTES.md, contradiction
    /// 14).
    pub frame_feedback: WireFrame,
    /// `scale-factor-out`: resolver scale, counts per turn.
    pub scale_factor: i32,
    /// `joint-limit-dummy`: always 0. VI.1.2 reserves it for joint limits, which the line does not report (A 2.3).
    pub joint_limit: i32,
    /// Tool frame from the resolvers, if they are valid (extension).
    pub resolver_frame: Option<WireFrame>,
    /// The link runs: the last report was received and commands are acknowledged (extension).
    pub link_running: bool,
    /// The controller's DTR is on (extension).
    pub controller_ready: bool,
    /// DTR is on, and the controller has not answered for a second or longer (extension).
    pub silent: bool,
    /// Comparison of the reported with the sent position (extension).
    pub check: ReportCheck,
    /// The last two sent positions, for a restarted T3I (extension).
    pub sent: Option<SentWords>,
    /// Comparison of the resolvers with the path (extension).
    pub following: Following,
    /// Distance of the resolvers from the path within the expected lag, 0.01 in; 0 without a link or valid resolvers
    /// (extension).
    pub deviation: i32,
    /// Place at which the robot left its path, until RESTART (extension).
    pub left: Option<PathLeft>,
    /// Counters (extension).
    pub counters: LinkCounters,
}

/// Output buffers of T3I.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct T3iOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To Prim.
    pub status: T3iStatus,
    /// To the DEPC line.
    pub link_tx: LinkBytes,
}

/// `2.31 in and 0.4 degrees from the commanded pose (1.00, 2.00, 3.00 in), fed back (1.00, 4.31, 3.00 in)`.
impl fmt::Display for PathLeft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Ok(commanded), Ok(fed_back)) = (self.commanded.to_frame(), self.fed_back.to_frame()) {
            let Distance { inches, radians } = commanded.distance(&fed_back);
            write!(f, "{inches:.2} in and {:.1} degrees from ", radians.to_degrees())?;
        }
        let [commanded, fed_back] = [self.commanded, self.fed_back].map(|pose| Point(pose.tool.map(inches)));
        write!(f, "the commanded pose {commanded}, fed back {fed_back}")
    }
}

impl T3iStatus {
    /// Possible causes of a line without answers, as text; `None` if the line is sound.
    #[must_use]
    pub const fn trouble(&self) -> Option<&'static str> {
        if self.silent {
            Some(
                "the robot controller does not answer, but its DTR is on: Hold, a warning D1 to D6 on its screen, a dead receiver or a \
                 cut wire; a re-start is sent every second",
            )
        } else if matches!(self.following, Following::OffPath) {
            Some("the robot has left its commanded path and was stopped; PAUSE takes its position over")
        } else if matches!(self.check, ReportCheck::Elsewhere) {
            Some(
                "the robot is not where it was sent, or its controller was off; PAUSE takes its position over",
            )
        } else if !self.controller_ready && !matches!(self.fault, LinkFault::None) {
            Some(
                "the robot controller's DTR is off: it is off, or its program does not run the DEPC function",
            )
        } else {
            None
        }
    }
}

/// `POINT`.
impl fmt::Display for T3iCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.command.fmt(f)
    }
}

impl T3iReport {
    /// The report as a state variable of the process above.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Executing => Lower::Executing,
            Self::Ready | Self::Finished => Lower::Done,
            Self::Error => Lower::Error,
        }
    }
}
