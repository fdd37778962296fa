//! Everything that belongs to objects (VII.7).

use crate::files::{
    ApprDept, EndEffPara, GripLoc, ObjGrips, ObjLoc, ObjectId, PedPara, RefType, VisionPara,
    index::{approach_key, grip_at_key, grip_key, object_at_key, object_key},
};

use super::{
    super::{
        collected::Collected,
        entries::{ApprDeptEntry, Named},
        index::OwnedIndex,
        source::At,
    },
    Linker, numbered,
};

impl Linker<'_> {
    pub(super) fn objects(&mut self, all: &Collected) {
        let mut ats = Vec::new();
        for entry in &all.objects {
            let object = self.object(entry.name).unwrap_or_default();
            let [appr_size, grasp_size, grasp_force, depart_size] = entry.values;
            let record =
                EndEffPara { object, grip: entry.grip, appr_size, grasp_size, grasp_force, depart_size };
            self.files.end_effs.push(record);
            ats.push(entry.at);
        }
        let keys = numbered(self.files.end_effs.iter().map(|r| grip_key(r.object, r.grip)));
        self.indexes.end_effs = self.unique("this grip of this object", &keys, &ats);
        self.origins.end_effs = ats;
        self.show_files(all);
        self.object_locations(all);
        self.grips(all);
        self.views(all);
        for entry in &all.appr_depts {
            self.appr_dept(entry);
        }
        let keys = self.files.appr_depts.iter();
        let keys = numbered(keys.map(|r| approach_key(r.direction, r.subject, r.grip, r.at)));
        let ats = std::mem::take(&mut self.origins.appr_depts);
        self.indexes.appr_depts = self.unique("this approach or depart", &keys, &ats);
        self.origins.appr_depts = ats;
    }

    fn show_files(&mut self, all: &Collected) {
        for entry in &all.obj_grips {
            let object = self.object(entry.object).unwrap_or_default();
            let [endeff_id, tray_grip] = entry.values;
            self.files.obj_grips.push(ObjGrips { object, endeff_id, tray_grip });
        }
        let ats: Vec<At> = all.obj_grips.iter().map(|e| e.object.at).collect();
        let keys = numbered(self.files.obj_grips.iter().map(|r| object_key(r.object)));
        self.indexes.obj_grips = self.unique("the gripper of this object", &keys, &ats);
        self.origins.obj_grips = ats;
        for entry in &all.ped_paras {
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
        let ats: Vec<At> = all.ped_paras.iter().map(|e| e.object.at).collect();
        let keys = numbered(self.files.ped_paras.iter().map(|r| object_key(r.object)));
        self.indexes.ped_paras = self.unique("the pedestal record of this object", &keys, &ats);
        self.origins.ped_paras = ats;
    }

    /// An object may be assigned to members of several owners, but not twice to the same.
    fn object_locations(&mut self, all: &Collected) {
        let mut ats = Vec::new();
        for entry in &all.obj_locs {
            if let (Some(object), Some(assigned)) =
                (self.object(entry.object), self.reference(entry.assigned))
            {
                self.files.obj_locs.push(ObjLoc { object, assigned });
                ats.push(entry.object.at);
            }
        }
        let records = &self.files.obj_locs;
        self.indexes.obj_locs = OwnedIndex::new(&numbered(records.iter().map(|r| object_key(r.object))));
        let keys = numbered(records.iter().map(|r| object_at_key(r.object, r.assigned)));
        self.unique("this location of this object", &keys, &ats);
        self.origins.obj_locs = ats;
    }

    fn grips(&mut self, all: &Collected) {
        let mut ats = Vec::new();
        for entry in &all.grips {
            let (object, at, movetable) =
                (self.object(entry.object), self.reference(entry.place), self.movetable(entry.movetable));
            if let (Some(object), Some(at), Some(movetable)) = (object, at, movetable) {
                self.known_grip(object, entry.grip, entry.object);
                self.files.grip_locs.push(GripLoc { object, grip: entry.grip, at, movetable });
                ats.push(entry.object.at.to(entry.movetable.at));
            }
        }
        let keys = numbered(self.files.grip_locs.iter().map(|r| grip_at_key(r.object, r.grip, r.at)));
        self.indexes.grip_locs = self.unique("this grip of this object at this location", &keys, &ats);
        self.origins.grip_locs = ats;
    }

    fn views(&mut self, all: &Collected) {
        let mut ats = Vec::new();
        for entry in &all.views {
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
                ats.push(entry.object.at.to(entry.movetable.at));
            }
        }
        let keys = numbered(self.files.visions.iter().map(|r| object_at_key(r.object, r.at)));
        self.indexes.visions = self.unique("the view of this object at this location", &keys, &ats);
        self.origins.visions = ats;
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
}
