//! What the table process remembers from tick to tick.

use rcs_core::{
    Plain,
    handshake::Commander,
    interface::{device::MotorCommand, pedestal::TableCommand},
    tick::Tick,
};

use crate::old_execution::Execution;

/// How far the calibration has come: the reference action of CALIBRATE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Phase {
    /// Never done: begins at once, since the table was booted just now (IV.5.1 step 10).
    Missing,
    /// Never done by this process, which was started in the middle of a job: the table may stand beside the robot, so it
    /// waits for a command that turns it.
    Deferred,
    /// The table turns towards its + limit.
    Seeking,
    /// The counter is being set.
    Setting,
    /// The counter shows the angle.
    Valid,
    /// The last attempt failed, or steps were lost; the next command that turns the table tries again.
    Failed,
}

/// Everything that the table process remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command number, its outcome and its step.
    pub execution: Execution,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: TableCommand,
    /// When the table of the command, or that of the calibration, was consulted first.
    pub since: Tick,
    /// How far the calibration has come.
    pub phase: Phase,
    /// Potentiometer at the + limit, counts.
    pub at_limit: u16,
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
    /// A calibration is under way.
    pub(super) fn calibrating(&self) -> bool {
        matches!(self.phase, Phase::Seeking | Phase::Setting)
    }
}
