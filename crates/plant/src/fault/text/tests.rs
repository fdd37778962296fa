use std::{fs, path::Path};

use depc::fault::{ALWAYS, Direction, FaultKind, Rule};
use diagnostics::Diagnostic;

use super::*;
use crate::fault::When;

fn cell() -> CellDescription {
    CellDescription::from_toml(include_str!("../../../../../data/cell.toml")).unwrap()
}

fn source(text: &str) -> Source {
    Source { name: "faults.toml".to_owned(), text: text.into() }
}

fn faults(text: &str) -> Vec<(String, When)> {
    let read = parse(&source(text), &cell()).unwrap();
    read.cell.faults.into_iter().map(|fault| (fault.what.to_string(), fault.when)).collect()
}

#[test]
fn every_kind_is_read() {
    let text = "seed = 7\n\
        [[fault]]\nkind = \"off\"\nsensor = \"beam.3\"\nfrom = 200\nuntil = 500\n\
        [[fault]]\nkind = \"stuck\"\nsensor = \"grip.potentiometer\"\nvalue = 900\nat = 10\nticks = 5\n\
        [[fault]]\nkind = \"stuck\"\nsensor = \"resolver.shoulder\"\nafter = 8.0\n\
        [[fault]]\nkind = \"noisy\"\nsensor = \"force.z\"\nby = 40\nrate = 0.01\nticks = 25\n\
        [[fault]]\nkind = \"slow\"\nsensor = \"grip.strain-left\"\nby = 3\n\
        [[fault]]\nkind = \"intermittent\"\nsensor = \"quick-change.id\"\nrate = 0.5\n\
        [[fault]]\nkind = \"offset\"\nsensor = \"table.potentiometer\"\nby = -12\n\
        [[fault]]\nkind = \"drift\"\nsensor = \"force.x\"\nby = 2.5\n\
        [[fault]]\nkind = \"stuck\"\nvalve = \"grip.close-fine\"\nvalue = \"open\"\n\
        [[fault]]\nkind = \"stuck\"\nvalve = \"quick-change.port\"\nvalue = \"closed\"\n\
        [[fault]]\nkind = \"stuck\"\ndevice = \"lock-ring\"\n\
        [[fault]]\nkind = \"stuck\"\ndevice = \"vise-jaw\"\n\
        [[fault]]\nkind = \"air-lost\"\nat = 7\n\
        [[fault]]\nkind = \"hydraulics-lost\"\nfrom = 9\n\
        [[fault]]\nkind = \"camera-blind\"\n\
        [[fault]]\nkind = \"missing\"\n\
        [[fault]]\nkind = \"misplaced\"\nobject = \"LINKBAR1_BH\"\nx = 1.5\n\
        [[fault]]\nkind = \"turned\"\nangle = 30\nrate = 0.5\n\
        [[fault]]\nkind = \"wrong-part\"\nobject = \"LINKBAR1_BH\"\npart = \"LCLEVIS_BH\"\n\
        [[fault]]\nkind = \"pedestal-moved\"\nx = 0.5\ny = -0.25\nangle = 2\n\
        [[fault]]\nkind = \"flip\"\nrate = 0.001\n";
    let read = faults(text);
    let window = |from, until| When { from, until, ..When::ALWAYS };
    let expected = [
        ("beam.3 is off", window(200, 500)),
        ("grip.potentiometer is stuck at 900", When { ticks: 5, ..window(10, 15) }),
        ("resolver.shoulder is stuck", window(200, u64::MAX)),
        ("force.z is noisy by 40 counts", When { rate: Some(0.01), ticks: 25, ..When::ALWAYS }),
        ("grip.strain-left is 0.12 s late", When::ALWAYS),
        ("quick-change.id is off", When { rate: Some(0.5), ..When::ALWAYS }),
        ("table.potentiometer is off by -12 counts", When::ALWAYS),
        ("force.x drifts by +2.5 counts a second", When::ALWAYS),
        ("valve grip.close-fine is stuck open", When::ALWAYS),
        ("valve quick-change.port is stuck closed", When::ALWAYS),
        ("the locking ring is stuck", When::ALWAYS),
        ("the jaw of the vise is stuck", When::ALWAYS),
        ("the air is lost", window(7, 8)),
        ("the hydraulics are lost", window(9, u64::MAX)),
        ("the camera is blind", When::ALWAYS),
        ("the part is not delivered", When::ALWAYS),
        ("LINKBAR1_BH lies 1.50 in, 0.00 in from its place", When::ALWAYS),
        ("the part is turned by 30 degrees", When { rate: Some(0.5), ..When::ALWAYS }),
        ("LCLEVIS_BH is delivered instead of LINKBAR1_BH", When::ALWAYS),
        ("the pedestal is 0.50 in, -0.25 in, 2 degrees from its mark", When::ALWAYS),
    ];
    for (read, (text, when)) in read.iter().zip(expected) {
        assert_eq!(*read, (text.to_owned(), when));
    }
    assert_eq!(read.len(), expected.len());
    let read = parse(&source(text), &cell()).unwrap();
    assert_eq!((read.cell.seed, read.line.map(|plan| plan.rules().len())), (7, Some(1)));
}

#[test]
fn every_line_rule_parses() {
    let read = parse_line(&source(
        "seed = 7\nmost_per_tick = 2\n\
         [[fault]]\nkind = \"flip\"\ndirection = \"to-host\"\nrate = 0.001\nfrom = 100\nuntil = 500\n\
         [[fault]]\nkind = \"delay\"\nat = 250\nticks = 3\ndirection = \"both\"\n\
         [[fault]]\nkind = \"insert\"\nrate = 1\nbyte = 0x06\ndirection = \"to-controller\"\n\
         [[fault]]\nkind = \"stall\"\nfrom = 600\n",
    ));
    let mut expected = Plan::new(7).most_per_tick(2);
    for rule in [
        Rule::new(FaultKind::Flip).only(Direction::ToHost).rate(1000).window(100, 500),
        Rule::new(FaultKind::Delay).at(250).ticks(3),
        Rule::new(FaultKind::Insert).only(Direction::ToController).rate(ALWAYS).byte(6),
        Rule::new(FaultKind::Stall).window(600, u64::MAX),
    ] {
        expected.add(rule).unwrap();
    }
    assert_eq!(read.unwrap(), expected);
    assert_eq!(parse_line(&source("[[fault]]\nkind = \"drop\"\nat = 1\n")).unwrap().seed(), 1);
}

/// The messages for a second fault entry after a correct one.
fn said(entry: &str) -> String {
    let text = format!("[[fault]]\nkind = \"flip\"\nrate = 0.1\n[[fault]]\n{entry}\n");
    parse(&source(&text), &cell()).unwrap_err().in_line()
}

#[test]
fn fault_file_errors_have_place_expected_and_found() {
    for (entry, expected) in [
        ("kind = \"stuk\"", "line 5, column 8: fault[1].kind: expected one of drop, "),
        ("kind = \"stuk\"", ", found \"stuk\" (the nearest one is stuck)"),
        (
            "kind = \"off\"\nsensor = \"grip.potentimeter\"",
            "line 6, column 10: fault[1].sensor: expected one of ",
        ),
        ("kind = \"off\"\nsensor = \"grip.potentimeter\"", "(the nearest one is grip.potentiometer)"),
        (
            "kind = \"stuck\"\nvalve = \"grip.shut\"\nvalue = \"open\"",
            "line 6, column 9: fault[1].valve: expected one",
        ),
        (
            "kind = \"stuck\"\nvalve = \"grip.vent\"\nvalue = \"ajar\"",
            "line 7, column 9: fault[1].value: expected \"open\" or \"closed\", found \"ajar\"",
        ),
        ("kind = \"stuck\"\nvalve = \"grip.vent\"", "line 4, column 1: fault[1]: stuck needs `value`"),
        (
            "kind = \"stuck\"\ndevice = \"door\"",
            "line 6, column 10: fault[1].device: expected one of lock-ring, vise-jaw",
        ),
        ("kind = \"stuck\"", "line 4, column 1: fault[1]: stuck needs one of `sensor`, `valve` and `device`"),
        (
            "kind = \"stuck\"\nsensor = \"beam.1\"\nvalue = 2",
            "line 7, column 9: fault[1].value: expected 0 to 1, found 2",
        ),
        (
            "kind = \"off\"\nsensor = \"beam.1\"\nvalues = 2",
            "fault[1] has no key values; expected one of kind, ",
        ),
        (
            "kind = \"off\"\nsensor = \"beam.1\"\nvalue = 2",
            "line 7, column 9: fault[1]: off takes no value; it takes sensor, at, from, after, until, rate, ticks",
        ),
        ("kind = \"noisy\"\nsensor = \"beam.1\"", "line 4, column 1: fault[1]: noisy needs `by`: how much"),
        (
            "kind = \"slow\"\nsensor = \"beam.1\"\nby = 0",
            "line 7, column 6: fault[1].by: expected 1 to 1000 ticks, found 0",
        ),
        ("kind = \"noisy\"\nsensor = \"beam.1\"\nby = nan", "fault[1].by: expected a number, found nan"),
        ("kind = \"slow\"\nsensor = \"camera\"\nby = 3", "fault[1]: slow is for converters"),
        ("kind = \"intermittent\"\nsensor = \"beam.1\"", "needs `rate`: the chance of failing in a tick"),
        ("kind = \"air-lost\"\nrate = 1.5", "fault[1].rate: expected a chance of 0.000001 to 1, found 1.5"),
        ("kind = \"air-lost\"\nat = -1", "line 6, column 6: fault[1].at: expected a whole number from 0 to "),
        ("kind = \"air-lost\"\nat = 1\nafter = 2.0", "has more than one of `at`, `from` and `after`"),
        ("kind = \"air-lost\"\nat = 1\nuntil = 2", "has `at`, which is one moment, and `until`"),
        (
            "kind = \"air-lost\"\nfrom = 9\nuntil = 9",
            "has no tick: expected `until` after the beginning, found 9 to 9",
        ),
        ("kind = \"air-lost\"\nfrom = 9\nticks = 9", "has a range of ticks, which says how long it lasts"),
        ("kind = \"air-lost\"\nat = \"soon\"", "fault[1].at: expected a whole number from 0 to "),
        ("kind = \"air-lost\"\nrate = 0.1\nticks = 0", "fault[1].ticks: expected 1 to 100000, found 0"),
        ("kind = \"turned\"", "turned needs `angle`"),
        ("kind = \"missing\"\nobject = \"LINKBAR1\"\nx = 1", "missing takes no x; it takes object, "),
        ("kind = \"missing\"\nobject = \"LINKBAR_BH\"", "(the nearest one is LINKBAR1_BH)"),
        ("kind = \"wrong-part\"", "wrong-part needs `part`: what is delivered instead"),
        ("kind = \"pedestal-moved\"\nat = 3", "pedestal-moved takes no at; it takes x, y, angle"),
        ("kind = \"misplaced\"\nx = 101", "fault[1].x: expected -100 to 100 in, found 101"),
        ("kind = \"flip\"\nrate = 2", "fault[1].rate: expected a chance of 0.000001 to 1, found 2"),
        (
            "kind = \"flip\"\ndirection = \"to-hots\"",
            "expected one of to-host, to-controller, both, found \"to-hots\"",
        ),
        (
            "kind = \"flip\"\nat = 3\nuntil = 4",
            "flip has `at`, and `from` or `until`: one of them was expected",
        ),
        ("kind = \"stall\"\nat = 3\nticks = 0", "fault[1].ticks: expected 1 to 1000 ticks, found 0"),
        (
            "kind = \"insert\"\nat = 3\nbyte = 256",
            "fault[1].byte: expected a whole number from 0 to 255, found 256",
        ),
        ("kind = \"drop\"\nat = 1\nticks = 2", "drop is refused: "),
        ("kind = \"drop\"\nuntil = 0", "drop has no tick: expected `until` after `from`, found 0 to 0"),
        ("at = 3", "fault[1] has no key kind, which it needs"),
    ] {
        assert!(said(entry).contains(expected), "{entry}\n  says     {}\n  expected {expected}", said(entry));
    }
}

#[test]
fn all_fault_file_errors_are_reported_at_once() {
    let text = "seeds = 3\n\
        [[fault]]\nkind = \"stuk\"\n\
        [[fault]]\nkind = \"slow\"\nsensor = \"beam.1\"\nby = 0\n\
        [[fault]]\nkind = \"flip\"\nrate = \"often\"\n";
    let report = parse(&source(text), &cell()).unwrap_err();
    let lines: Vec<_> = report.diagnostics().iter().filter_map(Diagnostic::line).collect();
    assert_eq!(lines, [1, 3, 7, 10], "{report}");
}

#[test]
fn invalid_fault_files_are_refused() {
    for (text, words) in [
        ("seed = \n", "line 1"),
        ("seed = 3\n", "expected at least one [[fault]], found none"),
        (
            "most_per_tick = 0\n[[fault]]\nkind = \"drop\"\nat = 1\n",
            "most_per_tick: expected 1 to 255 faults, found 0",
        ),
        ("fault = [3]\n", "expected a table, found 3"),
        ("fault = 3\n", "expected an array, found 3"),
        ("colour = 3\n[[fault]]\nkind = \"drop\"\nat = 1\n", "the file has no key colour"),
    ] {
        let found = parse(&source(text), &cell()).unwrap_err().in_line();
        assert!(found.contains(words), "{text:?}: {found}");
    }
    let found = parse_line(&source("[[fault]]\nkind = \"air-lost\"\n")).unwrap_err().in_line();
    assert!(found.contains("air-lost is a fault of the cell: such faults are for rcs-run"), "{found}");
}

#[test]
fn shipped_fault_files_parse() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/faults");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        parse(&source(&text), &cell()).unwrap_or_else(|report| panic!("{}: {report}", path.display()));
        count += 1;
    }
    assert!(count > 20, "{count} files");
}
