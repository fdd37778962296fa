//! Couplers in simulated time, with sensors and valves of the test instead of a cell.

use couplers::Report;
use diagnostics::Source;
use interfaces::{
    CommonMemory,
    device::{GroupHealth, KNOB_FULL, valve},
};

use super::*;

fn station() -> SimulatedField {
    changed(|text| text)
}

/// The shipped station with a change of its mapping.
fn changed(change: impl FnOnce(String) -> String) -> SimulatedField {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/field/station.toml");
    let text = change(std::fs::read_to_string(path).unwrap());
    let mapping = Mapping::parse(&Source { name: path.to_owned(), text: text.into() }).unwrap();
    SimulatedField::new(Arc::new(mapping), &sensors(0)).unwrap()
}

fn sensors(tick: u64) -> DeviceInputs {
    let mut inputs = DeviceInputs::default();
    inputs.grip.potentiometer = 1000 + u16::try_from(tick).unwrap();
    inputs.joystick.velocity = KNOB_FULL;
    inputs
}

fn closing() -> DeviceOutputs {
    let mut outputs = DeviceOutputs::default();
    outputs.grip.bits = valve::SUPPLY | valve::CLOSE_COARSE;
    outputs.tool_grip.close = true;
    outputs
}

struct Bench {
    field: SimulatedField,
    tick: u64,
}

impl Bench {
    fn new() -> Self {
        Self { field: station(), tick: 0 }
    }

    /// Run a tick. Returns the outputs at the valves and the inputs of the controller.
    fn step(&mut self, outputs: &DeviceOutputs, cut: &str) -> (DeviceOutputs, DeviceInputs) {
        self.tick += 1;
        let valves = self.field.write(Tick(self.tick), outputs, |device| device == cut);
        (valves, self.field.read(Tick(self.tick), &sensors(self.tick)))
    }

    fn steps(&mut self, ticks: u64, outputs: &DeviceOutputs, cut: &str) -> (DeviceOutputs, DeviceInputs) {
        (0..ticks).map(|_| self.step(outputs, cut)).last().unwrap()
    }

    fn codes(&mut self) -> Vec<&'static str> {
        self.field.desk.take_events().iter().map(FieldEvent::code).collect()
    }
}

#[test]
fn words_pass_the_couplers_without_delay() {
    let mut bench = Bench::new();
    for tick in 1..=100 {
        let outputs = if tick % 3 == 0 { closing() } else { DeviceOutputs::default() };
        let (valves, inputs) = bench.step(&outputs, "");
        assert_eq!((valves.grip, valves.tool_grip), (outputs.grip, outputs.tool_grip), "tick {tick}");
        assert_eq!(inputs.grip.potentiometer, sensors(tick).grip.potentiometer, "tick {tick}");
        assert_eq!(inputs.field.any, GroupHealth::Fresh);
    }
    assert!(bench.codes().is_empty());
    assert_eq!(bench.field.desk.status(), "arm 8 ms, fixture 8 ms, pedestal 8 ms");
}

#[test]
fn short_cut_keeps_the_inputs_and_goes_unnoticed() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    let (valves, inputs) = bench.step(&closing(), "arm");
    assert_eq!(valves.grip, closing().grip, "the watchdog has not fired");
    assert_eq!((inputs.grip.potentiometer, inputs.field.any), (1010, GroupHealth::Fresh));
    let (_, inputs) = bench.steps(3, &closing(), "");
    assert_eq!((inputs.grip.potentiometer, inputs.field.any), (1014, GroupHealth::Fresh));
    assert!(bench.codes().is_empty());
}

#[test]
fn cut_of_a_fifth_of_a_second_is_stale_and_recovers() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    let (valves, inputs) = bench.steps(5, &closing(), "arm");
    assert_eq!(valves.grip, closing().grip, "the watchdog has not fired");
    assert_eq!((inputs.field.grip, inputs.field.hand), (GroupHealth::Stale, GroupHealth::Fresh));
    assert_eq!((inputs.grip.potentiometer, inputs.joystick.velocity), (1010, 0), "held, and the knob at 0");
    let (_, inputs) = bench.steps(10, &closing(), "");
    assert_eq!((inputs.field.any, inputs.grip.potentiometer), (GroupHealth::Fresh, 1025));
    assert_eq!(bench.codes(), ["io.stale", "io.back"]);
}

#[test]
fn long_cut_makes_the_outputs_safe_until_a_release() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    let (valves, inputs) = bench.steps(50, &closing(), "arm");
    assert_eq!((valves.grip.bits, valves.tool_grip.close), (0, false), "the watchdog has fired");
    assert_eq!(inputs.field.grip, GroupHealth::Lost);
    let (valves, inputs) = bench.steps(25, &closing(), "");
    assert_eq!((valves.grip.bits, inputs.field.grip), (0, GroupHealth::Tripped));
    assert!(bench.field.desk.release("arm") && !bench.field.desk.release("leg"));
    let (valves, _) = bench.steps(2, &closing(), "");
    assert_eq!(valves.grip.bits, 0, "not while an output is asked for that may not be on at rest");
    let at_rest = DeviceOutputs { grip: Default::default(), ..closing() };
    assert!(bench.field.desk.release("arm"));
    let (valves, inputs) = bench.steps(2, &at_rest, "");
    assert!(valves.tool_grip.close && inputs.field.any == GroupHealth::Fresh);
    assert_eq!(bench.codes(), ["io.stale", "io.tripped", "io.refused", "io.released"]);
}

/// With couplers of any kind, a cut of a fifth of a second recovers, and a longer one trips.
#[test]
fn every_kind_of_coupler_is_simulated() {
    for (kind, fallback, watchdog) in [
        ("ek9000", "zero", "watchdog_ms = 500"),
        ("wago", "zero", "watchdog_ms = 500"),
        ("turck", "zero", "watchdog_ms = 500"),
        ("values", "values", "watchdog_ms = 1000"),
        ("plain", "hold", ""),
    ] {
        let mut bench = Bench { tick: 0, field: changed(|text| of_kind(&text, kind, fallback, watchdog)) };
        let (valves, inputs) = bench.steps(10, &closing(), "");
        assert_eq!((valves.grip, inputs.grip.potentiometer), (closing().grip, 1010), "{kind}");
        bench.steps(5, &closing(), "arm");
        let (valves, inputs) = bench.steps(10, &closing(), "");
        assert_eq!((valves.grip, inputs.field.any), (closing().grip, GroupHealth::Fresh), "{kind}");
        assert_eq!(bench.codes(), ["io.stale", "io.back"], "{kind}");
        bench.steps(50, &closing(), "arm");
        let (valves, inputs) = bench.steps(25, &closing(), "");
        assert_eq!((valves.grip.bits, inputs.field.grip), (0, GroupHealth::Tripped), "{kind}");
    }
}

/// A mapping with couplers of another kind. Without a watchdog, all outputs must be permitted at rest.
fn of_kind(text: &str, kind: &str, fallback: &str, watchdog: &str) -> String {
    let mut text = text
        .replace("\"bk9000\"", &format!("{kind:?}"))
        .replace("\"zero\"", &format!("{fallback:?}"))
        .replace("watchdog_ms = 500", watchdog);
    match kind {
        "wago" => text = text.replace("holding 0x8", "holding 0x2"),
        "plain" => text = text.replace(", rest = true", "").replace("safe = 0", "safe = 0, rest = true"),
        _ => {}
    }
    text
}

/// A mapping with these entries of `[holds]`.
fn with_holds(text: &str, holds: &str) -> String {
    text.replacen("\n[out]\n", &format!("\n[holds]\n{holds}\n[out]\n"), 1)
}

#[test]
fn gripper_without_current_does_as_the_mapping_says() {
    let at_rest = DeviceOutputs::default();
    for (holds, grip, tool) in [
        ("grip = \"trapped-air\"\ntool = \"check-valve\"\n", 0, [false, false]),
        ("grip = \"spring\"\ntool = \"spring\"\n", valve::SUPPLY | valve::CLOSE_COARSE, [true, false]),
        ("grip = \"nothing\"\ntool = \"nothing\"\n", valve::SUPPLY | valve::OPEN_COARSE, [false, true]),
    ] {
        let mut bench = Bench { field: changed(|text| with_holds(&text, holds)), tick: 0 };
        let state = |(valves, _): (DeviceOutputs, _)| {
            (valves.grip.bits, [valves.tool_grip.close, valves.tool_grip.open])
        };
        bench.steps(10, &closing(), "");
        assert_eq!(
            state(bench.steps(5, &at_rest, "")),
            (0, [false, false]),
            "{holds} off in normal operation"
        );
        assert_eq!(state(bench.steps(10, &at_rest, "arm")), (0, [false, false]), "{holds} late");
        assert_eq!(state(bench.steps(40, &at_rest, "arm")), (grip, tool), "{holds} after the fallback");
        assert_eq!(state(bench.steps(25, &at_rest, "")), (grip, tool), "{holds} tripped");
        assert!(bench.field.desk.release("arm"));
        assert_eq!(state(bench.steps(3, &at_rest, "")), (0, [false, false]), "{holds} released");
    }
}

#[test]
fn copy_continues_alike() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    let mut copy = Bench { field: bench.field.clone(), tick: bench.tick };
    for tick in 0..60 {
        let cut = if tick < 15 { "fixture" } else { "" };
        assert_eq!(bench.step(&closing(), cut), copy.step(&closing(), cut));
    }
    assert_eq!(bench.codes(), copy.codes());
}

#[test]
fn ordered_safe_outputs_wait_for_a_release() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    assert!(bench.field.desk.make_safe("arm") && !bench.field.desk.make_safe("leg"));
    let (valves, inputs) = bench.steps(2, &closing(), "");
    assert_eq!((valves.grip.bits, valves.tool_grip.close), (0, false));
    assert_eq!((inputs.field.grip, inputs.field.hand), (GroupHealth::Tripped, GroupHealth::Fresh));
    assert!(bench.field.desk.release("arm"));
    let at_rest = DeviceOutputs { grip: Default::default(), ..closing() };
    let (valves, inputs) = bench.steps(2, &at_rest, "");
    assert!(valves.tool_grip.close && inputs.field.any == GroupHealth::Fresh);
    assert_eq!(bench.codes(), ["io.tripped", "io.released"]);
}

#[test]
fn end_makes_the_outputs_safe_and_says_whether_that_is_confirmed() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    bench.step(&closing(), "pedestal");
    bench.field.end(&sensors(0));
    let events = bench.field.desk.take_events();
    let confirmed: Vec<_> = events.iter().map(|event| (event.device.as_str(), event.what.clone())).collect();
    let ended = |is_confirmed, on: &[&str]| {
        let on = on.iter().map(|name| (*name).to_owned()).collect();
        FieldChange::Ended { is_confirmed, on }
    };
    let expected = [
        ("arm", ended(true, &["tool.close"])),
        ("fixture", ended(true, &[])),
        ("pedestal", ended(false, &[])),
    ];
    assert_eq!(confirmed, expected);
    assert!(events[0].to_string().contains("except tool.close"), "{}", events[0]);
    let arm = bench.field.desk.mapping().device("arm").unwrap();
    let left = bench.field.simulated[arm].coupler().outputs()[0];
    assert_eq!(left, 1 << 11, "tool.close may be on at rest and stays on");
}

#[test]
fn points_are_shown_with_raw_words_and_ages() {
    let mut bench = Bench::new();
    let (_, inputs) = bench.steps(10, &closing(), "");
    let shown = |name: &str| bench.field.desk.show(name, &inputs);
    assert_eq!(
        shown("grip.potentiometer").as_deref(),
        Some("grip.potentiometer: raw 8082, 1010 in the controller; arm, 8 ms old")
    );
    assert_eq!(
        shown("grip.supply").as_deref(),
        Some("grip.supply: commanded 1, acknowledged 1; arm is running")
    );
    assert_eq!(shown("grip.missing"), None);
    bench.steps(5, &closing(), "arm");
    let event = &bench.field.desk.take_events()[0];
    let text = event.to_string();
    assert!(
        text.starts_with("arm has not answered for ") && text.contains("grip.potentiometer 1010"),
        "{text}"
    );
}

#[test]
fn open_safety_circuit_makes_all_outputs_safe() {
    let mut bench = Bench::new();
    bench.steps(10, &closing(), "");
    let inputs = &bench.field.desk.mapping().inputs;
    let safety = inputs.iter().position(|point| point.name == SAFETY).unwrap();
    bench.field.sensed[safety] = 0;
    let (valves, _) = bench.steps(3, &closing(), "");
    assert_eq!((valves.grip.bits, valves.tool_grip.close), (0, false));
    assert!(bench.field.desk.release("arm"));
    let (valves, _) = bench.steps(3, &closing(), "");
    assert_eq!((valves.grip.bits, valves.tool_grip.close), (0, false), "not while it is open");
    bench.field.sensed[safety] = 1;
    let at_rest = DeviceOutputs { grip: Default::default(), ..closing() };
    let (valves, _) = bench.steps(3, &at_rest, "");
    assert!(!valves.tool_grip.close, "not before a release");
    assert!(bench.field.desk.release("arm"));
    let (valves, _) = bench.steps(3, &at_rest, "");
    assert!(valves.tool_grip.close);
    let tripped = ["io.tripped"; 3];
    assert_eq!(bench.codes(), [&tripped[..], &["io.refused", "io.released"]].concat());
}

/// A controller that has closed the tool gripper and supplies the parts gripper, and its devices, whose first output
/// words are these.
fn resumed(arm: u16, fixture: u16) -> (FieldController, CommonMemory, [usize; 2]) {
    let mapping = station().desk.mapping().clone();
    let [arm_at, fixture_at] = ["arm", "fixture"].map(|name| mapping.device(name).unwrap());
    let reports = |index| {
        let mut report = Report { state: State::Running, ..Report::STARTING };
        report.acknowledged.words[0] = [(arm_at, arm), (fixture_at, fixture)]
            .into_iter()
            .find_map(|(at, word)| (at == index).then_some(word))
            .unwrap_or_default();
        report
    };
    let count = mapping.devices.len();
    let mut desk = FieldController::new(Arc::new(mapping));
    desk.observe(0, (0..count).map(reports));
    desk.begin();
    let mut memory = CommonMemory::default();
    memory.tool_grip.valves.close = true;
    memory.grip.valves.bits = valve::SUPPLY;
    (desk, memory, [arm_at, fixture_at])
}

const TOOL_CLOSE: u16 = 1 << 11; // bits of the first output word of the arm
const SUPPLY: u16 = 1 << 7;
const VISE_CLOSE: u16 = 1 << 2; // a bit of the first output word of the fixture

fn closed_vise(desk: &FieldController) -> Vec<i64> {
    let close = |point: &field::OutPoint| i64::from(point.name == "vise.PFIXTURE.close");
    desk.mapping().outputs.iter().map(close).collect()
}

#[test]
fn outputs_that_may_be_on_and_were_set_are_kept_until_the_first_command() {
    let (mut desk, mut memory, [arm, fixture]) = resumed(TOOL_CLOSE, VISE_CLOSE);
    let vise = closed_vise(&desk);
    let found = desk.adopt(&memory, &[vise]);
    assert_eq!(found.adopted, ["tool.close", "vise.PFIXTURE.close"]);
    assert_eq!((found.cleared, found.unknown), (vec!["grip.supply".to_owned()], Vec::new()));
    let words = |desk: &mut FieldController, memory: &CommonMemory| {
        desk.note_commands(memory);
        desk.order(Tick(8), &memory.device_outputs());
        let orders: Vec<u16> = desk.orders().map(|orders| orders.words.words[0]).collect();
        [orders[arm], orders[fixture]]
    };
    memory.prim.t3i.number += 1;
    assert_eq!(words(&mut desk, &memory), [TOOL_CLOSE, VISE_CLOSE], "the link has no outputs");
    memory.task.subtask.number += 1;
    assert_eq!(words(&mut desk, &memory), [TOOL_CLOSE | SUPPLY, VISE_CLOSE]);
}

#[test]
fn outputs_that_the_earlier_run_did_not_set_are_named() {
    let (mut desk, mut memory, [arm, fixture]) = resumed(TOOL_CLOSE, VISE_CLOSE);
    memory.tool_grip.valves.close = false;
    let off = vec![0; desk.mapping().outputs.len()];
    let found = desk.adopt(&memory, &[off]);
    let expected = [(arm, "tool.close".to_owned()), (fixture, "vise.PFIXTURE.close".to_owned())];
    assert_eq!(found.unknown, expected);
    let (mut desk, memory, _) = resumed(SUPPLY, 0);
    assert_eq!(desk.adopt(&memory, &[]).unknown, [(arm, "grip.supply".to_owned())], "not at rest");
}
