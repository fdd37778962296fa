//! `rcs-run new tray`: a tray with the sectors, views and approaches of an existing tray.

use std::path::Path;

use diagnostics::{JOBS, alternatives};
use geometry::units::Length;
use os_io::files;
use plant::{CellDescription, description::Tray};
use runtime::setup::CELL;
use taskdata::load::{
    Store,
    entries::{Entry, PoseEntry, Typed},
};

use super::{
    change::Change,
    entered::Entered,
    forms::Blocks,
    place::{New, clipped, is_name, with_blocks},
};
use crate::rcs_run::error::Error;

pub struct Made {
    pub change: Change,
    /// The changes, and a job of the like tray in which the new tray replaces it.
    pub trial: Change,
    pub job: String,
}

/// Make the data of a tray whose centre is at a point, in.
pub fn make(
    name: &str,
    centre: [f64; 2],
    like: &str,
    (store, cell, data): (&Store, &CellDescription, &Path),
) -> Result<Made, Error> {
    is_name(name, store)?;
    let tray = cell.tray(like).ok_or_else(|| unknown(like, cell))?;
    stands_alone(centre, cell)?;
    let [dx, dy] = [0, 1].map(|axis| centre[axis] - tray.centre[axis]);
    let entered = Entered::of(store);
    let point = entered.all().find_map(|entry| match entry {
        Entry::Locpt(point) if point.name.name.as_str() == like => Some(point),
        _ => None,
    });
    let point = point.ok_or_else(|| Error::New(format!("the task data have no location point {like}")))?;
    let pose = entered.all().find_map(|entry| match entry {
        Entry::Pose(pose) if pose.name.name == point.pose.name => Some(pose),
        _ => None,
    });
    let pose = pose.ok_or_else(|| Error::New(format!("{like} has no pose {}", point.pose.name)))?;
    let block =
        entered.block_of(|entry| matches!(entry, Entry::Locpt(one) if one.name.name == point.name.name));
    let directory = block.and_then(|block| entered.directory(block));
    let (directory, number) =
        directory.ok_or_else(|| Error::New(format!("no directory block loads the location point {like}")))?;

    let new = New { name: clipped(name), like };
    let mut blocks = Blocks::new(name, format!("{like} and the centre of the tray"), number.offset);
    blocks.group("pose of the corner, square to the tray", &[corner(&new, pose, [dx, dy])]);
    blocks.group("location point", &[new.point(&point.movetable)]);
    blocks.group("what the tray has", &owners(&new, &entered));
    let placed: Vec<Entry> = entered.all().filter_map(|entry| at_the_tray(&new, entry)).collect();
    let kind = |wanted: fn(&Entry) -> bool| placed.iter().filter(|e| wanted(e)).cloned().collect::<Vec<_>>();
    blocks.group("grips", &kind(|entry| matches!(entry, Entry::Grip(_))));
    blocks.group("views", &kind(|entry| matches!(entry, Entry::View(_))));
    let mut ways = new.ways(&entered);
    ways.extend(kind(|entry| matches!(entry, Entry::ApprDept(_))));
    blocks.group("approaches, departs, trajectories", &ways);

    let mut change = with_blocks(name, &blocks, &entered, (directory, number), data)?;
    for (block, owner) in entered.owners_of(like).filter(|(_, owner)| *owner != like) {
        let file = entered.file(block).unwrap_or(directory);
        change.add_member(file, owner, name)?;
    }
    let last = cell.tray.last().map_or(like, |tray| tray.unit.as_str());
    change.add_table(CELL, "tray", &format!("unit = \"{last}\""), &table(name, tray, [dx, dy]))?;
    let (job, text) = job(like, name, cell, data)?;
    let mut trial = change.clone();
    trial.add(&format!("jobs/{job}.job"), text)?;
    Ok(Made { change, trial, job })
}

fn unknown(like: &str, cell: &CellDescription) -> Error {
    let known = cell.tray.iter().map(|tray| tray.unit.as_str());
    Error::New(format!("no tray is named {like}: {}", alternatives(like, known, "the cell has")))
}

fn stands_alone([x, y]: [f64; 2], cell: &CellDescription) -> Result<(), Error> {
    let side = cell.tray_shape.inside + 2.0 * cell.tray_shape.wall;
    let other = cell.tray.iter().find(|other| {
        let [ox, oy] = other.centre;
        (x - ox).abs() < side && (y - oy).abs() < side
    });
    other.map_or(Ok(()), |other| {
        let unit = &other.unit;
        Err(Error::New(format!(
            "the tray would overlap {unit}: {} are expected between them, in x or y",
            Length(side)
        )))
    })
}

fn corner(new: &New<'_>, pose: &PoseEntry, [dx, dy]: [f64; 2]) -> Entry {
    let hundredths = |inches: f64| (inches * 100.0).round() as i32;
    let (dx, dy) = (hundredths(dx), hundredths(dy));
    let points = pose.points.map(|[x, y, z]| [x.saturating_add(dx), y.saturating_add(dy), z]);
    Entry::Pose(PoseEntry { points, name: new.pose_name(), ..pose.clone() })
}

fn owners(new: &New<'_>, entered: &Entered) -> Vec<Entry> {
    let own = entered.all().filter_map(|entry| match entry {
        Entry::Owner(owner) if owner.name.name.as_str() == new.like => Some(owner.clone()),
        _ => None,
    });
    let renamed = own.map(|mut owner| {
        owner.name = new.name;
        owner.members.iter_mut().for_each(|member| new.rename(member));
        Entry::Owner(owner)
    });
    renamed.collect()
}

/// An entry about the like tray, changed for the new one; `None` if it is about another place.
fn at_the_tray(new: &New<'_>, entry: &Entry) -> Option<Entry> {
    let moved = |place: &Typed| {
        let mut place = *place;
        let is_it = new.is_like(&place);
        new.rename(&mut place);
        is_it.then_some(place)
    };
    let mut entry = entry.clone();
    match &mut entry {
        Entry::Grip(grip) => grip.place = moved(&grip.place)?,
        Entry::View(view) => view.place = moved(&view.place)?,
        Entry::ApprDept(way) => way.place = Some(moved(way.place.as_ref()?)?),
        _ => return None,
    }
    Some(entry)
}

fn table(name: &str, like: &Tray, [dx, dy]: [f64; 2]) -> String {
    let thousandth = |inches: f64| (inches * 1000.0).round() / 1000.0;
    let moved = |[x, y]: [f64; 2]| format!("[{:?}, {:?}]", thousandth(x + dx), thousandth(y + dy));
    let sectors: Vec<String> = like.sectors.iter().map(|at| moved(*at)).collect();
    format!(
        "[[tray]]\nunit = \"{name}\"\ncentre = {}\nfloor = {:?}\nsectors = [{}]\n",
        moved(like.centre),
        like.floor,
        sectors.join(", ")
    )
}

/// The shortest job that takes loose parts only from the like tray, changed for the new one: its name and text.
fn job(like: &str, name: &str, cell: &CellDescription, data: &Path) -> Result<(String, String), Error> {
    let loose =
        |part: &str| cell.part(part).is_some_and(|part| !cell.nest.iter().any(|nest| nest.takes(part)));
    let from_it = |line: &&str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        matches!(words.as_slice(), ["**", "tray", unit, _, part, ..] if *unit == like && loose(part))
    };
    let is_tray = |line: &&str| line.starts_with("** tray");
    let texts = JOBS.all(data).into_iter().filter_map(|path| files::read_text(&path).ok());
    let mut fit: Vec<String> = texts
        .filter(|text| {
            let mut trays = text.lines().filter(is_tray).peekable();
            trays.peek().is_some() && trays.all(|line| from_it(&line))
        })
        .collect();
    fit.sort_by_key(String::len);
    let text = fit.first().ok_or_else(|| Error::New(format!("no job tries {like}: it brings no part")))?;
    let word = |word: &str| if word == like { name.to_owned() } else { word.to_owned() };
    let line = |line: &str| line.split_whitespace().map(word).collect::<Vec<_>>().join(" ") + "\n";
    Ok((format!("trial-{}", name.to_lowercase()), text.lines().map(line).collect()))
}
