//! The pedestal process (VI.7): coordinates hand and table for Subtask.
//!
//! | command  | hand                  | table                          |
//! |----------|-----------------------|--------------------------------|
//! | PRE-GRIP | opens to `grasp-size` | turns to `table-angle`         |
//! | GRIP     | grasps                |                                |
//! | FLIP     |                       | turns by `table-angle`         |
//! | RELEASE  | opens to `grasp-size` |                                |
//! | PAUSE    |                       | stops                          |
//!
//! A failure sends nothing to the hand: what it holds, it goes on holding.

mod postprocess;
mod preprocess;
mod state;
pub mod tables;
#[cfg(test)]
mod tests;

pub use self::state::State;

use rcs_core::{
    interface::{PedestalOutputs, pedestal::PedestalVerb},
    process::{Inputs, Process},
    table::Table,
};

use self::{
    preprocess::Seen,
    tables::{Action, FLIP, GRIP, PAUSE, PRE_GRIP, RELEASE, Step, flip, grip, pause, pre_grip, release},
};
use crate::old_execution::{Course, EXECUTE};

/// Decision tables, the upper one first.
const TABLES: &[&Table] = &[&EXECUTE, &PRE_GRIP, &GRIP, &FLIP, &RELEASE, &PAUSE];

/// The pedestal process.
#[derive(Clone, Debug, Default)]
pub struct Pedestal {
    state: State,
}

impl Pedestal {
    /// Look up the state variables in the table of the command.
    fn decide(&mut self, seen: &Seen) -> Action {
        let state = &mut self.state;
        if !matches!(seen.course, Course::Begin | Course::Continue) {
            return Action::Wait;
        }
        let step = Step::from_code(state.execution.step).unwrap_or_default();
        let Seen { hand, table, object, .. } = *seen;
        let (rows, decision) = match state.command.command {
            PedestalVerb::PreGrip => (&PRE_GRIP, pre_grip(step, hand, table)),
            PedestalVerb::Grip => (&GRIP, grip(step, hand, object)),
            PedestalVerb::Flip => (&FLIP, flip(step, table, object)),
            PedestalVerb::Release => (&RELEASE, release(step, hand)),
            PedestalVerb::Pause | PedestalVerb::None => (&PAUSE, pause(step, table)),
        };
        state.execution.note(TABLES, rows, decision.row, decision.next.code());
        decision.action
    }
}

impl<Data: ?Sized> Process<Data> for Pedestal {
    type State = State;
    type Seen = ();
    type Action = ();
    type Outputs = PedestalOutputs;

    const NAME: &'static str = "Active Pedestal";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut PedestalOutputs) {
        let seen = Seen::preprocess(&mut self.state, inputs);
        let action = self.decide(&seen);
        postprocess::perform(&mut self.state, &seen, action, inputs, outputs);
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &PedestalOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut PedestalOutputs) {}

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
