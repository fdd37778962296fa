//! E-move (V.2): divides elemental moves into straight segments for Prim, and coordinates gripper, quick change and
//! vision with them. Held object, place of the robot and located object persist between commands.
//!
//! ```text
//!           ACCEPT, RECORDS          CARRIED, ORDERED: Prim, gripper, ring, vision
//!   a command --------------> Start ---> Moving ---> Stopping ---> done ---> E-PAUSE done (ATTEND)
//!       |                                  |             |                      |            ^
//!       | data are missing                 | the carried object is lost, or       v            |
//!       v                                  v a neighbour failed             the operator has the robot
//!     error <-----------------------------------------------
//! ```
//!
//! [`State`] consists of the current command and these parts. No part reads the fields of another:
//!
//! * [`held_object`]: the object in the fingers;
//! * [`grippers`] and [`gripper`]: the three grippers as one;
//! * [`gripper_exchange`]: quick change, and position of the robot in an exchange;
//! * [`tool_drum`]: position at the tool drum;
//! * [`localization`]: place of the robot, or its path;
//! * [`motion`]: the route of the command, and the commands to Prim;
//! * [`vision`]: pictures, and the part frame from a picture.

pub mod act;
pub mod goals;
pub mod grasp;
pub mod gripper;
pub mod gripper_exchange;
pub mod grippers;
pub mod held_object;
pub mod localization;
pub mod motion;
pub mod plan;
pub mod report;
pub mod robot_place;
pub mod sense;
pub mod senses;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod tool_drum;
pub mod vision;

use interfaces::{
    EmoveOutputs,
    operator::Write,
    process::{Inputs, Process},
};
use rcs_core::{
    Plain,
    table::{Table, Verdict},
};
use taskdata::files::TaskData;

use self::{
    gripper_exchange::GripperExchange,
    grippers::Grippers,
    held_object::HeldObject,
    localization::Localization,
    motion::{EmoveMotion, flight::Progress},
    tables::{Action, EmoveRecipient, StateVariables, Step, attend::attend, number},
    tool_drum::ToolDrum,
    vision::EmoveVision,
};
use crate::execution::{Course, Execution};

pub type EmoveInputs<'a> = Inputs<'a, TaskData<'a>>;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub ordered: EmoveRecipient, // the process that has the last order
    pub uses_prim: bool,         // an order is sent, or waits until Prim has ended the previous one
    pub ordered_at: Progress,    // progress when the last order was given
    pub held: HeldObject,
    pub grippers: Grippers,
    pub exchange: GripperExchange,
    pub drum: ToolDrum,
    pub localization: Localization,
    pub motion: EmoveMotion,
    pub vision: EmoveVision,
}

#[derive(Clone, Debug, Default)]
pub struct Emove {
    state: State,
}

impl crate::goal::Goals for Emove {
    const GOALS: &'static [crate::goal::Declared] = tables::GOALS;
}

impl<'d> Process<TaskData<'d>> for Emove {
    type State = State;
    type Outputs = EmoveOutputs;
    type StateVariables = StateVariables;
    type Action = Action;

    const NAME: &'static str = "E-move";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &EmoveOutputs) -> StateVariables {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &StateVariables) -> Action {
        tables::decide(&mut self.state, &mut { *seen })
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &StateVariables,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut EmoveOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.asked, &[number::ACCEPT, number::RECORDS]) {
            state.motion.publish_route(outputs);
        }
        state.act(action, seen, inputs, outputs);
        state.report(inputs, outputs);
    }

    fn write(&mut self, write: &Write, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut EmoveOutputs) {
        self.state.write(write, inputs, outputs);
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }
}

impl State {
    /// Consult ATTEND if EXECUTE does not decide. If it passes, the tables of the command follow; else the error is
    /// the action of its row.
    fn attend(&mut self, course: Course, seen: &mut StateVariables) -> Result<Course, Action> {
        if course != Course::Rest {
            return Ok(course);
        }
        seen.watch.outcome = self.execution.outcome;
        match attend(self.step, &seen.watch) {
            Verdict::Passed(()) => Ok(Course::Continue),
            Verdict::Decided(decision) => {
                self.execution.rows.beside(&decision.of(number::ATTEND));
                Err(decision.action)
            }
        }
    }
}
