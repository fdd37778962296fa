//! Everything that belongs to objects (VII.7).

use crate::files::{
    ApprDept, EndEffPara, GripLoc, ObjGrips, ObjLoc, ObjectId, PedPara, RefType, VisionPara,
    index::{Key, approach_key, grip_at_key, grip_key, name_at_key, object_key, plain_key},
};

use super::{
    super::{
        collected::Collected,
        entries::{ApprDeptEntry, Named},
        index::{OwnedIndex, Pair},
        source::At,
    },
    Keyed, Linker, sure,
};

impl Linker<'_> {
    pub(super) fn objects(&mut self, all: &Collected) {
        for entry in &all.objects {
            let object = self.object(entry.name).unwrap_or_default();
            let [appr_size, grasp_size, grasp_force, depart_size] = entry.values;
            let record =
                EndEffPara { object, grip: entry.grip, appr_size, grasp_size, grasp_force, depart_size };
            self.files.end_effs.push(record);
        }
        self.show_files(all);
        let locations = self.object_locations(all);
        let (grips, views) = (self.grips(all), self.views(all));
        let paths: Vec<_> = all.appr_depts.iter().filter_map(|entry| self.appr_dept(entry)).collect();
        let [locations, grips, views, paths] = self.indexed([
            Keyed::new("this location of this object", locations.into_iter()),
            Keyed::answered("this grip of this object at this location", grips.into_iter()),
            Keyed::new("the view of this object at this location", views.into_iter()),
            Keyed::answered("this approach or depart", paths.into_iter()),
        ]);
        let (indexes, origins) = (&mut self.indexes, &mut self.origins);
        // An object may be assigned to members of several owners, but not twice to the same.
        origins.obj_locs = locations.1;
        (indexes.grip_locs, origins.grip_locs) = grips;
        (indexes.visions, origins.visions) = views;
        (indexes.appr_depts, origins.appr_depts) = paths;
        let by_object = |r: &ObjLoc, number| Pair { key: object_key(r.object), number, answer: 0 };
        let pairs: Vec<Pair> = self.files.obj_locs.iter().zip(1..).map(|(r, n)| by_object(r, n)).collect();
        self.indexes.obj_locs = OwnedIndex::new(&pairs);
    }

    fn show_files(&mut self, all: &Collected) {
        for entry in &all.obj_grips {
            let object = self.object(entry.object).unwrap_or_default();
            let [endeff_id, tray_grip] = entry.values;
            self.files.obj_grips.push(ObjGrips { object, endeff_id, tray_grip });
        }
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
    }

    fn object_locations(&mut self, all: &Collected) -> Vec<(Key, At)> {
        let mut keys = Vec::new();
        for entry in &all.obj_locs {
            if let (Some(object), Some(assigned)) =
                (self.object(entry.object), self.reference(entry.assigned))
            {
                self.files.obj_locs.push(ObjLoc { object, assigned });
                keys.push((name_at_key(&entry.object.name, assigned), entry.object.at));
            }
        }
        keys
    }

    /// Grips at locations; gives their keys, answers and places.
    fn grips(&mut self, all: &Collected) -> Vec<(Key, u32, At)> {
        let mut keys = Vec::new();
        for entry in &all.grips {
            let (object, at, movetable) =
                (self.object(entry.object), self.reference(entry.place), self.movetable(entry.movetable));
            if let (Some(object), Some(at), Some(movetable)) = (object, at, movetable) {
                self.known_grip(object, entry.grip, entry.object);
                self.files.grip_locs.push(GripLoc { object, grip: entry.grip, at, movetable });
                let key = sure(grip_at_key(&entry.object.name, entry.grip, at));
                keys.push((key, movetable.number(), entry.object.at.to(entry.movetable.at)));
            }
        }
        keys
    }

    fn views(&mut self, all: &Collected) -> Vec<(Key, At)> {
        let mut keys = Vec::new();
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
                let place = entry.object.at.to(entry.movetable.at);
                keys.push((name_at_key(&entry.object.name, at), place));
            }
        }
        keys
    }

    /// A grip must stand in the object form, which has its openings and its force (VII.7.1).
    fn known_grip(&mut self, object: ObjectId, grip: i32, name: Named<16>) {
        if self.indexes.end_effs.view().find(sure(grip_key(&name.name, grip))).is_none() {
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

    /// An approach or depart; gives its key, answer and place.
    fn appr_dept(&mut self, entry: &ApprDeptEntry) -> Option<(Key, u32, At)> {
        let ApprDeptEntry { direction, grip, .. } = *entry;
        let subject = self.reference(entry.subject);
        let at = entry.place.map_or(subject, |place| self.reference(place));
        let path = self.path(&entry.points);
        let (subject, at) = (subject?, at?);
        let name = entry.subject.name;
        let key = if matches!(subject.kind, RefType::Object | RefType::View) {
            self.known_grip(ObjectId::new(subject.number), grip, name);
            sure(approach_key(direction, subject.kind, &name.name, grip, at))
        } else {
            plain_key(direction, at)
        };
        self.files.appr_depts.push(ApprDept { direction, subject, grip, at, path });
        Some((key, path.number(), entry.at))
    }
}
