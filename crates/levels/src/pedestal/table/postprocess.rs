//! Postprocess: carry out the action of the row that fired, and fill the output buffers.

use rcs_core::{
    interface::{
        Reason, TableOutputs,
        device::{MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH},
        pedestal::{PedestalReport, TableStatus, TableVerb},
    },
    tick::Tick,
    units::rounded,
};

use super::{
    preprocess::{LIMIT_MINUS, LIMIT_PLUS, Seen, steps},
    state::{Phase, State},
    tables::Action,
};
use crate::old_execution::Outcome;

/// Steps that lead to the + limit from anywhere: twice as far as from one limit to the other. The switch ends the turn.
const TO_THE_LIMIT: i32 = steps(LIMIT_PLUS.saturating_sub(LIMIT_MINUS).saturating_mul(2));

/// Carry out `action` and report.
pub(super) fn perform(
    state: &mut State,
    seen: &Seen,
    action: Action,
    sensors: &PedestalSensors,
    tick: Tick,
) -> TableOutputs {
    let executing = state.execution.outcome == Outcome::Executing;
    match action {
        Action::Wait => {}
        Action::SeekLimit => order(state, MotorOrder::Turn, TO_THE_LIMIT, tick),
        Action::SetCounter => {
            state.at_limit = sensors.table_potentiometer;
            order(state, MotorOrder::SetCounter, steps(LIMIT_PLUS), tick);
        }
        Action::Calibrated => {
            // The time of a command that has waited begins now.
            state.since = tick;
            if executing && state.command.command == TableVerb::Calibrate {
                state.execution.finish();
            }
        }
        Action::Turn => {
            let way = steps(state.command.angle).saturating_sub(sensors.motor_counter);
            order(state, MotorOrder::Turn, way, tick);
        }
        Action::Stop => stop(state, tick),
        Action::Finish => state.execution.finish(),
        Action::Lose(reason) => {
            state.phase = Phase::Failed;
            stop(state, tick);
            // A PAUSE that has waited for a calibration goes on without it, and its time begins now.
            if seen.calibrate && state.command.command == TableVerb::Pause {
                state.since = tick;
            } else if executing {
                state.execution.fail(reason);
            }
        }
    }
    outputs(state, sensors, tick)
}

fn order(state: &mut State, order: MotorOrder, steps: i32, tick: Tick) {
    state.order = MotorCommand { number: state.motor.send(tick), order, steps };
    (state.standing, state.unanswered) = (0, 0);
}

/// Stop, unless that was the last order anyway.
fn stop(state: &mut State, tick: Tick) {
    if state.order.order != MotorOrder::Stop {
        order(state, MotorOrder::Stop, 0, tick);
    }
}

fn outputs(state: &State, sensors: &PedestalSensors, tick: Tick) -> TableOutputs {
    let execution = &state.execution;
    let calibrated = state.phase == Phase::Valid;
    let angle = rounded(f64::from(sensors.motor_counter) / f64::from(TABLE_STEPS_PER_TENTH));
    TableOutputs {
        header: execution.header(tick),
        status: TableStatus {
            echo: execution.receiver.echo,
            report: report(execution.outcome, execution.reason),
            reason: execution.reason,
            calibrated,
            position: if calibrated { angle } else { 0 },
        },
        motor: state.order,
    }
}

/// `status` (VI.7.2): `can't-do` for a command that is refused, `error` for one that something prevents.
pub(in crate::pedestal) const fn report(outcome: Outcome, reason: Reason) -> PedestalReport {
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
