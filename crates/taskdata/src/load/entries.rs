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

/// A type and a name, from the columns of a form.
#[derive(Clone, Copy, Debug)]
pub struct Typed {
    pub kind: RefType,
    pub name: Named<16>, // the word `$$$` itself for `RefType::Any`
}

/// A `-ppt` line.
#[derive(Clone, Copy, Debug)]
pub struct PointEntry {
    pub para: TrajPara,
    pub target: Option<Typed>, // `None` for `stop`
    pub at: At,
}

/// `-pose-` (VII.1).
#[derive(Clone, Debug)]
pub struct PoseEntry {
    pub points: [[i32; 3]; 3], // wrist, tool, finger point: X, Y, Z, 0.01 in
    pub at: At,
    pub movetable: Named<10>,
    pub name: Named<10>,
}

#[derive(Clone, Debug)]
pub struct MovetableEntry {
    pub lines: Vec<MovetableLine>, // at most eight
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
    pub dimensions: i32,             // 1 or 2
    pub columns: i32,                // elements of the first dimension
    pub rows: i32,                   // elements of the second dimension, or 1
    pub column_step: Named<10>,      // in the first dimension
    pub row_step: Option<Named<10>>, // in the second dimension
    pub present: i32,                // `# pres`
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
    pub at: At,           // name and grip number, to underline
    pub values: [i32; 4], // approach, grasp, force and depart
}

/// A record of Show mode, `:S … <= … :R >FILE` (VII.7.2, VII.7.4).
#[derive(Clone, Debug)]
pub struct ShowEntry<const N: usize> {
    pub object: Named<16>,
    pub values: [i32; N], // in the order of the record
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
    pub offset_from: RefType, // of the frame for the movetable
    pub range: i32,           // expected, mm
    pub enabled: bool,        // `en`
}

/// `-appr` or `-dept` (VII.7.7).
#[derive(Clone, Debug)]
pub struct ApprDeptEntry {
    pub direction: Direction,
    pub subject: Typed,       // object, view of an object, or location
    pub grip: i32,            // 0 for a location
    pub place: Option<Typed>, // `None`: the subject is itself a location
    pub points: Vec<PointEntry>,
    pub at: At, // from the compiling word to the location
}

/// `-sen-` (extension): a sensor of a guarded move.
#[derive(Clone, Debug)]
pub struct SensorEntry {
    pub name: Named<10>,
    pub source: SensorSource,
    pub which: i32,     // of the holster or beam
    pub threshold: i32, // of a force or moment, lb or in lb
}

/// `-rel-` (extension): a relative move of a command at a location.
#[derive(Clone, Debug)]
pub struct RelativeEntry {
    pub name: Named<10>, // that a command looks for
    pub place: Typed,
    pub para: TrajPara,
    pub movetable: Named<10>,
    pub sensor: Option<Named<10>>,
    pub at: At,
}

/// `-file-` (extension): the greatest number of records in a file.
#[derive(Clone, Debug)]
pub struct FileEntry {
    pub file: &'static str, // one of `super::store::FILE_NAMES`
    pub records: usize,
    pub at: At,
}

#[derive(Clone, Debug)]
pub enum Entry {
    File(FileEntry),
    Pose(PoseEntry),           // VII.1
    Movetable(MovetableEntry), // VII.2
    Locpt(PointAt),            // VII.3
    Array(ArrayEntry),         // VII.4, dimensions
    ArrayAt(PointAt),          // VII.4, location
    Owner(OwnerEntry),         // VII.5
    Traj(TrajEntry),           // VII.6
    Object(ObjectEntry),       // VII.7.1
    ObjGrips(ShowEntry<2>),    // VII.7.2: `endeff-id#`, `tray-grip#`
    ObjLoc(ObjLocEntry),       // VII.7.3
    PedPara(ShowEntry<6>),     // VII.7.4: appr, grasp size, force, release size, table position, flip angle
    Grip(GripEntry),           // VII.7.5
    View(ViewEntry),           // VII.7.6
    ApprDept(ApprDeptEntry),   // VII.7.7
    Sensor(SensorEntry),
    Relative(RelativeEntry),
}

/// A `n load` or `offset n OLOAD` of a directory block (VIII.9, IV.2.8).
#[derive(Clone, Copy, Debug)]
pub struct LoadLine {
    pub block: BlockNumber,
    pub at: At,
}
