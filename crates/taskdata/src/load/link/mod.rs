//! From entries to records: names become record numbers.
//!
//! All names are declared before any is looked up, so the order of blocks does not matter. One index a file finds both the
//! names and the duplicates, which share a key.

mod guarded;
mod objects;
mod places;

use std::collections::{HashMap, HashSet};

use rcs_core::frame::Frame;

use crate::files::{
    ArrayId, LocptId, MovtabId, Object, ObjectId, OwnerId, PoseId, RefType, Reference, TrajParaId,
    data::NULL_NAME,
    index::{name_key, pair_key, reference_key},
};

use super::{
    collected::Collected,
    entries::{Named, Typed},
    index::OwnedIndex,
    names::nearest,
    origins::Origins,
    report::Problems,
    source::{At, Source, place},
    store::{FILE_NAMES, FILE_RECORDS, Files, OwnedIndexes},
};

/// Unknown names for which the nearest known one is looked for; in data where everything is unknown that would take hours.
const NEAREST_FOR: usize = 200;

/// What links the entries of a load.
pub(super) struct Linker<'a> {
    sources: &'a [Source],
    broken: HashSet<String>,
    problems: &'a mut Problems,
    files: Files,
    indexes: OwnedIndexes,
    origins: Origins,
    /// Parameters that have a record already.
    paras: HashMap<[i32; 4], TrajParaId>,
    /// Names that were looked for in vain.
    unknown: usize,
}

/// Make files and indexes of entries; problems are noted. `broken` are names in entries that could not be read.
pub(super) fn link(
    entries: &Collected,
    broken: HashSet<String>,
    sources: &[Source],
    problems: &mut Problems,
) -> (Files, OwnedIndexes, Origins) {
    let mut linker = Linker {
        sources,
        broken,
        problems,
        files: Files::default(),
        indexes: OwnedIndexes::default(),
        origins: Origins::default(),
        paras: HashMap::new(),
        unknown: 0,
    };
    linker.declare(entries);
    linker.places(entries);
    linker.objects(entries);
    linker.guarded_moves(entries);
    linker.index_pairs();
    linker.check_full(entries);
    (linker.files, linker.indexes, linker.origins)
}

/// Keys with the record numbers of their records, which count from 1 in their order.
fn numbered(keys: impl Iterator<Item = u128>) -> Vec<(u128, u32)> {
    keys.zip(1..).collect()
}

fn number(position: usize) -> u32 {
    u32::try_from(position).unwrap_or(u32::MAX)
}

impl Linker<'_> {
    /// An index of keys in the order of the records; two records with one key are an error.
    fn unique(&mut self, what: &str, keys: &[(u128, u32)], ats: &[At]) -> OwnedIndex {
        let index = OwnedIndex::new(keys);
        let at = |n: &u32| {
            usize::try_from(n.saturating_sub(1)).ok().and_then(|i| ats.get(i)).copied().unwrap_or_default()
        };
        for numbers in index.shared() {
            for pair in numbers.windows(2) {
                if let [first, second] = pair {
                    let help = format!("the first is in {}", place(self.sources, at(first)));
                    self.problems.error_help("duplicate", at(second), format!("{what} is given twice"), help);
                }
            }
        }
        index
    }

    /// An index of names; where they stand is noted with it.
    fn declare_names<'n, const N: usize>(
        &mut self,
        what: &str,
        names: impl Iterator<Item = &'n Named<N>> + Clone,
    ) -> (OwnedIndex, Vec<At>) {
        let ats: Vec<At> = names.clone().map(|n| n.at).collect();
        let keys = numbered(names.map(|n| name_key(&n.name)));
        let index = self.unique(&format!("a {what} of this name"), &keys, &ats);
        (index, ats)
    }

    /// Declare all names, so that forms can be looked up in any order.
    fn declare(&mut self, all: &Collected) {
        for null in all.movetables.iter().filter(|e| e.name.name.as_str() == NULL_NAME) {
            self.problems.error("name.null", null.name.at, "... is the null movetable and cannot be defined");
        }
        (self.indexes.movetables, self.origins.movetables) =
            self.declare_names("movetable", all.movetables.iter().map(|e| &e.name));
        self.indexes.poses = self.declare_names("pose", all.poses.iter().map(|e| &e.name)).0;
        (self.indexes.locpts, self.origins.locpts) =
            self.declare_names("location point", all.locpts.iter().map(|e| &e.name));
        (self.indexes.arrays, self.origins.arrays) =
            self.declare_names("array", all.arrays.iter().map(|e| &e.name));
        (self.indexes.owners, self.origins.owners) =
            self.declare_names("owner", all.owners.iter().map(|e| &e.name));
        self.indexes.trajectory_names =
            self.declare_names("trajectory", all.trajectories.iter().map(|e| &e.name)).0;
        (self.indexes.sensors, self.origins.sensors) =
            self.declare_names("sensor", all.sensors.iter().map(|e| &e.name));

        // An object has one form entry for each grip; its name is declared by the first.
        let mut seen = HashSet::new();
        for entry in all.objects.iter().filter(|e| seen.insert(e.name.name)) {
            self.files.objects.push(Object { name: entry.name.name });
            self.origins.objects.push(entry.name.at);
        }
        self.indexes.objects =
            OwnedIndex::new(&numbered(self.files.objects.iter().map(|o| name_key(&o.name))));
    }

    /// The record number of a name, or a note that nothing has it.
    fn find<const N: usize>(
        &mut self,
        what: &str,
        name: Named<N>,
        file: impl Fn(&OwnedIndexes) -> &OwnedIndex,
    ) -> Option<u32> {
        let index = file(&self.indexes);
        if let Some(found) = index.view().find(name_key(&name.name)) {
            return Some(found);
        }
        let wanted = name.name.as_str();
        self.unknown += 1;
        let near = (self.unknown <= NEAREST_FOR).then(|| nearest_of(wanted, index)).flatten();
        // Its definition may be in an entry that could not be read, which is noted there; a slip of the pen included.
        let broken = || {
            self.unknown <= NEAREST_FOR && nearest(wanted, self.broken.iter().map(String::as_str)).is_some()
        };
        if self.broken.contains(wanted) || (near.is_none() && broken()) {
            return None;
        }
        self.problems.error("name.unknown", name.at, format!("no {what} is named {}", name.name));
        self.problems.expected(format!("the name of a {what}"));
        if let Some(near) = near {
            self.problems.nearest("known name", &near);
        }
        None
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

    /// A type and a name as a reference.
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

    /// A frame with a movetable applied.
    fn moved(&self, frame: &Frame, by: MovtabId) -> Frame {
        by.of(&self.files.movetables).map_or(*frame, |m| m.movetable.apply(frame))
    }

    /// Indexes by what records refer to.
    fn index_pairs(&mut self) {
        let members: Vec<(u128, u32)> =
            self.files.members.iter().map(|m| (reference_key(m.member), m.owner.number())).collect();
        self.indexes.members = OwnedIndex::new(&members);
        if self.files.trajectories.iter().all(|t| t.start != Reference::NONE && t.end != Reference::NONE) {
            let keys = numbered(self.files.trajectories.iter().map(|t| pair_key(t.start, t.end)));
            let ats = std::mem::take(&mut self.origins.trajectories);
            self.indexes.trajectories = self.unique("a trajectory between these locations", &keys, &ats);
            self.origins.trajectories = ats;
        }
    }

    /// FILE FULL (VII): a file holds what its declaration allows.
    fn check_full(&mut self, all: &Collected) {
        let mut declared = HashMap::new();
        for entry in &all.files {
            if let Some(first) = declared.insert(entry.file, entry) {
                let help = format!("the first is in {}", place(self.sources, first.at));
                self.problems.error_help("duplicate", entry.at, "this file is declared twice", help);
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

/// The nearest name in an index.
fn nearest_of(wanted: &str, index: &OwnedIndex) -> Option<String> {
    let mut known: Vec<String> = index.keys().map(key_text).collect();
    known.sort_unstable();
    nearest(wanted, known.iter().map(String::as_str)).map(str::to_owned)
}

/// The name that a key was made of.
fn key_text(key: u128) -> String {
    key.to_be_bytes().iter().take_while(|b| **b != 0).map(|b| char::from(*b)).collect()
}
