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
    /// None yet.
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
    /// 1: executing; no new point is wanted.
    Executing,
    /// 2: an error has occurred.
    Error,
    /// 3: ready for a new point.
    Ready,
}

/// Is the robot where it was sent? What T3I makes of a report of the robot controller (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ReportCheck {
    /// No report has come since the link was lost, or since the last RESTART.
    #[text = "no report"]
    NoReport,
    /// The robot is where it was sent, within 2 counts a word, or on the way there from where it was sent
    /// before. Or nothing has been sent yet.
    #[text = "as sent"]
    AsSent,
    /// It is elsewhere, or the controller's DTR was off meanwhile. Stays until the next point is sent.
    Elsewhere,
}

/// Is the robot on the path that it is sent along? What T3I makes of the resolvers while the link runs (extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Following {
    /// The link begins, and the resolvers have not been near the reported position yet.
    Joining,
    /// It is, or the resolvers are not valid.
    #[text = "on path"]
    OnPath,
    /// It was not, and was stopped: nothing is sent until RESTART.
    #[text = "off path"]
    OffPath,
}

/// Where a robot that left its path was found (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PathLeft {
    /// Tool frame of the position sent last.
    pub commanded: WireFrame,
    /// Tool frame of the resolvers.
    pub fed_back: WireFrame,
    /// Distance of the resolvers from the path of the expected lag, 0.01 in; a radian counts as 14 in.
    pub deviation: i32,
}

/// The last two positions sent, in words of the line: X, Y, Z in 0.01 in, D, E, R in 0.01 degree (extension).
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
    /// `frame-feedback`: resolver frame until the link runs, commanded frame afterwards
    /// (SPECNOTES.md, contradiction 14).
    pub frame_feedback: WireFrame,
    /// `scale-factor-out`: resolver scale, counts per turn.
    pub scale_factor: i32,
    /// `joint-limit-dummy`: always 0. VI.1.2 has it for joint limits and does not use it; the line does not
    /// tell of them (A 2.3).
    pub joint_limit: i32,
    /// Tool frame from the resolvers, if they can be believed (extension).
    pub resolver_frame: Option<WireFrame>,
    /// The link runs: the last report was received and commands are acknowledged (extension).
    pub link_running: bool,
    /// The controller's DTR is on (extension).
    pub controller_ready: bool,
    /// DTR is on, and for a second or longer the controller has not answered (extension).
    pub silent: bool,
    /// Is the robot where it was sent (extension)?
    pub check: ReportCheck,
    /// The last two positions sent, for a T3I that is restarted (extension).
    pub sent: Option<SentWords>,
    /// Is the robot on its path (extension)?
    pub following: Following,
    /// Distance of the resolvers from the path of the expected lag, 0.01 in; 0 without a link or valid resolvers
    /// (extension).
    pub deviation: i32,
    /// Where the robot left its path, until RESTART (extension).
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
    /// Possible causes of a line without answers, as text; `None` if there is no trouble.
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
