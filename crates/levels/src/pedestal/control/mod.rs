//! The pedestal process (VI.7): coordinates hand and table for Subtask.
//!
//! | command  | hand | table |
//! |----------|------|-------|
//! | PRE-GRIP | opens to `grasp-size`, after UP-INIT if it is not calibrated | turns to `table-angle` |
//! | GRIP     | grasps | |
//! | FLIP     | | turns by `table-angle` |
//! | RELEASE  | opens to `grasp-size` | |
//! | PAUSE    | is waited for | stops |
//!
//! ```text
//!               ACCEPT               ORDERED: hand, table
//!   a command ----------> Start ------> Moving ------> done
//!       |                                  |
//!       | it cannot be executed            | hand or table failed, or the object came loose
//!       v                                  v
//!     can't-do                           error
//! ```
//!
//! After a failure the hand gets no command and keeps holding its part. Before a new command is accepted or
//! refused, the table stops and the hand finishes its command; also after a restart.

pub mod goals;
pub mod orders;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use interfaces::{
    PedestalOutputs,
    process::{Inputs, Process},
};
use rcs_core::table::Table;

use self::{
    state::State,
    tables::{Action, StateVariables},
};

#[derive(Clone, Debug, Default)]
pub struct Pedestal {
    state: State,
}

impl crate::goal::Goals for Pedestal {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<Data: ?Sized> Process<Data> for Pedestal {
    type State = State;
    type Outputs = PedestalOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "Active Pedestal";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, Data>, outputs: &PedestalOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> Action {
        tables::decide(&mut self.state, &mut { *seen })
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
        outputs: &mut PedestalOutputs,
    ) {
        self.state.act(action, seen, inputs, outputs);
        self.state.report(inputs, outputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
