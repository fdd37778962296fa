//! The journal of a run: what a controller knows, on the disk, for a start after a loss of power
//! (docs/design/resume.md).
//!
//! ```text
//!  tick ──newest entry──> slot in memory ──> writer thread ──> one of eight slots in the file, fdatasync
//! ```
//!
//! The tick replaces the entry that the thread has not taken, so it never waits and nothing queues up. An entry is due
//! when the knowledge changes, and once per second. The file has its full length from the beginning, so a full disk
//! does not affect it. After a failed write the next entry is tried, and [`Journal::trouble`] reports it; the run
//! continues.

mod described;
mod doubt;
mod format;
mod kept;
mod logged;
mod witness;

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io,
    os::unix::fs::{FileExt as _, MetadataExt as _},
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError as Busy},
    thread::{self, JoinHandle},
};

use interfaces::CommonMemory;
use os_io::{files, replace};
use rcs_core::tick::Tick;

pub use self::{
    described::compared,
    doubt::{DOUBT, Estimate, Evidence, Fate, RunEnd, asks_for_line, doubt, doubted},
    format::{
        Contents, Entry, FIRST, FormatError, Identity, LOG, MAGIC, PROGRAM, SLOT, SLOTS, begun, cell, fill,
        length, note_at, place, read, read_cell,
    },
    kept::{kept, knowledge, resumed},
    logged::{LoggedError, is_log, logged},
    witness::{Witnesses, judged},
};

pub const HEARTBEAT: u64 = 25; // ticks after which an entry is due although nothing has changed: one second

/// Time within which the disk must store an entry, ms of the entries' clock. In fast clock the run does not wait.
const LATE: u64 = 5_000;

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JournalError {
    #[error("the journal {} cannot be created: {source}", path.display())]
    Create { path: PathBuf, source: io::Error },
    #[error("the journal {} cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("the journal {} is being written by another run: name another file with --journal", path.display())]
    InUse { path: PathBuf },
    #[error("{} is not a journal and was not changed: name another file with --journal", path.display())]
    OtherFile { path: PathBuf },
    #[error("the journal {} cannot be used: {source}", path.display())]
    Format { path: PathBuf, source: FormatError },
    #[error("the thread that writes the journal cannot be started: {0}")]
    Thread(io::Error),
}

pub fn open(path: &Path) -> Result<Contents, JournalError> {
    let limit = u64::try_from(length()).unwrap_or(u64::MAX).saturating_mul(2);
    let bytes =
        files::read(path, limit).map_err(|source| JournalError::Read { path: path.to_owned(), source })?;
    read(&bytes).map_err(|source| JournalError::Format { path: path.to_owned(), source })
}

pub struct Journal {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    path: PathBuf,
    last: Box<(Entry, CommonMemory)>, // the last entry that was handed over, and the knowledge in it
    has_last: bool,
    reported: Option<String>, // the last trouble that was reported
}

struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

struct State {
    entry: Box<Entry>,
    is_new: bool,       // the entry has not been taken by the thread
    since: (Tick, u64), // the oldest entry that the thread has not taken: its tick and its time
    is_over: bool,
    cell: Option<Vec<u8>>,   // a saved cell that the thread has not taken
    trouble: Option<String>, // why the last entry is not on the disk
}

impl Journal {
    /// Begin a journal, with `first` as its first entry. An earlier one at this path is replaced as a whole. If its
    /// run has not ended, and `first` does not continue it, or if it cannot be read, it is kept under another name
    /// ([`kept_before`]). Fails if the file belongs to another run, is no journal, or cannot be created.
    pub fn start(path: &Path, identity: &Identity, first: Option<&Entry>) -> Result<Self, JournalError> {
        let failed = |source| JournalError::Create { path: path.to_owned(), source };
        if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
            fs::create_dir_all(directory).map_err(failed)?;
        }
        // The lock of the earlier file is held until the new one is in its place.
        let _earlier = claim(path)?;
        let (bytes, of_head) = begun(identity, first);
        set_aside(path, first.is_some()).map_err(failed)?;
        replace::replace(path, &bytes).map_err(failed)?;
        let file = OpenOptions::new().write(true).open(path).map_err(failed)?;
        lock(&file, path)?;
        let state = State {
            entry: Box::default(),
            is_new: false,
            since: (Tick::BEFORE_START, 0),
            is_over: false,
            cell: None,
            trouble: None,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), wake: Condvar::new() });
        let metadata = file.metadata().map_err(failed)?;
        let writer = Writer {
            file,
            path: path.to_owned(),
            identity: (metadata.dev(), metadata.ino()),
            of_head,
            sequence: if first.is_some() { FIRST } else { 0 },
            slot: vec![0; SLOT],
            has_note: false,
        };
        let of_thread = Arc::clone(&shared);
        let thread = thread::Builder::new()
            .name("journal".into())
            .spawn(move || writer.run(&of_thread))
            .map_err(JournalError::Thread)?;
        Ok(Self {
            shared,
            thread: Some(thread),
            path: path.to_owned(),
            last: Box::default(),
            has_last: false,
            reported: None,
        })
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Hand over the knowledge after a tick if it has changed, or if an entry is due. Neither waits nor
    /// allocates. If the thread is taking an entry at this moment, the next call hands over the newer one.
    pub fn tick(&mut self, entry: &Entry) {
        let known = knowledge(&entry.memory);
        let (before, known_before) = &*self.last;
        let is_due = !self.has_last
            || entry.tick.since(before.tick) >= HEARTBEAT
            || entry.beside() != before.beside()
            || known != *known_before;
        if !is_due {
            return;
        }
        let mut state = match self.shared.state.try_lock() {
            Ok(state) => state,
            Err(Busy::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(Busy::WouldBlock) => return,
        };
        if !state.is_new {
            state.since = (entry.tick, entry.written);
        }
        (*state.entry, state.is_new) = (*entry, true);
        drop(state);
        self.shared.wake.notify_one();
        (*self.last, self.has_last) = ((*entry, known), true);
    }

    /// Hand over the simulated cell after the tick of an entry, as of [`cell()`], for the file beside the journal.
    pub fn save_cell(&mut self, bytes: Vec<u8>) {
        if let Ok(mut state) = self.shared.state.try_lock() {
            state.cell = Some(bytes);
            drop(state);
            self.shared.wake.notify_one();
        }
    }

    /// Returns each change of the trouble once, and `Some(None)` at its end. Call it between two ticks.
    pub fn trouble(&mut self) -> Option<Option<String>> {
        let Ok(state) = self.shared.state.try_lock() else { return None };
        let (tick, written) = state.since;
        let waits = if state.is_new { state.entry.written.saturating_sub(written) } else { 0 };
        let trouble = match waits {
            0..=LATE => state.trouble.clone(),
            _ => Some(format!("the disk has taken no entry since tick {tick}")),
        };
        drop(state);
        let is_news = trouble != self.reported;
        self.reported.clone_from(&trouble);
        is_news.then_some(trouble)
    }

    /// Write the last entry, and end the journal. Returns the trouble at its end, if any.
    #[must_use]
    pub fn finish(mut self, entry: Option<&Entry>) -> Option<String> {
        let mut state = locked(&self.shared);
        if let Some(entry) = entry {
            (*state.entry, state.is_new) = (*entry, true);
        }
        drop(state);
        self.end();
        locked(&self.shared).trouble.clone()
    }

    fn end(&mut self) {
        locked(&self.shared).is_over = true;
        self.shared.wake.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that has panicked has written all complete entries.
            let _ = thread.join();
        }
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        self.end();
    }
}

/// The file with the saved cell, beside a journal.
#[must_use]
pub fn cell_beside(path: &Path) -> PathBuf {
    path.with_added_extension("cell")
}

/// The earlier journal at a path, kept if its run has not ended.
#[must_use]
pub fn kept_before(path: &Path) -> PathBuf {
    path.with_added_extension("before")
}

/// Keep an earlier journal from which a run can be resumed, with its cell. Otherwise remove the cell. A run that is
/// resumed keeps only a journal that cannot be read.
fn set_aside(path: &Path, is_resumed: bool) -> io::Result<()> {
    let found = |result: io::Result<()>| match result {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    };
    if is_resumed {
        return match open(path) {
            Err(JournalError::Format { .. }) => fs::rename(path, kept_before(path)),
            _ => Ok(()),
        };
    }
    if open(path).is_ok_and(|contents| !contents.newest.over) {
        let before = kept_before(path);
        found(fs::rename(cell_beside(path), cell_beside(&before)))?;
        return fs::rename(path, before);
    }
    found(fs::remove_file(cell_beside(path)))
}

fn locked(shared: &Shared) -> MutexGuard<'_, State> {
    shared.state.lock().unwrap_or_else(PoisonError::into_inner)
}

fn claim(path: &Path) -> Result<Option<File>, JournalError> {
    let file = match OpenOptions::new().read(true).write(true).open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(JournalError::Create { path: path.to_owned(), source }),
    };
    let mut start = [0; MAGIC.len()];
    let length = file.metadata().map_or(0, |found| found.len());
    if length > 0 && (file.read_exact_at(&mut start, 0).is_err() || start != MAGIC) {
        return Err(JournalError::OtherFile { path: path.to_owned() });
    }
    lock(&file, path)?;
    Ok(Some(file))
}

fn lock(file: &File, path: &Path) -> Result<(), JournalError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(JournalError::InUse { path: path.to_owned() }),
        Err(TryLockError::Error(source)) => Err(JournalError::Create { path: path.to_owned(), source }),
    }
}

struct Writer {
    file: File,
    path: PathBuf,
    identity: (u64, u64),
    of_head: u64,
    sequence: u64, // number of the last entry on the disk
    slot: Vec<u8>,
    has_note: bool, // the journal notes that an entry was not accepted
}

impl Writer {
    fn run(mut self, shared: &Shared) {
        let mut state = locked(shared);
        loop {
            while !state.is_new && state.cell.is_none() && !state.is_over {
                state = shared.wake.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            let (is_new, cell) = (std::mem::take(&mut state.is_new), state.cell.take());
            if !is_new && cell.is_none() {
                return;
            }
            if is_new {
                self.slot.fill(0);
                fill(&mut self.slot, self.of_head, self.sequence.saturating_add(1), &state.entry);
            }
            let tick = state.entry.tick;
            drop(state);
            let written = if is_new { self.write() } else { Ok(()) };
            if is_new {
                self.note(tick, written.is_ok());
            }
            let saved = cell.map_or(Ok(()), |cell| replace::replace(&cell_beside(&self.path), &cell));
            let trouble = written.and(saved).err().map(|error| error.to_string());
            state = locked(shared);
            // A saved cell alone does not show that the disk accepts entries.
            if is_new || trouble.is_some() {
                state.trouble = trouble;
            }
        }
    }

    /// Note the first entry that the disk does not accept; withdraw the note after an accepted one. A disk that accepts
    /// neither keeps no trace of it.
    fn note(&mut self, tick: Tick, accepted: bool) {
        if self.has_note == accepted {
            let note = if accepted { [0; 8] } else { format::note(tick) };
            let at = u64::try_from(note_at()).unwrap_or(u64::MAX);
            let noted = self.file.write_all_at(&note, at).and_then(|()| self.file.sync_data());
            self.has_note = if noted.is_ok() { !accepted } else { self.has_note };
        }
    }

    /// Write the slot. After a failed write the next entry uses the same slot, so the earlier entries stay.
    fn write(&mut self) -> io::Result<()> {
        match fs::metadata(&self.path) {
            Ok(found) if (found.dev(), found.ino()) == self.identity => {}
            _ => return Err(io::Error::other(format!("{} was removed during the run", self.path.display()))),
        }
        let next = self.sequence.saturating_add(1);
        self.file.write_all_at(&self.slot, u64::try_from(place(next)).unwrap_or(u64::MAX))?;
        self.file.sync_data()?;
        self.sequence = next;
        Ok(())
    }
}

impl Entry {
    /// The knowledge that is not in the buffers.
    fn beside(&self) -> impl PartialEq + use<> {
        let Self { over, line, begun, delayed, asks_line, generation, hws, .. } = *self;
        (over, line, begun, delayed, asks_line, generation, hws)
    }

    /// True if another entry has the same knowledge.
    fn knows_as(&self, other: &Self) -> bool {
        self.beside() == other.beside() && knowledge(&self.memory) == knowledge(&other.memory)
    }

    /// The time of the entry for a person: its tick, and its age if it was written in real time.
    #[must_use]
    pub fn age(&self, now: u64) -> String {
        match self.written {
            0 => format!("tick {}", self.tick),
            written => format!("tick {}, {} s ago", self.tick, now.saturating_sub(written) / 1000),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(tick: u64) -> Entry {
        Entry { tick: Tick(tick), ..Entry::default() }
    }

    fn started(first: Option<&Entry>) -> (tempfile::TempDir, PathBuf, Journal) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run.journal");
        let journal = Journal::start(&path, &Identity::new(), first).unwrap();
        (directory, path, journal)
    }

    #[test]
    fn entry_is_due_on_change_and_once_per_second() {
        let (_directory, path, mut journal) = started(None);
        let due = |journal: &Journal| journal.has_last.then_some(journal.last.0.tick.0);
        // If the thread is taking the previous entry, the next tick hands over a newer one.
        let mut hand_over = |from: u64, change: fn(&mut Entry)| {
            (from..).take(5).find(|tick| {
                let mut entry = entry(*tick);
                change(&mut entry);
                journal.tick(&entry);
                due(&journal) == Some(*tick)
            })
        };
        let first = hand_over(1, |_| {}).expect("the first entry is due");
        assert_eq!(hand_over(first + 1, |_| {}), None, "nothing has changed");
        let second = hand_over(first + HEARTBEAT, |_| {}).expect("a second is over");
        let third = hand_over(second + 1, |entry| entry.memory.emove.estimates.empty = true);
        let third = third.expect("an estimate has changed");
        assert_eq!(journal.finish(None), None);
        let read = open(&path).unwrap().newest;
        assert!(read.tick.0 == third && read.memory.emove.estimates.empty);
    }

    #[test]
    fn last_entry_is_on_the_disk_at_the_end() {
        for last in [1, 2, 9, 40] {
            let (_directory, path, mut journal) = started(None);
            for tick in 1..=last {
                journal.tick(&Entry { line: u32::try_from(tick).unwrap(), ..entry(tick) });
            }
            assert_eq!(journal.finish(Some(&Entry { over: true, ..entry(last) })), None);
            let read = open(&path).unwrap();
            assert!(read.newest.tick == Tick(last) && read.newest.over && read.end == RunEnd::Reached);
        }
    }

    #[test]
    fn resumed_journal_has_its_first_entry_from_the_beginning() {
        let (_directory, path, journal) = started(Some(&entry(70)));
        assert_eq!(open(&path).unwrap().newest, entry(70));
        assert_eq!(journal.finish(None), None);
        assert_eq!(open(&path).unwrap().newest, entry(70));
    }

    #[test]
    fn journal_of_an_interrupted_run_is_not_overwritten() {
        let (_directory, path, journal) = started(Some(&entry(70)));
        assert_eq!(journal.finish(None), None);
        fs::write(cell_beside(&path), "a cell").unwrap();
        drop(Journal::start(&path, &Identity::new(), None).unwrap());
        let before = kept_before(&path);
        assert_eq!(open(&before).unwrap().newest, entry(70));
        assert!(cell_beside(&before).exists() && !cell_beside(&path).exists());
    }

    #[test]
    fn removed_file_is_reported_and_does_not_stop_the_run() {
        let (_directory, path, mut journal) = started(None);
        fs::remove_file(&path).unwrap();
        for tick in 1..=3 {
            journal.tick(&entry(tick * HEARTBEAT));
        }
        let trouble = journal.finish(Some(&entry(200))).expect("the file is gone");
        assert!(trouble.contains("was removed during the run"), "{trouble}");
    }

    #[test]
    fn saved_cell_does_not_end_the_trouble_of_entries() {
        let (_directory, path, mut journal) = started(None);
        fs::remove_file(&path).unwrap();
        journal.tick(&entry(HEARTBEAT));
        let soon = |is_over: &mut dyn FnMut() -> bool| {
            (0..10_000).any(|_| {
                thread::sleep(std::time::Duration::from_millis(1));
                is_over()
            })
        };
        assert!(soon(&mut || journal.trouble().is_some()), "the entry is not written");
        assert!(soon(&mut || {
            journal.save_cell(b"a cell".to_vec());
            cell_beside(&path).exists()
        }));
        assert!(journal.finish(None).is_some());
    }

    #[test]
    fn unreadable_journal_of_a_resumed_run_is_kept() {
        let (_directory, path, journal) = started(Some(&entry(70)));
        assert_eq!(journal.finish(None), None);
        let mut bytes = fs::read(&path).unwrap();
        bytes[100] ^= 1;
        fs::write(&path, &bytes).unwrap();
        drop(Journal::start(&path, &Identity::new(), Some(&entry(60))).unwrap());
        assert_eq!(open(&path).unwrap().newest, entry(60));
        assert_eq!(fs::read(kept_before(&path)).unwrap(), bytes);
    }

    #[test]
    fn entry_that_is_not_accepted_is_noted_until_the_next_one_is() {
        let (_directory, path, journal) = started(Some(&entry(70)));
        assert_eq!(journal.finish(None), None);
        let file = OpenOptions::new().write(true).open(&path).unwrap();
        let (_, of_head) = begun(&Identity::new(), None);
        let mut writer = Writer {
            file,
            path: path.clone(),
            identity: (0, 0),
            of_head,
            sequence: FIRST,
            slot: vec![0; SLOT],
            has_note: false,
        };
        // The file is another one than the writer expects, so the entry is not written.
        let accepted = writer.write().is_ok();
        writer.note(Tick(71), accepted);
        assert_eq!(
            open(&path).map(|read| (read.newest.tick, read.end)).unwrap(),
            (Tick(70), RunEnd::Trouble)
        );
        writer.note(Tick(72), true);
        assert_eq!(open(&path).unwrap().end, RunEnd::Reached);
    }

    #[test]
    fn journal_of_a_living_run_and_other_files_are_refused() {
        let (directory, path, journal) = started(None);
        let again = Journal::start(&path, &Identity::new(), None);
        assert!(matches!(again, Err(JournalError::InUse { .. })));
        assert_eq!(journal.finish(None), None);
        assert!(Journal::start(&path, &Identity::new(), None).is_ok());
        let text = directory.path().join("notes.txt");
        fs::write(&text, "do not lose this").unwrap();
        let refused = Journal::start(&text, &Identity::new(), None);
        assert!(matches!(refused, Err(JournalError::OtherFile { .. })));
        assert_eq!(fs::read_to_string(&text).unwrap(), "do not lose this");
    }
}
