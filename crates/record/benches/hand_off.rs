//! Cost of recording: [`Recorder::tick`] in the thread of the ticks, with 1 ms per tick, and [`Recorder::cell`]. Cost
//! of a journal whose entry changes in every tick, as while the robot moves.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "figures are what it is for")]

use std::{
    thread,
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::tick::Tick;
use record::{
    CellFrame, End, Pace, Recorder, Setup, Timing,
    journal::{self, Entry, Identity, Journal},
    writer::TickRecord,
};
use taskdata::files::TaskData;

const TICKS: u64 = 5000;

fn main() {
    let path = std::env::temp_dir().join(format!("hand-off-{}.mcap", std::process::id()));
    let mut recorder = match Recorder::start(&path, Pace::Drop, Setup::default()) {
        Ok(recorder) => recorder,
        Err(error) => return eprintln!("{error}"),
    };
    let mut ladder = Ladder::default();
    let mut memory = CommonMemory::default();
    let (mut ticks, mut cells) = (Vec::new(), Vec::new());
    for tick in (1..=TICKS).map(Tick) {
        let (before, mut external) = (memory, ExternalInputs::default());
        external.devices.resolvers.counts = [u32::try_from(tick.0).unwrap_or_default(); 6];
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        let frame = CellFrame::new(tick);
        let started = Instant::now();
        recorder.cell(&frame);
        cells.push(started.elapsed());
        let started = Instant::now();
        recorder.timing(Timing { controller_ns: 2000, skipped: 0 });
        recorder.tick(tick, &external, &memory, || ladder.state());
        ticks.push(started.elapsed());
        thread::sleep(Duration::from_millis(1));
    }
    println!("a record is {} bytes, a frame of the cell {}", size_of::<TickRecord>(), size_of::<CellFrame>());
    tell("hand-off of a tick", ticks);
    tell("hand-off of a frame", cells);
    match recorder.finish(End::default()) {
        Ok(summary) => println!("{} ticks, {} bytes, lost {:?}", summary.ticks, summary.bytes, summary.lost),
        Err(error) => eprintln!("{error}"),
    }
    let _ = std::fs::remove_file(path);
    hand_off_of_the_journal(&memory);
}

fn hand_off_of_the_journal(memory: &CommonMemory) {
    let path = std::env::temp_dir().join(format!("hand-off-{}.journal", std::process::id()));
    let mut journal = match Journal::start(&path, &Identity::new(), None) {
        Ok(journal) => journal,
        Err(error) => return eprintln!("{error}"),
    };
    let mut times = Vec::new();
    for tick in (1..=TICKS).map(Tick) {
        let started = Instant::now();
        let line = u32::try_from(tick.0).unwrap_or_default();
        journal.tick(&Entry { tick, line, memory: journal::kept(memory), ..Entry::default() });
        times.push(started.elapsed());
        thread::sleep(Duration::from_millis(1));
    }
    println!("an entry is {} bytes, a journal {}", journal::SLOT, journal::length());
    tell("hand-off of an entry", times);
    match journal.finish(None) {
        Some(trouble) => eprintln!("{trouble}"),
        None => println!("on the disk: {:?}", journal::open(&path).map(|read| read.newest.tick)),
    }
    let _ = std::fs::remove_file(path);
}

fn tell(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |permille: usize| times[(times.len() - 1) * permille / 1000];
    println!("{what}: p50 {:?}, p99 {:?}, p99.9 {:?}, max {:?}", at(500), at(990), at(999), at(1000));
}
