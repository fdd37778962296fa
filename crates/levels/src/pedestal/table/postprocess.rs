use interfaces::{
    Reason, TableOutputs,
    device::{MotorCommand, MotorOrder, PedestalSensors},
    pedestal::{PedestalReport, TableStatus},
};
use rcs_core::tick::Tick;

use super::{
    preprocess::{AT_LIMIT, LIMIT_MINUS, LIMIT_PLUS, steps},
    state::State,
    tables::{Action, StateVariables, TablePhase},
};
use crate::execution::Outcome;

/// Steps that lead to the + limit from any angle: twice the distance between the limits. The switch ends the turn.
const TO_THE_LIMIT: i32 = steps(AT_LIMIT.saturating_sub(LIMIT_MINUS).saturating_mul(2));

impl State {
    pub(super) fn act(&mut self, action: Action, sensors: &PedestalSensors, tick: Tick) {
        match action {
            Action::Wait => {}
            Action::SeekLimit => {
                self.since = tick;
                self.order(MotorOrder::Turn, TO_THE_LIMIT, tick);
            }
            Action::SetCounter => {
                self.at_limit = Some(sensors.table_potentiometer);
                self.order(MotorOrder::SetCounter, steps(AT_LIMIT), tick);
            }
            Action::Park => self.turn(LIMIT_PLUS, sensors, tick),
            Action::EndWait => self.since = tick,
            Action::Turn => self.turn(self.command.angle, sensors, tick),
            Action::Stop => self.stop(tick),
            Action::Finish => self.execution.finish(),
            Action::Lose(reason) => {
                self.phase = TablePhase::Failed;
                self.stop(tick);
                self.execution.fail(reason);
            }
            Action::GiveUp => {
                self.since = tick;
                self.stop(tick);
            }
        }
    }

    /// Turn to an angle, 0.1 degree.
    fn turn(&mut self, angle: i32, sensors: &PedestalSensors, tick: Tick) {
        let way = steps(angle).saturating_sub(sensors.motor_counter);
        self.order(MotorOrder::Turn, way, tick);
    }

    fn order(&mut self, order: MotorOrder, steps: i32, tick: Tick) {
        self.order = MotorCommand { number: self.motor.send(tick), order, steps };
        (self.standing, self.unanswered) = (0, 0);
    }

    /// Stop, unless that was the last order.
    fn stop(&mut self, tick: Tick) {
        if self.order.order != MotorOrder::Stop {
            self.order(MotorOrder::Stop, 0, tick);
        }
    }

    pub(super) fn report(&self, seen: &StateVariables, tick: Tick) -> TableOutputs {
        let execution = &self.execution;
        let calibrated = self.phase == TablePhase::Valid;
        let adoptable = calibrated || self.phase == TablePhase::Adopting;
        let step = if self.is_calibrating() { self.phase.text() } else { self.step.text() };
        TableOutputs {
            header: execution.rows.header(tick, step),
            status: TableStatus {
                echo: execution.receiver.echo,
                report: report_of(execution.outcome, execution.reason),
                reason: execution.reason,
                calibrated,
                position: seen.angle.filter(|_| calibrated),
            },
            at_limit: self.at_limit.filter(|_| adoptable),
            motor: self.order,
        }
    }
}

/// `status` (VI.7.2): `can't-do` for a refused command, `error` for a failed one.
pub(in crate::pedestal) const fn report_of(outcome: Outcome, reason: Reason) -> PedestalReport {
    match outcome {
        Outcome::Idle => PedestalReport::Idle,
        Outcome::Executing => PedestalReport::Executing,
        Outcome::Done => PedestalReport::Done,
        Outcome::Error | Outcome::Joystick => match reason {
            Reason::UnknownCommand
            | Reason::TableLimit
            | Reason::TableAngleUnknown
            | Reason::HandUnattainable
            | Reason::HandNotCalibrated => PedestalReport::CannotDo,
            _ => PedestalReport::Error,
        },
    }
}
