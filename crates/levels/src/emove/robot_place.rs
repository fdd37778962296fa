//! Place of the robot (docs/design/motion.md "Where the robot is"): by E-move's last completed move, and by Prim's
//! status.

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip, RobotPlace, Standing},
    prim::PrimReport,
};
use taskdata::files::Place;

use crate::places::place_of;

/// What a command goes to.
#[must_use]
pub const fn gone_to(command: &EmoveCommand) -> GoneTo {
    let Some(object) = command.object else { return GoneTo::Location };
    let object = ObjectGrip { object, grip: command.grip };
    match command.command {
        EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToHol => GoneTo::Object(object),
        EmoveVerb::MovToVu | EmoveVerb::LocateObj => GoneTo::View(object),
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
        | EmoveVerb::RemoveTool => GoneTo::Location,
    }
}

/// The robot at the location of a command.
#[must_use]
pub const fn robot_at(command: &EmoveCommand, gone_to: GoneTo, pose: Pose) -> RobotPlace {
    RobotPlace {
        gone_to,
        location: command.location,
        kind: command.location_kind,
        record: command.location_record,
        array: command.location_array,
        sector: command.location_sector,
        pose,
    }
}

/// Does the operator have the robot? Where it is counts again when it is given back.
#[must_use]
pub fn is_led(memory: &CommonMemory) -> bool {
    memory.prim.status.report == PrimReport::JoystickOn
}

/// Has the link to the robot controller failed, or does Prim restart it? The arm may have moved since.
#[must_use]
pub const fn is_cut_off(memory: &CommonMemory) -> bool {
    let status = &memory.prim.status;
    let failed =
        matches!(status.report, PrimReport::T3LinkOff | PrimReport::T3LinkErr | PrimReport::NoRespT3i);
    status.restarting || failed
}

/// The place as task data know it.
#[must_use]
pub const fn place(at: &RobotPlace) -> Place {
    place_of(at.kind, at.record, at.array)
}

/// The place that a command names.
#[must_use]
pub const fn place_named(command: &EmoveCommand) -> Place {
    place_of(command.location_kind, command.location_record, command.location_array)
}

/// Where the robot stands, for the status.
#[must_use]
pub const fn standing(at: &RobotPlace) -> Standing {
    let grip = match at.gone_to {
        GoneTo::Object(ObjectGrip { grip, .. }) | GoneTo::Brought(ObjectGrip { grip, .. }) => Some(grip),
        GoneTo::Location | GoneTo::View(_) | GoneTo::Drum => None,
    };
    Standing { location: at.location, record: at.record, array: at.array, sector: at.sector, grip }
}

/// Where the resolvers say that the robot is.
#[must_use]
pub fn present_frame(memory: &CommonMemory) -> Option<Frame> {
    memory.changing_pose(memory.prim.status.sensor_pose?)?.to_frame().ok()
}

/// The last commanded pose of the robot; the pose of the resolvers if Prim commands nothing.
#[must_use]
pub fn commanded_pose(memory: &CommonMemory) -> Option<Pose> {
    let commanded = memory.prim.status.present_pose.and_then(|number| memory.changing_pose(number)).copied();
    commanded.or_else(|| present_frame(memory).map(|frame| Pose::from_frame(&frame)))
}
