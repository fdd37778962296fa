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
use rcs_core::table::{Table, Variables as _, Verdict};
use taskdata::files::TaskData;

use self::{
    state::State,
    tables::{Action, Seen, Step, Watch, attend::attend, number},
};
use crate::execution::{Course, Orders as _};

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
        let state = &mut self.state;
        let course = state.execution.course(seen.arrival);
        match state.execution.admit(course, &seen.replaced) {
            Err(halting) => return Action::of_halt(halting),
            Ok(Course::Refuse) => return Action::Wait,
            Ok(Course::Rest) => {
                let watch = Watch { outcome: state.execution.outcome, ..seen.watch };
                if let Verdict::Decided(decision) = attend(state.step, &watch) {
                    state.execution.rows.beside(&decision.of(number::ATTEND));
                    return decision.action;
                }
            }
            Ok(Course::Begin) => state.step = Step::first(seen.verb),
            Ok(Course::Continue) => {}
        }
        let variables = seen.situation.code() | seen.progress;
        let choice = state.execution.effective(tables::decide(state.step, seen), variables);
        let goal = (tables::goal(seen.verb), seen.proof);
        let choice = state.execution.confirm(number::CONFIRM, state.step, choice, goal);
        state.execution.note(&choice);
        state.step = choice.next;
        choice.action
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
