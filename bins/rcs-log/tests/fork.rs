//! Tests the programs `fork` and `compare` with whole runs of the shipped jobs.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::LazyLock,
};

use runtime::{LogTarget, Run, RunConfig};
use serde_json::Value;
use tempfile::TempDir;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data");
const TRAY: &str = "datum poses.blk:612:3-5:3"; // the pose of the tray UNIT_1

static LOGS: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a directory for logs"));
static LINKBAR: LazyLock<PathBuf> = LazyLock::new(|| log("linkbar.mcap", |_| {}));
static MISSING: LazyLock<PathBuf> = LazyLock::new(|| {
    log("missing.mcap", |config| config.faults = Some(Path::new(DATA).join("faults/blank-missing.toml")))
});

/// The log of the linkbar job, run as configured.
fn log(name: &str, configure: impl FnOnce(&mut RunConfig)) -> PathBuf {
    let path = LOGS.path().join(name);
    let mut config = RunConfig {
        log: LogTarget::File(path.clone()),
        shared_memory: false,
        ..RunConfig::new(DATA, "linkbar")
    };
    configure(&mut config);
    let _ = Run::new(config, Box::new(())).expect("the run begins").complete();
    path
}

fn rcs_log(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rcs-log")).args(arguments).output().expect("rcs-log runs")
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path of ASCII")
}

fn fork(log: &Path, tick: &str, changes: &[&str]) -> Value {
    let mut arguments = vec!["fork", text(log), "--json", "--tick", tick];
    changes.iter().for_each(|change| arguments.extend(["--set", *change]));
    let output = rcs_log(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("one JSON object")
}

/// A fact that differs at the end: its value in the log, and in the fork.
fn ends<'v>(answer: &'v Value, what: &str) -> Option<[&'v str; 2]> {
    let ends = answer["ends"].as_array().expect("a list");
    let end = ends.iter().find(|end| end["what"] == what)?;
    Some(["a", "b"].map(|side| end[side].as_str().expect("a text")))
}

#[test]
fn fork_without_a_change_equals_the_run() {
    let copy = LOGS.path().join("copy.mcap");
    let output = rcs_log(&["fork", text(&LINKBAR), "--tick", "3000", "-o", text(&copy)]);
    let said = stdout(&output);
    assert!(said.starts_with("linkbar as logged up to tick 3000 (120.00 s), every bit compared"), "{said}");
    assert!(said.contains("different  nothing; both: finished\n"), "{said}");
    assert_eq!(rcs_log(&["diff", text(&LINKBAR), text(&copy)]).status.code(), Some(0));
    let output = rcs_log(&["fork", text(&copy), "--tick", "3000"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("the log is that of a fork, after tick 3000"), "{said}");
}

#[test]
fn inserted_line_delays_the_rest() {
    let answer = fork(&LINKBAR, "3000", &["line=** wait 50"]);
    assert_eq!(answer["outcome"], serde_json::json!(["finished", "finished"]));
    assert_eq!(ends(&answer, "duration").map(|[_, fork]| fork), Some("240.88 s, 2.00 s longer"));
    let rows = answer["changes"]["rows"].as_array().expect("a list");
    assert!(!rows.is_empty() && rows.iter().all(|rows| rows["same_order"] == true), "{rows:?}");
}

#[test]
fn changed_pose_moves_the_robot_and_is_logged() {
    let lower = LOGS.path().join("lower.mcap");
    let change = format!("{TRAY}-=40");
    let output = rcs_log(&["fork", text(&LINKBAR), "--tick", "500", "--set", &change, "-o", text(&lower)]);
    let said = stdout(&output);
    assert!(said.contains("contacts   none\n           left_finger runs into UNIT_1_floor"), "{said}");
    assert!(said.contains("0.40 in apart at most"), "{said}");
    let said = stdout(&rcs_log(&["replay", text(&lower)]));
    assert!(said.contains(": same, "), "{said}");
}

#[test]
fn new_seed_changes_the_noise_from_its_tick_on() {
    let seeded = LOGS.path().join("seeded.mcap");
    rcs_log(&["fork", text(&LINKBAR), "--tick", "1500", "--set", "seed=7", "-o", text(&seeded)]);
    let said = stdout(&rcs_log(&["diff", text(&LINKBAR), text(&seeded)]));
    let first = said.lines().find(|line| line.starts_with("first ")).expect("a first difference");
    let tick = first.split([' ', ',']).find_map(|word| word.parse::<u64>().ok()).expect("its tick");
    assert!((1501..1510).contains(&tick), "{first}");
}

#[test]
fn faults_begin_after_the_tick() {
    let faults = format!("fault={DATA}/faults/air-lost.toml");
    let answer = fork(&LINKBAR, "2000", &[&faults]);
    assert!(answer["outcome"][1].as_str().is_some_and(|end| end.contains("gripper")), "{answer}");
    assert!(answer["seconds"][1].as_f64().is_some_and(|seconds| seconds > 80.0), "{answer}");
}

#[test]
fn new_command_replaces_the_next_one() {
    // ACQUIRE continues; TRANSFER would be the next command.
    let answer = fork(&LINKBAR, "4000", &["command=MOVE -- +0 -- 0 +0 HOME 0 -- 0"]);
    let [logged, forked] = ends(&answer, "parts").expect("the part is not brought to the tray");
    assert!(logged.contains("UNIT_1 sector 1") && !forked.contains("UNIT_1 sector 1"), "{forked}");
    let change =
        ["fork", text(&LINKBAR), "--tick", "5000", "--set", "command=MOVE -- +0 -- 0 +0 HOME 0 -- 0"];
    let said = String::from_utf8_lossy(&rcs_log(&change).stderr).into_owned();
    assert!(said.contains("the job sends no command after tick 5000: name an earlier tick"), "{said}");
}

#[test]
fn changed_friction_changes_the_cell() {
    let answer = fork(&LINKBAR, "0", &["cell gripper.parts.friction=0.03"]);
    let [logged, forked] = ends(&answer, "parts").expect("the part slips");
    assert_ne!(logged, forked);
}

#[test]
fn fork_at_the_failure_precedes_its_last_command() {
    let output = rcs_log(&["fork", text(&MISSING), "--at-failure", "--json"]);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let tick = answer["tick"].as_u64().expect("a tick");
    assert!(
        tick < 623 && answer["before"].as_str().is_some_and(|text| text.contains("commands")),
        "{answer}"
    );
    let output = rcs_log(&["fork", text(&LINKBAR), "--at-failure"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn wrong_changes_are_refused_before_anything_runs() {
    let low = format!("{TRAY}=-99999");
    let cases = [
        ("row=3", "`datum PLACE=VALUE`"),
        ("datum poses.blk:9:1:1=2", "poses.blk has no block 9"),
        (&low, "z of the tool point is from -20000 to 20000, -99999 found"),
        ("line=** vise", "a vise was expected"),
        ("command=** wait 5", "source location was expected"),
        ("fault=nowhere.toml", "nowhere.toml: No such file"),
        ("cell vise.friction=0.1", "use --tick 0"),
    ];
    for (change, reason) in cases {
        let output = rcs_log(&["fork", text(&LINKBAR), "--tick", "1000", "--set", change]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{change}: {said}");
        assert!(said.contains(reason) && output.stdout.is_empty(), "{change}: {said}");
    }
    let output = rcs_log(&["fork", text(&LINKBAR), "--tick", "5972"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("a tick from 0 to 5971 was expected"), "{said}");
}

/// A run with a change that its log does not record.
#[test]
fn unrepeatable_log_is_not_forked() {
    let path = LOGS.path().join("changed.mcap");
    let log = LogTarget::File(path.clone());
    let config = RunConfig { log, shared_memory: false, ticks: Some(900), ..RunConfig::new(DATA, "linkbar") };
    let mut run = Run::new(config, Box::new(())).expect("the run begins");
    while run.last_tick().0 < 200 && run.step() {}
    run.change_seed(7);
    let _ = run.complete();
    assert!(rcs_log(&["fork", text(&path), "--tick", "200"]).status.success());
    let output = rcs_log(&["fork", text(&path), "--tick", "800"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("this program differs from the log from tick 20"), "{said}");
}

#[test]
fn compare_distinguishes_equal_and_different_jobs() {
    let new = tempfile::tempdir().expect("a directory for data");
    copy(Path::new(DATA), new.path());
    let same = rcs_log(&["compare", DATA, text(new.path()), "linkbar"]);
    assert_eq!(same.status.code(), Some(0), "{}", stdout(&same));
    assert!(stdout(&same).contains("\nlinkbar  238.88  "), "{}", stdout(&same));

    let poses = new.path().join("poses.blk");
    let changed = fs::read_to_string(&poses)
        .expect("poses")
        .replace("     800   -pose-   ...         UNIT-V1", "     820   -pose-   ...         UNIT-V1");
    fs::write(&poses, changed).expect("the file can be written");
    let different = rcs_log(&["compare", DATA, text(new.path()), "linkbar", "tool-change", "--json"]);
    assert_eq!(different.status.code(), Some(1));
    let answer: Value = serde_json::from_slice(&different.stdout).expect("one JSON object");
    assert_eq!(answer["jobs"][0]["same"], false, "{answer}");
    assert_eq!(answer["jobs"][1]["job"], "tool-change");

    let nothing = rcs_log(&["compare", DATA, text(&new.path().join("objects"))]);
    assert_eq!(nothing.status.code(), Some(2));
    let unknown = rcs_log(&["compare", DATA, DATA, "nothing"]);
    assert_eq!(unknown.status.code(), Some(2));
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a directory can be made");
    for entry in fs::read_dir(from).expect("a directory can be read") {
        let entry = entry.expect("an entry");
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy(&from, &to) } else { fs::copy(&from, &to).map(drop).expect("a copy") }
    }
}
