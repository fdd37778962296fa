//! Entries of the forms before their names are looked up: one for each record or group of records.

use diagnostics::{At, BlockNumber};
use geometry::movetable::MovetableLine;
use rcs_core::name::Name;

use crate::files::{Direction, RefType, SensorSource, TrajPara};

/// A name and its place.
#[derive(Clone, Copy, Debug)]
pub struct Named<const N: usize> {
    /// The name.
    pub name: Name<N>,
    /// Place of the name.
    pub at: At,
}

/// A type and a name, from the "type" and "name" columns of a form.
#[derive(Clone, Copy, Debug)]
pub struct Typed {
    /// The type.
    pub kind: RefType,
    /// The name; the word `$$$` itself for [`RefType::Any`].
    pub name: Named<16>,
}

/// A `-ppt` line.
#[derive(Clone, Copy, Debug)]
pub struct PointEntry {
    /// Parameters.
    pub para: TrajPara,
    /// The point; `None` for `stop`.
    pub target: Option<Typed>,
    /// Place of the whole line.
    pub at: At,
}

/// `-pose-` (VII.1).
#[derive(Clone, Debug)]
pub struct PoseEntry {
    /// Wrist, tool and finger point: X, Y, Z, 0.01 in.
    pub points: [[i32; 3]; 3],
    /// Place of the nine numbers.
    pub at: At,
    /// Movetable.
    pub movetable: Named<10>,
    /// Name.
    pub name: Named<10>,
}

/// A movetable (VII.2).
#[derive(Clone, Debug)]
pub struct MovetableEntry {
    /// Its lines, at most eight.
    pub lines: Vec<MovetableLine>,
    /// Name.
    pub name: Named<10>,
}

/// `-pt-` (VII.3) and `-ar-` (VII.4): a name at a pose and a movetable.
#[derive(Clone, Debug)]
pub struct PointAt {
    /// Name.
    pub name: Named<10>,
    /// Pose.
    pub pose: Named<10>,
    /// Movetable.
    pub movetable: Named<10>,
}

/// `-arr-` (VII.4).
#[derive(Clone, Debug)]
pub struct ArrayEntry {
    /// Name.
    pub name: Named<10>,
    /// Number of dimensions, 1 or 2.
    pub dimensions: i32,
    /// Elements in the first dimension.
    pub columns: i32,
    /// Elements in the second dimension, 1 if there is none.
    pub rows: i32,
    /// Offset in the first dimension.
    pub column_step: Named<10>,
    /// Offset in the second dimension.
    pub row_step: Option<Named<10>>,
    /// `# pres`.
    pub present: i32,
}

/// `-own-` (VII.5).
#[derive(Clone, Debug)]
pub struct OwnerEntry {
    /// Name.
    pub name: Named<10>,
    /// Members.
    pub members: Vec<Typed>,
}

/// `-traj` (VII.6).
#[derive(Clone, Debug)]
pub struct TrajEntry {
    /// Name.
    pub name: Named<10>,
    /// Start.
    pub start: Typed,
    /// End.
    pub end: Typed,
    /// Points.
    pub points: Vec<PointEntry>,
}

/// `-obj-` (VII.7.1).
#[derive(Clone, Debug)]
pub struct ObjectEntry {
    /// Name.
    pub name: Named<16>,
    /// Grip number.
    pub grip: i32,
    /// Place of name and grip number, to underline.
    pub at: At,
    /// Approach, grasp, force and depart, as in the form.
    pub values: [i32; 4],
}

/// A record entered in Show mode, `:S … <= … :R >FILE` (VII.7.2, VII.7.4).
#[derive(Clone, Debug)]
pub struct ShowEntry<const N: usize> {
    /// The object.
    pub object: Named<16>,
    /// The other variables, in the order of the record.
    pub values: [i32; N],
}

/// `-o-loc-` (VII.7.3).
#[derive(Clone, Debug)]
pub struct ObjLocEntry {
    /// Object.
    pub object: Named<16>,
    /// Assigned array or location point.
    pub assigned: Typed,
}

/// `-grip-` (VII.7.5).
#[derive(Clone, Debug)]
pub struct GripEntry {
    /// Object.
    pub object: Named<16>,
    /// Grip number.
    pub grip: i32,
    /// Location.
    pub place: Typed,
    /// Movetable.
    pub movetable: Named<10>,
}

/// `-vu-` (VII.7.6).
#[derive(Clone, Debug)]
pub struct ViewEntry {
    /// Object.
    pub object: Named<16>,
    /// Grip number.
    pub grip: i32,
    /// Number in the vision system.
    pub id: i32,
    /// Location.
    pub place: Typed,
    /// Offset of the view.
    pub movetable: Named<10>,
    /// Type of the frame to which the movetable is applied.
    pub offset_from: RefType,
    /// Expected range, mm.
    pub range: i32,
    /// `en`.
    pub enabled: bool,
}

/// `-appr` or `-dept` (VII.7.7).
#[derive(Clone, Debug)]
pub struct ApprDeptEntry {
    /// Approach or depart.
    pub direction: Direction,
    /// Object, view of an object, or location.
    pub subject: Typed,
    /// Grip number, 0 for a location.
    pub grip: i32,
    /// Location of the object; `None` if the subject is itself a location.
    pub place: Option<Typed>,
    /// Points.
    pub points: Vec<PointEntry>,
    /// Place from the compiling word to the location.
    pub at: At,
}

/// `-sen-` (extension): a sensor of a guarded move.
#[derive(Clone, Debug)]
pub struct SensorEntry {
    /// Name.
    pub name: Named<10>,
    /// The signal that is watched.
    pub source: SensorSource,
    /// Number of the holster or beam.
    pub which: i32,
    /// Threshold of a force or moment, lb or in lb.
    pub threshold: i32,
}

/// `-rel-` (extension): a relative move of a command at a location.
#[derive(Clone, Debug)]
pub struct RelativeEntry {
    /// Name that a command looks for.
    pub name: Named<10>,
    /// Location at which it applies.
    pub place: Typed,
    /// Parameters.
    pub para: TrajPara,
    /// Movetable that gives the goal.
    pub movetable: Named<10>,
    /// Sensor of a guarded move.
    pub sensor: Option<Named<10>>,
    /// Place of the whole entry.
    pub at: At,
}

/// `-file-` (extension): the greatest number of records in a file.
#[derive(Clone, Debug)]
pub struct FileEntry {
    /// The file, one of [`super::store::FILE_NAMES`].
    pub file: &'static str,
    /// Greatest number of records.
    pub records: usize,
    /// Place of the declaration.
    pub at: At,
}

/// An entry of any form.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A file declaration (VII).
    File(FileEntry),
    /// VII.1.
    Pose(PoseEntry),
    /// VII.2.
    Movetable(MovetableEntry),
    /// VII.3.
    Locpt(PointAt),
    /// VII.4, dimensions.
    Array(ArrayEntry),
    /// VII.4, location.
    ArrayAt(PointAt),
    /// VII.5.
    Owner(OwnerEntry),
    /// VII.6.
    Traj(TrajEntry),
    /// VII.7.1.
    Object(ObjectEntry),
    /// VII.7.2: `endeff-id#`, `tray-grip#`.
    ObjGrips(ShowEntry<2>),
    /// VII.7.3.
    ObjLoc(ObjLocEntry),
    /// VII.7.4: appr, grasp size, force, release size, table position, flip angle.
    PedPara(ShowEntry<6>),
    /// VII.7.5.
    Grip(GripEntry),
    /// VII.7.6.
    View(ViewEntry),
    /// VII.7.7.
    ApprDept(ApprDeptEntry),
    /// Extension: sensors of guarded moves.
    Sensor(SensorEntry),
    /// Extension: relative moves.
    Relative(RelativeEntry),
}

/// A `n load` or `offset n OLOAD` of a directory block (VIII.9, IV.2.8).
#[derive(Clone, Copy, Debug)]
pub struct LoadLine {
    /// The block.
    pub block: BlockNumber,
    /// Place of the line.
    pub at: At,
}
