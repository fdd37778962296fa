//! What a command needs, looked up when it comes: nothing moves for a command that cannot be executed.

use rcs_core::{
    frame::Frame,
    interface::{
        CommonMemory, Reason,
        emove::{EmoveCommand, EmoveVerb},
        pose_range,
    },
    process::Inputs,
};
use taskdata::files::{EndEffId, PoseId, TaskData};

use super::{
    Emove, fingers,
    gripper::Gripper,
    locate, relative,
    route::{Goal, Route},
};

/// What a motion command has planned: the way and its goal; `None` for commands without a route.
pub(super) type Plan = Option<(Route, Goal)>;

/// The gripper on the robot must be the one that the command needs.
fn check_gripper(command: &EmoveCommand, memory: &CommonMemory) -> Result<(), Reason> {
    let attached = Gripper::attached(memory);
    let right = command.end_effector_id == 0 || command.end_effector_id == attached.code();
    let good = match command.command {
        // Quick change commands have rows for it; what is held is released, whatever holds it.
        EmoveVerb::None
        | EmoveVerb::Pause
        | EmoveVerb::MovToLoc
        | EmoveVerb::Release
        | EmoveVerb::QcDetach
        | EmoveVerb::QcAttach
        | EmoveVerb::Withdraw => true,
        EmoveVerb::MovToHol => attached == Gripper::None || right,
        EmoveVerb::MovToObj
        | EmoveVerb::MovObjTo
        | EmoveVerb::MovToVu
        | EmoveVerb::LocateObj
        | EmoveVerb::GraspObj
        | EmoveVerb::InsertTool
        | EmoveVerb::ReleaseTool
        | EmoveVerb::AcquireTool
        | EmoveVerb::RemoveTool => attached != Gripper::None && right,
    };
    if good { Ok(()) } else { Err(Reason::WrongGripper) }
}

/// What is grasped must have its sizes in the task data: without them anything between the fingers would do.
fn check_sizes(command: &EmoveCommand, data: &TaskData<'_>) -> Result<(), Reason> {
    let found = data.end_eff(EndEffId::new(command.object_parameters));
    found.map(|_| ()).ok_or(Reason::UnknownGrip)
}

/// A quick change command needs a gripper with a holster, and the opening with which it goes through it.
fn check_holster(command: &EmoveCommand, data: &TaskData<'_>) -> Result<(), Reason> {
    if Gripper::of(command.end_effector_id) == Gripper::None {
        return Err(Reason::NoHolster);
    }
    fingers::gripper_on(&command.object, data).map(|_| ()).ok_or(Reason::UnknownGrip)
}

impl Emove {
    /// Look up all that a command needs.
    pub(super) fn plan(
        &self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Result<Plan, Reason> {
        check_gripper(command, inputs.memory)?;
        match command.command {
            EmoveVerb::None => return Err(Reason::UnknownCommand),
            EmoveVerb::Pause | EmoveVerb::Release => {}
            EmoveVerb::GraspObj => check_sizes(command, inputs.data)?,
            EmoveVerb::LocateObj => {
                locate::view_of(command, inputs.data).ok_or(Reason::BadRecord)?;
            }
            EmoveVerb::QcDetach | EmoveVerb::QcAttach => {
                check_holster(command, inputs.data)?;
                relative::check(command, inputs)?;
            }
            EmoveVerb::Withdraw => relative::check(command, inputs)?,
            EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => {
                if !self.state.stance.known {
                    return Err(Reason::UnknownStart);
                }
                if command.command == EmoveVerb::AcquireTool {
                    check_sizes(command, inputs.data)?;
                }
                relative::check(command, inputs)?;
            }
            EmoveVerb::MovToLoc
            | EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::MovToHol => return self.plan_route(command, inputs).map(Some),
        }
        Ok(None)
    }

    fn plan_route(
        &self,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Result<(Route, Goal), Reason> {
        let base = self.base_frame(command, inputs)?;
        let goal = Goal::new(command, &base, inputs.data)?;
        let mut route = Route::plan(command, &goal, &self.state.stance, inputs.data)?;
        if Gripper::attached(inputs.memory) == Gripper::None {
            route.opening = -1;
        }
        Ok((route, goal))
    }

    /// The pose of a command, or where vision has found the object.
    fn base_frame(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Result<Frame, Reason> {
        let located = &self.state.located;
        let found = command.command == EmoveVerb::MovToObj
            && located.object == command.object
            && !located.object.is_empty()
            && located.record == command.location_record
            && located.array == command.location_array;
        if !found && command.pose < pose_range::CHANGING {
            let record = inputs.data.pose(PoseId::new(command.pose)).ok_or(Reason::NoDestination)?;
            return Ok(record.frame);
        }
        let pose = if found {
            &located.pose
        } else {
            inputs.memory.changing_pose(command.pose).ok_or(Reason::NoDestination)?
        };
        pose.to_frame().map_err(|_| Reason::BadRecord)
    }
}
