//! `finished` means done: misplaced parts, or a command without effect, fail a run despite its statuses.

use std::fs;

use whole_system_tests::{Outcome, Scratch, run};

const PUT_BACK: &str = "== TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0";

fn assert_fails(outcome: &Outcome, said: &[&str]) {
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    for words in said {
        assert!(outcome.last_words.contains(words), "{words:?} is not in {}", outcome.last_words);
    }
}

fn job(name: &str, text: &str) -> Outcome {
    let file = format!("{name}.job");
    run(&file, 1, name, |scratch: &Scratch| {
        fs::write(scratch.file(&file), text).expect("the job can be written");
    })
}

#[test]
fn part_in_another_sector_has_not_arrived() {
    // During the run the sectors of the tray are taught again with an error of 5.2 in.
    let taught = fs::read_to_string(whole_system_tests::root().join("data/movetables.blk"))
        .expect("the movetables can be read");
    let block =
        taught.split("BLOCK# ").find(|block| block.starts_with("431 ")).expect("the block of the sectors");
    let beside = format!("BLOCK# {}", block.replace("   -525   -525", "   -525  -1045"));
    let outcome = run("linkbar.job", 1, "finished-sector", |scratch| {
        fs::write(scratch.file("sectors.blk"), beside).expect("blocks can be written");
        scratch.job_with("linkbar.job", PUT_BACK, &format!("** load sectors.blk expect error\n{PUT_BACK}"));
    });
    assert_fails(
        &outcome,
        &[
            PUT_BACK,
            "LINKBAR1 is at UNIT_1 sector 3, 5.15 in from the sector's centre",
            "was to leave it at UNIT_1 sector 1, within 0.25 in",
        ],
    );
    assert_eq!(outcome.result["failure"]["line"], PUT_BACK);
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    assert!(commands.iter().all(|command| command["status"] == "finished"), "{commands:?}");
}

#[test]
fn part_that_slipped_in_the_fingers_is_off_its_place() {
    // With a grip force of two pounds, friction moves the part in the fingers.
    let outcome = run("linkbar", 1, "finished-force", |scratch| {
        let weak = "-obj-  LINKBAR1         2     0300   0060   2 ";
        scratch.data_with("objects/linkbar.blk", "-obj-  LINKBAR1         2     0300   0060   30", weak);
    });
    assert_fails(&outcome, &[PUT_BACK, "LINKBAR1 is at UNIT_1 sector 1, 0.8", "within 0.25 in"]);
}

#[test]
fn tolerances_are_in_the_cell_description() {
    // The data place the linkbar with an error of 0.15 in.
    let outcome = run("linkbar", 1, "finished-near", |scratch| {
        scratch.data_with("cell.toml", "placing_tolerance = 0.25", "placing_tolerance = 0.10");
    });
    assert_fails(&outcome, &["0.15 in from the sector's centre", "within 0.10 in"]);
}

#[test]
fn part_pushed_out_of_the_fingers_is_named_with_its_place() {
    // The jaws push the part out of weak fingers. Its final place depends on the seed.
    let job = "** tray UNIT_1 4 LINKBAR1_BH\n\
               ** vise partial PFIXTURE\n\
               == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0\n\
               ** vise close PFIXTURE\n\
               == POSITION H-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0\n";
    for seed in 1..=3 {
        let outcome = run("lost.job", seed, &format!("finished-pushed-{seed}"), |scratch: &Scratch| {
            let weak = "-obj-  LINKBAR1_BH      2     0300   0060   2 ";
            scratch.data_with("objects/linkbar.blk", "-obj-  LINKBAR1_BH      2     0300   0060   30", weak);
            fs::write(scratch.file("lost.job"), job).expect("the job can be written");
        });
        assert_fails(
            &outcome,
            &["LINKBAR1_BH is ", " from PFIXTURE was to leave it at PFIXTURE, within 0.25 in"],
        );
        // The part slipped in the fingers, or touched a jaw, before it fell.
        let failure = &outcome.result["failure"];
        let causes = ["a confirmation is false: E-move reports MOV-OBJ-TO", "the robot ran into movable_jaw"];
        let first = failure["text"].as_str().expect("a failure has a text");
        assert!(causes.iter().any(|cause| first.contains(cause)), "{first}");
        let followed = failure["followed"].as_array().expect("a failure has a list of what followed");
        let misplaced = followed.iter().find(|later| later["kind"] == "misplaced");
        let place = misplaced.and_then(|later| later["text"].as_str()).expect("the part is misplaced");
        assert!(place.starts_with("LINKBAR1_BH is "), "{place}");
        assert!(!place.starts_with("LINKBAR1_BH is at PFIXTURE"), "{place}");
    }
}

#[test]
fn a_line_without_an_object_fails_with_a_message() {
    let nothing = job("finished-drum", "** drum grip\n");
    assert_fails(&nothing, &["in `** drum grip`", "the drum has nothing to grip: no tool is in its place"]);
    let nothing = job("finished-vise", "** machine LINKBAR1_BH LINKBAR1 PFIXTURE\n");
    assert_fails(&nothing, &["LINKBAR1_BH is to be machined, but nothing is clamped in the vise"]);
}

#[test]
fn a_clevis_is_not_machined_twice_on_the_same_side() {
    let outcome = run("clevis.job", 1, "finished-side", |scratch| {
        scratch.job_with("clevis.job", "== REFIXTURE LCLEVIS_IH", "% == REFIXTURE LCLEVIS_IH");
    });
    assert_fails(
        &outcome,
        &[
            "in `** machine LCLEVIS_IH LCLEVIS PFIXTURE`",
            "LCLEVIS_IH is to be machined on its other side, but the one in front was machined before",
        ],
    );
}

#[test]
fn command_expected_to_fail_is_marked() {
    let failing = "** after 60 estop terminals\n== MOVE -- +0 -- 0 +0 SAFE 0 -- 0{mark}\n\
                   ** wait 100\n** release terminals\n** panel fault-reset\n** panel hydraulics enable\n\
                   ** panel manual on\n** panel align\n** panel auto\n** panel cycle-start\n** wait 25\n\
                   == PAUSE -- +0 -- 0 +0 -- 0 -- 0\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";
    let marked = job("finished-marked", &failing.replace("{mark}", " expect error"));
    assert_eq!(marked.status, Some(0), "{}", marked.last_words);
    assert_eq!(marked.result["commands"][1]["status"], "error as expected");
    let unmarked = job("finished-unmarked", &failing.replace("{mark}", ""));
    assert_fails(
        &unmarked,
        &["in `== MOVE -- +0 -- 0 +0 SAFE 0 -- 0`", "the command has not finished since"],
    );
    let finished = job("finished-well", "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0 expect error\n");
    assert_fails(&finished, &["finished, but its line expects an error"]);
}
