//! The parts from which a new part is derived: the blank, the machined parts, and the virtual objects of hold and seat.

use std::path::Path;

use diagnostics::{JOBS, alternatives};
use plant::{
    CellDescription,
    description::{PartType, ViseProgram},
};
use rcs_core::name::Name16;
use taskdata::load::{
    BlockNumber, Job, Source, Step, Store, Workstation,
    entries::{Entry, GripEntry, MovetableEntry},
};

use super::entered::Entered;
use crate::rcs_run::error::Error;

pub struct Family {
    /// The parts from the blank to the finished part, in the order of the job.
    pub parts: Vec<PartType>,
    pub stem: String,
    /// For a tool: the other tools of the job.
    pub others: Vec<String>,
    pub job: Source,
    /// The program of the vise in the job, if the vise holds one of the parts.
    pub program: Option<ViseProgram>,
    pub entered: Entered,
}

impl Family {
    /// The family of a part: the parts in the job with the fewest parts that contains it. A tool has no other family
    /// members. The names need a common beginning.
    pub fn of(like: &str, store: &Store, cell: &CellDescription, data: &Path) -> Result<Self, Error> {
        let Some(part) = cell.part(like) else {
            let known = cell.part.iter().map(|part| part.name.as_str());
            let others = alternatives(like, known, "the cell has");
            return Err(Error::New(format!("no part is named {like}: {others}")));
        };
        let loaded = JOBS.all(data).into_iter().filter_map(|path| Some(Job::load(&path, store).ok()?.0));
        let with_parts = loaded.map(|job| (parts(&job, cell), job));
        let with_it = with_parts.filter(|(parts, _)| parts.iter().any(|part| part.name == like));
        let (all, job) = with_it
            .min_by_key(|(parts, _)| parts.len())
            .ok_or_else(|| Error::New(format!("no job moves {like}: a new part gets a job after another")))?;
        let others = all.iter().filter(|other| part.tool && other.tool && other.name != like);
        let others = others.map(|other| other.name.clone()).collect();
        let parts = if part.tool { vec![part.clone()] } else { all };
        let stem = if part.tool { Some(like.to_owned()) } else { stem(&parts) };
        let stem = stem.ok_or_else(|| {
            let names: Vec<_> = parts.iter().map(|part| part.name.as_str()).collect();
            let job = &job.name;
            Error::New(format!(
                "the job {job} has several parts, {}: name one that has a job",
                names.join(", ")
            ))
        })?;
        let program = program(&job, cell);
        Ok(Self { parts, stem, others, job: job.source().clone(), program, entered: Entered::of(store) })
    }

    /// Index of the part to which an object belongs, and false if the object is a hold or seat pose of that part.
    pub fn part_of(&self, object: &Name16) -> Option<(usize, bool)> {
        let at = |name: &str| self.parts.iter().position(|part| part.name == name);
        let name = object.as_str();
        let virtual_one = || name.split_once('-').and_then(|(_, part)| at(part)).map(|part| (part, false));
        at(name).map(|part| (part, true)).or_else(virtual_one)
    }

    /// The entries about the family's objects.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        let belongs = |entry: &Entry| subject(entry).is_some_and(|object| self.part_of(&object).is_some());
        self.entered.all().filter(move |entry| belongs(entry))
    }

    pub fn grips(&self) -> impl Iterator<Item = &GripEntry> {
        self.entries().filter_map(|entry| match entry {
            Entry::Grip(grip) => Some(grip),
            _ => None,
        })
    }

    pub fn movetable(&self, name: &str) -> Option<&MovetableEntry> {
        self.entered.all().find_map(|entry| match entry {
            Entry::Movetable(table) if table.name.name.as_str() == name => Some(table),
            _ => None,
        })
    }

    pub fn vision_ids(&self) -> impl Iterator<Item = i32> {
        self.entered.all().filter_map(|entry| match entry {
            Entry::View(view) => Some(view.id),
            _ => None,
        })
    }

    pub fn renamed(&self, name: &str, stem: &str) -> String {
        name.replacen(&self.stem, stem, 1)
    }

    /// The directory block that loads the family's forms: its file and number.
    pub fn directory(&self) -> Result<(&str, BlockNumber), Error> {
        let is_first = |entry: &Entry| match entry {
            Entry::Object(object) => self.part_of(&object.name.name).is_some_and(|(_, own)| own),
            _ => false,
        };
        let entered = &self.entered;
        let own = entered.block_of(is_first).and_then(|block| entered.directory(block));
        own.and_then(|(_, own)| entered.directory(own))
            .ok_or_else(|| Error::New(format!("no directory block leads to the forms of {}", self.stem)))
    }
}

/// The object that an entry describes.
pub fn subject(entry: &Entry) -> Option<Name16> {
    match entry {
        Entry::Object(e) => Some(e.name.name),
        Entry::ObjGrips(e) => Some(e.object.name),
        Entry::ObjLoc(e) => Some(e.object.name),
        Entry::PedPara(e) => Some(e.object.name),
        Entry::Grip(e) => Some(e.object.name),
        Entry::View(e) => Some(e.object.name),
        Entry::ApprDept(e) => Some(e.subject.name.name),
        _ => None,
    }
}

/// The parts that a job delivers, makes or moves, in order.
fn parts(job: &Job, cell: &CellDescription) -> Vec<PartType> {
    let mut names: Vec<Name16> = Vec::new();
    for line in &job.steps {
        let named = match &line.step {
            Step::Command(command) => vec![command.object],
            Step::Workstation(Workstation::Tray { object, .. }) => vec![Some(*object)],
            Step::Workstation(Workstation::Machine { blank, part, .. }) => vec![Some(*blank), Some(*part)],
            _ => Vec::new(),
        };
        names.extend(named.into_iter().flatten());
    }
    let mut parts: Vec<PartType> = Vec::new();
    for part in names.iter().filter_map(|name| cell.part(name.as_str())) {
        if !parts.iter().any(|known| known.name == part.name) {
            parts.push(part.clone());
        }
    }
    parts
}

fn program(job: &Job, cell: &CellDescription) -> Option<ViseProgram> {
    let used = job.steps.iter().filter_map(|line| match &line.step {
        Step::Workstation(Workstation::Vise { program, .. }) => Some(program.as_ref()),
        _ => None,
    });
    let used: Vec<_> = used.collect();
    let named = used.iter().flatten().next().copied();
    let of_name = |name: &Name16| cell.vise.program.iter().find(|one| one.name == name.as_str());
    let first = || (!used.is_empty()).then(|| cell.vise.program.first()).flatten();
    named.and_then(of_name).or_else(first).cloned()
}

/// The shortest name, if all other names begin with it.
fn stem(parts: &[PartType]) -> Option<String> {
    let shortest = parts.iter().min_by_key(|part| part.name.len())?.name.clone();
    let whole = shortest.split_once('_').map_or(shortest.as_str(), |(stem, _)| stem).to_owned();
    parts.iter().all(|part| part.name.starts_with(&whole)).then_some(whole)
}
