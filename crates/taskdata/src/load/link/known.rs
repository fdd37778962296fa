//! Look-ups that do not report unknown names, so that they can run on all processors. Entries with an unknown name are
//! linked again one by one, with reports.

use geometry::frame::Frame;

use crate::files::{
    ArrayId, GripLoc, Locpt, LocptId, MovtabId, ObjLoc, ObjectId, OwnerId, PoseId, RefType, Reference,
    data::NULL_NAME,
    index::{grip_key, name_key},
};

use super::{
    super::{
        entries::{ApprDeptEntry, GripEntry, Named, ObjLocEntry, PointAt, Typed},
        index::OwnedIndex,
        store::{Files, OwnedIndexes},
    },
    sure,
};

pub(super) fn named<const N: usize>(index: &OwnedIndex, name: &Named<N>) -> Option<u32> {
    index.view().find(name_key(&name.name))
}

/// Compares bytes, which is faster for many names.
fn is_null(name: &Named<10>) -> bool {
    name.name.bytes().strip_prefix(NULL_NAME.as_bytes()).is_some_and(|rest| rest.starts_with(&[0]))
}

#[derive(Clone, Copy)]
pub(super) struct Known<'l> {
    pub(super) files: &'l Files,
    pub(super) indexes: &'l OwnedIndexes,
}

impl Known<'_> {
    pub(super) fn movetable(&self, name: &Named<10>) -> Option<MovtabId> {
        if is_null(name) {
            return Some(MovtabId::NULL);
        }
        named(&self.indexes.movetables, name).map(MovtabId::new)
    }

    pub(super) fn object(&self, name: &Named<16>) -> Option<ObjectId> {
        named(&self.indexes.objects, name).map(ObjectId::new)
    }

    pub(super) fn reference(&self, typed: &Typed) -> Option<Reference> {
        let number = |index| named(index, &typed.name);
        Some(match typed.kind {
            RefType::Any => Reference::ANY,
            RefType::LocationPoint => Reference::location_point(LocptId::new(number(&self.indexes.locpts)?)),
            RefType::Array => Reference::array(ArrayId::new(number(&self.indexes.arrays)?)),
            RefType::Owner => Reference::owner(OwnerId::new(number(&self.indexes.owners)?)),
            RefType::Pose => Reference::pose(PoseId::new(number(&self.indexes.poses)?)),
            RefType::Object => Reference::object(self.object(&typed.name)?),
            RefType::View => Reference::view(self.object(&typed.name)?),
            RefType::None | RefType::Movetable => return None,
        })
    }

    pub(super) fn has_grip(&self, object: &Named<16>, grip: i32) -> bool {
        self.indexes.end_effs.view().find(sure(grip_key(&object.name, grip))).is_some()
    }

    pub(super) fn moved(&self, frame: &Frame, by: MovtabId) -> Frame {
        by.of(&self.files.movetables).map_or(*frame, |m| m.movetable.apply(frame))
    }

    pub(super) fn locpt(&self, entry: &PointAt) -> Option<Locpt> {
        let pose = PoseId::new(named(&self.indexes.poses, &entry.pose)?);
        let movetable = self.movetable(&entry.movetable)?;
        Some(self.locpt_at(entry, pose, movetable))
    }

    pub(super) fn locpt_at(&self, entry: &PointAt, pose: PoseId, movetable: MovtabId) -> Locpt {
        let base = pose.of(&self.files.poses).map_or_else(Frame::identity, |p| p.frame);
        Locpt { name: entry.name.name, pose, movetable, frame: self.moved(&base, movetable) }
    }

    pub(super) fn obj_loc(&self, entry: &ObjLocEntry) -> Option<ObjLoc> {
        Some(ObjLoc { object: self.object(&entry.object)?, assigned: self.reference(&entry.assigned)? })
    }

    pub(super) fn grip(&self, entry: &GripEntry) -> Option<GripLoc> {
        let (object, at) = (self.object(&entry.object)?, self.reference(&entry.place)?);
        let movetable = self.movetable(&entry.movetable)?;
        let record = GripLoc { object, grip: entry.grip, at, movetable };
        self.has_grip(&entry.object, entry.grip).then_some(record)
    }

    pub(super) fn subject(&self, entry: &ApprDeptEntry) -> Option<(Reference, Reference)> {
        let subject = self.reference(&entry.subject)?;
        let at = entry.place.as_ref().map_or(Some(subject), |place| self.reference(place))?;
        let of_object = matches!(subject.kind, RefType::Object | RefType::View);
        (!of_object || self.has_grip(&entry.subject.name, entry.grip)).then_some((subject, at))
    }
}
