//! Where the robot is (docs/design/motion.md "Where the robot is"): by E-move's last completed move, and by
//! what Prim says.

use rcs_core::{
    Plain,
    frame::Frame,
    interface::{
        CommonMemory,
        emove::{EmoveCommand, EmoveVerb},
    },
    name::{Name10, Name16},
    pose::Pose,
};
use taskdata::files::Place;

use crate::places::place_of;

/// An object and how it is gripped: approach and depart points belong to both.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjectGrip {
    /// The object.
    pub object: Name16,
    /// Its grip number.
    pub grip: i32,
}

/// What a move goes to. It decides which data lead away from there.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum GoneTo {
    /// A location as such.
    Location,
    /// An object at a location, or a held object's destination.
    Object(ObjectGrip),
    /// The place from which pictures of an object are taken.
    View(ObjectGrip),
    /// The tool drum, with the fingers around a tool in it: only the tool commands lead away from there.
    Drum,
}

impl GoneTo {
    /// What a command goes to.
    #[must_use]
    pub const fn of(command: &EmoveCommand) -> Self {
        let object = ObjectGrip { object: command.object, grip: command.grip };
        match command.command {
            EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToHol => Self::Object(object),
            EmoveVerb::MovToVu | EmoveVerb::LocateObj => Self::View(object),
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
            | EmoveVerb::RemoveTool => Self::Location,
        }
    }
}

/// Where the robot is: the end of the last completed move. It decides how the robot departs.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RobotPlace {
    /// What was gone to.
    pub gone_to: GoneTo,
    /// Name of the location.
    pub location: Name10,
    /// The location as task data know it.
    pub place: Place,
    /// Where the move ended.
    pub pose: Pose,
}

impl RobotPlace {
    /// At the location of a command.
    #[must_use]
    pub const fn at(command: &EmoveCommand, gone_to: GoneTo, pose: Pose) -> Self {
        Self { gone_to, location: command.location, place: place_named(command), pose }
    }
}

/// The place that a command names.
#[must_use]
pub const fn place_named(command: &EmoveCommand) -> Place {
    place_of(command.location_kind, command.location_record, command.location_array)
}

/// Where the resolvers say that the robot is.
#[must_use]
pub fn present_frame(memory: &CommonMemory) -> Option<Frame> {
    memory.changing_pose(memory.prim.status.sensor_pose?)?.to_frame().ok()
}

/// Where the robot was last told to be; where the resolvers say that it is, if Prim commands nothing.
#[must_use]
pub fn commanded_pose(memory: &CommonMemory) -> Option<Pose> {
    let commanded = memory.prim.status.present_pose.and_then(|number| memory.changing_pose(number)).copied();
    commanded.or_else(|| present_frame(memory).map(|frame| Pose::from_frame(&frame)))
}
