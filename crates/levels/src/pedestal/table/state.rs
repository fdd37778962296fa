use interfaces::{device::MotorCommand, pedestal::TableCommand};
use rcs_core::{Plain, handshake::Commander, tick::Tick};

use super::tables::{Step, TablePhase};
use crate::execution::Execution;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub command: TableCommand, // a copy: the buffer of a restarted commander is empty
    /// The latest of: arrival of the command, start and end of the calibration.
    pub since: Tick,
    pub phase: TablePhase,     // step of CALIBRATE
    pub at_limit: Option<u16>, // potentiometer counts, from this calibration or from before a restart
    pub motor: Commander,
    pub order: MotorCommand,
    pub unanswered: u8, // ticks for which the controller has not taken the order
    pub standing: u8,   // ticks at rest with the last order taken
}

impl State {
    pub(super) fn is_calibrating(&self) -> bool {
        matches!(self.phase, TablePhase::Seeking | TablePhase::Setting | TablePhase::Parking)
    }
}
