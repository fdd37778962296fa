//! Board 0's side of `--boards split`: gives the pulse, waits for the stamps, collects common memory.
//!
//! Common memory after a tick is the same, bit for bit, as that of a ladder on one board. There is one additional
//! failure: a board that does not stamp. Board 0 then gives no more pulses: no process is stepped again, the robot gets
//! no further point, and valves and fingers stay as they are.

use std::{
    process::{Child, ExitStatus},
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{LadderState, ProcessId};
use rcs_core::{Plain, tick::Tick};
use taskdata::files::TaskData;

use super::{
    BOARDS, Board,
    exchange::{Readers, Writers},
    lost::{LOST_AFTER, LossReason, Lost, SplitError},
    pulse::{
        BoardReport, Checked, Epochs, Fingerprint, PulseGiver, ReportReader, RunCard, SystemPulse, sleep,
    },
};
use crate::{
    histogram::Histogram,
    memory::{
        self, RunName, SharedMemoryError,
        publish::FIRST_EPOCH,
        runs::{self, RunNode},
    },
};
use closed_loop::course::Levels;

pub const BOARD_0: &str = "board-0";
/// Time that board 0 waits for a notification before it checks by itself.
const LOOK: Duration = Duration::from_millis(10);
/// Time between two checks for boards that have not joined yet.
const JOIN_PERIOD: Duration = Duration::from_millis(20);
/// Number of checks after which board 0 tests whether a board that had joined is still alive.
const LIFE: u32 = 25;
/// Time limit for the boards to end by themselves when the run is over.
const CLOSING_LIMIT: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardEvent {
    Came { board: Board, pid: u32 },
    Left { board: Board, pid: u32 },
}

struct Seat {
    board: Board,
    child: Option<Child>,                   // its process, if board 0 started it
    ports: Option<(Readers, ReportReader)>, // its services, once it has joined
    former: Vec<(Readers, ReportReader)>,   // services of earlier processes of this board
    report: BoardReport,
    former_allocations: u64, // allocations of earlier processes of this board
    times: Box<Histogram>,
}

impl Seat {
    fn new(board: Board) -> Self {
        Self {
            board,
            child: None,
            ports: None,
            former: Vec::new(),
            report: BoardReport::ZERO,
            former_allocations: 0,
            times: Box::default(),
        }
    }

    const fn has_come(&self) -> bool {
        self.report.pid != 0
    }

    const fn allocations(&self) -> u64 {
        self.former_allocations + self.report.allocations
    }

    fn ended(&mut self) -> Option<ExitStatus> {
        self.child.as_mut().and_then(|child| child.try_wait().ok().flatten())
    }

    const fn lost(&self, tick: Tick, how: LossReason) -> Lost {
        Lost { board: self.board, pid: self.report.pid, tick, how }
    }

    fn has_stamped(&mut self, tick: Tick) -> Result<bool, Lost> {
        let Some((_, reports)) = &self.ports else { return Ok(false) };
        let (stamp, report) = reports.read().map_err(|error| self.lost(tick, LossReason::Garbled(error)))?;
        if stamp != tick && !report.ready {
            return Err(self.lost(tick, LossReason::Left));
        }
        self.report = report;
        Ok(stamp == tick)
    }
}

#[derive(Clone, Copy)]
pub struct BoardFigures<'a> {
    pub board: Board,
    pub pid: u32,
    /// Heap allocations in its ticks.
    pub allocations: u64,
    /// Times from wake-up to stamp.
    pub times: &'a Histogram,
    pub punctual: bool, // all real-time requests were granted
}

/// Board 0. Dropping it ends the run for all boards, waits for its processes, and removes the shared memory.
pub struct Coordinator {
    name: RunName,
    ports: Option<(PulseGiver, RunNode)>,
    seats: Vec<Seat>,
    pulse: SystemPulse,
    fingerprint: Fingerprint,
    states: LadderState,
    resumed: Vec<Writers>, // the outputs with which the boards of a resumed run start, until they have read them
}

impl Coordinator {
    /// Set up the pulse of a run, after removing the remains of killed runs.
    pub fn create(name: &RunName, card: &RunCard) -> Result<Self, SharedMemoryError> {
        Self::set_up(name, card, None)
    }

    /// Set up the pulse of a run that starts after `tick` with these buffers. Each board finds them as the outputs of a
    /// predecessor, which it adopts like those of a lost board.
    pub fn resume(
        name: &RunName,
        card: &RunCard,
        tick: Tick,
        memory: &CommonMemory,
    ) -> Result<Self, SharedMemoryError> {
        Self::set_up(name, &RunCard { start: tick, ..*card }, Some(memory))
    }

    fn set_up(
        name: &RunName,
        card: &RunCard,
        resumed: Option<&CommonMemory>,
    ) -> Result<Self, SharedMemoryError> {
        runs::clean()?;
        memory::have_room()?;
        let node = runs::enter(name, BOARD_0)?;
        let predecessor = |board: &Board| {
            let memory = resumed?;
            let writers = Writers::create(&node, *board, FIRST_EPOCH);
            Some(writers.map(|mut writers| {
                writers.write(card.start, memory, &LadderState::default());
                writers
            }))
        };
        let resumed = Board::ALL.iter().filter_map(predecessor).collect::<Result<Vec<_>, _>>()?;
        let first = if resumed.is_empty() { FIRST_EPOCH } else { FIRST_EPOCH + 1 };
        let pulse = SystemPulse { tick: card.start, epochs: [first; BOARDS], ..SystemPulse::ZERO };
        let giver = PulseGiver::create(&node, card, &pulse)?;
        memory::reserve(name)?;
        Ok(Self {
            name: name.clone(),
            ports: Some((giver, node)),
            resumed,
            seats: Board::ALL.iter().map(|&board| Seat::new(board)).collect(),
            pulse,
            fingerprint: card.fingerprint,
            states: LadderState::ZERO,
        })
    }

    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    pub fn adopt(&mut self, board: Board, child: Child) {
        self.seats[board.index()].child = Some(child);
    }

    /// Wait until all boards have joined and read each other. Calls `heard` for each board that joins or leaves, with
    /// the missing ones. Fails if a board does not join, or has another program, data or job.
    pub fn gather(
        &mut self,
        wait_limit: Duration,
        stop: &AtomicBool,
        mut heard: impl FnMut(BoardEvent, &[Board]),
    ) -> Result<(), SplitError> {
        let deadline = Instant::now() + wait_limit;
        for look in 1_u32.. {
            for at in 0..self.seats.len() {
                if self.look_for(at)? {
                    let Seat { board, report: BoardReport { pid, .. }, .. } = self.seats[at];
                    heard(BoardEvent::Came { board, pid }, &self.boards_that(|seat| !seat.has_come()));
                }
                if look.is_multiple_of(LIFE)
                    && let Some(event) = self.drop_dead_members(at)
                {
                    heard(event, &self.boards_that(|seat| !seat.has_come()));
                }
            }
            let unready = self.boards_that(|seat| !seat.report.ready);
            if unready.is_empty() {
                break;
            }
            // A board that has joined is ready as soon as all others have joined.
            let absent = self.boards_that(|seat| !seat.has_come());
            let missing = if absent.is_empty() { unready } else { absent };
            if stop.load(Ordering::Relaxed) {
                return Err(SplitError::Interrupted(missing));
            }
            if Instant::now() > deadline {
                return Err(SplitError::Missing { missing, wait_limit });
            }
            if let Some((giver, _)) = &self.ports {
                sleep(&giver.done, JOIN_PERIOD);
            }
        }
        self.seats.iter_mut().for_each(|seat| seat.former.clear());
        self.resumed.clear();
        // The first call after a new listener connects to it, which allocates, so it must not be in a tick.
        if let Some((giver, _)) = &self.ports {
            giver.wake();
        }
        Ok(())
    }

    fn boards_that(&self, are_so: impl Fn(&Seat) -> bool) -> Vec<Board> {
        self.seats.iter().filter(|seat| are_so(seat)).map(|seat| seat.board).collect()
    }

    fn look_for(&mut self, at: usize) -> Result<bool, SplitError> {
        let (Some((_, node)), Some(seat)) = (&mut self.ports, self.seats.get_mut(at)) else {
            return Ok(false);
        };
        let board = seat.board;
        if let Some(status) = seat.ended() {
            return Err(SplitError::Ended { board, status });
        }
        if seat.ports.is_none() {
            let epoch = self.pulse.epochs[board.index()];
            // If the services do not exist, the board has not joined yet.
            let Ok(reports) = ReportReader::open(node, board, epoch) else { return Ok(false) };
            let Ok(readers) = Readers::open(node, board, epoch) else { return Ok(false) };
            seat.ports = Some((readers, reports));
        }
        let Some((_, reports)) = &seat.ports else { return Ok(false) };
        let had_come = seat.has_come();
        let Ok((_, report)) = reports.read() else { return Ok(false) };
        seat.report = report;
        if seat.has_come()
            && let Some(difference) = report.fingerprint.difference(&self.fingerprint)
        {
            return Err(SplitError::Different { board, pid: report.pid, difference });
        }
        Ok(seat.has_come() && !had_come)
    }

    /// Before all boards have joined: if the process of a board has ended, another process can join as this board.
    fn drop_dead_members(&mut self, at: usize) -> Option<BoardEvent> {
        let seat = self.seats.get(at)?;
        let came = seat.child.is_none() && seat.ports.is_some();
        if !came || runs::has_living(&self.name, seat.board.name()) {
            return None;
        }
        let event = BoardEvent::Left { board: seat.board, pid: seat.report.pid };
        self.free_seat(at);
        Some(event)
    }

    /// Wait for a process that replaces a lost board; it joins with the next epoch. Then run the tick again on the same
    /// inputs: boards that have stamped it take no further step, and the new one restarts its processes on the last
    /// outputs of the lost one.
    pub fn await_successor(
        &mut self,
        lost: &Lost,
        wait_limit: Duration,
        stop: &AtomicBool,
        heard: impl FnMut(BoardEvent, &[Board]),
    ) -> Result<(), SplitError> {
        self.free_seat(lost.board.index());
        self.gather(wait_limit, stop, heard)
    }

    fn free_seat(&mut self, at: usize) {
        let (Some((giver, _)), Some(seat)) = (&mut self.ports, self.seats.get_mut(at)) else { return };
        // Kept until the successor has read the last outputs to the devices from them.
        seat.former.extend(seat.ports.take());
        seat.former_allocations += seat.report.allocations;
        seat.report = BoardReport::ZERO;
        self.pulse.epochs[seat.board.index()] += 1;
        giver.give(&self.pulse);
    }

    #[must_use]
    pub const fn states(&self) -> &LadderState {
        &self.states
    }

    pub fn figures(&self) -> impl Iterator<Item = BoardFigures<'_>> {
        self.seats.iter().map(|seat| BoardFigures {
            board: seat.board,
            pid: seat.report.pid,
            allocations: seat.allocations(),
            times: &seat.times,
            punctual: seat.report.punctual,
        })
    }

    #[must_use]
    pub const fn epochs(&self) -> &Epochs {
        &self.pulse.epochs
    }

    /// Announce a load, whose file exists, to the boards, which check it in parallel with their ticks.
    pub fn announce(&mut self, load: u32) {
        self.pulse.load = load;
        if let Some((giver, _)) = &mut self.ports {
            giver.give(&self.pulse);
        }
    }

    /// True if all boards have checked the load and have these task data. Errors: the board that has others.
    pub fn have_checked(&mut self, load: u32, data: u64) -> Result<bool, Board> {
        let mut all = true;
        for seat in &mut self.seats {
            // If a report cannot be read, the wait for the next stamp detects it.
            if let Some((_, reports)) = &seat.ports
                && let Ok((_, report)) = reports.read()
            {
                seat.report = report;
            }
            let Checked { load: checked, data: found } = seat.report.checked;
            if checked == load && found != data {
                return Err(seat.board);
            }
            all &= checked == load;
        }
        Ok(all)
    }

    pub const fn commit(&mut self, load: u32) {
        self.pulse.loaded = load;
    }

    /// Wait until all boards have stamped the tick, or one is lost.
    fn await_stamps(&mut self, tick: Tick) -> Result<(), Lost> {
        let Some((giver, _)) = &self.ports else { return Ok(()) };
        let mut waited = Duration::ZERO;
        loop {
            let mut late = None;
            for (at, seat) in self.seats.iter_mut().enumerate() {
                if !seat.has_stamped(tick)? {
                    late = Some(at);
                }
            }
            let Some(seat) = late.and_then(|at| self.seats.get_mut(at)) else { return Ok(()) };
            let started = Instant::now();
            sleep(&giver.done, LOOK);
            // Do not count time in which this process itself was stopped.
            waited += started.elapsed().min(2 * LOOK);
            if started.elapsed() < LOOK {
                continue;
            }
            if let Some(status) = seat.ended() {
                return Err(seat.lost(tick, LossReason::Ended(status)));
            }
            if waited >= LOST_AFTER {
                return Err(seat.lost(tick, LossReason::Silent));
            }
            giver.wake();
        }
    }

    fn collect(&mut self, tick: Tick, after: &mut CommonMemory) -> Result<(), Lost> {
        for seat in &mut self.seats {
            seat.times.add(seat.report.step_ns);
            let Some((readers, _)) = &seat.ports else { continue };
            let garbled = |error| seat.lost(tick, LossReason::Garbled(error));
            if !readers.outputs(tick, after).map_err(garbled)? {
                return Err(seat.lost(tick, LossReason::Unwritten));
            }
            readers.states(tick, &mut self.states).map_err(garbled)?;
        }
        self.states.buttons = self.pulse.external.devices.joystick.single_step;
        Ok(())
    }

    fn reap(&mut self) {
        let deadline = Instant::now() + CLOSING_LIMIT;
        for child in self.seats.iter_mut().filter_map(|seat| seat.child.as_mut()) {
            while Instant::now() < deadline && matches!(child.try_wait(), Ok(None)) {
                std::thread::sleep(Duration::from_millis(2));
            }
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

impl Levels<TaskData<'_>> for Coordinator {
    type Error = Lost;

    /// The task data are those of the boards; they change to a new generation with the pulse that names it.
    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        _: &TaskData<'_>,
        after: &mut CommonMemory,
        _: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Lost> {
        *after = *before;
        self.pulse = SystemPulse { tick, external: *external, ..self.pulse };
        if let Some((giver, _)) = &mut self.ports {
            giver.give(&self.pulse);
        }
        self.await_stamps(tick)?;
        self.collect(tick, after)
    }

    fn allocations(&self) -> u64 {
        self.seats.iter().map(Seat::allocations).sum()
    }
}

impl Drop for Coordinator {
    fn drop(&mut self) {
        if let Some((giver, _)) = &mut self.ports {
            giver.give(&SystemPulse { over: true, ..self.pulse });
        }
        self.reap();
        self.seats.clear();
        self.resumed.clear();
        drop(self.ports.take());
        // Boards that were started by hand keep the files until they have left; the last process to leave removes them.
        let _ = runs::remove_if_deserted(&self.name, &memory::layout());
    }
}
