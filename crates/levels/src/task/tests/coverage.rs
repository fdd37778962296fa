//! Every row of every table of Task fires.

use interfaces::{
    Reason,
    data_base::DataBaseVerb,
    hws::{Checked, HwsReport},
    subtask::SubtaskVerb,
};
use rcs_core::{handshake::Lower, table::Verdict};

use super::{
    ACQUIRE, INSERT, REFUSED, RELEASE, REMOVE,
    bench::{Answer, Bench, Mishap},
    recovery,
};
use crate::{
    coverage::Coverage,
    execution::{Asked, Outcome},
    subtask::tests::data::without,
    task::{
        Task,
        plan::{Gripper, TaskVerb},
        tables::{
            Action, Operator, Request, TABLES, Takeover,
            accept::accept,
            joystick::{Control, joystick},
        },
    },
};

const STARTUP: &str = "STARTUP -- 0 -- 0 0 -- 0 -- 0";
const SHUTDOWN: &str = "SHUTDOWN -- 0 -- 0 0 -- 0 -- 0";
const TO_TRAY: &str = "TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 SAFE 0";

/// Lines that succeed or fail by themselves: the gripper that is on, what it holds and where the robot is
/// before them.
const LINES: &[(&str, u8, &str, &str)] = &[
    ("PAUSE -- 0 -- 0 0 -- 0 -- 0", 1, "", ""),
    (TO_TRAY, 1, "", ""),
    ("TRANSFER PART +1 PFIXTURE 0 -1 UNIT_1 2 SAFE 0", 1, "", ""),
    ("TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 -- 0", 1, "", ""),
    ("MOVE PART +1 PFIXTURE 0 -1 UNIT_1 2 -- 0", 1, "", ""),
    ("MOVE PART +1 PFIXTURE 0 +1 UNIT_1 2 -- 0", 1, "", ""),
    ("MOVE -- 0 -- 0 0 SAFE 0 -- 0", 1, "", ""),
    ("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "BAR", "PFIXTURE"),
    ("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "BAR", "HOME"),
    ("POSITION PART 0 -- 0 +1 PFIXTURE 0 -- 0", 1, "PART", "PFIXTURE"),
    ("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "BAR", "UNIT_1"),
    ("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "BAR", ""),
    ("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "", ""),
    ("POSITION -- 0 -- 0 0 SAFE 0 -- 0", 1, "BAR", "SAFE"),
    ("POSITION -- 0 -- 0 0 SAFE 0 -- 0", 1, "", ""),
    ("ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "", ""),
    ("REFIXTURE PART +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0", 1, "", ""),
    ("REFIXTURE PART +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0", 1, "PART", ""),
    (INSERT, 3, "TOOL-1", "TOOL-SAFE"),
    (INSERT, 3, "TOOL-1", "TOOL-TRNS"),
    (INSERT, 3, "TOOL-1", "HOME"),
    (INSERT, 3, "", "TOOL-SAFE"),
    (RELEASE, 3, "TOOL-1", "TOOL-TRNS"),
    (RELEASE, 3, "TOOL-1", "HOME"),
    (RELEASE, 3, "", "TOOL-SAFE"),
    (RELEASE, 3, "", "HOME"),
    (RELEASE, 1, "", "TOOL-SAFE"),
    ("RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 -- 0", 3, "TOOL-1", "TOOL-TRNS"),
    (ACQUIRE, 1, "", ""),
    (ACQUIRE, 3, "TOOL-1", "TOOL-TRNS"),
    (ACQUIRE, 3, "TOOL-1", "HOME"),
    (ACQUIRE, 1, "PART", "HOME"),
    (REMOVE, 3, "TOOL-1", "TOOL-TRNS"),
    (REMOVE, 3, "TOOL-1", "TOOL-SAFE"),
    (REMOVE, 3, "TOOL-1", "HOME"),
    (REMOVE, 3, "", "HOME"),
    ("REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 -- 0", 3, "TOOL-1", "TOOL-TRNS"),
    (STARTUP, 1, "", ""),
    (SHUTDOWN, 1, "", ""),
];

/// One command of each table that Subtask fails at.
const FAILURES: &[(&str, SubtaskVerb, u8, &str, &str)] = &[
    ("PAUSE -- 0 -- 0 0 -- 0 -- 0", SubtaskVerb::Pause, 1, "", ""),
    (TO_TRAY, SubtaskVerb::GetObject, 1, "", ""),
    ("MOVE -- 0 -- 0 0 SAFE 0 -- 0", SubtaskVerb::GotoDest, 1, "", ""),
    ("MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", SubtaskVerb::GetObject, 1, "", ""),
    ("POSITION -- 0 -- 0 0 SAFE 0 -- 0", SubtaskVerb::Position, 1, "", ""),
    ("ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0", SubtaskVerb::GetObject, 1, "", ""),
    ("REFIXTURE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0", SubtaskVerb::GetEndeff, 1, "", ""),
    (INSERT, SubtaskVerb::InsertTool, 3, "TOOL-1", "TOOL-SAFE"),
    (RELEASE, SubtaskVerb::ReleaseTool, 3, "TOOL-1", "TOOL-TRNS"),
    (ACQUIRE, SubtaskVerb::AcquireTool, 3, "", "HOME"),
    (REMOVE, SubtaskVerb::RemoveTool, 3, "TOOL-1", "TOOL-TRNS"),
];

fn with_data_system(rows: &mut Coverage) {
    let to_tray_and_stay = "TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 -- 0";
    let from_tray = "MOVE PART +1 UNIT_1 2 +1 PFIXTURE 0 -- 0";
    for line in [TO_TRAY, to_tray_and_stay, from_tray] {
        for trouble in [Answer::Absent, Answer::Refuse] {
            let mut bench = Bench::connected();
            bench.run(line);
            bench.data_system.answer = trouble;
            bench.run(line);
            bench.run(line);
            bench.data_system.answer = Answer::After(10);
            bench.run(line);
            bench.data_system.answer = trouble;
            bench.run(line);
            bench.data_system.answer = Answer::After(300);
            bench.run(STARTUP);
            bench.data_system.answer = Answer::After(10);
            bench.run(STARTUP);
            rows.append(&mut bench.rows);
        }
    }
    for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup, DataBaseVerb::Update] {
        for answer in [Answer::Absent, Answer::Refuse] {
            let mut bench = Bench::connected();
            bench.data_system.answer = Answer::Absent;
            bench.run(TO_TRAY);
            bench.data_system.answer = Answer::After(3);
            bench.data_system.except = Some((verb, answer));
            bench.run(STARTUP);
            bench.run(SHUTDOWN);
            rows.append(&mut bench.rows);
        }
    }
    // Two updates are owed when a REFIXTURE comes.
    let mut bench = Bench::connected();
    bench.data_system.answer = Answer::Refuse;
    bench.run(from_tray);
    bench.set(1, "PART", "PFIXTURE");
    bench.run("POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0");
    bench.data_system.answer = Answer::After(1);
    bench.run("REFIXTURE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0");
    rows.append(&mut bench.rows);
    // The Data System begins to answer when it has been told the first of two updates of a tool again.
    let mut bench = Bench::connected();
    bench.set(3, "TOOL-1", "HOME");
    bench.data_system.answer = Answer::Absent;
    bench.run("MOVE TOOL-1 +1 UNIT_1 2 +1 TOOL-SAFE 0 -- 0");
    bench.set(3, "TOOL-1", "TOOL-TRNS");
    bench.data_system.received.clear();
    bench.command(RELEASE);
    while bench.data_system.received.is_empty() {
        bench.step();
    }
    bench.data_system.answer = Answer::After(1);
    bench.finish();
    rows.append(&mut bench.rows);
}

/// The operator takes the robot before, after and from a command, and gives it back.
fn with_operator(rows: &mut Coverage) {
    for (line, ticks) in [("", 0), (TO_TRAY, 300), (TO_TRAY, 5)] {
        let mut bench = Bench::default();
        if !line.is_empty() {
            bench.command(line);
        }
        bench.wait(ticks);
        bench.subtask.joystick = true;
        bench.wait(10);
        bench.command(TO_TRAY);
        bench.wait(10);
        bench.subtask.joystick = false;
        bench.wait(10);
        rows.append(&mut bench.rows);
    }
}

#[test]
fn every_row_of_every_table_fires() {
    let mut rows = Coverage::default();
    for (line, gripper, object, at) in LINES {
        let mut bench = Bench::default();
        bench.set(*gripper, object, at);
        bench.data_system.answer = Answer::After(5);
        bench.run(line);
        rows.append(&mut bench.rows);
    }
    for (line, verb, gripper, object, at) in FAILURES {
        let mut bench = Bench::default();
        bench.set(*gripper, object, at);
        bench.subtask.mishap = Some((*verb, Mishap::Error(Reason::NotAtGoal)));
        bench.run(line);
        rows.append(&mut bench.rows);
    }
    with_data_system(&mut rows);
    with_operator(&mut rows);
    recovery::all_rows(&mut rows);
    for (line, _) in REFUSED {
        let mut bench = Bench::default();
        bench.run(line);
        rows.append(&mut bench.rows);
    }
    let mut bench = Bench::default();
    bench.command(TO_TRAY);
    bench.external.hws.checked = Checked::Fails;
    assert_eq!(bench.finish(), (HwsReport::Error, Reason::CheckFailed));
    rows.append(&mut bench.rows);
    let store = without(&["-o-loc- PART"]);
    let mut bench = Bench::with(store.view());
    bench.run("MOVE PART +1 UNIT_1 1 +1 SAFE 0 -- 0");
    rows.append(&mut bench.rows);
    let mut bench = Bench::default();
    bench.command(TO_TRAY);
    bench.process = Task::default();
    bench.finish();
    rows.append(&mut bench.rows);
    let mut bench = Bench::default();
    bench.command(TO_TRAY);
    bench.step();
    bench.step();
    bench.command("PAUSE -- +0 -- 0 +0 -- 0 -- 0");
    (0..2).for_each(|_| {
        bench.step();
    });
    bench.process = Task::default();
    bench.finish();
    rows.append(&mut bench.rows);
    // The task data have no gripper numbers but 1 to 3. The look-up of a location needs no grip. No process is above.
    // The rows about updates are in no header.
    let updates = ["UPDATE-DUE", "FOLLOW", "TAKE", "RELEASED"];
    let mut missing = rows.missing(TABLES);
    missing.retain(|row| !updates.iter().any(|table| row.starts_with(table)));
    assert_eq!(missing, ["ACCEPT 4", "ACCEPT 9", "HALT 4"]);
}

/// So no order is given twice, and Task needs no EFFECT. An update that is told again ends by itself: the Data
/// System takes it, refuses it or is silent.
#[test]
fn every_order_of_task_leads_to_a_later_step() {
    let others = [
        &["EXECUTE", "ACCEPT", "PRECONDITION", "HALT", "JOYSTICK", "ORDERED", "CONFIRM"][..],
        &["UPDATE-DUE", "FOLLOW", "TAKE", "RELEASED"],
    ]
    .concat();
    let no_orders = ["Wait", "Finish", "Fail", "PassUp", "Connect", "TellOwed"];
    let mut orders = 0;
    for table in TABLES.iter().filter(|table| !others.contains(&table.name)) {
        let steps = table.steps.expect("a command has steps").variants;
        let place = |step: &str| steps.iter().position(|variant| variant.name == step).unwrap();
        for row in table.rows.iter().filter(|row| !no_orders.contains(&row.action)) {
            let next = place(row.next.unwrap_or_else(|| panic!("{} {row}: no next step", table.name)));
            assert!(!row.steps.is_empty(), "{} {row}: in any step", table.name);
            assert!(row.steps.iter().all(|step| place(step) < next), "{} {row}", table.name);
            orders += 1;
        }
    }
    assert!(orders > 40, "{orders}");
}

#[test]
fn as_long_as_the_operator_does_not_have_the_robot_the_joystick_table_lets_the_command_go_on() {
    for subtask in [Lower::Pending, Lower::Executing, Lower::Done, Lower::Error, Lower::Lost] {
        for &outcome in Outcome::ALL {
            let verdict = joystick(Control::Automatic, &Operator { subtask, outcome });
            assert_eq!(verdict, Verdict::Passed(Takeover::None));
        }
    }
}

#[test]
fn a_command_whose_gripper_has_a_number_of_none_is_refused() {
    let request =
        Request { asked: Asked::Now, verb: TaskVerb::Move, gripper: Gripper::Invalid, ..Request::default() };
    let Verdict::Decided(decision) = accept((), &request) else { panic!() };
    assert_eq!((decision.row, decision.action), (4, Action::Fail(Reason::WrongGripper)));
}
