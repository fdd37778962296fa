//! Postprocess: carry out the action of the row that fired, and fill the output buffers.

use rcs_core::{
    interface::{
        GripOutputs, Reason,
        device::{GripValves, valve},
        grip::{GripReport, GripStatus, GripVerb},
    },
    tick::Tick,
    units::{hundredths, rounded},
};

use super::{
    preprocess::{Seen, greatest_flow},
    state::{CLOSED_END, Calibration, OPEN_END, Phase, SUPPLY_FORCE, Scale, State, Steady},
    tables::{Action, Flow, Gripper},
};
use crate::old_execution::Outcome;

/// All close flows.
const CLOSE_FULLY: u8 = valve::SUPPLY | valve::CLOSE_COARSE | valve::CLOSE_MEDIUM | valve::CLOSE_FINE;
/// All open flows.
const OPEN_FULLY: u8 = valve::SUPPLY | valve::OPEN_COARSE | valve::OPEN_MEDIUM | valve::OPEN_FINE;
/// The difference of fingertip heights at any opening: the fingers of this gripper move in parallel. ASSUMED.
const FINGER_HEIGHT: i32 = 0;

/// Carry out `action` and report.
pub(super) fn perform(state: &mut State, seen: &Seen, action: Action, tick: Tick) -> GripOutputs {
    note_readings(state, action);
    conclude(state, action);
    state.valves = match seen.gripper {
        Gripper::Attached => valves(state, action),
        Gripper::Detached => 0,
    };
    outputs(state, seen, action, tick)
}

/// Command bits to the valves.
fn valves(state: &State, action: Action) -> u8 {
    let limit = greatest_flow(state.command.speed);
    match action {
        Action::Stop | Action::Finish | Action::Fail(_) | Action::Calibrate => 0,
        Action::Keep | Action::Pause => state.valves,
        Action::Open(flow) => match flow.min(limit) {
            Flow::Fine => valve::SUPPLY | valve::OPEN_FINE,
            Flow::Medium => valve::SUPPLY | valve::OPEN_MEDIUM,
            Flow::Coarse => valve::SUPPLY | valve::OPEN_COARSE,
        },
        Action::Close(flow) => close(flow.min(limit)),
        Action::AwaitFinger => close(limit.min(Flow::Medium)),
        Action::CloseFully => CLOSE_FULLY,
        Action::NoteClosed | Action::OpenFully => OPEN_FULLY,
        Action::NoteOpen | Action::Vent => valve::VENT,
    }
}

const fn close(flow: Flow) -> u8 {
    match flow {
        Flow::Fine => valve::SUPPLY | valve::CLOSE_FINE,
        Flow::Medium => valve::SUPPLY | valve::CLOSE_MEDIUM,
        Flow::Coarse => valve::SUPPLY | valve::CLOSE_COARSE,
    }
}

/// Keep the steady readings that end a phase of the calibration; the last ones set scale and offset.
fn note_readings(state: &mut State, action: Action) {
    let readings = state.steady.mean();
    match action {
        Action::NoteClosed => state.closed = readings,
        Action::NoteOpen => state.open = readings,
        Action::Calibrate => {
            let travel = state.open.potentiometer - state.closed.potentiometer;
            let (left, right) = (state.closed.left - readings.left, state.closed.right - readings.right);
            state.calibration = Calibration {
                potentiometer: Scale::through(state.closed.potentiometer, CLOSED_END, travel, OPEN_END),
                left: Scale::through(readings.left, 0.0, left, SUPPLY_FORCE),
                right: Scale::through(readings.right, 0.0, right, SUPPLY_FORCE),
            };
        }
        _ => return,
    }
    state.steady = Steady::default();
}

/// Whether the current command ends with this action. A calibration that nothing waits for ends no command; one that a
/// command waits for ends it only by failing. PAUSE does not need the gripper, so it does not fail with it.
fn conclude(state: &mut State, action: Action) {
    if state.execution.outcome != Outcome::Executing {
        return;
    }
    match action {
        Action::Finish | Action::Pause => state.execution.finish(),
        Action::Fail(Reason::WrongGripper) if state.command.verb == GripVerb::Pause => {}
        Action::Fail(reason) => state.execution.fail(reason),
        Action::Calibrate if state.command.verb == GripVerb::UpInit => state.execution.finish(),
        _ => {}
    }
}

fn outputs(state: &State, seen: &Seen, action: Action, tick: Tick) -> GripOutputs {
    let execution = &state.execution;
    let report = match execution.outcome {
        Outcome::Idle => GripReport::Idle,
        Outcome::Executing if action == Action::AwaitFinger => GripReport::Paused,
        Outcome::Executing => GripReport::Executing,
        Outcome::Done => GripReport::Done,
        Outcome::Error | Outcome::Joystick => GripReport::Serror,
    };
    let mut status = GripStatus {
        echo: execution.receiver.echo,
        report,
        reason: execution.reason,
        initialized: state.phase == Phase::Valid,
        finger_height: FINGER_HEIGHT,
        valves: state.valves,
        ..GripStatus::default()
    };
    if seen.gripper == Gripper::Attached {
        status.position = hundredths(seen.measured.mean_opening);
        status.velocity = hundredths(seen.measured.velocity);
        status.left_force = rounded(seen.measured.left);
        status.right_force = rounded(seen.measured.right);
    }
    GripOutputs { header: execution.header(tick), status, valves: GripValves { bits: state.valves } }
}
