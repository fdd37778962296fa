//! A board's side of `--boards split`: waits for the pulse and steps its processes.
//!
//! A board steps its own processes with the code of the ladder ([`Ladder::step_in_order`]). Everything it needs for a
//! tick arrives with the pulse; it never reads a clock.
//!
//! A board that replaces a killed one finds a pulse without an answer. It latches the outputs of its predecessor and
//! writes them with its own epoch, so its neighbours read the same values as before. It restarts the processes, which
//! adopt the numbers of their commands and report the restart (docs/design/handshake.md "Restart").

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use iceoryx2::{node::Node, prelude::ipc};
use interfaces::CommonMemory;
use levels::ladder::{Ladder, LadderState, ProcessId};
use rcs_core::{Plain, plain::DecodeError, tick::Tick};
use rustix::process::{Pid, Signal, getppid, set_parent_process_death_signal};
use taskdata::files::TaskData;

use super::{
    BOARDS, Board,
    coordinator::BOARD_0,
    exchange::{Readers, Writers},
    pulse::{BoardReport, Checked, Fingerprint, PulseTaker, ReportWriter, RunCard, SystemPulse, sleep},
};
use crate::{
    alloc::{self, Section},
    memory::{
        self, RunName, SharedMemoryError,
        layout::Epoch,
        publish::FIRST_EPOCH,
        runs::{self, RunNode},
    },
};

/// Time that a board waits for a notification before it checks for a pulse by itself.
const LOOK: Duration = Duration::from_millis(100);
/// Number of checks without a pulse after which the board tests whether board 0 is still alive.
const LIFE: u32 = 10;
/// Time to wait for a board's name to become free: its process may just have been killed.
const CROWDED: Duration = Duration::from_secs(2);
/// Time between two attempts to open a service that does not exist yet.
const AGAIN: Duration = Duration::from_millis(5);

#[derive(Debug, thiserror::Error)]
pub enum MemberError {
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    #[error("{board} cannot take part in {run}: {difference}")]
    Different { board: Board, run: RunName, difference: &'static str },
    #[error("{board} of {run} runs already: {source}")]
    Taken {
        board: Board,
        run: RunName,
        source: SharedMemoryError, // the error of iceoryx2
    },
    #[error("{board} cannot be taken over: what it wrote in tick {last} is lost")]
    NothingToLatch {
        board: Board,
        last: Tick, // the last tick that all boards have finished
    },
    #[error("{0} is over")]
    RunIsOver(RunName),
    #[error("shared memory holds an invalid record: {0}")]
    Decode(#[from] DecodeError),
    #[error("the pulse asks for generation {0} of the task data, which the job does not have")]
    Generation(u32),
    #[error("tick {found} came after tick {last}")]
    OutOfStep {
        last: Tick,  // the tick that was run last
        found: Tick, // the tick of the pulse
    },
}

/// The task data of a board, with the loads during the run.
pub trait BoardData {
    /// A generation of the task data with the loads up to `loaded`; `None` if it was never loaded. Called in a tick.
    fn generation(&mut self, generation: u32, loaded: u32) -> Option<TaskData<'_>>;

    /// Start to check a load in parallel with the ticks, if it is a new one. Returns the last result.
    fn check(&mut self, load: u32) -> Checked;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemberEnd {
    Over,
    Asked,
    Orphaned,
    Replaced,
}

pub fn end_with_parent(parent: u32) -> std::io::Result<bool> {
    set_parent_process_death_signal(Some(Signal::KILL))?;
    let present = getppid().map(Pid::as_raw_nonzero).and_then(|pid| u32::try_from(pid.get()).ok());
    Ok(present == Some(parent))
}

struct Ports {
    taker: PulseTaker,
    writers: Writers,
    reports: ReportWriter,
    // The neighbours, each with the epoch in which it was opened.
    neighbours: [Option<(Epoch, Readers)>; BOARDS],
    node: RunNode,
}

pub struct Member {
    board: Board,
    processes: Vec<ProcessId>,
    epoch: Epoch,
    name: RunName,
    ports: Option<Ports>,
    card: RunCard,
    ladder: Ladder,
    halves: [CommonMemory; 2], // common memory by tick parity, as read by this board
    tick: Tick,
    loaded: u32,
    report: BoardReport,
    allocations_at_start: u64,
}

impl Member {
    /// Join a run as one of its boards. Fails if the run does not exist, has another `fingerprint`, or the place is
    /// taken.
    pub fn join(name: &RunName, board: Board, fingerprint: Fingerprint) -> Result<Self, MemberError> {
        runs::find_living(name)?;
        let node = runs::enter(name, board.name())?;
        let taker = PulseTaker::open(&node)?;
        let card = taker.card()?;
        if let Some(difference) = fingerprint.difference(&card.fingerprint) {
            return Err(MemberError::Different { board, run: name.clone(), difference });
        }
        let deadline = Instant::now() + CROWDED;
        let (pulse, mut writers, mut reports) = loop {
            let pulse = taker.pulse()?;
            if pulse.over {
                return Err(MemberError::RunIsOver(name.clone()));
            }
            let epoch = pulse.epochs[board.index()];
            let created = Writers::create(&node, board, epoch)
                .and_then(|writers| Ok((writers, ReportWriter::create(&node, board, epoch)?)));
            match created {
                Ok((writers, reports)) => break (pulse, writers, reports),
                Err(source) if Instant::now() > deadline => {
                    return Err(MemberError::Taken { board, run: name.clone(), source });
                }
                Err(_) => std::thread::sleep(AGAIN),
            }
        };
        memory::reserve(name)?;
        let report =
            BoardReport { fingerprint, pid: std::process::id(), punctual: true, ..BoardReport::ZERO };
        let mut halves = [CommonMemory::ZERO; 2];
        let epoch = pulse.epochs[board.index()];
        // Before the first tick the pulse names the tick after which the run starts.
        let tick = if pulse.tick == card.start { card.start } else { pulse.tick.previous() };
        if tick != Tick::BEFORE_START || pulse.tick != card.start {
            let latched = latch(&node, board, epoch, tick, &mut halves)?;
            writers.write(tick, latched, &LadderState::default());
        }
        reports.write(tick, &report);
        let ports = Ports { taker, writers, reports, neighbours: [const { None }; BOARDS], node };
        Ok(Self {
            board,
            processes: board.processes().collect(),
            epoch,
            name: name.clone(),
            ports: Some(ports),
            card,
            ladder: Ladder::default(),
            halves,
            tick,
            loaded: pulse.loaded,
            report,
            allocations_at_start: alloc::allocations(),
        })
    }

    /// True if ticks come every 40 ms: make the real-time requests, and pass their outcome to [`Member::run`].
    #[must_use]
    pub const fn is_real_time(&self) -> bool {
        self.card.real_time
    }

    /// The last load that was in effect when the board joined.
    #[must_use]
    pub const fn loaded(&self) -> u32 {
        self.loaded
    }

    /// Step the board's processes, once per pulse, until the run is over. `stop` asks the board to leave; `punctual` is
    /// true if all real-time requests were granted.
    pub fn run(
        &mut self,
        mut data: impl BoardData,
        punctual: bool,
        stop: &AtomicBool,
    ) -> Result<MemberEnd, MemberError> {
        self.report.punctual = punctual;
        self.allocations_at_start = alloc::allocations();
        let mut silent = 0;
        loop {
            let Some(pulse) = self.pulse()?.filter(|pulse| !pulse.over) else { return Ok(MemberEnd::Over) };
            if pulse.epochs[self.board.index()] != self.epoch {
                return Ok(MemberEnd::Replaced);
            }
            if stop.load(Ordering::Relaxed) {
                self.leave();
                return Ok(MemberEnd::Asked);
            }
            self.tell(data.check(pulse.load));
            if !self.follow(&pulse)? {
                std::thread::sleep(AGAIN);
                silent += 1;
            } else if pulse.tick == self.tick.next() {
                let generation = pulse.external.generation;
                let data =
                    data.generation(generation, pulse.loaded).ok_or(MemberError::Generation(generation))?;
                self.step(&pulse, &data)?;
                silent = 0;
            } else if pulse.tick == self.tick {
                silent = if self.wait() { 0 } else { silent + 1 };
            } else {
                return Err(MemberError::OutOfStep { last: self.tick, found: pulse.tick });
            }
            if silent >= LIFE {
                silent = 0;
                if !runs::has_living(&self.name, BOARD_0) {
                    let over = self.pulse()?.is_none_or(|pulse| pulse.over);
                    return Ok(if over { MemberEnd::Over } else { MemberEnd::Orphaned });
                }
            }
        }
    }

    fn pulse(&self) -> Result<Option<SystemPulse>, DecodeError> {
        self.ports.as_ref().map(|ports| ports.taker.pulse()).transpose()
    }

    /// Sleep until the pulse wakes this board; false if none came.
    fn wait(&self) -> bool {
        let _section = Section::enter();
        let Some(ports) = &self.ports else { return false };
        let started = Instant::now();
        sleep(&ports.taker.wake, LOOK);
        started.elapsed() < LOOK
    }

    /// Open the neighbours that have joined or were replaced since the last call; true if all are there.
    fn follow(&mut self, pulse: &SystemPulse) -> Result<bool, MemberError> {
        let Some(ports) = &mut self.ports else { return Ok(false) };
        // The tick whose outputs this board still needs for the next tick, if it has run.
        let needed = Some(self.tick).filter(|tick| *tick != Tick::BEFORE_START && *tick != pulse.tick);
        let [even, odd] = &mut self.halves;
        let half = if self.tick.0.is_multiple_of(2) { even } else { odd };
        let (mut complete, mut changed) = (true, !self.report.ready);
        for board in self.board.others() {
            let epoch = pulse.epochs[board.index()];
            let place = &mut ports.neighbours[board.index()];
            if place.as_ref().is_some_and(|(opened, _)| *opened == epoch) {
                continue;
            }
            // A service that cannot be opened does not exist yet; until it does, a successor may need the open one.
            let Ok(readers) = Readers::open(&ports.node, board, epoch) else {
                complete = false;
                continue;
            };
            match needed.map_or(Ok(true), |tick| readers.outputs(tick, half))? {
                true => (*place, changed) = (Some((epoch, readers)), true),
                false => complete = false,
            }
        }
        if complete && changed {
            self.report.ready = true;
            ports.reports.write(self.tick, &self.report);
            // The first call after a change of the run's nodes allocates, so it must not be in a tick.
            ports.taker.done();
        }
        Ok(complete)
    }

    fn step(&mut self, pulse: &SystemPulse, data: &TaskData<'_>) -> Result<(), MemberError> {
        let _section = Section::enter();
        let started = Instant::now();
        let Some(ports) = &mut self.ports else { return Ok(()) };
        let tick = pulse.tick;
        let [even, odd] = &mut self.halves;
        let (before, after) = if tick.0.is_multiple_of(2) { (odd, even) } else { (even, odd) };
        for (_, readers) in ports.neighbours.iter().flatten() {
            // A process that has not written keeps its old stamp, from which the others detect it.
            let _complete: bool = readers.outputs(self.tick, before)?;
        }
        self.ladder.step_in_order(&self.processes, tick, before, &pulse.external, data, after);
        ports.writers.write(tick, after, &self.ladder.state());
        self.tick = tick;
        self.report.allocations = alloc::allocations() - self.allocations_at_start;
        self.report.step_ns = u64::try_from(started.elapsed().as_nanos()).unwrap_or(u64::MAX);
        ports.reports.write(tick, &self.report);
        ports.taker.done();
        Ok(())
    }

    fn tell(&mut self, checked: Checked) {
        let Some(ports) = &mut self.ports else { return };
        if self.report.checked != checked {
            self.report.checked = checked;
            ports.reports.write(self.tick, &self.report);
            ports.taker.done();
        }
    }

    /// Report that this board will stamp no further tick.
    fn leave(&mut self) {
        let Some(ports) = &mut self.ports else { return };
        self.report.ready = false;
        ports.reports.write(self.tick, &self.report);
        ports.taker.done();
    }
}

/// Latch the outputs of the last predecessor that stepped: they stay on its devices.
fn latch<'a>(
    node: &Node<ipc::Service>,
    board: Board,
    epoch: Epoch,
    last: Tick,
    halves: &'a mut [CommonMemory; 2],
) -> Result<&'a CommonMemory, MemberError> {
    let [even, odd] = halves;
    let half = if last.0.is_multiple_of(2) { even } else { odd };
    for epoch in (FIRST_EPOCH..epoch).rev() {
        // A predecessor that never ran a tick may have left no services, or empty ones.
        let Ok(predecessor) = Readers::open(node, board, epoch) else { continue };
        if predecessor.outputs(last, half)? {
            return Ok(half);
        }
    }
    Err(MemberError::NothingToLatch { board, last })
}

impl Drop for Member {
    fn drop(&mut self) {
        drop(self.ports.take());
        // Board 0 or another board keeps the files; the last process to leave removes them.
        let _ = runs::remove_if_deserted(&self.name, &memory::layout());
    }
}
