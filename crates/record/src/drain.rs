//! The writer's end of the rings, in a separate thread.

use std::{
    mem,
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::Duration,
};

use levels::ladder::LadderState;
use rcs_core::tick::Tick;
use rtrb::Consumer;

use crate::{
    error::RecordError,
    file::LogFile,
    input::{Attachment, CellFrame, End, Lost, Note, Setup, Shown},
    names::CONTINUES,
    operator::OperatorLine,
    remarks::Remark,
    rotation::LogLimit,
    sink::Sink,
    writer::{FULL_SET, LogWriter, TickRecord, Written},
};

const IDLE: Duration = Duration::from_millis(5); // sleep of an idle writer: an eighth of a tick

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned()
}

pub(crate) struct Rotation {
    pub(crate) limit: LogLimit,
    /// Head of each log, with the files that were added to the run.
    pub(crate) setup: Setup,
    pub(crate) durable: bool,
    pub(crate) count: usize,
}

pub(crate) struct Drain {
    pub(crate) log: LogWriter<Sink>,
    pub(crate) file: LogFile,
    pub(crate) rotation: Option<Rotation>,
    pub(crate) ticks: Consumer<TickRecord>,
    pub(crate) states: Consumer<(Tick, LadderState)>,
    pub(crate) cells: Consumer<CellFrame>,
    pub(crate) notes: Consumer<Note>,
    pub(crate) files: Consumer<(Tick, Attachment)>,
    pub(crate) operators: Consumer<OperatorLine>,
    pub(crate) shown: Consumer<(Tick, Shown)>,
    pub(crate) end: Arc<Mutex<(End, Lost)>>,
}

impl Drain {
    /// Write until the run has ended. Returns the last log, and the number of earlier ones.
    pub(crate) fn run(mut self) -> Result<(Written, usize), RecordError> {
        loop {
            // The flag is read before the ring is emptied, so that all entries before the end of the run are found.
            let ended = self.ticks.is_abandoned();
            while let Ok(record) = self.ticks.pop() {
                if record.tick.0.is_multiple_of(FULL_SET) {
                    self.file.look()?;
                }
                self.write(&record)?;
            }
            if ended {
                break;
            }
            thread::sleep(IDLE);
        }
        self.write_files(Tick(u64::MAX))?;
        self.write_shown(Tick(u64::MAX))?;
        self.write_notes(Tick(u64::MAX))?;
        self.write_operators(Tick(u64::MAX))?;
        let (end, lost) = self.end.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let written = self.log.finish(&end, lost)?;
        self.file.look()?;
        Ok((written, self.rotation.map_or(0, |rotation| rotation.count)))
    }

    /// End a log that has reached its size, and begin the next log with this tick and its states.
    fn rotate(&mut self, record: &TickRecord) -> Result<TickRecord, RecordError> {
        let Some(rotation) = &mut self.rotation else { return Ok(*record) };
        if !self.log.has_ticks() || self.file.length()? < rotation.limit.bytes {
            return Ok(*record);
        }
        let (mut file, name) = self.file.succeeded()?;
        let sink = Sink::new(file.emptied()?, rotation.durable);
        let mut next = LogWriter::create_with(sink, rotation.setup.clone(), None)?;
        next.continue_run(&mut self.log, name.file_name().unwrap_or_default().to_string_lossy().into_owned());
        let end = End { result: format!("{CONTINUES}{} in another log", record.tick), ..End::default() };
        mem::replace(&mut self.log, next).finish(&end, Lost::default())?;
        self.file = file;
        rotation.count += 1;
        let removed = rotation.limit.remove_oldest(self.file.path());
        removed.map_err(|source| RecordError::Create { path: self.file.path().to_owned(), source })?;
        let before = record.tick.0.saturating_sub(1);
        Ok(TickRecord { gap: u32::try_from(before).unwrap_or(u32::MAX), ..*record })
    }

    fn write(&mut self, record: &TickRecord) -> Result<(), RecordError> {
        let state = latest(&mut self.states, record.tick, |(tick, _)| *tick).map(|(_, state)| state);
        let record = if state.is_some() { &self.rotate(record)? } else { record };
        self.write_notes(record.tick)?;
        self.write_operators(record.tick)?;
        self.write_files(record.tick)?;
        self.write_shown(record.tick)?;
        let cell = latest(&mut self.cells, record.tick, |frame| frame.tick);
        self.log.tick(record, state.as_ref(), cell.as_ref())?;
        Ok(())
    }

    fn write_files(&mut self, until: Tick) -> Result<(), RecordError> {
        while self.files.peek().is_ok_and(|(tick, _)| *tick <= until) {
            if let Ok((tick, attachment)) = self.files.pop() {
                if let Some(rotation) = &mut self.rotation {
                    rotation.setup.attachments.push(attachment.clone());
                }
                self.log.attach(tick, attachment)?;
            }
        }
        Ok(())
    }

    fn write_shown(&mut self, until: Tick) -> Result<(), RecordError> {
        while self.shown.peek().is_ok_and(|(tick, _)| *tick <= until) {
            if let Ok((tick, shown)) = self.shown.pop() {
                self.log.show(tick, &shown)?;
            }
        }
        Ok(())
    }

    fn write_operators(&mut self, until: Tick) -> Result<(), RecordError> {
        while self.operators.peek().is_ok_and(|line| line.tick <= until) {
            if let Ok(line) = self.operators.pop() {
                self.log.operator(&line)?;
            }
        }
        Ok(())
    }

    fn write_notes(&mut self, until: Tick) -> Result<(), RecordError> {
        while self.notes.peek().is_ok_and(|note| note.tick <= until) {
            if let Ok(Note { tick, level, source, code, text }) = self.notes.pop() {
                let (source, text) = (text_of(&source), text_of(&text));
                let remark = Remark { level, source, text, file: code, line: 0 };
                self.log.remark(tick, &remark)?;
            }
        }
        Ok(())
    }
}

fn latest<T>(ring: &mut Consumer<T>, tick: Tick, tick_of: impl Fn(&T) -> Tick) -> Option<T> {
    while ring.peek().is_ok_and(|entry| tick_of(entry) < tick) {
        let _ = ring.pop();
    }
    ring.peek().is_ok_and(|entry| tick_of(entry) == tick).then(|| ring.pop().ok()).flatten()
}
