//! `--boards split`: equal bits for any distribution of the processes, and the end of a run whose boards are killed,
//! stopped, started manually or do not match. `RCS_KILLS` is the number of boards killed in a row (default 8);
//! `RCS_ALL_JOBS` compares every job with one board (default: the three shortest).

use std::{
    collections::BTreeMap,
    env, fs,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use executive::{
    boards::{coming_up, lost::LOST_AFTER},
    memory::{self, Attached, RunName},
};
use interfaces::{
    CommonMemory, Reason, StatusReport,
    emove::EmoveVerb,
    grip::{GripReport, GripVerb},
};
use rcs_core::plain::from_bytes;
use record::{Log, replay};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use whole_system_tests::{Scratch, command, rcs_run, root};

const TIME_LIMIT: Duration = Duration::from_secs(120); // of each action
const ATTEMPTS: u32 = 20; // on a busy machine a run may end before it is observed, and is started again

struct Ended {
    status: Option<i32>,
    result: Value,
    said: String,
}

impl Ended {
    fn of(output: &Output) -> Self {
        Self::with(output, String::from_utf8_lossy(&output.stderr).into_owned())
    }

    fn with(output: &Output, said: String) -> Self {
        let result = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| {
            panic!("{error} in {:?}; {said}", String::from_utf8_lossy(&output.stdout))
        });
        Self { status: output.status.code(), result, said }
    }

    fn last_words(&self) -> &str {
        self.said.lines().last().unwrap_or_default()
    }
}

const SAID: &str = "said.txt"; // in the directory of the run

struct Bench {
    scratch: Scratch,
    name: RunName,
}

impl Bench {
    fn new(test: &str) -> Self {
        Self { scratch: Scratch::new(test), name: RunName::unique(test) }
    }

    fn command(&self, job: &str, boards: &str, more: &[&str]) -> Command {
        let mut command = command(&self.scratch, job, 1);
        command.args(["--boards", boards, "--run", self.name.as_str(), "--log", "run.mcap"]).args(more);
        command
    }

    fn run(&self, job: &str, boards: &str, more: &[&str]) -> Ended {
        Ended::of(&self.command(job, boards, more).output().expect("rcs-run can be started"))
    }

    fn start(&self, job: &str, boards: &str, more: &[&str]) -> Running<'_> {
        let said = fs::File::create(self.scratch.file(SAID)).expect("a file can be made");
        let child = self.command(job, boards, more).stdout(Stdio::piped()).stderr(said).spawn();
        Running { bench: self, child: child.expect("rcs-run can be started") }
    }

    /// Nothing of the run is left, and the next run with the same name works at once.
    fn assert_clean(&self) {
        assert_eq!(memory::traces(&self.name), Vec::<PathBuf>::new());
        let next = self.run("linkbar", "split", &["--ticks", "20"]);
        assert_eq!(next.status, Some(0), "{}", next.said);
        assert_eq!(memory::traces(&self.name), Vec::<PathBuf>::new());
    }

    fn last_memory(&self) -> CommonMemory {
        let log = Log::open(&self.scratch.file("run.mcap")).expect("the log can be read");
        let last = log.ticks().last().expect("there are ticks").expect("they can be read");
        from_bytes(&last.memory).expect("it is common memory")
    }

    fn assert_log_replays(&self) {
        let report = replay(&self.scratch.file("run.mcap")).expect("the log can be replayed");
        if let Some(difference) = &report.first_difference {
            panic!("{difference}");
        }
        assert!(report.is_same() && report.complete);
    }
}

struct Running<'a> {
    bench: &'a Bench,
    child: Child,
}

impl Running<'_> {
    fn attach(&mut self) -> Attached {
        wait_for("the run can be read", || {
            assert_eq!(self.child.try_wait().expect("it is a child"), None, "it ended at once");
            Attached::open(&self.bench.name).ok()
        })
    }

    fn wait_until(&mut self, what: &str, moment: impl Fn(&Attached) -> bool) -> bool {
        let reader = self.attach();
        wait_for(what, || {
            let over = self.child.try_wait().expect("it is a child").is_some();
            moment(&reader).then_some(true).or(over.then_some(false))
        })
    }

    fn boards(&self) -> BTreeMap<u8, Pid> {
        let main = self.child.id().to_string();
        let all = fs::read_dir("/proc").expect("there is /proc").flatten();
        all.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok())
            .filter_map(|pid| {
                let line = fs::read(format!("/proc/{pid}/cmdline")).ok()?;
                let words: Vec<&str> =
                    line.split(|byte| *byte == 0).filter_map(|word| str::from_utf8(word).ok()).collect();
                let parent = words.iter().position(|word| *word == "--parent")?;
                (words.get(1) == Some(&"board") && words.get(parent + 1) == Some(&main.as_str()))
                    .then(|| Some((words.get(2)?.parse().ok()?, Pid::from_raw(pid)?)))?
            })
            .collect()
    }

    fn said(&self) -> String {
        fs::read_to_string(self.bench.scratch.file(SAID)).expect("it says something")
    }

    fn hear(&self, what: &str) {
        wait_for(what, || self.said().contains(what).then_some(()));
    }

    fn finish(self) -> Ended {
        let file = self.bench.scratch.file(SAID);
        let output = self.child.wait_with_output().expect("it can be waited for");
        Ended::with(&output, fs::read_to_string(file).expect("it says something"))
    }
}

fn wait_for<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + TIME_LIMIT;
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(Instant::now() < deadline, "not within {TIME_LIMIT:?}: {what}");
        thread::sleep(Duration::from_micros(200));
    }
}

fn shows(wanted: impl Fn(&CommonMemory) -> bool) -> impl Fn(&Attached) -> bool {
    move |reader| reader.memory().is_ok_and(|memory| wanted(&memory))
}

fn reached(tick: u64) -> impl Fn(&Attached) -> bool {
    move |reader| reader.pulse().is_ok_and(|pulse| pulse.tick.0 >= tick)
}

/// Sends a signal to a board at a certain moment. The end of the run must meet a condition.
fn strike(
    bench: &Bench,
    (board, signal): (u8, Signal),
    moment: impl Fn(&Attached) -> bool,
    wanted: impl Fn(&Ended) -> bool,
) -> Ended {
    let mut said = String::new();
    for _ in 0..ATTEMPTS {
        let mut running = bench.start("linkbar", "split", &[]);
        drop(running.attach()); // searched before, as the moment is short
        let boards = running.boards();
        assert_eq!(boards.len(), 4, "{boards:?}");
        let struck =
            running.wait_until("the moment", &moment) && kill_process(boards[&board], signal).is_ok();
        let ended = running.finish();
        assert!(
            boards.values().all(|&pid| !is_alive(pid)),
            "no board outlives the run, not even one that was stopped"
        );
        assert_eq!(ended.result["allocations_after_start"], 0);
        if struck && ended.status == Some(3) {
            assert!(ended.last_words().contains(&format!("board {board} (")), "{}", ended.said);
            assert_eq!(ended.result["failure"]["process"], format!("board {board}"));
            assert_eq!(ended.result["failure"]["kind"], "program", "{}", ended.said);
            if wanted(&ended) {
                return ended;
            }
        } else {
            assert_eq!(ended.status, Some(0), "{}", ended.said);
        }
        said = ended.said;
    }
    panic!("never caught in {ATTEMPTS} attempts; the last one said: {said}");
}

/// A zombie is treated as ended. Zombies remain if process 1 does not reap them.
fn is_alive(pid: Pid) -> bool {
    let stat = fs::read_to_string(format!("/proc/{}/stat", pid.as_raw_nonzero())).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with(['Z', 'X']))
}

#[test]
fn five_boards_give_the_bits_of_one() {
    let jobs: &[&str] = if env::var_os("RCS_ALL_JOBS").is_some() {
        &["linkbar", "clevis", "turned-part", "tool-change", "shift"]
    } else {
        &["linkbar", "clevis", "tool-change"]
    };
    for job in jobs {
        let bench = Bench::new("bits");
        let one = bench.run(job, "one", &[]);
        let split = bench.run(job, "split", &[]);
        assert_eq!((one.status, split.status), (Some(0), Some(0)), "{job}: {}{}", one.said, split.said);
        assert_eq!(split.result["digest"], one.result["digest"], "{job}");
        assert_eq!(split.result["commands"], one.result["commands"], "{job}");
        assert_eq!(split.result["parts"], one.result["parts"], "{job}");
        assert_eq!(split.result["allocations_after_start"], 0, "{job}");
        let boards = split.result["boards"].as_array().expect("the boards are in the result");
        assert_eq!(boards.iter().map(|board| &board["board"]).collect::<Vec<_>>(), [2, 4, 6, 8]);
        assert!(one.result.get("boards").is_none());
        println!("{job}: {} on one board and on five", one.result["digest"]);
        bench.assert_log_replays();
        assert_eq!(memory::traces(&bench.name), Vec::<PathBuf>::new());
    }
}

#[test]
fn loaded_blocks_reach_every_board() {
    const HIGH: &str = "BLOCK# 990 OFFSET 21000
   0 -5022 1136    0 -7145 -983
   3000 -7145 -983  -pose- ... HIGH-POS
  -pt-  HIGH  HIGH-POS  ...
BLOCK# 991 OFFSET 21000
-traj  HOME-HIGH  lpt HOME  lpt HIGH
  -ppt  4 100 8 0  pos HIGH-POS
";
    let bench = Bench::new("reload");
    let job = "** load high.blk\n== MOVE -- +0 -- 0 +0 HIGH 0 -- 0\n";
    fs::write(bench.scratch.file("taught.job"), job).expect("the job can be written");
    fs::write(bench.scratch.file("high.blk"), HIGH).expect("the blocks can be written");
    let (one, split) = (bench.run("taught.job", "one", &[]), bench.run("taught.job", "split", &[]));
    assert_eq!((one.status, split.status), (Some(0), Some(0)), "{}{}", one.said, split.said);
    assert_eq!(split.result["digest"], one.result["digest"]);
    bench.assert_log_replays();
}

struct Kill {
    board: u8,
    phase: &'static str,
    moment: fn(&CommonMemory) -> bool,
    said: &'static str, // required output
    held: bool,
}

const KILLS: &[Kill] = &[
    Kill {
        board: 8,
        phase: "in mid-grasp",
        moment: |memory| memory.emove.status.report == StatusReport::Executing && grasps(memory),
        said: "Grip executed",
        held: false,
    },
    Kill {
        board: 2,
        phase: "with a part in the gripper",
        moment: carries,
        said: "E-move executed MOV-OBJ-TO",
        held: true,
    },
    Kill { board: 4, phase: "on the way", moment: carries, said: "board 4 (T3 Interface;", held: true },
    Kill { board: 6, phase: "during a command", moment: carries, said: "Task executed MOVE", held: true },
];

fn grasps(memory: &CommonMemory) -> bool {
    memory.grip.status.report == GripReport::Executing && memory.emove.grip.command == GripVerb::CloseGrip
}

fn carries(memory: &CommonMemory) -> bool {
    memory.subtask.emove.command == EmoveVerb::MovObjTo
        && memory.emove.status.report == StatusReport::Executing
}

#[test]
fn a_killed_board_stops_the_robot_and_is_named() {
    for Kill { board, phase, moment, said, held } in KILLS {
        let bench = Bench::new("killed");
        // The signal may have arrived too late.
        let in_the_phase = |_: &Ended| moment(&bench.last_memory());
        let ended = strike(&bench, (*board, Signal::KILL), shows(moment), in_the_phase);
        println!("{phase}: {}", ended.last_words());
        for words in ["signal: 9", said] {
            assert!(ended.last_words().contains(words), "{words}: {}", ended.said);
        }
        if *held {
            assert_eq!(ended.result["parts"][0]["held"], true, "the part is still held");
        }
        bench.assert_log_replays();
        bench.assert_clean();
    }
}

#[test]
fn boards_are_killed_many_times_in_a_row() {
    let kills = env::var("RCS_KILLS").map_or(8, |text| text.parse().expect("RCS_KILLS is a number"));
    let bench = Bench::new("row");
    for kill in 0..kills {
        let at = 1 + kill * 617 % 1000; // moments spread over the first 40 s of the cell's time
        let board = [2, 4, 6, 8][usize::try_from(kill).unwrap() % 4];
        strike(&bench, (board, Signal::KILL), reached(at), |_| true);
        assert_eq!(memory::traces(&bench.name), Vec::<PathBuf>::new(), "kill {kill}");
    }
}

#[test]
fn paused_board_is_awaited() {
    const TICKS: &[&str] = &["--ticks", "100"];
    let bench = Bench::new("pauses");
    let one = bench.run("linkbar", "one", TICKS); // in real time the robot ramps down after the last tick
    let mut said = String::new();
    for _ in 0..ATTEMPTS {
        let mut running = bench.start("linkbar", "split", &[&["--clock", "real"], TICKS].concat());
        let board = {
            drop(running.attach());
            running.boards()[&4]
        };
        assert!(running.wait_until("some ticks", reached(20)), "a run in real time takes its time");
        let stopped = Instant::now();
        kill_process(board, Signal::STOP).expect("it lives");
        thread::sleep(Duration::from_millis(300));
        kill_process(board, Signal::CONT).expect("it lives");
        let pause = stopped.elapsed();
        let ended = running.finish();
        // On a busy machine this process may have overslept, or the board may have continued late.
        if pause > LOST_AFTER / 2 || ended.status != Some(0) {
            said = ended.said;
            continue;
        }
        let skipped = ended.result["overruns"].as_u64().expect("it is a number");
        assert!(skipped >= 6, "300 ms cover six slots at least, {skipped} were skipped");
        let before_ramp = &ended.result["digest_before_ramp"];
        assert_eq!(*before_ramp, one.result["digest"], "what was skipped changed nothing");
        return;
    }
    panic!(
        "a board that pauses for 300 ms was never awaited in {ATTEMPTS} attempts; the last one said: {said}"
    );
}

#[test]
fn hung_board_is_lost() {
    let bench = Bench::new("hangs");
    let moves = shows(|memory| memory.emove.status.report == StatusReport::Executing);
    let ended = strike(&bench, (2, Signal::STOP), moves, |_| true);
    assert!(ended.last_words().contains("board 2 (E-move, Prim; process"), "{}", ended.last_words());
    assert!(ended.last_words().contains("has not answered for 1.0 s"), "{}", ended.last_words());
    bench.assert_clean();
}

#[test]
fn boards_do_not_outlive_a_killed_run() {
    let bench = Bench::new("orphans");
    let mut running = bench.start("linkbar", "split", &[]);
    drop(running.attach());
    let boards = running.boards();
    assert_eq!(boards.len(), 4, "{boards:?}");
    running.child.kill().expect("it has not been waited for");
    running.child.wait().expect("it can be waited for");
    wait_for("the boards end", || boards.values().all(|&pid| !is_alive(pid)).then_some(()));
    let clean = Command::new(rcs_run()).arg("clean").output().expect("rcs-run can be started");
    assert_eq!(clean.status.code(), Some(0));
    bench.assert_clean();
}

fn board(bench: &Bench, number: &str, data: &Path) -> Child {
    let mut command = Command::new(rcs_run());
    command.args(["board", number, "linkbar", "--run", bench.name.as_str(), "--data"]).arg(data);
    command.stderr(Stdio::piped()).spawn().expect("rcs-run can be started")
}

/// Starts a board until it has a place in the run.
fn seated(bench: &Bench, number: &str, data: &Path) -> Child {
    wait_for("a board finds its place free", || {
        let mut child = board(bench, number, data);
        let stderr = child.stderr.as_mut().expect("it is piped");
        let mut said = BufReader::new(stderr).lines().map_while(Result::ok);
        if said.any(|line| line.contains("waits for the pulse")) {
            return Some(child);
        }
        child.wait().expect("it can be waited for");
        None
    })
}

#[test]
fn boards_are_started_by_hand_and_strangers_are_refused() {
    let bench = Bench::new("hand");
    let running = bench.start("linkbar", "manual", &["--ticks", "500"]);
    running.hear(&format!("rcs-run board 8 --run {}", bench.name));
    let data = root().join("data");

    // A board with other task data names the difference and leaves the place free.
    bench.scratch.data_with(
        "objects/clevis.blk",
        "ped-table-pos        <= -2135",
        "ped-table-pos        <= -2134",
    );
    let stranger = board(&bench, "4", &bench.scratch.file("data")).wait_with_output().unwrap();
    let reason = String::from_utf8_lossy(&stranger.stderr).into_owned();
    assert_eq!(stranger.status.code(), Some(2), "{reason}");
    assert!(reason.contains("board 4 cannot take part") && reason.contains("other task data"), "{reason}");

    // The place of a board that is killed while others are missing is free for the next board.
    let mut first = seated(&bench, "2", &data);
    running.hear("board 2 is ready");
    first.kill().expect("it has not been waited for");
    first.wait().expect("it can be waited for");
    running.hear("board 2 has ended");
    // Meanwhile a console shows these boards.
    let there = || {
        let boards = coming_up(&bench.name)?;
        Some(
            boards
                .iter()
                .filter(|(_, is_there)| *is_there)
                .map(|(board, _)| board.number())
                .collect::<Vec<_>>(),
        )
    };
    assert_eq!(there(), Some(Vec::new()));
    let mut boards = vec![seated(&bench, "6", &data)];
    running.hear("board 6 is ready");
    assert_eq!(there(), Some(vec![6]));
    boards.extend(["2", "4", "8"].iter().map(|number| seated(&bench, number, &data)));
    running.hear("all are there");
    for child in boards {
        let output = child.wait_with_output().expect("it can be waited for");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let ended = running.finish();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let one = Bench::new("hand-one").run("linkbar", "one", &["--ticks", "500"]);
    assert_eq!(ended.result["digest"], one.result["digest"]);
    assert_eq!(there(), None);
    assert_eq!(memory::traces(&bench.name), Vec::<PathBuf>::new());
}

#[test]
fn manually_started_board_is_replaced_manually() {
    let bench = Bench::new("replace");
    let mut running = bench.start("linkbar", "manual", &[]);
    let data = root().join("data");
    running.hear("rcs-run board 8");
    let mut boards: BTreeMap<&str, Child> =
        ["2", "4", "6", "8"].map(|number| (number, seated(&bench, number, &data))).into();
    assert!(running.wait_until("a part is carried", shows(carries)), "the moment is long");
    let mut lost = boards.remove("2").expect("it was started");
    lost.kill().expect("it lives");
    lost.wait().expect("it can be waited for");
    let successor = seated(&bench, "2", &data);
    let ended = running.finish();
    // The restarted processes report that they do not know the progress of their commands. The job ends in order.
    assert_eq!(ended.status, Some(1), "{}", ended.said);
    assert!(ended.last_words().contains(Reason::Restarted.text()), "{}", ended.said);
    for child in boards.into_values().chain([successor]) {
        let output = child.wait_with_output().expect("it can be waited for");
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(memory::traces(&bench.name), Vec::<PathBuf>::new());
}
