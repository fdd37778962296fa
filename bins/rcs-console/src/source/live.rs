//! A run in progress as a source: its buffers in shared memory, and their last pictures.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use executive::memory::{
    Attached, OnTimeout, ReadError, RunName, SET_UP_LIMIT, SharedMemoryError, cell::CellView,
    field::FieldView, within_limit,
};

use super::{About, Cell, Source, State, seen};
use crate::rcs_console::{
    picture::{Picture, Timing},
    story::Story,
};

const KEPT: usize = 250; // number of pictures kept: ten seconds, without missed ones
const STORY: usize = 4096;
/// Number of attempts to read a consistent picture. In a fast run the next tick may begin during one.
const ATTEMPTS: usize = 10;
const SILENCE: Duration = Duration::from_secs(1); // time without a new tick after which a run is silent

pub struct Live {
    run: Attached,
    pictures: VecDeque<Picture>,
    cells: VecDeque<CellView>,
    fields: VecDeque<FieldView>,
    story: Story,
    state: State,
    news: Instant,
}

impl Live {
    /// Attach to a run. Fails if the run does not exist, was built from other sources, or cannot be read.
    pub fn open(name: &RunName, on_stuck: Option<OnTimeout>) -> Result<Self, SharedMemoryError> {
        let run = within_limit(SET_UP_LIMIT, on_stuck, || Attached::open(name))?;
        let mut live = Self {
            run,
            pictures: VecDeque::new(),
            cells: VecDeque::new(),
            fields: VecDeque::new(),
            story: Story::new(STORY),
            state: State::Runs,
            news: Instant::now(),
        };
        live.refresh();
        Ok(live)
    }

    /// True for the last picture of the run. `None` if the next tick began during every attempt, or before the first.
    fn read(&self) -> Result<Option<(Picture, bool)>, ReadError> {
        for _ in 0..ATTEMPTS {
            let pulse = self.run.pulse()?;
            let external = self.run.external()?;
            let memory = self.run.memory()?;
            let after = self.run.pulse()?;
            if pulse.tick == after.tick {
                let timing = Timing {
                    controller_ns: pulse.controller_ns,
                    skipped: pulse.skipped,
                    allocations: Some(pulse.allocations),
                };
                let picture = Picture { tick: pulse.tick, external, memory, timing: Some(timing) };
                return Ok(Some((picture, after.over)));
            }
        }
        Ok(None)
    }

    fn take(&mut self, picture: Picture) {
        let before = self.pictures.back().unwrap_or(&picture);
        self.story.note(before, &picture);
        self.story.remark(before, &picture);
        if self.pictures.len() == KEPT {
            self.pictures.pop_front();
        }
        self.pictures.push_back(picture);
        // The cell is published after the tick. If it cannot be read now, it is read with the next tick.
        if let Ok(Some(cell)) = self.run.cell() {
            self.story.tell(seen::lines(self.cells.back(), &cell));
            if self.cells.len() == KEPT {
                self.cells.pop_front();
            }
            self.cells.push_back(cell);
        }
        if let Ok(Some(field)) = self.run.field() {
            if self.fields.len() == KEPT {
                self.fields.pop_front();
            }
            self.fields.push_back(field);
        }
        self.news = Instant::now();
    }
}

impl Source for Live {
    fn about(&self) -> About<'_> {
        About { name: self.run.name().as_str(), state: self.state, result: None, damage: None }
    }

    fn refresh(&mut self) {
        if self.state == State::Over {
            return;
        }
        let last = self.pictures.back().map_or(0, |picture| picture.tick.0);
        let silent = self.news.elapsed();
        self.state = match self.read() {
            Ok(Some((picture, over))) => {
                if picture.tick.0 > last {
                    self.take(picture);
                }
                match over {
                    true => State::Over,
                    false if silent > SILENCE && self.news.elapsed() > SILENCE => {
                        State::Silent(silent.as_secs())
                    }
                    false => State::Runs,
                }
            }
            Ok(None) | Err(_) => State::Torn,
        };
    }

    fn range(&self) -> Option<(u64, u64)> {
        Some((self.pictures.front()?.tick.0, self.pictures.back()?.tick.0))
    }

    fn picture(&self, tick: u64) -> Option<Picture> {
        let end = self.pictures.partition_point(|picture| picture.tick.0 <= tick);
        self.pictures.get(end.checked_sub(1)?).cloned()
    }

    fn story(&self) -> &Story {
        &self.story
    }

    fn cell(&self, tick: u64) -> Cell {
        let end = self.cells.partition_point(|cell| cell.tick.0 <= tick);
        let shown = end.checked_sub(1).and_then(|at| self.cells.get(at));
        shown.map_or(Cell::NotPublished, |cell| Cell::Shown(Box::new(*cell)))
    }

    fn field(&self, picture: &Picture) -> Option<Box<FieldView>> {
        let end = self.fields.partition_point(|field| field.tick <= picture.tick);
        self.fields.get(end.checked_sub(1)?).map(|field| Box::new(*field))
    }
}
