//! Runs with emulated couplers between the controller and the cell.

use std::{
    fmt::Write as _,
    fs,
    path::Path,
    sync::{Arc, Mutex},
};

use field::Presence;
use interfaces::point::{Group, Point};
use rcs_core::tick::Tick;
use runtime::{
    ClockKind, Ending, Event, FieldConfig, LogTarget, Observer, Run, RunConfig, RunOutcome, StartError,
};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
/// Event codes of a lost part or gripper.
const LOST: [&str; 6] = [
    "cell.dropped",
    "cell.fell",
    "cell.slipped",
    "cell.gripper-fell",
    "cell.forced-out",
    "cell.gripper-torn",
];

fn config() -> RunConfig {
    RunConfig {
        log: LogTarget::None,
        shared_memory: false,
        field: Some(FieldConfig::simulated("station")),
        ..RunConfig::new(DATA, "linkbar")
    }
}

#[derive(Clone, Default)]
struct Codes(Arc<Mutex<Vec<&'static str>>>); // records the codes of the events

impl Observer for Codes {
    fn event(&mut self, _: Tick, event: &Event) {
        self.0.lock().unwrap().push(event.code());
    }
}

impl Codes {
    fn count(&self, code: &str) -> usize {
        self.0.lock().unwrap().iter().filter(|one| **one == code).count()
    }
}

/// A run in which the connections of these devices are cut for some ticks.
fn cut(devices: &[&str], at: u64, ticks: u64) -> (RunOutcome, Codes) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cuts.toml");
    let mut text = String::new();
    for device in devices {
        writeln!(text, "[[fault]]\nkind = \"field-cut\"\ndevice = \"{device}\"\nat = {at}\nticks = {ticks}")
            .unwrap();
    }
    fs::write(&path, text).unwrap();
    let codes = Codes::default();
    let config = RunConfig { faults: Some(path), retry: 3, ..config() };
    let outcome = Run::new(config, Box::new(codes.clone())).unwrap().complete();
    for code in LOST {
        assert_eq!(codes.count(code), 0, "{devices:?} cut at tick {at} for {ticks} ticks: {code}");
    }
    (outcome, codes)
}

fn mapping(change: impl FnOnce(String) -> String) -> (tempfile::TempDir, FieldConfig) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("changed.toml");
    let text = fs::read_to_string(Path::new(DATA).join("field/station.toml")).unwrap();
    fs::write(&path, change(text)).unwrap();
    let field = FieldConfig::simulated(path);
    (directory, field)
}

/// Removes the devices of the workstation, whose lines the cell then executes at once.
fn without_workstation(text: String) -> String {
    let points = text.split("\n# Lines of jobs").next().unwrap().lines();
    let is_kept = |line: &&str| {
        !["vise.", "machine.", "tray."].iter().any(|group| line.starts_with(&format!("\"{group}")))
    };
    points.filter(is_kept).map(|line| format!("{line}\n")).collect()
}

#[test]
fn couplers_without_a_fault_leave_the_cell_unchanged() {
    let (_directory, field) = mapping(without_workstation);
    let mut plain = Run::new(RunConfig { field: None, ..config() }, Box::new(())).unwrap();
    let mut through = Run::new(RunConfig { field: Some(field), ..config() }, Box::new(())).unwrap();
    loop {
        let more = [plain.step(), through.step()];
        assert_eq!(more[0], more[1], "tick {}", plain.last_tick());
        if !plain.last_tick().0.is_multiple_of(50) && more[0] {
            continue;
        }
        assert_eq!(plain.cell_digest(), through.cell_digest(), "tick {}", plain.last_tick());
        if !more[0] {
            break;
        }
    }
    let outcome = through.finish();
    assert!(outcome.is_finished());
    let field = outcome.result.field.expect("couplers");
    assert!(field.devices.iter().all(|device| device.confirmed), "safe outputs at the end: {field}");
}

fn failure(outcome: &RunOutcome) -> String {
    if let Ending::Failed(account) = &outcome.ending { account.to_string() } else { String::new() }
}

#[test]
fn lines_are_executed_by_the_devices_behind_the_couplers() {
    for job in ["linkbar", "clevis", "turned-part", "tool-change"] {
        let codes = Codes::default();
        let config = RunConfig { job: job.into(), ..config() };
        let outcome = Run::new(config, Box::new(codes.clone())).unwrap().complete();
        assert!(outcome.is_finished(), "{job}: {}", failure(&outcome));
        assert!(codes.count("io.asks") > 0, "a person fills the trays");
        for code in LOST {
            assert_eq!(codes.count(code), 0, "{job}: {code}");
        }
    }
}

#[test]
fn job_with_a_line_without_an_entry_is_refused() {
    let (_directory, field) =
        mapping(|text| text.replace("line = \"vise close PFIXTURE\"", "line = \"vise close OTHER\""));
    let refused = Run::new(RunConfig { field: Some(field), ..config() }, Box::new(())).err().unwrap();
    assert!(matches!(&refused, StartError::LinesWithoutDevices(lines) if lines.len() == 2), "{refused}");
    let said = "`** vise close PFIXTURE`: the mapping has no [[line]] with line = \"vise close PFIXTURE\"";
    assert!(refused.to_string().contains(said), "{refused}");
}

#[test]
fn job_at_the_panel_of_another_robot_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let job = directory.path().join("panel.job");
    fs::write(&job, "** panel fault-reset\n** after 2 estop pedestal\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n")
        .unwrap();
    let config = RunConfig {
        job: job.display().to_string(),
        field: None,
        robot: "egm:6510".parse().unwrap(),
        clock: ClockKind::Real,
        ..config()
    };
    let refused = Run::new(config, Box::new(())).err().unwrap();
    assert!(matches!(&refused, StartError::PanelElsewhere(lines) if lines.len() == 2), "{refused}");
    assert!(refused.to_string().contains("`** panel fault-reset`: the robot has its own panel"), "{refused}");
}

#[test]
fn trip_during_machining_ends_the_run_without_a_second_start() {
    let undisturbed = Run::new(config(), Box::new(())).unwrap().complete();
    let machining = undisturbed.steps.iter().find(|step| step.text.contains("machine")).unwrap();
    let machined = machining.began.0;
    let (outcome, codes) = cut(&["fixture"], machined + 30, 50);
    assert!(!outcome.is_finished());
    assert_eq!(codes.count("io.tripped"), 1);
    let said = failure(&outcome);
    assert!(said.contains("fixture is tripped; after `io go fixture`, `job go` waits for the end"), "{said}");
}

#[test]
fn repetition_of_a_log_has_the_same_couplers() {
    let directory = tempfile::tempdir().unwrap();
    let log = directory.path().join("run.mcap");
    let config = RunConfig { log: LogTarget::File(log.clone()), ticks: Some(200), ..config() };
    let first = Run::new(config, Box::new(())).unwrap().complete();
    let files = tempfile::tempdir().unwrap();
    let config = runtime::repeat::unpack(&record::Log::open(&log).unwrap(), files.path()).unwrap();
    assert!(config.field.as_ref().is_some_and(|field| field.is_simulated));
    let again = Run::new(config, Box::new(())).unwrap().complete();
    assert_eq!(first.result.digest, again.result.digest);
}

#[test]
fn short_cuts_need_no_operator() {
    for at in [130, 450, 770, 1090, 1410, 1730] {
        let (outcome, codes) = cut(&["arm"], at, 1);
        assert!(outcome.is_finished(), "one tick at {at}");
        assert_eq!(codes.count("io.stale"), 0);
        let (outcome, codes) = cut(&["arm"], at, 5);
        assert!(outcome.is_finished(), "0.2 s at tick {at}");
        assert_eq!((codes.count("io.stale"), codes.count("io.back"), codes.count("io.tripped")), (1, 1, 0));
    }
    let (outcome, _) = cut(&["fixture", "pedestal"], 900, 5);
    assert!(outcome.is_finished());
}

#[test]
fn long_cuts_wait_for_an_operator_and_drop_nothing() {
    for at in [450, 1090, 1730] {
        let (outcome, codes) = cut(&["arm"], at, 50);
        assert!(!outcome.is_finished(), "2 s at tick {at}");
        assert_eq!((codes.count("io.stale"), codes.count("io.released")), (1, 0));
        let Ending::Failed(account) = &outcome.ending else { panic!("2 s at tick {at}") };
        assert!(account.is_stopped(), "stopped devices are not a failure of the job: {account}");
        assert!(account.first.text.contains("grip.potentiometer"), "the held readings: {account}");
    }
}

/// The points of a group, or all of a workstation's group, in the shipped mapping, replaced by one of these words.
fn with_group(text: &str, group: Group, presence: Presence) -> String {
    let is_of = |point: Option<Point<'_>>| point.is_some_and(|point| point.group() == group);
    let (points, lines) = text.split_once("\n[[line]]").unwrap();
    let mut changed = String::new();
    for line in points.lines() {
        let name = line.strip_prefix('"').and_then(|line| line.split('"').next()).unwrap_or_default();
        let (is_input, is_output) = (is_of(Point::read(name)), is_of(Point::written(name)));
        let is_read = is_input && !line.contains("holding");
        if line == "[out]" && presence != Presence::Fixed {
            writeln!(changed, "[groups]\n{} = \"{}\"\n", group.name(), presence.name()).unwrap();
        }
        if is_read && presence == Presence::Fixed {
            writeln!(changed, "\"{name}\" = {{ fixed = {} }}", u8::from(group == Group::Supply)).unwrap();
        } else if !(is_read || is_output) {
            writeln!(changed, "{line}").unwrap();
        }
    }
    let word = if group == Group::Trays { "tray" } else { group.name() };
    let others = lines.split("\n[[line]]").filter(|line| {
        ![format!("\"{word}."), format!("\"!{word}."), format!("\"{word} ")]
            .iter()
            .any(|of| line.contains(of))
    });
    for line in others {
        writeln!(changed, "\n[[line]]{line}").unwrap();
    }
    changed
}

#[test]
fn every_group_can_be_simulated_fixed_or_absent_and_the_start_says_so() {
    let text = fs::read_to_string(Path::new(DATA).join("field/station.toml")).unwrap();
    // The entry of the machine needs the vise.
    let needed = |group, presence| match group {
        Group::Vise => true,
        Group::Machine | Group::Trays => presence != Presence::Simulated,
        _ => false,
    };
    for group in Group::ALL {
        for presence in [Presence::Simulated, Presence::Absent, Presence::Fixed] {
            let has_inputs = ![Group::V, Group::Vision].contains(&group);
            if (presence == Presence::Fixed && !has_inputs) || group == Group::Vision {
                continue;
            }
            let case = format!("{} {}", group.name(), presence.name());
            let (_directory, field) = mapping(|_| with_group(&text, group, presence));
            let read = runtime::field::read(&field.mapping).unwrap_or_else(|error| panic!("{case}: {error}"));
            assert_eq!(read.presence(group), presence, "{case}");
            let config = RunConfig { field: Some(field), ..config() };
            let said = runtime::field::introduction(&config, &read).join(" ");
            let (through, beside) = said.split_once("; not through them: ").unwrap();
            let expected = match presence {
                Presence::Simulated => group.name().to_owned(),
                other => format!("{} ({})", group.name(), other.name()),
            };
            let part = if presence == Presence::Simulated { beside } else { through };
            assert!(part.split([',', ';', ':']).any(|word| word.trim() == expected), "{case}: {said}");
            let refused = Run::new(config, Box::new(())).err();
            assert_eq!(refused.is_some(), needed(group, presence), "{case}: {refused:?}");
        }
    }
}

/// A log of a run with two cuts, one of which trips its device.
#[test]
fn log_with_a_trip_replays_without_devices() {
    let directory = tempfile::tempdir().unwrap();
    let faults = directory.path().join("cuts.toml");
    let cut = |device, at, ticks| {
        format!("[[fault]]\nkind = \"field-cut\"\ndevice = \"{device}\"\nat = {at}\nticks = {ticks}\n")
    };
    fs::write(&faults, cut("arm", 500, 5) + &cut("fixture", 700, 15)).unwrap();
    let log = directory.path().join("run.mcap");
    let config = RunConfig { log: LogTarget::File(log.clone()), faults: Some(faults), ..config() };
    let codes = Codes::default();
    let outcome = Run::new(config, Box::new(codes.clone())).unwrap().complete();
    assert_eq!((codes.count("io.back"), codes.count("io.tripped")), (1, 1), "{}", failure(&outcome));
    let report = record::replay(&log).unwrap();
    assert!(report.is_same() && report.ticks > 700, "{report:?}");
}

#[test]
fn cut_of_an_unknown_device_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cuts.toml");
    fs::write(&path, "[[fault]]\nkind = \"field-cut\"\ndevice = \"leg\"\nat = 5\n").unwrap();
    let refused = |field| {
        let config = RunConfig { faults: Some(path.clone()), field, ..config() };
        Run::new(config, Box::new(())).err().unwrap()
    };
    let error = refused(config().field);
    assert!(matches!(error, StartError::NoSuchDevice { .. }), "{error}");
    assert!(error.to_string().contains("one of arm, fixture, pedestal"), "{error}");
    assert!(refused(None).to_string().contains("add --field"), "no couplers");
}
