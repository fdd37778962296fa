//! Runs that lose their program, and are resumed from their journals (docs/design/resume.md).

use std::{
    fs,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use record::{
    Log,
    journal::{self, Entry, HEARTBEAT},
};
use runtime::{LogTarget, Run, RunConfig, RunOutcome, StartError};
use sessions::operator::Event;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");

fn config(job: &str) -> RunConfig {
    RunConfig { log: LogTarget::None, shared_memory: false, ..RunConfig::new(DATA, job) }
}

fn in_directory(directory: &tempfile::TempDir) -> PathBuf {
    directory.path().join("run.journal")
}

/// Runs a job for some ticks, and then drops the run like a program that is killed.
fn cut_off(job: &str, ticks: u64, path: &Path) {
    let config = RunConfig { journal: Some(path.to_owned()), ..config(job) };
    let mut run = Run::new(config, Box::new(())).expect("the job is sound");
    while run.last_tick().0 < ticks && run.step() {}
}

/// Resume a run as a person would. Returns the greatest motion of the tool before `job go`, in inches, and the outcome.
fn resumed(job: &str, path: &Path) -> (f64, RunOutcome) {
    let config = RunConfig { resume: Some(path.to_owned()), ..config(job) };
    let mut run = Run::new(config, Box::new(())).expect("the journal is sound");
    run.ask("tester", Event::Connected).expect("an operator can connect");
    // The arm comes to rest first.
    for _ in 0..50 {
        run.step();
    }
    let before = run.cell_mut().tool().position;
    for _ in 0..100 {
        run.step();
    }
    let moved = (run.cell_mut().tool().position - before).norm();
    let answer = run.ask("tester", Event::Line("resume".to_owned())).expect("it is a question");
    assert!(answer.starts_with("held: "), "{answer}");
    run.ask("tester", Event::Line("job go".to_owned())).expect("the job waits");
    // Without an operator a failed line ends the job.
    run.ask("tester", Event::Disconnected).expect("an operator can leave");
    (moved, run.complete())
}

#[test]
fn run_cut_off_at_any_tick_is_resumed_to_its_end() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    for (job, ticks) in [("linkbar", [300, 1_900]), ("clevis", [3_300, 9_800])] {
        for tick in ticks {
            cut_off(job, tick, &path);
            let (moved, outcome) = resumed(job, &path);
            assert!(moved < 0.02, "{job} at {tick}: the tool has moved by {moved} in before `job go`");
            assert!(outcome.is_finished(), "{job} at {tick}: {}", outcome.ending.text());
        }
    }
}

#[test]
fn interrupted_calibration_does_not_start_by_itself() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    cut_off("linkbar", 40, &path);
    let config = RunConfig { resume: Some(path.clone()), ..config("linkbar") };
    let mut run = Run::new(config, Box::new(())).expect("the journal is sound");
    for _ in 0..200 {
        run.step();
        let outputs = run.memory().device_outputs();
        assert_eq!((outputs.grip, outputs.pedestal_hand), Default::default(), "no valve opens");
    }
    assert!(run.memory().grip.calibration.is_none());
    drop(run);
    // The gripper may hold something, so the job ends with the reason, and nothing has been opened.
    let (moved, outcome) = resumed("linkbar", &path);
    assert!(moved < 0.02 && outcome.ending.text().contains("whether the gripper holds"));
}

#[test]
fn gripper_without_calibration_is_opened_by_hand_after_a_resume() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    cut_off("linkbar", 40, &path);
    let mut run = Run::new(RunConfig { resume: Some(path), ..config("linkbar") }, Box::new(())).unwrap();
    run.ask("tester", Event::Connected).expect("an operator can connect");
    for _ in 0..50 {
        run.step();
    }
    let ask = |run: &mut Run, line: &str| run.ask("tester", Event::Line(line.to_owned()));
    let refused =
        ask(&mut run, "resume held nothing").expect_err("no sensor shows that the gripper is empty");
    assert!(refused.contains("`confirm by hand` and POSITION"), "{refused}");
    for line in ["confirm by hand", "POSITION -- +0 -- 0 +0 HOME 0 -- 0"] {
        ask(&mut run, line).unwrap_or_else(|why| panic!("{line}: {why}"));
        run.step();
    }
    let is_open = |run: &Run| run.memory().emove.estimates.empty;
    let finished = (0..3_000).any(|_| run.step() && is_open(&run) && ask(&mut run, "job go").is_ok());
    assert!(finished, "{:?}", run.memory().task.status);
    run.ask("tester", Event::Disconnected).expect("an operator can leave");
    let outcome = run.complete();
    assert!(outcome.is_finished(), "{}", outcome.ending.text());
}

#[test]
fn contact_at_the_drum_is_no_collision_of_the_resumed_run() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    cut_off("tool-change", 2_730, &path);
    let (_, outcome) = resumed("tool-change", &path);
    assert!(outcome.result.contacts.is_empty(), "{:?}", outcome.result.contacts);
}

#[test]
fn finished_run_is_not_resumed() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    let with_journal = RunConfig { journal: Some(path.clone()), ..config("linkbar") };
    assert!(Run::new(with_journal, Box::new(())).unwrap().complete().is_finished());
    let again = Run::new(RunConfig { resume: Some(path), ..config("linkbar") }, Box::new(()));
    assert!(matches!(again, Err(StartError::NothingToResume(_))));
}

#[test]
fn journal_of_another_job_is_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    cut_off("linkbar", 60, &path);
    let other = Run::new(RunConfig { resume: Some(path), ..config("clevis") }, Box::new(()));
    let refused = other.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refused.contains("job linkbar") && refused.contains("there, clevis"), "{refused}");
}

#[test]
fn damaged_cell_and_missing_journal_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    let resume = || Run::new(RunConfig { resume: Some(path.clone()), ..config("linkbar") }, Box::new(()));
    assert!(matches!(resume().err(), Some(StartError::Journal(_))));
    cut_off("linkbar", 60, &path);
    let beside = journal::cell_beside(&path);
    let mut bytes = fs::read(&beside).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&beside, bytes).unwrap();
    assert!(matches!(resume().err(), Some(StartError::ResumedCell { .. })));
}

/// Runs a job for some ticks with a journal and a log, drops the run, and waits until the log has these ticks.
fn cut_off_with_log(job: &str, ticks: u64, path: &Path, log: &Path) {
    let target = LogTarget::File(log.to_owned());
    let config = RunConfig { journal: Some(path.to_owned()), log: target, ..config(job) };
    let mut run = Run::new(config, Box::new(())).expect("the job is sound");
    while run.last_tick().0 < ticks && run.step() {}
    drop(run);
    for _ in 0..600 {
        let last = Log::open(log).ok().and_then(|log| log.last_tick());
        if last.is_some_and(|last| last.0 >= ticks - HEARTBEAT) {
            return;
        }
        thread::sleep(Duration::from_millis(50));
    }
    panic!("the log does not reach tick {ticks}");
}

#[test]
fn run_without_journal_is_resumed_from_its_log() {
    let directory = tempfile::tempdir().unwrap();
    let (path, log) = (in_directory(&directory), directory.path().join("run.mcap"));
    cut_off_with_log("linkbar", 1_900, &path, &log);
    let Entry { line, .. } = journal::open(&path).unwrap().newest;
    fs::remove_file(&path).unwrap();
    let config = |job| RunConfig { resume: Some(log.clone()), journal: Some(path.clone()), ..config(job) };
    let other = Run::new(config("clevis"), Box::new(())).err();
    assert!(matches!(other, Some(StartError::OtherJournal { .. })), "{other:?}");
    let mut run = Run::new(config("linkbar"), Box::new(())).expect("the log is sound");
    run.ask("tester", Event::Connected).expect("an operator can connect");
    let mut ask = |line: &str| run.ask("tester", Event::Line(line.to_owned()));
    let refused = ask("job go").expect_err("the line is not known");
    assert!(
        refused.contains(&format!("the last recorded one is {line}: name it with `resume line N`")),
        "{refused}"
    );
    assert!(ask("resume").expect("it is a question").contains("line of the job: not known"));
    assert!(ask("resume line many").is_err() && ask("resume line 99").is_err());
    // Killed again before a person has named the line, the run still asks for it.
    assert!(journal::open(&path).unwrap().newest.asks_line);
    ask(&format!("resume line {line}")).expect("the job has this line");
    ask("job go").expect("the line is known");
    run.ask("tester", Event::Disconnected).expect("an operator can leave");
    let outcome = run.complete();
    assert!(outcome.is_finished(), "{}", outcome.ending.text());
    assert!(journal::open(&path).unwrap().newest.over);
}

#[test]
fn second_loss_of_power_before_the_first_entry_loses_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let path = in_directory(&directory);
    cut_off("linkbar", 700, &path);
    let saved = fs::read(journal::cell_beside(&path)).unwrap();
    let (before, _) = journal::read_cell(&saved).unwrap();
    drop(Run::new(RunConfig { resume: Some(path.clone()), ..config("linkbar") }, Box::new(())).unwrap());
    let Entry { tick, line, .. } = journal::open(&path).unwrap().newest;
    assert_eq!((tick, line), (before.tick, before.line));
    assert!(resumed("linkbar", &path).1.is_finished());
}
