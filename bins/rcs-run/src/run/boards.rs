//! Board 0's side of `--boards`: the ladder of this process, or boards in processes of their own.

use std::{
    env,
    process::{Child, Command, Stdio},
    sync::atomic::AtomicBool,
    time::Duration,
};

use executive::{
    boards::{Board, Conductor, Fingerprint, Lost, SplitError, conductor::BoardEvent, pulse::RunCard},
    memory::RunName,
    runner::Levels,
};
use levels::ladder::{Ladder, LadderState, ProcessId};
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    tick::Tick,
};
use taskdata::{
    files::TaskData,
    load::{Job, Store},
};

use super::result::BoardResult;
use crate::{
    cli::{Boards, ClockKind, RunArguments},
    error::Error,
};

/// How long boards that are started from here may take: they load the task data first.
const STARTING: Duration = Duration::from_secs(60);

/// Who steps the control processes.
pub enum Controller {
    /// This process, all of them.
    One(Box<Ladder>),
    /// Boards.
    Split(Box<Conductor>),
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
    ) -> Result<(), Lost> {
        match self {
            Self::One(ladder) => {
                ladder.step(tick, before, external, data, after);
                Ok(())
            }
            Self::Split(conductor) => conductor.step(tick, before, external, data, after),
        }
    }

    fn step_observed(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Lost> {
        match self {
            Self::One(ladder) => {
                let all = ProcessId::ALL;
                ladder.step_observed(all, tick, before, external, data, after, observe);
                Ok(())
            }
            Self::Split(conductor) => conductor.step(tick, before, external, data, after),
        }
    }

    /// Board 0 has no processes to warm up; the other boards wake with the pulse and not before it.
    fn shadow(&self) -> Option<Box<Self>> {
        match self {
            Self::One(ladder) => Some(Box::new(Self::One(ladder.clone()))),
            Self::Split(_) => None,
        }
    }

    fn copy_to(&self, shadow: &mut Self) {
        if let (Self::One(ladder), Self::One(shadow)) = (self, shadow) {
            shadow.as_mut().clone_from(ladder);
        }
    }

    fn allocations(&self) -> u64 {
        match self {
            Self::One(_) => 0,
            Self::Split(conductor) => Levels::allocations(&**conductor),
        }
    }
}

impl Controller {
    /// As asked for on the command line; boards are there when this returns.
    ///
    /// # Errors
    /// [`Error::Boards`] if they do not come together.
    pub fn start(
        arguments: &RunArguments,
        name: &RunName,
        store: &Store,
        job: &Job,
        stop: &AtomicBool,
    ) -> Result<Self, Error> {
        if arguments.boards == Boards::One {
            return Ok(Self::One(Box::default()));
        }
        let card =
            RunCard { fingerprint: fingerprint(store, job), real_time: arguments.clock == ClockKind::Real };
        let mut conductor = Conductor::create(name, &card).map_err(SplitError::from)?;
        if arguments.boards == Boards::Split {
            for &board in Board::ALL {
                let child =
                    spawn(arguments, name, board).map_err(|source| SplitError::Start { board, source })?;
                conductor.adopt(board, child);
            }
            conductor.gather(STARTING, stop, |_, _| ())?;
        } else {
            os_io::stderr_line!(
                "rcs-run: {name} waits for its boards; start each with the same data and job:"
            );
            for board in Board::ALL {
                os_io::stderr_line!("  {}", command_line(arguments, name, *board));
            }
            conductor.gather(patience(arguments), stop, announce)?;
        }
        Ok(Self::Split(Box::new(conductor)))
    }

    /// Boards that are started by hand can be replaced by hand: wait for one that takes the place of a lost one. False if the
    /// run has to end.
    pub fn replace(&mut self, lost: &Lost, arguments: &RunArguments, stop: &AtomicBool) -> bool {
        let Self::Split(conductor) = self else { return false };
        if arguments.boards != Boards::Manual {
            return false;
        }
        os_io::stderr_line!("rcs-run: {lost}; the robot waits for another to take its place:");
        os_io::stderr_line!("  {}", command_line(arguments, conductor.name(), lost.board));
        let came = conductor.await_successor(lost, patience(arguments), stop, announce);
        if let Err(error) = &came {
            os_io::stderr_line!("rcs-run: {error}");
        }
        came.is_ok()
    }

    /// What all processes remember.
    #[must_use]
    pub fn state(&self) -> LadderState {
        match self {
            Self::One(ladder) => ladder.state(),
            Self::Split(conductor) => *conductor.states(),
        }
    }

    /// What each board did; `None` on one board.
    #[must_use]
    pub fn results(&self) -> Option<Vec<BoardResult>> {
        match self {
            Self::One(_) => None,
            Self::Split(conductor) => Some(conductor.figures().map(BoardResult::from).collect()),
        }
    }

    /// Boards that did not get everything that real time needs.
    #[must_use]
    pub fn unpunctual(&self) -> Vec<Board> {
        match self {
            Self::One(_) => Vec::new(),
            Self::Split(conductor) => {
                conductor.figures().filter(|figures| !figures.punctual).map(|figures| figures.board).collect()
            }
        }
    }
}

/// How long to wait for boards that are started by hand.
fn patience(arguments: &RunArguments) -> Duration {
    Duration::from_secs(arguments.wait.into())
}

/// Say who has come, who has left, and who is missing.
fn announce(event: BoardEvent, missing: &[Board]) {
    let missing: Vec<String> = missing.iter().map(|board| board.number().to_string()).collect();
    let rest = match missing.as_slice() {
        [] => "all are there".to_owned(),
        some => format!("missing: {}", some.join(", ")),
    };
    match event {
        BoardEvent::Came { board, pid } => {
            os_io::stderr_line!("rcs-run: {board} is there (process {pid}); {rest}")
        }
        BoardEvent::Left { board, pid } => {
            os_io::stderr_line!("rcs-run: {board} is gone (process {pid}); {rest}")
        }
    }
}

/// What a board must have in common with the run.
#[must_use]
pub fn fingerprint(store: &Store, job: &Job) -> Fingerprint {
    let reloads = job.reloads.iter().map(|reload| &reload.source);
    Fingerprint::of(env!("RCS_COMMIT"), store.sources(), std::iter::once(job.source()).chain(reloads))
}

/// A board's process. Its words go to standard error like those of this one; standard output belongs to the result.
fn spawn(arguments: &RunArguments, name: &RunName, board: Board) -> std::io::Result<Child> {
    let mut command = Command::new(env::current_exe()?);
    command.args(["board", &board.number().to_string(), "--run", name.as_str()]);
    if let Some(cpu) = arguments.cpu {
        command.args(["--cpu", &cpu.to_string()]);
    }
    command
        .args(["--parent", &std::process::id().to_string()])
        .arg("--data")
        .arg(&arguments.data)
        .arg(arguments.played().unwrap_or("--commanded"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
}

/// The same for a person to type.
fn command_line(arguments: &RunArguments, name: &RunName, board: Board) -> String {
    let data = arguments.data.display();
    format!(
        "rcs-run board {} --run {name} --data {data} {}",
        board.number(),
        arguments.played().unwrap_or("--commanded")
    )
}
