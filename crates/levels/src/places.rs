//! Conversion of places of task data to records of the interfaces, and back.

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, GoneTo, LocatedObject, PlacedObject, RobotPlace, Standing},
    pose_range,
    subtask::{LocationKind, SubtaskCommand},
};
use rcs_core::{Plain, name::Name10};
use taskdata::files::{ArrayId, Location, LocptId, LookupError, Place, PoseId, Reference, TaskData};

/// Locations that the processes name themselves, because no command of the workstation controller does.
pub mod named {
    /// Where the Active Pedestal takes an object (V.3.1 FIX-GRIP).
    pub const PEDESTAL: &str = "PEDESTAL";
    /// Where the robot waits while the pedestal turns the object (V.3.1 FIX-GRIP).
    pub const PED_SAFE: &str = "PED-SAFE";
    /// The transfer location of the tool drum (V.4.1 INSERT-TOOL).
    pub const TOOL_TRNS: &str = "TOOL-TRNS";
    /// The location near the tool drum from which tools are inserted (V.4.1 INSERT-TOOL).
    pub const TOOL_SAFE: &str = "TOOL-SAFE";
    /// Owner of the fixtures in which a part stays by its weight (VII.5).
    pub const NESTS: &str = "VFIXTURE";
    /// Owner of the locations that the data base keeps account of, the MBD: UNIT_1 and UNIT_2 (VII.5).
    pub const MBD: &str = "UNIT";
}

/// What identifies a location in the task data: its records, and the sector of an array. The name alone does not
/// identify a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LocationKey {
    /// Record of LOCPT; null for a static array.
    pub point: LocptId,
    /// Record of ARRAY-TABLE; null unless the location is a sector.
    pub array: ArrayId,
    /// The sector, from 1, if it is one.
    pub sector: Option<i32>,
}

impl LocationKey {
    /// The location that a record of a buffer or of a state names.
    pub fn of<'a, Record>(record: &'a Record) -> Self
    where
        Self: From<&'a Record>,
    {
        Self::from(record)
    }

    /// The place as task data know it; `kind` is the type of the location.
    #[must_use]
    pub const fn place(self, kind: LocationKind) -> Place {
        Place { kind, locpt: self.point, array: self.array }
    }

    /// True if both are the same location, or sectors of the same array.
    #[must_use]
    pub fn has_location_of(self, other: Self) -> bool {
        same_location(&self.place(LocationKind::Point), &other.place(LocationKind::Point))
    }
}

macro_rules! location_keys {
    ($( $record:ty: $point:ident, $array:ident, $sector:ident; )+) => { $(
        impl From<&$record> for LocationKey {
            fn from(record: &$record) -> Self {
                Self {
                    point: LocptId::from_option(record.$point),
                    array: ArrayId::from_option(record.$array),
                    sector: record.$sector,
                }
            }
        }
    )+ };
}
location_keys! {
    SubtaskCommand: location_record, location_array, location_sector;
    EmoveCommand: location_record, location_array, location_sector;
    PlacedObject: record, array, sector;
    LocatedObject: record, array, sector;
    Standing: record, array, sector;
    RobotPlace: record, array, sector;
    crate::task::plan::Location: record, array, sector;
    crate::subtask::aims::Aim: record, array, sector;
}

/// True if two places are the same location: no intermediate trajectory leads from one to the other.
#[must_use]
pub fn same_location(a: &Place, b: &Place) -> bool {
    a.locpt == b.locpt && (!a.locpt.is_null() || a.array == b.array)
}

/// The place of a location point.
#[must_use]
pub const fn place_of(point: LocptId) -> Place {
    Place { kind: LocationKind::Point, locpt: point, array: ArrayId::NULL }
}

/// The robot at a location, with the tool at a frame (world, inches).
#[must_use]
pub fn robot_at(gone_to: GoneTo, at: &Location, frame: &Frame) -> RobotPlace {
    RobotPlace {
        gone_to,
        location: at.name,
        kind: at.place.kind,
        record: at.place.locpt.to_option(),
        array: at.place.array.to_option(),
        sector: at.sector,
        pose: Pose::from_frame(frame),
    }
}

/// The frame of a record of POSE, or of a changing record. World, inches.
#[must_use]
pub fn pose_of(number: u32, memory: &CommonMemory, data: &TaskData<'_>) -> Option<Frame> {
    if number >= pose_range::CHANGING {
        memory.changing_pose(number)?.to_frame().ok()
    } else {
        data.pose(PoseId::new(number)).map(|record| record.frame)
    }
}

/// True if a record of LOCPT is one of the MBD's.
#[must_use]
pub fn is_in_mbd(point: LocptId, data: &TaskData<'_>) -> bool {
    let owner = data.owner_named(&Name10::clipped(named::MBD)).filter(|_| !point.is_null());
    owner.is_some_and(|owner| data.is_member(owner, Reference::location_point(point)))
}

/// What a look-up of task data did not find: a state variable of the tables ACCEPT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Missing {
    /// Nothing: all was found.
    Nothing,
    /// The location, or it is only an owner of others.
    Location,
    /// The object.
    Object,
    /// The name of an object, which the location needs.
    ObjectName,
    /// An array of the object at the location.
    Array,
    /// The sector.
    Sector,
    /// The grip of the object.
    Grip,
    /// The grip movetable of object, grip and location.
    GripMovetable,
    /// The holster of a gripper.
    Holster,
}

impl From<LookupError> for Missing {
    fn from(error: LookupError) -> Self {
        match error {
            LookupError::UnknownLocation { .. } | LookupError::OwnerOnly { .. } => Self::Location,
            LookupError::UnknownObject { .. } => Self::Object,
            LookupError::ObjectNeeded { .. } => Self::ObjectName,
            LookupError::NotAssigned { .. } => Self::Array,
            LookupError::NoSectors { .. } | LookupError::SectorRange { .. } => Self::Sector,
            LookupError::NoGrip { .. } => Self::GripMovetable,
        }
    }
}
