//! Places of task data in the words of the interfaces, and back.

use rcs_core::interface::{Reason, subtask::LocationKind};
use taskdata::files::{ArrayId, LocptId, LookupError, Place};

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
