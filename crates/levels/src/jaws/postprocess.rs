//! Postprocess: carry out the action of the row that fired, and fill the output buffers.

use rcs_core::{
    interface::{
        JawsOutputs, Reason,
        device::JawValves,
        jaws::{JawsReport, JawsStatus},
    },
    tick::Tick,
    units::hundredths,
};

use super::{
    preprocess::Seen,
    state::State,
    tables::{Action, Gripper},
};
use crate::old_execution::Outcome;

/// Carry out `action` and report.
pub(super) fn perform(state: &mut State, seen: &Seen, action: Action, tick: Tick) -> JawsOutputs {
    conclude(state, action);
    let air = air(state, seen.gripper, action);
    if air != state.valves {
        (state.valves, state.air_ticks) = (air, 0);
    }
    let mut status = JawsStatus {
        echo: state.execution.receiver.echo,
        report: state.report,
        reason: state.execution.reason,
        ..JawsStatus::default()
    };
    if seen.gripper == Gripper::Attached {
        status.size = hundredths(seen.opening);
        status.velocity = hundredths(seen.velocity);
    }
    JawsOutputs { header: state.execution.header(tick), status, valves: state.valves }
}

/// How the command stands after this action. Of the words of VI.4.2 only `jaws-stuck` is bad news, so it stands for every
/// failure; the reason says which.
fn conclude(state: &mut State, action: Action) {
    state.report = match action {
        Action::Keep if state.execution.outcome == Outcome::Idle => JawsReport::Idle,
        Action::Keep => state.report,
        Action::Close | Action::Open | Action::Wait => JawsReport::Executing,
        Action::Report(report) => {
            state.execution.finish();
            report
        }
        Action::Wrong(report) => {
            state.execution.fail(Reason::JawsStuck);
            report
        }
        Action::Fail(reason) => {
            state.execution.fail(reason);
            JawsReport::Stuck
        }
        Action::Refuse => JawsReport::Stuck,
    };
}

/// Air to the fingers. It stays on when they have arrived: a part is held as long as they press.
fn air(state: &State, gripper: Gripper, action: Action) -> JawValves {
    const NONE: JawValves = JawValves { open: false, close: false };
    match (gripper, action) {
        (Gripper::Detached, _) | (_, Action::Fail(_)) => NONE,
        (_, Action::Close) => JawValves { close: true, ..NONE },
        (_, Action::Open) => JawValves { open: true, ..NONE },
        (_, Action::Keep | Action::Refuse | Action::Wait | Action::Report(_) | Action::Wrong(_)) => {
            state.valves
        }
    }
}
