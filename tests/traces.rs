//! Traces: every change is in them.

use rcs_core::{
    interface::{CommonMemory, Reason},
    name::Name16,
    tick::Tick,
};
use whole_system_tests::{golden::Ending, trace::Tracer};

/// The lines of a trace of two ticks.
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
fn a_trace_has_all_fields_and_then_what_changes() {
    let (first, later) = traced(|memory| {
        memory.emove.status.reason = Reason::ObjectLost;
        memory.emove.status.held_object = Name16::new("LINKBAR1").expect("it is a name");
        memory.prim.poses[2].pose.tool[1] = -7145;
        memory.grip.valves.bits = 0x82;
        memory.t3i.link_tx.length = 1;
        memory.t3i.link_tx.bytes[0] = 0xA5;
        memory.quick_change.header.republished = true;
        (memory.prim.header.table, memory.prim.header.row) = (1, 3);
    });
    for line in
        ["1\temove.status.reason\t", "1\ttask.header.age\t0", "1\tprim.header.age\t1", "1\tprim.fired\tnone"]
    {
        assert!(first.iter().any(|found| found == line), "{line:?} is not in {first:#?}");
    }
    assert!(first.iter().any(|line| line.starts_with("1\tdevice.link_tx.bytes\t0000")));
    assert!(!first.iter().any(|line| line.contains(".stamp\t") || line.contains("header.row")));
    let prim = levels::ladder::Ladder::processes().iter().find(|process| process.name == "Prim");
    let table = prim.and_then(|prim| prim.table(1)).expect("Prim has a table").name;
    let bytes = format!("A5{}", "00".repeat(63));
    let expected = [
        "2\temove.status.reason\tthe object was lost on the way".to_owned(),
        "2\temove.status.held_object\tLINKBAR1".to_owned(),
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
