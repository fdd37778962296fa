//! Task and the workstation controller, HWSC (V.4.2).

use core::fmt;

use rcs_core::{Plain, handshake::Lower, name::Name16};

use super::words::{location, name};
use crate::{
    ChangingPose, Header, Reason, Unconfirmed,
    data_base::{Connection, DataBaseCommand, DataBaseUpdates},
    emove::Standing,
    operator::Support,
    subtask::{SubtaskCommand, SubtaskVerb},
};

/// Command from the HWSC to Task. The words arrive as text, and Task checks them.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HwsCommand {
    /// `command-#-in`; 0 before the first command.
    pub number: u32,
    /// `"command-16"`.
    pub command: Name16,
    /// `"obj"`, if one is named.
    pub object: Option<Name16>,
    /// `"obj-serial-#"`.
    pub serial: Name16,
    /// `source-grip-#`.
    pub source_grip: i32,
    /// `"src-loc-16"`, if one is named.
    pub source: Option<Name16>,
    /// `src-sector#`, from 1, if one is named.
    pub source_sector: Option<i32>,
    /// `dest-grip-#`.
    pub destination_grip: i32,
    /// `"dest-loc-16"`, if one is named.
    pub destination: Option<Name16>,
    /// `dest-sector#`, from 1, if one is named.
    pub destination_sector: Option<i32>,
    /// `"end-at-16"`, if one is named.
    pub end_at: Option<Name16>,
    /// `endatsector#`, from 1, if one is named.
    pub end_at_sector: Option<i32>,
    /// Verdict of the check against the task data, which precedes Task (extension; docs/neighbours.md "Verdict").
    pub checked: Checked,
}

/// Verdict of the check of a command against the task data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Checked {
    /// The command passes, or was not checked.
    Passes,
    /// The command fails the check: Task refuses it.
    Fails,
}

/// `"status"` to the HWSC. The manual has `executing` and `finished`; the others are extensions
/// (docs/design/failures.md "Task").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HwsReport {
    /// No command yet (extension).
    Idle,
    /// The command is executing.
    Executing,
    /// The command is finished.
    Finished,
    /// The command failed (extension).
    Error,
    /// The operator controls the robot (extension).
    JoystickOn,
}

/// Status from Task to the HWSC.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HwsStatus {
    /// Echo of the command number.
    pub echo: u32,
    /// `"command-echo"`.
    pub command: Name16,
    /// `"status"`.
    pub report: HwsReport,
    /// Reason of a failure (extension).
    pub reason: Reason,
    /// Part of the goal that no sensor confirms, with `finished` (extension).
    pub unconfirmed: Unconfirmed,
}

/// The last accepted and unfinished command of Task about an object or a tool. As an output it survives a restart of
/// Task (docs/design/recovery.md "Ledger"; extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Ledger {
    /// The command, without its number.
    pub command: HwsCommand,
    /// Its last command to Subtask, except PAUSE.
    pub last: SubtaskVerb,
    /// The Data System has accepted the update for the move, or needs none. Reset when the object is taken again.
    pub reported: bool,
}

/// An operator's statement that the held object will not fall when the gripper opens. It is valid while the robot
/// stays at its place and holds an object. As an output it survives a restart of Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Confirmed {
    /// The support of the object.
    pub by: Support,
    /// The robot's place.
    pub at: Option<Standing>,
}

/// T-POSE-1 to T-POSE-3 (VII.1).
pub const TASK_POSES: usize = 3;

/// Output buffers of Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TaskOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To the HWSC.
    pub status: HwsStatus,
    /// To Subtask.
    pub subtask: SubtaskCommand,
    /// To the Data System.
    pub data_base: DataBaseCommand,
    /// State of the connection for updates (extension).
    pub connection: Connection,
    /// Connection to the Data System, and updates (extension).
    pub updates: DataBaseUpdates,
    /// The last unfinished command about an object or a tool (extension).
    pub ledger: Option<Ledger>,
    /// The operator's valid statement about the held object (extension).
    pub confirmed: Option<Confirmed>,
    /// T-POSE-1 …: poses named by the commands.
    pub poses: [ChangingPose; TASK_POSES],
}

impl HwsCommand {
    /// The command without its empty fields: `TRANSFER LINKBAR1 from TRAY:3 to PFIXTURE end at HOME`.
    pub fn in_words(&self) -> impl fmt::Display {
        fmt::from_fn(|f| {
            f.write_str(self.command.as_str())?;
            name(f, self.object.as_ref())?;
            let places = [
                ("from", self.source, self.source_sector),
                ("to", self.destination, self.destination_sector),
                ("end at", self.end_at, self.end_at_sector),
            ];
            for (word, name, sector) in places {
                let Some(name) = name else { continue };
                write!(f, " {word} {name}")?;
                if let Some(sector) = sector {
                    write!(f, ":{sector}")?;
                }
            }
            Ok(())
        })
    }
}

/// `TRANSFER LINKBAR1 at TRAY sector 3 to PFIXTURE`.
impl fmt::Display for HwsCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.command.as_str())?;
        name(f, self.object.as_ref())?;
        location(f, "at", self.source.as_ref(), self.source_sector)?;
        location(f, "to", self.destination.as_ref(), self.destination_sector)
    }
}

impl HwsReport {
    /// The report as a state variable of the superior.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Finished => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::Error => Lower::Error,
            Self::JoystickOn => Lower::Joystick,
        }
    }
}
