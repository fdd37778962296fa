//! A job with a collision fails, and reports objects, depth, place and command.

use std::fs;

use record::Log;
use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, root, run, run_with};

const UNCHECKED: &[&str] = &["--unchecked"]; // the run starts despite errors in the data

/// `prepare` causes a collision. The check before the run would find most of them.
fn run_into(job: &str, name: &str, prepare: impl FnOnce(&Scratch)) -> Outcome {
    let outcome = run_with(job, 1, name, UNCHECKED, prepare);
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert!(outcome.last_words.contains("the robot ran into"), "{}", outcome.last_words);
    let deepest = contacts(&outcome).iter().map(|contact| contact["depth_in"].as_f64());
    assert!(deepest.flatten().all(|depth| depth > 0.0), "{:?}", contacts(&outcome));
    outcome
}

fn contacts(outcome: &Outcome) -> &[Value] {
    outcome.result["contacts"].as_array().expect("a result has contacts")
}

fn met<'a>(outcome: &'a Outcome, mover: &str, obstacle: &str) -> &'a Value {
    let one = contacts(outcome).iter().find(|one| one["mover"] == mover && one["obstacle"] == obstacle);
    one.unwrap_or_else(|| panic!("no {mover} in {obstacle}: {:?}", contacts(outcome)))
}

#[test]
fn low_via_point_leads_into_the_tray() {
    let outcome = run_into("linkbar", "low-via", Scratch::with_a_low_via_point);
    let first = &contacts(&outcome)[0]["obstacle"];
    assert!(first.as_str().is_some_and(|name| name.starts_with("pot_")), "{:?}", contacts(&outcome));
    assert!(outcome.last_words.contains("during MOV-TO-VU of GET-OBJECT"), "{}", outcome.last_words);
}

#[test]
fn a_part_in_an_occupied_sector_is_a_collision_and_the_job_ends() {
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
fn a_vise_taught_a_fifth_of_an_inch_off_is_a_collision() {
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
    let marks = marks(&outcome);
    let red = marks.iter().find(|(_, text)| text.contains("LINKBAR1_BH in fixed_jaw"));
    let begun = contact["tick"].as_u64().map(|tick| tick + 1); // events in the cell appear in the next tick
    assert_eq!(red.map(|(tick, _)| *tick), begun, "the collision is marked when it begins");
    let last = marks.last().map(|(_, text)| text.as_str());
    assert!(
        last.is_some_and(|text| !text.contains("fixed_jaw")),
        "a body without contact is no longer marked: {last:?}"
    );
}

fn marks(outcome: &Outcome) -> Vec<(u64, String)> {
    let log = Log::open(&outcome.log).expect("a run has a log");
    let text = |data: Vec<u8>| String::from_utf8_lossy(&data).into_owned();
    log.messages("/contacts").map(|(tick, data)| (tick.0, text(data))).collect()
}

/// The reason of a `[[contact]]`, a job that needs it, and the change of the cell.
type Need = (&'static str, &'static str, Option<[&'static str; 2]>);

const NO_MISS: f64 = 0.005; // in: without its entry, such a contact is the nearest miss of the run

/// The robot moves the end mill to the drum, which holds the drill. The guarded insertion fails.
const DRUM_OCCUPIED: &str = "\
** drum tool DRILL-2
** tray UNIT_2 1 ENDMILL-1 0 0 0
== MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0
== INSERT-TOOL ENDMILL-1 +1 -- 0 +1 TOOL-SAFE 0 -- 0 expect error
";

const NEEDS: [Need; 8] = [
    (
        "they close on it and open from it",
        "linkbar",
        Some(["size = [0.625, 0.625, 4.00]", "size = [0.625, 0.640, 4.00]"]),
    ),
    ("they hold it against the vise", "linkbar", None),
    ("it moves a little while the fingers close on it, and lies there", "linkbar", None),
    ("the same where the vise has it", "clevis", None),
    ("it changes hands", "clevis", None),
    ("its ears rest on them", "turned-part", None),
    ("the held tool feels for one that is in the drum already", "drum-occupied.job", None),
    ("they feel for it", "tool-change", None),
];

#[test]
fn every_permitted_contact_is_needed_by_a_job() {
    let cell = fs::read_to_string(root().join("data/cell.toml")).expect("the cell is described");
    let entry = |at: usize| {
        let end = cell[at..].find("\nwhy = ").map(|why| at + why + 1).expect("an entry has a reason");
        let line = cell[end..].find('\n').map_or(cell.len(), |length| end + length + 1);
        &cell[at..line]
    };
    let entries: Vec<&str> = cell.match_indices("[[contact]]\n").map(|(at, _)| entry(at)).collect();
    assert_eq!(entries.len(), NEEDS.len(), "each entry needs a job that needs it");
    for (number, (entry, (why, job, change))) in entries.iter().zip(NEEDS).enumerate() {
        assert!(entry.contains(why), "{entry}");
        let [from, to] = change.unwrap_or_default();
        let cell = cell.replacen(from, to, 1);
        let in_a_cell = |cell: String| {
            move |scratch: &Scratch| {
                scratch.copy_data();
                fs::write(scratch.file("drum-occupied.job"), DRUM_OCCUPIED).expect("a job can be written");
                fs::write(scratch.file("data/cell.toml"), cell).expect("a cell can be described");
            }
        };
        let run_in = |cell: String, what: &str| {
            run_with(job, 1, &format!("{what}-{number}"), UNCHECKED, in_a_cell(cell))
        };
        if change.is_some() || job == "drum-occupied.job" {
            let outcome = run_in(cell.clone(), "permitted");
            assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
            assert!(contacts(&outcome).is_empty(), "{:?}", contacts(&outcome));
        }
        let outcome = run_in(cell.replacen(entry, "", 1), "forbidden");
        let nearest = outcome.result["clearance"]["distance_in"].as_f64();
        let lies_on_it = nearest.is_some_and(|distance| distance < NO_MISS);
        assert!(!contacts(&outcome).is_empty() || lies_on_it, "no job needs {entry}");
    }
}

#[test]
fn the_nearest_miss_of_a_good_run_is_reported() {
    let outcome = run("linkbar", 1, "nearest", |_| {});
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    assert!(contacts(&outcome).is_empty());
    let nearest = &outcome.result["clearance"];
    assert!(nearest["distance_in"].as_f64().is_some_and(|inches| inches > 0.1 && inches < 2.0), "{nearest}");
    assert!(nearest["mover"].is_string() && nearest["command"]["emove"].is_string(), "{nearest}");
}

/// The guarded move ends where the gripper rests on the holster or in its seat, without pressing.
#[test]
fn gripper_is_not_pressed_into_a_holster_with_a_dead_sensor() {
    for sensor in ["large-1", "small-2"] {
        let fault = format!("[[fault]]\nkind = \"off\"\nsensor = \"holster.right.{sensor}\"\n");
        let name = format!("unseen-{sensor}");
        let outcome = run("tool-change", 1, &name, |scratch| scratch.faults(&fault));
        assert_eq!(outcome.status, Some(1), "{sensor}: {}", outcome.last_words);
        assert!(outcome.last_words.contains("the sensor condition did not come"), "{}", outcome.last_words);
        assert!(contacts(&outcome).is_empty(), "{sensor}: {:?}", contacts(&outcome));
    }
}
