//! From entries to records: names become record numbers.
//!
//! All names are declared before any is looked up, so the order of blocks does not matter. One sorted index a file finds
//! both the names and the duplicates: equal keys come to lie side by side.

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
    entries::{
        ApprDeptEntry, ArrayEntry, Entry, GripEntry, MovetableEntry, Named, ObjLocEntry, ObjectEntry,
        OwnerEntry, PointAt, PoseEntry, RelativeEntry, SensorEntry, ShowEntry, TrajEntry, Typed, ViewEntry,
    },
    names::nearest,
    report::{Problems, Severity},
    source::{At, Source},
    store::{FILE_RECORDS, Files, Sorted, SortedIndexes},
};

/// Where the records come from, for the checks that follow.
#[derive(Clone, Debug, Default)]
pub(super) struct Origins {
    pub poses: Vec<At>,
    pub locpts: Vec<At>,
    pub trajectories: Vec<At>,
    pub grip_locs: Vec<At>,
    pub visions: Vec<At>,
    pub appr_depts: Vec<At>,
    pub path_points: Vec<At>,
    pub relative_moves: Vec<At>,
}

/// The entries of all blocks, by form.
#[derive(Debug, Default)]
struct Forms {
    poses: Vec<PoseEntry>,
    movetables: Vec<MovetableEntry>,
    locpts: Vec<PointAt>,
    arrays: Vec<ArrayEntry>,
    arrays_at: Vec<PointAt>,
    owners: Vec<OwnerEntry>,
    trajectories: Vec<TrajEntry>,
    objects: Vec<ObjectEntry>,
    obj_grips: Vec<ShowEntry<2>>,
    obj_locs: Vec<ObjLocEntry>,
    ped_paras: Vec<ShowEntry<6>>,
    grips: Vec<GripEntry>,
    views: Vec<ViewEntry>,
    appr_depts: Vec<ApprDeptEntry>,
    sensors: Vec<SensorEntry>,
    relative_moves: Vec<RelativeEntry>,
}

impl Forms {
    fn sort(entries: Vec<Entry>) -> Self {
        let mut forms = Self::default();
        for entry in entries {
            match entry {
                Entry::Pose(e) => forms.poses.push(e),
                Entry::Movetable(e) => forms.movetables.push(e),
                Entry::Locpt(e) => forms.locpts.push(e),
                Entry::Array(e) => forms.arrays.push(e),
                Entry::ArrayAt(e) => forms.arrays_at.push(e),
                Entry::Owner(e) => forms.owners.push(e),
                Entry::Traj(e) => forms.trajectories.push(e),
                Entry::Object(e) => forms.objects.push(e),
                Entry::ObjGrips(e) => forms.obj_grips.push(e),
                Entry::ObjLoc(e) => forms.obj_locs.push(e),
                Entry::PedPara(e) => forms.ped_paras.push(e),
                Entry::Grip(e) => forms.grips.push(e),
                Entry::View(e) => forms.views.push(e),
                Entry::ApprDept(e) => forms.appr_depts.push(e),
                Entry::Sensor(e) => forms.sensors.push(e),
                Entry::Relative(e) => forms.relative_moves.push(e),
            }
        }
        forms
    }
}

/// What links the entries of a load.
pub(super) struct Linker<'a> {
    sources: &'a [Source],
    broken: HashSet<String>,
    problems: &'a mut Problems,
    files: Files,
    indexes: SortedIndexes,
    origins: Origins,
    /// Parameters that have a record already.
    paras: HashMap<[i32; 4], TrajParaId>,
}

/// Make files and indexes of entries; problems are noted.
pub(super) fn link(
    entries: Vec<Entry>,
    broken: HashSet<String>,
    sources: &[Source],
    problems: &mut Problems,
) -> (Files, SortedIndexes, Origins) {
    let forms = Forms::sort(entries);
    let mut linker = Linker {
        sources,
        broken,
        problems,
        files: Files::default(),
        indexes: SortedIndexes::default(),
        origins: Origins::default(),
        paras: HashMap::new(),
    };
    linker.declare(&forms);
    linker.places(&forms);
    linker.objects(&forms);
    linker.guarded_moves(&forms);
    linker.index_pairs();
    linker.check_full();
    (linker.files, linker.indexes, linker.origins)
}

fn number(position: usize) -> u32 {
    u32::try_from(position).unwrap_or(u32::MAX)
}

impl Linker<'_> {
    /// An index of keys in the order of the records; two records with one key are an error.
    fn unique(&mut self, what: &str, keys: Vec<u128>, ats: &[At]) -> Sorted {
        let pairs = keys.into_iter().enumerate().map(|(i, key)| (key, number(i).saturating_add(1))).collect();
        let sorted = Sorted::new(pairs);
        let at = |n: &u32| {
            usize::try_from(n.saturating_sub(1)).ok().and_then(|i| ats.get(i)).copied().unwrap_or_default()
        };
        for (keys, numbers) in sorted.keys.windows(2).zip(sorted.numbers.windows(2)) {
            if let ([one, two], [first, second]) = (keys, numbers)
                && one == two
            {
                let help = format!("the first is in {}", self.place(at(first)));
                self.problems.error_help("duplicate", at(second), format!("{what} is given twice"), help);
            }
        }
        sorted
    }

    /// A place in words, for help.
    fn place(&self, at: At) -> String {
        let file = usize::try_from(at.source)
            .ok()
            .and_then(|i| self.sources.get(i))
            .map_or("?", |s| s.name.as_str());
        at.block.map_or_else(
            || format!("{file}, line {}", at.line),
            |block| format!("{file}, {block}, line {}", at.line),
        )
    }

    fn declare_names<const N: usize>(&mut self, what: &str, names: &[Named<N>]) -> Sorted {
        let ats: Vec<At> = names.iter().map(|n| n.at).collect();
        self.unique(
            &format!("a {what} of this name"),
            names.iter().map(|n| name_key(&n.name)).collect(),
            &ats,
        )
    }

    /// Declare all names, so that forms can be looked up in any order.
    fn declare(&mut self, forms: &Forms) {
        let names = |list: &[PointAt]| list.iter().map(|e| e.name).collect::<Vec<_>>();
        let movetables: Vec<_> = forms.movetables.iter().map(|e| e.name).collect();
        for null in movetables.iter().filter(|n| n.name.as_str() == NULL_NAME) {
            self.problems.error("name.null", null.at, "... is the null movetable and cannot be defined");
        }
        self.indexes.movetables = self.declare_names("movetable", &movetables);
        let poses: Vec<_> = forms.poses.iter().map(|e| e.name).collect();
        self.indexes.poses = self.declare_names("pose", &poses);
        self.indexes.locpts = self.declare_names("location point", &names(&forms.locpts));
        let arrays: Vec<_> = forms.arrays.iter().map(|e| e.name).collect();
        self.indexes.arrays = self.declare_names("array", &arrays);
        let owners: Vec<_> = forms.owners.iter().map(|e| e.name).collect();
        self.indexes.owners = self.declare_names("owner", &owners);
        let trajectories: Vec<_> = forms.trajectories.iter().map(|e| e.name).collect();
        self.indexes.trajectory_names = self.declare_names("trajectory", &trajectories);

        // An object has one form entry for each grip; its name is declared by the first.
        let mut seen = HashSet::new();
        for entry in &forms.objects {
            if seen.insert(entry.name.name) {
                self.files.objects.push(Object { name: entry.name.name });
            }
        }
        let keys = self.files.objects.iter().enumerate();
        self.indexes.objects =
            Sorted::new(keys.map(|(i, o)| (name_key(&o.name), number(i).saturating_add(1))).collect());
    }

    /// The record number of a name, or a note that nothing has it.
    fn find<const N: usize>(
        &mut self,
        what: &str,
        name: Named<N>,
        file: impl Fn(&SortedIndexes) -> &Sorted,
    ) -> Option<u32> {
        let sorted = file(&self.indexes);
        if let Some(found) = sorted.view().find(name_key(&name.name)) {
            return Some(found);
        }
        let known: Vec<String> = sorted.keys.iter().map(|key| key_text(*key)).collect();
        let wanted = name.name.as_str();
        let near = nearest(wanted, known.iter().map(String::as_str));
        // Its definition may be in an entry that could not be read, which is noted there; a slip of the pen included.
        let broken = || nearest(wanted, self.broken.iter().map(String::as_str)).is_some();
        if self.broken.contains(wanted) || (near.is_none() && broken()) {
            return None;
        }
        let help = near.map(|n| format!("the nearest known name is {n}"));
        let message = format!("no {what} is named {}", name.name);
        self.problems.push(Severity::Error, "name.unknown", name.at, message, help);
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
        let members =
            self.files.members.iter().map(|m| (reference_key(m.member), m.owner.number())).collect();
        self.indexes.members = Sorted::new(members);
        if self.files.trajectories.iter().all(|t| t.start != Reference::NONE && t.end != Reference::NONE) {
            let keys = self.files.trajectories.iter().map(|t| pair_key(t.start, t.end)).collect();
            let ats = self.origins.trajectories.clone();
            self.indexes.trajectories = self.unique("a trajectory between these locations", keys, &ats);
        }
    }

    fn check_full(&mut self) {
        let store = super::Store { files: std::mem::take(&mut self.files), ..super::Store::default() };
        for loaded in store.loaded().iter().filter(|l| l.records > FILE_RECORDS) {
            let message =
                format!("FILE FULL: {} holds {FILE_RECORDS} records, {} found", loaded.file, loaded.records);
            self.problems.general("file.full", message);
        }
        self.files = store.files;
    }
}

/// The name that a key was made of.
fn key_text(key: u128) -> String {
    key.to_be_bytes().iter().take_while(|b| **b != 0).map(|b| char::from(*b)).collect()
}
