//! The shipped jobs: each ends with every part in place, and failures are reported.

use std::fs;

use interfaces::{CommonMemory, ExternalInputs, Reason, hws::HwsReport};
use rcs_core::plain::from_bytes;
use record::{Log, replay};
use whole_system_tests::{Outcome, Scratch, run};

/// Name, location, sector, and greatest distance from the place, inches.
type Placed = (&'static str, &'static str, u32, f64);

const LINKBAR: &[Placed] = &[("LINKBAR1", "UNIT_1", 1, 0.2)];
const CLEVIS: &[Placed] = &[("LCLEVIS", "UNIT_1", 2, 0.1)];
const TURNED_PART: &[Placed] = &[("SHAFT", "UNIT_2", 8, 0.2)];
const TOOL_CHANGE: &[Placed] = &[("DRILL-2", "UNIT_2", 3, 0.2), ("ENDMILL-1", "TOOL-TRNS", 0, 0.1)];

fn assert_ends_well(job: &str, seed: u64, placed: &[&[Placed]]) {
    let outcome = run(job, seed, &format!("{job}-{seed}"), |_| {});
    assert_eq!(outcome.status, Some(0), "{job}, seed {seed}: {}", outcome.last_words);
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    assert!(commands.iter().all(|command| command["status"] == "finished"), "{commands:?}");
    for (name, location, sector, within) in placed.iter().copied().flatten() {
        let part = outcome.part(name);
        assert_eq!((&part["location"], &part["sector"]), (&(*location).into(), &(*sector).into()), "{part}");
        assert_eq!(part["held"], false, "{part}");
        assert!(part["error_in"].as_f64().is_some_and(|error| error < *within), "{part}");
    }
    assert_eq!(outcome.result["contacts"], serde_json::json!([]), "{job}, seed {seed}");
    let truth = &outcome.result["truth"];
    let least = if job == "brush" { 40 } else { 50 }; // `brush` has two commands
    assert!(truth["judged"].as_u64().is_some_and(|judged| judged > least), "{truth}");
    assert_eq!((&truth["false"], &truth["not_sensed"]), (&serde_json::json!([]), &serde_json::json!([])));
    assert_eq!(outcome.result["allocations_after_start"], 0);
    assert_eq!(outcome.result["link"]["naks"], 0);
    assert_replays(&outcome);
}

fn assert_replays(outcome: &Outcome) {
    let report = replay(&outcome.log).expect("the log can be replayed");
    if let Some(difference) = &report.first_difference {
        panic!("{difference}");
    }
    assert!(report.is_same() && report.complete);
    assert_eq!(report.digest.to_string(), outcome.digest());
}

#[test]
fn the_clevis_is_machined_on_both_sides() {
    for seed in [1, 7] {
        assert_ends_well("clevis", seed, &[CLEVIS]);
    }
}

#[test]
fn the_turned_part_is_machined() {
    assert_ends_well("turned-part", 1, &[TURNED_PART]);
}

#[test]
fn the_tools_are_exchanged() {
    assert_ends_well("tool-change", 1, &[TOOL_CHANGE]);
}

#[test]
fn a_blank_is_released_in_the_vise_and_fetched_again() {
    assert_ends_well("vise-and-back", 1, &[&[("LINKBAR1_BH", "UNIT_1", 4, 0.1)]]);
}

#[test]
fn the_brush_is_taken_from_its_bracket_and_returned() {
    assert_ends_well("brush", 1, &[&[("HAND-BRUSH", "BRUSH", 0, 0.1)]]);
}

#[test]
fn shift_finishes_all_jobs_in_a_row() {
    assert_ends_well("shift", 1, &[LINKBAR, CLEVIS, TURNED_PART, TOOL_CHANGE]);
}

/// A job disturbed by `prepare` fails with this reason, and its log replays.
fn assert_fails_for(job: &str, name: &str, reason: Reason, prepare: impl FnOnce(&Scratch)) {
    let outcome = run(job, 1, name, prepare);
    let said = &outcome.last_words;
    assert_eq!(outcome.status, Some(1), "{said}");
    assert!(said.contains(reason.text()), "{said} does not say: {}", reason.text());
    let failure = &outcome.result["failure"];
    let later = failure["followed"].as_array().into_iter().flatten();
    let of_process = std::iter::once(failure).chain(later).find(|failure| failure["table"].is_string());
    let of_process = of_process.unwrap_or_else(|| panic!("no process has failed: {failure}"));
    assert!(of_process["row"].as_u64().is_some(), "{failure}");
    assert!(of_process["text"].as_str().is_some_and(|text| text.contains(reason.text())), "{failure}");
    assert_eq!(outcome.result["allocations_after_start"], 0, "also on the way of the error");
    assert_replays(&outcome);
}

#[test]
fn a_missing_part_is_reported() {
    assert_fails_for("clevis.job", "no-part", Reason::NothingSeen, |scratch| {
        scratch.job_with("clevis.job", "** tray UNIT_1 3 LCLEVIS_BH", "%");
    });
}

#[test]
fn another_part_is_not_recognised() {
    assert_fails_for("clevis.job", "other-part", Reason::NotRecognised, |scratch| {
        scratch.job_with("clevis.job", "** tray UNIT_1 3 LCLEVIS_BH", "** tray UNIT_1 3 LINKBAR1_BH");
    });
}

#[test]
fn part_slipping_out_of_the_fingers_is_lost() {
    assert_fails_for("clevis", "slips", Reason::ObjectLost, |scratch| {
        // The force is enough for the weight, which `check` requires, but not for the motion.
        scratch.data_with(
            "cell.toml",
            "friction = 0.30                  # pads on steel",
            "friction = 0.025",
        );
    });
}

#[test]
fn angle_beyond_the_pedestal_limit_is_reported() {
    assert_fails_for("clevis.job", "pedestal", Reason::TableLimit, |scratch| {
        let pedestal = "BLOCK# 1 OFFSET 22000\n\
            :S \"p-object\" <= LCLEVIS_IH\n\
            ped-appr <= 500 ped-grasp-size <= 250\n\
            ped-force <= 50 ped-release-size <= 450\n\
            ped-table-pos <= 100 ped-flip-angle <= 1835 :R\n\
            >FILE PED-PARA\n";
        fs::write(scratch.file("pedestal.blk"), pedestal).expect("blocks can be written");
        scratch.job_with("clevis.job", "** tray UNIT_1", "** load pedestal.blk expect error\n** tray UNIT_1");
    });
}

#[test]
fn tool_held_by_the_drum_is_not_torn_out() {
    assert_fails_for("tool-change.job", "held-tool", Reason::Detected, |scratch| {
        scratch.job_with("tool-change.job", "** drum release", "%");
    });
}

#[test]
fn a_tool_is_not_forced_into_the_drum() {
    assert_fails_for("tool-change", "tight-drum", Reason::Detected, |scratch| {
        scratch.data_with("cell.toml", "insertion_force = 30.0", "insertion_force = 95.0");
    });
}

/// A location above HOME with trajectories, taught during the run.
const HIGH: &str = "BLOCK# 990 OFFSET 21000
   0 -5022 1136    0 -7145 -983
   3000 -7145 -983  -pose- ... HIGH-POS
  -pt-  HIGH  HIGH-POS  ...
BLOCK# 991 OFFSET 21000
-traj  HOME-HIGH  lpt HOME  lpt HIGH
  -ppt  4 100 8 0  pos HIGH-POS
-traj  HIGH-HOME  lpt HIGH  lpt HOME
  -ppt  4 100 8 0  pos HOME-POS
";

#[test]
fn loaded_blocks_take_effect_with_the_next_command() {
    let job = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n\
               ** after 50 load high.blk\n\
               == MOVE -- +0 -- 0 +0 HOME 0 -- 0\n\
               == MOVE -- +0 -- 0 +0 HIGH 0 -- 0\n\
               == MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";
    let outcome = run("taught.job", 1, "taught", |scratch| {
        fs::write(scratch.file("taught.job"), job).expect("the job can be written");
        fs::write(scratch.file("high.blk"), HIGH).expect("the blocks can be written");
    });
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    assert_replays(&outcome);

    // The new data take effect once, after the command during which they were loaded.
    let log = Log::open(&outcome.log).expect("the log can be read");
    let ticks = log.ticks().map(|tick| tick.expect("a sound tick"));
    let generations: Vec<(u32, CommonMemory)> = ticks
        .map(|tick| {
            let external: ExternalInputs = from_bytes(&tick.external).expect("sound inputs");
            (external.generation, from_bytes(&tick.memory).expect("sound buffers"))
        })
        .collect();
    let changes: Vec<_> = generations.windows(2).filter(|pair| pair[0].0 != pair[1].0).collect();
    let [change] = changes.as_slice() else { panic!("{} changes", changes.len()) };
    assert_eq!((change[0].0, change[1].0), (0, 1));
    assert_eq!(change[0].1.task.status.report, HwsReport::Finished);
}
