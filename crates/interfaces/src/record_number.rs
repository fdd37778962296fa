//! Record numbers: the values of the manual's variables ending in `-^` (V.1.2 `traj-para-^`, V.2.2 `pose-^-in` …).
//!
//! Each file of chapter VII has its own type. The null number is an absent value: logs show `none`, not 0.

use rcs_core::{
    Plain,
    plain::{DecodeError, Reader, Schema, Writer},
};

macro_rules! record_numbers {
    ($($(#[$meta:meta])* $name:ident;)+) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub struct $name(u32);

        impl $name {
            /// No record.
            pub const NULL: Self = Self(0);

            /// The record with a number from 1; 0 is null.
            #[must_use]
            pub const fn new(number: u32) -> Self {
                Self(number)
            }

            /// The number, 0 if null.
            #[must_use]
            pub const fn number(self) -> u32 {
                self.0
            }

            /// True if there is no record.
            #[must_use]
            pub const fn is_null(self) -> bool {
                self.0 == 0
            }

            /// Position in the file from 0; `None` if null.
            #[must_use]
            pub fn index(self) -> Option<usize> {
                usize::try_from(self.0.checked_sub(1)?).ok()
            }

            /// The number of the record at a position from 0, null if the number is too large.
            #[must_use]
            pub fn at(position: usize) -> Self {
                Self(u32::try_from(position).ok().and_then(|p| p.checked_add(1)).unwrap_or(0))
            }

            /// The record in its file.
            #[must_use]
            pub fn of<T>(self, file: &[T]) -> Option<&T> {
                file.get(self.index()?)
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                core::fmt::Display::fmt(&self.0, f)
            }
        }

        impl Plain for $name {
            const SCHEMA: Schema = Option::<u32>::SCHEMA;
            const ZERO: Self = Self::NULL;

            fn encode(&self, w: &mut Writer<'_>) {
                (!self.is_null()).then_some(self.0).encode(w);
            }

            fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
                match Option::<u32>::decode(r)? {
                    None => Ok(Self::NULL),
                    Some(0) => Err(DecodeError::BadFlag(1)),
                    Some(number) => Ok(Self(number)),
                }
            }
        }
    )+};
}

record_numbers! {
    /// Record number in POSE (VII.1).
    PoseId;
    /// Record number in MOVTAB (VII.2); null is the null movetable `...`.
    MovtabId;
    /// Record number in LOCPT (VII.3).
    LocptId;
    /// Record number in ARRAY-TABLE (VII.4).
    ArrayId;
    /// Record number in OWNER-ASCII-NAMES (VII.5).
    OwnerId;
    /// Record number in TRAJ (VII.6).
    TrajId;
    /// Record number in TRAJ-PARA (VII.6).
    TrajParaId;
    /// Number of a run of points in PATH-PTS (VII.6).
    PathId;
    /// Record number in OBJ-ASCII-NAMES (VII.7.1).
    ObjectId;
    /// Record number in END-EFF-PARA (VII.7.1).
    EndEffId;
    /// Record number in OBJ-GRIPS (VII.7.2).
    ObjGripsId;
    /// Record number in the file of the object location form (VII.7.3), which the manual does not name.
    ObjLocId;
    /// Record number in PED-PARA (VII.7.4).
    PedParaId;
    /// Record number in GRIP-LOC (VII.7.5).
    GripLocId;
    /// Record number in VISION-PARA (VII.7.6).
    VisionId;
    /// Record number in the file of the approach/depart form (VII.7.7), which the manual does not name.
    ApprDeptId;
    /// Record number in SENSOR-PARA (extension).
    SensorId;
    /// Record number in REL-MOVES (extension).
    RelativeMoveId;
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::plain::{from_bytes, to_bytes};

    #[test]
    fn numbers_count_from_one_and_zero_is_null() {
        assert_eq!(PoseId::NULL.index(), None);
        assert_eq!(PoseId::at(0), PoseId::new(1));
        assert_eq!(PoseId::new(3).index(), Some(2));
        assert_eq!(PoseId::new(3).of(&['a', 'b', 'c']), Some(&'c'));
        assert_eq!(PoseId::new(4).of(&['a', 'b', 'c']), None);
    }

    #[test]
    fn a_null_number_in_a_buffer_is_an_absent_value() {
        assert_eq!(to_bytes::<5, _>(&PoseId::NULL), to_bytes::<5, _>(&None::<u32>));
        assert_eq!(to_bytes::<5, _>(&PoseId::new(3)), to_bytes::<5, _>(&Some(3_u32)));
        for id in [PoseId::NULL, PoseId::new(3)] {
            assert_eq!(from_bytes(&to_bytes::<5, _>(&id)), Ok(id));
        }
        assert_eq!(from_bytes::<PoseId>(&to_bytes::<5, _>(&Some(0_u32))), Err(DecodeError::BadFlag(1)));
    }
}
