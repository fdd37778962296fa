//! LOAD during a run (IV.2.4): a block of the run's data directory, as the file is now, becomes part of the task data
//! before the next command. First all boards check the whole data with the block.
//!
//! The log keeps the text, so that a replay, and a repetition with the same inputs, load the same block.

use std::{
    fmt, fs, io, thread,
    time::{Duration, Instant},
};

use executive::{
    boards::{Board, Coordinator},
    generations,
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

/// Time limit for boards to check a load.
const PATIENCE: Duration = Duration::from_secs(10);
/// The same in ticks.
const BOARDS_LIMIT: u64 = PATIENCE.as_secs() * 1000 / TICK_MS;
/// Time between two checks of the boards, when the run waits for them.
const LOOK: Duration = Duration::from_millis(5);

/// Why a block is not loaded.
#[derive(Debug)]
pub enum LoadError {
    /// A command is executed.
    Busy,
    /// Another block is being loaded.
    Loading,
    /// The data directory has no such block.
    NoBlock(BlockNumber),
    /// The log whose inputs are replayed does not have the text.
    NotRecorded,
    /// With the block the data have errors.
    Data(String),
    /// The job has loaded blocks meanwhile, or waits for the end of a command with some.
    Reload,
    /// The file for the boards cannot be written.
    Write(io::Error),
    /// A board has not checked it in time.
    Late,
    /// A board has other data after the load.
    Differs(Board),
    /// The thread that checks has ended.
    NoThread,
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => {
                f.write_str("a command is executed, and keeps its records: PAUSE, or wait for its end")
            }
            Self::Loading => f.write_str("another block is being checked: ask again when that is answered"),
            Self::NoBlock(block) => write!(f, "the run's data directory has no {block}"),
            Self::NotRecorded => f.write_str("the log has no text of the block"),
            Self::Data(report) => write!(f, "with this change the task data have errors:\n{report}"),
            Self::Reload => f.write_str("the job loads blocks at this moment: ask again"),
            Self::Write(error) => write!(f, "the blocks for the boards cannot be written: {error}"),
            Self::Late => write!(
                f,
                "not all boards have checked it within {} s; nothing has changed",
                PATIENCE.as_secs()
            ),
            Self::Differs(board) => {
                write!(
                    f,
                    "{board} has other task data after this: it was started with other data; nothing has changed"
                )
            }
            Self::NoThread => f.write_str("the thread that checks blocks has ended; nothing has changed"),
        }
    }
}

/// Loads and jobs that operators have asked for during a run.
#[derive(Default)]
pub struct Loads {
    /// Thread that reads and checks; none where no operator can connect.
    loader: Option<Loader>,
    loading: Option<Loading>,
    /// Number of the last load that was announced to boards in other processes.
    last: u32,
    /// Number of jobs that have replaced the rest of the job before.
    pub played: u32,
}

impl Loads {
    /// Nothing was read yet.
    #[must_use]
    pub fn with(loader: Option<Loader>) -> Self {
        Self { loader, ..Self::default() }
    }

    /// A block is being checked.
    #[must_use]
    pub const fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Blocks can be checked beside the ticks.
    #[must_use]
    pub const fn can_load(&self) -> bool {
        self.loader.is_some()
    }
}

/// A load that was asked for and is not answered yet.
struct Loading {
    input: Input,
    number: BlockNumber,
    stage: Stage,
}

enum Stage {
    /// The thread of the run reads and checks.
    Checking,
    /// The boards check.
    Announced { loaded: Loaded, since: Tick },
}

impl Run {
    /// Whether a block can be loaded now.
    ///
    /// # Errors
    /// Why not.
    pub(crate) fn can_load(&self) -> Result<(), LoadError> {
        if self.loads.loading.is_some() {
            return Err(LoadError::Loading);
        }
        if generations::is_busy(self.runner.memory()) { Err(LoadError::Busy) } else { Ok(()) }
    }

    /// Begin to load a block beside the ticks; the input is answered later.
    pub(crate) fn begin_load(&mut self, number: BlockNumber, input: Input) {
        let order = self.order(number, None);
        if let Some(loader) = &self.loads.loader {
            loader.begin(order);
        }
        self.loads.loading = Some(Loading { input, number, stage: Stage::Checking });
    }

    /// Once between two ticks: the result of the load in progress, with the input that asked for it.
    pub(crate) fn follow_load(&mut self, tick: Tick) -> Option<(Input, Result<String, LoadError>)> {
        let Loading { input, number, stage } = self.loads.loading.take()?;
        let stage = match stage {
            Stage::Checking => match self.loads.loader.as_ref()?.look() {
                None => Stage::Checking,
                Some(Err(why)) => return Some((input, Err(why))),
                Some(Ok(loaded)) => {
                    let Some(load) = self.announce() else {
                        return Some((input, self.take_up(number, loaded)));
                    };
                    self.loads.last = load;
                    Stage::Announced { loaded, since: tick }
                }
            },
            Stage::Announced { loaded, since } => match self.boards_have_checked(&loaded) {
                Ok(true) => return Some((input, self.take_up(number, loaded))),
                Ok(false) if tick.since(since) < BOARDS_LIMIT => Stage::Announced { loaded, since },
                Ok(false) => return Some((input, Err(self.take_back(LoadError::Late)))),
                Err(board) => return Some((input, Err(self.take_back(LoadError::Differs(board))))),
            },
        };
        self.loads.loading = Some(Loading { input, number, stage });
        None
    }

    /// Load a block before the next tick, as a log has it.
    ///
    /// # Errors
    /// [`LoadError`]; then nothing has changed.
    pub(crate) fn load_recorded(&mut self, number: BlockNumber) -> Result<String, LoadError> {
        let recorded = self.asked.recorded_block(self.generations.number().saturating_add(1));
        let source = recorded.ok_or(LoadError::NotRecorded)?;
        let loaded = self.order(number, Some(source)).carry_out()?;
        if let Some(load) = self.announce() {
            self.loads.last = load;
            let begun = Instant::now();
            loop {
                match self.boards_have_checked(&loaded) {
                    Ok(true) => break,
                    Ok(false) if begun.elapsed() < PATIENCE => thread::sleep(LOOK),
                    Ok(false) => return Err(self.take_back(LoadError::Late)),
                    Err(board) => return Err(self.take_back(LoadError::Differs(board))),
                }
            }
        }
        self.take_up(number, loaded)
    }

    fn order(&self, number: BlockNumber, source: Option<Source>) -> Order {
        let is_split = matches!(self.runner.levels(), Controller::Split(_));
        Order {
            number,
            source,
            directory: self.config.data.clone(),
            base: self.generations.current().clone(),
            reloads: self.job.reloads.clone(),
            done: self.generations_done(),
            file: is_split.then(|| load_file(&self.name, self.loads.last.saturating_add(1))),
        }
    }

    fn coordinator(&mut self) -> Option<&mut Coordinator> {
        match self.runner.levels_mut() {
            Controller::Split(coordinator) => Some(coordinator),
            Controller::One(_) => None,
        }
    }

    /// Announce the file to the boards in other processes, which check it; returns the number of the load, `None` on
    /// one board.
    fn announce(&mut self) -> Option<u32> {
        let load = self.loads.last.saturating_add(1);
        self.coordinator()?.announce(load);
        Some(load)
    }

    fn boards_have_checked(&mut self, loaded: &Loaded) -> Result<bool, Board> {
        let load = self.loads.last;
        self.coordinator().map_or(Ok(true), |coordinator| coordinator.have_checked(load, loaded.data))
    }

    /// Withdraw a load that was announced: a board that joins later must not read it.
    fn take_back(&self, why: LoadError) -> LoadError {
        // It goes with the run otherwise.
        let _ = fs::remove_file(load_file(&self.name, self.loads.last));
        why
    }

    /// The task data have the block from the next tick on.
    fn take_up(&mut self, number: BlockNumber, loaded: Loaded) -> Result<String, LoadError> {
        let Loaded { reloads, done, .. } = loaded;
        let refused = if generations::is_busy(self.runner.memory()) {
            Some(LoadError::Busy)
        } else if done != self.generations_done() || !self.use_reloads(reloads) {
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
        let generation = self.generations.number();
        let name = self.job.reload(generation).map_or("", |reload| &reload.source.name);
        Ok(format!("{number} of {name} is loaded; the data have generation {generation}"))
    }
}
