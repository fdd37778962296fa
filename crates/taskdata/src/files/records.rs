//! The record of each file. The manual names the files and their variables but not their layouts (SPECNOTES).

use geometry::{frame::Frame, movetable::Movetable, pose::Pose};
use interfaces::record_number::{
    EndEffId, LocptId, MovtabId, ObjectId, OwnerId, PathId, PedParaId, PoseId, TrajParaId,
};
use rcs_core::{
    Plain,
    name::{Name10, Name16},
};

use super::reference::{RefType, Reference};

/// POSE (VII.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseRecord {
    pub name: Name10,
    pub pose: Pose,          // as entered, 0.01 in
    pub movetable: MovtabId, // corrects the pose; null for `...`
    /// The orthogonal frame of the points (X is kept), after the movetable; world coordinates, inches.
    pub frame: Frame,
}

/// MOVTAB (VII.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovtabRecord {
    pub name: Name10,
    pub movetable: Movetable,
}

/// LOCPT (VII.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locpt {
    pub name: Name10,
    pub pose: PoseId,
    pub movetable: MovtabId, // null for `...`
    pub frame: Frame,        // of the pose, with the movetable; world, inches
}

/// ARRAY-TABLE: the array dimension and array location forms of one array together (VII.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Array {
    pub name: Name10,
    pub dimensions: i32, // 1 or 2
    pub columns: i32,    // first dimension, left to right
    pub rows: i32,       // second dimension, top to bottom; 1 for one dimension
    pub column_step: MovtabId,
    pub row_step: MovtabId, // null for one dimension
    pub present: i32,       // the form's `# pres`, as entered
    pub pose: PoseId,       // of a static array; null if it belongs to owners
    pub offset: MovtabId,   // of the first sector from the base
}

impl Array {
    #[must_use]
    pub fn sectors(&self) -> i32 {
        self.columns.saturating_mul(self.rows)
    }
}

/// OWNER-ASCII-NAMES (VII.5). Members are consecutive in the file of members.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    pub name: Name10,
    pub first: u32, // position of the first member, from 0
    pub count: u32,
}

/// Location point, array or pose (VII.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Member {
    pub owner: OwnerId,
    pub member: Reference,
}

/// TRAJ (VII.6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traj {
    pub name: Name10,
    pub start: Reference, // location point, array or owner
    pub end: Reference,   // location point, array or owner
    pub path: PathId,
}

/// TRAJ-PARA: parameters of a trajectory segment (VII.6). Their units are ASSUMED where the manual has none
/// (docs/design/motion.md "Units").
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TrajPara {
    /// `acc-fac`, acceleration factor: counts of 0.1 in/s for each 40 ms.
    pub acc_fac: i32,
    /// `vel-max`, greatest velocity: counts of 0.1 in/s.
    pub vel_max: i32,
    /// `smooth-acc`: a greater value is less smoothing.
    pub smooth: i32,
    /// `brk-dst`: distance from the goal at which the next point may be begun, 0.01 in.
    pub brk_dst: i32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Pose(PoseId),
    LocationPoint(LocptId),
    /// Applied to the goal of an approach, the start of a depart, or the previous point of a trajectory.
    Movetable(MovtabId),
    Stop, // the goal: last point of an approach
}

/// PATH-PTS: a `-ppt` line (VII.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathPoint {
    pub para: TrajParaId, // of the segment that leads here
    pub target: Target,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    pub first: u32, // position of the first point, from 0
    pub count: u32, // 0: no intermediate points
}

/// OBJ-ASCII-NAMES (VII.7.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Object {
    pub name: Name16,
}

/// END-EFF-PARA: openings and force of a grip of an object (VII.7.1).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct EndEffPara {
    /// The object.
    pub object: ObjectId,
    /// Reference grip number.
    pub grip: i32,
    /// Opening while the object is approached, 0.01 in.
    pub appr_size: i32,
    /// Opening that is commanded to grasp it, 0.01 in.
    pub grasp_size: i32,
    /// Grasp force, lb.
    pub grasp_force: i32,
    /// Opening after the release of the object, 0.01 in.
    pub depart_size: i32,
}

/// OBJ-GRIPS: which gripper handles an object (VII.7.2).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjGrips {
    /// The object.
    pub object: ObjectId,
    /// `endeff-id#`: 1 parts, 2 v-blocks, 3 tool gripper.
    pub endeff_id: i32,
    /// `tray-grip#`: grip number at the trays.
    pub tray_grip: i32,
}

/// The object location form (VII.7.3): the array or location point at an owner to which an object is assigned.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ObjLoc {
    /// The object.
    pub object: ObjectId,
    /// Array or location point to which it is assigned.
    pub assigned: Reference,
}

/// PED-PARA: how the Active Pedestal grips an object (VII.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PedPara {
    /// `"p-object"`.
    pub object: ObjectId,
    /// `ped-appr`: opening to receive the object, 0.01 in.
    pub appr: i32,
    /// `ped-grasp-size`, 0.01 in.
    pub grasp_size: i32,
    /// `ped-force`, lb.
    pub force: i32,
    /// `ped-release-size`, 0.01 in.
    pub release_size: i32,
    /// `ped-table-pos`: table angle when the object is first grasped, 0.1 degree.
    pub table_pos: i32,
    /// `ped-flip-angle`: rotation that flips it, 0.1 degree.
    pub flip_angle: i32,
}

/// GRIP-LOC: the movetable of a grip at a location (VII.7.5).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct GripLoc {
    /// The object.
    pub object: ObjectId,
    /// Grip number.
    pub grip: i32,
    /// Location point, array, owner or `$$$`.
    pub at: Reference,
    /// Movetable from the location to the grip.
    pub movetable: MovtabId,
}

/// VISION-PARA: how an object is found with the camera at a location (VII.7.6).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct VisionPara {
    /// The object.
    pub object: ObjectId,
    /// Reference grip number.
    pub grip: i32,
    /// Number of the object in the vision system.
    pub id: i32,
    /// Location point, array, owner or `$$$`.
    pub at: Reference,
    /// `vu-offset`: movetable from the location to the place where the first picture is taken.
    pub movetable: MovtabId,
    /// `mov-ref`: type of the frame to which the movetable is applied: location point, array or object.
    pub offset_from: RefType,
    /// Expected range from image plane to object, mm.
    pub range: i32,
    /// True if vision is used for the object.
    pub enabled: bool,
}

/// Approach or depart (VII.7.7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Direction {
    /// `-appr`.
    #[text = "-appr"]
    Approach,
    /// `-dept`.
    #[text = "-dept"]
    Depart,
}

/// An approach or depart trajectory (VII.7.7).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ApprDept {
    /// Approach or depart.
    pub direction: Direction,
    /// Object, view of an object, or a plain location point, array, owner or `$$$`.
    pub subject: Reference,
    /// Grip number; 0 for a plain location.
    pub grip: i32,
    /// Where it applies: location point, array, owner or `$$$`; the same as the subject for a plain location.
    pub at: Reference,
    /// Its points.
    pub path: PathId,
}

/// The signal that a guarded move watches (III.3.4, III.3.6, III.3.8). The manual has no form for sensors; this project
/// chose the words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SensorSource {
    /// Force along the tool's X.
    Fx,
    /// Force along the tool's Y.
    Fy,
    /// Force along the tool's Z.
    Fz,
    /// Moment about the tool's Y.
    My,
    /// Large holster sensors: the ears are near.
    Near,
    /// Small holster sensors: the ears are seated.
    Seated,
    /// A beam between the fingers is broken.
    Beam,
}

impl SensorSource {
    /// True for a force or moment of the tool gripper, which has a threshold. The others are switches.
    #[must_use]
    pub const fn is_force(self) -> bool {
        matches!(self, Self::Fx | Self::Fy | Self::Fz | Self::My)
    }
}

/// SENSOR-PARA: a sensor that Prim can watch by name (V.1.2 `"sensor"`). An extension: the manual keeps
/// thresholds in code.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SensorPara {
    /// Name of the sensor.
    pub name: Name10,
    /// The signal that is watched.
    pub source: SensorSource,
    /// Holster: 1 right, 2 left, 3 centre. Beam: 1 to 8, 0 for any. Forces: 0.
    pub which: i32,
    /// For forces: the condition is true from this signed value on, away from 0; lb or in lb on the tool.
    pub threshold: i32,
}

/// REL-MOVES: a relative motion of a command at a location, and the sensor that guards it. An extension: the
/// manual keeps those of holsters and tool drum in code.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RelativeMove {
    /// Name that a command of E-move looks up.
    pub name: Name10,
    /// Where it applies: location point, array, owner or `$$$`.
    pub at: Reference,
    /// The movetable of the motion, applied to the start pose of the command.
    pub movetable: MovtabId,
    /// Its parameters.
    pub para: TrajParaId,
    /// Sensor of a guarded move, a name of SENSOR-PARA; empty for none.
    pub sensor: Name10,
}

pub type Numbered<'a, Id, T> = Option<(Id, &'a T)>; // a record with its number
pub type FoundEndEff<'a> = Numbered<'a, EndEffId, EndEffPara>;
pub type FoundPedPara<'a> = Numbered<'a, PedParaId, PedPara>;
