//! The entries of a load, by form, in the order of their entry. The position gives the record number. In the next
//! generation, newer entries take the positions of those that they replace, and others are appended: records keep
//! their numbers (docs/design/ownership.md "Reload").

use std::{
    collections::{HashMap, HashSet},
    hash::Hash,
};

use super::entries::{
    ApprDeptEntry, ArrayEntry, Entry, FileEntry, GripEntry, MovetableEntry, ObjLocEntry, ObjectEntry,
    OwnerEntry, PointAt, PoseEntry, RelativeEntry, SensorEntry, ShowEntry, TrajEntry, Typed, ViewEntry,
};

#[derive(Clone, Debug, Default)]
pub(super) struct Collected {
    pub files: Vec<FileEntry>,
    pub poses: Vec<PoseEntry>,
    pub movetables: Vec<MovetableEntry>,
    pub locpts: Vec<PointAt>,
    pub arrays: Vec<ArrayEntry>,
    pub arrays_at: Vec<PointAt>,
    pub owners: Vec<OwnerEntry>,
    pub trajectories: Vec<TrajEntry>,
    pub objects: Vec<ObjectEntry>,
    pub obj_grips: Vec<ShowEntry<2>>,
    pub obj_locs: Vec<ObjLocEntry>,
    pub ped_paras: Vec<ShowEntry<6>>,
    pub grips: Vec<GripEntry>,
    pub views: Vec<ViewEntry>,
    pub appr_depts: Vec<ApprDeptEntry>,
    pub sensors: Vec<SensorEntry>,
    pub relative_moves: Vec<RelativeEntry>,
}

impl Collected {
    pub fn add(&mut self, entry: Entry) {
        match entry {
            Entry::File(e) => self.files.push(e),
            Entry::Pose(e) => self.poses.push(e),
            Entry::Movetable(e) => self.movetables.push(e),
            Entry::Locpt(e) => self.locpts.push(e),
            Entry::Array(e) => self.arrays.push(e),
            Entry::ArrayAt(e) => self.arrays_at.push(e),
            Entry::Owner(e) => self.owners.push(e),
            Entry::Traj(e) => self.trajectories.push(e),
            Entry::Object(e) => self.objects.push(e),
            Entry::ObjGrips(e) => self.obj_grips.push(e),
            Entry::ObjLoc(e) => self.obj_locs.push(e),
            Entry::PedPara(e) => self.ped_paras.push(e),
            Entry::Grip(e) => self.grips.push(e),
            Entry::View(e) => self.views.push(e),
            Entry::ApprDept(e) => self.appr_depts.push(e),
            Entry::Sensor(e) => self.sensors.push(e),
            Entry::Relative(e) => self.relative_moves.push(e),
        }
    }

    /// Replaces entries by `newer` ones with the same key, and all object locations of an object by newer ones. Appends
    /// the others. If `newer` has a key twice, the second is appended, so that linking finds the duplicate.
    pub fn with(&self, newer: Self) -> Self {
        let mut all = self.clone();
        replace(&mut all.files, newer.files, |e| e.file);
        replace(&mut all.poses, newer.poses, |e| e.name.name);
        replace(&mut all.movetables, newer.movetables, |e| e.name.name);
        replace(&mut all.locpts, newer.locpts, |e| e.name.name);
        replace(&mut all.arrays, newer.arrays, |e| e.name.name);
        replace(&mut all.arrays_at, newer.arrays_at, |e| e.name.name);
        replace(&mut all.owners, newer.owners, |e| e.name.name);
        replace(&mut all.trajectories, newer.trajectories, |e| e.name.name);
        replace(&mut all.objects, newer.objects, |e| (e.name.name, e.grip));
        replace(&mut all.obj_grips, newer.obj_grips, |e| e.object.name);
        replace(&mut all.ped_paras, newer.ped_paras, |e| e.object.name);
        replace(&mut all.grips, newer.grips, |e| (e.object.name, e.grip, typed(&e.place)));
        replace(&mut all.views, newer.views, |e| (e.object.name, typed(&e.place)));
        replace(&mut all.appr_depts, newer.appr_depts, |e| {
            (e.direction.code(), typed(&e.subject), e.grip, e.place.as_ref().map(typed))
        });
        replace(&mut all.sensors, newer.sensors, |e| e.name.name);
        replace(&mut all.relative_moves, newer.relative_moves, |e| (e.name.name, typed(&e.place)));
        let moved: HashSet<_> = newer.obj_locs.iter().map(|e| e.object.name).collect();
        all.obj_locs.retain(|e| !moved.contains(&e.object.name));
        all.obj_locs.extend(newer.obj_locs);
        all
    }
}

const fn typed(typed: &Typed) -> (u8, rcs_core::name::Name16) {
    (typed.kind.code(), typed.name.name)
}

/// Replaces entries by newer ones with the same key, and appends the others.
fn replace<T, K: Eq + Hash>(entries: &mut Vec<T>, newer: Vec<T>, key: impl Fn(&T) -> K) {
    if newer.is_empty() {
        return;
    }
    if entries.is_empty() {
        *entries = newer;
        return;
    }
    let mut known: HashMap<K, usize> = entries.iter().enumerate().map(|(i, e)| (key(e), i)).collect();
    for entry in newer {
        match known.remove(&key(&entry)).and_then(|i| entries.get_mut(i)) {
            Some(old) => *old = entry,
            None => entries.push(entry),
        }
    }
}
