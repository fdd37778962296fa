//! What a tick pays for its record: time of [`Recorder::tick`] in the thread of the ticks, at the pace of a
//! run in real time shortened to 1 ms.

use std::{
    thread,
    time::{Duration, Instant},
};

use levels::ladder::Ladder;
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    tick::Tick,
};
use record::{End, Pace, Recorder, Setup};
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
    let mut times = Vec::new();
    for tick in (1..=TICKS).map(Tick) {
        let (before, mut external) = (memory, ExternalInputs::default());
        external.devices.resolvers.counts = [u32::try_from(tick.0).unwrap_or_default(); 6];
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        let started = Instant::now();
        recorder.tick(tick, &external, &memory, || ladder.state());
        times.push(started.elapsed());
        thread::sleep(Duration::from_millis(1));
    }
    times.sort();
    let at = |percent: usize| times[(times.len() - 1) * percent / 100];
    println!("hand-off of a tick: p50 {:?}, p99 {:?}, max {:?}", at(50), at(99), at(100));
    match recorder.finish(End::default()) {
        Ok(summary) => println!("{} ticks, {} bytes, lost {:?}", summary.ticks, summary.bytes, summary.lost),
        Err(error) => eprintln!("{error}"),
    }
    // The file was only there to be written.
    let _ = std::fs::remove_file(path);
}
