//! A run with faults may finish, or fail with an understandable reason. It must not crash, hang, or falsely report
//! that it has finished. `RCS_FAULT_RUNS` is the number of random schedules, `RCS_FAULT_SEED` the first seed.

use std::{env, fmt::Write as _, fs, process::Command};

use data_encoding::BASE64;
use flate2::read::ZlibDecoder;
use record::replay;
use runtime::result::FailureResult;
use serde_json::{Value, json};
use whole_system_tests::{Outcome, Scratch, rcs_console, rcs_log, run, run_with};

enum Ends {
    Well, // finished, part in place
    /// Exit status, and kind, process and words of the first failure.
    Failing(i32, &'static str, &'static str, &'static str),
}
use Ends::{Failing, Well};

fn with(job: &str, faults: &str) -> Outcome {
    run(job, 1, &format!("{job}-{faults}"), |scratch| scratch.faults_of(faults))
}

fn in_place(job: &str, result: &Value) -> bool {
    let expected: &[(&str, &str, u64, f64)] = match job {
        "linkbar" => &[("LINKBAR1", "UNIT_1", 1, 0.25)],
        "clevis" => &[("LCLEVIS", "UNIT_1", 2, 0.25)],
        "turned-part" => &[("SHAFT", "UNIT_2", 8, 0.25)],
        "tool-change" => &[("DRILL-2", "UNIT_2", 3, 0.25), ("ENDMILL-1", "TOOL-TRNS", 0, 0.15)],
        other => panic!("unknown job {other}"),
    };
    expected.iter().all(|(name, location, sector, within)| {
        let parts = result["parts"].as_array().map_or(&[][..], Vec::as_slice);
        parts.iter().any(|part| {
            part["name"] == *name
                && part["location"] == *location
                && part["sector"] == *sector
                && part["held"] == false
                && part["error_in"].as_f64().is_some_and(|error| error < *within)
        })
    })
}

fn assert_sound(what: &str, outcome: &Outcome) {
    let said = &outcome.last_words;
    assert!(matches!(outcome.status, Some(0 | 1 | 3)), "{what}: {:?} {said}", outcome.status);
    assert_eq!(outcome.result["allocations_after_start"], 0, "{what}");
    assert!(
        !outcome.result["cell_faults"].as_array().is_none_or(Vec::is_empty)
            || outcome.result["faults"]["total"].as_u64() > Some(0),
        "{what}: no fault has struck"
    );
    let report = replay(&outcome.log).expect("the log can be replayed");
    if let Some(difference) = &report.first_difference {
        panic!("{what}: {difference}");
    }
    assert!(report.is_same() && report.complete, "{what}");
    assert_eq!(report.digest.to_string(), outcome.digest(), "{what}");
}

fn assert_ends(job: &str, faults: &str, ends: &Ends) {
    let outcome = with(job, faults);
    let what = format!("{job} with {faults}");
    assert_sound(&what, &outcome);
    let failure = &outcome.result["failure"];
    match ends {
        Well => {
            assert_eq!(outcome.status, Some(0), "{what}: {}", outcome.last_words);
            assert!(in_place(job, &outcome.result), "{what}: {}", outcome.result["parts"]);
        }
        Failing(status, kind, process, reason) => {
            assert_eq!(outcome.status, Some(*status), "{what}: {}", outcome.last_words);
            assert_eq!(
                (&failure["kind"], &failure["process"]),
                (&json!(kind), &json!(process)),
                "{what}: {failure}"
            );
            let text = failure["text"].as_str().unwrap_or_default();
            assert!(text.contains(reason), "{what}: {text}");
        }
    }
    assert_same_account(&what, &outcome);
}

fn ask(outcome: &Outcome, arguments: &[&str]) -> String {
    let output = Command::new(rcs_log()).args(arguments).arg(&outcome.log).output();
    String::from_utf8_lossy(&output.expect("rcs-log can be started").stdout).into_owned()
}

fn of_page(outcome: &Outcome) -> Value {
    let path = outcome.log.with_extension("html");
    let written = Command::new(rcs_log()).arg("page").arg(&outcome.log).arg("-o").arg(&path).output();
    assert!(written.expect("rcs-log can be started").status.success());
    let page = fs::read_to_string(&path).expect("the page is written");
    let (_, data) = page.split_once("id=\"log-data\"").expect("the page has a log");
    let data = data.split(['<', '>']).nth(1).expect("the element has a text");
    let data = BASE64.decode(data.trim().as_bytes()).expect("it is encoded");
    let copy = record::Log::from_bytes(&path, data).expect("it is a log");
    let why = &copy.attachment("why.json.deflate").expect("the page has the answer").data;
    serde_json::from_reader(ZlibDecoder::new(why.as_slice())).expect("it is JSON")
}

fn of_console(outcome: &Outcome, failure: &FailureResult, last: u64) -> Vec<String> {
    let tick = failure.account.first.shown_at().min(last).to_string();
    let mut console = Command::new(rcs_console());
    console.args(["--colour", "never", "--once", "ladder", "--tick", &tick, "--log"]).arg(&outcome.log);
    let output = console.output().expect("rcs-console can be started");
    String::from_utf8_lossy(&output.stdout).lines().skip(1).take(3).map(str::to_owned).collect()
}

fn assert_shown_by_console(what: &str, outcome: &Outcome, failure: &FailureResult, last: u64) {
    let band = of_console(outcome, failure, last);
    assert_eq!(band.len(), 3, "{what}: the console has no picture of the failure");
    let is_stop = outcome.result["failure"]["kind"] == "emergency-stop";
    let state = if is_stop { "XX E-STOP" } else { "!! FAULT" };
    // For a button the band states that it is pressed.
    let text = failure.account.first.text.split(" was pressed").next().unwrap_or_default();
    let begin: String = text.chars().take(40).collect();
    assert!(band[0].contains(state) && band[0].contains(&begin), "{what}: {state} {begin:?} in {band:?}");
    assert!(band[1].contains("line ") || outcome.result["commands"] == json!([]), "{what}: {band:?}");
    assert!(band[2].starts_with(" next: "), "{what}: {band:?}");
}

/// Assert that all programs name the same first failure, which is not an injected fault.
pub fn assert_same_account(what: &str, outcome: &Outcome) {
    let answer = |arguments: &[&str]| -> Value {
        serde_json::from_str(&ask(outcome, arguments)).unwrap_or_else(|error| panic!("{what}: {error}"))
    };
    let (info, why) = (answer(&["info", "--json"]), answer(&["why", "--json"]));
    let failure = &outcome.result["failure"];
    if failure.is_null() {
        assert!(info["failure"].is_null() && why["world"].is_null(), "{what}: {info} {why}");
        return;
    }
    let (tick, text) = (&failure["tick"], failure["text"].as_str().unwrap_or_default());
    assert!(
        outcome.last_words.contains(&format!(" failed at tick {tick}")),
        "{what}: {}",
        outcome.last_words
    );
    assert!(outcome.last_words.contains(text), "{what}: {}", outcome.last_words);
    let page = of_page(outcome);
    assert_eq!(page, why, "{what}: the page has another answer than rcs-log why");
    let result: FailureResult = serde_json::from_value(failure.clone()).expect("one schema");
    let chain = serde_json::to_value(result.chain.as_ref().expect("a run attaches its chain")).expect("JSON");
    assert_eq!(
        (&info["failure"]["chain"], &why["world"]["commands"]),
        (&chain, &chain["commands"]),
        "{what}"
    );
    for field in ["tick", "text", "commands", "causes", "consequences"] {
        assert_eq!(why["failure"][field], chain["report"][field], "{what}: {field}");
    }
    assert_eq!(info["failure"]["remedy"], failure["remedy"], "{what}");
    assert_shown_by_console(what, outcome, &result, info["ticks"].as_u64().expect("a number"));
    let first_cause = &why["failure"]["first_cause"];
    let is_fault = |told: &Value| told.as_str().is_some_and(|text| text.contains("fault 1 begins"));
    assert!(!is_fault(&failure["text"]) && !is_fault(first_cause), "{what}: {failure} {first_cause}");
    for told in [&info["failure"], &why["world"]] {
        for field in ["tick", "kind", "process", "text", "followed"] {
            assert_eq!(told[field], failure[field], "{what}: {field} in {told}");
        }
    }
    let why = ask(outcome, &["why"]);
    assert!(why.starts_with(&format!("First, at tick {tick} (")), "{what}: {why}");
}

macro_rules! endings {
    ($($name:ident: $job:literal, $faults:literal => $ends:expr;)*) => {$(
        #[test]
        fn $name() {
            assert_ends($job, $faults, &$ends);
        }
    )*};
}

endings! {
    a_blind_camera: "linkbar", "camera-blind" => Failing(1, "process", "E-move", "vision sees no object");
    a_silent_camera: "linkbar", "camera-silent" => Failing(1, "process", "E-move", "vision does not answer");
    no_blank: "linkbar", "blank-missing" => Failing(1, "process", "E-move", "vision sees no object");
    another_blank: "linkbar", "wrong-blank" => Failing(1, "process", "E-move", "vision does not recognise the object");
    a_blank_askew: "linkbar", "blank-askew" => Well;
    no_air: "linkbar", "air-lost" => Failing(1, "process", "Grip", "the gripper does not finish");
    a_stuck_potentiometer: "linkbar", "potentiometer-stuck" => Failing(1, "process", "Grip", "the gripper does not finish");
    a_gage_that_is_off: "linkbar", "gage-off" => Failing(1, "process", "Grip", "the gripper is not calibrated");
    bad_id_pins: "linkbar", "id-pins-bad" => Failing(1, "process", "E-move", "the id pins of the quick change name another gripper, or none");
    a_stuck_ring: "tool-change", "lock-ring-stuck" => Failing(1, "process", "Quick Change", "the locking ring of the quick change is stuck");
    a_blind_holster: "tool-change", "holster-eye-off" => Failing(1, "process", "E-move", "the sensor condition did not come");
    a_stuck_resolver: "linkbar", "resolver-stuck" => Failing(1, "off-path", "Prim", "the robot is off its commanded path");
    an_offset_resolver: "linkbar", "resolver-offset" => Failing(1, "off-path", "Prim", "the robot is off its commanded path");
    a_valve_that_stays_open: "linkbar", "valve-stuck-open" => Failing(1, "process", "Grip", "the gripper does not finish");
    a_stuck_vise: "linkbar", "vise-stuck" => Failing(1, "device", "cell", "the jaw of the vise does not move");
    a_pedestal_beside_its_mark: "clevis", "pedestal-moved" => Failing(1, "collision", "cell", "the robot ran into LCLEVIS_IH");
    a_drifting_force_sensor: "tool-change", "force-drift" => Well;
    a_noisy_cell: "linkbar", "noisy-cell" => Well;
    lost_hydraulics: "linkbar", "hydraulics-lost" => Failing(3, "power", "T3", "the hydraulics have lost their pressure");
    pulled_cable_is_explained: "linkbar", "cable-pulled" => Failing(3, "robot-controller", "T3", "the T3 controller shows WD1");
    an_absent_host: "linkbar", "host-absent" => Failing(3, "robot-controller", "T3", "the T3 controller shows WD1");
}

#[test]
fn lagging_egm_robot_is_off_its_path_on_every_surface() {
    let outcome = run_with("linkbar", 1, "egm-lags", &["--robot", "egm:sim,deviation=2"], |_| {});
    let failure = &outcome.result["failure"];
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert_eq!((&failure["kind"], &failure["process"]), (&json!("off-path"), &json!("Prim")), "{failure}");
    assert_same_account("a lagging EGM robot", &outcome);
}

/// IV.3.3 step 11: the reset of the joint at HOME corrects its reading.
#[test]
fn a_reset_at_home_repairs_an_offset_resolver() {
    const RESET: &str = "** resolvers manual\n** resolvers joint 2\n** resolvers auto\n";
    const TO_SAFE: &str = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0";
    let ends = |reset: &str| {
        let job = format!(
            "** wait 100\n{TO_SAFE} expect error\n{reset}== PAUSE -- +0 -- 0 +0 -- 0 -- 0\n{TO_SAFE}\n"
        );
        let outcome = run("reset.job", 1, "resolver-reset", |scratch| {
            scratch
                .faults("[[fault]]\nkind = \"offset\"\nsensor = \"resolver.elbow\"\nby = 200\nfrom = 100\n");
            fs::write(scratch.file("reset.job"), job).expect("the job can be written");
        });
        assert_sound("a reset of a resolver", &outcome);
        outcome
    };
    let (repaired, not) = (ends(RESET), ends(""));
    assert_eq!(repaired.status, Some(0), "{}", repaired.last_words);
    assert_eq!(not.status, Some(1), "{}", not.last_words);
    assert!(not.last_words.contains("the robot is at no known location"), "{}", not.last_words);
}

fn linkbar_with(fault: &str, ticks: [u32; 4]) -> Outcome {
    let name = fault.split('"').nth(1).unwrap_or("fault");
    run("linkbar", 1, &format!("line-{name}"), |scratch| {
        let rule = |at| format!("[[fault]]\ndirection = \"to-host\"\nat = {at}\n{fault}");
        scratch.faults(&ticks.map(rule).concat());
    })
}

#[test]
fn linkbar_survives_lost_damaged_and_late_answers_and_a_silence() {
    let undisturbed = run("linkbar", 1, "line-undisturbed", |_| {});
    let end = |outcome: &Outcome| {
        let parts = outcome.result["parts"].as_array().cloned().unwrap_or_default();
        let places = parts
            .into_iter()
            .map(|part| [part["name"].clone(), part["location"].clone(), part["sector"].clone()]);
        places.collect::<Vec<_>>()
    };
    // The bytes are lost, damaged, late by 5 ticks, or missing for 3 s.
    let faults = [
        "kind = \"drop\"\n",
        "kind = \"flip\"\n",
        "kind = \"delay\"\nticks = 5\n",
        "kind = \"stall\"\nticks = 75\n",
    ];
    for (fault, after) in faults.into_iter().zip([0, 37, 74, 111]) {
        let ticks = [200, 1100, 2300, 3900].map(|at| at + after);
        let outcome = linkbar_with(fault, ticks);
        assert_eq!(outcome.status, Some(0), "{fault} at {ticks:?}: {}", outcome.last_words);
        let struck = outcome.result["faults"]["total"].as_u64();
        assert_eq!(struck, Some(4), "{fault} at {ticks:?}: each strikes once");
        assert!(in_place("linkbar", &outcome.result), "{fault} at {ticks:?}: {}", outcome.result["parts"]);
        assert_eq!(end(&outcome), end(&undisturbed), "{fault} at {ticks:?}");
    }
}

/// The id pins fail for 20 ticks while the fingers open or close on the blank.
#[test]
fn failed_command_is_repeated_on_request() {
    for at in [800, 1305] {
        let text =
            format!("[[fault]]\nkind = \"off\"\nsensor = \"quick-change.id\"\nat = {at}\nticks = 20\n");
        let with = |retry: &str| {
            let arguments = ["--retry", retry];
            run_with("linkbar", 1, &format!("retry-{retry}-{at}"), &arguments, |scratch| {
                scratch.faults(&text)
            })
        };
        let failed = with("0");
        assert_eq!(failed.status, Some(1), "{at}: {}", failed.last_words);
        assert_eq!(failed.result["retries"].as_array().map(Vec::len), Some(0));
        let retried = with("1");
        assert_sound("the id pins fail for 20 ticks", &retried);
        assert_eq!(retried.status, Some(0), "{at}: {}", retried.last_words);
        assert!(in_place("linkbar", &retried.result), "{at}: {}", retried.result["parts"]);
        assert_eq!(retried.result["retries"].as_array().map(Vec::len), Some(1), "{at}");
        let commands = retried.result["commands"].as_array().cloned().unwrap_or_default();
        let statuses: Vec<_> = commands.iter().filter_map(|command| command["status"].as_str()).collect();
        assert_eq!(statuses[..4], ["finished", "error", "finished", "finished"], "{at}");
        let events = retried.result["events"]["first"].to_string();
        assert!(events.contains("PAUSE and the same command again, retry 1 of 1"), "{at}: {events}");
    }
}

/// The sensor of a holster fails. The run names the operator's action.
#[test]
fn failures_for_a_person_are_reported_and_not_retried() {
    let faults = |scratch: &Scratch| scratch.faults_of("holster-eye-off");
    let outcome = run_with("tool-change", 1, "retry-person", &["--retry", "3"], faults);
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    let remedy = outcome.result["failure"]["remedy"].as_str().unwrap_or_default();
    assert!(
        !remedy.is_empty() && outcome.last_words.ends_with(&format!("; to do: {remedy}")),
        "{}",
        outcome.last_words
    );
    assert_eq!(outcome.result["retries"].as_array().map(Vec::len), Some(0), "{}", outcome.result["retries"]);
}

fn with_reflectance(reflectance: f64) -> Outcome {
    run("linkbar", 1, &format!("reflectance-{reflectance}"), |scratch| {
        scratch.data_with(
            "cell.toml",
            "vision_id = 17\n",
            &format!("vision_id = 17\nreflectance = {reflectance}\n"),
        );
    })
}

#[test]
fn dark_and_shiny_blanks_are_found_with_another_exposure() {
    for reflectance in [0.08, 0.95] {
        let outcome = with_reflectance(reflectance);
        assert_eq!(outcome.status, Some(0), "{reflectance}: {}", outcome.last_words);
        assert!(in_place("linkbar", &outcome.result), "{reflectance}: {}", outcome.result["parts"]);
    }
    let black = with_reflectance(0.01);
    assert_eq!(black.status, Some(1));
    assert!(black.last_words.contains("vision sees no object"), "{}", black.last_words);
}

struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15); // splitmix64
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % end
    }

    fn one_of<'w>(&mut self, words: &[&'w str]) -> &'w str {
        words[self.below(words.len() as u64) as usize]
    }
}

const SENSORS: [&str; 24] = [
    "resolvers",
    "resolver.base",
    "resolver.shoulder",
    "resolver.pitch",
    "resolver.roll",
    "grip.potentiometer",
    "grip.strain-left",
    "grip.strain-right",
    "beam.2",
    "quick-change.locked",
    "quick-change.unlocked",
    "quick-change.id",
    "holster.right.large-1",
    "holster.right.small-2",
    "holster.centre",
    "force",
    "force.x",
    "force.z",
    "force.moment",
    "pedestal.potentiometer",
    "pedestal.strain-right",
    "table.potentiometer",
    "table.limit-plus",
    "table.limit-minus",
];
const VALVES: [&str; 12] = [
    "grip.open-fine",
    "grip.open-coarse",
    "grip.close-fine",
    "grip.close-medium",
    "grip.vent",
    "grip.supply",
    "v.close",
    "tool.open",
    "quick-change.unlock",
    "quick-change.port",
    "pedestal.close-medium",
    "pedestal.vent",
];

fn schedule(numbers: &mut Numbers) -> String {
    let mut text = format!("seed = {}\n", numbers.below(1000));
    for _ in 0..=numbers.below(3) {
        text += "\n[[fault]]\n";
        let (sensor, by) = (numbers.one_of(&SENSORS), 1 + numbers.below(300));
        let rate = numbers.below(4) == 0;
        // Writing to a String cannot fail.
        let _ = match numbers.below(12) {
            0 | 1 => writeln!(text, "kind = \"off\"\nsensor = \"{sensor}\""),
            2 | 3 => writeln!(text, "kind = \"stuck\"\nsensor = \"{sensor}\""),
            4 => writeln!(text, "kind = \"noisy\"\nsensor = \"{sensor}\"\nby = {by}"),
            5 => writeln!(text, "kind = \"slow\"\nsensor = \"{sensor}\"\nby = {}", 1 + by / 10),
            6 => writeln!(text, "kind = \"offset\"\nsensor = \"{sensor}\"\nby = {by}"),
            7 => writeln!(text, "kind = \"drift\"\nsensor = \"{sensor}\"\nby = {by}"),
            8 | 9 => {
                let (valve, value) = (numbers.one_of(&VALVES), numbers.one_of(&["open", "closed"]));
                writeln!(text, "kind = \"stuck\"\nvalve = \"{valve}\"\nvalue = \"{value}\"")
            }
            10 => writeln!(text, "kind = \"air-lost\""),
            _ => writeln!(
                text,
                "kind = \"stuck\"\ndevice = \"{}\"",
                numbers.one_of(&["lock-ring", "vise-jaw"])
            ),
        };
        let from = numbers.below(2500);
        let _ = if rate {
            writeln!(text, "from = {from}\nrate = 0.01\nticks = {}", 1 + numbers.below(50))
        } else if numbers.below(2) == 0 {
            writeln!(text, "from = {from}")
        } else {
            writeln!(text, "at = {from}\nticks = {}", 1 + numbers.below(400))
        };
    }
    text
}

fn number(name: &str, otherwise: u64) -> u64 {
    env::var(name).ok().map_or(otherwise, |text| {
        text.parse().unwrap_or_else(|_| panic!("{name}: a number was expected, found {text:?}"))
    })
}

#[test]
fn every_fault_ends_in_a_true_report() {
    let first = number("RCS_FAULT_SEED", 28);
    let mut ends = [0, 0, 0];
    for seed in first..first + number("RCS_FAULT_RUNS", 6) {
        let mut numbers = Numbers(seed);
        let job = numbers.one_of(&["linkbar", "clevis", "tool-change", "turned-part"]);
        let text = schedule(&mut numbers);
        let what = format!("{job}, seed {seed}, with\n{text}\n");
        let outcome = run(job, seed, &format!("campaign-{seed}"), |scratch| scratch.faults(&text));
        if outcome.result["cell_faults"].is_array() {
            assert_sound(&what, &outcome);
        }
        match outcome.status {
            Some(0) => {
                assert!(in_place(job, &outcome.result), "{what}finished, but {}", outcome.result["parts"]);
                ends[0] += 1;
            }
            _ => {
                let failure = &outcome.result["failure"];
                assert!(failure["process"].is_string() && failure["text"].is_string(), "{what}{failure}");
                ends[usize::from(outcome.status == Some(3)) + 1] += 1;
            }
        }
        println!("seed {seed}: {job} {:?} {}", outcome.status, outcome.last_words);
    }
    println!("{} finished, {} failed, {} stopped", ends[0], ends[1], ends[2]);
}
