//! Quick Change (VI.2): watches the locking ring and reads which gripper is mated.
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
//! The status is that of the ring, not of the command: it is true from the first tick on, before any command and after a
//! restart. A command table only adds what the valves do; QC-PAUSE does nothing, with the control port disabled, and is
//! consulted whenever no other command is executing.

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
mod tests;

pub use self::state::{Ring, State};

use rcs_core::{
    interface::QuickChangeOutputs,
    process::{Inputs, Process},
    table::Table,
};

use self::tables::{QC_PAUSE, qc_pause};
use crate::execution::EXECUTE;

/// Decision tables, the upper one first.
const TABLES: &[&Table] = &[&EXECUTE, &QC_PAUSE];

/// The Quick Change process.
#[derive(Clone, Debug, Default)]
pub struct QuickChange {
    state: State,
}

impl<Data: ?Sized> Process<Data> for QuickChange {
    type State = State;
    type Outputs = QuickChangeOutputs;

    const NAME: &'static str = "Quick Change";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut QuickChangeOutputs) {
        let id = preprocess::observe(&mut self.state, inputs);
        let decision = qc_pause(self.state.ring, id);
        self.state.execution.note(TABLES, &QC_PAUSE, decision.row, decision.next.code());
        *outputs = postprocess::perform(&mut self.state, decision.action, inputs.tick);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}
