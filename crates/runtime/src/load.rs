//! LOAD during a run (IV.2.4): a block of the data directory, in its present version, becomes part of the task data
//! before the next command, after all boards have checked the whole data with it. The check runs in parallel to the
//! ticks; in fast clock the next tick waits for it. The log contains the text, for a replay.

pub mod error;

use std::{
    fs, thread,
    time::{Duration, Instant},
};

use closed_loop::generations;
use executive::{
    boards::{Board, Coordinator},
    memory::load_file,
};
use rcs_core::tick::{TICK_MS, Tick};
use taskdata::load::{BlockNumber, Source};

use crate::{
    Run,
    boards::Controller,
    loads::{Loaded, Loader, Order},
    operator::Input,
};

use self::error::LOAD_LIMIT;
pub use self::error::LoadError;

const BOARDS_LIMIT: u64 = LOAD_LIMIT.as_secs() * 1000 / TICK_MS; // the same time limit in ticks
/// Time between two checks of the boards, when the run waits for them.
const LOOK: Duration = Duration::from_millis(5);

pub enum LoadSource {
    Operator(Input),
    /// The workstation controller, with this line for the cell.
    Workstation(String),
}

pub type Answer = (LoadSource, Result<String, LoadError>);

#[derive(Default)]
pub struct Loads {
    /// Thread that reads and checks in parallel to the ticks; `None` in fast clock.
    loader: Option<Loader>,
    loading: Option<Loading>,
    last: u32, // number of the last load that was announced to boards in other processes
    /// Number of jobs that have replaced the rest of an earlier job.
    pub played: u32,
}

impl Loads {
    #[must_use]
    pub fn with(loader: Option<Loader>) -> Self {
        Self { loader, ..Self::default() }
    }

    /// True while a block is being checked.
    #[must_use]
    pub const fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Withdraw the load that an operator has requested. Its check then has no effect.
    pub fn withdraw(&mut self, who: &str) {
        if let Some(Loading { asker: LoadSource::Operator(input), is_withdrawn, .. }) = &mut self.loading {
            *is_withdrawn |= input.source() == who;
        }
    }
}

struct Loading {
    asker: LoadSource,
    number: BlockNumber,
    stage: Stage,
    is_withdrawn: bool,
}

enum Stage {
    Checking,
    Announced { loaded: Loaded, since: Tick },
}

impl Run {
    fn can_load(&self) -> Result<(), LoadError> {
        if self.loads.loading.is_some() {
            return Err(LoadError::Loading);
        }
        if generations::is_busy(self.closed.memory()) { Err(LoadError::Busy) } else { Ok(()) }
    }

    /// Load a block. In parallel to the ticks it only begins; [`Run::follow_load`] returns the answer later.
    pub(crate) fn load(&mut self, number: BlockNumber, asker: LoadSource) -> Option<Answer> {
        if let Err(why) = self.can_load() {
            return Some((asker, Err(why)));
        }
        let inside = matches!(asker, LoadSource::Workstation(_));
        if self.loads.loader.is_none() {
            return Some((asker, self.load_at_once(number, inside)));
        }
        let order = self.order(number, None, inside);
        if let Some(loader) = &self.loads.loader {
            loader.begin(order);
        }
        self.loads.loading = Some(Loading { asker, number, stage: Stage::Checking, is_withdrawn: false });
        None
    }

    /// Called once between two ticks: the result of the load in progress, with its source.
    pub(crate) fn follow_load(&mut self, tick: Tick) -> Option<Answer> {
        let Loading { asker, number, stage, is_withdrawn } = self.loads.loading.take()?;
        let stage = match stage {
            Stage::Checking => match self.loads.loader.as_ref()?.look() {
                None => Stage::Checking,
                Some(Err(why)) => return Some((asker, Err(why))),
                Some(Ok(_)) if is_withdrawn => return Some((asker, Err(LoadError::Withdrawn))),
                Some(Ok(loaded)) => {
                    let Some(load) = self.announce() else {
                        return Some((asker, self.take_up(number, loaded)));
                    };
                    self.loads.last = load;
                    Stage::Announced { loaded, since: tick }
                }
            },
            Stage::Announced { loaded, since } => match self.boards_have_checked(&loaded) {
                Ok(_) if is_withdrawn => {
                    return Some((asker, Err(self.take_back(LoadError::Withdrawn))));
                }
                Ok(true) => return Some((asker, self.take_up(number, loaded))),
                Ok(false) if tick.since(since) < BOARDS_LIMIT => Stage::Announced { loaded, since },
                Ok(false) => return Some((asker, Err(self.take_back(LoadError::Late)))),
                Err(board) => return Some((asker, Err(self.take_back(LoadError::Differs(board))))),
            },
        };
        self.loads.loading = Some(Loading { asker, number, stage, is_withdrawn });
        None
    }

    /// Load a block before the next tick; in a repetition, from the log.
    fn load_at_once(&mut self, number: BlockNumber, inside: bool) -> Result<String, LoadError> {
        let recorded = self.asked.recorded_block(self.closed.generations().number().saturating_add(1));
        let source = recorded.map(|block| block.ok_or(LoadError::NotRecorded)).transpose()?;
        let loaded = self.order(number, source, inside).carry_out()?;
        if let Some(load) = self.announce() {
            self.loads.last = load;
            let begun = Instant::now();
            loop {
                match self.boards_have_checked(&loaded) {
                    Ok(true) => break,
                    Ok(false) if begun.elapsed() < LOAD_LIMIT => thread::sleep(LOOK),
                    Ok(false) => return Err(self.take_back(LoadError::Late)),
                    Err(board) => return Err(self.take_back(LoadError::Differs(board))),
                }
            }
        }
        self.take_up(number, loaded)
    }

    fn order(&self, number: BlockNumber, source: Option<Source>, inside: bool) -> Order {
        let is_split = matches!(self.closed.course().levels(), Controller::Split(_));
        let generations = self.closed.generations();
        Order {
            number,
            source,
            directory: self.config.data.clone(),
            base: generations.current().clone(),
            reloads: generations.reloads().to_vec(),
            done: generations.done(),
            file: is_split.then(|| load_file(&self.name, self.loads.last.saturating_add(1))),
            inside,
        }
    }

    fn coordinator(&mut self) -> Option<&mut Coordinator> {
        match self.closed.course_mut().levels_mut() {
            Controller::Split(coordinator) => Some(coordinator),
            Controller::One(_) => None,
        }
    }

    /// Announce the file to the boards in other processes. Returns the number of the load; `None` on one board.
    fn announce(&mut self) -> Option<u32> {
        let load = self.loads.last.saturating_add(1);
        self.coordinator()?.announce(load);
        Some(load)
    }

    fn boards_have_checked(&mut self, loaded: &Loaded) -> Result<bool, Board> {
        let load = self.loads.last;
        self.coordinator().map_or(Ok(true), |coordinator| coordinator.have_checked(load, loaded.data))
    }

    /// Withdraw an announced load, so that a board that joins later does not read it.
    fn take_back(&self, why: LoadError) -> LoadError {
        let _ = fs::remove_file(load_file(&self.name, self.loads.last));
        why
    }

    /// Add the block to the task data from the next tick on.
    fn take_up(&mut self, number: BlockNumber, loaded: Loaded) -> Result<String, LoadError> {
        let Loaded { reloads, done, .. } = loaded;
        let refused = if generations::is_busy(self.closed.memory()) {
            Some(LoadError::Busy)
        } else if done != self.closed.generations().done() || !self.use_reloads(reloads) {
            Some(LoadError::Reload)
        } else {
            None
        };
        if let Some(why) = refused {
            return Err(self.take_back(why));
        }
        let load = self.loads.last;
        if let Some(coordinator) = self.coordinator() {
            coordinator.commit(load);
        }
        let generations = self.closed.generations();
        let generation = generations.number();
        let name = generations.reload(generation).map_or("", |reload| &reload.source.name);
        Ok(format!("{number} of {name} is loaded; the data have generation {generation}"))
    }
}
