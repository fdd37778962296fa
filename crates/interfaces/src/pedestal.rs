//! Subtask and the Active Pedestal (VI.7.2), and the pedestal's own hand and table processes.
//!
//! The Active Pedestal is itself a small RCS. The manual gives the interface of its upper process; this project defines
//! those of hand and table. The hand has the buffers of Grip (III.9.2).

use core::fmt;

use rcs_core::{Plain, handshake::Lower, tick::Tick};

use super::words::{Degrees, Inches};
use crate::{
    GripOutputs, Header, Reason,
    device::MotorCommand,
    grip::{Felt, GripCommand},
};

/// Commands of the Active Pedestal (VI.7.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum PedestalVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing.
    Pause,
    /// Open the hand and turn the table to an absolute angle, to receive an object.
    PreGrip,
    /// Close the hand on the object.
    Grip,
    /// Turn the table by a relative angle.
    Flip,
    /// Open the hand to release the object.
    Release,
}

/// Command from Subtask to the Active Pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PedestalCommand {
    /// `cycle-cnt`: tick in which the command was written.
    pub cycle: Tick,
    /// `incr-cmnd#`.
    pub number: u32,
    /// `command`.
    pub command: PedestalVerb,
    /// `grasp-size`: opening, 0.01 in (SPECNOTES.md, contradiction 27).
    pub grasp_size: i32,
    /// `grasp-force`: lb.
    pub grasp_force: i32,
    /// `table-angle`: 0.1 degree, absolute for PRE-GRIP, relative for FLIP.
    pub table_angle: i32,
}

/// `status` of the Active Pedestal and of its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalReport {
    /// No command yet (extension).
    Idle,
    /// Hand, table or both are moving.
    Executing,
    /// Hand and table have reached the commanded state.
    Done,
    /// The command cannot be executed.
    #[text = "can't-do"]
    CannotDo,
    /// An error that prevents the command from finishing.
    Error,
}

impl PedestalReport {
    /// The report as a state variable of the process above.
    #[must_use]
    pub const fn lower(self) -> Lower {
        match self {
            Self::Idle | Self::Done => Lower::Done,
            Self::Executing => Lower::Executing,
            Self::CannotDo | Self::Error => Lower::Error,
        }
    }
}

/// Status from the Active Pedestal to Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PedestalStatus {
    /// `cycle-cnt-echo`.
    pub cycle_echo: Tick,
    /// `incr-cmnd#-echo`.
    pub echo: u32,
    /// `status`.
    pub report: PedestalReport,
    /// `status-code`.
    pub reason: Reason,
    /// `grip-size`: opening, 0.01 in.
    pub grip_size: i32,
    /// `grip-force`: lb.
    pub grip_force: i32,
    /// `table-position`: absolute angle, 0.1 degree, if known: the counter was set at the + limit and agrees with the
    /// potentiometer of the stationary table.
    pub table_position: Option<i32>,
    /// Content of the hand by strain gages and potentiometer (extension).
    pub felt: Felt,
    /// GRIP was ordered, and no opening since: a sensed part is the object (extension).
    pub gripped: bool,
}

/// Commands of the table process (ours).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum TableVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing; a turning table stops.
    Pause,
    /// Find the + limit and set the counter (IV.1 step 3, IV.5.1 step 10).
    Calibrate,
    /// Turn to an absolute angle.
    Turn,
}

/// Command from the pedestal process to the table process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TableCommand {
    /// Command number.
    pub number: u32,
    /// Command.
    pub command: TableVerb,
    /// Absolute angle, 0.1 degree.
    pub angle: i32,
}

/// Status from the table process to the pedestal process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TableStatus {
    /// Echo of the command number.
    pub echo: u32,
    /// Its report.
    pub report: PedestalReport,
    /// Why it failed.
    pub reason: Reason,
    /// The counter was set at the limit, so angles are absolute.
    pub calibrated: bool,
    /// Absolute angle, 0.1 degree, if known: calibrated, and the counter agrees with the potentiometer of the
    /// stationary table.
    pub position: Option<i32>,
}

/// Output buffers of the pedestal process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PedestalOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To Subtask.
    pub status: PedestalStatus,
    /// To the hand process.
    pub hand: GripCommand,
    /// To the table process.
    pub table: TableCommand,
}

/// Output buffers of the table process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TableOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To the pedestal process.
    pub status: TableStatus,
    /// Potentiometer reading at the + limit, counts, while the table is calibrated. A restarted process adopts it if
    /// counter and potentiometer agree.
    pub at_limit: Option<u16>,
    /// To the rotary table controller.
    pub motor: MotorCommand,
}

/// Data from an Active Pedestal on a separate system, received over the network (II.2, IX.3). Its three processes run
/// there, and their outputs are copied into common memory here.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct OutsidePedestal {
    /// The pedestal is a separate system, and its processes are not stepped here.
    pub elsewhere: bool,
    /// The system answers. Otherwise its buffers keep their last values and stamp, so readers treat it as lost.
    pub answers: bool,
    /// Output buffers of its pedestal process; the stamp is ignored.
    pub pedestal: PedestalOutputs,
    /// Output buffers of its hand process; the stamp is ignored.
    pub hand: GripOutputs,
    /// Output buffers of its table process; the stamp is ignored.
    pub table: TableOutputs,
}

/// `FLIP by 180.0 degrees`.
impl fmt::Display for PedestalCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (verb, size, angle) = (self.command, Inches(self.grasp_size), Degrees(self.table_angle));
        match verb {
            PedestalVerb::None | PedestalVerb::Pause => verb.fmt(f),
            PedestalVerb::PreGrip => write!(f, "{verb} (opening {size}, table at {angle})"),
            PedestalVerb::Grip => write!(f, "{verb} (size {size}, force {} lb)", self.grasp_force),
            PedestalVerb::Flip => write!(f, "{verb} by {angle}"),
            PedestalVerb::Release => write!(f, "{verb} (opening {size})"),
        }
    }
}

/// `TURN to 90.0 degrees`.
impl fmt::Display for TableCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.command {
            TableVerb::Turn => write!(f, "{} to {}", self.command, Degrees(self.angle)),
            verb => verb.fmt(f),
        }
    }
}
