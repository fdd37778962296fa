//! Where the robot is, and what it has just taken hold of: what E-move notes when a command ends.

use rcs_core::{
    interface::{EmoveOutputs, emove::EmoveCommand, emove::EmoveVerb},
    name::Name16,
    pose::Pose,
    process::Inputs,
};
use taskdata::files::{EndEffId, TaskData};

use super::{
    Emove,
    gripper::Gripper,
    relative::commanded_pose,
    state::{Held, Located, Sort, Stance},
};

/// A stance at the location of a command.
const fn at(command: &EmoveCommand, sort: Sort, pose: Pose) -> Stance {
    Stance {
        known: true,
        sort,
        location: command.location,
        kind: command.location_kind,
        record: command.location_record,
        array: command.location_array,
        object: command.object,
        grip: command.grip,
        pose,
    }
}

impl Emove {
    /// The robot is at the goal of the current command: report done.
    pub(super) fn arrive(&mut self, command: &EmoveCommand, outputs: &EmoveOutputs) {
        let sort = match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToHol => Sort::Object,
            EmoveVerb::MovToVu | EmoveVerb::LocateObj => Sort::View,
            EmoveVerb::None
            | EmoveVerb::Pause
            | EmoveVerb::MovToLoc
            | EmoveVerb::GraspObj
            | EmoveVerb::Release
            | EmoveVerb::QcDetach
            | EmoveVerb::QcAttach
            | EmoveVerb::Withdraw
            | EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => Sort::Location,
        };
        self.settle(command, sort, outputs);
        self.finish();
    }

    /// The robot has come to rest at the goal record: remember where that is.
    pub(super) fn settle(&mut self, command: &EmoveCommand, sort: Sort, outputs: &EmoveOutputs) {
        let [_, goal, ..] = outputs.poses;
        self.state.stance = at(command, sort, goal.pose);
    }

    /// The robot stands where relative moves have led it: it is at the location of the command. Report done.
    pub(super) fn stand(&mut self, sort: Sort, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) {
        let object = if sort == Sort::Drum { command.object } else { Name16::EMPTY };
        if let Some(pose) = commanded_pose(inputs) {
            self.state.stance = Stance { object, ..at(command, sort, pose) };
        }
        self.finish();
    }

    /// The object of the command is held: report done.
    pub(super) fn grasped(&mut self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) {
        let parameters = EndEffId::new(command.object_parameters);
        let gripper = Gripper::attached(inputs.memory);
        self.state.held = Held {
            object: command.object,
            parameters,
            gripper,
            grasp_size: inputs.data.end_eff(parameters).map_or(0, |p| p.grasp_size),
            opening: gripper.opening(inputs.memory).unwrap_or_default(),
            unfelt: 0,
        };
        self.state.located = Located::default();
        self.finish();
    }
}
