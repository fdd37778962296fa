//! Quick Change (VI.2): turns the locking ring, watches it, and reads which gripper is mated.
//!
//! Two reflectance sensors detect the ring at the ends of its travel. Together they give one of four readings. A
//! reading that may be temporary (the ring moves, a sensor switches late) counts only after some ticks.
//!
//! ```text
//!                     locked seen             neither seen, 12 ticks
//!    Unread --------------------> Locked <------------------------> Between   qc-stuck
//!      |                            ^                                  ^
//!      | unlocked seen              | at once        neither, 12 ticks |
//!      '----------> Unlocked <------+----------------------------------'
//!                       ^           |
//!                       |           v
//!                       '---------> Implausible     both seen, 3 ticks: qc-sens-malf
//! ```
//!
//! QC-LOCK and QC-UNLOCK give the ring air and enable the control port until the ring has arrived, both sensors
//! detect it, or 25 ticks have passed. Then the port is disabled, so that no gripper is unlocked by accident.
//! Between commands, and before the first one, QC-PAUSE watches the ring. A ring that had air before a restart may
//! still move in the first tick, and is read from the next one on. A ring that did not arrive, or sensors that
//! failed while it turned, are reported until the next command, regardless of later readings.
//!
//! ```text
//!    QC-LOCK, QC-UNLOCK            arrived
//!          -----> Start -------------------------> Watch
//!                   |  \  both sensors see it
//!                   |   '------------------------> Faulty    until the next command
//!                   |  late
//!                   '----------------------------> Stuck     until the next command
//! ```

pub mod goals;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use interfaces::{
    QuickChangeOutputs,
    process::{Inputs, Process},
};
use rcs_core::table::Table;

use self::{
    state::State,
    tables::{Action, StateVariables, Step, accept::accept, of_command},
};
use crate::execution::Course;

#[derive(Clone, Debug, Default)]
pub struct QuickChange {
    state: State,
}

impl crate::goal::Goals for QuickChange {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<Data: ?Sized> Process<Data> for QuickChange {
    type State = State;
    type Outputs = QuickChangeOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "Quick Change";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &QuickChangeOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    /// The ring is watched in every tick, also in that of a refusal.
    fn decide(&mut self, seen: &StateVariables) -> Action {
        let state = &mut self.state;
        if state.execution.execute(seen.arrival) == Course::Begin {
            state.step = Step::Start;
        }
        let accepted = state.execution.accepts(accept(state.step, &seen.request));
        let choice = of_command(state.command, state.step, &seen.situation);
        if accepted {
            state.execution.rows.decide(&choice);
        } else {
            state.execution.rows.beside(&choice);
        }
        state.step = choice.next;
        choice.action
    }

    fn postprocess(
        &mut self,
        action: Action,
        _: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut QuickChangeOutputs,
    ) {
        *outputs = self.state.act(action, inputs.tick);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
