use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory,
    emove::{GoneTo, RobotPlace},
    pose_range,
};
use rcs_core::{Plain, name::Name10};
use taskdata::files::{Location, LocptId, LookupError, PoseId, Reference, TaskData};

/// Locations that the processes name themselves; no command of the workstation controller names them.
pub mod named {
    /// Where the Active Pedestal takes an object (V.3.1 FIX-GRIP).
    pub const PEDESTAL: &str = "PEDESTAL";
    /// Where the robot waits while the pedestal turns the object (V.3.1 FIX-GRIP).
    pub const PED_SAFE: &str = "PED-SAFE";
    /// The transfer location of the tool drum (V.4.1 INSERT-TOOL).
    pub const TOOL_TRNS: &str = "TOOL-TRNS";
    /// The location near the tool drum from which tools are inserted (V.4.1 INSERT-TOOL).
    pub const TOOL_SAFE: &str = "TOOL-SAFE";
    /// Owner of the fixtures in which a part rests by its weight (VII.5).
    pub const NESTS: &str = "VFIXTURE";
    /// Owner of the locations that the database tracks, the MBD: UNIT_1 and UNIT_2 (VII.5).
    pub const MBD: &str = "UNIT";
}

/// The robot at a location, with the tool at a frame (world, inches).
#[must_use]
pub fn robot_at(gone_to: GoneTo, at: &Location, frame: &Frame) -> RobotPlace {
    RobotPlace { gone_to, site: at.site(), pose: Pose::from_frame(frame) }
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

#[must_use]
pub fn is_in_mbd(point: LocptId, data: &TaskData<'_>) -> bool {
    let owner = data.owner_named(&Name10::clipped(named::MBD)).filter(|_| !point.is_null());
    owner.is_some_and(|owner| data.is_member(owner, Reference::location_point(point)))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Missing {
    /// No entry is missing.
    Nothing,
    /// The location is missing, or is only an owner of others.
    Location,
    /// The object is missing.
    Object,
    /// The location requires the name of an object.
    ObjectName,
    /// The object has no array at the location.
    Array,
    /// The array does not have the sector.
    Sector,
    /// The object does not have the grip.
    Grip,
    /// Object, grip and location have no grip movetable.
    GripMovetable,
    /// The gripper has no holster.
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
