//! Board 0's side of `--boards`: the ladder of this process, or boards in other processes.

use std::{
    process::{Child, Command, Stdio},
    sync::atomic::Ordering,
    time::Duration,
};

use closed_loop::{Present, course::Levels};
use executive::{
    boards::{Board, Coordinator, Fingerprint, Lost, SplitError, coordinator::BoardEvent, pulse::RunCard},
    memory::{RunName, SET_UP_LIMIT, within_limit},
};
use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{LadderState, ProcessId};
use os_io::shell;
use rcs_core::tick::Tick;
use taskdata::{
    files::TaskData,
    load::{Job, Store},
};

use crate::result::BoardResult;
use crate::{
    config::{Boards, ClockKind, RunConfig},
    error::StartError,
    observer::Observer,
};

const STARTING: Duration = Duration::from_secs(60); // including the load of the task data

pub enum Controller {
    One(Box<Present>),
    Split(Box<Coordinator>),
}

impl Levels<TaskData<'_>> for Controller {
    type Error = Lost;

    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Lost> {
        match self {
            Self::One(present) => {
                let Ok(()) = present.step(tick, before, external, data, after, observe);
                Ok(())
            }
            Self::Split(coordinator) => coordinator.step(tick, before, external, data, after, observe),
        }
    }

    /// Board 0 has no processes to warm up. The other boards wake with the pulse, not before it.
    fn shadow(&self) -> Option<Box<Self>> {
        match self {
            Self::One(present) => present.shadow().map(Self::One).map(Box::new),
            Self::Split(_) => None,
        }
    }

    fn copy_to(&self, shadow: &mut Self) {
        if let (Self::One(present), Self::One(shadow)) = (self, shadow) {
            present.copy_to(shadow);
        }
    }

    fn allocations(&self) -> u64 {
        match self {
            Self::One(_) => 0,
            Self::Split(coordinator) => Levels::allocations(&**coordinator),
        }
    }
}

impl Controller {
    /// Start the boards of the configuration; all are ready when this returns. Fails if the run is interrupted before.
    pub fn start(
        config: &RunConfig,
        name: &RunName,
        (store, job): (&Store, &Job),
        resumed: Option<&(Tick, CommonMemory)>,
        observer: &mut dyn Observer,
    ) -> Result<Self, StartError> {
        if config.boards == Boards::One {
            return Ok(Self::One(Box::default()));
        }
        let real_time = config.clock == ClockKind::Real;
        let card = RunCard { fingerprint: fingerprint(store, job), real_time, start: Tick::BEFORE_START };
        let mut coordinator = within_limit(SET_UP_LIMIT, config.on_stuck, || match resumed {
            Some((tick, memory)) => Coordinator::resume(name, &card, *tick, memory),
            None => Coordinator::create(name, &card),
        })
        .map_err(SplitError::from)?;
        if config.boards == Boards::Split {
            for &board in Board::ALL {
                let child =
                    spawn(config, name, board).map_err(|source| SplitError::Start { board, source })?;
                coordinator.adopt(board, child);
            }
            // The signal may have ended a board before it ignored signals.
            let gather = || coordinator.gather(STARTING, &config.stop, |_, _| ());
            within_limit(STARTING + SET_UP_LIMIT, config.on_stuck, gather)
                .map_err(|error| refused(error, config, job))?;
        } else {
            observer.message(&format!("{name} waits for its boards; start each with the same data and job:"));
            for board in Board::ALL {
                observer.message(&format!("  {}", command_line(config, name, *board)));
            }
            let gathered = within_limit(wait_limit(config) + SET_UP_LIMIT, config.on_stuck, || {
                coordinator.gather(wait_limit(config), &config.stop, |event, missing| {
                    announce(event, missing, observer);
                })
            });
            gathered.map_err(|error| refused(error, config, job))?;
        }
        Ok(Self::Split(Box::new(coordinator)))
    }

    /// Wait for a replacement of a lost board, perhaps by hand. Returns false if the run must end.
    pub fn replace(&mut self, lost: &Lost, config: &RunConfig, observer: &mut dyn Observer) -> bool {
        let Self::Split(coordinator) = self else { return false };
        if config.boards != Boards::Manual {
            return false;
        }
        observer.message(&format!("{lost}; the robot waits for a replacement:"));
        observer.message(&format!("  {}", command_line(config, coordinator.name(), lost.board)));
        let came = coordinator.await_successor(lost, wait_limit(config), &config.stop, |event, missing| {
            announce(event, missing, observer);
        });
        if let Err(error) = &came {
            observer.message(&error.to_string());
        }
        came.is_ok()
    }

    #[must_use]
    pub fn state(&self) -> LadderState {
        match self {
            Self::One(present) => present.ladder().state(),
            Self::Split(coordinator) => *coordinator.states(),
        }
    }

    #[must_use]
    pub fn results(&self) -> Option<Vec<BoardResult>> {
        match self {
            Self::One(_) => None,
            Self::Split(coordinator) => Some(coordinator.figures().map(BoardResult::from).collect()),
        }
    }

    #[must_use]
    pub fn unpunctual(&self) -> Vec<Board> {
        match self {
            Self::One(_) => Vec::new(),
            Self::Split(coordinator) => coordinator
                .figures()
                .filter(|figures| !figures.punctual)
                .map(|figures| figures.board)
                .collect(),
        }
    }
}

fn refused(error: SplitError, config: &RunConfig, job: &Job) -> StartError {
    let interrupted = config.stop.load(Ordering::Relaxed);
    if interrupted { StartError::Interrupted(job.name.clone()) } else { error.into() }
}

/// Time limit for boards that are started by hand.
fn wait_limit(config: &RunConfig) -> Duration {
    Duration::from_secs(config.wait.into())
}

/// Print which boards have joined, have left, or are missing.
fn announce(event: BoardEvent, missing: &[Board], observer: &mut dyn Observer) {
    let missing: Vec<String> = missing.iter().map(|board| board.number().to_string()).collect();
    let rest = match missing.as_slice() {
        [] => "all are there".to_owned(),
        some => format!("missing: {}", some.join(", ")),
    };
    match event {
        BoardEvent::Came { board, pid } => {
            observer.message(&format!("{board} is ready (process {pid}); {rest}"));
        }
        BoardEvent::Left { board, pid } => {
            observer.message(&format!("{board} has ended (process {pid}); {rest}"));
        }
    }
}

/// Data that a board must share with the run.
#[must_use]
pub fn fingerprint(store: &Store, job: &Job) -> Fingerprint {
    let reloads = job.reloads.iter().map(|reload| &reload.source);
    Fingerprint::of(crate::COMMIT, store.sources(), std::iter::once(job.source()).chain(reloads))
}

/// Start the process of a board. Its messages go to standard error; standard output is for the result.
fn spawn(config: &RunConfig, name: &RunName, board: Board) -> std::io::Result<Child> {
    let mut command = Command::new(&config.program);
    command.args(["board", &board.number().to_string(), "--run", name.as_str()]);
    if let Some(cpu) = config.cpu {
        command.args(["--cpu", &cpu.to_string()]);
    }
    command
        .args(["--parent", &std::process::id().to_string()])
        .arg("--data")
        .arg(&config.data)
        .arg(config.played().unwrap_or("--commanded"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
}

/// The same command line for a terminal.
fn command_line(config: &RunConfig, name: &RunName, board: Board) -> String {
    let job = config.played().map_or_else(|| "--commanded".to_owned(), shell::path);
    format!("rcs-run board {} --run {name} --data {} {job}", board.number(), shell::path(&config.data))
}
