use interfaces::{
    QuickChangeOutputs,
    device::QuickChangeValves,
    quick_change::{QuickChangeReport, QuickChangeStatus},
};
use rcs_core::tick::Tick;

use super::{state::State, tables::Action};
use crate::execution::Outcome;

impl State {
    pub(super) fn act(&mut self, action: Action, tick: Tick) -> QuickChangeOutputs {
        let report = match action {
            Action::Wait | Action::Lock | Action::Unlock => QuickChangeReport::Executing,
            Action::Report(report) => {
                if self.execution.outcome == Outcome::Executing {
                    self.execution.finish();
                }
                report
            }
            Action::Fail(failure) => {
                self.execution.fail(failure.reason());
                failure.report()
            }
        };
        let (lock, unlock) = (action == Action::Lock, action == Action::Unlock);
        QuickChangeOutputs {
            header: self.execution.rows.header(tick, self.step.text()),
            status: QuickChangeStatus {
                echo: self.execution.receiver.echo,
                report,
                reason: self.execution.reason,
                end_effector_id: self.end_effector_id,
                ring: self.reading,
            },
            // With the port disabled the ring cannot move, regardless of the two air lines (VI.2.1 QC-LOCK), so it is
            // enabled only while the ring is to turn.
            valves: QuickChangeValves { lock, unlock, port: lock || unlock },
        }
    }
}
