//! Subtask (V.3): divides a command of Task into commands to E-move, and coordinates the robot with the Active
//! Pedestal.
//!
//! * `pedestal_hand`: the part in the pedestal's hand;
//! * [`manual`]: orders of a person to the pedestal;
//! * [`aims`]: objects and locations of the commands to E-move.

pub mod aims;
pub mod goals;
pub mod manual;
mod pedestal_hand;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;

use interfaces::{
    SubtaskOutputs,
    operator::{Variable, Write},
    process::{Inputs, Process},
    subtask::Regrip,
};
use rcs_core::table::{Table, Verdict};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{
        Action, StateVariables,
        by_hand::{Manually, by_hand},
        number,
    },
};

#[derive(Clone, Debug, Default)]
pub struct Subtask {
    state: State,
}

impl crate::goal::Goals for Subtask {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<'d> Process<TaskData<'d>> for Subtask {
    type State = State;
    type Outputs = SubtaskOutputs;
    type StateVariables = StateVariables;
    type Action = (Action, Option<Manually>);

    const NAME: &'static str = "Subtask";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, _: &SubtaskOutputs) -> StateVariables {
        self.state.sense(inputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> (Action, Option<Manually>) {
        let action = tables::decide(&mut self.state, &mut { *seen });
        let manually = match by_hand((), &seen.manual) {
            Verdict::Passed(()) => None,
            Verdict::Decided(decision) => {
                self.state.execution.rows.beside(&decision.of(number::BY_HAND));
                Some(decision.action)
            }
        };
        (action, manually)
    }

    fn postprocess(
        &mut self,
        (action, manually): (Action, Option<Manually>),
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut SubtaskOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.asked, &[number::ACCEPT]) {
            state.publish_poses(outputs);
        }
        state.act(action, seen, inputs, outputs);
        if manually == Some(Manually::Send) {
            state.command_manually(inputs, outputs);
        }
        state.report(inputs, outputs);
    }

    fn write(&mut self, write: &Write, _: &Inputs<'_, TaskData<'d>>, outputs: &mut SubtaskOutputs) {
        if write.variable == Variable::Regrip {
            outputs.regrip = write.object.map(|object| Regrip { object });
            self.state.regrip = outputs.regrip;
        }
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}
