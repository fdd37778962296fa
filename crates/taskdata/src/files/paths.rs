//! Grips, views, approaches, departs and trajectories at a place (VII.6, VII.7).
//!
//! The entry for the exact location point has priority, then that for the array on it, for an owner, for the wild card
//! `$$$` (VII.7.5). A trajectory needs an entry for both ends, has no wild card, and is used only from start to end.

use geometry::frame::Frame;
use interfaces::{
    location::Place,
    record_number::{GripLocId, MovtabId, ObjectId, PathId, RelativeMoveId, TrajId, VisionId},
};
use rcs_core::name::{Name, Name16};

use super::{
    data::TaskData,
    index::{EntryAt, Key, PlaceIndex, approach_key, grip_at_key, name_at_key, pair_key, plain_key},
    locations::{Location, LookupError},
    records::{Direction, PathPoint, RelativeMove, Target, VisionPara},
    reference::{RefType, Reference},
};

impl<'a> TaskData<'a> {
    fn at_place(&self, index: &PlaceIndex<'a>, key: Key, place: &Place) -> Option<EntryAt> {
        index.first(key, Self::exact(place), self.owners(place))
    }

    /// The movetable (VII.7.5); null if the form names `...`.
    #[must_use]
    pub fn grip_movetable<const N: usize>(
        &self,
        object: &Name<N>,
        grip: i32,
        place: &Place,
    ) -> Option<MovtabId> {
        let key = grip_at_key(object, grip, Reference::ANY)?;
        self.at_place(&self.indexes.grip_locs, key, place).map(|entry| MovtabId::new(entry.answer))
    }

    /// The record number in GRIP-LOC (VII.7.5).
    #[must_use]
    pub fn grip_loc<const N: usize>(&self, object: &Name<N>, grip: i32, place: &Place) -> Option<GripLocId> {
        let key = grip_at_key(object, grip, Reference::ANY)?;
        self.at_place(&self.indexes.grip_locs, key, place).map(|entry| GripLocId::new(entry.number))
    }

    pub fn grip_frame<const N: usize>(
        &self,
        object: &Name<N>,
        grip: i32,
        location: &Location,
    ) -> Result<Frame, LookupError> {
        let movetable = self.grip_movetable(object, grip, &location.place).ok_or_else(|| {
            LookupError::NoGrip { object: Name::clipped(object.as_str()), grip, location: location.name }
        })?;
        Ok(self.moved(&location.frame, movetable))
    }

    /// View parameters (VII.7.6), with the record number for `obj-vision-para-^` (V.2.2).
    #[must_use]
    pub fn view<const N: usize>(
        &self,
        object: &Name<N>,
        place: &Place,
    ) -> Option<(VisionId, &'a VisionPara)> {
        let key = name_at_key(object, Reference::ANY);
        let id = VisionId::new(self.at_place(&self.indexes.visions, key, place)?.number);
        Some((id, id.of(self.visions)?))
    }

    #[must_use]
    pub fn vision_para(&self, id: VisionId) -> Option<&'a VisionPara> {
        id.of(self.visions)
    }

    /// The approach to an object (VII.7.7). Its last point is [`Target::Stop`].
    #[must_use]
    pub fn approach<const N: usize>(&self, object: &Name<N>, grip: i32, place: &Place) -> Option<PathId> {
        self.appr_dept(Direction::Approach, RefType::Object, object, grip, place)
    }

    #[must_use]
    pub fn depart<const N: usize>(&self, object: &Name<N>, grip: i32, place: &Place) -> Option<PathId> {
        self.appr_dept(Direction::Depart, RefType::Object, object, grip, place)
    }

    /// The approach to the camera's place (VII.7.7, type `vu`).
    #[must_use]
    pub fn view_approach<const N: usize>(
        &self,
        object: &Name<N>,
        grip: i32,
        place: &Place,
    ) -> Option<PathId> {
        self.appr_dept(Direction::Approach, RefType::View, object, grip, place)
    }

    /// The depart from the camera's place (VII.7.7, type `vu`).
    #[must_use]
    pub fn view_depart<const N: usize>(&self, object: &Name<N>, grip: i32, place: &Place) -> Option<PathId> {
        self.appr_dept(Direction::Depart, RefType::View, object, grip, place)
    }

    /// The approach to a location itself (VII.7.7, types `lpt`, `arr`, `own`).
    #[must_use]
    pub fn approach_location(&self, place: &Place) -> Option<PathId> {
        self.plain(Direction::Approach, place)
    }

    #[must_use]
    pub fn depart_location(&self, place: &Place) -> Option<PathId> {
        self.plain(Direction::Depart, place)
    }

    fn appr_dept<const N: usize>(
        &self,
        direction: Direction,
        kind: RefType,
        object: &Name<N>,
        grip: i32,
        place: &Place,
    ) -> Option<PathId> {
        let key = approach_key(direction, kind, object, grip, Reference::ANY)?;
        self.at_place(&self.indexes.appr_depts, key, place).map(|entry| PathId::new(entry.answer))
    }

    fn plain(&self, direction: Direction, place: &Place) -> Option<PathId> {
        let key = plain_key(direction, Reference::ANY);
        self.at_place(&self.indexes.appr_depts, key, place).map(|entry| PathId::new(entry.answer))
    }

    /// A relative move: an extension of the manual.
    #[must_use]
    pub fn relative_move<const N: usize>(&self, name: &Name<N>, place: &Place) -> Option<&'a RelativeMove> {
        let key = name_at_key(name, Reference::ANY);
        let entry = self.at_place(&self.indexes.relative_moves, key, place)?;
        RelativeMoveId::new(entry.number).of(self.relative_moves)
    }

    /// The intermediate trajectory (VII.6): exact names have priority, then the owner of the end, of the start, of
    /// both.
    #[must_use]
    pub fn trajectory(&self, from: &Place, to: &Place) -> Option<PathId> {
        self.between(from, to, |key| self.indexes.trajectories.answer(key)).map(PathId::new)
    }

    #[must_use]
    pub fn trajectory_id(&self, from: &Place, to: &Place) -> Option<TrajId> {
        self.between(from, to, |key| self.indexes.trajectories.find(key)).map(TrajId::new)
    }

    fn between(&self, from: &Place, to: &Place, find: impl Fn(Key) -> Option<u32>) -> Option<u32> {
        let ends = self.aliases(to);
        self.aliases(from).find_map(|start| ends.clone().find_map(|end| find(pair_key(start, end))))
    }

    /// The frame of a point; `None` if it names a missing record. `reference` is the goal of an approach, the start of
    /// a depart, the previous point of a trajectory.
    #[must_use]
    pub fn point_frame(&self, point: &PathPoint, reference: &Frame) -> Option<Frame> {
        match point.target {
            Target::Pose(id) => self.pose(id).map(|record| record.frame),
            Target::LocationPoint(id) => self.locpt(id).map(|record| record.frame),
            Target::Movetable(id) => Some(self.moved(reference, id)),
            Target::Stop => Some(*reference),
        }
    }

    #[must_use]
    pub fn object_name(&self, id: ObjectId) -> Name16 {
        self.object_record(id).map_or(Name16::EMPTY, |record| record.name)
    }
}
