//! `rcs-run new part`: forms, movetables, cell description and a job for a part like an existing one.

use std::path::Path;

use os_io::text::amount;
use plant::{
    CellDescription,
    description::{PartType, Shape},
};
use rcs_core::name::{Name, Name16};
use runtime::setup::CELL;
use taskdata::load::{
    Store,
    entries::{Entry, GripEntry, MovetableEntry, Named},
};

use super::{
    change::Change,
    family::Family,
    forms::Blocks,
    nests::Nested,
    numbers::{Numbers, Places},
    size::Size,
    sizes::Sizes,
};
use crate::rcs_run::error::Error;

/// Longest name of a part: `S-` and `_BH` are added to it, and an object has 16 characters.
const LONGEST: usize = 11;
const BEGINS: usize = 6; // number of the name's characters with which its movetables begin

pub struct Order<'a> {
    pub name: &'a str,
    pub like: &'a str,
    pub tool: bool,
    /// Size of the blank; `None` for the size of the like part.
    pub size: Option<Size>,
    /// Weight of the blank, lb; `None` to compute it from the volume.
    pub weight: Option<f64>,
}

pub struct Made {
    pub change: Change,
    /// The changes, with additional jobs for the trial only.
    pub trial: Change,
    /// The job that moves the part, and the additional ones.
    pub jobs: Vec<String>,
    pub others: bool, // true if jobs of other parts are tried, too
    pub size: Size,
    /// The choices made: pairs of subject and text.
    pub chosen: Vec<(&'static str, String)>,
    /// The poses that must be taught at the machine.
    pub to_teach: Vec<String>,
}

pub fn make(
    order: &Order<'_>,
    (store, cell, data): (&Store, &CellDescription, &Path),
) -> Result<Made, Error> {
    let Order { name, like, tool, size, weight } = *order;
    let family = Family::of(like, store, cell, data)?;
    is_name(order, &family, store, cell)?;
    let old = family.parts.first().ok_or_else(|| Error::New(format!("{like} has no blank")))?;
    if old.tool != tool {
        let (what, command) = if old.tool { ("a", "tool") } else { ("no", "part") };
        return Err(Error::New(format!("{} is {what} tool: make it with rcs-run new {command}", old.name)));
    }
    let size = size.unwrap_or_else(|| Size::of(old));
    let blank = size.like(old).map_err(Error::New)?;
    let nested = cell.nest.iter().any(|nest| nest.takes(old));
    let numbers: &dyn Numbers = match old.shape {
        _ if nested => &Nested::new((store, cell), &family, name, (blank, weight))?,
        Shape::Box => &Sizes::new(cell, &family, name, blank)?,
        Shape::CylinderX | Shape::CylinderZ => {
            let what =
                "a cylinder without a nest has no forms to follow: give the nests of cell.toml its name";
            return Err(Error::New(format!("{}: {what}", old.name)));
        }
    };
    let (directory, area) = family.directory()?;
    let new = New { name, family: &family, numbers, store, area: area.offset };
    let id = new.vision_id(cell);
    let (text, first, tables) = new.forms(id)?;
    let file = name.to_lowercase();
    let mut change = Change::of(data);
    change.add(&format!("objects/{file}.blk"), text)?;
    let title: String = file.chars().take(16).collect();
    change.add_to_block(directory, area.number, &format!("  {first:03} load ( {title:<16} )"))?;
    let last = family.parts.last().map_or("", |part| part.name.as_str());
    let described: Vec<String> = numbers.parts().iter().map(|part| table_of_part(part, id)).collect();
    change.add_table(CELL, "part", &format!("name = \"{last}\""), &described.join("\n"))?;
    let Places { chosen, mut to_teach, others } = numbers.places(&mut change)?;
    change.add(&format!("jobs/{file}.job"), new.job(&family.stem))?;
    let mut trial = change.clone();
    let mut jobs = vec![file];
    for (number, other) in (1..).zip(&family.others) {
        let job = format!("trial-{number}");
        trial.add(&format!("jobs/{job}.job"), new.job(other))?;
        jobs.push(job);
    }
    if id != 0 {
        let blank = numbers.parts().first().map_or("", |part| part.name.as_str());
        to_teach.push(format!("vision: {blank} as object {id}"));
    }
    if !tables.is_empty() {
        to_teach.push(format!("robot: {} by joystick, at the first part", tables.join(", ")));
    }
    Ok(Made { change, trial, jobs, others, size, chosen, to_teach })
}

fn is_name(order: &Order<'_>, family: &Family, store: &Store, cell: &CellDescription) -> Result<(), Error> {
    let Order { name, tool, .. } = *order;
    let fits = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || (c == '-' && tool);
    if !name.starts_with(|c: char| c.is_ascii_uppercase()) || name.len() > LONGEST || !name.chars().all(fits)
    {
        let (what, expected) =
            if tool { ("tool", "letters, digits and -") } else { ("part", "letters and digits") };
        return Err(Error::New(format!(
            "a {what} is not named {name}: 1 to {LONGEST} capital {expected} were expected, a letter first"
        )));
    }
    let data = store.view();
    let objects: Vec<String> = data.objects.iter().map(|object| object.name.to_string()).collect();
    let there = |name: &String| objects.contains(name) || cell.part(name).is_some();
    let all = family.parts.iter().map(|part| family.renamed(&part.name, name)).chain([name.to_owned()]);
    if let Some(known) = all.into_iter().find(there) {
        let free = (2..).map(|number| format!("{name}{number}")).find(|name| !there(name));
        let free = free.unwrap_or_default();
        return Err(Error::New(format!("{known} already exists: choose another name, such as {free}")));
    }
    if cell.vise.program.iter().any(|program| program.name == name) {
        return Err(Error::New(format!("a program of the vise is named {name}: choose another name")));
    }
    Ok(())
}

struct New<'a> {
    name: &'a str,
    family: &'a Family,
    numbers: &'a dyn Numbers,
    store: &'a Store,
    area: u32,
}

impl New<'_> {
    /// A free number of the camera; 0 if the camera does not look for the like part.
    fn vision_id(&self, cell: &CellDescription) -> u16 {
        let looks = self.family.entries().any(|entry| matches!(entry, Entry::View(_)));
        let of_parts = cell.part.iter().map(|part| i32::from(part.vision_id));
        let highest = of_parts.chain(self.family.vision_ids()).max().unwrap_or(0);
        if looks { u16::try_from(highest + 1).unwrap_or(u16::MAX) } else { 0 }
    }

    fn object(&self, object: &Named<16>) -> Named<16> {
        let renamed = self.family.renamed(object.name.as_str(), self.name);
        Named { name: Name::clipped(&renamed), ..*object }
    }

    /// The forms, the number of their directory block, and the names of their movetables.
    fn forms(&self, id: u16) -> Result<(String, u32, Vec<String>), Error> {
        let (tables, grips) = self.grips()?;
        let names: Vec<String> = tables.iter().map(|table| table.name.name.to_string()).collect();
        let mut all: [Vec<Entry>; 6] = Default::default();
        let [objects, show, places, pedestal, views, ways] = &mut all;
        for entry in self.family.entries() {
            match entry.clone() {
                Entry::Object(mut e) => {
                    e.values = self.numbers.openings(&e.name.name, e.values);
                    e.name = self.object(&e.name);
                    objects.push(Entry::Object(e));
                }
                Entry::ObjGrips(mut e) => {
                    e.object = self.object(&e.object);
                    show.push(Entry::ObjGrips(e));
                }
                Entry::ObjLoc(mut e) => {
                    e.object = self.object(&e.object);
                    places.push(Entry::ObjLoc(e));
                }
                Entry::PedPara(mut e) => {
                    e.values = self.numbers.pedestal(&e.object.name, e.values);
                    e.object = self.object(&e.object);
                    pedestal.push(Entry::PedPara(e));
                }
                Entry::View(mut e) => {
                    e.range = self.numbers.range(&e.object.name, e.range);
                    e.id = i32::from(id);
                    e.object = self.object(&e.object);
                    views.push(Entry::View(e));
                }
                Entry::ApprDept(mut e) => {
                    e.subject.name = self.object(&e.subject.name);
                    ways.push(Entry::ApprDept(e));
                }
                _ => {}
            }
        }
        let [objects, show, places, pedestal, views, ways] = all;
        let from = format!("{} and the size of the blank", self.family.stem);
        let mut blocks = Blocks::new(self.name, from, self.area);
        blocks.group("objects: grip, approach, grasp, force, depart", &objects);
        blocks.group("gripper and grip on the tray", &show);
        blocks.group("where it lies", &places);
        blocks.group("at the pedestal", &pedestal);
        blocks
            .group("movetables of the grips", &tables.into_iter().map(Entry::Movetable).collect::<Vec<_>>());
        blocks.group("grips", &grips.into_iter().map(Entry::Grip).collect::<Vec<_>>());
        blocks.group("views", &views);
        blocks.group("approaches and departs", &ways);
        let first = self.family.entered.free_blocks(self.area, blocks.count());
        let first = first.ok_or_else(|| {
            Error::New(format!(
                "the area {} does not have {} free in a row",
                self.area,
                amount(blocks.count(), "block")
            ))
        })?;
        Ok((blocks.text(first), first, names))
    }

    /// Movetables and grips. Grips with the same lines share a movetable.
    fn grips(&self) -> Result<(Vec<MovetableEntry>, Vec<GripEntry>), Error> {
        let data = self.store.view();
        let known: Vec<String> = data.movetables.iter().map(|table| table.name.to_string()).collect();
        let begins: String = self.name.chars().take(BEGINS).collect();
        let mut free = (1..).map(|number| format!("{begins}-{number}")).filter(|name| !known.contains(name));
        let (mut tables, mut grips): (Vec<MovetableEntry>, Vec<GripEntry>) = (Vec::new(), Vec::new());
        for grip in self.family.grips() {
            for (place, lines) in self.numbers.grips(grip)? {
                let name = match tables.iter().find(|table| table.lines == lines) {
                    _ if lines.is_empty() => grip.movetable,
                    Some(table) => table.name,
                    None => {
                        let name = Name::clipped(&free.next().unwrap_or_default());
                        let name = Named { name, ..grip.movetable };
                        tables.push(MovetableEntry { lines, name });
                        name
                    }
                };
                let object = self.object(&grip.object);
                grips.push(GripEntry { object, place, movetable: name, ..grip.clone() });
            }
        }
        Ok((tables, grips))
    }

    /// The job of the like part with the new names, without its comments.
    fn job(&self, like: &str) -> String {
        let mut text = format!("% {}, made like {} by rcs-run new.\n\n", self.name, self.family.stem);
        let mut opened = false;
        let old = self.family.program.as_ref().map_or("", |program| program.name.as_str());
        for line in self.family.job.text.lines().filter(|line| line.starts_with(['*', '='])) {
            let word = |word: &str| match Name16::new(word) {
                _ if word == like => self.name.to_owned(),
                Ok(name) if like == self.family.stem && self.family.part_of(&name).is_some() => {
                    self.family.renamed(word, self.name)
                }
                _ if line.starts_with("** vise") && word == old => String::new(),
                _ => word.to_owned(),
            };
            let mut new = line.split_whitespace().map(word).collect::<Vec<_>>().join(" ");
            if line.starts_with("** vise") && !opened {
                opened = true;
                new = format!("{} {}", new.trim_end(), self.name);
            }
            text += &format!("{}\n", new.trim_end());
        }
        text
    }
}

fn table_of_part(part: &PartType, id: u16) -> String {
    let [x, y, z] = part.size;
    let shape = match part.shape {
        Shape::Box => "",
        Shape::CylinderX => "shape = \"cylinder-x\"\n",
        Shape::CylinderZ => "shape = \"cylinder-z\"\n",
    };
    let mut text = format!(
        "[[part]]\nname = \"{}\"\n{shape}size = [{x:?}, {y:?}, {z:?}]\nweight = {:?}\n",
        part.name, part.weight
    );
    if part.tool {
        text += "tool = true\n";
    }
    if id != 0 && part.vision_id != 0 {
        text += &format!("vision_id = {id}\n");
    }
    if part.reflectance != 0.5 {
        text += &format!("reflectance = {:?}\n", part.reflectance);
    }
    if part.other_side {
        text += "other_side = true\n";
    }
    text
}
