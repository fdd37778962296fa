//! Postprocess: fill the output buffers.

use rcs_core::{
    interface::{
        QuickChangeOutputs,
        device::QuickChangeValves,
        quick_change::{QuickChangeReport, QuickChangeStatus},
    },
    tick::Tick,
};

use super::{state::State, tables::Action};
use crate::execution::Outcome;

/// Carry out the action of the row that fired.
pub(super) fn perform(state: &mut State, action: Action, tick: Tick) -> QuickChangeOutputs {
    let Action::Report(report) = action;
    if report != QuickChangeReport::Executing && state.execution.outcome == Outcome::Executing {
        state.execution.finish();
    }
    QuickChangeOutputs {
        header: state.execution.header(tick),
        status: QuickChangeStatus {
            echo: state.execution.receiver.echo,
            report,
            reason: state.execution.reason,
            end_effector_id: state.end_effector_id,
        },
        // With the port disabled the ring cannot move, whatever the two air lines do (VI.2.1 QC-LOCK).
        valves: QuickChangeValves { lock: false, unlock: false, port: false },
    }
}
