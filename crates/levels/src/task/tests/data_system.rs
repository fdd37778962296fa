use interfaces::{
    Reason,
    data_base::DataBaseVerb,
    emove::Holding,
    hws::HwsReport,
    operator::{Variable, Write},
    process::{Inputs, Process},
    subtask::SubtaskStatus,
};
use rcs_core::name::Name16;

use super::{
    FROM_TRAY, HOME, NOWHERE, PAUSE, POSITION_RELEASE, SAFE, SHUTDOWN, STARTUP, TRANSFER, TRANSFER_AND_STAY,
    bench::{Answer, Bench, FINISHED},
    error,
};
use crate::task::data_system::{ANSWER_LIMIT, MAX_TRIES};

pub(super) const SCENARIOS: &[fn()] = &[
    late_answer_to_a_repeated_update_is_ignored,
    repeated_position_updates_the_object_it_released,
    parts_of_one_name_keep_their_serial_numbers,
    refixture_sends_pending_updates_first,
];

/// The last update: item, serial number, position, sector.
fn update(bench: &Bench<'_>) -> (String, String, String, i32) {
    let told = bench.world.data_system.received.iter().rfind(|c| c.command == DataBaseVerb::Update).unwrap();
    (told.item.to_string(), told.serial.to_string(), told.position.to_string(), told.sector.unwrap_or(0))
}

#[test]
fn startup_sends_abort_initiate_and_startup() {
    let mut bench = Bench::default();
    bench.world.data_system.answer = Answer::After(5);
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(bench.asked(), ["ABORT", "INITIATE", "STARTUP"]);
    assert!(bench.sent().is_empty(), "the robot has nothing to do with it");
    assert_eq!(bench.run(SHUTDOWN), FINISHED);
    assert_eq!(bench.asked(), ["ABORT"]);
}

#[test]
fn unconnected_data_system_receives_nothing() {
    let mut bench = Bench::default();
    for line in [TRANSFER, FROM_TRAY] {
        assert_eq!(bench.run(line), FINISHED);
    }
    assert!(bench.asked().is_empty());
    let mut bench = Bench::connected();
    assert_eq!(bench.run(SHUTDOWN), FINISHED);
    bench.world.data_system.answer = Answer::Absent;
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert!(bench.asked().is_empty());
}

#[test]
fn db_done_waits_for_no_answer() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Absent;
    bench.external.operator.db_done = true;
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.asked(), ["UPDATE"], "it is sent once");
    assert!(bench.memory.task.updates.pending.iter().all(Option::is_none), "no update is pending");
    bench.external.operator.db_done = false;
    assert_eq!(bench.run(FROM_TRAY), error(Reason::DataBaseSilent));
}

#[test]
fn only_moves_from_and_to_the_mbd_are_updates() {
    let mut bench = Bench::connected();
    assert_eq!(bench.run(TRANSFER), FINISHED);
    let words = |item: &str, position: &str, sector| {
        (item.to_owned(), "S-17".to_owned(), position.to_owned(), sector)
    };
    assert_eq!(update(&bench), words("PART", "UNIT_1", 2));
    assert_eq!(bench.run(TRANSFER_AND_STAY), FINISHED);
    assert_eq!((bench.asked(), update(&bench)), (vec!["UPDATE"], words("PART", "UNIT_1", 2)));
    assert_eq!(bench.run(FROM_TRAY), FINISHED);
    assert_eq!((bench.asked(), update(&bench)), (vec!["UPDATE"], words("PART", "H_ROBOT", 0)));
    bench.world.subtask.hold("");
    assert_eq!(bench.run("TRANSFER PART +1 UNIT_1 1 +1 PFIXTURE 0 SAFE 0"), FINISHED);
    assert_eq!((bench.asked(), update(&bench)), (vec!["UPDATE"], words("PART", "PFIXTURE", 0)));
    for line in ["TRANSFER PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", "MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0"] {
        assert_eq!(bench.run(line), FINISHED);
        assert!(bench.asked().is_empty(), "{line}");
    }
    assert_eq!(bench.run(SAFE), FINISHED);
    assert!(bench.asked().is_empty());
}

#[test]
fn update_precedes_the_departure_of_the_robot() {
    let mut bench = Bench::connected();
    bench.command(TRANSFER);
    bench.until(|bench| !bench.asked().is_empty());
    assert_eq!(bench.sent().last(), Some(&"PLACE-OBJ"), "GOTO-ENDPT has not arrived yet");
    assert_eq!(bench.finish(), FINISHED);
    assert_eq!(bench.asked(), ["UPDATE"]);
}

#[test]
fn task_waits_for_a_slow_data_system() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::After(200);
    for line in [TRANSFER, FROM_TRAY] {
        let before = bench.tick;
        assert_eq!(bench.run(line), FINISHED);
        assert!(bench.tick.since(before) > 200);
        assert_eq!(bench.asked(), ["UPDATE"]);
    }
}

#[test]
fn silent_data_system_is_retried_and_then_reported() {
    for line in [TRANSFER, TRANSFER_AND_STAY, FROM_TRAY] {
        let mut bench = Bench::connected();
        bench.world.data_system.answer = Answer::Absent;
        let before = bench.tick;
        assert_eq!(bench.run(line), error(Reason::DataBaseSilent), "{line}");
        assert!(bench.tick.since(before) > u64::from(MAX_TRIES) * ANSWER_LIMIT);
        assert_eq!(bench.asked(), ["UPDATE"; MAX_TRIES as usize]);
        let numbers: Vec<_> = bench.world.data_system.received.iter().map(|c| c.number).collect();
        assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1));
    }
}

#[test]
fn late_answer_to_a_repeated_update_is_ignored() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Absent;
    bench.command(TRANSFER);
    while bench.world.data_system.received.len() < 2 {
        assert_eq!(bench.step().status.report, HwsReport::Executing);
    }
    bench.external.data_base.report = interfaces::data_base::DataBaseReport::Done;
    bench.external.data_base.echo = bench.world.data_system.received[0].number;
    bench.world.data_system.status = bench.external.data_base;
    (0..20).for_each(|_| assert_eq!(bench.step().status.report, HwsReport::Executing));
    bench.world.data_system.answer = Answer::After(0);
    assert_eq!(bench.finish(), FINISHED);
}

#[test]
fn pending_update_precedes_the_next_object_motion() {
    for trouble in [Answer::Absent, Answer::Refuse] {
        let reason = if trouble == Answer::Refuse { Reason::DataBase } else { Reason::DataBaseSilent };
        let mut bench = Bench::connected();
        bench.world.data_system.answer = trouble;
        assert_eq!(bench.run(TRANSFER), error(reason));
        let kept = update(&bench);
        // The robot alone can move.
        assert_eq!(bench.run(SAFE), FINISHED);
        // No object can move while the update is pending.
        for line in [FROM_TRAY, TRANSFER] {
            assert_eq!(bench.run(line), error(reason));
            assert_eq!((bench.sent(), update(&bench)), (vec![], kept.clone()));
        }
        bench.world.data_system.answer = Answer::After(1);
        assert_eq!(bench.run(FROM_TRAY), FINISHED);
        assert_eq!(bench.asked(), ["UPDATE", "UPDATE"]);
        let first = bench.world.data_system.received[0];
        assert_eq!((first.position.as_str(), first.sector), ("UNIT_1", Some(2)));
        assert_eq!(update(&bench).2, "H_ROBOT");
    }
}

#[test]
fn pending_update_follows_the_next_startup() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Absent;
    assert_eq!(bench.run(TRANSFER), error(Reason::DataBaseSilent));
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(bench.asked(), ["ABORT", "INITIATE", "STARTUP", "UPDATE"]);
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(bench.asked(), ["ABORT", "INITIATE", "STARTUP"], "it is pending no longer");
    // SHUTDOWN drops the pending updates.
    bench.world.data_system.answer = Answer::Absent;
    assert_eq!(bench.run(FROM_TRAY), error(Reason::DataBaseSilent));
    assert_eq!(bench.run(SHUTDOWN), error(Reason::DataBaseSilent));
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(bench.asked(), ["ABORT", "INITIATE", "STARTUP"]);
}

#[test]
fn late_answer_after_a_failed_command_settles_the_update() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Absent;
    assert_eq!(bench.run(TRANSFER), error(Reason::DataBaseSilent));
    bench.world.data_system.answer = Answer::After(0);
    bench.wait(3);
    assert_eq!(bench.run(FROM_TRAY), FINISHED);
    assert_eq!(bench.asked(), ["UPDATE"], "only that of this command");
}

#[test]
fn refused_connection_is_reported() {
    for verb in [DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup] {
        for (answer, reason) in [(Answer::Refuse, Reason::DataBase), (Answer::Absent, Reason::DataBaseSilent)]
        {
            let mut bench = Bench::default();
            bench.world.data_system.answer = Answer::After(1);
            bench.world.data_system.except = Some((verb, answer));
            assert_eq!(bench.run(STARTUP), error(reason), "{verb}");
            // No update without a connection.
            assert_eq!(bench.run(TRANSFER), FINISHED);
            assert!(bench.asked().is_empty());
        }
    }
    for (answer, reason) in [(Answer::Refuse, Reason::DataBase), (Answer::Absent, Reason::DataBaseSilent)] {
        let mut bench = Bench::connected();
        bench.world.data_system.answer = answer;
        assert_eq!(bench.run(SHUTDOWN), error(reason));
        assert_eq!(bench.run(TRANSFER), FINISHED, "it is disconnected anyway");
    }
}

#[test]
fn update_carries_the_serial_number_of_the_command() {
    let mut bench = Bench::connected();
    bench.command(FROM_TRAY);
    bench.external.hws.serial = Name16::new("LB-0042").unwrap();
    assert_eq!(bench.finish(), FINISHED);
    assert_eq!(update(&bench).1, "LB-0042");
}

fn told(bench: &mut Bench<'_>, line: &str) -> Vec<String> {
    assert_eq!(bench.run(line), FINISHED, "{line}");
    let updates = bench.world.data_system.received.iter().filter(|told| told.command == DataBaseVerb::Update);
    updates.map(|told| told.position.to_string()).collect()
}

/// An ACQUIRE that finds its object in the gripper sends only the missing update of the command before.
#[test]
fn acquire_of_an_object_taken_elsewhere_sends_no_update() {
    const FROM_FIXTURE: &str = "ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0";
    const FROM_SECTOR_2: &str = "ACQUIRE PART +1 UNIT_1 2 0 -- 0 -- 0";
    const FROM_SECTOR_1: &str = "ACQUIRE PART +1 UNIT_1 1 0 -- 0 -- 0";
    // A finished command, or an ACQUIRE of another sector, took the part elsewhere. A repetition changes nothing.
    for first in [FROM_FIXTURE, "MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", FROM_SECTOR_1] {
        let mut bench = Bench::connected();
        told(&mut bench, first);
        for _ in 0..2 {
            assert!(told(&mut bench, FROM_SECTOR_2).is_empty(), "{first}");
        }
    }
    // The second command is interrupted at any tick.
    let mut bench = Bench::connected();
    told(&mut bench, FROM_FIXTURE);
    for mut bench in bench.interrupted(FROM_SECTOR_2, Some(PAUSE)) {
        assert!(told(&mut bench, FROM_SECTOR_2).is_empty(), "tick {}", bench.tick);
    }
    // The part was taken elsewhere by an interrupted command.
    let mut bench = Bench::connected();
    bench.command("MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0");
    bench.until(|bench| bench.memory.subtask.status.held.object().is_some());
    assert_eq!(bench.run(PAUSE), FINISHED);
    assert!(told(&mut bench, FROM_SECTOR_2).is_empty());
    // The part was taken from the source by the same command, by a MOVE, or before the Data System was connected.
    for first in [FROM_SECTOR_2, FROM_TRAY] {
        let mut bench = Bench::connected();
        bench.command(first);
        bench.until(|bench| bench.memory.subtask.status.held.object().is_some());
        assert_eq!(bench.run(PAUSE), FINISHED);
        assert_eq!(told(&mut bench, FROM_SECTOR_2), ["H_ROBOT"], "{first}");
    }
    let mut bench = Bench::default();
    bench.world.data_system.answer = Answer::After(1);
    assert!(told(&mut bench, FROM_SECTOR_2).is_empty());
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(told(&mut bench, FROM_SECTOR_2), ["H_ROBOT"]);
}

const POSITION_RELEASE_WITHOUT_NAME: &str = "POSITION -- 0 -- 0 0 PFIXTURE 0 -- 0";
const TO_FIXTURE: &str = "TRANSFER PART +1 SAFE 0 +1 PFIXTURE 0 -- 0";
const OTHER: &str = "TRANSFER BAR +1 PFIXTURE 0 +1 UNIT_1 1 SAFE 0";

fn positions(bench: &mut Bench<'_>) -> Vec<String> {
    let updates =
        bench.world.data_system.received.drain(..).filter(|told| told.command == DataBaseVerb::Update);
    updates.map(|told| told.position.to_string()).collect()
}

/// Benches in which `line`, which releases the part, is replaced by `by` after each number of ticks. Only those with
/// the part in the fixture are returned, with the positions of their updates.
fn let_go_while_replaced(line: &str, by: &str) -> Vec<(Bench<'static>, Vec<String>)> {
    let mut bench = Bench::connected();
    assert_eq!(told(&mut bench, FROM_TRAY), ["H_ROBOT"]);
    bench.world.data_system.received.clear();
    let placed =
        bench.interrupted(line, Some(by)).filter(|bench| bench.memory.subtask.status.placed.is_some());
    placed
        .map(|mut bench| {
            let told = positions(&mut bench);
            (bench, told)
        })
        .collect()
}

/// The part is released already when the POSITION is repeated. The update is sent nevertheless.
#[test]
fn repeated_position_updates_the_object_it_released() {
    for line in [POSITION_RELEASE, POSITION_RELEASE_WITHOUT_NAME] {
        for by in [PAUSE, NOWHERE, HOME] {
            let mut untold = 0;
            for (mut bench, mut positions) in let_go_while_replaced(line, by) {
                untold += u32::from(positions.is_empty());
                positions.extend(told(&mut bench, line));
                assert_eq!(positions, ["PFIXTURE"], "{line}, {by}");
                assert!(told(&mut bench, line).is_empty(), "{line}, {by}");
            }
            assert!(untold > 1, "{line}, {by}");
        }
    }
}

/// The command is not repeated, so the next command about another object, or a STARTUP, sends the update first.
#[test]
fn next_command_updates_an_object_released_before() {
    for line in [POSITION_RELEASE, POSITION_RELEASE_WITHOUT_NAME, TO_FIXTURE] {
        for (next, then) in [(OTHER, &["UNIT_1"][..]), (STARTUP, &[])] {
            let mut untold = 0;
            for (mut bench, mut positions) in let_go_while_replaced(line, PAUSE) {
                untold += u32::from(positions.is_empty());
                positions.extend(told(&mut bench, next));
                // A TRANSFER can be repeated after a STARTUP, and sends the update then.
                if (line, next) == (TO_FIXTURE, STARTUP) {
                    positions.extend(told(&mut bench, line));
                }
                assert_eq!(positions, [&["PFIXTURE"], then].concat(), "{line}, {next}");
            }
            assert!(untold > 1, "{line}, {next}");
        }
    }
}

/// The drum has the tool, with an end-at location or without.
#[test]
fn release_tool_updates_the_tool() {
    for end_at in ["TOOL-SAFE", "--"] {
        let release = format!("RELEASE-TOOL TOOL-1 +1 -- 0 +1 -- 0 {end_at} 0");
        let bench = || {
            let mut bench = Bench::connected();
            bench.set(3, "", "HOME");
            assert_eq!(told(&mut bench, "MOVE TOOL-1 +1 UNIT_1 2 +1 TOOL-SAFE 0 -- 0"), ["H_ROBOT"]);
            bench.set(3, "TOOL-1", "TOOL-TRNS");
            bench.world.data_system.received.clear();
            bench
        };
        assert_eq!(told(&mut bench(), &release), ["TOOL-TRNS"], "{end_at}");
        // The command is replaced at any tick after the release, and repeated.
        for mut bench in bench().interrupted(&release, Some(PAUSE)) {
            let mut positions = positions(&mut bench);
            positions.extend(told(&mut bench, &release));
            assert_eq!(positions, ["TOOL-TRNS"], "{end_at}, tick {}", bench.tick);
        }
    }
}

#[test]
fn update_of_an_abandoned_transfer_carries_its_sector() {
    let mut untold = 0;
    for (mut bench, positions) in let_go_while_replaced(TRANSFER, PAUSE) {
        if positions.is_empty() {
            untold += 1;
            assert_eq!(told(&mut bench, OTHER), ["UNIT_1", "UNIT_1"]);
            let first = bench.world.data_system.received[0];
            assert_eq!((first.item.as_str(), first.sector), ("PART", Some(2)));
        }
    }
    assert!(untold > 0);
}

/// An update of an item: serial number, position, and sector or 0.
type Told = (String, String, i32);

fn was(serial: &str, position: &str, sector: i32) -> Told {
    (serial.to_owned(), position.to_owned(), sector)
}

fn parts(bench: &mut Bench<'_>) -> Vec<Told> {
    let updates = bench.world.data_system.received.drain(..);
    let of_part = updates.filter(|told| told.command == DataBaseVerb::Update && told.item.as_str() == "PART");
    of_part.map(|told| was(told.serial.as_str(), told.position.as_str(), told.sector.unwrap_or(0))).collect()
}

fn order(bench: &mut Bench<'_>, line: &str, serial: &str) {
    bench.command(line);
    bench.external.hws.serial = Name16::new(serial).unwrap();
}

fn perform(bench: &mut Bench<'_>, line: &str, serial: &str) {
    order(bench, line, serial);
    assert_eq!(bench.finish(), FINISHED, "{line}");
}

fn until(bench: &mut Bench<'_>, holds: impl Fn(&SubtaskStatus) -> bool) {
    while !holds(&bench.memory.subtask.status) {
        assert_eq!(bench.step().status.report, HwsReport::Executing);
    }
}

/// A command that takes a part out of the MBD is replaced and not repeated. The command that releases the part, or
/// the next one about an object, sends the update. An earlier part of the same name gets no further update.
#[test]
fn object_taken_by_an_abandoned_command_is_updated() {
    const LINES: [&str; 4] = [
        "TRANSFER PART +1 UNIT_1 2 +1 PFIXTURE 0 SAFE 0",
        FROM_TRAY,
        "ACQUIRE PART +1 UNIT_1 2 0 -- 0 -- 0",
        "REFIXTURE PART +1 UNIT_1 2 +2 PFIXTURE 0 -- 0",
    ];
    for (line, by, earlier) in LINES.into_iter().flat_map(|line| {
        [PAUSE, NOWHERE, HOME].into_iter().flat_map(move |by| [(line, by, false), (line, by, true)])
    }) {
        let (mut approaching, mut placed, mut held) = (0, 0, 0);
        let mut bench = Bench::connected();
        if earlier {
            perform(&mut bench, FROM_TRAY, "A");
            bench.set(1, "PART", "PFIXTURE");
            perform(&mut bench, POSITION_RELEASE, "A");
            assert_eq!(parts(&mut bench), [was("A", "H_ROBOT", 0), was("A", "PFIXTURE", 0)]);
        }
        order(&mut bench, line, "B");
        for mut bench in bench.at_every_tick() {
            bench.command(by);
            bench.finish();
            bench.wait(5);
            let case = format!("{line}, {by}, tick {}, {earlier}", bench.tick);
            let mut told = parts(&mut bench);
            let below = bench.memory.subtask.status;
            let has_begun = bench.memory.task.updates.taking.is_none();
            if below.held.object().is_some() {
                held += 1;
                bench.set(1, "PART", "PFIXTURE");
                perform(&mut bench, POSITION_RELEASE, "B");
                told.extend(parts(&mut bench));
                told.retain(|told| *told != was("B", "H_ROBOT", 0));
                assert_eq!(told, [was("B", "PFIXTURE", 0)], "{case}");
                continue;
            }
            assert_eq!(bench.run(OTHER), FINISHED, "{case}");
            told.extend(parts(&mut bench));
            if has_begun {
                placed += 1;
                assert_eq!(told, [was("B", "PFIXTURE", 0)], "{case}");
            } else {
                approaching += 1;
                assert_eq!(told, [], "{case}");
            }
        }
        assert_eq!((approaching > 0, placed > 0, held > 0), (true, line == LINES[0], true), "{line}, {by}");
    }
}

/// The robot has lost the carried part, with a Data System or without. The next part of the same name is another
/// part.
#[test]
fn lost_part_is_not_updated_for_the_next_one() {
    let mut bench = Bench::connected();
    perform(&mut bench, FROM_TRAY, "A");
    bench.set(1, "", "PFIXTURE");
    order(&mut bench, "MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", "B");
    until(&mut bench, |below| below.held.object().is_some());
    assert_eq!(bench.run(PAUSE), FINISHED);
    bench.set(1, "PART", "PFIXTURE");
    perform(&mut bench, POSITION_RELEASE, "B");
    assert_eq!(parts(&mut bench), [was("B", "PFIXTURE", 0)]);
    const NEXT: &str = "TRANSFER PART +1 PFIXTURE 0 +1 SAFE 0 -- 0";
    for is_sent_before in [false, true] {
        let mut bench = Bench::connected();
        perform(&mut bench, FROM_TRAY, "A");
        bench.world.data_system.answer = Answer::Refuse;
        assert_eq!(bench.run(STARTUP), error(Reason::DataBase));
        if is_sent_before {
            order(&mut bench, NEXT, "B");
            bench.wait(2);
            assert_eq!(bench.run(PAUSE), FINISHED);
        }
        bench.set(1, "", "PFIXTURE");
        perform(&mut bench, NEXT, "B");
        bench.world.data_system.answer = Answer::After(1);
        assert_eq!(bench.run(STARTUP), FINISHED);
        assert_eq!(bench.run(OTHER), FINISHED);
        assert_eq!(parts(&mut bench), []);
    }
    // The same with a tool.
    let mut bench = Bench::connected();
    bench.set(3, "", "HOME");
    perform(&mut bench, "MOVE TOOL-1 +1 UNIT_1 2 +1 TOOL-SAFE 0 -- 0", "A");
    bench.set(3, "", "TOOL-SAFE");
    bench.world.data_system.received.clear();
    for line in
        ["ACQUIRE-TOOL TOOL-1 +1 -- 0 +1 TOOL-SAFE 0 -- 0", "RELEASE-TOOL TOOL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0"]
    {
        perform(&mut bench, line, "B");
        assert!(positions(&mut bench).is_empty(), "{line}");
    }
}

/// Other commands do not change the serial number of a held part. The next part of the same name has its own.
#[test]
fn parts_of_one_name_keep_their_serial_numbers() {
    for next in [
        "TRANSFER PART +1 UNIT_1 1 +1 SAFE 0 -- 0",
        "MOVE PART +1 SAFE 0 +1 HOME 0 -- 0",
        "REFIXTURE PART +1 UNIT_1 1 +2 HOME 0 -- 0",
    ] {
        let mut bench = Bench::connected();
        perform(&mut bench, FROM_TRAY, "A");
        order(&mut bench, next, "B");
        bench.wait(2);
        assert_eq!(bench.run(PAUSE), FINISHED);
        bench.set(1, "PART", "PFIXTURE");
        perform(&mut bench, POSITION_RELEASE, "A");
        assert_eq!(parts(&mut bench), [was("A", "PFIXTURE", 0)], "{next}");
    }
    for next in ["MOVE PART +1 SAFE 0 +1 HOME 0 -- 0", "ACQUIRE PART +1 UNIT_1 1 0 -- 0 -- 0"] {
        let mut bench = Bench::connected();
        perform(&mut bench, FROM_TRAY, "A");
        perform(&mut bench, next, "B");
        bench.set(1, "PART", "PFIXTURE");
        perform(&mut bench, POSITION_RELEASE, "A");
        assert_eq!(parts(&mut bench), [was("A", "H_ROBOT", 0), was("A", "PFIXTURE", 0)], "{next}");
    }
    // The held part needs no update, and another part of its name is in the tray.
    let mut bench = Bench::connected();
    order(&mut bench, "MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", "A");
    until(&mut bench, |below| below.held.object().is_some());
    assert_eq!(bench.run(PAUSE), FINISHED);
    order(&mut bench, "TRANSFER PART +1 UNIT_1 1 +1 SAFE 0 -- 0", "B");
    bench.wait(2);
    assert_eq!(bench.run(PAUSE), FINISHED);
    bench.set(1, "PART", "PFIXTURE");
    perform(&mut bench, POSITION_RELEASE, "A");
    assert_eq!(parts(&mut bench), []);
    // A replaced command released the first part, and the next one takes another part of its name.
    for next in ["TRANSFER PART +1 UNIT_1 1 +1 SAFE 0 -- 0", "TRANSFER PART +1 PFIXTURE 0 +1 SAFE 0 -- 0"] {
        let mut bench = Bench::connected();
        order(&mut bench, "TRANSFER PART +1 UNIT_1 2 +1 PFIXTURE 0 HOME 0", "A");
        until(&mut bench, |below| below.placed.is_some());
        assert_eq!(bench.run(PAUSE), FINISHED);
        order(&mut bench, next, "B");
        bench.finish();
        let mut told = parts(&mut bench);
        assert_eq!(bench.run(OTHER), FINISHED);
        told.extend(parts(&mut bench));
        assert_eq!(told.first(), Some(&was("A", "PFIXTURE", 0)), "{next}");
        let second = next.contains("UNIT_1").then(|| was("B", "SAFE", 0));
        assert_eq!(told.get(1), second.as_ref(), "{next}");
    }
}

/// The sensors of the gripper fail while a command is accepted. The held object keeps its serial number. An object
/// that was taken at another place gets no update.
#[test]
fn unreadable_gripper_keeps_serial_number_and_origin() {
    const ACQUIRE: &str = "ACQUIRE PART +1 UNIT_1 2 0 -- 0 -- 0";
    let begin = |bench: &mut Bench<'_>, line: &str, serial: &str| {
        order(bench, line, serial);
        bench.wait(2);
        assert_eq!(bench.run(PAUSE), FINISHED);
    };
    for unreadable in [Holding::NotKnown, Holding::Something] {
        let mut bench = Bench::connected();
        perform(&mut bench, "ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0", "A");
        begin(&mut bench, ACQUIRE, "A");
        let held = core::mem::replace(&mut bench.world.subtask.outputs.status.held, unreadable);
        bench.step();
        begin(&mut bench, ACQUIRE, "A");
        bench.world.subtask.outputs.status.held = held;
        bench.step();
        perform(&mut bench, ACQUIRE, "A");
        assert_eq!(parts(&mut bench), [], "it was taken from the fixture: {unreadable:?}");

        let mut bench = Bench::connected();
        perform(&mut bench, FROM_TRAY, "A");
        let held = core::mem::replace(&mut bench.world.subtask.outputs.status.held, unreadable);
        bench.step();
        begin(&mut bench, "TRANSFER PART +1 UNIT_1 1 +1 SAFE 0 -- 0", "B");
        bench.world.subtask.outputs.status.held = held;
        bench.set(1, "PART", "PFIXTURE");
        perform(&mut bench, POSITION_RELEASE, "A");
        assert_eq!(parts(&mut bench), [was("A", "PFIXTURE", 0)], "{unreadable:?}");
    }
}

/// The sector is the one where the fingers opened, not that of another command.
#[test]
fn update_carries_the_sector_of_the_release() {
    for (first, sector, next) in [
        (TRANSFER, 2, "TRANSFER PART +1 UNIT_1 2 +1 UNIT_1 1 SAFE 0"),
        ("TRANSFER PART +1 UNIT_1 2 +1 UNIT_1 1 SAFE 0", 1, "MOVE PART +1 UNIT_1 1 +1 SAFE 0 -- 0"),
        (TRANSFER, 2, "MOVE PART +1 UNIT_1 2 +1 SAFE 0 -- 0"),
    ] {
        let mut bench = Bench::connected();
        order(&mut bench, first, "A");
        until(&mut bench, |below| below.placed.is_some());
        assert_eq!(bench.run(PAUSE), FINISHED);
        order(&mut bench, next, "A");
        bench.wait(2);
        let mut told = parts(&mut bench);
        assert_eq!(bench.run(PAUSE), FINISHED);
        assert_eq!(bench.run(OTHER), FINISHED);
        told.extend(parts(&mut bench));
        assert_eq!(told, [was("A", "UNIT_1", sector)], "{first}, {next}");
    }
    // A MOVE from one sector to another is abandoned at its destination.
    let mut bench = Bench::connected();
    order(&mut bench, "MOVE PART +1 UNIT_1 2 +1 UNIT_1 1 -- 0", "A");
    until(&mut bench, |below| below.at.is_some_and(|at| at.site.sector == Some(1)));
    assert_eq!(bench.run(PAUSE), FINISHED);
    perform(&mut bench, "POSITION PART +1 UNIT_1 2 0 -- 0 -- 0", "A");
    assert!(bench.sent().ends_with(&["RELEASE", ">POSITION"]), "the sector at the robot supports it");
    assert_eq!(parts(&mut bench), [was("A", "UNIT_1", 1)]);
}

#[test]
fn transfer_accepted_in_the_tick_of_the_grasp_sends_its_update() {
    let mut bench = Bench::connected();
    order(&mut bench, FROM_TRAY, "A");
    for mut bench in bench.at_every_tick() {
        let is_held = bench.world.subtask.outputs.status.held.object().is_some();
        perform(&mut bench, TO_FIXTURE, "A");
        if is_held {
            assert_eq!(parts(&mut bench).last(), Some(&was("A", "PFIXTURE", 0)), "tick {}", bench.tick);
        }
    }
}

#[test]
fn refixture_sends_pending_updates_first() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Refuse;
    order(&mut bench, FROM_TRAY, "A");
    assert_eq!(bench.finish(), error(Reason::DataBase));
    bench.set(1, "PART", "PFIXTURE");
    order(&mut bench, POSITION_RELEASE, "A");
    assert_eq!(bench.finish(), error(Reason::DataBase));
    const REFIXTURE: &str = "REFIXTURE PART +1 UNIT_1 2 +2 PFIXTURE 0 -- 0";
    assert_eq!(bench.run(REFIXTURE), error(Reason::DataBase));
    assert!(bench.sent().is_empty(), "no motion");
    bench.world.data_system.answer = Answer::After(1);
    perform(&mut bench, REFIXTURE, "B");
    assert_eq!(parts(&mut bench).split_off(1), [was("A", "H_ROBOT", 0), was("A", "PFIXTURE", 0)]);
}

#[test]
fn deleted_ledger_deletes_the_object_to_take() {
    let mut bench = Bench::connected();
    bench.command(FROM_TRAY);
    bench.wait(3);
    assert_eq!(bench.run(PAUSE), FINISHED);
    assert!(bench.memory.task.updates.taking.is_some());
    let mut outputs = bench.memory.task;
    let (tick, memory, external, data) = (bench.tick, &bench.memory, &bench.external, &bench.data);
    let write = Write { variable: Variable::Ledger, ..Write::default() };
    bench.process.write(&write, &Inputs { tick, memory, external, data }, &mut outputs);
    bench.memory.task = outputs;
    bench.step();
    assert_eq!((bench.memory.task.ledger, bench.memory.task.updates.taking), (None, None));
}

#[test]
fn held_part_keeps_its_update_during_a_refused_transfer() {
    let mut bench = Bench::connected();
    assert_eq!(told(&mut bench, FROM_TRAY), ["H_ROBOT"]);
    bench.command(OTHER);
    bench.wait(3);
    assert_eq!(bench.run(PAUSE), FINISHED);
    bench.set(1, "PART", "PFIXTURE");
    assert_eq!(told(&mut bench, POSITION_RELEASE), ["PFIXTURE"]);
}

/// V.4.1 requires updates of moves from and to the MBD only.
#[test]
fn transfer_updates_a_part_that_the_robot_held() {
    let mut bench = Bench::connected();
    assert_eq!(told(&mut bench, FROM_TRAY), ["H_ROBOT"]);
    assert_eq!(told(&mut bench, TO_FIXTURE), ["PFIXTURE"]);
    bench.world.subtask.hold("PART");
    assert!(told(&mut bench, TO_FIXTURE).is_empty(), "the database has it elsewhere");
    // Replaced at any tick and repeated, the command sends one update.
    for by in [PAUSE, NOWHERE, HOME] {
        for (mut bench, mut positions) in let_go_while_replaced(TO_FIXTURE, by) {
            positions.extend(told(&mut bench, TO_FIXTURE));
            assert_eq!(positions, ["PFIXTURE"], "{by}");
        }
    }
}
