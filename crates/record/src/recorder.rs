//! The run's side of the log: a bounded ring buffer, and a thread that writes its entries into the file.
//!
//! In a tick the recorder copies three records into memory that was allocated before the first tick. In a real-time run
//! the recorder never waits: if the ring is full, it counts the tick as lost. In fast clock it waits instead. The
//! writer thread ends at the first error, which [`Recorder::finish`] returns: a full disk ends the log, never the run.
//! Start a recorder before the real-time requests, because the writer inherits the priority.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    thread::{self, JoinHandle},
    time::Duration,
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::LadderState;
use rcs_core::tick::Tick;
use rtrb::{Consumer, Producer, RingBuffer};

use crate::{
    drain::{Drain, Rotation},
    error::RecordError,
    file::LogFile,
    input::{Attachment, CellFrame, End, Lost, NOTE, Note, Setup, Shown},
    operator::OperatorLine,
    proto::foxglove::Level,
    rotation::LogLimit,
    sink::Sink,
    tap::Tap,
    writer::{FULL_SET, LogWriter, TickRecord, Timing, Written},
};

/// Capacity in ticks: 40 s of real time. With the cell at rest, the writer is slower than a run in fast clock.
const RING: usize = 1024;
const STATE_RING: usize = 64; // capacity of the ring of states, which are written once per second
const NOTE_RING: usize = 1024;
const FULL: Duration = Duration::from_micros(100); // sleep of a run in fast clock when the ring is full
const FILE_RING: usize = 64;
/// Capacity of the ring of camera pictures, lists of contacts and states of the run: on average one per tick.
const SHOWN_RING: usize = RING;
const OPERATOR_RING: usize = 256; // capacity of the ring of operators' lines

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// For runs in fast clock: the run waits.
    Wait,
    /// For runs in real time: the tick is counted, but not recorded.
    Drop,
}

/// The longest beginning of a text that fits, without splitting a character.
fn clipped<const N: usize>(text: &str) -> [u8; N] {
    let mut end = text.len().min(N);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let mut bytes = [0; N];
    bytes.iter_mut().zip(text.bytes().take(end)).for_each(|(slot, byte)| *slot = byte);
    bytes
}

pub struct Recorder {
    ticks: Producer<TickRecord>,
    states: Producer<(Tick, LadderState)>,
    cells: Producer<CellFrame>,
    notes: Producer<Note>,
    files: Producer<(Tick, Attachment)>,
    operators: Producer<OperatorLine>,
    shown: Producer<(Tick, Shown)>,
    pace: Pace,
    last_state: Option<Tick>,
    timing: Option<Timing>,
    gap: u32,
    lost: Lost,
    path: PathBuf,
    end: Arc<Mutex<(End, Lost)>>,
    thread: JoinHandle<Result<(Written, usize), RecordError>>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    pub path: PathBuf,
    pub ticks: u64, // in the file
    pub lost: Lost,
    pub bytes: u64, // size of the file, bytes
    /// Number of logs of this run that ended earlier because of their size.
    pub earlier: usize,
}

impl Recorder {
    /// Claim a file, creating its directory if necessary, and start the writer.
    pub fn start(path: &Path, pace: Pace, setup: Setup) -> Result<Self, RecordError> {
        Self::start_in(LogFile::claim(path)?, pace, setup, None, None)
    }

    /// Empty the file and start the writer. A tap receives the same messages as the file. With a limit, the run writes
    /// several logs, one after the other.
    pub fn start_in(
        mut file: LogFile,
        pace: Pace,
        setup: Setup,
        tap: Option<Box<dyn Tap>>,
        limit: Option<LogLimit>,
    ) -> Result<Self, RecordError> {
        if let Some(cell) = &setup.cell {
            cell.check()?;
        }
        let path = file.path().to_owned();
        let emptied = file.emptied()?;
        let durable = pace == Pace::Drop;
        let rotation = limit.map(|limit| Rotation { limit, setup: setup.clone(), durable, count: 0 });
        let log =
            LogWriter::create_with(Sink::new(emptied, durable), setup, tap).map_err(RecordError::Begin)?;
        let tick = Tick::BEFORE_START;
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        let (ticks, tick_consumer) = ring(RING, TickRecord { tick, gap: 0, external, memory, timing: None });
        let (states, state_consumer) = ring(STATE_RING, (tick, LadderState::default()));
        let (cells, cell_consumer) = ring(RING, CellFrame::new(tick));
        let note = Note { tick, level: Level::Info, source: [0; 16], code: "", text: [0; NOTE] };
        let (notes, note_consumer) = ring(NOTE_RING, note);
        let (files, file_consumer) = RingBuffer::new(FILE_RING);
        let (operators, operator_consumer) = RingBuffer::new(OPERATOR_RING);
        let (shown, shown_consumer) = RingBuffer::new(SHOWN_RING);
        let end = Arc::default();
        let drain = Drain {
            log,
            file,
            rotation,
            ticks: tick_consumer,
            states: state_consumer,
            cells: cell_consumer,
            notes: note_consumer,
            files: file_consumer,
            operators: operator_consumer,
            shown: shown_consumer,
            end: Arc::clone(&end),
        };
        let thread = thread::Builder::new()
            .name("log".into())
            .spawn(move || drain.run())
            .map_err(|_| RecordError::Thread)?;
        Ok(Self {
            ticks,
            states,
            cells,
            notes,
            files,
            operators,
            shown,
            pace,
            last_state: None,
            timing: None,
            gap: 0,
            lost: Lost::default(),
            path,
            end,
            thread,
        })
    }

    /// Record the cell. Call it before [`Recorder::tick`] of the same tick.
    pub fn cell(&mut self, frame: &CellFrame) {
        if !has_room(&self.cells, self.pace) || self.cells.push(*frame).is_err() {
            self.lost.frames += 1;
        }
    }

    /// Record a line for `/log`, before [`Recorder::tick`] of the same tick. It must not wait for room: the writer
    /// reads a note only when it reaches the note's tick.
    pub fn note(&mut self, tick: Tick, level: Level, source: &str, code: &'static str, text: &str) {
        let note = Note { tick, level, source: clipped(source), code, text: clipped(text) };
        if !has_room(&self.notes, Pace::Drop) || self.notes.push(note).is_err() {
            self.lost.notes += 1;
        }
    }

    /// Record a file of the run, before [`Recorder::tick`] of the tick from which it is valid.
    pub fn attach(&mut self, tick: Tick, attachment: Attachment) {
        if !has_room(&self.files, self.pace) || self.files.push((tick, attachment)).is_err() {
            self.lost.files += 1;
        }
    }

    /// Record data for viewers. Call it before [`Recorder::tick`] of the same tick.
    pub fn show(&mut self, tick: Tick, shown: Shown) {
        if !has_room(&self.shown, Pace::Drop) || self.shown.push((tick, shown)).is_err() {
            self.lost.shown += 1;
        }
    }

    /// Record an operator's request, before [`Recorder::tick`] of the first tick with its effect.
    pub fn operator(&mut self, line: OperatorLine) {
        if !has_room(&self.operators, Pace::Drop) || self.operators.push(line).is_err() {
            self.lost.operators += 1;
        }
    }

    /// Record times of the tick, before [`Recorder::tick`]. A run without them writes the same bytes each time.
    pub const fn timing(&mut self, timing: Timing) {
        self.timing = Some(timing);
    }

    /// Record a tick. `state` is called in the first tick, once per second, and after a gap.
    pub fn tick(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        memory: &CommonMemory,
        state: impl FnOnce() -> LadderState,
    ) {
        if !has_room(&self.ticks, self.pace) {
            self.gap = self.gap.saturating_add(1);
            self.lost.ticks += 1;
            return;
        }
        let due = self.last_state.is_none_or(|last| tick.since(last) >= FULL_SET);
        // The states are pushed first, so that they are in their ring before their tick.
        if (due || self.gap > 0)
            && has_room(&self.states, self.pace)
            && self.states.push((tick, state())).is_ok()
        {
            self.last_state = Some(tick);
        }
        let (gap, timing) = (self.gap, self.timing.take());
        let record = TickRecord { tick, gap, external: *external, memory: *memory, timing };
        if self.ticks.push(record).is_ok() {
            self.gap = 0;
        }
    }

    #[must_use]
    pub const fn lost(&self) -> Lost {
        self.lost
    }

    /// Ticks in the ring. More than a few mean that the system does not schedule the writer.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.ticks.buffer().capacity() - self.ticks.slots()
    }

    /// Wait until everything is written, and end the log. Fails with the error that ended the log before the run.
    pub fn finish(self, end: End) -> Result<Summary, RecordError> {
        let Self {
            ticks, states, cells, notes, files, operators, shown, lost, path, end: slot, thread, ..
        } = self;
        *slot.lock().unwrap_or_else(PoisonError::into_inner) = (end, lost);
        // The writer finishes when the producers are dropped. The ticks are dropped last, because it waits for them.
        drop((states, cells, notes, files, operators, shown));
        drop(ticks);
        let (Written { ticks, bytes }, earlier) = thread.join().map_err(|_| RecordError::Thread)??;
        Ok(Summary { path, ticks, lost, bytes, earlier })
    }
}

/// A ring whose memory is allocated and touched, so that the first ticks cause no page faults.
fn ring<T: Copy>(capacity: usize, sample: T) -> (Producer<T>, Consumer<T>) {
    let (mut producer, mut consumer) = RingBuffer::new(capacity);
    while producer.push(sample).is_ok() {}
    while consumer.pop().is_ok() {}
    (producer, consumer)
}

/// True if a push will succeed. In fast clock this waits for room, unless the writer has ended.
fn has_room<T>(ring: &Producer<T>, pace: Pace) -> bool {
    while ring.is_full() && !ring.is_abandoned() {
        match pace {
            Pace::Drop => return false,
            Pace::Wait => thread::sleep(FULL),
        }
    }
    !ring.is_abandoned()
}
