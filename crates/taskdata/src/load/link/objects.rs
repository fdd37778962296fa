//! Everything that belongs to objects (VII.7).

use crate::files::{
    ApprDept, EndEffPara, GripLoc, ObjGrips, ObjLoc, ObjectId, PedPara, RefType, VisionPara,
    index::{approach_key, grip_at_key, grip_key, object_at_key, object_key},
};

use super::{
    super::{
        entries::{ApprDeptEntry, Named},
        source::At,
        store::Sorted,
    },
    Forms, Linker, number,
};

impl Linker<'_> {
    pub(super) fn objects(&mut self, forms: &Forms) {
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
}
