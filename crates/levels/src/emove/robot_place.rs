//! Place of the robot (docs/design/motion.md "Where the robot is").

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip, Offset, RobotPlace, Standing},
    prim::PrimReport,
};
use taskdata::files::TaskData;

use crate::places::pose_of;

#[must_use]
pub fn near(a: &Frame, b: &Frame, inches: f64, radians: f64) -> bool {
    let distance = a.distance(b);
    distance.inches <= inches && distance.radians <= radians
}

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

#[must_use]
pub const fn robot_at(command: &EmoveCommand, gone_to: GoneTo, pose: Pose) -> RobotPlace {
    RobotPlace { gone_to, site: command.site, pose }
}

/// True if the operator controls the robot. Its place matters again when the operator returns the control.
#[must_use]
pub fn is_moved_by_hand(memory: &CommonMemory) -> bool {
    memory.prim.status.report == PrimReport::JoystickOn
}

/// True if the link to the robot controller has failed, or Prim restarts it. The arm may have moved since.
#[must_use]
pub const fn is_cut_off(memory: &CommonMemory) -> bool {
    let status = &memory.prim.status;
    let failed =
        matches!(status.report, PrimReport::T3LinkOff | PrimReport::T3LinkErr | PrimReport::NoRespT3i);
    status.restarting || failed
}

#[must_use]
pub fn base(command: &EmoveCommand, memory: &CommonMemory, data: &TaskData<'_>) -> Option<Frame> {
    pose_of(command.pose?, memory, data)
}

#[must_use]
pub const fn standing(at: &RobotPlace) -> Standing {
    let grip = match at.gone_to {
        GoneTo::Object(ObjectGrip { grip, .. }) | GoneTo::Brought(ObjectGrip { grip, .. }) => Some(grip),
        GoneTo::Location | GoneTo::View(_) | GoneTo::Drum => None,
    };
    Standing { site: at.site, grip }
}

#[must_use]
pub fn present_frame(memory: &CommonMemory) -> Option<Frame> {
    memory.changing_pose(memory.prim.status.sensor_pose?)?.to_frame().ok()
}

/// An uncontrolled robot this near may push an object with its fingers or a held part (ASSUMED).
const PUSHED_INCHES: f64 = 6.0;

/// True if the object is near, or the resolvers give no position.
#[must_use]
pub fn may_push(pose: &Pose, memory: &CommonMemory) -> bool {
    match (present_frame(memory), pose.to_frame()) {
        (Some(present), Ok(object)) => present.distance(&object).inches <= PUSHED_INCHES,
        _ => true,
    }
}

/// The last commanded pose; the pose of the resolvers if Prim commands nothing.
#[must_use]
pub fn commanded_pose(memory: &CommonMemory) -> Option<Pose> {
    let commanded = memory.prim.status.present_pose.and_then(|number| memory.changing_pose(number)).copied();
    commanded.or_else(|| present_frame(memory).map(|frame| Pose::from_frame(&frame)))
}

/// A robot within these is at a place. Prim confirms this tolerance after a motion.
pub const THERE_INCHES: f64 = 0.02;
pub const THERE_RADIANS: f64 = 0.1 * core::f64::consts::PI / 180.0; // 0.1 degree
/// A place within these is confirmed, because the arm settles while the status is passed up.
pub const CONFIRMED_INCHES: f64 = 0.05;
pub const CONFIRMED_RADIANS: f64 = 0.25 * core::f64::consts::PI / 180.0; // 0.25 degree

#[must_use]
pub fn offset(pose: &Pose, present: Option<&Frame>) -> Offset {
    let (Some(present), Ok(goal)) = (present, pose.to_frame()) else {
        return Offset::NotSensed;
    };
    let distance = goal.distance(present);
    if distance.inches <= THERE_INCHES && distance.radians <= THERE_RADIANS {
        Offset::None
    } else if distance.inches <= CONFIRMED_INCHES && distance.radians <= CONFIRMED_RADIANS {
        Offset::Slight
    } else {
        Offset::Off
    }
}

/// True for the same pose at the same location, independent of [`GoneTo`].
#[must_use]
pub fn is_same_pose(a: &RobotPlace, b: &RobotPlace) -> bool {
    let (Ok(a_frame), Ok(b_frame)) = (a.pose.to_frame(), b.pose.to_frame()) else { return false };
    a.site.has_location_of(&b.site) && near(&a_frame, &b_frame, THERE_INCHES, THERE_RADIANS)
}

pub(super) fn is_same_goal(a: &RobotPlace, b: &RobotPlace) -> bool {
    a.gone_to == b.gone_to && a.site.place() == b.site.place() && is_same_pose(a, b)
}
