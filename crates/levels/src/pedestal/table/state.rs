//! The state of the table process.

use interfaces::{device::MotorCommand, pedestal::TableCommand};
use rcs_core::{Plain, handshake::Commander, tick::Tick};

use super::tables::{Step, TablePhase};
use crate::execution::Execution;

/// State of the table process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command and how far it has come.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: TableCommand,
    /// When it came, or when the calibration began or ended, whichever was last.
    pub since: Tick,
    /// Step of CALIBRATE.
    pub phase: TablePhase,
    /// Potentiometer at the + limit, counts, once it was read there, or of the time before a restart.
    pub at_limit: Option<u16>,
    /// Numbers of the orders to the motor.
    pub motor: Commander,
    /// The last order to the motor.
    pub order: MotorCommand,
    /// Ticks for which it has not been taken.
    pub unanswered: u8,
    /// Ticks for which the motor has been standing, its last order taken.
    pub standing: u8,
}

impl State {
    pub(super) fn is_calibrating(&self) -> bool {
        matches!(self.phase, TablePhase::Seeking | TablePhase::Setting | TablePhase::Parking)
    }
}
