//! From entries to records: names become record numbers.
//!
//! All names are declared before any is looked up, so the order of blocks does not matter. The index of a file finds
//! both names and duplicates, which share a key.

mod guarded;
mod known;
mod objects;
mod places;

use std::collections::{BTreeMap, HashSet};

use diagnostics::{At, Problems, nearest};
use geometry::frame::Frame;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::files::{
    ArrayId, LocptId, Member, MovtabId, ObjLoc, Object, ObjectId, OwnerId, PoseId, RefType, Reference,
    TrajParaId,
    data::NULL_NAME,
    index::{Key, grip_key, name_key, object_key, pair_key, reference_key},
};

use super::{
    collected::Collected,
    entries::{Named, Typed},
    index::{OwnedIndex, OwnedPlaceIndex, Pair},
    origins::Origins,
    orphans::Orphans,
    parallel,
    store::{FILE_NAMES, FILE_RECORDS, Files, OwnedIndexes},
};

use known::Known;

const NEAREST_FOR: usize = 200; // a search for the nearest names of all unknown ones would take hours

pub(super) struct Linker<'a> {
    broken: &'a HashSet<String>,
    orphans: &'a mut Orphans,
    problems: &'a mut Problems,
    files: Files,
    indexes: OwnedIndexes,
    origins: Origins,
    paras: FxHashMap<[i32; 4], TrajParaId>, // that already have a record
    unknown: usize,
    /// Place of the first use and number of uses, by unknown name and expected kind.
    asked: BTreeMap<(String, String), (At, usize)>,
}

/// `broken` has names in unreadable entries, `orphans` those in unloaded blocks. The last result is the unknown names.
pub(super) fn link(
    entries: &Collected,
    broken: &HashSet<String>,
    orphans: &mut Orphans,
    problems: &mut Problems,
) -> (Files, OwnedIndexes, Origins, Vec<String>) {
    let mut linker = Linker {
        broken,
        orphans,
        problems,
        files: Files::default(),
        indexes: OwnedIndexes::default(),
        origins: Origins::default(),
        paras: FxHashMap::default(),
        unknown: 0,
        asked: BTreeMap::new(),
    };
    linker.declare(entries);
    linker.places(entries);
    linker.objects(entries);
    linker.guarded_moves(entries);
    linker.index_pairs();
    linker.check_full(entries);
    let unknown = linker.count_unknown();
    (linker.files, linker.indexes, linker.origins, unknown)
}

/// Keys in the order of the records, and their places.
struct Keyed {
    what: &'static str, // of entry, which must be unique; with its article
    keys: Vec<Pair>,
    ats: Vec<At>,
}

impl Keyed {
    fn with_capacity(what: &'static str, records: usize) -> Self {
        Self { what, keys: Vec::with_capacity(records), ats: Vec::with_capacity(records) }
    }

    /// `answer` is the field that look-ups need, or 0.
    fn push(&mut self, key: Key, answer: u32, at: At) {
        self.keys.push(Pair { key, number: number(self.keys.len()) + 1, answer });
        self.ats.push(at);
    }

    fn new(what: &'static str, records: impl ExactSizeIterator<Item = (Key, At)>) -> Self {
        let mut keyed = Self::with_capacity(what, records.len());
        records.for_each(|(key, at)| keyed.push(key, 0, at));
        keyed
    }

    fn names<'n, const N: usize>(
        what: &'static str,
        names: impl ExactSizeIterator<Item = &'n Named<N>>,
    ) -> Self {
        Self::new(what, names.map(|n| (name_key(&n.name), n.at)))
    }
}

/// The form has checked the grip's number, so its key exists.
fn sure(key: Option<Key>) -> Key {
    key.unwrap_or_default()
}

fn number(position: usize) -> u32 {
    u32::try_from(position).unwrap_or(u32::MAX)
}

impl Linker<'_> {
    /// Builds indexes in parallel. Two records with one key are an error.
    fn indexed<const N: usize>(&mut self, lists: [Keyed; N]) -> [(OwnedIndex, Vec<At>); N] {
        let make = |i: usize| lists.get(i).map_or_else(OwnedIndex::default, |l| OwnedIndex::new(&l.keys));
        let mut made = parallel::map(N, make).into_iter();
        lists.map(|list| {
            let index = made.next().unwrap_or_default();
            self.twice(list.what, &list.ats, index.shared());
            (index, list.ats)
        })
    }

    /// Like [`Linker::indexed`], for entries at locations.
    fn indexed_at<const N: usize>(&mut self, lists: [Keyed; N]) -> [(OwnedPlaceIndex, Vec<At>); N] {
        let make =
            |i: usize| lists.get(i).map_or_else(OwnedPlaceIndex::default, |l| OwnedPlaceIndex::new(&l.keys));
        let mut made = parallel::map(N, make).into_iter();
        lists.map(|list| {
            let index = made.next().unwrap_or_default();
            self.twice(list.what, &list.ats, index.shared());
            (index, list.ats)
        })
    }

    fn twice<'n>(&mut self, what: &str, ats: &[At], shared: impl Iterator<Item = &'n [u32]>) {
        let at = |n: &u32| {
            let position = usize::try_from(n.saturating_sub(1)).ok();
            position.and_then(|i| ats.get(i)).copied().unwrap_or_default()
        };
        for pair in shared.flat_map(|numbers| numbers.windows(2)) {
            if let [first, second] = pair {
                self.problems.duplicate(at(second), format!("{what} is given twice"), at(first));
            }
        }
    }

    /// Declares all names, and records that need only an object's name, so that forms can be in any order.
    fn declare(&mut self, all: &Collected) {
        for null in all.movetables.iter().filter(|e| e.name.name.as_str() == NULL_NAME) {
            self.problems.error("name.null", null.name.at, "... is the null movetable and cannot be defined");
        }
        // An object has one form entry per grip; the first declares its name.
        let mut seen = FxHashSet::with_capacity_and_hasher(all.objects.len(), Default::default());
        let objects: Vec<Named<16>> =
            all.objects.iter().map(|e| e.name).filter(|name| seen.insert(name.name)).collect();
        self.files.objects = objects.iter().map(|o| Object { name: o.name }).collect();
        let grips = all.objects.iter().map(|e| (sure(grip_key(&e.name.name, e.grip)), e.at));
        let [movetables, poses, locpts, objects, end_effs] = self.indexed([
            Keyed::names("a movetable of this name", all.movetables.iter().map(|e| &e.name)),
            Keyed::names("a pose of this name", all.poses.iter().map(|e| &e.name)),
            Keyed::names("a location point of this name", all.locpts.iter().map(|e| &e.name)),
            Keyed::names("an object of this name", objects.iter()),
            Keyed::new("this grip of this object", grips),
        ]);
        let [arrays, owners, trajectories, sensors, obj_grips, ped_paras] = self.indexed([
            Keyed::names("an array of this name", all.arrays.iter().map(|e| &e.name)),
            Keyed::names("an owner of this name", all.owners.iter().map(|e| &e.name)),
            Keyed::names("a trajectory of this name", all.trajectories.iter().map(|e| &e.name)),
            Keyed::names("a sensor of this name", all.sensors.iter().map(|e| &e.name)),
            Keyed::names("the gripper of this object", all.obj_grips.iter().map(|e| &e.object)),
            Keyed::names("the pedestal record of this object", all.ped_paras.iter().map(|e| &e.object)),
        ]);
        let (indexes, origins) = (&mut self.indexes, &mut self.origins);
        (indexes.movetables, origins.movetables) = movetables;
        indexes.poses = poses.0;
        (indexes.locpts, origins.locpts) = locpts;
        (indexes.objects, origins.objects) = objects;
        (indexes.end_effs, origins.end_effs) = end_effs;
        (indexes.arrays, origins.arrays) = arrays;
        (indexes.owners, origins.owners) = owners;
        indexes.trajectory_names = trajectories.0;
        (indexes.sensors, origins.sensors) = sensors;
        (indexes.obj_grips, origins.obj_grips) = obj_grips;
        (indexes.ped_paras, origins.ped_paras) = ped_paras;
    }

    fn find<const N: usize>(
        &mut self,
        what: &str,
        name: Named<N>,
        file: impl Fn(&OwnedIndexes) -> &OwnedIndex,
    ) -> Option<u32> {
        let index = file(&self.indexes);
        if let Some(found) = known::named(index, &name) {
            return Some(found);
        }
        let wanted = name.name.as_str();
        self.unknown += 1;
        // Its definition, perhaps misspelt, may be in an unreadable entry, which is already reported.
        if self.has_elsewhere(wanted) {
            return None;
        }
        let asked = self.asked.entry((what.to_owned(), wanted.to_owned())).or_insert((name.at, 0));
        asked.1 += 1;
        if asked.1 > 1 {
            return None;
        }
        let known: Vec<String> =
            if self.unknown <= NEAREST_FOR { names_of(file(&self.indexes)) } else { Vec::new() };
        let broken = self.broken.iter().map(String::as_str).filter(|_| self.unknown <= NEAREST_FOR);
        let near = nearest(wanted, broken.chain(known.iter().map(String::as_str)));
        if near.is_some_and(|near| self.broken.contains(near)) {
            return None;
        }
        let incomplete = self.orphans.incomplete;
        if incomplete && near.is_none() {
            return None;
        }
        let among = if incomplete { " in the files that can be read" } else { "" };
        self.problems.error("name.unknown", name.at, format!("no {what} is named {}{among}", name.name));
        self.problems.expected(format!("the name of a {what}"));
        if let Some(near) = near {
            self.problems.nearest("known name", near);
        }
        None
    }

    /// Adds the number of uses to the report of each unknown name; returns these names.
    fn count_unknown(&mut self) -> Vec<String> {
        let mut names = Vec::new();
        for ((_, name), (at, times)) in std::mem::take(&mut self.asked) {
            names.push(name);
            match times {
                1 => {}
                2 => self.problems.add_help("name.unknown", at, "1 more entry refers to it"),
                more => self.problems.add_help("name.unknown", at, &format!("{} more refer to it", more - 1)),
            }
        }
        names
    }

    /// The name is in an entry that is unreadable or not loaded, which is already reported.
    fn has_elsewhere(&mut self, name: &str) -> bool {
        let longer = |broken: &String| broken.len() > name.len() && broken.starts_with(name);
        self.broken.contains(name)
            || self.orphans.lack_blocks()
            || self.orphans.have(name)
            || self.broken.iter().any(longer)
    }

    fn movetable(&mut self, name: Named<10>) -> Option<MovtabId> {
        if name.name.as_str() == NULL_NAME {
            return Some(MovtabId::NULL);
        }
        self.find("movetable", name, |i| &i.movetables).map(MovtabId::new)
    }

    fn pose(&mut self, name: Named<10>) -> Option<PoseId> {
        self.find("pose", name, |i| &i.poses).map(PoseId::new)
    }

    fn object(&mut self, name: Named<16>) -> Option<ObjectId> {
        self.find("object", name, |i| &i.objects).map(ObjectId::new)
    }

    fn reference(&mut self, typed: Typed) -> Option<Reference> {
        let name = typed.name;
        Some(match typed.kind {
            RefType::Any => Reference::ANY,
            RefType::LocationPoint => {
                Reference::location_point(LocptId::new(self.find("location point", name, |i| &i.locpts)?))
            }
            RefType::Array => Reference::array(ArrayId::new(self.find("array", name, |i| &i.arrays)?)),
            RefType::Owner => Reference::owner(OwnerId::new(self.find("owner", name, |i| &i.owners)?)),
            RefType::Pose => Reference::pose(PoseId::new(self.find("pose", name, |i| &i.poses)?)),
            RefType::Object => Reference::object(self.object(name)?),
            RefType::View => Reference::view(self.object(name)?),
            RefType::None | RefType::Movetable => return None,
        })
    }

    const fn known(&self) -> Known<'_> {
        Known { files: &self.files, indexes: &self.indexes }
    }

    fn moved(&self, frame: &Frame, by: MovtabId) -> Frame {
        self.known().moved(frame, by)
    }

    fn index_pairs(&mut self) {
        let by_member =
            |m: &Member| Pair { key: reference_key(m.member), number: m.owner.number(), answer: 0 };
        let members: Vec<Pair> = self.files.members.iter().map(by_member).collect();
        let by_object = |(r, number): (&ObjLoc, _)| Pair { key: object_key(r.object), number, answer: 0 };
        let obj_locs: Vec<Pair> = self.files.obj_locs.iter().zip(1..).map(by_object).collect();
        self.indexes.members = OwnedIndex::new(&members);
        self.indexes.obj_locs = OwnedIndex::new(&obj_locs);
        if self.files.trajectories.iter().all(|t| t.start != Reference::NONE && t.end != Reference::NONE) {
            let ends = self.files.trajectories.iter().zip(&self.origins.trajectories);
            let mut keyed =
                Keyed::with_capacity("a trajectory between these locations", self.files.trajectories.len());
            ends.for_each(|(t, at)| keyed.push(pair_key(t.start, t.end), t.path.number(), *at));
            let [trajectories] = self.indexed([keyed]);
            self.indexes.trajectories = trajectories.0;
        }
    }

    /// Reports FILE FULL (VII) if a file has more records than its declaration allows.
    fn check_full(&mut self, all: &Collected) {
        let mut declared = FxHashMap::default();
        for entry in &all.files {
            if let Some(first) = declared.insert(entry.file, entry) {
                self.problems.duplicate(entry.at, "this file is declared twice", first.at);
            }
        }
        for (file, records) in FILE_NAMES.iter().zip(self.files.records()) {
            let declaration = declared.get(file);
            let capacity = declaration.map_or(FILE_RECORDS, |entry| entry.records);
            if records <= capacity {
                continue;
            }
            let message = format!("FILE FULL: {file} holds {capacity} records, {records} found");
            match declaration {
                Some(entry) => {
                    let help = format!("raise the number in this declaration, to {FILE_RECORDS} at most");
                    self.problems.error_help("file.full", entry.at, message, help);
                }
                None => {
                    self.problems.general("file.full", message);
                    self.problems
                        .help(format!("the declaration is FILE_RECORDS, {FILE_RECORDS} for every file"));
                }
            }
        }
    }
}

fn names_of(index: &OwnedIndex) -> Vec<String> {
    let mut known: Vec<String> = index.keys().map(key_text).collect();
    known.sort_unstable();
    known
}

fn key_text(key: Key) -> String {
    key.main
        .map(u64::to_be_bytes)
        .as_flattened()
        .iter()
        .take_while(|b| **b != 0)
        .map(|b| char::from(*b))
        .collect()
}
