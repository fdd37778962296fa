//! Subtask and E-move (V.2.2).

use core::fmt;

use geometry::{frame::Frame, pose::Pose};
use rcs_core::{
    Plain,
    name::{Name10, Name16},
};

use super::words::{location, name};
use crate::{
    ChangingPose, Header, Reason, StatusReport, Unconfirmed,
    grip::GripCommand,
    jaws::JawsCommand,
    location::Site,
    prim::PrimCommand,
    quick_change::QuickChangeCommand,
    record_number::{EndEffId, ObjGripsId, VisionId},
    track::Track,
    vision::VisionRequest,
};

/// Commands of E-move (V.2.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum EmoveVerb {
    /// No command yet.
    #[text = ""]
    None,
    /// Do nothing.
    #[text = "E-PAUSE"]
    Pause,
    /// Move to a location.
    MovToLoc,
    /// Move to an object at a location, fingers open for it.
    MovToObj,
    /// Move the held object to a location.
    MovObjTo,
    /// Move to the place from which pictures are taken.
    MovToVu,
    /// Find the object with the vision system.
    LocateObj,
    /// Close the fingers on the object.
    GraspObj,
    /// Open the fingers.
    Release,
    /// Move to a holster, fingers closed for it.
    MovToHol,
    /// Put the attached gripper into the holster and leave it there.
    QcDetach,
    /// Take the gripper out of the holster.
    QcAttach,
    /// A DELTA-MOVE from above.
    Withdraw,
    /// Insert a tool into the tool drum.
    InsertTool,
    /// Release a tool in the drum.
    ReleaseTool,
    /// Move to a tool in the drum and grasp it.
    AcquireTool,
    /// Pull a tool out of the drum.
    RemoveTool,
}

/// Command from Subtask to E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveCommand {
    /// `command-#-in`.
    pub number: u32,
    /// `"command-in"`.
    pub command: EmoveVerb,
    /// `"obj"`, if one is named.
    pub object: Option<Name16>,
    /// Grip number of the object (extension: in the manual only the records of `obj-para-^` contain it).
    pub grip: i32,
    /// `obj-para-^`: record of END-EFF-PARA, if the object has that grip.
    pub object_parameters: EndEffId,
    /// `obj-grip-loc-^`: record of OBJ-GRIPS, if an object is named.
    pub object_grips: ObjGripsId,
    /// `obj-vision-para-^`: record of VISION-PARA, if vision is used.
    pub object_vision: VisionId,
    /// `locpt-name`, `locpt-type` and `locpt-^-in`.
    pub site: Site,
    /// `pose-^-in`: the goal pose, if a location is named.
    pub pose: Option<u32>,
    /// `endeff-id#-in`; none if any gripper is suitable.
    pub end_effector_id: Option<u8>,
}

/// An object and its grip, which together select the approach and depart points.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjectGrip {
    /// The object.
    pub object: Name16,
    /// Its grip number.
    pub grip: i32,
}

/// Content of the attached gripper by its sensors (docs/design/recovery.md "Held"; extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum Holding {
    /// The gripper is empty.
    Nothing,
    /// A sensed object whose name is known from the last grasp.
    Object(ObjectGrip),
    /// A sensed object without a known name.
    Something,
    /// The gripper is not calibrated or not at rest; treated as held.
    NotKnown,
}

impl Holding {
    /// The object, if it is known.
    #[must_use]
    pub const fn object(&self) -> Option<Name16> {
        match self {
            Self::Object(held) => Some(held.object),
            Self::Nothing | Self::Something | Self::NotKnown => None,
        }
    }

    /// False only if the gripper is known to hold nothing.
    #[must_use]
    pub const fn is_held(&self) -> bool {
        !matches!(self, Self::Nothing)
    }
}

/// An object that was released at its place (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PlacedObject {
    /// The object.
    pub object: Name16,
    /// Grip number with which it was held.
    pub grip: i32,
    /// The location.
    pub site: Site,
}

/// An object that vision has found (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LocatedObject {
    /// The name.
    pub object: Name16,
    /// Its location.
    pub site: Site,
}

/// The robot's place: the end of its last completed move (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Standing {
    /// The location.
    pub site: Site,
    /// Grip of the object at the place, after MOV-TO-OBJ, MOV-OBJ-TO and MOV-TO-HOL.
    pub grip: Option<i32>,
}

/// Distance of the robot from its place, by the resolvers (extension; docs/design/motion.md "Where the robot is").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Offset {
    /// Within 0.02 in and 0.1 degree, or the robot's place is unknown.
    None,
    /// Within 0.05 in and 0.25 degree: the arm settles this far while its status passes up the ladder.
    Slight,
    /// Farther away: the robot was moved, or the arm has sunk.
    Off,
    /// The resolvers give no position.
    NotSensed,
}

/// Position of the part along the fingers, which no sensor measures (extension; docs/design/recovery.md "Held").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Seat {
    /// The position at which it was grasped, or there is no grasped part.
    Kept,
    /// Not known: with a grasped part an operator moved the robot, or the arm had no pressure.
    NotKnown,
}

/// The id pins of the quick change, compared with the gripper that was mated when the ring was locked (extension;
/// docs/design/recovery.md "Held").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pins {
    /// The pins name the same gripper, or the ring has been open since.
    Agree,
    /// The pins name another gripper or none: a bad contact, or the gripper was torn off.
    Differ,
}

/// Status from E-move to Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveStatus {
    /// `command-#-echo-out`.
    pub echo: u32,
    /// `status-report`.
    pub report: StatusReport,
    /// `status-para-out`.
    pub reason: Reason,
    /// Part of the goal that no sensor confirms, with `done` (extension).
    pub unconfirmed: Unconfirmed,
    /// `ref-pose-^`: the feedback pose, if the resolvers are valid.
    pub reference_pose: Option<u32>,
    /// `obj-held-status-out`: the held object (more than yes or no is an extension).
    pub held: Holding,
    /// Position of the object along the fingers, or at its release (extension).
    pub seat: Seat,
    /// The object of the last RELEASE; none after the next grasp or while an object is held (extension).
    pub placed: Option<PlacedObject>,
    /// The object that vision found, until it becomes invalid (extension).
    pub located: Option<LocatedObject>,
    /// `pres-endeff-id#-out`, if a gripper is attached. While the pins differ, the gripper attached before.
    pub end_effector_id: Option<u8>,
    /// Confirmation of the gripper by the id pins (extension).
    pub pins: Pins,
    /// The robot's place, if known (extension).
    pub at: Option<Standing>,
    /// Distance of the robot from its place (extension).
    pub offset: Offset,
    /// Gripper whose holster the robot occupies in the middle of an exchange: between the first and the last point of
    /// QC-ATTACH or QC-DETACH. Also a gripper that hangs on an unlocked ring (extension).
    pub exchange: Option<u8>,
    /// The fingers surround a tool in the tool drum (extension).
    pub drum: bool,
}

/// Kind of a move's goal. It selects the data for the approach and the departure.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum GoneTo {
    /// A location as such.
    Location,
    /// An object at a location, or the destination of a held object.
    Object(ObjectGrip),
    /// The place from which pictures of an object are taken.
    View(ObjectGrip),
    /// The tool drum, with the fingers around a tool in it; only tool commands lead away.
    Drum,
    /// The destination of an object that has arrived and is still held.
    Brought(ObjectGrip),
}

/// A place of the robot: the end of a move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RobotPlace {
    /// The kind of goal.
    pub gone_to: GoneTo,
    /// The location.
    pub site: Site,
    /// Pose of the tool at this place.
    pub pose: Pose,
}

/// Part of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Leg {
    /// The depart points of the place left.
    Depart,
    /// The points of the intermediate trajectory.
    Trajectory,
    /// The approach points of the goal and the goal itself.
    Approach,
}

/// Direction of travel along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Direction {
    /// To the goal.
    Forward,
    /// Back to the end of the depart leg.
    Back,
}

/// The path of the robot, published so that an interrupted move can continue (docs/design/recovery.md).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Way {
    /// The place left.
    pub from: RobotPlace,
    /// The goal.
    pub to: RobotPlace,
    /// Index of the next point toward the goal, from 0 over all legs; the goal is the last.
    pub next: u16,
    /// Leg of the next point.
    pub leg: Leg,
    /// The path is a straight line between two poses without points, such as that of the camera over a part.
    pub straight: bool,
    /// Last direction of travel.
    pub direction: Direction,
    /// The last commanded pose of the robot.
    pub rest: Pose,
    /// The joystick box has moved the robot since the interruption.
    pub by_hand: bool,
    /// The link has failed since the interruption: the robot stopped before its commanded position.
    pub cut_off: bool,
}

/// The object that the gripper holds or has tried to grasp.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Grasped {
    /// The object and its grip.
    pub object: ObjectGrip,
    /// Its record of END-EFF-PARA.
    pub parameters: EndEffId,
    /// `endeff-id#` of the gripper that holds it.
    pub gripper: Option<u8>,
    /// Grasp size of the object, 0.01 in.
    pub grasp_size: i32,
    /// Opening at the grasp, 0.01 in.
    pub opening: i32,
    /// Pose of the robot at the grasp.
    pub pose: Pose,
}

/// An object that vision has located and that has not moved since.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Located {
    /// The object.
    pub object: Name16,
    /// Its location.
    pub site: Site,
    /// Its part frame.
    pub pose: Pose,
}

/// A holster in which the robot changes a gripper.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Exchange {
    /// `endeff-id#` of its gripper.
    pub gripper: u8,
    /// Its place.
    pub place: RobotPlace,
}

/// Facts that E-move cannot read from a sensor alone. As an output they survive a restart of E-move. Each estimate is
/// valid as long as no sensor contradicts it.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Estimates {
    /// The robot's place.
    pub place: Option<RobotPlace>,
    /// The robot's path.
    pub way: Option<Way>,
    /// The held object.
    pub held: Option<Grasped>,
    /// The object of the last grasp command. None while a part is held means that its release was interrupted.
    pub grasping: Option<Grasped>,
    /// The fingers were empty and have not been commanded to close since.
    pub empty: bool,
    /// Position of the last grasped object along the fingers.
    pub seat: Seat,
    /// The last place whose object may have moved: the operator moved the robot past it, the arm sank past it, or an
    /// object that had slipped in the fingers was released there.
    pub disturbed: Option<RobotPlace>,
    /// The released object and its place.
    pub placed: Option<PlacedObject>,
    /// The object located by vision.
    pub located: Option<Located>,
    /// The holster in which the robot changes a gripper.
    pub exchange: Option<Exchange>,
    /// The tool drum at which the robot is between the first and the last point of a tool command; the pose of the
    /// location.
    pub drum: Option<RobotPlace>,
    /// The path since the last known place or way.
    pub track: Track,
    /// The robot's place at the last calibration of the force sensor.
    pub calibrated: CalibratedAt,
}

/// Place of the calibration of the force sensor (V.1.1 CAL-SENSOR; extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum CalibratedAt {
    /// At the drum, where the fingers or a held tool may touch something.
    Drum,
    /// At TOOL-SAFE, where nothing touches the tool.
    Safe,
}

/// A known place and the robot's distance from it (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct NearPlace {
    /// Name of the location.
    pub location: Name10,
    /// Distance, inches.
    pub inches: f64,
    /// Angle between the orientations, degrees.
    pub degrees: f64,
    /// Offset of the place from the robot, inches along world X, Y and Z.
    pub offset: [f64; 3],
}

impl NearPlace {
    /// A place with the tool at `goal`, seen from a robot with the tool at `present`.
    #[must_use]
    pub fn seen(location: Name10, goal: &Frame, present: &Frame) -> Self {
        let distance = goal.distance(present);
        Self {
            location,
            inches: distance.inches,
            degrees: distance.radians.to_degrees(),
            offset: (goal.position - present.position).into(),
        }
    }
}

/// Dormancy flags of the gripper processes (II.2.3): a dormant process is not stepped.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Dormancy {
    /// Grip.
    pub grip: bool,
    /// V-Grip.
    pub v_grip: bool,
    /// Tool-Grip.
    pub tool_grip: bool,
}

/// Changing poses of E-move: departure, goal, intermediate point, located object.
pub const EMOVE_POSES: usize = 4;

/// Output buffers of E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EmoveOutputs {
    /// Stamp and row.
    pub header: Header,
    /// To Subtask.
    pub status: EmoveStatus,
    /// To Prim.
    pub prim: PrimCommand,
    /// To Quick Change.
    pub quick_change: QuickChangeCommand,
    /// To Grip.
    pub grip: GripCommand,
    /// To V-Grip.
    pub v_grip: JawsCommand,
    /// To Tool-Grip.
    pub tool_grip: JawsCommand,
    /// Dormant gripper processes (II.2.3): all except that of the attached gripper.
    pub dormant: Dormancy,
    /// To the vision system.
    pub vision: VisionRequest,
    /// Facts that E-move cannot sense after a restart (extension).
    pub estimates: Estimates,
    /// The nearest known places, the nearest first, while the robot's place is unknown (extension).
    pub nearest: [Option<NearPlace>; 2],
    /// Departure, goal, intermediate point, located object.
    pub poses: [ChangingPose; EMOVE_POSES],
}

/// `MOV-TO-OBJ LINKBAR1 at TRAY`, `MOV-TO-LOC at SAFE`: the verb with its fields.
impl fmt::Display for EmoveCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.command.text())?;
        let (object, at) = (self.object.as_ref(), self.site.name());
        match self.command {
            EmoveVerb::None | EmoveVerb::Pause => Ok(()),
            EmoveVerb::MovToLoc | EmoveVerb::Withdraw => location(f, "at", at, None),
            // The fingers open at the robot's present place.
            EmoveVerb::Release => name(f, object),
            EmoveVerb::MovToObj
            | EmoveVerb::MovObjTo
            | EmoveVerb::MovToVu
            | EmoveVerb::LocateObj
            | EmoveVerb::GraspObj
            | EmoveVerb::MovToHol
            | EmoveVerb::QcDetach
            | EmoveVerb::QcAttach
            | EmoveVerb::InsertTool
            | EmoveVerb::ReleaseTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool => {
                name(f, object)?;
                location(f, "at", at, None)
            }
        }
    }
}
