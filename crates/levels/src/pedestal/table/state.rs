use interfaces::{device::MotorCommand, pedestal::TableCommand};
use rcs_core::{Plain, handshake::Commander, tick::Tick};

use super::tables::{Step, TablePhase};
use crate::execution::Execution;

/// State of the table process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: TableCommand,
    /// The latest of: arrival of the command, start and end of the calibration.
    pub since: Tick,
    /// Step of CALIBRATE.
    pub phase: TablePhase,
    /// Potentiometer at the + limit, counts, from this calibration or from before a restart.
    pub at_limit: Option<u16>,
    /// Numbers the orders to the motor.
    pub motor: Commander,
    /// The last order to the motor.
    pub order: MotorCommand,
    /// Ticks for which the controller has not taken it.
    pub unanswered: u8,
    /// Ticks for which the motor has been at rest with its last order taken.
    pub standing: u8,
}

impl State {
    pub(super) fn is_calibrating(&self) -> bool {
        matches!(self.phase, TablePhase::Seeking | TablePhase::Setting | TablePhase::Parking)
    }
}
