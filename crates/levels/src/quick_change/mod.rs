//! Quick Change (VI.2): turns the locking ring, watches it, and reads which gripper is mated.
//!
//! Two reflectance sensors see the ring at either end of its way. What they say together is one of four readings; a reading
//! that may be a passing one (the ring on its way, a sensor that switches late) counts only after some ticks.
//!
//! ```text
//!                     locked seen             neither seen, 12 ticks
//!    Unread --------------------> Locked <------------------------> Between   qc-stuck
//!      |                            ^                                  ^
//!      | unlocked seen              | at once        neither, 12 ticks |
//!      '----------> Unlocked <------+----------------------------------'
//!                       ^           |
//!                       |           v
//!                       '---------> Both     both seen, 3 ticks: qc-sens-malf
//! ```
//!
//! QC-LOCK and QC-UNLOCK give the ring air and enable the control port, until the ring has arrived, both sensors see it, or
//! 25 ticks have passed; then the port is disabled again, so that nothing can unlock a gripper by accident. In between the
//! status is that of the ring, not of a command: it is true from the first tick on, before any command and after a restart,
//! and QC-PAUSE only watches. One thing is kept: a ring that did not arrive, or sensors that failed while it turned, are
//! reported until the next command, whatever the sensors say meanwhile.

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
mod tests;

pub use self::state::{Ring, State};

use rcs_core::{
    interface::{QuickChangeOutputs, quick_change::QuickChangeVerb},
    process::{Inputs, Process},
    table::Table,
};

use self::{
    preprocess::Seen,
    tables::{Action, QC_LOCK, QC_PAUSE, QC_UNLOCK, Step, qc_lock, qc_pause, qc_unlock},
};
use crate::old_execution::{Course, EXECUTE};

/// Decision tables, the upper one first.
const TABLES: &[&Table] = &[&EXECUTE, &QC_PAUSE, &QC_LOCK, &QC_UNLOCK];

/// The Quick Change process.
#[derive(Clone, Debug, Default)]
pub struct QuickChange {
    state: State,
}

impl QuickChange {
    /// Look up the state variables in the table of the command, or in that of QC-PAUSE if no command turns the ring.
    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        let executing = matches!(seen.course, Course::Begin | Course::Continue);
        let (table, decision) = match state.command {
            QuickChangeVerb::Lock if executing => (&QC_LOCK, qc_lock(state.ring, seen.id, seen.clock)),
            QuickChangeVerb::Unlock if executing => (&QC_UNLOCK, qc_unlock(state.ring, seen.clock)),
            _ => {
                let step = Step::from_code(state.execution.step).unwrap_or_default();
                (&QC_PAUSE, qc_pause(step, state.ring, seen.id))
            }
        };
        state.execution.note(TABLES, table, decision.row, decision.next.code());
        decision.action
    }
}

impl<Data: ?Sized> Process<Data> for QuickChange {
    type State = State;
    type Seen = ();
    type Action = ();
    type Outputs = QuickChangeOutputs;

    const NAME: &'static str = "Quick Change";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut QuickChangeOutputs) {
        let seen = Seen::preprocess(&mut self.state, inputs);
        let action = self.decide(&seen);
        *outputs = postprocess::perform(&mut self.state, action, inputs.tick);
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &QuickChangeOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut QuickChangeOutputs) {}

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}
