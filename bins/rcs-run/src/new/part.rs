//! `rcs-run new part`: forms, movetables, entries of the cell and a job for a part that is like another one.

use std::{fmt, path::Path, str::FromStr};

use plant::{
    CellDescription,
    description::{PartType, Shape, ViseProgram},
};
use rcs_core::name::{Name, Name16};
use runtime::setup::CELL;
use taskdata::load::{
    Store,
    entries::{Entry, GripEntry, MovetableEntry, Named},
};

use super::{change::Change, family::Family, forms::Blocks, sizes::Sizes};
use crate::error::Error;

/// Longest name: `S-` and `_BH` go around it, and an object has 16 characters.
const LONGEST: usize = 11;
/// Characters of the name with which its movetables begin.
const BEGINS: usize = 6;
/// Greatest side of a part, in.
const GREATEST: f64 = 20.0;

/// Length, width and height of a blank as it lies, in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub length: f64,
    pub width: f64,
    pub height: f64,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let sides: Option<Vec<f64>> = text.split('x').map(|side| side.trim().parse().ok()).collect();
        match sides.as_deref() {
            Some([length, width, height])
                if [length, width, height].into_iter().all(|side| (0.1..=GREATEST).contains(side)) =>
            {
                Ok(Self { length: *length, width: *width, height: *height })
            }
            _ => Err(format!(
                "length x width x height of the blank as it lies was expected, 0.1 to {GREATEST} in each, such as \
                 3x1.5x1; found {text}"
            )),
        }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {} x {}", self.length, self.width, self.height)
    }
}

/// What a new part changes, and what it leaves to people.
pub struct Made {
    pub change: Change,
    /// The job that moves it.
    pub job: String,
    /// The vise gets a new step: jobs of other parts are tried, too.
    pub jaws: bool,
    /// What was chosen, line by line.
    pub chosen: Vec<String>,
    /// What has to be taught at the machine.
    pub to_teach: Vec<String>,
}

/// Make the data of a part.
///
/// # Errors
/// [`Error::New`] with the reason if there cannot be such a part.
pub fn make(
    name: &str,
    size: Size,
    like: &str,
    (store, cell, data): (&Store, &CellDescription, &Path),
) -> Result<Made, Error> {
    let family = Family::of(like, store, cell, data)?;
    is_name(name, &family, store, cell)?;
    if let Some(part) = family.parts.iter().find(|part| part.shape != Shape::Box || part.tool) {
        let what = "only boxes have sizes that a grip follows; copy its forms, and its nests in cell.toml";
        return Err(Error::New(format!("{} is no box: {what}", part.name)));
    }
    let sizes = Sizes::new(cell, &family, name, [size.height, size.width, size.length])?;
    let (directory, area) = family.directory()?;
    let new = New { name, family: &family, sizes: &sizes, store, area: area.offset };
    let id = new.vision_id(cell);
    let (text, first, tables) = new.forms(id)?;
    let file = name.to_lowercase();
    let mut change = Change::of(data);
    change.add(&format!("objects/{file}.blk"), text)?;
    let title: String = file.chars().take(16).collect();
    change.add_to_block(directory, area.number, &format!("  {first:03} load ( {title:<16} )"))?;
    let last = family.parts.last().map_or("", |part| part.name.as_str());
    let described: Vec<String> = sizes.parts.iter().map(|part| table_of_part(part, id)).collect();
    change.add_table(CELL, "part", &format!("name = \"{last}\""), &described.join("\n"))?;
    let program = &sizes.step.program;
    let programs = cell.vise.program.last().map_or("", |program| program.name.as_str());
    change.add_table(CELL, "vise.program", &format!("name = \"{programs}\""), &table_of_program(program))?;
    change.add(&format!("jobs/{file}.job"), new.job())?;
    let step = if sizes.step.is_new { "a step that is cut for it" } else { "a step that is there" };
    let openings = format!("opens {} in, partially {} in", program.opening_open, program.opening_partial);
    let place = format!("back {}, depth {:.4}, ledge {}", program.back, program.depth, program.ledge);
    let mut to_teach = vec![format!("vise: program {name}, as above")];
    if id != 0 {
        let blank = sizes.parts.first().map_or("", |part| part.name.as_str());
        to_teach.push(format!("vision: {blank} as object {id}"));
    }
    to_teach.push(format!("robot: {} by joystick, at the first part", tables.join(", ")));
    Ok(Made {
        change,
        job: file,
        jaws: sizes.step.is_new,
        chosen: vec![format!("{step}: {place}"), openings],
        to_teach,
    })
}

/// Whether a name can be given.
fn is_name(name: &str, family: &Family, store: &Store, cell: &CellDescription) -> Result<(), Error> {
    let fits = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit();
    if name.is_empty() || name.len() > LONGEST || !name.chars().all(fits) {
        let expected = format!("1 to {LONGEST} capital letters and digits were expected");
        return Err(Error::New(format!("a part is not named {name}: {expected}")));
    }
    let data = store.view();
    let objects: Vec<String> = data.objects.iter().map(|object| object.name.to_string()).collect();
    let there = |name: &String| objects.contains(name) || cell.part(name).is_some();
    let all = family.parts.iter().map(|part| family.renamed(&part.name, name)).chain([name.to_owned()]);
    if let Some(known) = all.into_iter().find(there) {
        let free = (2..).map(|number| format!("{name}{number}")).find(|name| !there(name));
        let free = free.unwrap_or_default();
        return Err(Error::New(format!("{known} is there already: choose another name, such as {free}")));
    }
    if cell.vise.program.iter().any(|program| program.name == name) {
        return Err(Error::New(format!("a program of the vise is named {name}: choose another name")));
    }
    Ok(())
}

/// A new family.
struct New<'a> {
    name: &'a str,
    family: &'a Family,
    sizes: &'a Sizes<'a>,
    store: &'a Store,
    area: u32,
}

impl New<'_> {
    /// A number of the camera that nothing has; 0 if the camera does not look for the like part.
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
                    e.values = self.sizes.openings(&e.name.name, e.values);
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
                    e.values = self.sizes.pedestal(&e.object.name, e.values);
                    e.object = self.object(&e.object);
                    pedestal.push(Entry::PedPara(e));
                }
                Entry::View(mut e) => {
                    e.range = self.sizes.range(&e.object.name, e.range);
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
                "the area {} has no {} blocks in a row that are free",
                self.area,
                blocks.count()
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
            let lines = self.sizes.moved(grip)?;
            let name = match tables.iter().find(|table| table.lines == lines) {
                Some(table) => table.name,
                None => {
                    let name = Name::clipped(&free.next().unwrap_or_default());
                    let name = Named { name, ..grip.movetable };
                    tables.push(MovetableEntry { lines, name });
                    name
                }
            };
            grips.push(GripEntry { object: self.object(&grip.object), movetable: name, ..grip.clone() });
        }
        Ok((tables, grips))
    }

    /// The job of the like part with other names, and without its comments, which are about the like part.
    fn job(&self) -> String {
        let mut text = format!("% {}, made like {} by rcs-run new part.\n\n", self.name, self.family.stem);
        let mut opened = false;
        let old = self.family.program.as_ref().map_or("", |program| program.name.as_str());
        for line in self.family.job.text.lines().filter(|line| line.starts_with(['*', '='])) {
            let word = |word: &str| match Name16::new(word) {
                Ok(name) if self.family.part_of(&name).is_some() => self.family.renamed(word, self.name),
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

/// A part in the cell description.
fn table_of_part(part: &PartType, id: u16) -> String {
    let [x, y, z] = part.size;
    let mut text = format!(
        "[[part]]\nname = \"{}\"\nsize = [{x:?}, {y:?}, {z:?}]\nweight = {:?}\n",
        part.name, part.weight
    );
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

/// A program of the vise in the cell description.
fn table_of_program(program: &ViseProgram) -> String {
    let ViseProgram { name, back, depth, ledge, opening_open, opening_partial } = program;
    format!(
        "[[vise.program]]\nname = \"{name}\"\nback = {back:?}\ndepth = {depth:?}\nledge = {ledge:?}\n\
         opening_open = {opening_open:?}\nopening_partial = {opening_partial:?}\n"
    )
}
