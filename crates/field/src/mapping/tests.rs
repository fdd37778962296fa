//! A right file, and files with one mistake each.

use couplers::{Area, Kind as Coupler, Span};
use interfaces::point::Group;

use super::*;

/// A quick change on a coupler, with a hole for a mistake.
const RIGHT: &str = r#"form = 1
name = "bench"

[device.arm]
address = "127.0.0.1:1502"
unit = 1
kind = "bk9000"
fallback = "zero"
watchdog_ms = 500

[in]
"quick-change.locked"   = { at = "arm input 8.8" }
"quick-change.unlocked" = { at = "arm input 8.9" }
"quick-change.id.0"     = { at = "arm input 8.10", invert = true }
"quick-change.id.1"     = { at = "arm input 8.11" }

[out]
"quick-change.lock"     = { at = "arm holding 0x800.12", safe = 0 }
"quick-change.unlock"   = { at = "arm holding 0x800.13", safe = 0 }
"quick-change.port"     = { at = "arm holding 0x800.14", safe = 0 }
"#;

fn parse(text: &str) -> Result<Mapping, Vec<String>> {
    let source = Source { name: "bench.toml".to_owned(), text: text.into() };
    Mapping::parse(&source).map_err(|report| {
        report.diagnostics().iter().map(|one| format!("{}: {}", one.place(), one.message())).collect()
    })
}

fn changed(from: &str, to: &str) -> Vec<String> {
    assert!(RIGHT.contains(from), "{from:?} is not in the file");
    parse(&RIGHT.replacen(from, to, 1)).expect_err(to)
}

/// The file with another kind of coupler.
fn of_kind(kind: &str, fallback: &str, watchdog: &str, outputs: &str) -> String {
    RIGHT
        .replace("bk9000", kind)
        .replace("\"zero\"", &format!("{fallback:?}"))
        .replace("watchdog_ms = 500", watchdog)
        .replace("0x800", outputs)
}

fn with_input(line: &str) -> Vec<String> {
    changed("\n[out]\n", &format!("{line}\n\n[out]\n"))
}

#[test]
fn right_file_gives_images_and_groups() {
    let mapping = parse(RIGHT).unwrap();
    assert_eq!(
        (mapping.name.as_str(), mapping.device("arm"), mapping.device("leg")),
        ("bench", Some(0), None)
    );
    let plan = &mapping.devices[0].plan;
    assert_eq!((plan.kind, plan.watchdog_ms, plan.stale_ms), (Coupler::Bk9000, 500, 100));
    assert_eq!(plan.reads, [Span { area: Area::Input, first: 8, count: 1 }]);
    assert_eq!(plan.writes, [Span { area: Area::Holding, first: 0x800, count: 1 }]);
    assert_eq!(mapping.groups(Presence::Mapped).collect::<Vec<_>>(), [Group::QuickChange]);
    assert_eq!(mapping.groups(Presence::Simulated).count(), Group::ALL.len() - 1);
}

#[test]
fn shipped_station_maps_every_point_but_the_camera() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/field/station.toml");
    let mapping = parse(&std::fs::read_to_string(path).unwrap()).unwrap();
    let words = |wanted: bool| {
        mapping.inputs.iter().filter(move |point| matches!(point.target, Target::Word(_)) == wanted)
    };
    let mappable = Input::all().filter(|input| !matches!(input.kind(), Kind::Cable | Kind::Camera)).count();
    assert_eq!((words(true).count(), words(false).count()), (mappable, 26));
    assert_eq!(mapping.outputs.len(), Output::all().count() + 11);
    assert_eq!(mapping.groups(Presence::Simulated).collect::<Vec<_>>(), [Group::Vision]);
    assert!(mapping.outputs.iter().all(|point| point.safe == 0));
}

#[test]
fn fixed_and_absent_groups_need_no_points() {
    let fixed = r#"form = 1
[device.arm]
address = "[::1]:502"
unit = 255
kind = "plain"
fallback = "hold"

[in]
"safety.ok"             = { at = "arm discrete 0" }
"quick-change.locked"   = { fixed = 1 }
"quick-change.unlocked" = { fixed = 0 }
"quick-change.id.0"     = { fixed = 1 }
"quick-change.id.1"     = { fixed = 0 }

[groups]
pedestal = "absent"
table = "simulated"
"#;
    let mapping = parse(fixed).unwrap();
    assert_eq!(mapping.presence(Group::QuickChange), Presence::Fixed);
    assert_eq!(mapping.presence(Group::Pedestal), Presence::Absent);
    assert_eq!(mapping.presence(Group::Table), Presence::Simulated);
}

#[test]
fn every_wrong_file_is_refused_with_its_line() {
    let lock = "\"quick-change.lock\"     = { at = \"arm holding 0x800.12\", safe = 0 }";
    let as_output = |form: &str| changed(lock, &format!("\"quick-change.lock\" = {form}"));
    let device = |key: &str, to: &str| changed(key, to);
    let cases: Vec<(Vec<String>, u32, &str)> = vec![
        (changed("form = 1", "form = 2"), 1, "expected 1, which this version reads, found 2"),
        (changed("name = \"bench\"", "nam = \"bench\""), 2, "the file has no key nam"),
        (changed("name = \"bench\"", "name = \"bench"), 2, "this is not TOML"),
        (device("\"127.0.0.1:1502\"", "\"arm.example:1502\""), 5, "expected a numeric address with a port"),
        (device("\"127.0.0.1:1502\"", "\"127.0.0.1\""), 5, "expected a numeric address with a port"),
        (device("unit = 1\n", ""), 4, "device.arm has no key unit"),
        (device("unit = 1", "unit = 256"), 6, "expected a whole number from 0 to 255"),
        (device("\"bk9000\"", "\"bk9001\""), 7, "expected one of bk9000, ek9000, wago, turck, values, plain"),
        (device("\"zero\"", "\"freeze\""), 8, "expected what kind bk9000 can do, zero"),
        (device("\"zero\"", "\"hold\""), 8, "expected what kind bk9000 can do, zero"),
        (device("watchdog_ms = 500\n", ""), 4, "expected the time of the watchdog, 1 to 65535 ms"),
        (
            device("watchdog_ms = 500", "watchdog_ms = 100"),
            4,
            "a watchdog of 100 ms, expected at least 101 ms",
        ),
        (
            device("watchdog_ms = 500", "watchdog_ms = 500\nalive = \"input\""),
            10,
            "expected a register that the program of the device increments",
        ),
        (device("watchdog_ms = 500", "watchdog_ms = 500\nalive = \"coil 7\""), 10, "expected a register"),
        (device("watchdog_ms = 500", "watchdog = 500"), 9, "device.arm has no key watchdog"),
        (
            device("watchdog_ms = 500", "watchdog_ms = 500\ntimeout_ms = 20"),
            10,
            "expected 1 ms to less than exchange_ms",
        ),
        (device("watchdog_ms = 500", "watchdog_ms = 500\nexchange_ms = 5"), 10, "expected 10 to 1000 ms"),
        (device("watchdog_ms = 500", "watchdog_ms = 0"), 9, "1 to 65535 ms for kind bk9000"),
        (
            changed(
                "500\n",
                "500\n\n[device.leg]\naddress = \"127.0.0.1:1502\"\nunit = 1\nkind = \"plain\"\nfallback = \"hold\"\n",
            ),
            12,
            "expected another address or unit than arm",
        ),
        (with_input("\"beam.9\" = { at = \"arm input 9.0\" }"), 16, "it is not an input"),
        (
            with_input("\"tool.close\" = { at = \"arm input 9.0\" }"),
            16,
            "it is an output: write it into [out]",
        ),
        (
            with_input("\"quick-change.id\" = { at = \"arm input 9\" }"),
            16,
            "is a name for faults of several sensors",
        ),
        (with_input("\"camera\" = { at = \"arm input 9.0\" }"), 16, "is a name for faults"),
        (changed("arm input 8.9", "leg input 8.9"), 13, "expected a device: one of arm"),
        (
            changed("arm input 8.9", "arm input 8.8"),
            13,
            "an address that no other point has, as quick-change.locked does",
        ),
        (changed("arm input 8.9", "arm input 8.16"), 13, "expected a bit from 0 to 15"),
        (changed("arm input 8.9", "arm input 8"), 13, "expected a bit, such as"),
        (changed("arm input 8.9", "arm inputs 8.9"), 13, "expected one of coil, discrete, input and holding"),
        (changed("arm input 8.9", "arm discrete 8.9"), 13, "expected no bit after the address of a discrete"),
        (changed("arm input 8.9", "arm input 70000.9"), 13, "expected an address from 0 to 65535"),
        (
            changed("arm input 8.9", "arm input 0x100.9"),
            13,
            "expected a register from 0x0 to 0xFF of kind bk9000",
        ),
        (changed("arm input 8.9\" }", "arm input 8.9\", stale_ms = 20 }"), 13, "expected 40 to 10000 ms"),
        (changed("arm input 8.9\" }", "arm input 8.9\", then = 2 }"), 13, "expected 0 to 1, found 2"),
        (changed("arm input 8.9\" }", "arm input 8.9\", fixed = 1 }"), 13, "needs one of `at` and `fixed`"),
        (
            changed("arm input 8.9\" }", "arm input 8.9\", type = \"u16\" }"),
            13,
            "expected no type but \"bit\"",
        ),
        (
            changed("arm input 8.9\" }", "arm input 8.9\", type = \"f32\" }"),
            13,
            "expected one of bit, u16, i16, u32, i32",
        ),
        (
            changed("arm input 8.9\" }", "arm input 8.9\", raw = [0, 9], counts = [0, 1] }"),
            13,
            "takes no `raw` and `counts`",
        ),
        (
            with_input("\"grip.potentiometer\" = { at = \"arm input 9\", raw = [0, 9] }"),
            16,
            "needs both `raw` and `counts`",
        ),
        (
            with_input("\"grip.potentiometer\" = { at = \"arm input 9\", raw = [9, 9], counts = [0, 9] }"),
            16,
            "two raw values, the lower one first",
        ),
        (
            with_input("\"grip.potentiometer\" = { at = \"arm input 9\", raw = [0, 9], counts = [0, 5000] }"),
            16,
            "two different values from 0 to 4095",
        ),
        (with_input("\"grip.potentiometer\" = { at = \"arm input 9.1\" }"), 16, "expected a whole register"),
        (
            with_input("\"grip.potentiometer\" = { at = \"arm input 9\", invert = true }"),
            16,
            "only a bit can be inverted",
        ),
        (
            with_input("\"grip.potentiometer\" = { at = \"arm input 9\", words = \"low-first\" }"),
            16,
            "only a value of two registers",
        ),
        (
            with_input(
                "\"grip.potentiometer\" = { at = \"arm input 9\", by_gripper = { 4 = { raw = [0, 9], counts = [0, 9] } } }",
            ),
            16,
            "expected the id of a gripper",
        ),
        (
            with_input(
                "\"force.x\" = { at = \"arm input 9\", by_gripper = { 2 = { raw = [0, 9], counts = [0, 9] } } }",
            ),
            16,
            "only grip.potentiometer depends on the gripper",
        ),
        (
            with_input("\"table.counter\" = { at = \"arm input 0xFF\", type = \"i32\" }"),
            16,
            "expected a register from 0x0 to 0xFF",
        ),
        (with_input("\"beam.1\" = { at = \"arm input 9.0\" }"), 16, "grip is mapped in part"),
        (as_output("{ at = \"arm holding 0x800.12\" }"), 18, "has no key safe"),
        (
            as_output("{ at = \"arm holding 0x800.12\", safe = 1 }"),
            18,
            "expected 0, which the device gives when its watchdog fires",
        ),
        (
            as_output("{ at = \"arm holding 0x800.12\", safe = 0, invert = true }"),
            18,
            "expected 1, which the device gives",
        ),
        (as_output("{ at = \"arm holding 0x800.12\", safe = 2 }"), 18, "expected 0 to 1, found 2"),
        (as_output("{ at = \"arm input 9.12\", safe = 0 }"), 18, "expected a coil or a holding register"),
        (
            as_output("{ at = \"arm holding 0x1120.0\", safe = 0 }"),
            18,
            "expected a register from 0x800 to 0x8FF of kind bk9000",
        ),
        (as_output("{ at = \"arm holding 0x800.13\", safe = 0 }"), 19, "as quick-change.lock does"),
        (
            changed(&format!("{lock}\n"), ""),
            14,
            "quick-change is mapped in part: quick-change.lock is missing",
        ),
        (
            changed("\n[out]\n", "\n[groups]\nhand = \"absent\"\n\n[out]\n"),
            18,
            "expected one of grip, v, tool",
        ),
        (
            changed("\n[out]\n", "\n[groups]\nquick-change = \"absent\"\n\n[out]\n"),
            18,
            "and the file has points of it",
        ),
        (
            changed("\n[out]\n", "\n[groups]\nvise = \"mapped\"\n\n[out]\n"),
            18,
            "expected \"absent\" or \"simulated\"",
        ),
        (changed("\n[out]\n", "\n[holds]\nvise = \"nothing\"\n\n[out]\n"), 18, "a part must stay clamped"),
        (changed("\n[out]\n", "\n[holds]\ntool = \"glue\"\n\n[out]\n"), 18, "expected one of trapped-air"),
        (changed("\n[out]\n", "\n[holds]\narm = \"spring\"\n\n[out]\n"), 18, "expected one of grip"),
    ];
    for (found, line, expected) in &cases {
        let at = format!("bench.toml: line {line}, column ");
        let fits = found.iter().any(|one| one.starts_with(&at) && one.contains(expected));
        assert!(fits, "line {line}, {expected:?} is not in {found:#?}");
    }
    assert!(cases.len() >= 40);
}

#[test]
fn every_kind_is_mapped_at_its_own_addresses() {
    for (kind, fallback, watchdog, outputs) in [
        ("ek9000", "zero", "watchdog_ms = 500", "0x800"),
        ("wago", "zero", "watchdog_ms = 500", "0x200"),
        ("turck", "zero", "watchdog_ms = 500", "0x800"),
        ("values", "values", "watchdog_ms = 1000", "40"),
    ] {
        let mapping = parse(&of_kind(kind, fallback, watchdog, outputs)).unwrap();
        assert_eq!(mapping.devices[0].plan.kind.text(), kind);
    }
    let mapping = parse(&RIGHT.replace("= 500", "= 500\nalive = \"input 40\"")).unwrap();
    let alive = Span { area: Area::Input, first: 40, count: 1 };
    assert_eq!(mapping.devices[0].plan.alive, Some(alive));
}

#[test]
fn what_a_kind_cannot_do_is_refused_with_its_line() {
    let cases = [
        (
            of_kind("ek9000", "zero", "watchdog_ms = 400", "0x800"),
            9,
            "500 to 60000 ms for kind ek9000, found 400",
        ),
        (
            of_kind("wago", "zero", "watchdog_ms = 450", "0x200"),
            9,
            "100 to 65500 ms, a multiple of 100 for kind wago",
        ),
        (of_kind("values", "values", "watchdog_ms = 500", "0"), 9, "1000 to 65000 ms, a multiple of 1000"),
        (
            of_kind("wago", "zero", "watchdog_ms = 500", "0"),
            18,
            "expected a register from 0x200 to 0x2FF of kind wago",
        ),
        (of_kind("wago", "hold", "watchdog_ms = 500", "0x200"), 8, "expected what kind wago can do, zero"),
        (
            of_kind("turck", "values", "watchdog_ms = 500", "0x800"),
            8,
            "expected what kind turck can do, zero",
        ),
        (
            of_kind("values", "hold", "watchdog_ms = 1000", "0"),
            18,
            "keeps its outputs when its watchdog fires",
        ),
        (
            of_kind("wago", "zero", "watchdog_ms = 500", "0x200").replace("holding 0x200.12", "coil 12"),
            18,
            "expected a coil from 0x200 to 0x3FF of kind wago",
        ),
        (
            of_kind("wago", "zero", "watchdog_ms = 500", "0x200").replace("0x200.14", "0x264.14"),
            4,
            "101 output registers in one request, and kind wago accepts at most 100",
        ),
        (
            of_kind("ek9000", "zero", "watchdog_ms = 500", "0x800")
                .replace("0x800.12\", safe = 0", "0x800.12\", safe = 1"),
            18,
            "expected 0, which the device gives when its watchdog fires",
        ),
    ];
    for (text, line, expected) in cases {
        let found = parse(&text).unwrap_err();
        let at = format!("bench.toml: line {line}, column ");
        let fits = found.iter().any(|one| one.starts_with(&at) && one.contains(expected));
        assert!(fits, "line {line}, {expected:?} is not in {found:#?}");
    }
    // Safe values that are set in the device need not be 0.
    let set = of_kind("values", "values", "watchdog_ms = 1000", "0")
        .replace("0.12\", safe = 0", "0.12\", safe = 1");
    assert_eq!(parse(&set).unwrap().devices[0].plan.safe.words[0], 1 << 12);
}

#[test]
fn outputs_without_a_watchdog_must_be_at_rest() {
    let plain = RIGHT.replace("bk9000", "plain").replace("\"zero\"\nwatchdog_ms = 500", "\"hold\"");
    let found = parse(&plain).unwrap_err();
    assert_eq!(found.len(), 3, "{found:#?}");
    assert!(found[0].contains("its device has no watchdog, so it stays on when the controller is lost"));
    parse(&plain.replace("safe = 0", "safe = 0, rest = true")).unwrap();
}

#[test]
fn more_words_than_a_request_carries_are_refused() {
    let far = |register: u16| parse(&RIGHT.replace("arm input 8.9", &format!("arm input {register}.9")));
    assert_eq!(far(132).unwrap().devices[0].plan.reads[0].count, 125);
    let found = far(133).unwrap_err();
    assert!(found[0].contains("points within 125 registers that one request can have read"), "{found:?}");
    assert!(
        found[0].contains("found 126 registers") && found[0].starts_with("bench.toml: line 4"),
        "{found:?}"
    );
    let wide = |register: u16| parse(&RIGHT.replace("0x800.14", &format!("{register}.14")));
    assert!(wide(0x800 + 120).is_ok());
    assert!(wide(0x800 + 121).unwrap_err()[0].contains("found 122 registers"));
}
