//! Parts that lie in nests (cylinders and tools). A grip keeps its position relative to the middle of the part; grips
//! at a nest move with it. A part that does not rest like the like part does not fit its nests.

use geometry::{
    frame::{Frame, Vector},
    movetable::{MovetableLine, System},
};
use plant::{
    CellDescription,
    description::{Nest, PartType, Points},
    room::Room,
};
use rcs_core::name::Name16;
use runtime::setup::CELL;
use taskdata::{
    files::RefType,
    load::{
        Store,
        entries::{Entry, GripEntry, Typed},
    },
};

use super::{
    change::Change,
    family::Family,
    numbers::{Numbers, Places},
    sizes::{ROOM, hundredths, resized},
};
use crate::rcs_run::error::Error;

const ABOVE: f64 = 3.0; // height above its nest from which a part is lowered, in
/// Greatest difference between the resting heights of the part's lower side and of the like part's, in.
const SAME: f64 = 0.10;

pub struct Nested<'a> {
    family: &'a Family,
    store: &'a Store,
    parts: Vec<PartType>,
    /// The like part's nests, with the vector from the middle of the like blank to that of the new one, world, in.
    nests: Vec<(Nest, Vector)>,
}

impl<'a> Nested<'a> {
    /// Compute where a blank of a size (along its axes, in) lies, if it fits the nests and the fingers.
    pub fn new(
        (store, cell): (&'a Store, &CellDescription),
        family: &'a Family,
        name: &str,
        (blank, weight): ([f64; 3], Option<f64>),
    ) -> Result<Self, Error> {
        let refused = |why: String| Error::New(format!("{name} cannot be made like {}: {why}", family.stem));
        let old = family.parts.first().ok_or_else(|| refused("it has no part".to_owned()))?;
        let renamed = |part: &PartType| resized(part, old, blank, &family.renamed(&part.name, name));
        let mut parts: Vec<PartType> = family.parts.iter().map(renamed).collect();
        if let Some(part) = parts.iter().find(|part| part.size.iter().any(|side| *side < 0.1)) {
            return Err(refused(format!("of {} too little would be left after machining", part.name)));
        }
        let room = Room::new(cell);
        if let Some(first) = parts.first_mut() {
            first.weight = weight.unwrap_or(first.weight);
            fingers_reach(&room, family, first).map_err(refused)?;
        }
        let new = parts.first().unwrap_or(old);
        let its = cell.nest.iter().filter(|nest| nest.takes(old));
        let nests = its.map(|nest| Ok((nest.clone(), moved(&room, nest, old, new)?)));
        let nests = nests.collect::<Result<_, _>>().map_err(refused)?;
        Ok(Self { family, store, parts, nests })
    }

    /// Displacement of a grip at a place, in axes of the place.
    fn shift(&self, object: &Name16, place: &Typed) -> Result<Vector, Error> {
        let data = self.store.view();
        let name = place.name.name;
        let at_point = place.kind == RefType::LocationPoint;
        let here = |nest: &Nest| match at_point {
            true => nest.location == name.as_str(),
            false => nest.sector != 0,
        };
        let mut found: Option<Vector> = None;
        for (nest, by) in self.nests.iter().filter(|(nest, _)| here(nest)) {
            let sector = (nest.sector != 0).then(|| i32::from(nest.sector));
            let location = Name16::clipped(&nest.location);
            let Ok(location) = data.resolve_location(&location, sector, Some(object)) else { continue };
            let seen = location.frame.rotation.inverse() * by;
            if found.is_some_and(|other| (other - seen).norm() > SAME / 2.0) {
                let what = format!("{name} has nests in which it lies differently");
                return Err(Error::New(format!("no grip serves all of {object}: {what}")));
            }
            found = Some(seen);
        }
        Ok(found.unwrap_or_else(Vector::zeros))
    }
}

impl Numbers for Nested<'_> {
    fn parts(&self) -> &[PartType] {
        &self.parts
    }

    /// A grip that is valid at any place stays unchanged; a second grip is added for the array of the nests.
    fn grips(&self, grip: &GripEntry) -> Result<Vec<(Typed, Vec<MovetableLine>)>, Error> {
        let object = grip.object.name;
        let table = self.family.movetable(grip.movetable.name.as_str());
        let lines = table.map(|table| table.lines.clone()).unwrap_or_default();
        if grip.place.kind != RefType::Any {
            let by = self.shift(&object, &grip.place)?;
            return Ok(vec![(grip.place, shifted(lines, by))]);
        }
        let assigned = self.family.entries().find_map(|entry| match entry {
            Entry::ObjLoc(place) if place.object.name == object => Some(place.assigned),
            _ => None,
        });
        let mut grips = vec![(grip.place, lines.clone())];
        if let Some(array) = assigned {
            let moved = shifted(lines.clone(), self.shift(&object, &array)?);
            grips.extend((moved != lines).then_some((array, moved)));
        }
        Ok(grips)
    }

    /// Openings of an object: the grasp size is the diameter.
    fn openings(&self, object: &Name16, [appr, grasp, force, depart]: [i32; 4]) -> [i32; 4] {
        let part = self.family.part_of(object).map(|(part, _)| part);
        let width =
            |parts: &[PartType]| part.and_then(|part| parts.get(part)).map_or(0.0, |part| part.size[1]);
        [appr, grasp + hundredths(width(&self.parts) - width(&self.family.parts)), force, depart]
    }

    fn places(&self, change: &mut Change) -> Result<Places, Error> {
        let names: Vec<&str> = self.parts.iter().map(|part| part.name.as_str()).collect();
        let tables: Vec<String> = self.nests.iter().map(|(nest, by)| table(nest, &names, *by)).collect();
        change.add_table(CELL, "nest", "", &tables.join("\n"))?;
        let by = self.nests.iter().map(|(nest, by)| {
            let how = match hundredths(by.z) {
                0 => "its middle where that of the like part is".to_owned(),
                high => format!("its middle {:.2} in above that of the like part", f64::from(high) / 100.0),
            };
            ("nest", format!("{}: {how}", place(nest)))
        });
        Ok(Places { chosen: by.collect(), to_teach: Vec::new(), others: false })
    }
}

/// Check that the fingers close on a part and open around it.
fn fingers_reach(room: &Room, family: &Family, part: &PartType) -> Result<(), String> {
    let gripper = family.entries().find_map(|entry| match entry {
        Entry::ObjGrips(grips) => room.gripper(u8::try_from(grips.values[0]).ok()?),
        _ => None,
    });
    let [least, most] = gripper.ok_or("no form says which gripper takes it")?.opening;
    let diameter = part.size[1];
    (least..=most - ROOM).contains(&diameter).then_some(()).ok_or_else(|| {
        format!(
            "its gripper takes diameters from {least:.2} to {:.2} in, and it has {diameter:.2} in",
            most - ROOM
        )
    })
}

fn place(nest: &Nest) -> String {
    let sector = if nest.sector == 0 { String::new() } else { format!(" sector {}", nest.sector) };
    format!("{}{sector}", nest.location)
}

/// Vector from the middle of a part to that of another part in the same nest, world coordinates, 0.01 in.
fn moved(room: &Room, nest: &Nest, old: &PartType, new: &PartType) -> Result<Vector, String> {
    let seat = nest.frame();
    let axes = [seat.x(), seat.y(), seat.z()];
    let lowest = axes.iter().zip(0..).max_by(|(one, _), (other, _)| one.z.abs().total_cmp(&other.z.abs()));
    let (axis, along) = lowest.map_or((seat.x(), 0), |(axis, along)| (*axis, along));
    let down = if axis.z > 0.0 { -axis } else { axis };
    let half = |part: &PartType| part.size.get(along).map_or(0.0, |size| size / 2.0);
    let above = ABOVE + half(new);
    let from = Frame { position: seat.position - down * above, ..seat };
    let place = place(nest);
    let rests = room.let_down(new, &from, &down, above + half(old));
    let rests = rests.ok_or_else(|| format!("it does not fit into the nest at {place}"))?;
    let by = rests.position - seat.position;
    let higher = half(old) - half(new) - by.dot(&down);
    if higher.abs() > SAME {
        return Err(format!(
            "it does not fit into the nest at {place}: it would lie {higher:.2} in above its floor"
        ));
    }
    Ok(by.map(|inches| f64::from(hundredths(inches)) / 100.0))
}

/// Lines of a movetable that begin with an offset in axes of the place.
fn shifted(mut lines: Vec<MovetableLine>, by: Vector) -> Vec<MovetableLine> {
    let by = [by.x, by.y, by.z].map(hundredths);
    if by == [0; 3] {
        return lines;
    }
    match lines.first_mut().filter(|line| line.system == System::Tool) {
        Some(first) => first.values.iter_mut().zip(by).for_each(|(value, by)| *value += by),
        None => lines.insert(0, MovetableLine { system: System::Tool, values: by }),
    }
    lines
}

/// The table of a nest in the cell description.
fn table(like: &Nest, parts: &[&str], by: Vector) -> String {
    let Points { wrist, tool, finger } = like.seat;
    let by = [by.x, by.y, by.z].map(hundredths);
    let [wrist, tool, finger] = [wrist, tool, finger].map(|[x, y, z]| [x + by[0], y + by[1], z + by[2]]);
    let mut text = format!("[[nest]]\nlocation = \"{}\"\n", like.location);
    if like.sector != 0 {
        text += &format!("sector = {}\n", like.sector);
    }
    text +=
        &format!("parts = {parts:?}\nseat = {{ wrist = {wrist:?}, tool = {tool:?}, finger = {finger:?} }}\n");
    if let Some(allowed) = like.machining {
        let (inches, degrees) = (allowed.inches, allowed.degrees);
        text += &format!("machining = {{ inches = {inches:?}, degrees = {degrees:?} }}\n");
    }
    text
}
