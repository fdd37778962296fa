//! Computes the numbers of a family whose parts have other sizes. A grip moves with the face to which it refers: the
//! floor of a tray, the back, ledge and fixed face of the vise, the front face for a push, the middle of the part at
//! the pedestal. This keeps the clearances of the like part.

use plant::{
    CellDescription,
    description::{Gripper, PartType, ViseProgram},
};
use rcs_core::name::Name16;
use runtime::setup::CELL;
use taskdata::{
    files::RefType,
    load::entries::{GripEntry, MovetableEntry, Typed},
};

use geometry::{
    movetable::{MovetableLine, System},
    units::Length,
};

use super::{
    change::Change,
    family::{Family, subject},
    jaws::{Chosen, StepNeeds, choose},
    numbers::{Numbers, Places},
};
use crate::rcs_run::error::Error;

/// Largest share of a low part's height that the fingers cover. The remaining height keeps them off the floor.
const REACH: f64 = 2.0 / 3.0;
const CLEAR: f64 = 0.25; // clearance of the fingers above jaws and hands, in
pub const ROOM: f64 = 0.5; // least clearance of an open gripper around a part, both sides together, in
const SAFE: f64 = 3.0; // safety factor of the grasp force over the force that weight and lever require
const MM: f64 = 25.4; // millimetres in an inch

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Tray,
    Vise,
    Pedestal,
}

pub struct Sizes<'a> {
    cell: &'a CellDescription,
    family: &'a Family,
    pub parts: Vec<PartType>,
    before: ViseProgram, // the step of the like part, and that of the new part
    pub step: Chosen,
    tips: [f64; 2], // height of the fingertips above the floor, in: like part and new part
    /// Height of the tool point above the lower end of a vertical part, in: like part and new part.
    height: [f64; 2],
    behind: f64, // distance before the back where the like part is released, in
    force: f64,  // grasp force, lb, if that of the like part is too small
}

impl<'a> Sizes<'a> {
    /// Compute the numbers for a blank of a size (height, width, length, in).
    pub fn new(
        cell: &'a CellDescription,
        family: &'a Family,
        name: &str,
        blank: [f64; 3],
    ) -> Result<Self, Error> {
        let refused = |why: String| Error::New(format!("{name} cannot be made like {}: {why}", family.stem));
        let old = family.parts.first().ok_or_else(|| refused("it has no part".to_owned()))?;
        let before = family.program.clone().ok_or_else(|| refused("its job has no vise".to_owned()))?;
        let parts =
            family.parts.iter().map(|part| resized(part, old, blank, &family.renamed(&part.name, name)));
        let parts: Vec<PartType> = parts.collect();
        if let Some(part) = parts.iter().find(|part| part.size.iter().any(|side| *side < 0.1)) {
            return Err(refused(format!("of {} too little would be left after machining", part.name)));
        }
        let rules = Rules { cell, family, before: &before };
        let (like, tips) = rules.read().map_err(refused)?;
        let [height, width, length] = blank;
        let new_tips = tips.min((1.0 - REACH) * parts.iter().map(|part| part.size[0]).fold(height, f64::min));
        let pushed = family.entries().filter_map(subject);
        let pushed = pushed.filter_map(|object| family.part_of(&object)).filter(|(_, own)| !own);
        let pushed = pushed.filter_map(|(at, _)| parts.get(at)).map(|part| part.size[0]);
        let edge = cell.gripper.parts.fingers[2] / 2.0;
        let open = before.opening_open - old.size[1];
        let wanted = StepNeeds {
            height,
            pushed: pushed.reduce(f64::min),
            out: old.size[0] - before.back,
            behind: like.behind,
            width,
            narrowest: parts.iter().map(|part| part.size[1]).fold(width, f64::min),
            length,
            fingers: CLEAR,
            partial: before.opening_partial - old.size[1],
            open,
            stands_in_open: open <= 2.0 * (before.depth - super::jaws::LEDGE),
        };
        let step = choose(&cell.vise, &before, name, &wanted)
            .map_err(|why| refused(format!("it does not fit the vise:\n  {}", why.join("\n  "))))?;
        let lowest =
            (CLEAR + edge - step.program.ledge).max(like.in_hand.map_or(0.0, |hand| hand + CLEAR + edge));
        let above = lowest.max(length / 2.0);
        if length - (above - edge) < super::jaws::GRIPPED {
            return Err(refused(format!(
                "the fingers would have {:.2} in of its length",
                length - above + edge
            )));
        }
        let mut sizes = Self {
            cell,
            family,
            parts,
            before: before.clone(),
            step,
            tips: [tips, new_tips],
            height: [like.height, above],
            behind: like.behind,
            force: 0.0,
        };
        sizes.lies_in_tray().and_then(|()| sizes.is_reached()).map_err(refused)?;
        sizes.force = sizes.needed_force();
        let most = cell.gripper.parts.greatest_force;
        if sizes.force > most {
            let why = format!("the fingers would need {:.0} lb to carry it, and have {most} lb", sizes.force);
            return Err(refused(why));
        }
        Ok(sizes)
    }

    /// Check that a part stays in its tray at every position that a seed can give it.
    fn lies_in_tray(&self) -> Result<(), String> {
        let Some([_, width, length]) = self.parts.first().map(|part| part.size) else { return Ok(()) };
        let around = width.hypot(length) / 2.0 + self.cell.tray_shape.random_offset;
        let room = |[x, y]: &[f64; 2], [cx, cy]: [f64; 2]| {
            self.cell.tray_shape.inside / 2.0 - (x - cx).abs().max((y - cy).abs())
        };
        let rooms =
            self.cell.tray.iter().flat_map(|tray| tray.sectors.iter().map(|at| room(at, tray.centre)));
        let least = rooms.fold(f64::INFINITY, f64::min);
        (around <= least).then_some(()).ok_or_else(|| {
            format!("a sector of the trays has {least:.2} in of room around its middle, and the part needs {around:.2} in")
        })
    }

    fn is_reached(&self) -> Result<(), String> {
        let Gripper { fingers, opening, .. } = &self.cell.gripper.parts;
        let [height, width, _] = self.parts.first().map_or([0.0; 3], |part| part.size);
        if height - self.tips[1] > fingers[0] - CLEAR {
            let most = fingers[0] - CLEAR + self.tips[1];
            return Err(format!("the fingers are long enough for parts up to {most:.2} in high"));
        }
        if width + ROOM > opening[1] {
            let most = opening[1] - ROOM;
            return Err(format!("the fingers open for parts up to {most:.2} in wide"));
        }
        Ok(())
    }

    /// The grasp force that weight and lever arm of the parts require, lb.
    fn needed_force(&self) -> f64 {
        let gripper = &self.cell.gripper.parts;
        let [length, _, wide] = gripper.fingers;
        let of = |part: &PartType| {
            let [height, _, long] = part.size;
            let lever = (self.height[1] - long / 2.0).abs();
            let over = (long - (self.height[1] - wide / 2.0)).min(wide);
            let area = over * (height - self.tips[1]).min(length);
            let arm = 2.0 / 3.0 * (area / std::f64::consts::PI).sqrt();
            SAFE * part.weight * (1.0 + lever / arm) / (2.0 * gripper.friction)
        };
        self.parts.iter().map(of).fold(0.0, f64::max)
    }

    /// The lines of the movetable of a grip. Fails with [`Error::New`] if the grip is at an unsupported place.
    pub fn moved(&self, grip: &GripEntry) -> Result<Vec<MovetableLine>, Error> {
        let (name, table) = (&grip.object.name, grip.movetable.name);
        let unknown = |what: String| Error::New(format!("the grip of {name} cannot be made: {what}"));
        let table = self.family.movetable(table.as_str()).ok_or_else(|| unknown(format!("no {table}")))?;
        let mut lines = table.lines.clone();
        let first = lines.first_mut().filter(|line| line.system == System::Tool);
        let first =
            first.ok_or_else(|| unknown(format!("{} does not begin with a line t", table.name.name)))?;
        let place = place(self.cell, self.family, grip).ok_or_else(|| {
            unknown(format!("{} is not a tray, a vise or a pedestal", grip.place.name.name))
        })?;
        let (part, own) = self.family.part_of(name).ok_or_else(|| unknown("of no part".to_owned()))?;
        let [x, _, z] = first.values.map(|value| f64::from(value) / 100.0);
        let by = self.shift(place, part, own, [x, z]);
        for (value, by) in first.values.iter_mut().zip(by) {
            *value += hundredths(by);
        }
        Ok(lines)
    }

    /// Displacement of a grip, in tool axes, in.
    fn shift(&self, place: Place, part: usize, own: bool, [x, z]: [f64; 2]) -> [f64; 3] {
        let size = |parts: &[PartType]| parts.get(part).map_or([0.0; 3], |part| part.size);
        let (old, new) = (size(&self.family.parts), size(&self.parts));
        let (before, after) = (&self.before, &self.step.program);
        let deeper = self.tips[0] - self.tips[1];
        let higher = self.height[1] - self.height[0];
        let seat = |program: &ViseProgram, width: f64| width / 2.0 - program.depth;
        let aside = seat(after, new[1]) - seat(before, old[1]);
        match (place, own) {
            (Place::Tray, _) => [deeper, 0.0, higher - (new[2] - old[2]) / 2.0],
            (Place::Vise, true) => {
                // A part that would not be stable is released nearer to the back.
                let gap = (before.back - x - self.tips[0]).max(0.0);
                let nearer =
                    if self.behind > 0.0 { gap * (1.0 - self.step.behind / self.behind) } else { 0.0 };
                [after.back - before.back + deeper + nearer, aside, after.ledge - before.ledge + higher]
            }
            // A push keeps its height above the ledge, and its distance behind the front face.
            (Place::Vise, false) => {
                let up = z * after.ledge / before.ledge - z;
                [(after.back - new[0]) - (before.back - old[0]), aside, up]
            }
            (Place::Pedestal, _) => [(new[0] - old[0]) / 2.0 + deeper, 0.0, higher],
        }
    }

    /// The increase of a part's width, and its new width; `None` for a push.
    fn wider(&self, object: &Name16) -> Option<(f64, f64)> {
        let (part, _) = self.family.part_of(object).filter(|(_, own)| *own)?;
        let (old, new) = (self.family.parts.get(part)?, self.parts.get(part)?);
        Some((new.size[1] - old.size[1], new.size[1]))
    }

    /// An opening around a wider part, limited to the stroke.
    fn opened(&self, size: i32, wider: f64, width: f64, gripper: &Gripper) -> i32 {
        let [_, most] = gripper.opening;
        let wanted = (f64::from(size) / 100.0 + wider).max(width + ROOM);
        hundredths(wanted.min(most))
    }
}

impl Numbers for Sizes<'_> {
    fn parts(&self) -> &[PartType] {
        &self.parts
    }

    fn grips(&self, grip: &GripEntry) -> Result<Vec<(Typed, Vec<MovetableLine>)>, Error> {
        Ok(vec![(grip.place, self.moved(grip)?)])
    }

    fn openings(&self, object: &Name16, [appr, grasp, force, depart]: [i32; 4]) -> [i32; 4] {
        let Some((wider, new)) = self.wider(object) else { return [appr, grasp, force, depart] };
        let room = |size: i32| self.opened(size, wider, new, &self.cell.gripper.parts);
        [room(appr), grasp + hundredths(wider), force.max(whole(self.force.ceil())), room(depart)]
    }

    fn pedestal(&self, object: &Name16, values: [i32; 6]) -> [i32; 6] {
        let [appr, grasp, force, release, table, flip] = values;
        let Some((wider, new)) = self.wider(object) else { return values };
        let room = |size: i32| self.opened(size, wider, new, &self.cell.pedestal.hand);
        let force = force.max(whole(self.force.ceil()));
        [room(appr), grasp + hundredths(wider), force, room(release), table, flip]
    }

    fn range(&self, object: &Name16, range: i32) -> i32 {
        let at = self.family.part_of(object).map(|(part, _)| part);
        let height = |parts: &[PartType]| at.and_then(|at| parts.get(at)).map_or(0.0, |part| part.size[0]);
        let nearer = (height(&self.parts) - height(&self.family.parts)) * MM;
        range - whole(nearer)
    }

    /// Add a program of the vise, and a new step if there is one.
    fn places(&self, change: &mut Change) -> Result<Places, Error> {
        let program = &self.step.program;
        let last = self.cell.vise.program.last().map_or("", |program| program.name.as_str());
        change.add_table(CELL, "vise.program", &format!("name = \"{last}\""), &table_of_program(program))?;
        let step = if self.step.is_new { "a step cut for it" } else { "an existing step" };
        let [back, depth, ledge] = [program.back, program.depth, program.ledge].map(Length);
        let place = format!("back {back}, depth {depth:.4}, ledge {ledge}");
        let [open, partial] = [program.opening_open, program.opening_partial].map(Length);
        let openings = format!("opens {open}, partially {partial}");
        Ok(Places {
            chosen: vec![("vise", format!("{step}: {place}")), ("vise", openings)],
            to_teach: vec![format!("vise: program {}, as above", program.name)],
            others: self.step.is_new,
        })
    }
}

/// Rules that the like part's own numbers follow.
struct Rules<'a> {
    cell: &'a CellDescription,
    family: &'a Family,
    before: &'a ViseProgram,
}

struct LikePart {
    behind: f64,          // distance before the back where the blank is released, in
    height: f64,          // height of the tool point above the lower end of a seated part, in
    in_hand: Option<f64>, // length of the lower end in the pedestal's hand, in
}

impl Rules<'_> {
    /// Reads the like part's numbers, and the height of the fingertips above the floor, in.
    fn read(&self) -> Result<(LikePart, f64), String> {
        let last = self.family.parts.len().saturating_sub(1);
        let tips = -self.offset(Place::Tray, |part| part == 0).ok_or("no grip takes it from a tray")?[0];
        let brought = self.offset(Place::Vise, |part| part == 0).ok_or("no grip brings it into the vise")?;
        let seated = self.offset(Place::Vise, |part| part == last).ok_or("no grip takes it from the vise")?;
        let height = seated[2] - self.before.ledge;
        let in_hand = self.offset(Place::Pedestal, |_| true).map(|at| height - at[2]);
        Ok((LikePart { behind: self.before.back - brought[0] - tips, height, in_hand }, tips))
    }

    /// The offset of the first grip of a part at a kind of place, in.
    fn offset(&self, at: Place, of: impl Fn(usize) -> bool) -> Option<[f64; 3]> {
        let mut grips = self.family.grips().filter(|grip| place(self.cell, self.family, grip) == Some(at));
        let own = |grip: &&GripEntry| {
            self.family.part_of(&grip.object.name).is_some_and(|(part, own)| own && of(part))
        };
        let table: &MovetableEntry = self.family.movetable(grips.find(own)?.movetable.name.as_str())?;
        let first = table.lines.first().filter(|line| line.system == System::Tool)?;
        Some(first.values.map(|value| f64::from(value) / 100.0))
    }
}

/// Kind of a grip's place. A grip that is valid at any place belongs to the place of its movetable.
fn place(cell: &CellDescription, family: &Family, grip: &GripEntry) -> Option<Place> {
    let at = |place: &Typed| {
        let name = place.name.name;
        let named = |known: &str| name.as_str() == known;
        if named(&cell.vise.location) {
            Some(Place::Vise)
        } else if named(&cell.pedestal.location) {
            Some(Place::Pedestal)
        } else {
            cell.tray.iter().any(|tray| named(&tray.unit)).then_some(Place::Tray)
        }
    };
    if !matches!(grip.place.kind, RefType::Any | RefType::Array | RefType::Owner) {
        return at(&grip.place);
    }
    let same = |other: &&GripEntry| {
        let both = |one: &GripEntry| (one.object.name, one.grip, one.movetable.name);
        both(other) == both(grip) && matches!(other.place.kind, RefType::LocationPoint)
    };
    family.grips().find(same).map_or(Some(Place::Tray), |other| at(&other.place))
}

/// A part whose blank has another size: each side changes by as much as that of the blank, the weight with the volume.
pub fn resized(part: &PartType, blank: &PartType, size: [f64; 3], name: &str) -> PartType {
    let mut new = part.clone();
    name.clone_into(&mut new.name);
    for (side, (was, to)) in new.size.iter_mut().zip(blank.size.into_iter().zip(size)) {
        *side = ((*side + to - was) * 1000.0).round() / 1000.0;
    }
    let volume = |size: [f64; 3]| size.into_iter().product::<f64>();
    new.weight = (part.weight * volume(new.size) / volume(part.size) * 100.0).round().max(1.0) / 100.0;
    new
}

/// Inches in units of 0.01 in.
pub fn hundredths(inches: f64) -> i32 {
    whole(inches * 100.0)
}

/// The nearest whole number; sizes are limited far below the range of `i32`.
fn whole(number: f64) -> i32 {
    number.round() as i32
}

fn table_of_program(program: &ViseProgram) -> String {
    let ViseProgram { name, back, depth, ledge, opening_open, opening_partial } = program;
    format!(
        "[[vise.program]]\nname = \"{name}\"\nback = {back:?}\ndepth = {depth:?}\nledge = {ledge:?}\n\
         opening_open = {opening_open:?}\nopening_partial = {opening_partial:?}\n"
    )
}
