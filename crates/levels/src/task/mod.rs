//! Task (V.4): takes a command of the workstation controller apart into commands to Subtask.
//!
//! Task looks every name of a new command up before anything moves: a command that names an unknown object,
//! location, sector or grip is refused whole. What it found travels down as record numbers and as the poses
//! T-POSE-1 to T-POSE-3 (VII.1).
//!
//! * [`state`]: what Task remembers;
//! * [`plan`]: a command with its names looked up;
//! * [`ledger`]: what the Data System has been told;
//! * [`sensing`]: preprocess, the state variables;
//! * [`tables`]: one decision table a command, and one for the joystick box;
//! * [`acting`]: postprocess, the outputs that a row asks for;
//! * this module: the process.

pub mod acting;
pub mod ledger;
pub mod plan;
pub mod sensing;
pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use rcs_core::{
    interface::{ChangingPose, Reason, TaskOutputs, pose_range},
    pose::Pose,
    process::{Inputs, Process},
    table::{Decision, Table},
};
use taskdata::files::TaskData;

use self::{
    plan::{Plan, TaskVerb},
    state::{State, Watch},
    tables::joystick::{JOYSTICK, Takeover, joystick},
};
use crate::old_execution::{Course, EXECUTE};

/// The Task process.
#[derive(Clone, Debug, Default)]
pub struct Task {
    state: State,
}

/// Decision tables of Task.
pub const TABLES: &[&Table] = &[
    &EXECUTE,
    &JOYSTICK,
    &tables::pause::PAUSE,
    &tables::transfer::TRANSFER,
    &tables::mov::MOVE,
    &tables::position::POSITION,
    &tables::acquire::ACQUIRE,
    &tables::refixture::REFIXTURE,
    &tables::insert_tool::INSERT_TOOL,
    &tables::release_tool::RELEASE_TOOL,
    &tables::acquire_tool::ACQUIRE_TOOL,
    &tables::remove_tool::REMOVE_TOOL,
    &tables::startup::STARTUP,
    &tables::shutdown::SHUTDOWN,
];

impl<'d> Process<TaskData<'d>> for Task {
    type Outputs = TaskOutputs;
    type State = State;
    type Seen = ();
    type Action = ();

    const NAME: &'static str = "Task";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, TaskData<'d>>, outputs: &mut TaskOutputs) {
        self.sense(inputs);
        let Decision { row, action: takeover, next } = joystick(self.state.watch, self.subtask(inputs));
        self.state.watch = next;
        let course = self.take_command(inputs, outputs);
        if takeover != Takeover::None {
            self.state.execution.note(TABLES, &JOYSTICK, row, self.state.execution.step);
        }
        if takeover == Takeover::Yield {
            self.yield_to_operator(inputs, outputs);
        } else if matches!(course, Course::Begin | Course::Continue) {
            let situation = self.situation(inputs);
            let choice = tables::decide(self.state.plan.verb, self.state.execution.step, &situation);
            self.state.execution.note(TABLES, choice.table, choice.row, choice.step);
            self.act(choice.action, &situation, inputs, outputs);
        }
        self.report(inputs, outputs);
    }

    fn preprocess(&mut self, _: &Inputs<'_, TaskData<'d>>, _: &TaskOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, TaskData<'d>>, _: &mut TaskOutputs) {}

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

impl Task {
    /// Read the command buffer; look the names of a new command up.
    fn take_command(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &mut TaskOutputs) -> Course {
        let command = &inputs.external.hws;
        let manual = self.state.watch == Watch::Manual;
        let mut plan = Plan::default();
        let course = self.state.execution.consult(command.number, || {
            match Plan::new(command, inputs.data) {
                Ok(found) => plan = found,
                Err(reason) => return Some(reason),
            }
            // PAUSE is what an operator with the box needs; anything else would move the robot under his
            // hands.
            (manual && plan.verb != TaskVerb::Pause).then_some(Reason::JoystickOn)
        });
        if course == Course::Begin {
            self.state.plan = plan;
            self.state.ledger.told = false;
            self.publish_poses(&plan.poses, outputs);
        }
        course
    }

    /// Give the poses of a new command new record numbers: T-POSE-1 source, T-POSE-2 destination, T-POSE-3
    /// end-at.
    fn publish_poses(&mut self, poses: &[Pose; 3], outputs: &mut TaskOutputs) {
        let plan = &mut self.state.plan;
        let sites = [&mut plan.source, &mut plan.destination, &mut plan.end_at];
        for ((slot, pose), site) in outputs.poses.iter_mut().zip(poses).zip(sites) {
            self.state.last_pose = pose_range::next(pose_range::TASK, self.state.last_pose);
            *slot = ChangingPose { number: self.state.last_pose, pose: *pose };
            site.pose = if site.location.is_empty() { 0 } else { self.state.last_pose };
        }
    }
}
