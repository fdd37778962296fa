//! Compares the traces of two versions by tick and field. A file of [`Renames`] lists intended changes: other paths,
//! other texts of values, fields of only one version. Other deviations are differences. Rows of decision tables are
//! not compared: for review, a [`RowMap`] shows which row fired instead of an old one.

mod read;
mod renames;
mod rows;

use std::{
    collections::{BTreeSet, HashMap},
    fmt,
    io::{self, BufRead},
};

use self::{read::Lines, renames::Rule, rows::learn};
pub use self::{
    read::Moment,
    renames::{NewText, Only, Renamed, Renames},
    rows::{Pair, Pairs, Row, RowMap, Seen},
};
use crate::trace::{FIRED, TICKS};

const WRITTEN: usize = 12; // printed per scenario; others are counted

#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    #[error(transparent)]
    Toml(#[from] toml::de::Error),
    #[error("at most as many stars as in old = {old:?} were expected, found new = {new:?}")]
    Stars { old: String, new: String },
    #[error("the {0} trace: {1}")]
    Unreadable(&'static str, io::Error),
    #[error("the {which} trace, line {line}: tick, path and value in order were expected, found {found:?}")]
    Line {
        which: &'static str, // old or new
        line: usize,         // from 1
        found: String,
    },
    #[error("the {0} trace ends without saying how the run ended: make it again")]
    NoEnd(&'static str),
    #[error("{first} and {second} of the old version both become {new}")]
    Twice { first: String, second: String, new: String },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    pub first: Moment,       // first
    pub path: String,        // in the new version
    pub was: Option<String>, // in the old version; `None` without such a field
    pub is: Option<String>,  // in the new version
    pub ticks: u64,          // in which it differs
}

#[derive(Clone, Debug, Default)]
pub struct Comparison {
    pub differences: Vec<Difference>, // by their first difference
    pub rows: Pairs,                  // for the old ones, up to the first difference
    pub ticks: (u64, u64),            // of the old and the new run
    used: BTreeSet<Rule>,
}

/// Fails with [`CompareError`] if a trace is incomplete, or two old fields become one.
pub fn compare(was: impl BufRead, is: impl BufRead, renames: &Renames) -> Result<Comparison, CompareError> {
    let (mut was, mut is) = (Lines::new("old", was)?, Lines::new("new", is)?);
    let mut comparer = Comparer::new(renames);
    while let Some(mut moment) = was.moment().min(is.moment()) {
        // The ticks of only one run cannot be compared.
        let last = was.last_tick().into_iter().chain(is.last_tick()).min();
        if last.is_some_and(|last| moment > Moment::Tick(last)) {
            moment = Moment::End;
            was.skip_to_end()?;
            is.skip_to_end()?;
        }
        comparer.begin(moment);
        while let Some((path, value)) = was.take(moment)? {
            comparer.was(&path, value)?;
        }
        while let Some((path, value)) = is.take(moment)? {
            comparer.is(&path, value);
        }
        comparer.settle(moment);
    }
    Ok(comparer.finish())
}

struct Slot {
    path: String,
    old_path: Option<String>,
    was: Option<String>,
    is: Option<String>,
    values: Vec<usize>,
    kind: Kind,
    touched: bool, // it got a value in this tick
}

enum Kind {
    Compared {
        /// Position among the differences, and first tick of the present one.
        difference: Option<usize>,
        since: Option<u64>,
    },
    Row(Option<(Pair, u64)>), // the present pair and its first tick
    Added,                    // in the new version only
}

impl Kind {
    const COMPARED: Self = Self::Compared { difference: None, since: None };
}

struct Comparer<'a> {
    renames: &'a Renames,
    slots: Vec<Slot>,
    old: HashMap<String, Option<usize>>, // by old path; `None`: dropped
    new: HashMap<String, usize>,         // by new path
    touched: Vec<usize>,
    tick: u64,
    diverged: Option<u64>, // first tick with a difference: rows are collected up to it
    found: Comparison,
}

impl<'a> Comparer<'a> {
    fn new(renames: &'a Renames) -> Self {
        Self {
            renames,
            slots: Vec::new(),
            old: HashMap::new(),
            new: HashMap::new(),
            touched: Vec::new(),
            tick: 0,
            diverged: None,
            found: Comparison::default(),
        }
    }

    fn begin(&mut self, moment: Moment) {
        if let Moment::Tick(tick) = moment {
            self.tick = tick;
        }
    }

    fn was(&mut self, path: &str, value: String) -> Result<(), CompareError> {
        let slot = match self.old.get(path) {
            Some(slot) => *slot,
            None => self.old_slot(path)?,
        };
        if let Some(slot) = slot {
            self.touch(slot).was = Some(value);
        }
        Ok(())
    }

    fn is(&mut self, path: &str, value: String) {
        let slot = self.new_slot(path);
        self.touch(slot).is = Some(value);
    }

    fn touch(&mut self, at: usize) -> &mut Slot {
        let slot = &mut self.slots[at];
        if !std::mem::replace(&mut slot.touched, true) {
            self.touched.push(at);
        }
        slot
    }

    fn old_slot(&mut self, path: &str) -> Result<Option<usize>, CompareError> {
        let new = self.renames.new_path(path, &mut self.found.used);
        let slot = new.map(|new| self.new_slot(&new));
        if let Some(at) = slot {
            let slot = &mut self.slots[at];
            if let Some(first) = slot.old_path.replace(path.to_owned()) {
                let (second, new) = (path.to_owned(), slot.path.clone());
                return Err(CompareError::Twice { first, second, new });
            }
        }
        self.old.insert(path.to_owned(), slot);
        Ok(slot)
    }

    fn new_slot(&mut self, path: &str) -> usize {
        if let Some(slot) = self.new.get(path) {
            return *slot;
        }
        let values = self.renames.values_of(path);
        let kind = match path.ends_with(FIRED) {
            _ if self.renames.is_added(path, &mut self.found.used) => Kind::Added,
            true => Kind::Row(None),
            false => Kind::COMPARED,
        };
        let path = path.to_owned();
        self.new.insert(path.clone(), self.slots.len());
        let slot = Slot { path, old_path: None, was: None, is: None, values, kind, touched: false };
        self.slots.push(slot);
        self.slots.len() - 1
    }

    fn settle(&mut self, moment: Moment) {
        let mut touched = std::mem::take(&mut self.touched);
        // Differences are handled first, because they end the collection of rows.
        touched.sort_by_key(|at| (matches!(self.slots[*at].kind, Kind::Row(_)), *at));
        for at in touched.drain(..) {
            let slot = &mut self.slots[at];
            slot.touched = false;
            match (&slot.kind, &slot.was, &slot.is) {
                (Kind::Row(_), Some(_), Some(_)) => {}
                // These are a process of only one version, or a field that was not declared as added.
                (Kind::Row(_), ..) | (Kind::Added, Some(_), _) => slot.kind = Kind::COMPARED,
                _ => {}
            }
            match slot.kind {
                Kind::Compared { .. } => self.compare_field(at, moment),
                Kind::Row(_) => self.change_row(at),
                Kind::Added => {}
            }
        }
        self.touched = touched;
    }

    fn compare_field(&mut self, at: usize, moment: Moment) {
        let slot = &mut self.slots[at];
        let Kind::Compared { difference, since } = &mut slot.kind else { return };
        let (was, is) = (slot.was.as_deref(), slot.is.as_deref());
        let equal = self.renames.agree(was, is, &slot.values, &mut self.found.used);
        match (equal, *since) {
            (true, Some(first)) => {
                *since = None;
                let known = difference.and_then(|at| self.found.differences.get_mut(at));
                known.into_iter().for_each(|known| known.ticks += self.tick - first);
            }
            (false, None) => {
                if moment != Moment::End {
                    *since = Some(self.tick);
                    self.diverged.get_or_insert(self.tick);
                }
                difference.get_or_insert_with(|| {
                    self.found.differences.push(Difference {
                        first: moment,
                        path: slot.path.clone(),
                        was: slot.was.clone(),
                        is: slot.is.clone(),
                        ticks: 0,
                    });
                    self.found.differences.len() - 1
                });
            }
            (true, None) | (false, Some(_)) => {}
        }
    }

    fn change_row(&mut self, at: usize) {
        let slot = &mut self.slots[at];
        let (Kind::Row(firing), Some(was), Some(is)) = (&mut slot.kind, &slot.was, &slot.is) else { return };
        let process = slot.path.trim_end_matches(FIRED).to_owned();
        let pair = Pair { process, old: Row::new(was), new: Row::new(is) };
        if firing.as_ref().is_none_or(|(before, _)| *before != pair) {
            let until = self.diverged.unwrap_or(self.tick);
            if let Some((pair, since)) = firing.replace((pair, self.tick)) {
                learn(&mut self.found.rows, pair, since, until);
            }
        }
    }

    fn finish(mut self) -> Comparison {
        let ticks = self.new.get(TICKS).and_then(|at| self.slots.get(*at));
        let number = |text: Option<&String>| text.and_then(|text| text.parse().ok()).unwrap_or(self.tick);
        let ticks = ticks.map(|slot| (number(slot.was.as_ref()), number(slot.is.as_ref())));
        self.found.ticks = ticks.unwrap_or((self.tick, self.tick));
        let end = self.found.ticks.0.min(self.found.ticks.1) + 1;
        for slot in self.slots {
            match slot.kind {
                Kind::Compared { difference: Some(at), since: Some(since) } => {
                    self.found.differences[at].ticks += end.saturating_sub(since);
                }
                Kind::Row(Some((pair, since))) => {
                    learn(&mut self.found.rows, pair, since, self.diverged.unwrap_or(end));
                }
                _ => {}
            }
        }
        self.found
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |value: &Option<String>| {
            value.as_ref().map_or("no such field".to_owned(), |value| format!("{value:?}"))
        };
        // The last entry, the end of the run, is always printed.
        let (ends, ticks): (Vec<_>, Vec<_>) = self.differences.iter().partition(|d| d.first == Moment::End);
        let (written, more) = ticks.split_at(WRITTEN.min(ticks.len()));
        for Difference { first, path, was, is, ticks } in written.iter().chain(&ends) {
            write!(f, "  {first:<11}  {path}: was {}, is {}", text(was), text(is))?;
            match ticks {
                0 | 1 => writeln!(f)?,
                _ => writeln!(f, "; differs in {ticks} ticks")?,
            }
        }
        if !more.is_empty() {
            let ticks: u64 = more.iter().map(|difference| difference.ticks).sum();
            writeln!(f, "  and {} fields more, in {ticks} ticks together", more.len())?;
        }
        Ok(())
    }
}
