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
    /// None yet.
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
    /// Move to where pictures are taken.
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
    /// Let go of a tool in the drum.
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
    /// Grip number of the object (extension: the manual has it only in the records that `obj-para-^` names).
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
    /// `endeff-id#-in`; none if any gripper will do.
    pub end_effector_id: Option<u8>,
}

/// An object and how it is gripped: approach and depart points belong to both.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjectGrip {
    /// The object.
    pub object: Name16,
    /// Its grip number.
    pub grip: i32,
}

/// The content of the attached gripper, by its sensors (docs/design/recovery.md "Held"; extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub enum Holding {
    /// Nothing.
    Nothing,
    /// Something is felt, and the last grasp that named an object was made here.
    Object(ObjectGrip),
    /// Something is felt, and nothing says what it is.
    Something,
    /// The gripper is not calibrated or not at rest: counts as held.
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

/// An object that has been let go at its place (extension).
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
    /// The object.
    pub object: Name16,
    /// Where it is.
    pub site: Site,
}

/// Where the robot stands: the end of its last completed move (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Standing {
    /// The location.
    pub site: Site,
    /// Grip of the object that was gone to, for MOV-TO-OBJ, MOV-OBJ-TO and MOV-TO-HOL.
    pub grip: Option<i32>,
}

/// How far the robot is from the place at which it stands, by the resolvers (extension; docs/design/motion.md "Where
/// the robot is").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Offset {
    /// Within 0.02 in and 0.1 degree, or it stands at no known place.
    None,
    /// Within 0.05 in and 0.25 degree: as far as the arm settles while its status is passed up the ladder.
    Slight,
    /// More: the robot was moved, or the arm has sunk.
    Off,
    /// The resolvers give no position.
    NotSensed,
}

/// Where a part is along the fingers, which no sensor measures (extension; docs/design/recovery.md "Held").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Seat {
    /// Where it was grasped, or the fingers have not closed on anything.
    Kept,
    /// Not known: with the part between the fingers the robot was moved by a person, or the arm had no pressure.
    NotKnown,
}

/// The id pins of the quick change, compared with the gripper that the robot had when the ring was locked (extension;
/// docs/design/recovery.md "Held").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pins {
    /// They name it, or the ring has been open since.
    Agree,
    /// They name another one, or none: a bad contact, or the gripper has been torn off.
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
    /// `ref-pose-^`: the feedback pose, if the resolvers can be believed.
    pub reference_pose: Option<u32>,
    /// `obj-held-status-out`: what is held (more than yes or no is an extension).
    pub held: Holding,
    /// Where it is along the fingers, or was when it was let go (extension).
    pub seat: Seat,
    /// The object that the last RELEASE has let go; none as soon as anything is grasped or held (extension).
    pub placed: Option<PlacedObject>,
    /// What vision has found and nothing has made invalid since (extension).
    pub located: Option<LocatedObject>,
    /// `pres-endeff-id#-out`, if a gripper is on; while the pins differ, the gripper that was on.
    pub end_effector_id: Option<u8>,
    /// Do the id pins confirm it (extension)?
    pub pins: Pins,
    /// Where the robot stands, if that is known (extension).
    pub at: Option<Standing>,
    /// How far the robot is from there (extension).
    pub offset: Offset,
    /// Number of the gripper in whose holster the robot stands in the middle of an exchange: between the
    /// first and the last point of QC-ATTACH or QC-DETACH; or of the one that hangs on a ring that is not
    /// locked (extension).
    pub exchange: Option<u8>,
    /// The fingers are around a tool in the tool drum (extension).
    pub drum: bool,
}

/// What a move goes to. It decides which data lead there, and away from there.
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
    /// The destination of an object, where it has been brought and is held still.
    Brought(ObjectGrip),
}

/// A place of the robot: where a move ended, or where one leads.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RobotPlace {
    /// What is gone to.
    pub gone_to: GoneTo,
    /// The location.
    pub site: Site,
    /// Where the tool is there.
    pub pose: Pose,
}

/// Part of a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Leg {
    /// The depart points of the place left.
    Depart,
    /// The points of the intermediate trajectory.
    Trajectory,
    /// The approach points of the goal, and the goal.
    Approach,
}

/// Which way the robot goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Direction {
    /// To the goal.
    Forward,
    /// Back to the end of the depart leg.
    Back,
}

/// The path that the robot is on: published so that an interrupted move can go on (docs/design/recovery.md).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Way {
    /// The place left.
    pub from: RobotPlace,
    /// The goal.
    pub to: RobotPlace,
    /// The next point in the direction of the goal, from 0, through all legs; the goal is the last.
    pub next: u16,
    /// The leg of that point.
    pub leg: Leg,
    /// It leads straight from one pose to the other, without points, as that of the camera over a part.
    pub straight: bool,
    /// Which way the robot went last.
    pub direction: Direction,
    /// The last commanded pose of the robot.
    pub rest: Pose,
    /// The joystick box has moved the robot since.
    pub by_hand: bool,
    /// The link has failed since: the robot has stopped before its commanded position.
    pub cut_off: bool,
}

/// What the gripper holds, or has tried to grasp.
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
    /// Opening when it was grasped, 0.01 in.
    pub opening: i32,
    /// Where the robot stood.
    pub pose: Pose,
}

/// An object that vision has located and that nothing has moved since.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Located {
    /// The object.
    pub object: Name16,
    /// Where it is.
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

/// State of the world that E-move cannot read from a sensor alone. It is an output, so that E-move has it again after a
/// restart; each estimate counts only as long as no sensor contradicts it.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Estimates {
    /// Where the robot stands.
    pub place: Option<RobotPlace>,
    /// The path that it is on.
    pub way: Option<Way>,
    /// What the gripper holds.
    pub held: Option<Grasped>,
    /// The object that it was last commanded to grasp. None beside something that counts as held: it has been
    /// half let go, and the release was cut off.
    pub grasping: Option<Grasped>,
    /// The fingers were empty, and have not been told to close since.
    pub empty: bool,
    /// Where along the fingers the object is that they have closed on last.
    pub seat: Seat,
    /// The last place where an object may not be where the data say: a person has led the robot past it, the arm has
    /// sunk past it, or it was let go there after it had slid in the fingers.
    pub disturbed: Option<RobotPlace>,
    /// The object that the gripper has let go, and where.
    pub placed: Option<PlacedObject>,
    /// What vision has located.
    pub located: Option<Located>,
    /// The holster in which the robot changes a gripper.
    pub exchange: Option<Exchange>,
    /// The tool drum at which the robot is half way, between the first and the last point of a tool command.
    /// Its pose is that of the location.
    pub drum: Option<RobotPlace>,
    /// The path from the last known place or way.
    pub track: Track,
    /// Where the robot was when the force sensor was last ordered to be calibrated.
    pub calibrated: CalibratedAt,
}

/// Where the force sensor was calibrated (V.1.1 CAL-SENSOR; extension).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum CalibratedAt {
    /// At the drum, where the fingers or a held tool may touch something.
    Drum,
    /// At TOOL-SAFE, where nothing is touched.
    Safe,
}

/// A known place, and how far the robot is from it (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct NearPlace {
    /// Name of the location.
    pub location: Name10,
    /// Distance, inches.
    pub inches: f64,
    /// Angle between the orientations, degrees.
    pub degrees: f64,
    /// The place seen from the robot, inches along world X, Y and Z.
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

/// Changing poses of E-move: the pose departed from, the goal, a point between, and the located object.
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
    /// Which gripper processes are dormant (II.2.3): all but that of the attached gripper.
    pub dormant: Dormancy,
    /// To the vision system.
    pub vision: VisionRequest,
    /// Facts that E-move cannot sense again after a restart (extension).
    pub estimates: Estimates,
    /// The known places that are nearest, the nearest first, while it is not known where the robot is
    /// (extension).
    pub nearest: [Option<NearPlace>; 2],
    /// Departure, goal, point between, located object.
    pub poses: [ChangingPose; EMOVE_POSES],
}

/// `MOV-TO-OBJ LINKBAR1 at TRAY`, `MOV-TO-LOC at SAFE`: the verb with the fields that it uses.
impl fmt::Display for EmoveCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.command.text())?;
        let (object, at) = (self.object.as_ref(), self.site.name());
        match self.command {
            EmoveVerb::None | EmoveVerb::Pause => Ok(()),
            EmoveVerb::MovToLoc | EmoveVerb::Withdraw => location(f, "at", at, None),
            // The fingers open where the robot is.
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
