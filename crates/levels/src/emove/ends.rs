//! The records of E-move at the end of a command: the place of the robot, and the grasped object.

use interfaces::{
    EmoveOutputs,
    emove::{EmoveCommand, EmoveVerb, GoneTo, Grasped, ObjectGrip},
    process::Inputs,
};
use taskdata::files::TaskData;

use super::{
    fingers::sizes,
    gripper::Gripper,
    robot_place::{commanded_pose, gone_to, robot_at},
    state::State,
};

impl State {
    /// The robot is at the goal of the current command: report done.
    pub(super) fn arrive(&mut self, command: &EmoveCommand, outputs: &EmoveOutputs) {
        let at = match gone_to(command) {
            GoneTo::Object(object) if self.brings(command) => GoneTo::Brought(object),
            at => at,
        };
        self.settle(command, at, outputs);
        self.finish();
    }

    /// Does the robot bring the object of the command, which it holds?
    fn brings(&self, command: &EmoveCommand) -> bool {
        let held = self.beliefs.held.map(|held| held.object.object);
        command.command == EmoveVerb::MovObjTo && held == command.object
    }

    /// The robot has come to rest at the goal record: remember where that is.
    pub(super) fn settle(&mut self, command: &EmoveCommand, gone_to: GoneTo, outputs: &EmoveOutputs) {
        let [_, goal, ..] = outputs.poses;
        self.beliefs.place = Some(robot_at(command, gone_to, goal.pose));
        (self.beliefs.way, self.away) = (None, false);
    }

    /// The robot stands where relative moves have led it: it is at the location of the command. Report done.
    pub(super) fn stand(
        &mut self,
        gone_to: GoneTo,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) {
        if let Some(pose) = commanded_pose(inputs.memory) {
            self.beliefs.place = Some(robot_at(command, gone_to, pose));
            self.away = false;
        }
        (self.beliefs.exchange, self.beliefs.drum) = (None, None);
        self.finish();
    }

    /// What the fingers are to close on, for the command.
    pub(super) fn grasp_of(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Grasped {
        let gripper = Gripper::attached(inputs.memory);
        Grasped {
            object: ObjectGrip { object: command.object.unwrap_or_default(), grip: command.grip },
            parameters: command.object_parameters,
            gripper: gripper.id(),
            grasp_size: sizes(command, inputs.data).map_or(0, |sizes| sizes.grasp_size),
            opening: gripper.opening(inputs.memory).unwrap_or_default(),
            pose: commanded_pose(inputs.memory).unwrap_or_default(),
        }
    }

    /// The object of the command is held: report done.
    pub(super) fn grasped(&mut self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) {
        self.hold(self.grasp_of(command, inputs));
        self.finish();
    }

    /// An object is held.
    pub(super) fn hold(&mut self, grasped: Grasped) {
        self.beliefs.held = Some(grasped);
        (self.beliefs.placed, self.beliefs.located) = (None, None);
        self.forget_disturbance();
        self.unfelt = 0;
    }
}
