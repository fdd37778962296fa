//! Owns the loaded files; [`TaskData`] is a view of them.

use std::collections::BTreeSet;

use diagnostics::{At, BlockNumber, Loaded, Places, Source};

use crate::files::{
    ApprDept, Array, EndEffPara, GripLoc, Locpt, Member, MovtabRecord, ObjGrips, ObjLoc, Object, Owner, Path,
    PathPoint, PedPara, PoseRecord, RelativeMove, SensorPara, TaskData, Traj, TrajPara, VisionPara,
    data::Indexes,
};

use super::{
    collected::Collected,
    commands::Commands,
    fault::Fault,
    index::{OwnedIndex, OwnedPlaceIndex},
    origins::Origins,
    source::places_in_blocks,
};

pub const FILE_RECORDS: usize = 100_000; // per file (SPECNOTES.md, Task data); beyond it, FILE FULL

/// Not in the manual: object locations, approaches and departs, and the last two files.
pub const FILE_NAMES: [&str; 18] = [
    "POSE",
    "MOVTAB",
    "LOCPT",
    "ARRAY-TABLE",
    "OWNER-ASCII-NAMES",
    "TRAJ",
    "TRAJ-PARA",
    "PATH-PTS",
    "OBJ-ASCII-NAMES",
    "END-EFF-PARA",
    "OBJ-GRIPS",
    "OBJ-LOC",
    "PED-PARA",
    "GRIP-LOC",
    "VISION-PARA",
    "APPR-DEPT",
    "SENSOR-PARA",
    "REL-MOVES",
];

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

impl Files {
    /// Records per file, in the order of [`FILE_NAMES`].
    pub const fn records(&self) -> [usize; FILE_NAMES.len()] {
        [
            self.poses.len(),
            self.movetables.len(),
            self.locpts.len(),
            self.arrays.len(),
            self.owners.len(),
            self.trajectories.len(),
            self.traj_paras.len(),
            self.path_points.len(),
            self.objects.len(),
            self.end_effs.len(),
            self.obj_grips.len(),
            self.obj_locs.len(),
            self.ped_paras.len(),
            self.grip_locs.len(),
            self.visions.len(),
            self.appr_depts.len(),
            self.sensors.len(),
            self.relative_moves.len(),
        ]
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct OwnedIndexes {
    pub poses: OwnedIndex,
    pub movetables: OwnedIndex,
    pub locpts: OwnedIndex,
    pub arrays: OwnedIndex,
    pub owners: OwnedIndex,
    pub members: OwnedIndex,
    pub trajectory_names: OwnedIndex,
    pub trajectories: OwnedIndex,
    pub objects: OwnedIndex,
    pub end_effs: OwnedIndex,
    pub obj_grips: OwnedIndex,
    pub obj_locs: OwnedIndex,
    pub ped_paras: OwnedIndex,
    pub grip_locs: OwnedPlaceIndex,
    pub visions: OwnedPlaceIndex,
    pub appr_depts: OwnedPlaceIndex,
    pub sensors: OwnedIndex,
    pub relative_moves: OwnedPlaceIndex,
}

#[derive(Clone, Debug, Default)]
pub struct Store {
    pub(super) files: Files,
    pub(super) indexes: OwnedIndexes,
    pub(super) sources: Vec<Source>,
    pub(super) entries: Collected, // for the next generation
    pub(super) blocks: BTreeSet<BlockNumber>,
    pub(super) origins: Origins,
    pub(super) commands: Commands,
    pub(super) faults: Vec<Fault>,
    pub(super) found: Vec<Fault>, // by other checks
}

impl Store {
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

    /// Files for a log: the files of the first load, then the files of each [`Store::with_blocks`].
    #[must_use]
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    #[must_use]
    pub const fn origins(&self) -> &Origins {
        &self.origins
    }

    #[must_use]
    pub fn places(&self) -> Places<'_> {
        places_in_blocks(&self.sources)
    }

    #[must_use]
    pub fn place(&self, at: At) -> String {
        self.places().words(at)
    }

    #[must_use]
    pub fn loaded(&self) -> Vec<Loaded> {
        let files = FILE_NAMES.iter().zip(self.files.records());
        files.map(|(file, records)| Loaded { file, records }).collect()
    }
}
