//! What E-move notes when a command ends: where the robot is, and what it has taken hold of.

use rcs_core::{
    interface::{EmoveOutputs, emove::EmoveCommand},
    process::Inputs,
};
use taskdata::files::{EndEffId, TaskData};

use super::{
    fingers::sizes,
    gripper::Gripper,
    robot_place::{GoneTo, RobotPlace, commanded_pose},
    state::{Held, State},
};

impl State {
    /// The robot is at the goal of the current command: report done.
    pub(super) fn arrive(&mut self, command: &EmoveCommand, outputs: &EmoveOutputs) {
        self.settle(command, GoneTo::of(command), outputs);
        self.finish();
    }

    /// The robot has come to rest at the goal record: remember where that is.
    pub(super) fn settle(&mut self, command: &EmoveCommand, gone_to: GoneTo, outputs: &EmoveOutputs) {
        let [_, goal, ..] = outputs.poses;
        self.place = Some(RobotPlace::at(command, gone_to, goal.pose));
    }

    /// The robot stands where relative moves have led it: it is at the location of the command. Report done.
    pub(super) fn stand(
        &mut self,
        gone_to: GoneTo,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) {
        if let Some(pose) = commanded_pose(inputs.memory) {
            self.place = Some(RobotPlace::at(command, gone_to, pose));
        }
        self.finish();
    }

    /// The object of the command is held: report done.
    pub(super) fn grasped(&mut self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) {
        let gripper = Gripper::attached(inputs.memory);
        self.held = Some(Held {
            object: command.object,
            parameters: EndEffId::from_option(command.object_parameters),
            gripper,
            grasp_size: sizes(command, inputs.data).map_or(0, |sizes| sizes.grasp_size),
            opening: gripper.opening(inputs.memory).unwrap_or_default(),
            unfelt: 0,
        });
        self.located = None;
        self.finish();
    }
}
