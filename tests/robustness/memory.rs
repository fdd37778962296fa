//! Garbage in shared memory: in the values of a run, anywhere, before and after its end.

use std::{
    fs::{self, File},
    io::{Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use executive::memory::RunName;
use whole_system_tests::{
    Scratch,
    bench::{Ended, Running, traces, wait_for},
};

use crate::{
    runs::{BOARDS, assert_no_harm, end, judge_damaged, start},
    table::{Chance, Extent, Outcome, Row},
};

const TICKS: &str = "100"; // of an attacked run
const STARTS: Duration = Duration::from_secs(2); // a run has begun

/// The objects in which iceoryx2 finds values. Garbage in its lists of nodes and ports would end a program.
fn values(run: &RunName) -> Vec<PathBuf> {
    let is_value = |path: &PathBuf| path.to_string_lossy().contains("blackboard_");
    traces(run).into_iter().filter(|path| path.is_file() && is_value(path)).collect()
}

fn files(path: PathBuf) -> Vec<PathBuf> {
    match fs::read_dir(&path) {
        Ok(entries) => entries.flatten().flat_map(|entry| files(entry.path())).collect(),
        Err(_) => vec![path],
    }
}

fn scribble(file: &mut File, at: u64, bytes: u64, chance: &mut Chance) {
    let garbage: Vec<u8> = (0..bytes).map(|_| chance.byte()).collect();
    file.seek(SeekFrom::Start(at)).and_then(|_| file.write_all(&garbage)).expect("it can be written");
}

/// Fills a file with garbage, truncates it, or leaves it.
fn damage(path: &Path, chance: &mut Chance) {
    let kind = chance.below(5);
    let Ok(mut file) = File::options().write(true).open(path) else { return };
    let length = file.metadata().map_or(0, |found| found.len());
    match kind {
        0 => file.set_len(0).expect("it can be emptied"),
        1 => file.set_len(length / 2).expect("it can be cut"),
        2 => scribble(&mut file, 0, length, chance),
        3 => {
            let bytes = 8.min(length);
            (0..16).for_each(|_| scribble(&mut file, chance.below(length - bytes + 1), bytes, chance));
        }
        _ => {}
    }
}

/// The digest of a run without readers. In fast clock the robot does not ramp down after the last tick.
fn undisturbed(directory: &Path) -> String {
    let fast = ["--ticks", TICKS, "--log", "none", "--shared-memory", "off"];
    Ended::run(directory, "linkbar", &fast).digest().to_owned()
}

fn garbage_in_values(directory: &Path, boards: &str, expected: &str, chance: &mut Chance) -> Outcome {
    let mut run = start(directory, boards, TICKS, "none");
    drop(run.attach());
    let name = run.name.clone();
    let opened = |path: PathBuf| File::options().write(true).open(path).ok();
    let mut files: Vec<File> = values(&name).into_iter().filter_map(opened).collect();
    assert!(!files.is_empty(), "there is nothing to write to");
    while run.child.try_wait().expect("a child").is_none() {
        for file in &mut files {
            let length = file.metadata().expect("a file").len();
            scribble(file, chance.below(length.max(64) - 32), 32, chance);
        }
        thread::sleep(Duration::from_micros(200));
    }
    let ended = end(run);
    if boards == "one" {
        assert_eq!(ended.status, Some(0), "{}", ended.said);
        assert_eq!(ended.result["digest_before_ramp"], expected);
    }
    assert_no_harm(directory, &name);
    judge_damaged(&ended)
}

/// Damages any object, during the run or after it was killed.
fn damage_anywhere(directory: &Path, boards: &str, chance: &mut Chance) -> Outcome {
    let mut run = start(directory, boards, TICKS, "none");
    drop(run.attach());
    let name = run.name.clone();
    if chance.below(2) == 0 {
        run.kill();
    }
    traces(&name).into_iter().flat_map(files).for_each(|path| damage(&path, chance));
    let ended = end(run);
    assert_no_harm(directory, &name);
    judge_damaged(&ended)
}

/// Removes the page under the next tick's buffers: the run ends and reports the reason.
fn cut_short(directory: &Path, boards: &str) -> Outcome {
    let mut run = start(directory, boards, TICKS, "none");
    drop(run.attach());
    let name = run.name.clone();
    for path in values(&name) {
        File::options().write(true).open(path).and_then(|file| file.set_len(0)).expect("it can be cut");
    }
    let ended = end(run);
    if boards == "one" {
        assert_eq!(ended.status, Some(3), "{}", ended.said);
        assert!(ended.last_words().contains("shared memory went away"), "{}", ended.said);
    }
    assert_no_harm(directory, &name);
    judge_damaged(&ended)
}

/// Runs are killed at once, and their remains are damaged.
fn stale(directory: &Path, boards: &str, chance: &mut Chance) -> Outcome {
    let mut runs: Vec<Running> = (0..3).map(|_| start(directory, boards, TICKS, "none")).collect();
    runs.iter_mut().for_each(|run| drop(run.attach()));
    thread::sleep(Duration::from_millis(chance.below(200)));
    for run in &mut runs {
        run.kill();
    }
    let names: Vec<RunName> = runs.iter().map(|run| run.name.clone()).collect();
    wait_for("the killed runs leave something", || names.iter().all(|name| !traces(name).is_empty()));
    runs.into_iter().for_each(|run| drop(end(run)));
    names.iter().for_each(|name| assert_no_harm(directory, name));
    Outcome::BySignal
}

/// Damages the files of a starting run, until its first tick or its end.
fn damage_while_it_starts(directory: &Path, boards: &str, chance: &mut Chance) -> Outcome {
    let mut run = start(directory, boards, "30", "none");
    let name = run.name.clone();
    let (began, mut left) = (Instant::now(), chance.below(30));
    while left > 0 && began.elapsed() < STARTS && run.child.try_wait().expect("a child").is_none() {
        let found: Vec<PathBuf> = traces(&name).into_iter().flat_map(files).collect();
        let at = chance.place(found.len());
        if let Some(path) = found.get(at) {
            damage(path, chance);
            left -= 1;
        }
    }
    let ended = end(run);
    assert_no_harm(directory, &name);
    judge_damaged(&ended)
}

pub fn rows(extent: Extent) -> Vec<Row> {
    let scratch = Scratch::new("memory");
    let place = scratch.file("");
    let expected = undisturbed(&place);
    let mut rows = Vec::new();
    for (boards, on) in BOARDS {
        rows.push(Row::of(extent, "garbage in the values of a run", on, 0..extent.of(5, 1), |_, chance| {
            garbage_in_values(&place, boards, &expected, chance)
        }));
        let all = extent.of(30, 3);
        rows.push(Row::of(extent, "garbage in any object, or a cut", on, 0..all, |_, chance| {
            damage_anywhere(&place, boards, chance)
        }));
        let all = extent.of(30, 2);
        rows.push(Row::of(extent, "garbage while a run sets up", on, 0..all, |_, chance| {
            damage_while_it_starts(&place, boards, chance)
        }));
        rows.push(Row::of(extent, "all values cut to nothing", on, 0..extent.of(5, 1), |_, _| {
            cut_short(&place, boards)
        }));
        rows.push(Row::of(extent, "three runs killed at once", on, 0..extent.of(5, 1), |_, chance| {
            stale(&place, boards, chance)
        }));
    }
    rows
}
