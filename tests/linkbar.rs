//! The linkbar of chapter VIII, from the first command to the finished bar in its tray.

use std::{fs, sync::OnceLock, thread, time::Duration};

use interfaces::{CommonMemory, ExternalInputs, Reason};
use levels::ladder::{Ladder, ProcessId};
use proptest::prelude::*;
use rcs_core::{
    Plain,
    plain::{Writer, from_bytes},
    tick::Tick,
};
use record::{
    Log, replay,
    replay::{ReplayReport, task_data},
};
use whole_system_tests::{Outcome, Scratch, root, run, start};

const SEED: u64 = 1;
/// Greatest distance from the centre of the sector, in. Chapter VIII gives 0.15, because the blank drops onto a ledge.
const PLACED: f64 = 0.2;

fn linkbar() -> &'static Outcome {
    static RUN: OnceLock<Outcome> = OnceLock::new();
    RUN.get_or_init(|| run("linkbar", SEED, "linkbar", |_| {}))
}

fn assert_finished(outcome: &Outcome) {
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    assert!(outcome.result.get("failure").is_none(), "{}", outcome.result["failure"]);
    let commands = outcome.result["commands"].as_array().unwrap();
    assert!(commands.len() >= 7, "{commands:?}");
    assert!(commands.iter().all(|command| command["status"] == "finished"), "{commands:?}");
    let bar = outcome.part("LINKBAR1");
    assert_eq!((&bar["location"], &bar["sector"]), (&"UNIT_1".into(), &1.into()), "{bar}");
    assert_eq!(bar["held"], false);
    assert!(bar["error_in"].as_f64().unwrap() < PLACED, "{bar}");
}

#[test]
fn the_linkbar_is_machined_and_brought_back() {
    assert_finished(linkbar());
}

#[test]
fn no_heap_is_allocated_after_the_start() {
    let result = &linkbar().result;
    assert!(result["ticks"].as_u64().unwrap() > 1000);
    assert_eq!(result["allocations_after_start"], 0);
}

#[test]
fn the_link_is_without_errors() {
    let link = &linkbar().result["link"];
    assert!(link["frames"].as_u64().unwrap() > 1000, "{link}");
    for counter in ["naks", "retries", "checksum_errors"] {
        assert_eq!(link[counter], 0, "{link}");
    }
}

#[test]
fn the_same_seed_gives_the_same_run_and_the_same_log() {
    let again = run("linkbar", SEED, "again", |_| {});
    assert_eq!(again.digest(), linkbar().digest());
    assert_eq!(again.result["ticks"], linkbar().result["ticks"]);
    assert!(fs::read(&again.log).unwrap() == fs::read(&linkbar().log).unwrap(), "the logs differ");
}

#[test]
fn run_with_another_seed_differs_and_finishes() {
    let other = run("linkbar", SEED + 1, "seed", |_| {});
    assert_finished(&other);
    assert_ne!(other.digest(), linkbar().digest());
}

fn assert_same(report: &ReplayReport) {
    if let Some(difference) = &report.first_difference {
        panic!("{difference}");
    }
    assert!(report.is_same(), "run {:?}, replay {}", report.recorded_digest, report.digest);
}

#[test]
fn a_replay_gives_the_same_bits() {
    let report = replay(&linkbar().log).unwrap();
    assert_same(&report);
    assert!(report.complete && report.skipped == 0);
    assert_eq!(report.ticks, linkbar().result["ticks"].as_u64().unwrap());
    assert_eq!(report.digest.to_string(), linkbar().digest());
}

#[test]
fn a_killed_run_leaves_a_log_that_replays() {
    let scratch = Scratch::new("killed");
    let mut program = start(&scratch, "linkbar", SEED);
    let log = scratch.file("run.mcap");
    // Waits for some seconds of the run, which then has not ended.
    while fs::metadata(&log).map_or(0, |file| file.len()) < 1_000_000 {
        assert!(program.try_wait().unwrap().is_none(), "the run ended before it was killed");
        thread::sleep(Duration::from_millis(5));
    }
    program.kill().unwrap();
    program.wait().unwrap();
    let report = replay(&log).unwrap();
    assert_same(&report);
    assert!(!report.complete && report.ticks > 25, "{} ticks", report.ticks);
}

#[test]
fn a_missing_blank_is_named_with_process_table_and_row() {
    let job = fs::read_to_string(root().join("data/jobs/linkbar.job")).unwrap();
    let without: Vec<&str> = job.lines().filter(|line| !line.starts_with("** tray")).collect();
    assert!(without.len() < job.lines().count());
    let outcome = run("missing.job", SEED, "missing", |scratch| {
        fs::write(scratch.file("missing.job"), without.join("\n") + "\n").unwrap();
    });
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    let failure = &outcome.result["failure"];
    let text = failure["text"].as_str().unwrap();
    assert!(text.contains(Reason::NothingSeen.text()), "{failure}");
    assert!(outcome.last_words.contains(Reason::NothingSeen.text()), "{}", outcome.last_words);
    assert_eq!(failure["process"], "E-move");
    assert!(failure["table"].is_string() && failure["row"].as_u64().unwrap() > 0, "{failure}");
    assert_eq!(outcome.result["allocations_after_start"], 0, "also on the way of the error");
    assert_same(&replay(&outcome.log).unwrap());
}

struct Recorded {
    log: Log,
    ticks: Vec<(ExternalInputs, Vec<u8>)>,
}

fn recorded() -> &'static Recorded {
    static RECORDED: OnceLock<Recorded> = OnceLock::new();
    RECORDED.get_or_init(|| {
        let log = Log::open(&linkbar().log).unwrap();
        let ticks = log.ticks().map(Result::unwrap).map(|t| (from_bytes(&t.external).unwrap(), t.memory));
        let ticks = ticks.collect();
        Recorded { log, ticks }
    })
}

fn orders() -> impl Strategy<Value = Vec<Vec<ProcessId>>> {
    prop::collection::vec(Just(ProcessId::ALL.to_vec()).prop_shuffle(), 16)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    /// The run is the same for any order of the processes, even if it changes from tick to tick.
    #[test]
    fn the_order_of_the_processes_does_not_matter(orders in orders()) {
        let Recorded { log, ticks } = recorded();
        let store = task_data(log).unwrap();
        let data = store.view();
        let mut ladder = Ladder::default();
        let (mut before, mut image) = (CommonMemory::default(), vec![0; CommonMemory::SIZE]);
        for (number, (order, (external, memory))) in (1..).zip(orders.iter().cycle().zip(ticks)) {
            let tick = Tick(number);
            let mut after = before;
            ladder.step_in_order(order, tick, &before, external, &data, &mut after);
            after.encode(&mut Writer::new(&mut image));
            prop_assert!(image == *memory, "tick {tick}, order {order:?}");
            before = after;
        }
    }
}
