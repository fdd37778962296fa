//! From entries to records: names become record numbers.
//!
//! All names are declared before any is looked up, so the order of blocks does not matter. One sorted index a file finds
//! both the names and the duplicates: equal keys come to lie side by side.

use std::collections::{HashMap, HashSet};

use rcs_core::{frame::Frame, movetable::Movetable, name::Name, pose::Pose};

use crate::files::{
    ApprDept, Array, ArrayId, EndEffPara, GripLoc, Locpt, LocptId, Member, MovtabId, MovtabRecord, ObjGrips,
    ObjLoc, Object, ObjectId, Owner, OwnerId, Path, PathId, PathPoint, PedPara, PoseId, PoseRecord, RefType,
    Reference, Target, Traj, TrajPara, TrajParaId, VisionPara,
    data::NULL_NAME,
    index::{
        approach_key, grip_at_key, grip_key, name_key, object_at_key, object_key, pair_key, reference_key,
    },
};

use super::{
    entries::{
        ApprDeptEntry, ArrayEntry, Entry, GripEntry, MovetableEntry, Named, ObjLocEntry, ObjectEntry,
        OwnerEntry, PointAt, PointEntry, PoseEntry, ShowEntry, TrajEntry, Typed, ViewEntry,
    },
    names::nearest,
    report::Problems,
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
        if self.broken.contains(name.name.as_str()) {
            return None;
        }
        let known: Vec<String> = sorted.keys.iter().map(|key| key_text(*key)).collect();
        let near = nearest(name.name.as_str(), known.iter().map(String::as_str));
        let help = near.map(|n| format!("the nearest known name is {n}"));
        let message = format!("no {what} is named {}", name.name);
        self.problems.push(super::report::Severity::Error, "name.unknown", name.at, message, help);
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

    fn places(&mut self, forms: &Forms) {
        for entry in &forms.movetables {
            let movetable = Movetable::from_lines(&entry.lines).unwrap_or_default();
            self.files.movetables.push(MovtabRecord { name: entry.name.name, movetable });
        }
        for entry in &forms.poses {
            let record = self.pose_record(entry);
            self.files.poses.push(record);
            self.origins.poses.push(entry.at);
        }
        for entry in &forms.locpts {
            let (pose, movetable) = (self.pose(entry.pose), self.movetable(entry.movetable));
            let (pose, movetable) = (pose.unwrap_or_default(), movetable.unwrap_or_default());
            let base = pose.of(&self.files.poses).map_or_else(Frame::identity, |p| p.frame);
            let frame = self.moved(&base, movetable);
            self.files.locpts.push(Locpt { name: entry.name.name, pose, movetable, frame });
            self.origins.locpts.push(entry.name.at);
        }
        self.arrays(forms);
        for (i, entry) in forms.owners.iter().enumerate() {
            self.owner(OwnerId::at(i), entry);
        }
        for entry in &forms.trajectories {
            // An end that is not known is noted; the record is kept, since the name index counts it.
            let start = self.reference(entry.start).unwrap_or(Reference::NONE);
            let end = self.reference(entry.end).unwrap_or(Reference::NONE);
            let path = self.path(&entry.points);
            self.files.trajectories.push(Traj { name: entry.name.name, start, end, path });
            self.origins.trajectories.push(entry.start.name.at.to(entry.end.name.at));
        }
    }

    /// A pose with its effective frame; points that are not square are made so.
    fn pose_record(&mut self, entry: &PoseEntry) -> PoseRecord {
        let [wrist, tool, finger] = entry.points;
        let pose = Pose { wrist, tool, finger };
        let movetable = self.movetable(entry.movetable).unwrap_or_default();
        let base = match (pose.to_frame(), pose.off_square()) {
            (Ok(frame), Ok(off)) => {
                self.squareness(entry, off.to_degrees().abs());
                frame
            }
            (Err(error), _) | (_, Err(error)) => {
                self.problems.error("pose.points", entry.at, format!("{}: {error}", entry.name.name));
                Frame::identity()
            }
        };
        PoseRecord { name: entry.name.name, pose, movetable, frame: self.moved(&base, movetable) }
    }

    fn squareness(&mut self, entry: &PoseEntry, degrees: f64) {
        const WARN: f64 = 0.1;
        const REFUSE: f64 = 2.0;
        let message = format!("{} is {degrees:.2} degrees off square", entry.name.name);
        if degrees > REFUSE {
            let help = format!(
                "the finger point must be square to the axis within {REFUSE} degrees: record the pose again"
            );
            self.problems.error_help("pose.square", entry.at, message, help);
        } else if degrees > WARN {
            let help = "it is made square, with the axis from wrist to tool point kept".to_owned();
            self.problems.warning("pose.square", entry.at, message, Some(help));
        }
    }

    /// The dimension form and the location form of each array together (VII.4).
    fn arrays(&mut self, forms: &Forms) {
        let at_names: Vec<_> = forms.arrays_at.iter().map(|e| e.name).collect();
        let located = self.declare_names("array location", &at_names);
        for entry in &forms.arrays_at {
            self.find("array", entry.name, |i| &i.arrays);
        }
        for entry in &forms.arrays {
            let place = located
                .view()
                .find(name_key(&entry.name.name))
                .and_then(|n| ArrayId::new(n).of(&forms.arrays_at));
            let (mut pose, mut offset) = (PoseId::NULL, MovtabId::NULL);
            match place {
                Some(place) => {
                    if place.pose.name.as_str() != NULL_NAME {
                        pose = self.pose(place.pose).unwrap_or_default();
                    }
                    offset = self.movetable(place.movetable).unwrap_or_default();
                }
                None if self.broken.contains(entry.name.name.as_str()) => {}
                None => self.problems.error_help(
                    "array.location",
                    entry.name.at,
                    format!("the array {} has no location", entry.name.name),
                    "an array needs an array location form too (-ar-, VII.4)",
                ),
            }
            let column_step = self.movetable(entry.column_step).unwrap_or_default();
            let row_step = entry.row_step.and_then(|step| self.movetable(step)).unwrap_or_default();
            self.files.arrays.push(Array {
                name: entry.name.name,
                dimensions: entry.dimensions,
                columns: entry.columns,
                rows: entry.rows,
                column_step,
                row_step,
                present: entry.present,
                pose,
                offset,
            });
            if self.indexes.locpts.view().find(name_key(&entry.name.name)).is_some() {
                let message = format!("{} is a location point too", entry.name.name);
                self.problems.error("name.both", entry.name.at, message);
            }
        }
    }

    fn owner(&mut self, id: OwnerId, entry: &OwnerEntry) {
        let first = number(self.files.members.len());
        for member in &entry.members {
            if let Some(reference) = self.reference(*member) {
                self.files.members.push(Member { owner: id, member: reference });
            }
        }
        let of_arrays = entry.members.iter().any(|m| m.kind == RefType::Array);
        if let (true, Some(member)) = (of_arrays, entry.members.first())
            && member.kind != RefType::LocationPoint
        {
            self.problems.error_help(
                "owner.first",
                member.name.at,
                format!("the first member of {} is no location point", entry.name.name),
                "the first member of an owner of arrays is the location point at which they are used (VII.5)",
            );
        }
        let count = number(self.files.members.len()).saturating_sub(first);
        self.files.owners.push(Owner { name: entry.name.name, first, count });
    }

    /// Points and their parameters; equal parameters share a record.
    fn path(&mut self, entries: &[PointEntry]) -> PathId {
        let first = number(self.files.path_points.len());
        for entry in entries {
            let target = match entry.target {
                None => Some(Target::Stop),
                Some(typed) => self.target(typed),
            };
            if let Some(target) = target {
                let para = self.para(entry.para);
                self.files.path_points.push(PathPoint { para, target });
                self.origins.path_points.push(entry.at);
            }
        }
        let count = number(self.files.path_points.len()).saturating_sub(first);
        self.files.paths.push(Path { first, count });
        PathId::new(number(self.files.paths.len()))
    }

    fn target(&mut self, typed: Typed) -> Option<Target> {
        let name = Named { name: Name::clipped(typed.name.name.as_str()), at: typed.name.at };
        match typed.kind {
            RefType::Pose => self.pose(name).map(Target::Pose),
            RefType::LocationPoint => self
                .find("location point", name, |i| &i.locpts)
                .map(|n| Target::LocationPoint(LocptId::new(n))),
            RefType::Movetable => self.movetable(name).map(Target::Movetable),
            _ => None,
        }
    }

    fn para(&mut self, para: TrajPara) -> TrajParaId {
        let next = TrajParaId::at(self.files.traj_paras.len());
        let id = *self.paras.entry([para.acc_fac, para.vel_max, para.smooth, para.brk_dst]).or_insert(next);
        if id == next {
            self.files.traj_paras.push(para);
        }
        id
    }

    fn objects(&mut self, forms: &Forms) {
        let mut ats = Vec::new();
        for entry in &forms.objects {
            let object = self.object(entry.name).unwrap_or_default();
            let [appr_size, grasp_size, grasp_force, depart_size] = entry.values;
            let record =
                EndEffPara { object, grip: entry.grip, appr_size, grasp_size, grasp_force, depart_size };
            self.files.end_effs.push(record);
            ats.push(entry.at);
        }
        let keys = self.files.end_effs.iter().map(|r| grip_key(r.object, r.grip)).collect();
        self.indexes.end_effs = self.unique("this grip of this object", keys, &ats);
        self.show_files(forms);
        for entry in &forms.obj_locs {
            if let (Some(object), Some(assigned)) =
                (self.object(entry.object), self.reference(entry.assigned))
            {
                self.files.obj_locs.push(ObjLoc { object, assigned });
            }
        }
        self.obj_loc_index(forms);
        self.grips_and_views(forms);
        for entry in &forms.appr_depts {
            self.appr_dept(entry);
        }
        let keys = self.files.appr_depts.iter();
        let keys = keys.map(|r| approach_key(r.direction, r.subject, r.grip, r.at)).collect();
        let ats = self.origins.appr_depts.clone();
        self.indexes.appr_depts = self.unique("this approach or depart", keys, &ats);
    }

    fn show_files(&mut self, forms: &Forms) {
        for entry in &forms.obj_grips {
            let object = self.object(entry.object).unwrap_or_default();
            let [endeff_id, tray_grip] = entry.values;
            self.files.obj_grips.push(ObjGrips { object, endeff_id, tray_grip });
        }
        let ats: Vec<At> = forms.obj_grips.iter().map(|e| e.object.at).collect();
        let keys = self.files.obj_grips.iter().map(|r| object_key(r.object)).collect();
        self.indexes.obj_grips = self.unique("the gripper of this object", keys, &ats);
        for entry in &forms.ped_paras {
            let object = self.object(entry.object).unwrap_or_default();
            let [appr, grasp_size, force, release_size, table_pos, flip_angle] = entry.values;
            self.files.ped_paras.push(PedPara {
                object,
                appr,
                grasp_size,
                force,
                release_size,
                table_pos,
                flip_angle,
            });
        }
        let ats: Vec<At> = forms.ped_paras.iter().map(|e| e.object.at).collect();
        let keys = self.files.ped_paras.iter().map(|r| object_key(r.object)).collect();
        self.indexes.ped_paras = self.unique("the pedestal record of this object", keys, &ats);
    }

    /// An object may be assigned to members of several owners, but not twice to the same.
    fn obj_loc_index(&mut self, forms: &Forms) {
        let pairs = self.files.obj_locs.iter().enumerate();
        let pairs = pairs.map(|(i, r)| (object_key(r.object), number(i).saturating_add(1))).collect();
        self.indexes.obj_locs = Sorted::new(pairs);
        if self.files.obj_locs.len() == forms.obj_locs.len() {
            let ats: Vec<At> = forms.obj_locs.iter().map(|e| e.object.at).collect();
            let keys = self.files.obj_locs.iter().map(|r| object_at_key(r.object, r.assigned)).collect();
            self.unique("this location of this object", keys, &ats);
        }
    }

    fn grips_and_views(&mut self, forms: &Forms) {
        for entry in &forms.grips {
            let (object, at, movetable) =
                (self.object(entry.object), self.reference(entry.place), self.movetable(entry.movetable));
            if let (Some(object), Some(at), Some(movetable)) = (object, at, movetable) {
                self.known_grip(object, entry.grip, entry.object);
                self.files.grip_locs.push(GripLoc { object, grip: entry.grip, at, movetable });
                self.origins.grip_locs.push(entry.object.at.to(entry.movetable.at));
            }
        }
        let keys = self.files.grip_locs.iter().map(|r| grip_at_key(r.object, r.grip, r.at)).collect();
        let ats = self.origins.grip_locs.clone();
        self.indexes.grip_locs = self.unique("this grip of this object at this location", keys, &ats);
        for entry in &forms.views {
            let (object, at, movetable) =
                (self.object(entry.object), self.reference(entry.place), self.movetable(entry.movetable));
            if let (Some(object), Some(at), Some(movetable)) = (object, at, movetable) {
                self.known_grip(object, entry.grip, entry.object);
                self.files.visions.push(VisionPara {
                    object,
                    grip: entry.grip,
                    id: entry.id,
                    at,
                    movetable,
                    offset_from: entry.offset_from,
                    range: entry.range,
                    enabled: entry.enabled,
                });
                self.origins.visions.push(entry.object.at.to(entry.movetable.at));
            }
        }
        let keys = self.files.visions.iter().map(|r| object_at_key(r.object, r.at)).collect();
        let ats = self.origins.visions.clone();
        self.indexes.visions = self.unique("the view of this object at this location", keys, &ats);
    }

    /// A grip must stand in the object form, which has its openings and its force (VII.7.1).
    fn known_grip(&mut self, object: ObjectId, grip: i32, name: Named<16>) {
        if self.indexes.end_effs.view().find(grip_key(object, grip)).is_none() {
            let grips: Vec<String> = self
                .files
                .end_effs
                .iter()
                .filter(|e| e.object == object)
                .map(|e| e.grip.to_string())
                .collect();
            self.problems.error_help(
                "grip.unknown",
                name.at,
                format!("{} has no grip {grip} in an object form", name.name),
                format!("it has grip {}", grips.join(" and ")),
            );
        }
    }

    fn appr_dept(&mut self, entry: &ApprDeptEntry) {
        let subject = self.reference(entry.subject);
        let at = entry.place.map_or(subject, |place| self.reference(place));
        let path = self.path(&entry.points);
        if let (Some(subject), Some(at)) = (subject, at) {
            if matches!(subject.kind, RefType::Object | RefType::View) {
                self.known_grip(ObjectId::new(subject.number), entry.grip, entry.subject.name);
            }
            self.files.appr_depts.push(ApprDept {
                direction: entry.direction,
                subject,
                grip: entry.grip,
                at,
                path,
            });
            self.origins.appr_depts.push(entry.at);
        }
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
            self.problems.error("file.full", At::default(), message);
        }
        self.files = store.files;
    }
}

/// The name that a key was made of.
fn key_text(key: u128) -> String {
    key.to_be_bytes().iter().take_while(|b| **b != 0).map(|b| char::from(*b)).collect()
}
