//! Entries of the forms before their names are looked up: one per record or group of records.

use diagnostics::{At, BlockNumber};
use geometry::movetable::MovetableLine;
use rcs_core::name::Name;

use crate::files::{Direction, RefType, SensorSource, TrajPara};

#[derive(Clone, Copy, Debug)]
pub struct Named<const N: usize> {
    pub name: Name<N>,
    pub at: At,
}

/// A type and a name, from the "type" and "name" columns of a form.
#[derive(Clone, Copy, Debug)]
pub struct Typed {
    pub kind: RefType,
    /// The name; the word `$$$` itself for [`RefType::Any`].
    pub name: Named<16>,
}

/// A `-ppt` line.
#[derive(Clone, Copy, Debug)]
pub struct PointEntry {
    pub para: TrajPara,
    /// The point; `None` for `stop`.
    pub target: Option<Typed>,
    pub at: At,
}

/// `-pose-` (VII.1).
#[derive(Clone, Debug)]
pub struct PoseEntry {
    /// Wrist, tool and finger point: X, Y, Z, 0.01 in.
    pub points: [[i32; 3]; 3],
    pub at: At,
    pub movetable: Named<10>,
    pub name: Named<10>,
}

/// A movetable (VII.2).
#[derive(Clone, Debug)]
pub struct MovetableEntry {
    /// Its lines, at most eight.
    pub lines: Vec<MovetableLine>,
    pub name: Named<10>,
}

/// `-pt-` (VII.3) and `-ar-` (VII.4): a name at a pose and a movetable.
#[derive(Clone, Debug)]
pub struct PointAt {
    pub name: Named<10>,
    pub pose: Named<10>,
    pub movetable: Named<10>,
}

/// `-arr-` (VII.4).
#[derive(Clone, Debug)]
pub struct ArrayEntry {
    pub name: Named<10>,
    /// Number of dimensions, 1 or 2.
    pub dimensions: i32,
    /// Elements in the first dimension.
    pub columns: i32,
    /// Elements in the second dimension, or 1.
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
    pub name: Named<10>,
    pub members: Vec<Typed>,
}

/// `-traj` (VII.6).
#[derive(Clone, Debug)]
pub struct TrajEntry {
    pub name: Named<10>,
    pub start: Typed,
    pub end: Typed,
    pub points: Vec<PointEntry>,
}

/// `-obj-` (VII.7.1).
#[derive(Clone, Debug)]
pub struct ObjectEntry {
    pub name: Named<16>,
    pub grip: i32,
    /// Place of name and grip number, to underline.
    pub at: At,
    /// Approach, grasp, force and depart, as in the form.
    pub values: [i32; 4],
}

/// A record entered in Show mode, `:S … <= … :R >FILE` (VII.7.2, VII.7.4).
#[derive(Clone, Debug)]
pub struct ShowEntry<const N: usize> {
    pub object: Named<16>,
    /// The other variables, in the order of the record.
    pub values: [i32; N],
}

/// `-o-loc-` (VII.7.3).
#[derive(Clone, Debug)]
pub struct ObjLocEntry {
    pub object: Named<16>,
    pub assigned: Typed,
}

/// `-grip-` (VII.7.5).
#[derive(Clone, Debug)]
pub struct GripEntry {
    pub object: Named<16>,
    pub grip: i32,
    pub place: Typed,
    pub movetable: Named<10>,
}

/// `-vu-` (VII.7.6).
#[derive(Clone, Debug)]
pub struct ViewEntry {
    pub object: Named<16>,
    pub grip: i32,
    pub id: i32,
    pub place: Typed,
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
    pub direction: Direction,
    /// Object, view of an object, or location.
    pub subject: Typed,
    /// Grip number, 0 for a location.
    pub grip: i32,
    /// Location of the object; `None` if the subject is itself a location.
    pub place: Option<Typed>,
    pub points: Vec<PointEntry>,
    /// Place from the compiling word to the location.
    pub at: At,
}

/// `-sen-` (extension): a sensor of a guarded move.
#[derive(Clone, Debug)]
pub struct SensorEntry {
    pub name: Named<10>,
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
    pub place: Typed,
    pub para: TrajPara,
    pub movetable: Named<10>,
    pub sensor: Option<Named<10>>,
    pub at: At,
}

/// `-file-` (extension): the greatest number of records in a file.
#[derive(Clone, Debug)]
pub struct FileEntry {
    /// The file, one of [`super::store::FILE_NAMES`].
    pub file: &'static str,
    pub records: usize,
    pub at: At,
}

#[derive(Clone, Debug)]
pub enum Entry {
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
    Sensor(SensorEntry),
    Relative(RelativeEntry),
}

/// A `n load` or `offset n OLOAD` of a directory block (VIII.9, IV.2.8).
#[derive(Clone, Copy, Debug)]
pub struct LoadLine {
    pub block: BlockNumber,
    pub at: At,
}
