//! Loads during a run, which are read, checked and announced to the boards in parallel to the ticks.
//!
//! ```text
//!   operator: load ──► thread of the run: reads the block, checks all data with it, writes the file
//!                                │  the number of the file, with the pulse
//!                                ▼
//!                      thread of each board: reads the file, checks all data with it
//!                                │  the fingerprint of its data, in its report
//!                                ▼
//!                      all boards have the same data: the generation is valid from the next tick on
//! ```
//!
//! On one board the middle step is omitted. The threads start before the real-time requests, with ordinary priority.

use std::{
    fs, io,
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{Receiver, Sender, TryRecvError, channel},
    },
    thread,
};

use executive::{
    boards::{BoardData, Checked, Fingerprint},
    memory::{RunName, load_file},
};
use os_io::{files, replace::replace};
use rcs_core::Plain as _;
use taskdata::{
    files::TaskData,
    load::{
        BlockNumber, Diagnostics, Source, Store,
        job::Reload,
        source::{blocks, read_blocks_under},
    },
};

use crate::load::error::LoadError;

/// Read `load OFFSET BLOCK` (IV.2.4); `None` if the words begin something else, such as a line of a job.
#[must_use]
pub fn asked(words: &[&str]) -> Option<Result<BlockNumber, String>> {
    let ["load", offset, block] = words else { return None };
    let numbers = offset.parse().ok().zip(block.parse().ok());
    let expected = || "load OFFSET BLOCK was expected, such as load 21000 610".to_owned();
    Some(numbers.map(|(offset, number)| BlockNumber { offset, number }).ok_or_else(expected))
}

/// Insert a reload after the first `done` reloads, which have led to `base`; later ones are loaded on top of it.
/// Errors: the report of the first reload that now has errors.
pub fn insert(
    base: &Store,
    reloads: &[Reload],
    done: usize,
    source: &Source,
) -> Result<Vec<Reload>, Box<Diagnostics>> {
    let mut all: Vec<Reload> = reloads.iter().take(done).cloned().collect();
    let later = reloads.iter().skip(done).map(|reload| &reload.source);
    for source in std::iter::once(source).chain(later) {
        let newest = all.get(done..).and_then(<[_]>::last).map_or(base, |reload| &reload.store);
        let (store, _) = newest.with_blocks(vec![source.clone()])?;
        all.push(Reload { source: source.clone(), store });
    }
    Ok(all)
}

pub struct Loaded {
    /// All reloads of the run, including this one.
    pub reloads: Vec<Reload>,
    pub done: usize, // reloads before it
    /// [`Fingerprint::data`] of the task data with the block.
    pub data: u64,
}

pub struct Order {
    pub number: BlockNumber,
    /// Text of the block, if it is not from the directory.
    pub source: Option<Source>,
    pub directory: PathBuf,
    pub base: Store,
    pub reloads: Vec<Reload>,
    pub done: usize,
    /// File from which the boards of other processes read the block.
    pub file: Option<PathBuf>,
    /// True if symbolic links must not lead out of the directory.
    pub inside: bool,
}

impl Order {
    /// Read the block, check all data with it, and write the file for the boards.
    pub fn carry_out(self) -> Result<Loaded, LoadError> {
        let Self { number, source, directory, base, reloads, done, file, inside } = self;
        let is_recorded = source.is_some();
        let read = || read_blocks_under(&directory).0.iter().find_map(|file| cut(file, number));
        let source = source.or_else(read).ok_or(LoadError::NoBlock(number))?;
        if inside && !is_recorded && !files::lies_in(&directory.join(&source.name), &directory) {
            return Err(LoadError::Outside(source.name));
        }
        let reloads = insert(&base, &reloads, done, &source).map_err(LoadError::Data)?;
        let data = reloads.get(done).map_or(0, |reload| fingerprint(&reload.store));
        if let Some(path) = &file {
            write(path, done, &source).map_err(LoadError::Write)?;
        }
        Ok(Loaded { reloads, done, data })
    }
}

/// One block of a file, under the name of the file.
fn cut(file: &Source, number: BlockNumber) -> Option<Source> {
    let (found, _) = blocks(0, file);
    let at = found.iter().position(|block| block.number == number)?;
    let start = |at: usize| found.get(at).and_then(|block| usize::try_from(block.header.start).ok());
    let end = start(at + 1).unwrap_or(file.text.len());
    let text = file.text.get(start(at)?..end)?;
    Some(Source { name: file.name.clone(), text: text.into() })
}

fn fingerprint(store: &Store) -> u64 {
    Fingerprint::of("", store.sources(), []).data
}

fn write(path: &Path, done: usize, source: &Source) -> io::Result<()> {
    replace(path, format!("{done} {}\n{}", source.name, source.text).as_bytes())
}

/// Read the file for the boards: number of reloads before the block, and the block.
fn read(path: &Path) -> Option<(usize, Source)> {
    let text = fs::read_to_string(path).ok()?;
    let (head, text) = text.split_once('\n')?;
    let (done, name) = head.split_once(' ')?;
    Some((done.parse().ok()?, Source { name: name.to_owned(), text: text.into() }))
}

pub struct Loader {
    orders: Sender<Order>,
    done: Receiver<Result<Loaded, LoadError>>,
}

impl Loader {
    /// Start the thread; it ends with the run. Errors are those of the system.
    pub fn start() -> io::Result<Self> {
        let (orders, received) = channel::<Order>();
        let (sender, done) = channel();
        let work = move || {
            while let Ok(order) = received.recv() {
                if sender.send(order.carry_out()).is_err() {
                    return;
                }
            }
        };
        thread::Builder::new().name("load".into()).spawn(work)?;
        Ok(Self { orders, done })
    }

    pub fn begin(&self, order: Order) {
        let _ = self.orders.send(order);
    }

    /// The result, once the thread has finished.
    pub fn look(&self) -> Option<Result<Loaded, LoadError>> {
        match self.done.try_recv() {
            Ok(done) => Some(done),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(LoadError::NoThread)),
        }
    }
}

type Reloads = Arc<Vec<Reload>>;
/// A load that a board has checked: its number, and the reloads with it, or `None` if there are errors.
type Candidate = (u32, Option<(Reloads, u64)>);

/// The task data of a board in a separate process.
pub struct BoardFiles {
    run: RunName,
    store: Store,
    reloads: Reloads,
    loaded: u32,
    asked: u32,
    checked: Checked,
    candidate: Option<(u32, Reloads)>,
    orders: Sender<(u32, Reloads)>,
    done: Receiver<Candidate>,
}

impl BoardFiles {
    /// Start with the reloads of the job, and start the checking thread. Errors are those of the system.
    pub fn new(run: &RunName, store: Store, reloads: Vec<Reload>) -> io::Result<Self> {
        let (orders, received) = channel::<(u32, Reloads)>();
        let (sender, done) = channel();
        let (name, first) = (run.clone(), store.clone());
        let work = move || {
            while let Ok((load, reloads)) = received.recv() {
                if sender.send((load, with_load(&name, &first, &reloads, load))).is_err() {
                    return;
                }
            }
        };
        thread::Builder::new().name("load".into()).spawn(work)?;
        Ok(Self {
            run: run.clone(),
            store,
            reloads: Arc::new(reloads),
            loaded: 0,
            asked: 0,
            checked: Checked::ZERO,
            candidate: None,
            orders,
            done,
        })
    }

    /// Load the blocks that were loaded before this board joined. The files of refused loads have been removed.
    pub fn catch_up(&mut self, loaded: u32) {
        for load in self.loaded.saturating_add(1)..=loaded {
            if let Some((reloads, _)) = with_load(&self.run, &self.store, &self.reloads, load) {
                self.reloads = reloads;
            }
        }
        (self.loaded, self.asked) = (loaded, loaded);
    }
}

/// The reloads, including the reload in a file. `None` if the file does not exist or has errors.
fn with_load(run: &RunName, first: &Store, reloads: &[Reload], load: u32) -> Option<(Reloads, u64)> {
    let (done, source) = read(&load_file(run, load))?;
    let base = match done.checked_sub(1) {
        None => first,
        Some(last) => &reloads.get(last)?.store,
    };
    let reloads = insert(base, reloads, done, &source).ok()?;
    let data = fingerprint(&reloads.get(done)?.store);
    Some((Arc::new(reloads), data))
}

impl BoardData for BoardFiles {
    fn generation(&mut self, generation: u32, loaded: u32) -> Option<TaskData<'_>> {
        if loaded != self.loaded {
            let (_, reloads) = self.candidate.take_if(|(load, _)| *load == loaded)?;
            (self.reloads, self.loaded) = (reloads, loaded);
        }
        match usize::try_from(generation).ok()?.checked_sub(1) {
            None => Some(self.store.view()),
            Some(reload) => self.reloads.get(reload).map(|reload| reload.store.view()),
        }
    }

    fn check(&mut self, load: u32) -> Checked {
        if load != self.asked {
            self.asked = load;
            let _ = self.orders.send((load, Arc::clone(&self.reloads)));
        }
        while let Ok((load, made)) = self.done.try_recv() {
            self.checked = Checked { load, data: made.as_ref().map_or(0, |(_, data)| *data) };
            self.candidate = made.map(|(reloads, _)| (load, reloads));
        }
        self.checked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn block_is_cut_out_of_its_file() {
        let text = "%% about the file\nBLOCK# 1 OFFSET 21000\n  a\nBLOCK# 2 OFFSET 21000\n  b\n";
        let file = Source { name: "x.blk".into(), text: text.into() };
        let block = |number| cut(&file, BlockNumber { offset: 21_000, number });
        assert_eq!(block(1).unwrap().text.as_ref(), "BLOCK# 1 OFFSET 21000\n  a\n");
        assert_eq!(block(2).unwrap().text.as_ref(), "BLOCK# 2 OFFSET 21000\n  b\n");
        assert!(block(3).is_none() && block(2).unwrap().name == "x.blk");
    }

    #[test]
    fn load_requests_of_boards_round_trip() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("load-1");
        assert!(read(&path).is_none());
        let source = Source { name: "a b.blk".into(), text: "BLOCK# 1 OFFSET 21000\n  a\n".into() };
        write(&path, 3, &source).unwrap();
        let (done, again) = read(&path).unwrap();
        assert_eq!((done, again.name.as_str(), &again.text), (3, "a b.blk", &source.text));
    }
}
