//! E-move (V.2): divides elemental moves into straight segments for Prim, and coordinates gripper, quick change and
//! vision with them.
//!
//! All data of a command are looked up when it comes, before anything moves. Held object, place of the robot and
//! located object are kept from command to command.
//!
//! ```text
//!           ACCEPT, RECORDS          CARRIED, ORDERED: Prim, gripper, ring, vision
//!   a command --------------> Start ---> Moving ---> Stopping ---> done ---> E-PAUSE stands (ATTEND)
//!       |                                  |             |                      |            ^
//!       | what it needs is missing         | what is carried is lost, or        v            |
//!       v                                  v a neighbour failed             the operator has the robot
//!     error <-----------------------------------------------
//! ```
//!
//! A tick reads as the manual does (II.2.1): [`sense`], decide, [`act`], [`report`]. [`State`] is the command under way
//! and these parts, none of which reads the fields of another:
//!
//! * [`held_object`]: the object in the fingers;
//! * [`grippers`] and [`gripper`]: the three grippers as one;
//! * [`gripper_exchange`]: quick change, and the position of the robot in the change of a gripper;
//! * [`tool_drum`]: its position at the tool drum;
//! * [`localization`]: its place, or the path that it is on;
//! * [`motion`]: the route of the command, and the commands to Prim;
//! * [`vision`]: pictures, and from a picture to a part frame.
//!
//! The other modules are:
//!
//! * [`senses`]: the state variables of the commands;
//! * [`plan`]: what a new command needs;
//! * [`goals`]: what a finished command has reached;
//! * [`robot_place`] and [`grasp`]: conversions of places and objects;
//! * [`tables`]: the decision tables, one file per command.

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

/// What E-move reads in a tick.
pub type EmoveInputs<'a> = Inputs<'a, TaskData<'a>>;

/// State of E-move: the command under way, and the parts.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of Subtask and how far it has come.
    pub execution: Execution,
    pub step: Step,
    /// The process that has its last order.
    pub ordered: EmoveRecipient,
    /// It has ordered something of Prim, or waits until Prim has ended what it did before.
    pub uses_prim: bool,
    /// The points that were sent when it gave its last order.
    pub ordered_at: Progress,
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
    /// Consult ATTEND if EXECUTE leaves the command alone: the tables of the command are consulted if it passes.
    ///
    /// # Errors
    /// The action of its row otherwise.
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
