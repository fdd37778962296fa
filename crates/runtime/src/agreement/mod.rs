//! Checks that task data, job and cell description describe the same cell.
//!
//! Each was already checked alone. This module finds names that only one of them has, which would stop a run late. The
//! modules `sizes`, `places` and `job` compare numbers.

mod alike;
mod both;
mod job;
pub mod places;
mod sizes;

use std::{collections::BTreeSet, path::Path};

use diagnostics::{At, Diagnostic, Diagnostics, Problems, Severity, Source, nearest};
use plant::CellDescription;
use rcs_core::name::Name16;
use taskdata::{
    files::TaskData,
    load::{
        Job, Step, Store, Workstation,
        job::{JobLine, Reload},
    },
};

use closed_loop::workstation::orders;

/// The names in the `**` lines of a job that the cell lacks. `source` is the text of the description, `path` its file.
pub fn of_job(job: &Job, source: &Source, cell: &CellDescription, store: &Store, path: &Path) -> Diagnostics {
    let mut problems = Problems::default();
    let mut state = job::State::new(cell, store.view());
    let mut loaded = store;
    for line in &job.steps {
        if let Step::Workstation(Workstation::Load { number })
        | Step::After { action: Workstation::Load { number }, .. } = &line.step
        {
            if let Some(reload) = job.reload(*number) {
                load(job.source(), line, reload, loaded, (source, cell), &mut problems);
                (loaded, state.data) = (&reload.store, reload.store.view());
            }
            continue;
        }
        let (Step::Workstation(action) | Step::After { action, .. }) = &line.step else {
            if let Step::Command(command) = &line.step
                && !line.expects_error
                && let Some(job::Refused { word, message, help }) = state.command(command)
            {
                problems.error_help("job.cell", place(job.source(), line, Some(&word)), message, help);
            }
            continue;
        };
        let orders = orders(action, cell);
        let occupied = orders.iter().flatten().find_map(|order| job::occupied(order, cell));
        let admitted = orders.and_then(|orders| orders.iter().try_for_each(|o| cell.admits(o)));
        let other = state.action(action, matches!(line.step, Step::After { .. }) || admitted.is_err());
        let Err(error) = admitted else {
            if let Some(message) = occupied.or(other) {
                problems.error("job.cell", place(job.source(), line, None), message);
                problems.help(format!("what the cell has is in {}", path.display()));
            }
            continue;
        };
        let suspects = error.suspects();
        let word = suspects.as_ref().map(|(word, _)| word.as_str());
        problems.error("job.cell", place(job.source(), line, word), error.to_string());
        match suspects {
            Some((_, Some(near))) => problems.nearest("one", near),
            _ => problems.help(format!("what the cell has is in {}", path.display())),
        }
    }
    Diagnostics::of_file(problems, job.source())
}

/// Check blocks that a line loads against the cell. With `expect error` they must not fit.
fn load(
    job: &Source,
    line: &JobLine,
    reload: &Reload,
    before: &Store,
    (source, cell): (&Source, &CellDescription),
    problems: &mut Problems,
) {
    let of = |store: &Store| of_cell(source.clone(), cell, store);
    let known = of(before);
    let known: BTreeSet<&str> = known.diagnostics().iter().map(Diagnostic::message).collect();
    let at = place(job, line, Some(&reload.source.name));
    let found = of(&reload.store);
    let new = || found.diagnostics().iter().filter(|one| !known.contains(one.message()));
    if line.expects_error {
        if new().all(|one| one.severity() != Severity::Error) {
            let message = "the blocks fit the cell, and the line ends with `expect error`";
            problems.error("job.load", at, message);
        }
        return;
    }
    for one in new() {
        let message = format!("{}: {}", one.place(), one.message());
        problems.push(one.severity(), "job.load", at, message, one.help().map(str::to_owned));
    }
}

/// Position of a word of an action, or of its line if the line does not contain the word.
fn place(source: &Source, line: &JobLine, word: Option<&str>) -> At {
    let index = usize::try_from(line.line).unwrap_or(1).saturating_sub(1);
    let begin: usize = source.text.split_inclusive('\n').take(index).map(str::len).sum();
    let text = source.text.get(begin..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    // The first words are `**`, or `**`, `after` and a number.
    let first = if matches!(line.step, Step::After { .. }) { 3 } else { 1 };
    let words = text.split_whitespace().map(|found| (found, found.as_ptr().addr() - text.as_ptr().addr()));
    let found = words.skip(first).find(|(found, _)| Some(*found) == word);
    let (start, length) = found.map_or((0, text.len()), |(found, start)| (start, found.len()));
    let short = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    At { source: 0, start: short(begin + start), length: short(length) }
}

/// The names in a cell description that the task data lack: errors for locations, warnings for names that no job needs.
pub fn of_cell(source: Source, cell: &CellDescription, store: &Store) -> Diagnostics {
    let mut names = Names { source: &source, data: store.view(), problems: Problems::default() };
    names.locations(cell);
    names.sectors(cell);
    names.objects(cell);
    let problems = names.problems;
    let report = Diagnostics::of_file(problems, &source);
    if report.has_errors() {
        return report;
    }
    let mut both = both::Both::new(&source, cell, store);
    places::check(&mut both);
    sizes::check(&mut both);
    alike::check(&mut both);
    report.with(both.report())
}

struct Names<'a> {
    source: &'a Source,
    data: TaskData<'a>,
    problems: Problems,
}

impl Names<'_> {
    fn at(&self, entry: &str) -> At {
        CellDescription::place(self.source, entry)
    }

    fn warn(&mut self, entry: &str, message: String) {
        let at = self.at(entry);
        self.problems.warning("cell.data", at, format!("{entry}: {message}"), None);
    }

    fn locations(&mut self, cell: &CellDescription) {
        let devices = [
            ("vise.location", &cell.vise.location),
            ("pedestal.location", &cell.pedestal.location),
            ("drum.location", &cell.drum.location),
        ];
        let devices = devices.map(|(entry, name)| (entry.to_owned(), name));
        let trays = cell.tray.iter().enumerate().map(|(i, tray)| (format!("tray[{i}].unit"), &tray.unit));
        let nests =
            cell.nest.iter().enumerate().map(|(i, nest)| (format!("nest[{i}].location"), &nest.location));
        for (entry, name) in devices.into_iter().chain(trays).chain(nests) {
            if !self.has_location(name) {
                let expected = "a location of the task data";
                let message = format!("{entry}: expected {expected}, found {name}");
                let at = self.at(&entry);
                self.problems.error("cell.data", at, message);
                self.problems.expected(expected);
                self.near_location(name);
            }
        }
    }

    fn has_location(&self, name: &str) -> bool {
        let data = &self.data;
        Name16::new(name).is_ok_and(|name| {
            data.locpt_named(&name).is_some()
                || data.owner_named(&name).is_some()
                || data.array_named(&name).is_some()
        })
    }

    fn near_location(&mut self, name: &str) {
        let points = self.data.locpts.iter().map(|point| point.name.to_string());
        let known: Vec<String> =
            points.chain(self.data.owners.iter().map(|owner| owner.name.to_string())).collect();
        if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
            self.problems.nearest("one", near);
        }
    }

    /// Check that a command can send parts to each nest, and that the sectors of each tray are those of the task data.
    fn sectors(&mut self, cell: &CellDescription) {
        for (number, nest) in cell.nest.iter().enumerate() {
            if !self.has_location(&nest.location) {
                continue;
            }
            let parts = nest.parts.iter().map(String::as_str);
            let entry = format!("nest[{number}].{}", if nest.sector == 0 { "location" } else { "sector" });
            for message in self.unresolved(&nest.location, nest.sector, parts) {
                self.warn(&entry, message);
            }
        }
        for (number, tray) in cell.tray.iter().enumerate() {
            let loose = cell.part.iter().filter(|part| !cell.nest.iter().any(|nest| nest.takes(part)));
            // Parts that the task data never place on this tray are skipped.
            let here = |part: &&str| self.resolves(&tray.unit, 1, part);
            let parts: Vec<&str> = loose.map(|part| part.name.as_str()).filter(here).collect();
            let last = u16::try_from(tray.sectors.len()).unwrap_or(u16::MAX);
            let entry = format!("tray[{number}].sectors");
            for message in self.unresolved(&tray.unit, last, parts.iter().copied()) {
                self.warn(&entry, message);
            }
            let more = last.saturating_add(1);
            if parts.iter().any(|part| self.resolves(&tray.unit, more, part)) {
                self.warn(
                    &entry,
                    format!("{} has a sector {more} in the task data, {last} found", tray.unit),
                );
            }
        }
    }

    fn resolves(&self, location: &str, sector: u16, part: &str) -> bool {
        self.unresolved(location, sector, [part].into_iter()).is_empty()
    }

    /// The reasons why known objects have no location in a sector of the task data, each reason once.
    fn unresolved<'p>(
        &self,
        location: &str,
        sector: u16,
        parts: impl Iterator<Item = &'p str>,
    ) -> BTreeSet<String> {
        let Ok(location) = Name16::new(location) else { return BTreeSet::new() };
        let objects = parts.filter_map(|part| Name16::new(part).ok());
        let known = objects.filter(|object| self.data.object_named(object).is_some());
        let sector = (sector != 0).then(|| i32::from(sector));
        known
            .filter_map(|object| self.data.resolve_location(&location, sector, Some(&object)).err())
            .map(|error| error.to_string())
            .collect()
    }

    /// Check that each part is an object of the task data with the same number for the camera.
    fn objects(&mut self, cell: &CellDescription) {
        for (number, part) in cell.part.iter().enumerate() {
            let object = Name16::new(&part.name).ok().and_then(|name| self.data.object_named(&name));
            let Some(object) = object else {
                self.warn(
                    &format!("part[{number}].name"),
                    format!("the task data have no object {}", part.name),
                );
                let known: Vec<String> =
                    self.data.objects.iter().map(|object| object.name.to_string()).collect();
                if let Some(near) = nearest(&part.name, known.iter().map(String::as_str)) {
                    self.problems.nearest("one", near);
                }
                continue;
            };
            let asked = self.data.visions.iter().filter(|view| view.object == object).map(|view| view.id);
            let others: BTreeSet<i32> = asked.filter(|id| *id != i32::from(part.vision_id)).collect();
            for id in others {
                let message = format!("the task data ask the camera for {id}, found {}", part.vision_id);
                let entry = format!("part[{number}].vision_id");
                let at = self.at(&entry);
                self.problems.error("cell.data", at, format!("{entry}: {message}"));
                self.problems.help(
                    "the camera does not recognise the part: one of the two numbers is wrong".to_owned(),
                );
            }
        }
    }
}
