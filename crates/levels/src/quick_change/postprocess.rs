//! Postprocess: fill the output buffers.

use rcs_core::{
    interface::{
        QuickChangeOutputs, Reason,
        device::QuickChangeValves,
        quick_change::{QuickChangeReport, QuickChangeStatus},
    },
    tick::Tick,
};

use super::{state::State, tables::Action};
use crate::old_execution::Outcome;

/// Carry out the action of the row that fired.
pub(super) fn perform(state: &mut State, action: Action, tick: Tick) -> QuickChangeOutputs {
    let report = match action {
        Action::Report(report) => {
            if report != QuickChangeReport::Executing && state.execution.outcome == Outcome::Executing {
                state.execution.finish();
            }
            report
        }
        Action::Lock | Action::Unlock => QuickChangeReport::Executing,
        Action::Fail(report) => {
            state.execution.fail(match report {
                QuickChangeReport::Stuck => Reason::QuickChangeStuck,
                _ => Reason::QuickChangeFault,
            });
            report
        }
    };
    let (lock, unlock) = (action == Action::Lock, action == Action::Unlock);
    QuickChangeOutputs {
        header: state.execution.header(tick),
        status: QuickChangeStatus {
            echo: state.execution.receiver.echo,
            report,
            reason: state.execution.reason,
            end_effector_id: state.end_effector_id,
        },
        // With the port disabled the ring cannot move, whatever the two air lines do (VI.2.1 QC-LOCK): it is enabled only while
        // the ring is to turn.
        valves: QuickChangeValves { lock, unlock, port: lock || unlock },
    }
}
