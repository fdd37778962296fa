//! What the robot runs into: a job with a collision has not finished, and says what touched what, how deep, where, and during
//! which command.

use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, run};

/// Run a job in which `prepare` has put something into the robot's way, or the robot into the way of something.
fn run_into(job: &str, name: &str, prepare: impl FnOnce(&Scratch)) -> Outcome {
    let outcome = run(job, 1, name, prepare);
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert!(outcome.last_words.contains("the robot ran into"), "{}", outcome.last_words);
    let deepest = contacts(&outcome).iter().map(|contact| contact["depth_in"].as_f64());
    assert!(deepest.flatten().all(|depth| depth > 0.0), "{:?}", contacts(&outcome));
    outcome
}

fn contacts(outcome: &Outcome) -> &[Value] {
    outcome.result["contacts"].as_array().expect("a result has contacts")
}

/// The contact of a pair.
fn met<'a>(outcome: &'a Outcome, mover: &str, obstacle: &str) -> &'a Value {
    let one = contacts(outcome).iter().find(|one| one["mover"] == mover && one["obstacle"] == obstacle);
    one.unwrap_or_else(|| panic!("no {mover} in {obstacle}: {:?}", contacts(outcome)))
}

#[test]
fn a_via_point_that_is_too_low_leads_into_the_tray() {
    let outcome = run_into("linkbar", "low-via", |scratch| {
        scratch.data_with(
            "poses.blk",
            "   -4040    -1471     3398
   -5450    -1984      800
   -4424    -4803      800   -pose-   ...         UNIT-V1",
            "   -4040    -1471     1098
   -5450    -1984    -1500
   -4424    -4803    -1500   -pose-   ...         UNIT-V1",
        );
    });
    let first = &contacts(&outcome)[0]["obstacle"];
    assert!(first.as_str().is_some_and(|name| name.starts_with("pot_")), "{:?}", contacts(&outcome));
    assert!(outcome.last_words.contains("during MOV-TO-VU of GET-OBJECT"), "{}", outcome.last_words);
}

#[test]
fn a_part_that_lies_where_another_is_put_is_run_into_and_the_job_goes_on_to_its_end() {
    let outcome = run_into("linkbar.job", "occupied", |scratch| {
        scratch.job_with(
            "linkbar.job",
            "** vise partial",
            "** tray UNIT_1 1 LCLEVIS_BH 0 0 0\n** vise partial",
        );
    });
    let contact = met(&outcome, "LINKBAR1", "LCLEVIS_BH");
    assert_eq!(contact["command"]["emove"], "MOV-OBJ-TO", "{contact}");
    assert_eq!(outcome.result["failure"]["process"], "cell");
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    assert!(commands.iter().all(|command| command["status"] == "finished"), "{commands:?}");
}

#[test]
fn a_vise_that_was_taught_a_fifth_of_an_inch_beside_its_place_is_run_into() {
    let outcome = run_into("linkbar", "beside", |scratch| {
        scratch.data_with(
            "poses.blk",
            "    3800    -4400     -400
    6800    -4400     -400
    6800    -1400     -400   -pose-   PFIX-COR    PFIX-P",
            "    3800    -4420     -400
    6800    -4420     -400
    6800    -1420     -400   -pose-   PFIX-COR    PFIX-P",
        );
    });
    let contact = met(&outcome, "LINKBAR1_BH", "fixed_jaw");
    let [x, y, z] = [0, 1, 2].map(|axis| contact["position_in"][axis].as_f64().unwrap_or(f64::NAN));
    assert!(
        (67.0..69.0).contains(&x) && (-45.0..-43.0).contains(&y) && (-8.0..-3.0).contains(&z),
        "{contact}"
    );
}

#[test]
fn the_nearest_miss_of_a_good_run_is_told() {
    let outcome = run("linkbar", 1, "nearest", |_| {});
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    assert!(contacts(&outcome).is_empty());
    let nearest = &outcome.result["clearance"];
    assert!(nearest["distance_in"].as_f64().is_some_and(|inches| inches > 0.1 && inches < 2.0), "{nearest}");
    assert!(nearest["mover"].is_string() && nearest["command"]["emove"].is_string(), "{nearest}");
}
