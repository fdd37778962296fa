//! A log as a source, with access to every tick.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use closed_loop::account::Account;
use record::{Attachment, Log, ReadError};
use taskdata::load::Source as Blocks;

use super::{About, Cell, Source, State, deltas::Deltas};
use crate::rcs_console::{error::ConsoleError, picture::Picture, story::Story};

/// Metres to inches.
const INCHES: f64 = 1.0 / 0.0254;
/// Prefix of the names of links that are parts.
const PART: &str = "part_";

/// Positions of a link, each with its first tick, in.
type Places = Vec<(u64, [f64; 3])>;

pub struct Recorded {
    path: PathBuf,
    name: String,
    deltas: Deltas,
    story: Story,
    parts: BTreeMap<String, Places>,
    result: Option<String>,
    clearance: Option<String>,
    contacts: Option<String>,
    damage: Option<String>,
    blocks: Vec<Blocks>,
    cell_text: Option<String>,
}

impl Recorded {
    /// Read a whole log.
    ///
    /// # Errors
    /// [`ConsoleError::Log`] if the file is not a log or was written by another program; [`ConsoleError::Empty`] if it
    /// has no tick. Damaged parts are skipped, and described in [`About::damage`].
    pub fn open(path: &Path) -> Result<Self, ConsoleError> {
        let failed = |source: ReadError| ConsoleError::Log { path: path.to_owned(), source };
        let log = Log::open(path).map_err(failed)?;
        log.check_layout().map_err(failed)?;
        let (mut deltas, mut story) = (Deltas::new(), Story::new(usize::MAX));
        let mut damage = log.damage();
        let mut before: Option<Picture> = None;
        for logged in log.ticks() {
            let damaged = |tick| format!("tick {tick} is damaged; what follows is missing");
            let logged = match logged {
                Ok(logged) => logged,
                Err(error) => {
                    damage.get_or_insert(error.to_string());
                    break;
                }
            };
            let tick = logged.tick;
            let Ok(picture) = deltas.push(logged) else {
                damage.get_or_insert(damaged(tick));
                break;
            };
            story.note(before.as_ref().unwrap_or(&picture), &picture);
            before = Some(picture);
        }
        story.tell(log.lines());
        if let Some(account) = log.end.as_ref().and_then(Account::of_facts) {
            story.end(account);
        }
        if deltas.range().is_none() {
            return Err(ConsoleError::Empty(path.to_owned()));
        }
        let fact = |key| log.end.as_ref().and_then(|end| end.get(key)).cloned();
        let [result, clearance, contacts] = ["result", "clearance", "contacts"].map(fact);
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok(Self {
            path: path.to_owned(),
            name,
            deltas,
            story,
            parts: parts(&log),
            result,
            clearance,
            contacts,
            damage,
            blocks: blocks(&log),
            cell_text: log
                .attachment(Attachment::CELL)
                .map(|cell| String::from_utf8_lossy(&cell.data).into_owned()),
        })
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// The blocks of the run; blocks loaded during the run come last.
fn blocks(log: &Log) -> Vec<Blocks> {
    let first = log.attachments.iter().filter_map(|attachment| {
        let name = attachment.name.strip_prefix(Attachment::TASK_DATA)?;
        Some(attachment.source(name))
    });
    let later = log.attachments.iter().filter_map(Attachment::as_reload).map(|(_, source)| source);
    first.chain(later).collect()
}

/// Positions of the parts, tick by tick.
fn parts(log: &Log) -> BTreeMap<String, Places> {
    let mut parts: BTreeMap<String, Places> = BTreeMap::new();
    for (tick, moved) in log.places() {
        for (link, place) in moved.into_iter().filter(|(link, _)| link.name.starts_with(PART)) {
            parts.entry(link.name).or_default().push((tick.0, place.position.map(|metres| metres * INCHES)));
        }
    }
    parts
}

impl Source for Recorded {
    fn about(&self) -> About<'_> {
        About {
            name: &self.name,
            state: State::Log,
            result: self.result.as_deref(),
            damage: self.damage.clone(),
        }
    }

    fn refresh(&mut self) {}

    fn range(&self) -> Option<(u64, u64)> {
        self.deltas.range()
    }

    fn picture(&self, tick: u64) -> Option<Picture> {
        self.deltas.picture(tick)
    }

    fn story(&self) -> &Story {
        &self.story
    }

    fn cell_text(&self) -> Option<&str> {
        self.cell_text.as_deref()
    }

    fn blocks(&self) -> Option<&[Blocks]> {
        Some(&self.blocks)
    }

    fn cell(&self, tick: u64) -> Cell {
        let at = |(name, places): (&String, &Places)| {
            let end = places.partition_point(|(from, _)| *from <= tick);
            let (_, place) = places.get(end.checked_sub(1)?)?;
            // A part that has not been delivered yet is at the origin of the world.
            (*place != [0.0; 3]).then(|| (name.clone(), *place))
        };
        Cell::Recorded {
            parts: self.parts.iter().filter_map(at).collect(),
            clearance: self.clearance.clone(),
            contacts: self.contacts.clone(),
        }
    }
}
