//! Commands that are interrupted, replaced or stopped by a restart, and repeated (docs/design/recovery.md).

use interfaces::{
    Reason, StatusReport,
    data_base::{Connection, DataBaseVerb},
    emove::{Holding, ObjectGrip},
    hws::HwsReport,
    operator::Support,
    subtask::SubtaskVerb,
};
use rcs_core::name::{Name10, Name16};

use super::{
    ACQUIRE, FROM_TRAY, HOME, INSERT, NOWHERE, PAUSE, POSITION_RELEASE, RELEASE, REMOVE, SHUTDOWN, STARTUP,
    TRANSFER, TRANSFER_AND_STAY,
    bench::{Answer, Bench, FINISHED},
    error,
};

pub(super) const SCENARIOS: &[fn()] = &[
    new_command_stops_the_running_one_before_it_is_answered,
    next_command_waits_for_a_replaced_pause,
    transfer_without_end_returns_to_its_object,
    part_in_the_pedestal_is_regripped_first,
    interrupted_tool_command_resumes,
    tool_command_without_end_is_finished_only_at_the_drum,
    tool_command_with_its_effect_only_leaves,
    release_requires_a_known_way_out,
    position_at_a_vise_releases_only_a_clamped_or_confirmed_part,
    position_in_mid_air_releases_only_a_part_held_by_a_person,
    two_pending_updates_are_sent_in_order,
    unanswered_updates_are_sent_in_order,
];

const REGRIP: &str = "TRANSFER PART +1 PFIXTURE 0 -1 UNIT_1 2 SAFE 0";
const POSITION_RELEASE_BY_DESTINATION: &str = "POSITION PART 0 -- 0 +1 PFIXTURE 0 -- 0";

fn moving_bench() -> Bench<'static> {
    let mut bench = Bench::connected();
    bench.world.subtask.loses_place = true;
    bench
}

fn is_under_way(bench: &Bench<'_>) -> bool {
    let pausing = bench.memory.task.subtask.command == SubtaskVerb::Pause;
    let status = &bench.memory.subtask.status;
    !pausing && (status.report == StatusReport::Executing || status.echo != bench.memory.task.subtask.number)
}

#[test]
fn new_command_stops_the_running_one_before_it_is_answered() {
    for line in [PAUSE, HOME, NOWHERE, STARTUP, SHUTDOWN, TRANSFER, POSITION_RELEASE, ACQUIRE] {
        let mut bench = Bench::default();
        bench.world.data_system.answer = Answer::After(2);
        bench.command(TRANSFER);
        for mut bench in bench.at_every_tick() {
            let tick = bench.tick;
            let under_way = is_under_way(&bench);
            let before = bench.world.subtask.received.len();
            bench.command(line);
            bench.step();
            if under_way {
                assert_eq!(bench.memory.task.subtask.command, SubtaskVerb::Pause, "{line}, tick {tick}");
                assert_eq!(bench.memory.task.status.report, HwsReport::Executing);
            }
            bench.until(|bench| bench.memory.task.status.report != HwsReport::Executing);
            assert!(!is_under_way(&bench), "{line}, tick {tick}: Subtask is still busy");
            assert_eq!(bench.memory.subtask.status.report, StatusReport::Done);
            if under_way && line == NOWHERE {
                assert_eq!(bench.sent()[before..].last(), Some(&"S-PAUSE"));
                assert_eq!(bench.memory.task.status.reason, Reason::UnknownLocation);
            }
        }
    }
}

#[test]
fn command_without_predecessor_is_accepted_in_its_first_tick() {
    let mut bench = Bench::default();
    for line in [TRANSFER, HOME] {
        bench.command(line);
        let number = bench.memory.task.subtask.number;
        bench.step();
        assert_ne!(bench.memory.task.subtask.number, number);
        assert_ne!(bench.memory.task.subtask.command, SubtaskVerb::Pause);
        bench.finish();
    }
}

#[test]
fn next_command_waits_for_a_replaced_pause() {
    let mut bench = Bench::default();
    bench.command(TRANSFER);
    bench.wait(6);
    bench.command(PAUSE);
    bench.wait(2);
    assert_eq!(bench.run(HOME), FINISHED);
    assert_eq!(bench.sent(), ["GOTO-DEST"], "one S-PAUSE is enough");
    // A restart interrupts the pause.
    let mut bench = Bench::default();
    bench.command(TRANSFER);
    bench.wait(2);
    bench.command(PAUSE);
    bench.wait(2);
    bench.restart();
    assert_eq!(bench.finish(), error(Reason::Restarted));
    assert_eq!(bench.sent().iter().filter(|word| **word == "S-PAUSE").count(), 1);
}

#[test]
fn restarted_task_stops_its_orders() {
    let mut bench = Bench::default();
    bench.command(TRANSFER);
    for mut bench in bench.at_every_tick() {
        let tick = bench.tick;
        let under_way = is_under_way(&bench);
        bench.restart();
        assert_eq!(bench.finish(), error(Reason::Restarted));
        bench.wait(10);
        assert!(!is_under_way(&bench));
        assert_eq!(bench.sent().last() == Some(&"S-PAUSE"), under_way, "tick {tick}");
        assert_eq!(bench.memory.task.status.reason, Reason::Restarted);
        assert_eq!(bench.run(TRANSFER), FINISHED);
    }
}

#[test]
fn manual_control_sends_nothing_to_subtask() {
    let mut bench = Bench::default();
    bench.command(TRANSFER);
    bench.wait(6);
    bench.world.subtask.joystick = true;
    bench.wait(10);
    let sent = bench.sent().len();
    for line in [NOWHERE, HOME] {
        bench.command(line);
        bench.wait(10);
        assert_eq!(bench.sent().len(), sent, "{line}");
    }
}

/// The event before a command is repeated: another command, or a restart.
const INTERRUPTIONS: [Option<&str>; 4] = [Some(PAUSE), Some(NOWHERE), Some(HOME), None];

#[test]
fn interrupted_transfer_resumes() {
    for (line, by) in
        [TRANSFER, TRANSFER_AND_STAY, REGRIP].into_iter().flat_map(|line| INTERRUPTIONS.map(|by| (line, by)))
    {
        for mut bench in moving_bench().interrupted(line, by) {
            let case = format!("{line}, {by:?}, tick {}", bench.tick);
            let (placed, told) = (bench.memory.subtask.status.placed.is_some(), updates(&bench).len());
            assert_eq!(bench.run(line), FINISHED, "{case}");
            if placed {
                let rest: &[&str] = match (line, by) {
                    (TRANSFER_AND_STAY, Some(HOME)) => &[">POSITION"],
                    (TRANSFER_AND_STAY, _) => &[],
                    _ => &["GOTO-ENDPT"],
                };
                assert_eq!(bench.sent(), rest, "{case}");
                assert_eq!(told + bench.asked().len(), 1, "{case}: one update");
            } else {
                assert!(bench.sent().contains(&"PLACE-OBJ"));
            }
            // A finished command starts from the beginning.
            assert_eq!(bench.memory.task.ledger, None);
            assert_eq!(bench.run(line), FINISHED);
            assert_eq!(bench.sent()[..2], ["GET-ENDEFF", "GET-OBJECT"]);
        }
    }
}

#[test]
fn transfer_without_end_returns_to_its_object() {
    let other_grip = "TRANSFER PART +1 PFIXTURE 0 -1 UNIT_1 2 -- 0";
    for line in [TRANSFER_AND_STAY, other_grip] {
        let mut bench = moving_bench();
        bench.command(line);
        bench.until(|bench| bench.memory.subtask.status.placed.is_some());
        assert_eq!(bench.run(HOME), FINISHED);
        assert_eq!(bench.run(line), FINISHED);
        assert_eq!(bench.sent(), [">POSITION"]);
        let at = bench.memory.subtask.status.at.unwrap();
        assert_eq!(
            (at.site.location.as_str(), at.grip),
            ("UNIT_1", Some(bench.memory.task.subtask.destination_grip))
        );
    }
    // With an end-at location, the TRANSFER continues from any place of the robot.
    let mut bench = moving_bench();
    bench.command(TRANSFER);
    bench.until(|bench| bench.memory.subtask.status.placed.is_some());
    assert_eq!(bench.run(HOME), FINISHED);
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.sent(), ["GOTO-ENDPT"]);
}

#[test]
fn transfer_ignores_an_object_placed_by_an_earlier_command() {
    let mut bench = moving_bench();
    assert_eq!(bench.run(TRANSFER), FINISHED);
    bench.command(TRANSFER);
    bench.until(|bench| bench.memory.task.subtask.command == SubtaskVerb::GetObject);
    assert_eq!(bench.run(PAUSE), FINISHED);
    assert!(bench.memory.subtask.status.placed.is_some());
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "PLACE-OBJ", "GOTO-ENDPT"]);
}

#[test]
fn command_for_another_object_ends_the_interrupted_one() {
    let mut bench = moving_bench();
    bench.command(TRANSFER);
    bench.until(|bench| bench.memory.task.subtask.command == SubtaskVerb::GotoEndpt);
    assert_eq!(bench.run("ACQUIRE BAR +1 PFIXTURE 0 0 -- 0 -- 0"), FINISHED);
    bench.world.subtask.hold("");
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "PLACE-OBJ", "GOTO-ENDPT"]);
}

#[test]
fn part_in_the_pedestal_is_regripped_first() {
    for (line, words) in [
        (REGRIP, &["FIX-GRIP", "PLACE-OBJ", "GOTO-ENDPT"][..]),
        ("MOVE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0", &["FIX-GRIP", "MOVE-OBJ>D"]),
        ("REFIXTURE PART +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0", &["FIX-GRIP", "MOVE-OBJ>D"]),
        // No regrip is needed: Subtask reports the obstacle.
        (TRANSFER, &["GET-ENDEFF", "GET-OBJECT", "PLACE-OBJ", "GOTO-ENDPT"]),
    ] {
        let mut bench = Bench::default();
        bench.world.subtask.outputs.status.pedestal_part = true;
        bench.step();
        assert_eq!(bench.run(line), FINISHED);
        assert_eq!(bench.sent(), words, "{line}");
    }
}

#[test]
fn interrupted_tool_command_resumes() {
    for (line, object, at) in [
        (INSERT, "TOOL-1", "TOOL-SAFE"),
        (RELEASE, "TOOL-1", "TOOL-TRNS"),
        (ACQUIRE, "", "HOME"),
        (REMOVE, "TOOL-1", "TOOL-TRNS"),
    ] {
        for by in [Some(PAUSE), None] {
            let mut bench = moving_bench();
            bench.set(3, object, at);
            for mut bench in bench.interrupted(line, by) {
                let case = format!("{line}, {by:?}, tick {}", bench.tick);
                assert_eq!(bench.run(line), FINISHED, "{case}");
                let status = &bench.memory.subtask.status;
                let held = matches!(line, INSERT | ACQUIRE | REMOVE);
                let drum = matches!(line, INSERT | ACQUIRE);
                assert_eq!((status.held.is_held(), status.drum), (held, drum), "{case}");
            }
        }
    }
}

/// Tool commands without an end-at location, and the held object after they are interrupted at the end.
const STAYING: [(&str, &str); 2] =
    [("RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 -- 0", ""), ("REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 -- 0", "TOOL-1")];

/// A bench after the interruption of such a command.
fn staying(line: &str, holds: &str, at: &str) -> Bench<'static> {
    let mut bench = moving_bench();
    bench.set(3, "TOOL-1", "TOOL-TRNS");
    bench.command(line);
    bench.until(|bench| !bench.memory.subtask.status.drum);
    bench.restart();
    bench.finish();
    bench.set(3, holds, at);
    bench.world.subtask.outputs.status.drum = false;
    bench.step();
    bench
}

#[test]
fn tool_command_without_end_is_finished_only_at_the_drum() {
    for (line, holds) in STAYING {
        let mut bench = staying(line, holds, "TOOL-TRNS");
        assert_eq!(bench.run(line), FINISHED, "{line}");
        for at in ["TOOL-SAFE", "HOME"] {
            let mut bench = staying(line, holds, at);
            assert_eq!(bench.run(line), error(Reason::SentAway), "{line}, {at}");
            assert!(bench.sent().is_empty());
        }
    }
}

/// The command was interrupted before its effect was detected.
#[test]
fn tool_command_with_its_effect_only_leaves() {
    for (line, held, at, sent) in [
        (RELEASE, "", "HOME", &["GOTO-ENDPT"][..]),
        (RELEASE, "", "TOOL-SAFE", &[]),
        (REMOVE, "TOOL-1", "HOME", &["GOTO-ENDPT"]),
    ] {
        let mut bench = Bench::default();
        bench.set(3, "TOOL-1", "TOOL-TRNS");
        let mut bench = bench.interrupted(line, Some(PAUSE)).nth(2).unwrap();
        bench.set(3, held, at);
        assert_eq!((bench.run(line), bench.sent()), (FINISHED, sent.to_vec()), "{line}, {at}");
    }
}

#[test]
fn release_requires_a_known_way_out() {
    for (at, reason) in [("", Reason::UnknownStart), ("HOME", Reason::NoTrajectory)] {
        let mut bench = Bench::default();
        bench.set(1, "PART", at);
        assert_eq!(bench.run(POSITION_RELEASE), error(reason), "{at}");
        assert!(bench.sent().is_empty());
    }
}

/// A bench whose robot has brought PART to a place. `held` is the content of the gripper that Subtask reports.
fn brought(held: Holding, at: &str) -> Bench<'static> {
    let mut bench = Bench::default();
    bench.set(1, "PART", at);
    bench.world.subtask.outputs.status.held = held;
    bench.external.devices.clamping = None;
    bench.step();
    bench
}

fn part() -> Holding {
    Holding::Object(ObjectGrip { object: Name16::new("PART").unwrap(), grip: 1 })
}

const STAY_AT_FIXTURE: &str = "POSITION -- 0 -- 0 0 PFIXTURE 0 -- 0";
const STAY_AT_HOME: &str = "POSITION -- 0 -- 0 0 HOME 0 -- 0";

#[test]
fn position_at_a_vise_releases_only_a_clamped_or_confirmed_part() {
    for held in [part(), Holding::Something, Holding::NotKnown] {
        // Hold-and-seat: the command names an object at the fixture (VIII.2).
        assert_eq!(brought(held, "PFIXTURE").run(POSITION_RELEASE), FINISHED, "{held:?}");
    }
    assert_eq!(brought(part(), "PFIXTURE").run(STAY_AT_FIXTURE), error(Reason::NotClamped));
    for clamping in ["HOME", "PFIXTURE"] {
        let mut bench = brought(part(), "PFIXTURE");
        bench.external.devices.clamping = Some(Name10::clipped(clamping));
        let expected = if clamping == "PFIXTURE" { FINISHED } else { error(Reason::NotClamped) };
        assert_eq!(bench.run(STAY_AT_FIXTURE), expected, "{clamping}");
    }
    for by in [Support::Clamped, Support::ByHand] {
        let mut bench = confirmed(brought(part(), "PFIXTURE"), by);
        assert_eq!(bench.run(STAY_AT_FIXTURE), FINISHED, "{by}");
        assert_eq!(bench.sent(), ["RELEASE", ">POSITION"]);
    }
}

#[test]
fn position_in_mid_air_releases_only_a_part_held_by_a_person() {
    let cases = [
        (part(), Reason::HeldElsewhere),
        (Holding::Something, Reason::UnknownHeld),
        (Holding::NotKnown, Reason::HeldNotKnown),
    ];
    for (held, reason) in cases {
        for by in [None, Some(Support::Clamped)] {
            let bench = brought(held, "HOME");
            let mut bench = if let Some(by) = by { confirmed(bench, by) } else { bench };
            assert_eq!(bench.run(STAY_AT_HOME), error(reason), "{by:?}");
            assert!(bench.sent().is_empty());
        }
        let mut bench = confirmed(brought(held, "HOME"), Support::ByHand);
        assert_eq!(bench.run(STAY_AT_HOME), FINISHED, "{held:?}");
    }
    // At the pedestal only its hand supports a part, and grip data at `$$$` do not describe a fixture.
    for at in ["PEDESTAL", "SAFE"] {
        let mut bench = brought(part(), at);
        let stay = format!("POSITION -- 0 -- 0 0 {at} 0 -- 0");
        assert_eq!(bench.run(&stay), error(Reason::HeldElsewhere), "{at}");
    }
}

#[test]
fn position_in_a_nest_releases() {
    let mut bench = Bench::default();
    bench.set(2, "CYLINDER", "V-VFIXTURE");
    assert_eq!(bench.run("POSITION -- 0 -- 0 0 V-VFIXTURE 0 -- 0"), FINISHED);
    bench.set(1, "PART", "V-VFIXTURE");
    assert_eq!(bench.run("POSITION -- 0 -- 0 0 V-VFIXTURE 0 -- 0"), error(Reason::HeldElsewhere));
}

fn confirmed(mut bench: Bench<'static>, by: Support) -> Bench<'static> {
    bench.external.operator.confirmed = Some(by);
    bench.step();
    bench.external.operator.confirmed = None;
    bench.step();
    bench
}

#[test]
fn confirmation_ends_when_the_robot_leaves_or_holds_nothing() {
    let counts = |bench: &Bench<'_>| bench.memory.task.confirmed.is_some();
    let mut bench = confirmed(brought(part(), "HOME"), Support::ByHand);
    assert!(counts(&bench));
    bench.restart();
    bench.step();
    assert!(counts(&bench), "a restarted Task keeps it");
    bench.world.subtask.outputs.status.at = None;
    bench.wait(2);
    assert!(!counts(&bench));
    let mut bench = confirmed(brought(part(), "HOME"), Support::ByHand);
    bench.world.subtask.outputs.status.held = Holding::Nothing;
    bench.wait(2);
    assert!(!counts(&bench));
    assert!(!counts(&confirmed(brought(Holding::Nothing, "HOME"), Support::ByHand)));
}

fn updates(bench: &Bench<'_>) -> Vec<(String, i32)> {
    let told = bench.world.data_system.received.iter().filter(|told| told.command == DataBaseVerb::Update);
    told.map(|told| (told.position.to_string(), told.sector.unwrap_or(0))).collect()
}

/// The robot arrives before the Data System answers.
#[test]
fn position_waits_for_its_update() {
    for seat in [POSITION_RELEASE, POSITION_RELEASE_BY_DESTINATION] {
        let mut bench = Bench::connected();
        assert_eq!(bench.run(FROM_TRAY), FINISHED);
        bench.world.data_system.answer = Answer::After(100);
        assert_eq!(bench.run(seat), FINISHED);
        assert_eq!(updates(&bench), [("PFIXTURE".to_owned(), 0)]);
        assert_eq!(bench.sent(), ["RELEASE", ">POSITION"]);
        assert!(bench.memory.task.updates.pending.iter().all(Option::is_none));
    }
}

#[test]
fn release_updates_the_database() {
    for seat in [POSITION_RELEASE, POSITION_RELEASE_BY_DESTINATION] {
        let mut bench = Bench::connected();
        assert_eq!(bench.run(FROM_TRAY), FINISHED);
        assert_eq!(updates(&bench), [("H_ROBOT".to_owned(), 0)]);
        assert_eq!(bench.run(seat), FINISHED);
        assert_eq!(updates(&bench), [("PFIXTURE".to_owned(), 0)]);
        let told = bench.world.data_system.received[0];
        assert_eq!((told.item, told.serial), (Name16::new("PART").unwrap(), Name16::new("S-17").unwrap()));
        assert_eq!(bench.run(seat), FINISHED);
        assert!(updates(&bench).is_empty(), "the gripper is empty");
    }
    // ACQUIRE takes the object from one tray, and POSITION releases it in the tray of a MOVE.
    let mut bench = Bench::connected();
    assert_eq!(bench.run("ACQUIRE PART +1 UNIT_1 2 0 -- 0 -- 0"), FINISHED);
    assert_eq!(updates(&bench), [("H_ROBOT".to_owned(), 0)]);
    assert_eq!(bench.run("MOVE PART +1 UNIT_1 2 +1 UNIT_1 1 -- 0"), FINISHED);
    assert_eq!(bench.run("POSITION PART +1 UNIT_1 1 0 -- 0 -- 0"), FINISHED);
    assert_eq!(updates(&bench), [("UNIT_1".to_owned(), 1)]);
    // The database does not have this object as held by the robot.
    let mut bench = Bench::connected();
    assert_eq!(bench.run("MOVE PART +1 PFIXTURE 0 +1 PFIXTURE 0 -- 0"), FINISHED);
    assert_eq!(bench.run(POSITION_RELEASE), FINISHED);
    assert!(updates(&bench).is_empty());
}

/// A bench with two pending updates: an object was taken, and released again.
fn owing_two(trouble: Answer) -> Bench<'static> {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = trouble;
    bench.run(FROM_TRAY);
    bench.run(POSITION_RELEASE);
    bench
}

#[test]
fn two_pending_updates_are_sent_in_order() {
    for trouble in [Answer::Absent, Answer::Refuse] {
        for line in [TRANSFER, FROM_TRAY, "ACQUIRE PART +1 UNIT_1 2 0 -- 0 -- 0", STARTUP] {
            let mut bench = owing_two(trouble);
            assert!(!bench.memory.subtask.status.held.is_held(), "the object is released anyway");
            bench.world.data_system.answer = Answer::After(1);
            assert_eq!(bench.run(line), FINISHED);
            assert_eq!(
                updates(&bench)[..2],
                [("H_ROBOT".to_owned(), 0), ("PFIXTURE".to_owned(), 0)],
                "{line}, {trouble:?}"
            );
        }
    }
}

#[test]
fn pending_update_survives_a_replaced_command() {
    for by in [PAUSE, HOME, NOWHERE] {
        let mut bench = Bench::connected();
        bench.world.data_system.answer = Answer::Absent;
        bench.command(TRANSFER);
        bench.until(|bench| !bench.asked().is_empty());
        bench.command(by);
        bench.finish();
        bench.world.data_system.answer = Answer::After(1);
        assert_eq!(bench.run("ACQUIRE BAR +1 PFIXTURE 0 0 -- 0 -- 0"), FINISHED);
        // The first update may have been written once more, without an answer.
        assert!(updates(&bench).len() <= 1);
        assert!(bench.memory.task.updates.pending.iter().all(Option::is_none), "{by}");
    }
}

#[test]
fn interrupted_startup_leaves_the_connection_closed() {
    let mut bench = Bench::default();
    assert_eq!(bench.memory.task.connection, Connection::Closed);
    bench.command(STARTUP);
    bench.wait(3);
    assert_eq!(bench.memory.task.connection, Connection::Opening);
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.memory.task.connection, Connection::Interrupted);
    assert!(updates(&bench).is_empty());
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.run(STARTUP), FINISHED);
    assert_eq!(bench.memory.task.connection, Connection::Open);
    assert_eq!(bench.run(SHUTDOWN), FINISHED);
    assert_eq!(bench.memory.task.connection, Connection::Closed);
}

#[test]
fn restarted_task_keeps_its_estimates() {
    // Pending updates are sent in order.
    let mut bench = owing_two(Answer::Refuse);
    bench.restart();
    bench.step();
    assert_eq!(bench.memory.task.connection, Connection::Open);
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.run(FROM_TRAY), FINISHED);
    assert_eq!(updates(&bench)[..2], [("H_ROBOT".to_owned(), 0), ("PFIXTURE".to_owned(), 0)]);
    // The carried object is still known.
    bench.restart();
    bench.step();
    assert_eq!(bench.run(POSITION_RELEASE), FINISHED);
    assert_eq!(updates(&bench), [("PFIXTURE".to_owned(), 0)]);
    // An update that is accepted after the restart was sent before it.
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::After(8);
    bench.command(TRANSFER);
    bench.until(|bench| !bench.asked().is_empty());
    bench.restart();
    bench.wait(12);
    assert_eq!(bench.memory.task.updates.pending, [None; 2]);
    // A STARTUP that a restart interrupts is remembered.
    let mut bench = Bench::default();
    bench.command(STARTUP);
    bench.wait(3);
    bench.restart();
    assert_eq!(bench.finish(), error(Reason::Restarted));
    assert_eq!(bench.memory.task.connection, Connection::Interrupted);
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.memory.task.connection, Connection::Interrupted);
    assert!(updates(&bench).is_empty());
}

#[test]
fn link_failure_after_a_pause_changes_only_the_reason() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(PAUSE), FINISHED);
    bench.world.subtask.outputs.status.reason = Reason::LinkOff;
    bench.wait(3);
    let status = bench.memory.task.status;
    assert_eq!((status.report, status.reason), (HwsReport::Finished, Reason::LinkOff));
    assert_eq!(bench.run(HOME), FINISHED);
}

/// The Data System begins to answer when the first of two updates is written again.
#[test]
fn unanswered_updates_are_sent_in_order() {
    let mut bench = Bench::connected();
    bench.world.data_system.answer = Answer::Absent;
    bench.run(FROM_TRAY);
    bench.world.data_system.received.clear();
    bench.command(POSITION_RELEASE);
    bench.until(|bench| !bench.world.data_system.received.is_empty());
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.finish(), FINISHED);
    assert_eq!(updates(&bench), [("H_ROBOT".to_owned(), 0), ("PFIXTURE".to_owned(), 0)]);
    // The same with a tool.
    let mut bench = Bench::connected();
    bench.set(3, "TOOL-1", "HOME");
    bench.world.data_system.answer = Answer::Absent;
    bench.run("MOVE TOOL-1 +1 UNIT_1 2 +1 TOOL-SAFE 0 -- 0");
    bench.set(3, "TOOL-1", "TOOL-TRNS");
    bench.world.data_system.received.clear();
    bench.command(RELEASE);
    bench.until(|bench| !bench.world.data_system.received.is_empty());
    bench.world.data_system.answer = Answer::After(1);
    assert_eq!(bench.finish(), FINISHED);
    assert_eq!(updates(&bench), [("H_ROBOT".to_owned(), 0), ("TOOL-TRNS".to_owned(), 0)]);
}
