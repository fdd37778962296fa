//! A run that is killed with `kill -9` at ten random moments: its log can be replayed, and at most a second of the
//! ticks that the writer had received is missing. The test starts itself as the victim, which prints each recorded tick
//! with the number of waiting ticks. `cargo test --release -p record --test kill` prints the moments.

#![expect(clippy::print_stdout, reason = "the figures of a campaign are printed")]

use std::{
    env,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Command, ExitCode, Stdio},
    thread,
    time::Duration,
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::tick::Tick;
use record::{Epoch, Log, Pace, Recorder, Setup, replay, writer::FULL_SET};
use taskdata::files::TaskData;

const VICTIM: &str = "--victim"; // argument that makes the program a victim
const RUNS: u64 = 10;
const PERIOD: Duration = Duration::from_millis(20); // length of a tick here
/// The unflushed second of ticks, and the tick that the writer is processing.
const MOST_LOST: u64 = FULL_SET + 1;

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    match arguments.next().as_deref() {
        Some(VICTIM) => record_until_killed(Path::new(&arguments.next().expect("a victim has a file"))),
        // The answer to `cargo test -- --list` is empty, so that tools find no tests here.
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
        // The program ends by itself if its parent process has ended.
        if writeln!(out, "{tick} {}", recorder.pending()).and_then(|()| out.flush()).is_err() {
            break;
        }
        thread::sleep(PERIOD);
    }
    ExitCode::FAILURE
}

fn kill_ten() -> ExitCode {
    let directory = tempfile::tempdir().expect("a directory for the logs");
    let mut seed = u64::from(std::process::id());
    let runs: Vec<thread::JoinHandle<bool>> = (0..RUNS)
        .map(|run| {
            let path = directory.path().join(format!("{run}.mcap"));
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let moment = Duration::from_millis(500 + (seed >> 33) % 3000);
            thread::spawn(move || survives(&path, moment))
        })
        .collect();
    let survived = runs.into_iter().map(|run| u64::from(run.join().expect("nothing panics"))).sum::<u64>();
    println!("{survived} of {RUNS} killed runs can be read and replayed");
    ExitCode::from(u8::from(survived < RUNS))
}

fn survives(path: &Path, moment: Duration) -> bool {
    let mut program = Command::new(env::current_exe().expect("a test has a path"));
    let mut child = program.arg(VICTIM).arg(path).stdout(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let begun = lines.next().is_some();
    thread::sleep(moment);
    // On Unix this is SIGKILL, which the program cannot handle.
    child.kill().expect("a child can be killed");
    let last =
        lines.map_while(Result::ok).filter_map(|line| LastMessage::read(&line)).last().unwrap_or_default();
    child.wait().expect("a killed child ends");
    begun && judge(path, moment, &last)
}

#[derive(Default)]
struct LastMessage {
    tick: u64,
    pending: u64, // ticks that waited for the writer
}

impl LastMessage {
    /// A line; `None` if it is incomplete.
    fn read(line: &str) -> Option<Self> {
        let (tick, pending) = line.split_once(' ')?;
        Some(Self { tick: tick.parse().ok()?, pending: pending.parse().ok()? })
    }
}

/// True if the rest of a log is sufficient.
fn judge(path: &Path, moment: Duration, last: &LastMessage) -> bool {
    let log = match Log::open(path) {
        Ok(log) => log,
        Err(error) => {
            println!("killed after {moment:?}: {error}");
            return false;
        }
    };
    let kept = log.ticks().map_while(Result::ok).last().map_or(0, |tick| tick.tick.0);
    let same = kept == 0 || replay(path).is_ok_and(|report| report.is_same() && report.ticks == kept);
    let LastMessage { tick, pending } = *last;
    println!(
        "killed after {moment:?} in tick {tick}, {pending} waiting: the last that is left is {kept}, replayed: {same}"
    );
    !log.complete && same && kept <= tick + 1 && kept + pending + MOST_LOST >= tick
}
