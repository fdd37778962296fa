//! Postprocess of the table process: orders to the motor, and the status to the pedestal process.

use rcs_core::{
    interface::{
        Reason, TableOutputs,
        device::{MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH},
        pedestal::{PedestalReport, TableStatus},
    },
    tick::Tick,
    units::rounded,
};

use super::{
    preprocess::{LIMIT_MINUS, LIMIT_PLUS, steps},
    state::State,
    tables::{Action, Phase},
};
use crate::execution::Outcome;

/// Steps that lead to the + limit from anywhere: twice as far as from one limit to the other. The switch ends
/// the turn.
const TO_THE_LIMIT: i32 = steps(LIMIT_PLUS.saturating_sub(LIMIT_MINUS).saturating_mul(2));

impl State {
    /// Carry out what a row asks for.
    pub(super) fn act(&mut self, action: Action, sensors: &PedestalSensors, tick: Tick) {
        match action {
            Action::Wait => {}
            Action::SeekLimit => {
                self.since = tick;
                self.order(MotorOrder::Turn, TO_THE_LIMIT, tick);
            }
            Action::SetCounter => {
                self.at_limit = sensors.table_potentiometer;
                self.order(MotorOrder::SetCounter, steps(LIMIT_PLUS), tick);
            }
            Action::EndCalibration => self.since = tick,
            Action::Turn => {
                let way = steps(self.command.angle).saturating_sub(sensors.motor_counter);
                self.order(MotorOrder::Turn, way, tick);
            }
            Action::Stop => self.stop(tick),
            Action::Finish => self.execution.finish(),
            Action::Lose(reason) => {
                self.phase = Phase::Failed;
                self.stop(tick);
                self.execution.fail(reason);
            }
            Action::GiveUp => {
                self.since = tick;
                self.stop(tick);
            }
        }
    }

    fn order(&mut self, order: MotorOrder, steps: i32, tick: Tick) {
        self.order = MotorCommand { number: self.motor.send(tick), order, steps };
        (self.standing, self.unanswered) = (0, 0);
    }

    /// Stop, unless that was the last order anyway.
    fn stop(&mut self, tick: Tick) {
        if self.order.order != MotorOrder::Stop {
            self.order(MotorOrder::Stop, 0, tick);
        }
    }

    /// The outputs of this tick.
    pub(super) fn report(&self, sensors: &PedestalSensors, tick: Tick) -> TableOutputs {
        let execution = &self.execution;
        let calibrated = self.phase == Phase::Valid;
        let angle = rounded(f64::from(sensors.motor_counter) / f64::from(TABLE_STEPS_PER_TENTH));
        let step = if self.is_calibrating() { self.phase.text() } else { self.step.text() };
        TableOutputs {
            header: execution.header(tick, step),
            status: TableStatus {
                echo: execution.receiver.echo,
                report: report_of(execution.outcome, execution.reason),
                reason: execution.reason,
                calibrated,
                position: if calibrated { angle } else { 0 },
            },
            motor: self.order,
        }
    }
}

/// `status` (VI.7.2): `can't-do` for a command that is refused, `error` for one that something prevents.
pub(in crate::pedestal) const fn report_of(outcome: Outcome, reason: Reason) -> PedestalReport {
    match outcome {
        Outcome::Idle => PedestalReport::Idle,
        Outcome::Executing => PedestalReport::Executing,
        Outcome::Done => PedestalReport::Done,
        Outcome::Error | Outcome::Joystick => match reason {
            Reason::UnknownCommand | Reason::TableLimit | Reason::GripUnattainable | Reason::NotPrepared => {
                PedestalReport::CannotDo
            }
            _ => PedestalReport::Error,
        },
    }
}
