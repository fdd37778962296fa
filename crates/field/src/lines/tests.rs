//! A machine and a vise that the tests operate by their inputs.

use couplers::{InWords, OutWords};
use diagnostics::Source;
use rcs_core::Plain as _;

use super::*;

const MAPPING: &str = r#"form = 1

[device.fixture]
address = "127.0.0.1:1502"
unit = 1
kind = "bk9000"
fallback = "zero"
watchdog_ms = 500

[in]
"vise.V.opened"     = { at = "fixture input 0.0" }
"vise.V.partial"    = { at = "fixture input 0.1" }
"vise.V.clamped"    = { at = "fixture input 0.2" }
"vise.V.program"    = { at = "fixture input 1" }
"machine.V.ready"   = { at = "fixture input 0.3" }
"machine.V.busy"    = { at = "fixture input 0.4" }
"machine.V.done"    = { at = "fixture input 0.5" }
"machine.V.fault"   = { at = "fixture input 0.6" }
"machine.V.clear"   = { at = "fixture input 0.7" }

[out]
"vise.V.open"       = { at = "fixture holding 0x800.0", safe = 0 }
"vise.V.partial"    = { at = "fixture holding 0x800.1", safe = 0 }
"vise.V.close"      = { at = "fixture holding 0x800.2", safe = 0, rest = true }
"vise.V.program"    = { at = "fixture holding 0x801", safe = 0, rest = true }
"machine.V.start"   = { at = "fixture holding 0x800.3", safe = 0 }
"machine.V.program" = { at = "fixture holding 0x802", safe = 0, rest = true }

[[line]]
line = "machine BLANK PART V"
needs = ["machine.V.ready", "machine.V.clear", "vise.V.clamped"]
sets = { "machine.V.program" = 17, "machine.V.start" = 1 }
begun = ["machine.V.busy"]
begun_within_s = 2
done = ["machine.V.done", "!machine.V.busy"]
while = ["vise.V.clamped"]
fault = ["machine.V.fault"]
within_s = 900
then = { "machine.V.start" = 0 }

[[line]]
line = "vise open V"
sets = { "vise.V.open" = 1, "vise.V.close" = 0 }
done = ["vise.V.opened", "!vise.V.clamped"]
within_s = 10
then = { "vise.V.open" = 0 }
"#;

const MACHINE: &str = "machine BLANK PART V";
const READY: u16 = 1 << 3;
const BUSY: u16 = 1 << 4;
const DONE: u16 = 1 << 5;
const FAULT: u16 = 1 << 6;
const CLEAR: u16 = 1 << 7;
const OPENED: u16 = 1 << 0;
const CLAMPED: u16 = 1 << 2;
const IDLE: u16 = READY | CLEAR | CLAMPED; // the machine before its start
const WORKS: u16 = BUSY | CLEAR | CLAMPED;
const START: u16 = 1 << 3;

struct Bench {
    mapping: Mapping,
    lines: Lines,
    inputs: u16,
    is_tripped: bool,
    age_ms: u32,
    starts: u32, // rising edges of the machine's start output
    last: u16,
}

impl Bench {
    fn new(inputs: u16) -> Self {
        let source = Source { name: "bench.toml".to_owned(), text: MAPPING.into() };
        let mapping = Mapping::parse(&source).unwrap();
        let lines = Lines::new(&mapping);
        Self { mapping, lines, inputs, is_tripped: false, age_ms: 8, starts: 0, last: 0 }
    }

    fn begin(&mut self, line: &str) {
        self.lines.begin(&self.mapping, line).unwrap();
    }

    fn ticks(&mut self, inputs: u16, count: u64) -> &mut Self {
        self.inputs = inputs;
        for _ in 0..count {
            let mut words = InWords::ZERO;
            words.words[0] = self.inputs;
            let seen = Seen { words, age_ms: Some(self.age_ms), is_tripped: self.is_tripped };
            self.lines.step(&self.mapping, &[seen]);
            let now = self.output();
            self.starts += u32::from(now & START != 0 && self.last & START == 0);
            self.last = now;
            if self.lines.failure().is_some() {
                break;
            }
        }
        self
    }

    fn output(&self) -> u16 {
        let mut images = [OutWords::ZERO];
        self.mapping.collect_station(self.lines.outputs(), &mut images);
        images[0].words[0]
    }

    fn failed(&self) -> String {
        assert!(!self.lines.is_busy());
        self.lines.failure().expect("a failure").to_string()
    }

    fn ended(&self) -> bool {
        !self.lines.is_busy() && self.lines.failure().is_none()
    }
}

#[test]
fn machining_of_fifteen_minutes_ends_in_time() {
    let mut bench = Bench::new(IDLE);
    bench.begin(MACHINE);
    bench.ticks(IDLE, 3);
    assert_eq!(bench.output() & START, START);
    bench.ticks(WORKS, 1);
    assert_eq!(bench.output() & START, 0, "the start ends when the machine has taken it");
    bench.ticks(WORKS, 890 * TICKS_PER_S).ticks(IDLE | DONE, 1);
    assert!(bench.ended());
    assert_eq!((bench.starts, bench.output()), (1, 0));
}

#[test]
fn done_of_the_last_cycle_ends_no_line() {
    let mut bench = Bench::new(IDLE | DONE);
    bench.begin(MACHINE);
    bench.ticks(IDLE | DONE, 40);
    assert!(bench.lines.is_busy());
    bench.ticks(IDLE | DONE, 20);
    assert_eq!(
        bench.failed(),
        "`machine BLANK PART V` has not begun within 2 s: machine.V.busy is 0, 1 was expected"
    );
    assert_eq!(bench.output() & START, 0);
    let mut fast = Bench::new(IDLE | DONE);
    fast.begin(MACHINE);
    fast.ticks(IDLE | DONE, 2).ticks(IDLE, 2).ticks(IDLE | DONE, 1);
    assert!(fast.ended(), "seen off, without a tick in which it was busy");
}

#[test]
fn missing_need_fault_and_lost_clamp_are_named() {
    for (needs, said) in [
        (READY | CLAMPED, "cannot begin: machine.V.clear is 0, 1 was expected"),
        (READY | CLEAR, "cannot begin: vise.V.clamped is 0, 1 was expected"),
        (CLEAR | CLAMPED, "cannot begin: machine.V.ready is 0, 1 was expected"),
        (IDLE | FAULT, "the device reports a fault: machine.V.fault is 1"),
    ] {
        let mut bench = Bench::new(needs);
        bench.begin(MACHINE);
        bench.ticks(needs, 1);
        assert!(bench.failed().ends_with(said), "{}", bench.failed());
        assert_eq!(bench.starts, 0);
    }
    for (inputs, said) in [
        (WORKS & !CLAMPED, "is no longer safe: vise.V.clamped is 0, 1 was expected"),
        (WORKS | FAULT, "the device reports a fault: machine.V.fault is 1"),
    ] {
        let mut bench = Bench::new(IDLE);
        bench.begin(MACHINE);
        bench.ticks(IDLE, 1).ticks(WORKS, 10).ticks(inputs, 1);
        assert!(bench.failed().ends_with(said), "{}", bench.failed());
    }
}

#[test]
fn line_that_takes_too_long_names_its_input() {
    let mut bench = Bench::new(IDLE);
    bench.begin(MACHINE);
    bench.ticks(IDLE, 1).ticks(WORKS, 899 * TICKS_PER_S);
    assert!(bench.lines.is_busy());
    bench.ticks(WORKS, TICKS_PER_S);
    assert!(bench.failed().ends_with("has not ended within 900 s: machine.V.done is 0, 1 was expected"));
    let mut vise = Bench::new(CLAMPED);
    vise.begin("vise open V");
    vise.ticks(CLAMPED, 10 * TICKS_PER_S);
    assert!(vise.failed().ends_with("has not ended within 10 s: vise.V.opened is 0, 1 was expected"));
    assert_eq!(vise.output(), 0, "no output stays on");
}

#[test]
fn short_gap_delays_a_line_only() {
    let mut bench = Bench::new(IDLE);
    bench.begin(MACHINE);
    bench.age_ms = 400;
    bench.ticks(IDLE, 5);
    assert_eq!((bench.lines.is_busy(), bench.starts), (true, 0), "needs that are late are awaited");
    bench.age_ms = 8;
    bench.ticks(IDLE, 1).ticks(WORKS, 5);
    bench.age_ms = 400;
    // The last words are held, and late inputs do not break a condition.
    bench.ticks(WORKS & !CLAMPED, 5);
    bench.age_ms = 8;
    bench.ticks(WORKS, 5).ticks(IDLE | DONE, 1);
    assert!(bench.ended());
    assert_eq!(bench.starts, 1);
}

#[test]
fn interrupted_machining_is_not_started_twice() {
    let mut bench = Bench::new(IDLE);
    bench.begin(MACHINE);
    bench.ticks(IDLE, 1).ticks(WORKS, 10);
    bench.is_tripped = true;
    bench.ticks(WORKS, 1);
    assert!(bench.failed().contains("after `io go fixture`, `job go` waits for the end"));
    bench.begin(MACHINE);
    bench.ticks(WORKS, 1);
    assert!(bench.failed().contains("fixture is tripped"), "not released yet");
    bench.is_tripped = false;
    bench.begin(MACHINE);
    // The machine has ended in the meantime.
    bench.ticks(IDLE | DONE, 1);
    assert!(bench.ended());
    assert_eq!(bench.starts, 1);
}

#[test]
fn trip_before_the_line_has_begun_asks_a_person() {
    let mut bench = Bench::new(IDLE);
    bench.begin(MACHINE);
    bench.ticks(IDLE, 1);
    bench.is_tripped = true;
    bench.ticks(IDLE, 1);
    assert!(bench.failed().contains("it is unknown whether the line has begun"), "{}", bench.failed());
    assert_eq!(bench.output() & START, 0);
}

#[test]
fn open_vise_ends_its_line_after_it_has_settled() {
    let mut bench = Bench::new(OPENED);
    bench.begin("vise open V");
    bench.ticks(OPENED, SETTLE_TICKS);
    assert!(bench.lines.is_busy());
    bench.ticks(OPENED, 2);
    assert!(bench.ended());
    bench.begin("vise open V");
    bench.ticks(OPENED, 1).ticks(CLAMPED, 2).ticks(OPENED, 1);
    assert!(bench.ended(), "seen off");
}

#[test]
fn unknown_line_and_second_line_are_refused() {
    let mut bench = Bench::new(IDLE);
    let refused = bench.lines.begin(&bench.mapping, "vise close V").unwrap_err().to_string();
    assert_eq!(refused, "`vise close V` has no [[line]] in the mapping, and its devices are real");
    bench.begin(MACHINE);
    let refused = bench.lines.begin(&bench.mapping, "vise open V").unwrap_err().to_string();
    assert_eq!(refused, "`vise open V` cannot begin: `machine BLANK PART V` is still executed");
}

#[test]
fn wrong_entries_are_refused_with_their_line() {
    let changed = |from: &str, to: &str| {
        assert!(MAPPING.contains(from), "{from}");
        let text = MAPPING.replacen(from, to, 1);
        let source = Source { name: "bench.toml".to_owned(), text: text.into() };
        let report = Mapping::parse(&source).expect_err(to);
        let all = report.diagnostics().iter().map(|one| format!("{}: {}", one.place(), one.message()));
        all.collect::<Vec<_>>()
    };
    for (from, to, line, said) in [
        ("machine BLANK PART V", "mill BLANK", 30, "begins with vise, machine, drum, tray"),
        ("\"vise open V\"", "\"machine  BLANK PART V\"", 42, "a line that no other entry has"),
        ("[\"machine.V.busy\"]", "[\"machine.W.busy\"]", 33, "expected an input of [in]"),
        ("[\"machine.V.busy\"]", "[\"vise.V.program\"]", 33, "vise.V.program = VALUE"),
        ("[\"machine.V.busy\"]", "[\"machine.V.busy = 2\"]", 33, "machine.V.busy or !machine.V.busy"),
        ("\"machine.V.start\" = 1", "\"machine.V.go\" = 1", 32, "expected an output of [out]"),
        ("\"machine.V.start\" = 1", "\"machine.V.start\" = 2", 32, "expected 0 to 1, found 2"),
        ("within_s = 900", "within_s = 0", 38, "expected 1 to 65535 s, found 0"),
        ("done = [\"vise.V.opened\", \"!vise.V.clamped\"]", "done = []", 44, "at least one input"),
        ("within_s = 900", "whithin_s = 900", 38, "whithin_s"),
    ] {
        let found = changed(from, to);
        let at = format!("bench.toml: line {line}, column ");
        let is_there = found.iter().any(|one| one.starts_with(&at) && one.contains(said));
        assert!(is_there, "{to}: {at} {said}: {found:#?}");
    }
}

#[test]
fn outputs_after_lines_are_those_of_their_entries() {
    let mapping = Bench::new(0).mapping;
    let value = |values: &[i64], name: &str| {
        mapping.outputs.iter().zip(values).find_map(|(point, value)| (point.name == name).then_some(*value))
    };
    let possible = outputs_after(&mapping, ["vise open V", "no entry"], Some(MACHINE));
    let of = |name| possible.iter().map(|values| value(values, name).unwrap()).collect::<Vec<_>>();
    assert_eq!(of("vise.V.open"), [0, 0, 0], "switched off at the end of the line");
    assert_eq!(of("machine.V.program"), [0, 17, 17]);
    assert_eq!(of("machine.V.start"), [0, 1, 0]);
}
