//! A run with one picture and one view of its cell, as a source without a terminal.

use executive::memory::cell::CellView;
use interfaces::{CommonMemory, ExternalInputs, ProcessId};
use programs::rcs_console::{
    picture::Picture,
    source::{About, Cell, Source, State},
    story::Story,
};
use rcs_core::tick::Tick;

pub struct Stage {
    pub picture: Picture,
    pub view: Option<CellView>, // the simulated cell; `None` with a robot at a port
    pub story: Story,
    pub state: State,
}

impl Stage {
    /// Tick 100 of a run without a command, in which all processes were executed.
    pub fn new() -> Self {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        let picture = Picture { tick: Tick(99), external, memory, timing: None };
        let view = Some(CellView::default());
        let mut stage = Self { picture, view, story: Story::new(99), state: State::Runs };
        stage.pass(1);
        stage
    }

    pub fn pass(&mut self, ticks: u64) {
        self.picture.tick = Tick(self.picture.tick.0 + ticks);
        for process in ProcessId::ALL {
            self.picture.memory.header_mut(*process).stamp = self.picture.tick;
        }
    }

    pub fn view(&mut self) -> &mut CellView {
        self.view.as_mut().expect("the cell is simulated")
    }
}

impl Source for Stage {
    fn about(&self) -> About<'_> {
        About { name: "demo", state: self.state, result: None, damage: None }
    }

    fn refresh(&mut self) {}

    fn range(&self) -> Option<(u64, u64)> {
        Some((1, self.picture.tick.0))
    }

    fn picture(&self, _: u64) -> Option<Picture> {
        Some(self.picture.clone())
    }

    fn story(&self) -> &Story {
        &self.story
    }

    fn cell(&self, _: u64) -> Cell {
        self.view.map_or(Cell::NotPublished, |view| Cell::Shown(Box::new(view)))
    }
}
