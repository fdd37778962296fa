//! A run that is killed with `kill -9` at ten random moments: what is left can be read and replayed, and at most a second of
//! ticks is missing.
//!
//! The program is its own victim: started with an argument of ours it records a run in real time, twice as fast as a robot's,
//! and says each tick on its standard output once it has handed it over.

use std::{
    env, fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, Command, ExitCode, Stdio},
    thread,
    time::Duration,
};

use levels::ladder::Ladder;
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    tick::Tick,
};
use record::{Epoch, Log, Pace, Recorder, Setup, replay};
use taskdata::files::TaskData;

/// Argument that makes the program a victim.
const VICTIM: &str = "--victim";
/// How many runs are killed.
const RUNS: u64 = 10;
/// Length of a tick here.
const PERIOD: Duration = Duration::from_millis(20);
/// A second, and what the system may let the writer wait until it comes to run: 0.3 s.
const MOST_LOST: u64 = 25 + 15;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    match arguments.next().as_deref() {
        Some(VICTIM) => record_until_killed(Path::new(&arguments.next().expect("a victim has a file"))),
        // What `cargo test -- --list` asks, so that tools that list tests find none here.
        Some("--list") => ExitCode::SUCCESS,
        _ => kill_ten(),
    }
}

fn record_until_killed(path: &Path) -> ExitCode {
    let setup = Setup { epoch: Epoch::now(), ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Drop, setup).expect("the log begins");
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    let mut out = std::io::stdout();
    for tick in (1..).map(Tick) {
        let (before, mut external) = (memory, ExternalInputs::default());
        external.devices.resolvers.counts = [u32::try_from(tick.0 * 37 % 131_072).unwrap_or_default(); 6];
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        recorder.tick(tick, &external, &memory, || ladder.state());
        // Whoever started this may be gone: then nobody kills it either.
        if writeln!(out, "{tick}").and_then(|()| out.flush()).is_err() {
            break;
        }
        thread::sleep(PERIOD);
    }
    ExitCode::FAILURE
}

fn kill_ten() -> ExitCode {
    let directory = env::temp_dir().join(format!("record-kill-{}", std::process::id()));
    fs::create_dir_all(&directory).expect("a directory for the logs");
    let mut seed = u64::from(std::process::id());
    let victims: Vec<(PathBuf, Child, Duration)> = (0..RUNS)
        .map(|run| {
            let path = directory.join(format!("{run}.mcap"));
            let mut program = Command::new(env::current_exe().expect("a test has a path"));
            let child = program.arg(VICTIM).arg(&path).stdout(Stdio::piped()).spawn().expect("it starts");
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (path, child, Duration::from_millis(1000 + (seed >> 33) % 3000))
        })
        .collect();
    let mut failed = 0;
    let mut waited = Duration::ZERO;
    let mut victims = victims;
    victims.sort_by_key(|(_, _, moment)| *moment);
    for (path, mut child, moment) in victims {
        thread::sleep(moment.saturating_sub(waited));
        waited = waited.max(moment);
        // On Unix this is SIGKILL: the program hears nothing of it.
        child.kill().expect("a child can be killed");
        let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        let last: u64 = lines.map_while(Result::ok).filter_map(|line| line.parse().ok()).last().unwrap_or(0);
        child.wait().expect("a killed child ends");
        failed += u64::from(!judge(&path, moment, last));
    }
    fs::remove_dir_all(directory).expect("the logs can be removed");
    println!("{} of {RUNS} killed runs can be read and replayed", RUNS - failed);
    ExitCode::from(u8::from(failed > 0))
}

/// Is what is left of a log enough?
fn judge(path: &Path, moment: Duration, last: u64) -> bool {
    let log = match Log::open(path) {
        Ok(log) => log,
        Err(error) => {
            println!("killed after {moment:?}: {error}");
            return false;
        }
    };
    let kept = log.ticks().map_while(Result::ok).last().map_or(0, |tick| tick.tick.0);
    let same = kept == 0 || replay(path).is_ok_and(|report| report.is_same() && report.ticks == kept);
    println!("killed after {moment:?} in tick {last}: {kept} ticks are left, replayed: {same}");
    !log.complete && same && kept + MOST_LOST >= last && last > 10
}
