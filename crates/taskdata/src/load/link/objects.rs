//! Links the forms of objects (VII.7).

use crate::files::{
    ApprDept, EndEffPara, GripLoc, ObjGrips, ObjLoc, ObjectId, PedPara, RefType, Reference, VisionPara,
    index::{approach_key, grip_at_key, name_at_key, plain_key},
};

use super::{
    super::{
        collected::Collected,
        entries::{ApprDeptEntry, GripEntry, Named, ObjLocEntry, ObjectEntry},
        parallel,
    },
    Keyed, Linker, sure,
};

impl Linker<'_> {
    pub(super) fn objects(&mut self, all: &Collected) {
        let known = self.known();
        let end_eff = |entry: &ObjectEntry| {
            let object = known.object(&entry.name).unwrap_or_default();
            let [appr_size, grasp_size, grasp_force, depart_size] = entry.values;
            EndEffPara { object, grip: entry.grip, appr_size, grasp_size, grasp_force, depart_size }
        };
        self.files.end_effs = parallel::map_each(&all.objects, end_eff).collect();
        self.show_files(all);
        let locations = self.object_locations(all);
        let (grips, views, paths) = (self.grips(all), self.views(all), self.appr_depts(all));
        let [grips, paths, views] = self.indexed_at([grips, paths, views]);
        let [locations] = self.indexed([locations]);
        let (indexes, origins) = (&mut self.indexes, &mut self.origins);
        // An object may be assigned to members of several owners, but only once to each.
        origins.obj_locs = locations.1;
        (indexes.grip_locs, origins.grip_locs) = grips;
        (indexes.visions, origins.visions) = views;
        (indexes.appr_depts, origins.appr_depts) = paths;
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

    fn object_locations(&mut self, all: &Collected) -> Keyed {
        let mut keyed = Keyed::with_capacity("this location of this object", all.obj_locs.len());
        let known = self.known();
        let linked = parallel::map_each(&all.obj_locs, |entry| known.obj_loc(entry));
        for (entry, linked) in all.obj_locs.iter().zip(linked) {
            if let Some(record) = linked.or_else(|| self.obj_loc(entry)) {
                self.files.obj_locs.push(record);
                keyed.push(name_at_key(&entry.object.name, record.assigned), 0, entry.object.at);
            }
        }
        keyed
    }

    fn obj_loc(&mut self, entry: &ObjLocEntry) -> Option<ObjLoc> {
        let (object, assigned) = (self.object(entry.object), self.reference(entry.assigned));
        Some(ObjLoc { object: object?, assigned: assigned? })
    }

    fn grips(&mut self, all: &Collected) -> Keyed {
        let mut keyed = Keyed::with_capacity("this grip of this object at this location", all.grips.len());
        let known = self.known();
        let linked = parallel::map_each(&all.grips, |entry| known.grip(entry));
        for (entry, linked) in all.grips.iter().zip(linked) {
            if let Some(record) = linked.or_else(|| self.grip(entry)) {
                let key = sure(grip_at_key(&entry.object.name, entry.grip, record.at));
                let at = entry.object.at.to(entry.movetable.at);
                keyed.push(key, record.movetable.number(), at);
                self.files.grip_locs.push(record);
            }
        }
        keyed
    }

    fn grip(&mut self, entry: &GripEntry) -> Option<GripLoc> {
        let (object, at) = (self.object(entry.object), self.reference(entry.place));
        let movetable = self.movetable(entry.movetable);
        let record = GripLoc { object: object?, grip: entry.grip, at: at?, movetable: movetable? };
        self.known_grip(record.object, entry.grip, entry.object);
        Some(record)
    }

    fn views(&mut self, all: &Collected) -> Keyed {
        let mut keyed = Keyed::with_capacity("the view of this object at this location", all.views.len());
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
                keyed.push(name_at_key(&entry.object.name, at), 0, place);
            }
        }
        keyed
    }

    /// Reports a grip without an object form, which gives openings and force (VII.7.1).
    fn known_grip(&mut self, object: ObjectId, grip: i32, name: Named<16>) {
        if !self.known().has_grip(&name, grip) && !self.has_elsewhere(name.name.as_str()) {
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

    fn appr_depts(&mut self, all: &Collected) -> Keyed {
        let mut keyed = Keyed::with_capacity("this approach or depart", all.appr_depts.len());
        let known = self.known();
        let linked = parallel::map_each(&all.appr_depts, |entry| known.subject(entry));
        for (entry, linked) in all.appr_depts.iter().zip(linked) {
            let found = linked.or_else(|| self.subject(entry));
            let path = self.path(&entry.points);
            let Some((subject, at)) = found else { continue };
            let ApprDeptEntry { direction, grip, .. } = *entry;
            let key = if matches!(subject.kind, RefType::Object | RefType::View) {
                sure(approach_key(direction, subject.kind, &entry.subject.name.name, grip, at))
            } else {
                plain_key(direction, at)
            };
            self.files.appr_depts.push(ApprDept { direction, subject, grip, at, path });
            keyed.push(key, path.number(), entry.at);
        }
        keyed
    }

    fn subject(&mut self, entry: &ApprDeptEntry) -> Option<(Reference, Reference)> {
        let subject = self.reference(entry.subject);
        let at = entry.place.map_or(subject, |place| self.reference(place));
        let (subject, at) = (subject?, at?);
        if matches!(subject.kind, RefType::Object | RefType::View) {
            self.known_grip(ObjectId::new(subject.number), entry.grip, entry.subject.name);
        }
        Some((subject, at))
    }
}
