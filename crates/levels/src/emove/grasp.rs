//! Object and grip of a command, with the sizes of the object forms (VII.7.1).

use interfaces::{
    emove::{EmoveCommand, Grasped, ObjectGrip},
    grip::Felt,
};
use rcs_core::name::Name16;
use taskdata::files::{EndEffPara, TaskData};

use super::{EmoveInputs, gripper::EmoveGripper, robot_place::commanded_pose};

/// Grip of a holster object with the gripper on the robot. Its approach size is the opening in the holster.
const GRIPPER_ON: i32 = 1;

pub(super) fn gripper_on<'d>(command: &EmoveCommand, data: &TaskData<'d>) -> Option<&'d EndEffPara> {
    data.object(&command.object?, GRIPPER_ON).map(|(_, parameters)| parameters)
}

pub(super) fn sizes<'d>(command: &EmoveCommand, data: &TaskData<'d>) -> Option<&'d EndEffPara> {
    data.end_eff(command.object_parameters)
}

pub(super) fn grasp_of(command: &EmoveCommand, inputs: &EmoveInputs<'_>) -> Grasped {
    let gripper = EmoveGripper::attached(inputs.memory);
    Grasped {
        object: ObjectGrip { object: command.object.unwrap_or_default(), grip: command.grip },
        parameters: command.object_parameters,
        gripper: gripper.id(),
        grasp_size: sizes(command, inputs.data).map_or(0, |sizes| sizes.grasp_size),
        opening: gripper.opening(inputs.memory).unwrap_or_default(),
        pose: commanded_pose(inputs.memory).unwrap_or_default(),
    }
}

/// `None` if no finger detects a force, or the task data lack the object.
pub(super) fn named_grasp(object: Name16, grip: i32, inputs: &EmoveInputs<'_>) -> Option<Grasped> {
    let (parameters, _) = inputs.data.object(&object, grip)?;
    let gripper = EmoveGripper::attached(inputs.memory);
    if gripper.felt(inputs.memory) != Felt::Something {
        return None;
    }
    gripper.opening(inputs.memory)?;
    let command =
        EmoveCommand { object: Some(object), grip, object_parameters: parameters, ..EmoveCommand::default() };
    Some(grasp_of(&command, inputs))
}
