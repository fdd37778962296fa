//! Finds objects that differ only in their vision ids: one of them is probably an unfinished copy of the other.

use std::collections::HashMap;

use crate::files::{ObjectId, Reference, TaskData};

#[derive(Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Described {
    grips: Vec<[i32; 5]>,
    grippers: Vec<[i32; 2]>,
    assigned: Vec<(u8, u32)>,
    movetables: Vec<(i32, (u8, u32), u32)>,
    views: Vec<[i64; 6]>,
}

const fn bits(reference: Reference) -> (u8, u32) {
    (reference.kind.code(), reference.number)
}

#[must_use]
pub fn alike(data: &TaskData<'_>) -> Vec<[ObjectId; 2]> {
    let mut ids: HashMap<ObjectId, Vec<i32>> = HashMap::new(); // only objects with views have vision ids
    for view in data.visions {
        ids.entry(view.object).or_default().push(view.id);
    }
    let mut described: HashMap<ObjectId, Described> =
        ids.keys().map(|&object| (object, Described::default())).collect();
    describe(data, &mut described);
    let mut objects: Vec<(ObjectId, Described)> = described.into_iter().collect();
    objects.sort_unstable_by_key(|(object, _)| *object);
    let mut first_of: HashMap<Described, ObjectId> = HashMap::new();
    let mut pairs = Vec::new();
    for (object, mut description) in objects {
        description.sort();
        let first = *first_of.entry(description).or_insert(object);
        if first != object && ids.get(&first) != ids.get(&object) {
            pairs.push([first, object]);
        }
    }
    pairs
}

impl Described {
    fn sort(&mut self) {
        self.grips.sort_unstable();
        self.assigned.sort_unstable();
        self.movetables.sort_unstable();
        self.views.sort_unstable();
    }
}

fn describe(data: &TaskData<'_>, described: &mut HashMap<ObjectId, Described>) {
    for r in data.end_effs {
        if let Some(d) = described.get_mut(&r.object) {
            d.grips.push([r.grip, r.appr_size, r.grasp_size, r.grasp_force, r.depart_size]);
        }
    }
    for r in data.obj_grips {
        if let Some(d) = described.get_mut(&r.object) {
            d.grippers.push([r.endeff_id, r.tray_grip]);
        }
    }
    for r in data.obj_locs {
        if let Some(d) = described.get_mut(&r.object) {
            d.assigned.push(bits(r.assigned));
        }
    }
    for r in data.grip_locs {
        if let Some(d) = described.get_mut(&r.object) {
            d.movetables.push((r.grip, bits(r.at), r.movetable.number()));
        }
    }
    for r in data.visions {
        if let Some(d) = described.get_mut(&r.object) {
            d.views.push([
                r.at.kind.code().into(),
                r.at.number.into(),
                r.grip.into(),
                r.movetable.number().into(),
                r.range.into(),
                r.enabled.into(),
            ]);
        }
    }
}
