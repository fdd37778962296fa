//! Readers that die, hang, or write where they have no business: the run does not notice.

use std::{
    env, fs,
    io::{Read, Seek, SeekFrom, Write},
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use executive::memory::{self, Attached};
use rustix::process::{Pid, Signal, kill_process};
use whole_system_tests::Scratch;

use crate::bench::{Ended, ONE_AT_A_TIME, Running, assert_cleaned, traces, wait_for};

/// Says to a child of a test which run it is to disturb.
const RUN: &str = "RCS_SURVIVAL_RUN";
/// Ticks of a run that is disturbed.
const TICKS: &str = "200";

/// This program again, as one of the processes below.
fn process(test: &str, run: &Running) -> Child {
    Command::new(env::current_exe().expect("a test has a path"))
        .args(["--exact", &format!("readers::{test}"), "--ignored", "--nocapture"])
        .env(RUN, run.name.as_str())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("a test can be started")
}

/// Wait until a process has said that it is at work.
fn at_work(child: &mut Child) {
    let mut said = String::new();
    let stdout = child.stdout.as_mut().expect("its output is piped");
    wait_for("the process is at work", || {
        let mut byte = [0];
        if stdout.read(&mut byte).is_ok_and(|count| count == 1) {
            said.push(char::from(byte[0]));
        }
        said.contains("at work")
    });
}

#[test]
#[ignore = "not a test but a process that tests of this file start, and kill"]
fn reads_on_and_on() {
    let name = env::var(RUN).expect("started by another test").parse().expect("a name");
    let reader = Attached::open(&name).expect("the run lives");
    println!("at work");
    loop {
        let _ = (reader.memory(), reader.external(), reader.pulse());
        std::thread::sleep(Duration::from_micros(100));
    }
}

/// Where it writes garbage: values, and what iceoryx2 keeps to find them. Its lists of nodes and ports are not
/// touched: who can write there can end the program, as he can with a signal (docs/shared-memory.md).
fn values(run: &executive::memory::RunName) -> Vec<PathBuf> {
    let is_value = |path: &PathBuf| path.to_string_lossy().contains("blackboard_");
    traces(run).into_iter().filter(|path| path.is_file() && is_value(path)).collect()
}

#[test]
#[ignore = "not a test but a process that tests of this file start, and kill"]
fn scribbles_on_and_on() {
    let name = env::var(RUN).expect("started by another test").parse().expect("a name");
    let mut files: Vec<_> = values(&name)
        .into_iter()
        .map(|path| fs::File::options().read(true).write(true).open(path).expect("it is ours"))
        .collect();
    assert!(!files.is_empty(), "nothing to scribble on");
    println!("at work");
    let mut number = 1_u64;
    loop {
        for file in &mut files {
            let length = file.metadata().expect("a file").len();
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = number % length.max(64).saturating_sub(32);
            file.seek(SeekFrom::Start(at)).expect("it is long enough");
            file.write_all(&[number.to_le_bytes(); 4].concat()).expect("it can be written");
        }
        std::thread::sleep(Duration::from_micros(100));
    }
}

/// The digest of a run without readers, in fast clock: there the robot does not ramp down after the last tick.
fn alone(directory: &Path) -> String {
    let fast = ["--ticks", TICKS, "--log", "none", "--shared-memory", "off"];
    Ended::run(directory, "linkbar", &fast).digest().to_owned()
}

#[test]
fn a_reader_that_dies_or_hangs_changes_nothing() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("readers");
    let more = ["--clock", "real", "--ticks", TICKS, "--log", "none"];
    let mut run = Running::start(&scratch.file(""), "linkbar", &more);
    let name = run.name.clone();
    drop(run.attach());
    let mut dies = process("reads_on_and_on", &run);
    at_work(&mut dies);
    let mut hangs = process("reads_on_and_on", &run);
    at_work(&mut hangs);
    kill_process(Pid::from_child(&hangs), Signal::STOP).expect("it can be stopped");
    dies.kill().expect("it can be killed");
    dies.wait().expect("it is dead");
    let ended = run.end();
    hangs.kill().expect("it can be killed");
    hangs.wait().expect("it is dead");
    assert_eq!((ended.status, ended.number("allocations_after_start")), (Some(0), 0), "{}", ended.said);
    assert_eq!(ended.result["digest_before_ramp"], alone(&scratch.file("")));
    assert_cleaned(&scratch.file(""), &name);
}

#[test]
fn garbage_in_shared_memory_changes_no_bit() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("garbage");
    let more = ["--clock", "real", "--ticks", TICKS, "--log", "none"];
    let mut run = Running::start(&scratch.file(""), "linkbar", &more);
    let name = run.name.clone();
    let reader = run.attach();
    let mut scribbles = process("scribbles_on_and_on", &run);
    at_work(&mut scribbles);
    // A reader that meets garbage says so, or takes what looks like values; it does not fall over.
    let (mut refused, began) = (0, Instant::now());
    while began.elapsed() < Duration::from_secs(2) {
        refused += u32::from(reader.memory().is_err());
        std::thread::sleep(Duration::from_millis(1));
    }
    let ended = run.end();
    scribbles.kill().expect("it can be killed");
    scribbles.wait().expect("it is dead");
    drop(reader);
    assert!(refused > 0, "the garbage was not seen at all");
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["digest_before_ramp"], alone(&scratch.file("")));
    assert_cleaned(&scratch.file(""), &name);
}

/// Nothing can be done about that: the page under the next tick's buffers is gone. But it is said.
#[test]
fn objects_that_are_cut_short_end_the_run_and_it_says_why() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("cut");
    let mut run = Running::start(&scratch.file(""), "linkbar", &["--clock", "real", "--log", "none"]);
    let name = run.name.clone();
    drop(run.attach());
    for path in values(&name) {
        let file = fs::File::options().write(true).open(path).expect("it is ours");
        file.set_len(0).expect("it can be cut");
    }
    let ended = run.end();
    assert_eq!(ended.status, Some(3), "{}", ended.said);
    assert!(ended.last_words().contains("shared memory went away"), "{}", ended.said);
    assert_cleaned(&scratch.file(""), &name);
}

#[test]
fn what_is_shared_is_the_owners_alone() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("modes");
    let mut run = Running::start(&scratch.file(""), "linkbar", &["--clock", "real", "--log", "none"]);
    drop(run.attach());
    let mode = |path: &Path| fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
    assert_eq!(mode(&memory::root()), 0o700, "no other user may open the files in it");
    let objects: Vec<_> = traces(&run.name).into_iter().filter(|path| path.starts_with("/dev/shm")).collect();
    assert!(objects.len() > 16, "{objects:?}");
    for object in objects {
        assert_eq!(mode(&object) & 0o077, 0, "{}", object.display());
    }
    run.kill();
    assert_cleaned(&scratch.file(""), &run.name);
}
