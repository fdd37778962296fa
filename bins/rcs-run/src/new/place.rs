//! `rcs-run new place`: a pose, a location point, and trajectories and approaches, derived from an existing place.

use std::path::Path;

use diagnostics::{At, BlockNumber, alternatives};
use geometry::{frame::Frame, pose::Pose};
use rcs_core::name::{Name, Name10};
use taskdata::{
    files::RefType,
    load::{
        Store,
        entries::{Entry, Named, PointAt, PoseEntry, Typed},
    },
};

use super::{change::Change, entered::Entered, forms::Blocks};
use crate::rcs_run::error::Error;

const LONGEST: usize = 8; // longest name: `-P` is added to it in a name of 10 characters
const BEGINS: usize = 6; // number of the name's characters with which its trajectories begin

pub fn make(name: &str, frame: &Frame, like: &str, store: &Store, data: &Path) -> Result<Change, Error> {
    let entered = Entered::of(store);
    is_name(name, store)?;
    let locpt = |entry: &Entry| matches!(entry, Entry::Locpt(point) if point.name.name.as_str() == like);
    let block = entered.block_of(locpt).ok_or_else(|| unknown(like, store))?;
    let (directory, number) = entered
        .directory(block)
        .ok_or_else(|| Error::New(format!("no directory block loads the location point {like}")))?;
    let new = New { name: clipped(name), like };
    let ways = new.ways(&entered);
    let mut blocks = Blocks::new(name, format!("{like} and the pose"), number.offset);
    blocks.group("pose", &[new.pose(frame)]);
    blocks.group("location point", &[new.point(&clipped("..."))]);
    blocks.group("trajectories, approach and depart", &ways);
    with_blocks(name, &blocks, &entered, (directory, number), data)
}

/// Add a file with the blocks of a place, and its load command to the directory block that loads the like place.
pub fn with_blocks(
    name: &str,
    blocks: &Blocks,
    entered: &Entered,
    (directory, number): (&str, BlockNumber),
    data: &Path,
) -> Result<Change, Error> {
    let first = entered.free_blocks(number.offset, blocks.count());
    let first = first.ok_or_else(|| Error::New(format!("the area {} has no free blocks", number.offset)))?;
    let file = name.to_lowercase();
    let mut change = Change::of(data);
    change.add(&format!("places/{file}.blk"), blocks.text(first))?;
    change.add_to_block(directory, number.number, &format!("  {first:03} load ( {file:<16} )"))?;
    Ok(change)
}

pub fn is_name(name: &str, store: &Store) -> Result<(), Error> {
    let fits = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    if name.is_empty() || name.len() > LONGEST || !name.chars().all(fits) {
        let expected = format!("1 to {LONGEST} capital letters, digits and _ were expected");
        return Err(Error::New(format!("a place is not named {name}: {expected}")));
    }
    let data = store.view();
    let there = |name: &str| {
        data.locpts.iter().any(|point| point.name.as_str() == name)
            || data.owners.iter().any(|owner| owner.name.as_str() == name)
            || data.arrays.iter().any(|array| array.name.as_str() == name)
            || data.poses.iter().any(|pose| pose.name.as_str() == format!("{name}-P"))
    };
    if there(name) {
        let free = (2..).map(|number| format!("{name}{number}")).find(|name| !there(name));
        let free = free.unwrap_or_default();
        return Err(Error::New(format!("{name} already exists: choose another name, such as {free}")));
    }
    Ok(())
}

fn unknown(like: &str, store: &Store) -> Error {
    let known: Vec<String> = store.view().locpts.iter().map(|point| point.name.to_string()).collect();
    let others = alternatives(like, known.iter().map(String::as_str), "there are");
    Error::New(format!("no location point is named {like}: {others}"))
}

/// A name of a form that was not read from a file.
pub fn clipped(name: &str) -> Named<10> {
    Named { name: Name10::clipped(name), at: At::default() }
}

pub struct New<'a> {
    pub name: Named<10>,
    pub like: &'a str,
}

impl New<'_> {
    pub fn is_like(&self, end: &Typed) -> bool {
        end.kind == RefType::LocationPoint && end.name.name.as_str() == self.like
    }

    pub fn rename(&self, end: &mut Typed) {
        if self.is_like(end) {
            end.name.name = Name::clipped(self.name.name.as_str());
        }
    }

    pub fn pose_name(&self) -> Named<10> {
        clipped(&format!("{}-P", self.name.name))
    }

    fn pose(&self, frame: &Frame) -> Entry {
        let Pose { wrist, tool, finger } = Pose::from_frame(frame);
        let points = [wrist, tool, finger];
        Entry::Pose(PoseEntry {
            points,
            at: At::default(),
            movetable: clipped("..."),
            name: self.pose_name(),
        })
    }

    pub fn point(&self, movetable: &Named<10>) -> Entry {
        Entry::Locpt(PointAt { name: self.name, pose: self.pose_name(), movetable: *movetable })
    }

    /// The trajectories from and to the place, and its approaches and departures.
    pub fn ways(&self, entered: &Entered) -> Vec<Entry> {
        let begins: String = self.name.name.as_str().chars().take(BEGINS).collect();
        let mut numbers = 1..;
        let renamed = entered.all().filter_map(|entry| match entry.clone() {
            Entry::Traj(mut way) if self.is_like(&way.start) || self.is_like(&way.end) => {
                way.name.name = Name::clipped(&format!("{begins}-T{}", numbers.next()?));
                self.rename(&mut way.start);
                self.rename(&mut way.end);
                Some(Entry::Traj(way))
            }
            Entry::ApprDept(mut way) if way.place.is_none() && self.is_like(&way.subject) => {
                self.rename(&mut way.subject);
                Some(Entry::ApprDept(way))
            }
            _ => None,
        });
        renamed.collect()
    }
}
