//! Locations in buffers, and as keys of the task data (VII.3 to VII.5).

use rcs_core::{Plain, name::Name10};

use crate::record_number::{ArrayId, LocptId};

/// `locpt-type`: kind of a location (VII.3 to VII.5; SPECNOTES.md, contradiction 26).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LocationKind {
    /// No location.
    #[text = ""]
    None,
    /// `lpt`: a location point.
    #[text = "lpt"]
    Point,
    /// `arr`: a sector of an array.
    #[text = "arr"]
    Array,
    /// `own`: an owner.
    #[text = "own"]
    Owner,
}

/// A location of a command or of the robot: its name and the records that identify it.
///
/// The records determine type and name, so equal sites are the same location or the same sector of an array. The
/// default names no location.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Site {
    /// `locpt-name`.
    pub location: Name10,
    /// `locpt-type`.
    pub kind: LocationKind,
    /// `locpt-^`: record of LOCPT; a static array has none.
    pub record: LocptId,
    /// Record of ARRAY-TABLE if the location is a sector (extension).
    pub array: ArrayId,
    /// The sector, from 1, if the location is one (extension).
    pub sector: Option<i32>,
}

impl Site {
    /// A location point as such.
    #[must_use]
    pub const fn point(location: Name10, record: LocptId) -> Self {
        Self { location, kind: LocationKind::Point, record, array: ArrayId::NULL, sector: None }
    }

    /// The name, if a location is named.
    #[must_use]
    pub fn name(&self) -> Option<&Name10> {
        Some(&self.location).filter(|name| !name.is_empty())
    }

    /// The key for the task data.
    #[must_use]
    pub const fn place(&self) -> Place {
        Place { kind: self.kind, locpt: self.record, array: self.array }
    }

    /// True if both are the same location, or sectors of the same tray.
    #[must_use]
    pub fn has_location_of(&self, other: &Self) -> bool {
        self.place().has_location_of(&other.place())
    }
}

/// The location point and the array on it, which select grips, approaches and trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Place {
    /// Kind of the command's location: a location point, a static array, or a sector at an owner.
    pub kind: LocationKind,
    /// The location point; null for a static array.
    pub locpt: LocptId,
    /// The array in which the sector lies; null for a location point.
    pub array: ArrayId,
}

impl Place {
    /// The place of a location point.
    #[must_use]
    pub const fn point(locpt: LocptId) -> Self {
        Self { kind: LocationKind::Point, locpt, array: ArrayId::NULL }
    }

    /// True if both are the same location: no intermediate trajectory connects them.
    #[must_use]
    pub fn has_location_of(&self, other: &Self) -> bool {
        self.locpt == other.locpt && (!self.locpt.is_null() || self.array == other.array)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sector(record: u32, array: u32, sector: i32) -> Site {
        let (record, array) = (LocptId::new(record), ArrayId::new(array));
        Site { record, array, sector: Some(sector), ..Site::default() }
    }

    #[test]
    fn sectors_of_one_tray_share_its_location() {
        assert!(sector(3, 1, 1).has_location_of(&sector(3, 2, 4)));
        assert!(sector(3, 1, 1).has_location_of(&Site::point(Name10::default(), LocptId::new(3))));
        assert!(!sector(3, 1, 1).has_location_of(&sector(4, 1, 1)));
        assert_ne!(sector(3, 1, 1), sector(3, 1, 2));
    }

    #[test]
    fn static_arrays_differ_by_their_array() {
        assert!(sector(0, 1, 1).has_location_of(&sector(0, 1, 2)));
        assert!(!sector(0, 1, 1).has_location_of(&sector(0, 2, 1)));
    }
}
