//! The files of a load, owned: what [`TaskData`] is a view of.

use crate::files::{
    ApprDept, Array, EndEffPara, GripLoc, Index, Locpt, Member, MovtabRecord, ObjGrips, ObjLoc, Object,
    Owner, Path, PathPoint, PedPara, PoseRecord, RelativeMove, SensorPara, TaskData, Traj, TrajPara,
    VisionPara, data::Indexes,
};

use super::{report::Loaded, source::Source};

/// Records that a file can hold (DESIGN 7); one more is the manual's FILE FULL.
pub const FILE_RECORDS: usize = 100_000;

/// The records of all files. See [`TaskData`] for what each is.
#[derive(Clone, Debug, Default)]
pub(super) struct Files {
    pub poses: Vec<PoseRecord>,
    pub movetables: Vec<MovtabRecord>,
    pub locpts: Vec<Locpt>,
    pub arrays: Vec<Array>,
    pub owners: Vec<Owner>,
    pub members: Vec<Member>,
    pub trajectories: Vec<Traj>,
    pub traj_paras: Vec<TrajPara>,
    pub paths: Vec<Path>,
    pub path_points: Vec<PathPoint>,
    pub objects: Vec<Object>,
    pub end_effs: Vec<EndEffPara>,
    pub obj_grips: Vec<ObjGrips>,
    pub obj_locs: Vec<ObjLoc>,
    pub ped_paras: Vec<PedPara>,
    pub grip_locs: Vec<GripLoc>,
    pub visions: Vec<VisionPara>,
    pub appr_depts: Vec<ApprDept>,
    pub sensors: Vec<SensorPara>,
    pub relative_moves: Vec<RelativeMove>,
}

/// An index, owned.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorted {
    pub keys: Vec<u128>,
    pub numbers: Vec<u32>,
}

impl Sorted {
    /// Sort keys, given in the order of the records or with the record number of each. Equal keys keep their order.
    pub fn new(mut pairs: Vec<(u128, u32)>) -> Self {
        pairs.sort_by_key(|pair| pair.0);
        let (keys, numbers) = pairs.into_iter().unzip();
        Self { keys, numbers }
    }

    pub fn view(&self) -> Index<'_> {
        Index::sorted(&self.keys, &self.numbers)
    }
}

/// The indexes of all files. See [`Indexes`] for their keys.
#[derive(Clone, Debug, Default)]
pub(super) struct SortedIndexes {
    pub poses: Sorted,
    pub movetables: Sorted,
    pub locpts: Sorted,
    pub arrays: Sorted,
    pub owners: Sorted,
    pub members: Sorted,
    pub trajectory_names: Sorted,
    pub trajectories: Sorted,
    pub objects: Sorted,
    pub end_effs: Sorted,
    pub obj_grips: Sorted,
    pub obj_locs: Sorted,
    pub ped_paras: Sorted,
    pub grip_locs: Sorted,
    pub visions: Sorted,
    pub appr_depts: Sorted,
    pub sensors: Sorted,
    pub relative_moves: Sorted,
}

/// Loaded task data: the files, their indexes and the text that they came from.
#[derive(Clone, Debug, Default)]
pub struct Store {
    pub(super) files: Files,
    pub(super) indexes: SortedIndexes,
    pub(super) sources: Vec<Source>,
}

impl Store {
    /// What the control processes look into.
    #[must_use]
    pub fn view(&self) -> TaskData<'_> {
        let (files, indexes) = (&self.files, &self.indexes);
        TaskData {
            poses: &files.poses,
            movetables: &files.movetables,
            locpts: &files.locpts,
            arrays: &files.arrays,
            owners: &files.owners,
            members: &files.members,
            trajectories: &files.trajectories,
            traj_paras: &files.traj_paras,
            paths: &files.paths,
            path_points: &files.path_points,
            objects: &files.objects,
            end_effs: &files.end_effs,
            obj_grips: &files.obj_grips,
            obj_locs: &files.obj_locs,
            ped_paras: &files.ped_paras,
            grip_locs: &files.grip_locs,
            visions: &files.visions,
            appr_depts: &files.appr_depts,
            sensors: &files.sensors,
            relative_moves: &files.relative_moves,
            indexes: Indexes {
                poses: indexes.poses.view(),
                movetables: indexes.movetables.view(),
                locpts: indexes.locpts.view(),
                arrays: indexes.arrays.view(),
                owners: indexes.owners.view(),
                members: indexes.members.view(),
                trajectory_names: indexes.trajectory_names.view(),
                trajectories: indexes.trajectories.view(),
                objects: indexes.objects.view(),
                end_effs: indexes.end_effs.view(),
                obj_grips: indexes.obj_grips.view(),
                obj_locs: indexes.obj_locs.view(),
                ped_paras: indexes.ped_paras.view(),
                grip_locs: indexes.grip_locs.view(),
                visions: indexes.visions.view(),
                appr_depts: indexes.appr_depts.view(),
                sensors: indexes.sensors.view(),
                relative_moves: indexes.relative_moves.view(),
            },
        }
    }

    /// The files of blocks that were read, for whoever keeps them with a log.
    #[must_use]
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// How many records each file has, by the manual's names.
    #[must_use]
    pub fn loaded(&self) -> Vec<Loaded> {
        let f = &self.files;
        [
            ("POSE", f.poses.len()),
            ("MOVTAB", f.movetables.len()),
            ("LOCPT", f.locpts.len()),
            ("ARRAY-TABLE", f.arrays.len()),
            ("OWNER-ASCII-NAMES", f.owners.len()),
            ("TRAJ", f.trajectories.len()),
            ("TRAJ-PARA", f.traj_paras.len()),
            ("PATH-PTS", f.path_points.len()),
            ("OBJ-ASCII-NAMES", f.objects.len()),
            ("END-EFF-PARA", f.end_effs.len()),
            ("OBJ-GRIPS", f.obj_grips.len()),
            ("OBJ-LOC", f.obj_locs.len()),
            ("PED-PARA", f.ped_paras.len()),
            ("GRIP-LOC", f.grip_locs.len()),
            ("VISION-PARA", f.visions.len()),
            ("APPR-DEPT", f.appr_depts.len()),
            ("SENSOR-PARA", f.sensors.len()),
            ("REL-MOVES", f.relative_moves.len()),
        ]
        .map(|(file, records)| Loaded { file, records })
        .to_vec()
    }
}
