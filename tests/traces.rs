//! A trace contains every change, and the comparison finds every difference.

use interfaces::{CommonMemory, Decided, Reason, emove::Holding};
use rcs_core::{name::Name16, tick::Tick};
use whole_system_tests::{
    compare::{CompareError, Comparison, Moment, Renames, RowMap, compare},
    golden::Ending,
    trace::Tracer,
};

const END: &str = "end\tticks\t9\nend\tstatus\t0\n";

fn trace(lines: &[&str]) -> String {
    let tabs = |line: &&str| line.replacen(' ', "\t", 2) + "\n";
    lines.iter().map(tabs).collect::<String>() + END
}

fn compared(was: &[&str], is: &[&str], renames: &str) -> Comparison {
    let renames = Renames::parse(renames).expect("the renames can be read");
    compare(trace(was).as_bytes(), trace(is).as_bytes(), &renames).expect("the traces can be compared")
}

fn differences(was: &[&str], is: &[&str], renames: &str) -> String {
    compared(was, is, renames).to_string()
}

const WAS: [&str; 5] =
    ["1 emove.at HOME", "1 emove.echo 0", "3 emove.at ", "4 emove.echo 7", "8 emove.at SAFE"];

#[test]
fn equal_traces_in_another_order_have_no_difference() {
    let is = ["1 emove.echo 0", "1 emove.at HOME", "3 emove.at ", "4 emove.echo 7", "8 emove.at SAFE"];
    let found = compared(&WAS, &is, "");
    assert_eq!(found.differences, []);
    assert_eq!(found.ticks, (9, 9));
}

#[test]
fn a_changed_value_is_a_difference_for_as_long_as_it_lasts() {
    let is = ["1 emove.at HOME", "1 emove.echo 0", "3 emove.at DRUM", "5 emove.echo 7", "8 emove.at SAFE"];
    let found = compared(&WAS, &is, "");
    let [at, echo] = found.differences.as_slice() else { panic!("two were expected: {found}") };
    assert_eq!((at.path.as_str(), at.first, at.ticks), ("emove.at", Moment::Tick(3), 5));
    assert_eq!((at.was.as_deref(), at.is.as_deref()), (Some(""), Some("DRUM")));
    assert_eq!((echo.path.as_str(), echo.first, echo.ticks), ("emove.echo", Moment::Tick(4), 1));
    assert_eq!((echo.was.as_deref(), echo.is.as_deref()), (Some("7"), Some("0")));
    let text = found.to_string();
    assert!(
        text.starts_with("  tick 3       emove.at: was \"\", is \"DRUM\"; differs in 5 ticks\n"),
        "{text}"
    );
}

#[test]
fn missing_change_of_a_value_is_a_difference() {
    let found = compared(&WAS, WAS.get(..4).expect("there are five"), "");
    assert_eq!(found.differences.len(), 1, "{found}");
    assert_eq!(found.differences.first().map(|d| (d.first, d.ticks)), Some((Moment::Tick(8), 2)));
}

#[test]
fn missing_and_new_fields_are_differences_unless_declared() {
    let was = ["1 prim.old 1", "1 prim.same 2", "4 prim.old 9"];
    let is = ["1 prim.same 2", "1 prim.new 3", "5 prim.new 4"];
    let text = differences(&was, &is, "");
    assert!(text.contains("prim.old: was \"1\", is no such field; differs in 9 ticks\n"), "{text}");
    assert!(text.contains("prim.new: was no such field, is \"3\"; differs in 9 ticks\n"), "{text}");
    let meant = r#"
        dropped = [{ path = "prim.old", reason = "it is not read" }]
        added = [{ path = "*.new", reason = "for the screen" }]
    "#;
    assert_eq!(differences(&was, &is, meant), "");
}

#[test]
fn field_of_both_versions_is_compared_despite_an_added_entry() {
    let added = r#"added = [{ path = "prim.*", reason = "for the screen" }]"#;
    let text = differences(&["1 prim.same 2"], &["1 prim.same 3", "1 prim.new 4"], added);
    assert_eq!(text, "  tick 1       prim.same: was \"2\", is \"3\"; differs in 9 ticks\n");
}

#[test]
fn differences_beyond_the_first_ones_are_counted() {
    let paths: Vec<String> = (0..15).map(|number| format!("1\tfield{number:02}\t")).collect();
    let with = |value: &str, end: &str| {
        paths.iter().map(|path| format!("{path}{value}\n")).collect::<String>() + "end\tticks\t9\n" + end
    };
    let (was, is) = (with("0", "end\tstatus\t0\n"), with("1", "end\tstatus\t3\n"));
    let found = compare(was.as_bytes(), is.as_bytes(), &Renames::default()).expect("both are complete");
    let text = found.to_string();
    assert!(text.contains("field11") && !text.contains("field12"), "{text}");
    let end = "  end          status: was \"0\", is \"3\"\n  and 3 fields more, in 27 ticks together\n";
    assert!(text.ends_with(end), "{text}");
}

#[test]
fn a_renamed_field_is_compared_under_its_new_path() {
    let was = ["1 emove.poses[0].pose.tool[1] 5", "1 emove.poses[1].pose.tool[1] 6", "1 prim.a.b.c 1"];
    let is = ["1 emove.frames[0].tool[1] 5", "1 emove.frames[1].tool[1] 7", "1 prim.x.b.c 1"];
    let renames = r#"
        renamed = [
            { old = "emove.poses[*].pose.*", new = "emove.frames[*].*" },
            { old = "prim.a.*", new = "prim.x.*" },
        ]
    "#;
    let text = differences(&was, &is, renames);
    assert_eq!(text, "  tick 1       emove.frames[1].tool[1]: was \"6\", is \"7\"; differs in 9 ticks\n");
}

#[test]
fn a_star_inside_a_path_is_one_segment() {
    let (was, is) = (["1 emove.status.pose.x 5"], ["1 emove.status.pose.y 5"]);
    let renames = r#"renamed = [{ old = "emove.*.x", new = "emove.*.y" }]"#;
    assert_ne!(differences(&was, &is, renames), "");
    let renames = r#"renamed = [{ old = "emove.*.*.x", new = "emove.*.*.y" }]"#;
    assert_eq!(differences(&was, &is, renames), "");
}

#[test]
fn declared_fields_may_have_another_text() {
    let was = ["1 task.reason ", "1 prim.reason ", "1 prim.pose 0", "4 prim.pose 12"];
    let is = ["1 task.reason none", "1 prim.reason none", "1 prim.pose none", "4 prim.pose record 12"];
    let renames = r#"
        value = [
            { path = "task.reason", old = "", new = "none" },
            { path = "prim.pose", old = "0", new = "none" },
            { path = "prim.pose", old = "*", new = "record *" },
        ]
    "#;
    assert_eq!(
        differences(&was, &is, renames),
        "  tick 1       prim.reason: was \"\", is \"none\"; differs in 9 ticks\n"
    );
}

#[test]
fn initially_absent_field_follows_the_rules_of_absent_fields() {
    let (was, is) = (["1 a.object ", "3 a.object PIN", "5 a.object "], ["3 a.object PIN", "5 a.object -"]);
    let renames = r#"value = [{ path = "a.object", old = "", new = "-" }]"#;
    assert_eq!(differences(&was, &is, renames), "");
    assert_ne!(differences(&was, &is, ""), "");
}

#[test]
fn row_numbers_are_mapped_and_are_not_a_difference() {
    let was = ["1 grip.fired none", "2 grip.fired open 1", "4 grip.fired open 2", "7 grip.fired open 1"];
    let is = ["1 grip.fired none", "2 grip.fired move 3", "4 grip.fired move 3", "7 grip.fired wait 1"];
    let found = compared(&was, &is, "");
    assert_eq!(found.differences, []);
    let mut rows = RowMap::default();
    rows.add("linkbar", &found);
    rows.add("clevis", &found);
    assert_eq!(
        rows.to_string(),
        "## Rows\n\n4 pairs, 3 with another name or number.\n\n\
         | process | old row | new row | ticks | for example |\n|---|---|---|--:|---|\n\
         | grip | none | none | 2 | linkbar, tick 1 |\n\
         | grip | open 1 | move 3 | 4 | linkbar, tick 2 |\n\
         | grip | open 1 | wait 1 | 6 | linkbar, tick 7 |\n\
         | grip | open 2 | move 3 | 6 | linkbar, tick 4 |\n\n\
         ## Old rows that became more than one new row\n\n\
         | process | old row | new row | ticks | for example |\n|---|---|---|--:|---|\n\
         | grip | open 1 | move 3 | 4 | linkbar, tick 2 |\n\
         | grip | open 1 | wait 1 | 6 | linkbar, tick 7 |\n"
    );
}

#[test]
fn rows_are_learned_up_to_the_first_difference() {
    let was = ["1 grip.fired open 1", "1 a 0", "5 a 1", "5 grip.fired open 2"];
    let is = ["1 grip.fired open 1", "1 a 0", "6 a 1", "6 grip.fired open 3"];
    let found = compared(&was, &is, "");
    assert_eq!(found.differences.len(), 1, "{found}");
    let ticks: Vec<u64> = found.rows.values().map(|seen| seen.ticks).collect();
    assert_eq!(ticks, [4], "{:?}", found.rows);
}

#[test]
fn removed_process_is_a_difference() {
    let text = differences(&["1 grip.fired open 1"], &["1 jaw.fired open 1"], "");
    assert_eq!(text.lines().count(), 2, "{text}");
    let renames = r#"renamed = [{ old = "grip.*", new = "jaw.*" }]"#;
    assert_eq!(differences(&["1 grip.fired open 1"], &["1 jaw.fired open 1"], renames), "");
}

#[test]
fn another_end_is_a_difference_and_ends_the_comparison() {
    let was = "1\ta\t0\n2\ta\t1\n3\ta\t2\nend\tticks\t3\nend\tstatus\t0\n";
    let is = "1\ta\t0\n2\ta\t1\nend\tticks\t2\nend\tstatus\t1\n";
    let found = compare(was.as_bytes(), is.as_bytes(), &Renames::default()).expect("both are whole");
    assert_eq!(
        found.to_string(),
        "  end          ticks: was \"3\", is \"2\"\n  end          status: was \"0\", is \"1\"\n"
    );
    assert_eq!(found.ticks, (3, 2));
}

#[test]
fn invalid_traces_are_refused() {
    let refused = |text: &str| {
        let found = compare(trace(&["1 a 0"]).as_bytes(), text.as_bytes(), &Renames::default());
        found.map(|found| found.to_string()).expect_err("it is not a trace")
    };
    assert!(matches!(refused(""), CompareError::NoEnd("new")));
    assert!(matches!(refused("1\ta\t0\n"), CompareError::NoEnd("new")));
    assert!(matches!(refused("1\ta\t0\n1 a 0\n"), CompareError::Line { which: "new", line: 2, .. }));
    assert!(matches!(refused("2\ta\t0\n1\ta\t0\n"), CompareError::Line { line: 2, .. }));
}

#[test]
fn invalid_renames_are_refused() {
    let stars = r#"renamed = [{ old = "a", new = "b.*" }]"#;
    assert!(matches!(Renames::parse(stars), Err(CompareError::Stars { .. })));
    let no_reason = r#"dropped = [{ path = "a" }]"#;
    assert!(matches!(Renames::parse(no_reason), Err(CompareError::Toml(_))));
    let two_become_one = Renames::parse(r#"renamed = [{ old = "a", new = "b" }]"#).expect("it can be read");
    let (was, is) = (trace(&["1 a 0", "1 b 0"]), trace(&["1 b 0"]));
    let found = compare(was.as_bytes(), is.as_bytes(), &two_become_one);
    assert!(matches!(found, Err(CompareError::Twice { .. })));
}

#[test]
fn unused_entries_are_named() {
    let renames = r#"
        renamed = [{ old = "a", new = "b" }, { old = "x", new = "y" }]
        value = [{ path = "b", old = "0", new = "none" }, { path = "b", old = "1", new = "one" }]
    "#;
    let mut rows = RowMap::default();
    rows.add("linkbar", &compared(&["1 a 0"], &["1 b none"], renames));
    let renames = Renames::parse(renames).expect("it can be read");
    assert_eq!(rows.unused(&renames), ["renamed x to y", "value of b: \"1\" to \"one\""]);
}

fn traced(change: impl FnOnce(&mut CommonMemory)) -> (Vec<String>, Vec<String>) {
    let mut tracer = Tracer::new(Vec::new());
    let mut memory = CommonMemory::default();
    for header in [&mut memory.task.header, &mut memory.grip.header] {
        header.stamp = Tick(1);
    }
    tracer.tick(Tick(1), &memory).expect("a vector takes everything");
    memory.task.header.stamp = Tick(2);
    change(&mut memory);
    tracer.tick(Tick(2), &memory).expect("a vector takes everything");
    let ending = Ending {
        status: Some(1),
        last_line: "Grip: stuck (table position, row 2: clock Expired => Fail(Stuck)); twice\t".into(),
    };
    let bytes = tracer.finish(&ending).expect("a vector takes everything");
    let text = String::from_utf8(bytes).expect("a trace is text");
    let (first, later): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with("1\t"));
    let owned = |lines: Vec<&str>| lines.into_iter().map(str::to_owned).collect();
    (owned(first), owned(later))
}

#[test]
fn a_trace_has_all_fields_and_then_the_changes() {
    let (first, later) = traced(|memory| {
        memory.emove.status.reason = Reason::ObjectLost;
        memory.emove.status.held = Holding::Something;
        memory.task.status.command = Name16::new("MOVE").expect("it is a name");
        memory.prim.poses[2].pose.tool[1] = -7145;
        memory.grip.valves.bits = 0x82;
        memory.t3i.link_tx.length = 1;
        memory.t3i.link_tx.bytes[0] = 0xA5;
        memory.quick_change.header.republished = true;
        memory.prim.header.decided = Some(Decided { table: 1, row: 3 });
    });
    for line in
        ["1\temove.status.reason\t", "1\ttask.header.age\t0", "1\tprim.header.age\t1", "1\tprim.fired\tnone"]
    {
        assert!(first.iter().any(|found| found == line), "{line:?} is not in {first:#?}");
    }
    assert!(first.iter().any(|line| line.starts_with("1\tdevice.link_tx.bytes\t0000")));
    assert!(!first.iter().any(|line| line.contains(".stamp\t") || line.contains("header.decided")));
    let prim = levels::ladder::Ladder::processes().iter().find(|process| process.name == "Prim");
    let table = prim.and_then(|prim| prim.table(1)).expect("Prim has a table").name;
    let bytes = format!("A5{}", "00".repeat(63));
    let expected = [
        "2\ttask.status.command\tMOVE".to_owned(),
        "2\temove.status.reason\tthe object was lost on the way".to_owned(),
        "2\temove.status.held\tsomething".to_owned(),
        "2\tprim.poses[2].pose.tool[1]\t-7145".to_owned(),
        "2\tt3i.link_tx.length\t1".to_owned(),
        format!("2\tt3i.link_tx.bytes\t{bytes}"),
        "2\tquick_change.header.republished\ttrue".to_owned(),
        "2\tgrip.valves.bits\t130".to_owned(),
        "2\tdevice.link_tx.length\t1".to_owned(),
        format!("2\tdevice.link_tx.bytes\t{bytes}"),
        "2\tdevice.grip.bits\t130".to_owned(),
        format!("2\tprim.fired\t{table} 3"),
        "2\tgrip.header.age\t1".to_owned(),
        "end\tticks\t2".to_owned(),
        "end\tstatus\t1".to_owned(),
        "end\tlast line\tGrip: stuck; twice\\t".to_owned(),
    ];
    let ages = |line: &&String| {
        !line.contains(".header.age") || line.contains("grip.header.age") && !line.contains("_grip")
    };
    let later: Vec<&String> = later.iter().filter(ages).collect();
    assert_eq!(later, expected.iter().collect::<Vec<_>>());
}
