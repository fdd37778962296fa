//! References of names in forms (VII.4 to VII.7).

use interfaces::record_number::{ArrayId, LocptId, ObjectId, OwnerId, PoseId};
use rcs_core::Plain;

/// The kind of record to which a name in a form refers: the words of the "type" columns (VII.4 to VII.7). The manual
/// passes them as integers (`locpt-type`, `pose-type`) without giving values; these codes are ASSUMED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum RefType {
    /// Nothing.
    #[text = ""]
    None,
    /// `lpt`: a location point.
    #[text = "lpt"]
    LocationPoint,
    /// `arr`: an array.
    #[text = "arr"]
    Array,
    /// `own`: an owner.
    #[text = "own"]
    Owner,
    /// `pos`: a pose.
    #[text = "pos"]
    Pose,
    /// `mtb`: a movetable.
    #[text = "mtb"]
    Movetable,
    /// `obj`: an object.
    #[text = "obj"]
    Object,
    /// `vu`: the view location of an object.
    #[text = "vu"]
    View,
    /// `$$$`: every location that no other entry names (VII.7.5).
    #[text = "$$$"]
    Any,
}

/// A resolved type and name of a form: the record `number` of the file of `kind`.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Reference {
    /// The kind, which gives the file.
    pub kind: RefType,
    /// Record number in it; 0 for [`RefType::Any`] and [`RefType::None`].
    pub number: u32,
}

impl Reference {
    pub const NONE: Self = Self { kind: RefType::None, number: 0 };
    pub const ANY: Self = Self { kind: RefType::Any, number: 0 }; // the wild card `$$$`

    #[must_use]
    pub const fn location_point(id: LocptId) -> Self {
        Self { kind: RefType::LocationPoint, number: id.number() }
    }

    #[must_use]
    pub const fn array(id: ArrayId) -> Self {
        Self { kind: RefType::Array, number: id.number() }
    }

    #[must_use]
    pub const fn owner(id: OwnerId) -> Self {
        Self { kind: RefType::Owner, number: id.number() }
    }

    #[must_use]
    pub const fn pose(id: PoseId) -> Self {
        Self { kind: RefType::Pose, number: id.number() }
    }

    #[must_use]
    pub const fn object(id: ObjectId) -> Self {
        Self { kind: RefType::Object, number: id.number() }
    }

    #[must_use]
    pub const fn view(id: ObjectId) -> Self {
        Self { kind: RefType::View, number: id.number() }
    }
}
