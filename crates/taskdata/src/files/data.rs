//! All files of the task data, by record number and by name.

use geometry::{frame::Frame, movetable::Movetable};
use interfaces::record_number::{
    ArrayId, EndEffId, LocptId, MovtabId, ObjGripsId, ObjectId, OwnerId, PathId, PedParaId, PoseId, SensorId,
    TrajId, TrajParaId,
};
use rcs_core::name::Name;

use super::{
    index::{Index, PlaceIndex, grip_key, name_key},
    records::{
        ApprDept, Array, EndEffPara, FoundEndEff, FoundPedPara, GripLoc, Locpt, Member, MovtabRecord,
        ObjGrips, ObjLoc, Object, Owner, Path, PathPoint, PedPara, PoseRecord, RelativeMove, SensorPara,
        Traj, TrajPara, VisionPara,
    },
};

/// A view of files and indexes, as cheap to copy as a few pointers. `load::Store` builds it outside the tick, and
/// never changes it: blocks loaded during a run create a new generation (docs/design/ownership.md "Reload").
#[derive(Clone, Copy, Debug, Default)]
pub struct TaskData<'a> {
    pub poses: &'a [PoseRecord],
    pub movetables: &'a [MovtabRecord],
    pub locpts: &'a [Locpt],
    pub arrays: &'a [Array],
    pub owners: &'a [Owner],
    pub members: &'a [Member], // the members, grouped by owner, in the order of the forms
    pub trajectories: &'a [Traj],
    pub traj_paras: &'a [TrajPara],
    pub paths: &'a [Path],
    pub path_points: &'a [PathPoint],
    pub objects: &'a [Object],
    pub end_effs: &'a [EndEffPara],
    pub obj_grips: &'a [ObjGrips],
    pub obj_locs: &'a [ObjLoc],
    pub ped_paras: &'a [PedPara],
    pub grip_locs: &'a [GripLoc],
    pub visions: &'a [VisionPara],
    pub appr_depts: &'a [ApprDept],
    pub sensors: &'a [SensorPara],
    pub relative_moves: &'a [RelativeMove],
    pub indexes: Indexes<'a>,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Indexes<'a> {
    pub poses: Index<'a>,
    pub movetables: Index<'a>,
    pub locpts: Index<'a>,
    pub arrays: Index<'a>,
    pub owners: Index<'a>,
    pub members: Index<'a>,
    pub trajectory_names: Index<'a>,
    pub trajectories: Index<'a>, // by start and end; the answer is the path
    pub objects: Index<'a>,
    pub end_effs: Index<'a>,       // by name of the object and grip
    pub obj_grips: Index<'a>,      // by name of the object
    pub obj_locs: Index<'a>,       // by record number of the object
    pub ped_paras: Index<'a>,      // by name of the object
    pub grip_locs: PlaceIndex<'a>, // by object, grip and location; the answer is the movetable
    pub visions: PlaceIndex<'a>,   // by name of the object and location
    /// Approaches and departs by direction, object, grip and location; the answer is the path.
    pub appr_depts: PlaceIndex<'a>,
    pub sensors: Index<'a>,
    pub relative_moves: PlaceIndex<'a>, // by name and location
}

impl<'a> TaskData<'a> {
    #[must_use]
    pub fn pose(&self, id: PoseId) -> Option<&'a PoseRecord> {
        id.of(self.poses)
    }

    #[must_use]
    pub fn pose_named<const N: usize>(&self, name: &Name<N>) -> Option<PoseId> {
        self.indexes.poses.find(name_key(name)).map(PoseId::new)
    }

    /// Returns `None` for the null movetable.
    #[must_use]
    pub fn movetable(&self, id: MovtabId) -> Option<&'a Movetable> {
        id.of(self.movetables).map(|record| &record.movetable)
    }

    /// The name `...` gives [`MovtabId::NULL`].
    #[must_use]
    pub fn movetable_named<const N: usize>(&self, name: &Name<N>) -> Option<MovtabId> {
        if name.as_str() == NULL_NAME {
            return Some(MovtabId::NULL);
        }
        self.indexes.movetables.find(name_key(name)).map(MovtabId::new)
    }

    /// Applies a movetable; the null movetable changes nothing.
    #[must_use]
    pub fn moved(&self, frame: &Frame, by: MovtabId) -> Frame {
        self.movetable(by).map_or(*frame, |movetable| movetable.apply(frame))
    }

    #[must_use]
    pub fn locpt(&self, id: LocptId) -> Option<&'a Locpt> {
        id.of(self.locpts)
    }

    #[must_use]
    pub fn locpt_named<const N: usize>(&self, name: &Name<N>) -> Option<LocptId> {
        self.indexes.locpts.find(name_key(name)).map(LocptId::new)
    }

    #[must_use]
    pub fn array(&self, id: ArrayId) -> Option<&'a Array> {
        id.of(self.arrays)
    }

    #[must_use]
    pub fn array_named<const N: usize>(&self, name: &Name<N>) -> Option<ArrayId> {
        self.indexes.arrays.find(name_key(name)).map(ArrayId::new)
    }

    #[must_use]
    pub fn owner(&self, id: OwnerId) -> Option<&'a Owner> {
        id.of(self.owners)
    }

    #[must_use]
    pub fn owner_named<const N: usize>(&self, name: &Name<N>) -> Option<OwnerId> {
        self.indexes.owners.find(name_key(name)).map(OwnerId::new)
    }

    #[must_use]
    pub fn members_of(&self, id: OwnerId) -> &'a [Member] {
        self.owner(id).and_then(|owner| run(self.members, owner.first, owner.count)).unwrap_or_default()
    }

    #[must_use]
    pub fn trajectory_named<const N: usize>(&self, name: &Name<N>) -> Option<TrajId> {
        self.indexes.trajectory_names.find(name_key(name)).map(TrajId::new)
    }

    #[must_use]
    pub fn traj_para(&self, id: TrajParaId) -> Option<&'a TrajPara> {
        id.of(self.traj_paras)
    }

    #[must_use]
    pub fn path(&self, id: PathId) -> &'a [PathPoint] {
        id.of(self.paths).and_then(|path| run(self.path_points, path.first, path.count)).unwrap_or_default()
    }

    #[must_use]
    pub fn object_named<const N: usize>(&self, name: &Name<N>) -> Option<ObjectId> {
        self.indexes.objects.find(name_key(name)).map(ObjectId::new)
    }

    /// The name record (VII.7.1).
    #[must_use]
    pub fn object_record(&self, id: ObjectId) -> Option<&'a Object> {
        id.of(self.objects)
    }

    /// Grasp parameters (VII.7.1) with the record number for `obj-para-^` (V.2.2).
    #[must_use]
    pub fn object<const N: usize>(&self, object: &Name<N>, grip: i32) -> FoundEndEff<'a> {
        let id = EndEffId::new(self.indexes.end_effs.find(grip_key(object, grip)?)?);
        Some((id, id.of(self.end_effs)?))
    }

    #[must_use]
    pub fn end_eff(&self, id: EndEffId) -> Option<&'a EndEffPara> {
        id.of(self.end_effs)
    }

    /// The gripper and the tray grip (VII.7.2).
    #[must_use]
    pub fn obj_grips<const N: usize>(&self, object: &Name<N>) -> Option<&'a ObjGrips> {
        self.obj_grips_id(object)?.of(self.obj_grips)
    }

    /// The record number in OBJ-GRIPS for `obj-grip-loc-^` (V.2.2).
    #[must_use]
    pub fn obj_grips_id<const N: usize>(&self, object: &Name<N>) -> Option<ObjGripsId> {
        self.indexes.obj_grips.find(name_key(object)).map(ObjGripsId::new)
    }

    /// Grip parameters of the Active Pedestal (VII.7.4), with their record number.
    #[must_use]
    pub fn ped_para<const N: usize>(&self, object: &Name<N>) -> FoundPedPara<'a> {
        let id = PedParaId::new(self.indexes.ped_paras.find(name_key(object))?);
        Some((id, id.of(self.ped_paras)?))
    }

    /// A sensor: an extension of the manual.
    #[must_use]
    pub fn sensor<const N: usize>(&self, name: &Name<N>) -> Option<&'a SensorPara> {
        SensorId::new(self.indexes.sensors.find(name_key(name))?).of(self.sensors)
    }
}

pub const NULL_NAME: &str = "..."; // the null movetable, or no pose in an array location form (VII.2, VII.4)

fn run<T>(file: &[T], first: u32, count: u32) -> Option<&[T]> {
    let first = usize::try_from(first).ok()?;
    let count = usize::try_from(count).ok()?;
    file.get(first..first.checked_add(count)?)
}
