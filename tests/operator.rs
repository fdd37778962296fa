//! An operator stops a live run, commands it, restarts it after an emergency stop, and lets the job continue. The same
//! inputs from the log give the same bits.

use std::{
    ffi::OsStr,
    io::{BufRead as _, BufReader, Write as _},
    os::unix::net::UnixStream,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::atomic::{AtomicU64, Ordering},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use executive::memory::{Attached, RunName, operator_socket};
use interfaces::ExternalInputs;
use record::{Log, LogLimit, OperatorLine};
use runtime::{Boards, ClockKind, LogTarget, OperatorAccess, Run, RunConfig, RunOutcome, StartError};
use rustix::process::{Pid, Signal, kill_process};
use sessions::operator::{Client, ClientError};
use tempfile::TempDir;
use whole_system_tests::{copy, rcs_run, root};

const SPEED: u8 = 20; // times real time: 2 ms per tick
const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action

fn unused_name() -> RunName {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("operated-{}-{count}", std::process::id()).parse().unwrap()
}

struct Cell {
    directory: TempDir,
    name: RunName,
    log: PathBuf,
    run: JoinHandle<RunOutcome>,
}

impl Cell {
    fn start(job: &str, change: impl FnOnce(RunConfig) -> RunConfig) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("operated.job");
        std::fs::write(&path, job).unwrap();
        let log = directory.path().join("operated.mcap");
        let name = unused_name();
        let config = RunConfig {
            clock: ClockKind::Real,
            speed: SPEED,
            name: Some(name.clone()),
            log: LogTarget::File(log.clone()),
            ..RunConfig::new(root().join("data"), path.to_string_lossy())
        };
        let config = change(config);
        let run = thread::spawn(move || Run::new(config, Box::new(())).unwrap().complete());
        Self { directory, name, log, run }
    }

    fn client(&self, name: &str) -> Client {
        let begun = Instant::now();
        loop {
            match Client::connect(&operator_socket(&self.name), &name.parse().unwrap()) {
                Ok(client) => return client,
                Err(error) => assert!(begun.elapsed() < TIME_LIMIT, "{error}"),
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    fn end(self) -> (RunOutcome, PathBuf, TempDir) {
        (self.run.join().unwrap(), self.log, self.directory)
    }
}

fn ask(client: &mut Client, lines: &[&str]) {
    for line in lines {
        let answer = client.ask(line).unwrap();
        assert!(answer.is_ok(), "{line}: {answer:?}");
    }
}

fn wait_for(client: &mut Client, text: &str) -> String {
    let begun = Instant::now();
    loop {
        let status = client.ask("status").unwrap().unwrap();
        if status.contains(text) {
            return status;
        }
        assert!(begun.elapsed() < TIME_LIMIT, "{text:?} did not come: {status}");
        thread::sleep(Duration::from_millis(10));
    }
}

fn wait_ticks(client: &mut Client, ticks: u64) {
    let tick = |client: &mut Client| {
        let status = client.ask("status").unwrap().unwrap();
        let number = status.strip_prefix("tick ").and_then(|rest| rest.split_once(':')).unwrap().0;
        number.parse::<u64>().unwrap()
    };
    let until = tick(client) + ticks;
    while tick(client) < until {
        thread::sleep(Duration::from_millis(4));
    }
}

fn go_on(client: &mut Client) {
    let begun = Instant::now();
    while let Err(why) = client.ask("job go").unwrap() {
        assert!(why.contains("is still executed"), "{why}");
        assert!(begun.elapsed() < TIME_LIMIT, "{why}");
        thread::sleep(Duration::from_millis(20));
    }
}

const TO_SAFE_AND_HOME: &str = "== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n== MOVE -- 0 -- 0 0 HOME 0 -- 0\n";

fn outcomes(outcome: &RunOutcome) -> Vec<(&str, &'static str)> {
    let bare = |text: &'_ str| -> &'static str {
        ["PAUSE", "SAFE", "HOME"].into_iter().find(|word| text.contains(word)).unwrap_or("other")
    };
    outcome.steps.iter().map(|step| (bare(&step.text), step.outcome.text())).collect()
}

/// The inputs of the log, replayed in fast clock, lead to the same bits.
fn assert_repeats(outcome: &RunOutcome, log: &PathBuf, directory: &TempDir) {
    assert_repeats_with(|config| config, outcome, log, directory);
}

fn assert_repeats_with(
    change: impl FnOnce(RunConfig) -> RunConfig,
    outcome: &RunOutcome,
    log: &PathBuf,
    directory: &TempDir,
) {
    let again = directory.path().join("again.mcap");
    let config = RunConfig {
        inputs: Some(log.clone()),
        name: Some(unused_name()),
        log: LogTarget::File(again.clone()),
        ticks: Some(outcome.result.ticks),
        shared_memory: false,
        ..RunConfig::new(root().join("data"), directory.path().join("operated.job").to_string_lossy())
    };
    let repeated = Run::new(change(config), Box::new(())).unwrap().complete();
    let digests = |log: &PathBuf| Log::open(log).unwrap().cell_digests().collect::<Vec<_>>();
    assert_eq!(repeated.result.digest, outcome.result.digest);
    assert!(digests(&again) == digests(log), "the cell differs");
    let lines = |log: &PathBuf| Log::open(log).unwrap().operator_lines().collect::<Vec<OperatorLine>>();
    assert_eq!(lines(&again), lines(log));
}

#[test]
fn a_job_is_stopped_commanded_and_finished_and_the_log_gives_the_same_run() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    let mut other = cell.client("bert");
    wait_for(&mut client, "the job plays");
    wait_ticks(&mut client, 150);
    ask(&mut client, &["stop"]);
    assert!(client.ask("bogus").unwrap().unwrap_err().contains("no request is named bogus"));
    ask(&mut client, &["go", "PAUSE"]);
    wait_for(&mut client, "the job waits");
    let refused = other.ask("job go").unwrap().unwrap_err();
    assert!(refused.starts_with("anna commands this run"), "{refused}");
    ask(&mut other, &["stop", "joystick hold PRIM"]);
    ask(&mut client, &["go", "joystick free PRIM"]);
    go_on(&mut client);
    drop((client, other));
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    let expected = [
        ("PAUSE", "finished"),
        ("SAFE", "interrupted"),
        // The PAUSE of the job replaces that of the operator, while the robot is still coming to rest.
        ("PAUSE", "interrupted"),
        ("PAUSE", "finished"),
        ("SAFE", "finished"),
        ("HOME", "finished"),
    ];
    assert_eq!(outcomes(&outcome), expected);
    let requests = outcome.result.operator.unwrap();
    assert!(requests.requests >= 8 && requests.refused >= 2, "{requests:?}");
    assert_eq!(outcome.result.allocations_after_start.unwrap_or(0), 0);
    assert_repeats(&outcome, &log, &directory);
}

#[test]
fn operator_restarts_the_robot_after_an_emergency_stop_and_the_job_continues() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    wait_ticks(&mut client, 150);
    ask(&mut client, &["estop pedestal"]);
    wait_for(&mut client, "the job waits");
    wait_ticks(&mut client, 100);
    ask(&mut client, &["release pedestal"]);
    for key in ["fault-reset", "hydraulics enable", "manual on", "align", "auto", "cycle-start"] {
        let begun = Instant::now();
        // A key is accepted only after the effect of the previous key is complete.
        while let Err(why) = client.ask(&format!("panel {key}")).unwrap() {
            assert!(begun.elapsed() < TIME_LIMIT, "{key}: {why}");
            thread::sleep(Duration::from_millis(20));
        }
        wait_ticks(&mut client, 10);
    }
    wait_ticks(&mut client, 600);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}\n{:?}", outcome.result.failure, outcomes(&outcome));
    assert!(outcome.result.emergency_stop.is_some());
    assert_repeats(&outcome, &log, &directory);
}

fn ask_until(client: &mut Client, line: &str, meanwhile: &str) {
    let begun = Instant::now();
    while let Err(why) = client.ask(line).unwrap() {
        assert!(why.contains(meanwhile) && begun.elapsed() < TIME_LIMIT, "{line}: {why}");
        thread::sleep(Duration::from_millis(10));
    }
}

/// IV.2.6, IV.3, on one board and on five.
#[test]
fn boards_are_stopped_executed_and_started_again() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    wait_ticks(&mut client, 150);
    ask(&mut client, &["board 2 stop"]);
    wait_ticks(&mut client, 20);
    let refused = client.ask("robot-init").unwrap().unwrap_err();
    assert!(refused.contains("PAUSE first"), "{refused}");
    ask(&mut client, &["board 2 go", "PAUSE"]);
    ask_until(&mut client, "robot-init", "PAUSE first");
    wait_ticks(&mut client, 100);
    ask(&mut client, &["board 2 stop", "robot-init", "execute PRIM 2"]);
    wait_ticks(&mut client, 20);
    ask(&mut client, &["board 2 go", "board 6 stop", "line-load 863 4 4"]);
    wait_ticks(&mut client, 20);
    let refused = client.ask("line-load 863 0 2").unwrap().unwrap_err();
    assert!(refused.contains("one command was expected"), "{refused}");
    ask(&mut client, &["board 8 stop", "board 8 go", "board 6 go"]);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}\n{:?}", outcome.result.failure, outcomes(&outcome));
    assert_repeats(&outcome, &log, &directory);
    let program = rcs_run().to_path_buf(); // each board is a process
    let split = |config| RunConfig { boards: Boards::Split, program, ..config };
    assert_repeats_with(split, &outcome, &log, &directory);
}

/// `<=` and DB-DONE (IV.2.6, IV.3.2), on one board and on five. The log contains the old and the new value.
#[test]
fn values_are_written_into_suspended_processes() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    wait_ticks(&mut client, 150);
    ask(&mut client, &["PAUSE"]);
    wait_ticks(&mut client, 100);
    for line in ["write task.ledger NONE", "write emove.estimates.located NONE", "db-done on"] {
        let refused = client.ask(line).unwrap().unwrap_err();
        assert!(refused.contains(" runs: `board "), "{line}: {refused}");
    }
    ask(&mut client, &["board 2 stop", "board 6 stop", "board 8 stop"]);
    wait_ticks(&mut client, 5);
    for (line, why) in [
        ("write emove.status.held NONE", "one of task.ledger, "),
        ("write emove.estimates.placed LINKBAR1", "write emove.estimates.placed NONE was expected"),
        ("write emove.estimates.held LINKBAR1_BH 9", "a grip of LINKBAR1_BH was expected"),
        ("write emove.estimates.held LINKBAR1_BH 2", "the sensors of the gripper"),
    ] {
        let refused = client.ask(line).unwrap().unwrap_err();
        assert!(refused.contains(why), "{line}: {refused}");
    }
    ask(&mut client, &["write task.ledger NONE", "write emove.estimates.located NONE", "db-done on"]);
    let answer = client.ask("write grip.calibration NONE").unwrap().unwrap();
    assert!(answer.ends_with("grip.calibration was known, is NONE"), "{answer}");
    wait_ticks(&mut client, 5);
    let answer = client.ask("write grip.calibration NONE").unwrap().unwrap();
    assert!(answer.ends_with("grip.calibration was NONE, is NONE"), "{answer}");
    ask(&mut client, &["board 8 go", "board 2 go", "board 6 go"]);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}\n{:?}", outcome.result.failure, outcomes(&outcome));
    let lines: Vec<OperatorLine> = Log::open(&log).unwrap().operator_lines().collect();
    let written = lines.iter().find(|line| line.line == "write grip.calibration NONE").unwrap();
    assert_eq!((written.source.as_str(), written.refused.as_ref()), ("anna", None));
    assert_eq!(written.answer, "grip.calibration was known, is NONE");
    assert_repeats(&outcome, &log, &directory);
    let program = rcs_run().to_path_buf();
    let split = |config| RunConfig { boards: Boards::Split, program, ..config };
    assert_repeats_with(split, &outcome, &log, &directory);
}

/// LOAD (IV.2.4): the log contains the text.
#[test]
fn a_block_is_loaded_during_a_run() {
    load_during_a_run(Boards::One);
}

#[test]
fn a_block_is_loaded_by_boards_of_other_processes() {
    load_during_a_run(Boards::Split);
}

fn load_during_a_run(boards: Boards) {
    let place = tempfile::tempdir().unwrap();
    let data = place.path().join("data");
    copy(&root().join("data"), &data);
    let (own, program) = (data.clone(), rcs_run().to_path_buf());
    let with = |config| RunConfig { data: own, boards, program, ..config };
    let cell = Cell::start("== MOVE -- 0 -- 0 0 HOME 0 -- 0\n", with);
    let mut client = cell.client("anna");
    assert!(client.ask("data").unwrap().unwrap().ends_with(&data.display().to_string()));
    ask_until(&mut client, "job wait", "waits");
    ask(&mut client, &["line-load 863 4 4"]);
    wait_ticks(&mut client, 20);
    let refused = client.ask("load 16000 863").unwrap().unwrap_err();
    assert!(refused.contains("a command is executed"), "{refused}");
    ask(&mut client, &["PAUSE"]);
    let refused = client.ask("load 21000 999").unwrap().unwrap_err();
    assert!(refused.contains("a command is executed") || refused.contains("no block 999"), "{refused}");
    let text = std::fs::read_to_string(data.join("commands.blk")).unwrap(); // line 5 is new: PAUSE
    let safe = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n";
    let longer = format!("{safe}== PAUSE -- +0 -- 0 +0 -- 0 -- 0");
    std::fs::write(data.join("commands.blk"), text.replace(safe, &longer)).unwrap();
    assert!(client.ask("line-load 863 5 5").unwrap().is_err(), "it is not loaded yet");
    ask_until(&mut client, "load 16000 863", "a command is executed");
    ask(&mut client, &["line-load 863 5 5"]);
    std::fs::write(data.join("commands.blk"), text.replace(safe, "== NONSENSE\n")).unwrap();
    ask_until_refused(&mut client, "load 16000 863", "with this change the task data have errors");
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}\n{:?}", outcome.result.failure, outcomes(&outcome));
    assert_repeats(&outcome, &log, &directory); // the data of the repetition have no line 5
    if boards == Boards::Split {
        let program = rcs_run().to_path_buf();
        let split = |config| RunConfig { boards, program, ..config };
        assert_repeats_with(split, &outcome, &log, &directory);
    }
}

/// `run JOB`: the log contains the text of the job.
#[test]
fn another_job_replaces_the_rest_of_the_waiting_one() {
    let place = tempfile::tempdir().unwrap();
    let data = place.path().join("data");
    copy(&root().join("data"), &data);
    let job = |name: &str, text: &str| std::fs::write(data.join("jobs").join(name), text).unwrap();
    job("there.job", "** vise open PFIXTURE\n== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n");
    job("loads.job", "** load ../commands.blk\n");
    job("wrong.job", "== MOVE NOBODY\n");
    job("vise.job", "** vise open TABLE\n");
    let own = data.clone();
    let stand_by = |config| RunConfig { data: own, stand_by: true, ..config };
    let cell = Cell::start("== MOVE -- 0 -- 0 0 HOME 0 -- 0\n", stand_by);
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    for (request, why) in [
        ("run ../../etc/passwd", "the name of a job"),
        ("run nowhere", "there is no job nowhere"),
        ("run loads", "load blocks with `load OFFSET BLOCK`"),
        ("run wrong", "the job wrong has errors"),
        ("run vise", "line 1 of the job vise"),
        ("run", "run JOB was expected"),
    ] {
        let refused = client.ask(request).unwrap().unwrap_err();
        assert!(refused.contains(why), "{request}: {refused}");
    }
    let taken = client.ask("run there").unwrap().unwrap();
    assert!(taken.contains("the job there plays, lines: 2"), "{taken}");
    let refused = client.ask("run there").unwrap().unwrap_err();
    assert!(refused.contains("the job plays already"), "{refused}");
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    // The PAUSE of the start, the PAUSE after the interruption, the vise.
    let expected =
        [("PAUSE", "finished"), ("PAUSE", "finished"), ("other", "finished"), ("SAFE", "finished")];
    assert_eq!(outcomes(&outcome), expected);
    assert_repeats_with(|config| RunConfig { stand_by: true, ..config }, &outcome, &log, &directory);
}

fn ask_until_refused(client: &mut Client, line: &str, why: &str) {
    let begun = Instant::now();
    loop {
        match client.ask(line).unwrap() {
            Err(refused) if refused.contains(why) => return,
            other => assert!(begun.elapsed() < TIME_LIMIT, "{line}: {other:?}"),
        }
        thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn stand_by_job_starts_when_permitted_and_ends_with_its_failure_if_unattended() {
    let cell =
        Cell::start("== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n", |config| RunConfig { stand_by: true, ..config });
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    ask(&mut client, &["job go", "estop pedestal"]);
    wait_for(&mut client, "the job waits");
    drop(client);
    let (outcome, log, directory) = cell.end();
    let failure = outcome.result.failure.as_ref().expect("nobody is left who could start the robot up");
    assert!(failure.account.first.text.contains("pedestal"), "{}", failure.account);
    assert_repeats_with(|config| RunConfig { stand_by: true, ..config }, &outcome, &log, &directory);
}

#[test]
fn request_gets_the_verdict_of_a_job_line() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| RunConfig { stand_by: true, ..config });
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    let refused = client.ask("TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 3 UNIT_1 2").unwrap().unwrap_err();
    let expected = "sector 2 of UNIT_1 needs an object, which says how the tray is divided";
    assert!(refused.ends_with(expected), "{refused}");
    go_on(&mut client);
    drop(client);
    assert!(cell.end().0.result.failure.is_none());
}

#[test]
fn stand_by_starts_with_wrong_data_and_refuses_only_their_commands() {
    let data = tempfile::tempdir().unwrap();
    copy(&root().join("data"), data.path());
    let file = data.path().join("objects/linkbar.blk");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen("LK-GRP-FX1", "LK-GPR-FX1", 1)).unwrap();
    let path = data.path().to_owned();
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| RunConfig { stand_by: true, data: path, ..config });
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    let refused = client.ask("ACQUIRE LINKBAR1_BH +2 UNIT_1 4 +0 -- 0 -- 0").unwrap().unwrap_err();
    assert!(refused.contains("no movetable is named LK-GPR-FX1"), "{refused}");
    ask(&mut client, &["MOVE -- 0 -- 0 0 SAFE 0 -- 0"]);
    go_on(&mut client);
    drop(client);
    assert!(cell.end().0.result.failure.is_none());
}

/// IV.1 step 3; the table was already calibrated.
#[test]
fn the_rotary_table_is_started_up_at_its_panel() {
    let stand_by = |config| RunConfig { stand_by: true, ..config };
    let cell = Cell::start(TO_SAFE_AND_HOME, stand_by);
    let mut client = cell.client("anna");
    wait_ticks(&mut client, 700);
    let run = Attached::open(&cell.name).unwrap();
    let wait_for_home = || {
        let begun = Instant::now();
        let stands = |inputs: ExternalInputs| inputs.devices.pedestal.motor_counter == -2000;
        while !run.external().is_ok_and(stands) {
            assert!(begun.elapsed() < TIME_LIMIT, "its counter should read -20.00");
            thread::sleep(Duration::from_millis(5));
        }
    };
    wait_for_home();
    let refused = client.ask("table reset").unwrap().unwrap_err();
    assert!(refused.contains("table mode manual comes first"), "{refused}");
    ask(&mut client, &["table power off", "table power on", "table mode manual", "table run+ 1000"]);
    ask_until(&mut client, "table run- 10", "the rotary table turns");
    ask_until(&mut client, "table reset", "the rotary table turns");
    ask_until(&mut client, "table step- 2000", "the rotary table turns");
    wait_for_home();
    ask(&mut client, &["table mode prog"]);
    assert!(!run.cell().unwrap().expect("it is simulated").table.obeys, "its power was on all the time");
    ask(&mut client, &["table power off", "table power on"]);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    assert_repeats_with(stand_by, &outcome, &log, &directory);
}

fn joystick(run: &Attached) -> (u8, (i16, i16), u16) {
    let shown = run.external().unwrap().devices.joystick;
    (shown.frame, (shown.x, shown.y), shown.velocity)
}

fn wait_for_box(run: &Attached, wanted: impl Fn((u8, (i16, i16), u16)) -> bool) {
    let begun = Instant::now();
    while !wanted(joystick(run)) {
        assert!(begun.elapsed() < TIME_LIMIT, "{:?}", joystick(run));
        thread::sleep(Duration::from_millis(4));
    }
}

const HELD: [&str; 3] = ["joystick velocity 0", "joystick frame WORLD", "joystick stick 0 300 36000"];

#[test]
fn motion_by_hand_ends_with_its_session() {
    let stand_by = |config| RunConfig { stand_by: true, ..config };
    let cell = Cell::start(TO_SAFE_AND_HOME, stand_by);
    let mut watcher = cell.client("watcher");
    wait_for(&mut watcher, "the job waits");
    let run = Attached::open(&cell.name).unwrap();
    let is_free = |shown| shown == (0, (0, 0), 0);
    // The session must remain. On a busy machine it may have been silent for too long.
    let mut anna = cell.client("anna");
    let begun = Instant::now();
    loop {
        ask(&mut anna, &HELD);
        let answer = anna.ask("leave").unwrap().unwrap();
        if answer.contains("stick and buttons are released, and the frame is off") {
            break;
        }
        assert!(begun.elapsed() < TIME_LIMIT, "{answer}");
    }
    wait_for_box(&run, is_free);
    ask(&mut anna, &HELD); // silence: the session and its command remain
    wait_for_box(&run, is_free);
    let status = wait_for(&mut watcher, "anna commands");
    assert!(status.contains("connected 2: watcher, anna"), "{status}");
    ask(&mut anna, &HELD); // the end of the connection
    drop(anna);
    wait_for(&mut watcher, "nobody commands");
    wait_for_box(&run, is_free);
    ask(&mut watcher, &["joystick velocity 1000"]);
    wait_ticks(&mut watcher, 50); // all processes have read that the box is off
    go_on(&mut watcher);
    drop(watcher);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    assert_repeats_with(stand_by, &outcome, &log, &directory);
}

#[test]
fn a_centred_stick_or_one_without_frame_causes_no_later_motion() {
    let stand_by = |config| RunConfig { stand_by: true, ..config };
    let cell = Cell::start(TO_SAFE_AND_HOME, stand_by);
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    let run = Attached::open(&cell.name).unwrap();
    ask(&mut client, &["joystick frame WORLD", "joystick stick 0 300 36000", "joystick stick 0 0 1"]);
    wait_ticks(&mut client, 4);
    assert_eq!(joystick(&run).1, (0, 0), "0 0 stops");
    ask(&mut client, &["joystick stick 0 300 36000", "joystick stick 0 -300 3"]);
    wait_ticks(&mut client, 8);
    assert_eq!(joystick(&run).1, (0, 0), "the first deflection does not come back");
    ask(&mut client, &["joystick stick 0 300 36000", "joystick frame OFF", "joystick frame WORLD"]);
    wait_ticks(&mut client, 4);
    assert_eq!(joystick(&run).1, (0, 0), "frame OFF has released it");
    ask(&mut client, &["leave"]);
    wait_ticks(&mut client, 50);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    assert_repeats_with(stand_by, &outcome, &log, &directory);
}

#[test]
fn sessions_with_equal_names_do_not_command_at_the_same_time() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let [mut first, mut second] = [(); 2].map(|()| cell.client("send"));
    assert_eq!([first.name(), second.name()], ["send", "send-2"]);
    ask(&mut first, &["joystick velocity 900"]);
    let refused = second.ask("joystick velocity 800").unwrap().unwrap_err();
    assert!(refused.starts_with("send commands this run"), "{refused}");
    drop(first);
    wait_for(&mut second, "nobody commands");
    ask(&mut second, &["joystick velocity 1000"]);
    wait_for(&mut second, "send-2 commands");
    drop(second);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    assert_repeats(&outcome, &log, &directory);
}

#[test]
fn expired_request_is_executed_only_if_it_stops() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    let mut script = UnixStream::connect(operator_socket(&cell.name)).unwrap();
    let lines =
        "hello script\n1 @0 PAUSE\n2 PAUSE\n3 @99999999 PAUSE\n4 @0 go\n5 joystick hold PRIM\n6 @0 stop\n";
    script.write_all(lines.as_bytes()).unwrap();
    let mut answers = BufReader::new(script.try_clone().unwrap()).lines().map(Result::unwrap);
    assert!(answers.next().unwrap().starts_with("rcs-operator 2 "));
    let late = "refused it arrived after its sender had stopped waiting";
    let unlimited = "refused a time limit was expected";
    for (number, expected) in
        [(1, late), (2, unlimited), (3, unlimited), (4, late), (5, "ok tick"), (6, "ok tick")]
    {
        let answer = answers.next().unwrap();
        assert!(answer.starts_with(&format!("{number} @")) && answer.contains(expected), "{answer}");
    }
    drop((answers, script));
    let status = client.ask("status").unwrap().unwrap();
    assert!(status.contains("knob 0"), "{status}");
    ask(&mut client, &["joystick free PRIM", "go"]);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    assert!(outcomes(&outcome).iter().all(|(_, outcome)| *outcome == "finished"), "no PAUSE was carried out");
    assert_repeats(&outcome, &log, &directory);
}

/// `rcs-run send` times out while a signal has stopped the run.
#[test]
fn a_command_to_a_stopped_run_is_discarded_on_resume() {
    let directory = tempfile::tempdir().unwrap();
    let (job, log) = (directory.path().join("safe.job"), directory.path().join("log.mcap"));
    std::fs::write(&job, "== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n").unwrap();
    let name = unused_name();
    let mut child = Command::new(rcs_run())
        .args([&job, Path::new("--log"), &log].map(AsRef::<OsStr>::as_ref))
        .args(["--clock", "real", "--stand-by", "--run", name.as_str(), "--json"])
        .current_dir(root())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let mut client = loop {
        match Client::connect(&operator_socket(&name), &"anna".parse().unwrap()) {
            Ok(client) => break client,
            Err(error) => assert!(begun.elapsed() < TIME_LIMIT, "{error}"),
        }
        thread::sleep(Duration::from_millis(20));
    };
    wait_for(&mut client, "the job waits");
    let process = Pid::from_child(&child);
    kill_process(process, Signal::STOP).unwrap();
    let sent = Command::new(rcs_run())
        .args(["send", "--run", name.as_str(), "MOVE -- 0 -- 0 0 HOME 0 -- 0"])
        .output()
        .unwrap();
    let given_up = client.ask("MOVE -- 0 -- 0 0 HOME 0 -- 0");
    thread::sleep(Duration::from_millis(500));
    kill_process(process, Signal::CONT).unwrap();
    assert!(!sent.status.success() && String::from_utf8_lossy(&sent.stderr).contains("has not answered"));
    assert!(matches!(given_up, Err(ClientError::Silent)), "{given_up:?}");
    go_on(&mut client);
    drop(client);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let lines: Vec<OperatorLine> = Log::open(&log).unwrap().operator_lines().collect();
    let moves: Vec<_> = lines.iter().filter(|line| line.line.contains("MOVE")).collect();
    assert!(moves.iter().all(|line| line.refused.is_some()), "{moves:?}");
    assert!(
        moves.iter().any(|line| line.source == "anna" && line.line.starts_with("(given up) ")),
        "{moves:?}"
    );
}

#[test]
fn emergency_stop_is_in_the_status_and_blocks_the_job() {
    let cell = Cell::start(TO_SAFE_AND_HOME, |config| config);
    let mut client = cell.client("anna");
    wait_ticks(&mut client, 150);
    ask(&mut client, &["job wait", "PAUSE", "estop terminals"]);
    let status = wait_for(&mut client, "the job waits");
    let emergency = "the E-stop near the terminals is pressed: `release terminals`, `panel fault-reset`";
    assert!(status.contains(emergency), "{status}");
    let refused = client.ask("job go").unwrap().unwrap_err();
    assert!(refused.contains(&format!("nothing moves: EMERGENCY: {emergency}")), "{refused}");
    drop(client); // the job keeps waiting without a connection, and the next session gets the same answer
    let mut client = cell.client("bert");
    wait_for(&mut client, emergency);
    let refused = client.ask("job skip").unwrap().unwrap_err();
    assert!(refused.contains(emergency), "{refused}");
    wait_ticks(&mut client, 100);
    ask(&mut client, &["release terminals"]);
    for key in ["fault-reset", "hydraulics enable", "manual on", "align", "auto", "cycle-start"] {
        ask_until(&mut client, &format!("panel {key}"), "");
        wait_ticks(&mut client, 10);
    }
    let status = client.ask("status").unwrap().unwrap();
    assert!(!status.contains("EMERGENCY"), "{status}");
    wait_ticks(&mut client, 600);
    go_on(&mut client);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}\n{:?}", outcome.result.failure, outcomes(&outcome));
    assert_repeats(&outcome, &log, &directory);
}

#[test]
fn stand_by_without_a_possible_operator_is_refused() {
    let config = |change: fn(RunConfig) -> RunConfig| {
        let real = RunConfig {
            clock: ClockKind::Real,
            stand_by: true,
            log: LogTarget::None,
            ..RunConfig::default()
        };
        change(RunConfig { data: root().join("data"), name: Some(unused_name()), ..real })
    };
    for change in [
        (|config| RunConfig { clock: ClockKind::Fast, ..config }) as fn(RunConfig) -> RunConfig,
        |config| RunConfig { operator: OperatorAccess::None, ..config },
        |config| RunConfig { shared_memory: false, ..config },
    ] {
        let error = Run::new(config(change), Box::new(())).err().expect("it would wait forever");
        assert!(
            error.to_string().contains("--stand-by waits for an operator, and none can connect"),
            "{error}"
        );
    }
    assert!(Run::new(config(|config| config), Box::new(())).is_ok());
}

#[test]
fn run_can_exclude_operators() {
    for change in [
        (|config| RunConfig { operator: OperatorAccess::None, ..config }) as fn(RunConfig) -> RunConfig,
        |config| RunConfig { clock: ClockKind::Fast, ticks: None, ..config },
    ] {
        let cell = Cell::start("** wait 2000\n", change);
        let mut seen = false;
        while !cell.run.is_finished() {
            seen |= Attached::open(&cell.name).is_ok();
            let refused =
                Client::connect(&operator_socket(&cell.name), &"anna".parse().unwrap()).unwrap_err();
            assert!(matches!(refused, ClientError::Unreachable(_)), "{refused}");
            thread::sleep(Duration::from_millis(5));
        }
        assert!(seen, "the run was there");
        cell.end();
    }
}

fn repeated(
    directory: &TempDir,
    change: impl FnOnce(RunConfig) -> RunConfig,
) -> Result<RunOutcome, StartError> {
    let job = directory.path().join("operated.job");
    std::fs::write(&job, TO_SAFE_AND_HOME).unwrap();
    let config = RunConfig {
        log: LogTarget::None,
        shared_memory: false,
        ..RunConfig::new(root().join("data"), job.to_string_lossy())
    };
    Run::new(change(config), Box::new(())).map(Run::complete)
}

#[test]
fn inputs_of_an_incomplete_log_are_refused_or_announced() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let log_limit = Some(LogLimit { bytes: 200_000, kept: None });
    let log = LogTarget::File(path.clone());
    let outcome = repeated(&directory, |config| RunConfig { log, log_limit, ..config }).unwrap();
    assert!(outcome.is_finished());
    let mut logs: Vec<PathBuf> = std::fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mcap"))
        .collect();
    let begin = |log: &PathBuf| Log::open(log).unwrap().ticks().next().unwrap().unwrap().tick;
    logs.sort_by_key(begin);
    assert!(logs.len() > 2, "{logs:?}");
    let given = |log: &PathBuf| {
        let inputs = Some(log.clone());
        repeated(&directory, |config| RunConfig { inputs, ..config }).map_err(|error| error.to_string())
    };
    let refused = given(&path).err().unwrap();
    let expected = format!(
        "{}: the log begins at tick {}, not at the start of its run; the first log of the run is {}; name",
        path.display(),
        begin(&path),
        logs[0].display()
    );
    assert!(refused.contains(&expected), "{refused}");
    let part = Log::open(&logs[0]).unwrap().part().unwrap().to_string();
    let end = format!("the log ends at tick {}, and its run continues", begin(&logs[1]).0 - 1);
    assert!(part.starts_with(&end), "{part}");
    assert!(given(&logs[0]).unwrap().is_finished());
    let second = logs[1].clone();
    std::fs::remove_file(&second).unwrap();
    let refused = given(&path).err().unwrap();
    assert!(refused.contains(&format!("{}, is missing", second.display())), "{refused}");
}

#[test]
fn a_job_that_waits_after_the_last_input_of_a_log_ends() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let log = LogTarget::File(path.clone());
    assert!(repeated(&directory, |config| RunConfig { log, ..config }).unwrap().is_finished());
    let last = Log::open(&path).unwrap().last_tick().unwrap();
    let inputs = Some(path);
    let outcome =
        repeated(&directory, |config| RunConfig { inputs, stand_by: true, ticks: Some(20_000), ..config });
    let outcome = outcome.unwrap();
    let failure = outcome.result.failure.unwrap();
    assert!(
        failure.account.first.text.contains("the log with the operator's inputs has ended"),
        "{}",
        failure.account
    );
    assert_eq!(outcome.result.ticks, last.0);
}

#[test]
fn a_command_right_after_a_motion_by_hand_waits_for_the_robot() {
    let stand_by = |config| RunConfig { stand_by: true, ..config };
    let cell = Cell::start(TO_SAFE_AND_HOME, stand_by);
    let mut client = cell.client("anna");
    wait_for(&mut client, "the job waits");
    for ticks in [0, 1, 2, 4, 8, 20] {
        ask(&mut client, &["joystick frame WORLD", "joystick stick 0 300 20"]);
        wait_ticks(&mut client, ticks);
        ask(&mut client, &["joystick frame OFF"]);
        let begun = Instant::now();
        while let Err(why) = client.ask("MOVE -- 0 -- 0 0 HOME 0 -- 0").unwrap() {
            assert!(why.contains("coming to rest") && begun.elapsed() < TIME_LIMIT, "{why}");
        }
        wait_ticks(&mut client, 60);
        ask(&mut client, &["PAUSE"]);
    }
    ask(&mut client, &["job go"]);
    drop(client);
    let (outcome, log, directory) = cell.end();
    assert!(outcome.is_finished(), "{:?}", outcome.result.failure);
    let failed = outcome.steps.iter().filter(|step| step.outcome.text() == "failed").count();
    assert_eq!(failed, 0, "{:?}", outcomes(&outcome));
    assert_repeats_with(stand_by, &outcome, &log, &directory);
}
