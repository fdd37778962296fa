//! `rcs-run new`: derives data from existing data, tries them, shows a diff, and writes them on request.

mod arguments;
mod change;
mod entered;
mod family;
mod forms;
mod jaws;
mod nests;
mod numbers;
mod part;
mod place;
mod size;
mod sizes;
#[cfg(test)]
mod tests;
mod tray;
mod trial;

use std::{path::Path, process::ExitCode};

use os_io::text::amount;
use os_io::{console, shell};
use plant::CellDescription;
use runtime::{StartError, setup::CELL};
use taskdata::load::Store;

pub use arguments::NewArguments;

use self::{
    arguments::{NewItem, PartArguments, PlaceArguments, ToolArguments, TrayArguments},
    change::Change,
    part::Order,
    trial::Trial,
};
use crate::rcs_run::{arguments::CheckArguments, error::Error, pose, ways};

/// Make new data. After an [`Error`], which has the reason, no file was written.
pub fn new(arguments: &NewArguments) -> Result<ExitCode, Error> {
    match &arguments.what {
        NewItem::Part(arguments) => {
            let PartArguments { name, size, like, write, explain_job, data } = arguments;
            let order = Order { name, like, tool: false, size: Some(*size), weight: None };
            part(&order, (*write, *explain_job), data)
        }
        NewItem::Tool(arguments) => {
            let ToolArguments { name, size, weight, like, write, explain_job, data } = arguments;
            let order = Order { name, like, tool: true, size: *size, weight: *weight };
            part(&order, (*write, *explain_job), data)
        }
        NewItem::Place(arguments) => place(arguments),
        NewItem::Tray(arguments) => tray(arguments),
    }
}

/// Load the task data; if `write`, they must be changeable.
fn loaded(data: &Path, write: bool) -> Result<Store, Error> {
    if write {
        change::changeable(data)?;
    }
    let unusable =
        |report| StartError::Data { what: format!("the task data under {}", data.display()), report };
    Ok(Store::load(data).map_err(unusable)?.0)
}

fn cell(data: &Path) -> Result<CellDescription, Error> {
    let path = data.join(CELL);
    CellDescription::load(&path).map_err(|error| Error::New(format!("{}: {error}", path.display())))
}

/// `new part` and `new tool`.
fn part(order: &Order<'_>, (write, explain_job): (bool, bool), data: &Path) -> Result<ExitCode, Error> {
    let store = loaded(data, write)?;
    let cell = cell(data)?;
    let made = part::make(order, (&store, &cell, data))?;
    let Order { name, like, tool, .. } = *order;
    let trial = Trial::checked(&made.trial, name)?;
    let first = made.jobs.first().map_or(name, String::as_str);
    if explain_job {
        return ways::explain(&CheckArguments::of(trial.data()), first);
    }
    let runs = made.jobs.iter().map(|job| trial.run(job, made.others)).sum::<Result<usize, Error>>()?;
    let mut lines = vec![(if tool { "tool" } else { "part" }, format!("{name}, {}, like {like}", made.size))];
    lines.extend(made.chosen);
    lines.push(("tried", format!("check finds no errors; {} finished", amount(runs, "run"))));
    lines.extend(trial.warnings.into_iter().map(|line| ("warning", line)));
    lines.extend(made.to_teach.into_iter().map(|line| ("to teach", line)));
    let next = format!("rcs-run {first} --data {}", shell::path(data));
    finish(&made.change, lines, write.then_some(next))
}

fn place(arguments: &PlaceArguments) -> Result<ExitCode, Error> {
    let PlaceArguments { name, point, azimuth, tilt, roll, like, write, data } = arguments;
    let store = loaded(data, *write)?;
    let point = point.as_slice().try_into().map_err(|_| Error::New("X, Y and Z were expected".to_owned()))?;
    let frame = pose::standing(point, *azimuth, *tilt, *roll).map_err(Error::New)?;
    let change = place::make(name, &frame, like, &store, data)?;
    let trial = Trial::checked(&change, name)?;
    let mut lines = vec![("place", format!("{name}, reached like {like}"))];
    lines.push(("tried", "check finds no errors".to_owned()));
    lines.extend(trial.warnings.into_iter().map(|line| ("warning", line)));
    lines.push(("to teach", format!("robot: the pose {name}-P by joystick (rcs-run pose --write)")));
    let next =
        format!("rcs-run check --data {} --explain 'MOVE -- +0 -- 0 +0 {name} 0 -- 0'", shell::path(&**data));
    finish(&change, lines, write.then_some(next))
}

fn tray(arguments: &TrayArguments) -> Result<ExitCode, Error> {
    let TrayArguments { name, centre, like, write, data } = arguments;
    let store = loaded(data, *write)?;
    let cell = cell(data)?;
    let centre = centre.as_slice().try_into().map_err(|_| Error::New("X and Y were expected".to_owned()))?;
    let made = tray::make(name, centre, like, (&store, &cell, data))?;
    let trial = Trial::checked(&made.trial, name)?;
    let runs = trial.run(&made.job, false)?;
    let mut lines = vec![("tray", format!("{name}, like {like}"))];
    lines.push((
        "tried",
        format!("check finds no errors; {} with a part from it finished", amount(runs, "run")),
    ));
    lines.extend(trial.warnings.into_iter().map(|line| ("warning", line)));
    lines.push(("to teach", format!("robot: the pose {name}-P by joystick, square to the tray (VIII.3)")));
    lines.push(("to teach", "cell: what the tray stands on, as a [[fixture]] of cell.toml".to_owned()));
    let next = format!("a job with {name} in the place of {like}, with --data {}", data.display());
    finish(&made.change, lines, write.then_some(next))
}

/// Show the changes. Write them if `next` names a next command.
fn finish(change: &Change, lines: Vec<(&str, String)>, next: Option<String>) -> Result<ExitCode, Error> {
    let mut text = change.diff() + "\n";
    let mut before = "";
    for (word, line) in lines {
        text += &format!("{:<10} {line}\n", if word == before { "" } else { word });
        before = word;
    }
    text += &match next {
        Some(next) => {
            change.write()?;
            format!("written    try {next}\n")
        }
        None => "not written; --write writes the files\n".to_owned(),
    };
    console::answer(&text)?;
    Ok(ExitCode::SUCCESS)
}
