//! A log as a source, with access to every tick.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use executive::memory::field::FieldView;
use field::Mapping;
use rcs_core::tick::Tick;
use record::{
    Attachment, Log, ReadError,
    tables::{self, Origin},
    views::{Changes, Commander, Controller, Couplers, JobState, Part, Parts},
};
use runtime::{
    field::{of_log, view_of_log},
    result::FailureResult,
};
use taskdata::load::Source as Blocks;

use super::{About, Cell, RecordedCell, Source, State, deltas::Deltas};
use crate::rcs_console::{error::ConsoleError, picture::Picture, story::Story};

const INCHES: f64 = 1.0 / 0.0254; // metres to inches
/// The screens have only the tables of this program.
const OTHER_TABLES: &str =
    "the log has other decision tables than this program, which it shows: use `rcs-log why LOG`";
const PART: &str = "part_"; // prefix of the names of links that are parts

type Places = Vec<(u64, [f64; 3])>; // positions of a link, each with its first tick, in

pub struct Recorded {
    path: PathBuf,
    name: String,
    deltas: Deltas,
    story: Story,
    places: BTreeMap<String, Places>, // positions of the links of parts, by their names
    parts: Changes<Parts>,
    job: Changes<JobState>,
    commander: Changes<Commander>,
    controller: Changes<Controller>,
    couplers: Changes<Couplers>,
    mapping: Option<Mapping>, // of the couplers
    result: Option<String>,
    clearance: Option<String>,
    contacts: Option<String>,
    damage: Option<String>,
    blocks: Vec<Blocks>,
    cell_text: Option<String>,
}

impl Recorded {
    /// Skips damaged parts ([`About::damage`]). Fails if the log is of another program, or has no tick.
    pub fn open(path: &Path) -> Result<Self, ConsoleError> {
        let failed = |source: ReadError| ConsoleError::Log { path: path.to_owned(), source };
        let log = Log::open(path).map_err(failed)?;
        log.check_layout().map_err(failed)?;
        let (mut deltas, mut story) = (Deltas::new(), Story::new(usize::MAX));
        let mut damage = log.damage();
        let mut before: Option<Picture> = None;
        for logged in log.ticks() {
            let damaged = |tick| format!("tick {tick} is damaged; the rest is missing");
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
        if tables::of_log(&log).1 == Origin::Log {
            damage.get_or_insert_with(|| OTHER_TABLES.to_owned());
        }
        story.tell(log.lines());
        if let Some(failed) = FailureResult::of_log(&log) {
            story.end(failed.map(|failed| failed.account));
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
            places: places(&log),
            parts: Changes::of(&log),
            job: Changes::of(&log),
            commander: Changes::of(&log),
            controller: Changes::of(&log),
            couplers: Changes::of(&log),
            mapping: of_log(&log),
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

fn places(log: &Log) -> BTreeMap<String, Places> {
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

    fn field(&self, picture: &Picture) -> Option<Box<FieldView>> {
        let (mapping, couplers) = (self.mapping.as_ref()?, self.couplers.at(picture.tick)?);
        Some(Box::new(view_of_log(picture.tick, mapping, couplers, &picture.external.devices)))
    }

    fn cell_text(&self) -> Option<&str> {
        self.cell_text.as_deref()
    }

    fn blocks(&self) -> Option<&[Blocks]> {
        Some(&self.blocks)
    }

    fn cell(&self, tick: u64) -> Cell {
        let known = self.parts.at(Tick(tick));
        let at = |(frame, places): (&String, &Places)| {
            let end = places.partition_point(|(from, _)| *from <= tick);
            let (_, place) = places.get(end.checked_sub(1)?)?;
            let part = known.and_then(|known| known.parts.iter().find(|part| part.frame == *frame));
            let unknown = || Part { name: frame.clone(), ..Part::default() };
            // A part that has not been delivered yet is at the origin of the world.
            (*place != [0.0; 3]).then(|| (part.cloned().unwrap_or_else(unknown), *place))
        };
        Cell::Recorded(Box::new(RecordedCell {
            job: self.job.at(Tick(tick)).cloned(),
            commander: self.commander.at(Tick(tick)).cloned(),
            controller: self.controller.at(Tick(tick)).cloned(),
            parts: self.places.iter().filter_map(at).collect(),
            clearance: self.clearance.clone(),
            contacts: self.contacts.clone(),
        }))
    }
}
