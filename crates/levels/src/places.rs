//! Places of task data in the words of the interfaces, and back.

use rcs_core::interface::{Reason, subtask::LocationKind};
use taskdata::files::{ArrayId, LocptId, LookupError, Place};

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
    /// Owner of the locations that the data base keeps account of, the MBD: UNIT_1 and UNIT_2 (VII.5).
    pub const MBD: &str = "UNIT";
}

/// The place that a command names by type and record numbers.
#[must_use]
pub const fn place_of(kind: LocationKind, location_record: u32, location_array: u32) -> Place {
    Place { kind, locpt: LocptId::new(location_record), array: ArrayId::new(location_array) }
}

/// Why a look-up failed, as a reason that can travel in a status.
#[must_use]
pub const fn reason_of(error: &LookupError) -> Reason {
    match error {
        LookupError::UnknownLocation { .. } | LookupError::OwnerOnly { .. } => Reason::UnknownLocation,
        LookupError::UnknownObject { .. } => Reason::UnknownObject,
        LookupError::ObjectNeeded { .. } => Reason::NoObjectNamed,
        LookupError::NotAssigned { .. } => Reason::NoArrayForObject,
        LookupError::NoSectors { .. } | LookupError::SectorRange { .. } => Reason::SectorOutOfRange,
        LookupError::NoGrip { .. } => Reason::NoGripMovetable,
    }
}
