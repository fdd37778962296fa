//! Task (V.4): divides a command of the workstation controller into commands to Subtask.
//!
//! Task looks up every name of a new command before anything moves. It refuses a command that names an unknown
//! object, location, sector or grip. The results are passed down as record numbers and as the poses T-POSE-1 to
//! T-POSE-3 (VII.1).
//!
//! ```text
//!           ACCEPT, PRECONDITION         ORDERED: Subtask, Data System
//!   a command --------------> Start ---> Gripper ---> Object ---> ... ---> finished
//!       |                                  |            |
//!       | data are missing, or             | Subtask or the Data System failed, or JOYSTICK: the operator
//!       | the operator has the robot       | took the robot
//!       v                                  v
//!     error <-----------------------------------------
//! ```
//!
//! * [`plan`]: a command with its names looked up;
//! * [`ledger`]: the command that is not finished;
//! * [`data_system`]: updates of the Data System.

pub mod data_system;
pub mod goals;
pub mod ledger;
pub mod plan;
pub mod postprocess;
pub mod preprocess;
pub mod state;
pub mod support;
pub mod tables;
#[cfg(test)]
mod tests;

use interfaces::{
    TaskOutputs,
    data_base::KEPT_UPDATES,
    operator::{Variable, Write},
    process::{Inputs, Process},
};
use rcs_core::table::{Table, Verdict};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{
        Action, StateVariables, Takeover, TaskOperator,
        joystick::{Control, joystick},
        number,
    },
};
use crate::{execution::Course, halt::BoxState};

#[derive(Clone, Debug, Default)]
pub struct Task {
    state: State,
}

impl crate::goal::Goals for Task {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<'d> Process<TaskData<'d>> for Task {
    type State = State;
    type Outputs = TaskOutputs;
    type StateVariables = StateVariables;
    type Action = (Takeover, Action);

    const NAME: &'static str = "Task";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, _: &TaskOutputs) -> StateVariables {
        self.state.sense(inputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> (Takeover, Action) {
        let mut seen = *seen;
        let action = tables::decide(&mut self.state, &mut seen);
        (seen.subordinates.takeover, action)
    }

    fn postprocess(
        &mut self,
        (takeover, action): (Takeover, Action),
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut TaskOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.asked, &[number::ACCEPT, number::PRECONDITION]) {
            state.begin(&seen.plan, inputs, outputs);
        }
        outputs.confirmed = state.confirmed;
        state.take_over(takeover, inputs, outputs);
        state.act(action, seen, inputs, outputs);
        state.report(inputs, outputs);
    }

    fn write(&mut self, write: &Write, _: &Inputs<'_, TaskData<'d>>, outputs: &mut TaskOutputs) {
        match write.variable {
            Variable::Ledger => {
                (outputs.ledger, outputs.updates.taking) = (None, None);
                self.state.data_system.updates = outputs.updates;
            }
            Variable::Pending => {
                outputs.updates.pending = [None; KEPT_UPDATES];
                self.state.data_system.updates = outputs.updates;
            }
            _ => {}
        }
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}

impl State {
    /// JOYSTICK follows any result of EXECUTE. HALT, PRECONDITION and ORDERED test its decision.
    fn joystick(&mut self, course: Course, seen: &mut StateVariables) -> Result<Course, Action> {
        let operator = TaskOperator { subtask: seen.subordinates.subtask, outcome: self.execution.outcome };
        seen.subordinates.takeover = match joystick(self.control, &operator) {
            Verdict::Passed(takeover) => takeover,
            Verdict::Decided(decision) => {
                self.execution.rows.decide(&decision.of(number::JOYSTICK));
                self.control = decision.next;
                decision.action
            }
        };
        seen.preconditions.control = self.control;
        seen.replaced.joystick = match self.control {
            Control::Manual => BoxState::On,
            Control::Automatic => BoxState::Off,
        };
        Ok(course)
    }
}
