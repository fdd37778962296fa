//! E-move (V.2): divides elemental moves into straight segments for Prim, and coordinates gripper, quick change and
//! vision with them.
//!
//! All data of a command are looked up when it comes, before anything moves. Held object, place of the robot and
//! located object are kept from command to command.
//!
//! ```text
//!                 ACCEPT             CARRIED, ORDERED: Prim, gripper, ring, vision
//!   a command --------------> Start ---> Moving ---> Stopping ---> done ---> E-PAUSE stands (ATTEND)
//!       |                                  |             |                      |            ^
//!       | what it needs is missing         | what is carried is lost, or        v            |
//!       v                                  v a neighbour failed             the operator has the robot
//!     error <-----------------------------------------------
//! ```
//!
//! * [`state`]: the state of E-move;
//! * [`robot_place`] and [`whereabouts`]: place of the robot;
//! * [`route`]: depart, trajectory, approach and stop as one list of points;
//! * [`way`]: continuation of an interrupted path;
//! * [`track`] and [`rejoin`]: return of a robot that the joystick box has moved;
//! * [`exchange`]: position of the robot in the change of a gripper;
//! * [`drum`]: its position at the tool drum;
//! * [`locate`]: from a picture to a part frame;
//! * [`relative`]: the short moves at holsters and tool drum;
//! * [`gripper`] and [`order`]: the three grippers as one;
//! * [`preprocess`] and [`plan`]: the state variables, and what a new command needs;
//! * [`fingers`]: openings as state variables and as orders;
//! * [`tables`]: the decision tables, one file per command;
//! * [`postprocess`], [`camera`] and [`ends`]: the outputs that a row asks for.

pub mod back;
pub mod camera;
pub mod drum;
pub mod ends;
pub mod exchange;
pub mod fingers;
pub mod goals;
pub mod gripper;
pub mod grippers;
pub mod locate;
pub mod order;
pub mod plan;
pub mod postprocess;
pub mod preprocess;
pub mod rejoin;
pub mod relative;
pub mod robot_place;
pub mod route;
pub mod state;
pub mod surroundings;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod track;
pub mod way;
pub mod whereabouts;
mod written;

use interfaces::{
    EmoveOutputs,
    operator::Write,
    process::{Inputs, Process},
};
use rcs_core::table::{Table, Verdict};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{Action, Seen, attend::attend, number},
};
use crate::execution::Course;

/// The E-move process.
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
    type Seen = Seen;
    type Action = Action;

    const NAME: &'static str = "E-move";
    const TABLES: &'static [&'static Table] = tables::TABLES;

    fn preprocess(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &EmoveOutputs) -> Seen {
        self.state.sense(inputs, outputs)
    }

    fn decide(&mut self, seen: &Seen) -> Action {
        tables::decide(&mut self.state, &mut { *seen })
    }

    fn postprocess(
        &mut self,
        action: Action,
        seen: &Seen,
        inputs: &Inputs<'_, TaskData<'d>>,
        outputs: &mut EmoveOutputs,
    ) {
        let state = &mut self.state;
        if state.execution.accepted(seen.asked) {
            state.publish_route(outputs);
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
    fn attend(&mut self, course: Course, seen: &mut Seen) -> Result<Course, Action> {
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
