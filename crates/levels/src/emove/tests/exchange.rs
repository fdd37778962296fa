//! MOV-TO-HOL, QC-DETACH and QC-ATTACH.

use interfaces::{
    Reason, StatusReport,
    emove::EmoveVerb::{MovToHol, MovToLoc, MovToObj, Pause, QcAttach, QcDetach, Release},
    jaws::JawsReport,
    prim::PrimReport,
    quick_change::QuickChangeReport,
};

use super::{
    bench::{Bench, DONE, error, frame_of, moved},
    doubles::Mishap,
};

pub const SCENARIOS: &[fn()] = &[
    grippers_are_exchanged_in_the_manuals_order,
    the_gripper_closes_on_the_way_to_its_holster,
    a_robot_that_is_sent_away_from_above_a_holster_leaves_upward,
    detaching_begins_only_when_it_can,
    robot_brings_no_gripper_to_a_holster_that_is_not_empty,
    attaching_begins_only_when_it_can,
    what_is_done_already_is_done_at_once,
    a_guarded_move_that_sees_nothing_is_given_up,
    a_quick_change_that_fails_is_named,
    a_gripper_that_does_not_come_off_is_named,
    a_gripper_that_does_not_come_on_is_named,
    motions_that_fail_end_the_command,
    the_parts_gripper_is_calibrated_when_it_comes,
    data_for_the_holsters_must_be_there,
];

/// Gripper, its object and its holster.
const GRIPPERS: [(u8, &str, &str); 3] =
    [(1, "GRIPPER-1", "HOLSTER-R"), (2, "GRIPPER-2", "HOLSTER-L"), (3, "GRIPPER-3", "HOLSTER-C")];

/// A robot above the holster of the gripper that it has, fingers closed for it.
fn above(gripper: u8) -> Bench {
    let (_, object, holster) = GRIPPERS[usize::from(gripper) - 1];
    let mut bench = Bench::ready("HOME", gripper);
    assert_eq!(bench.run(MovToHol, object, 1, holster, gripper), DONE);
    bench
}

/// A bare robot above the holster of a gripper.
fn bare(gripper: u8) -> Bench {
    let (_, object, holster) = GRIPPERS[usize::from(gripper) - 1];
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(bench.run(MovToHol, object, 2, holster, gripper), DONE);
    bench
}

fn detach(bench: &mut Bench, gripper: u8) -> (StatusReport, Reason) {
    let (_, object, holster) = GRIPPERS[usize::from(gripper) - 1];
    bench.run(QcDetach, object, 1, holster, gripper)
}

fn attach(bench: &mut Bench, gripper: u8) -> (StatusReport, Reason) {
    let (_, object, holster) = GRIPPERS[usize::from(gripper) - 1];
    bench.run(QcAttach, object, 2, holster, gripper)
}

#[test]
fn grippers_are_exchanged_in_the_manuals_order() {
    for (from, old, old_holster) in GRIPPERS {
        for (to, new, new_holster) in GRIPPERS.into_iter().filter(|(to, ..)| *to != from) {
            let mut bench = above(from);
            assert!(bench.off(&moved(frame_of(old_holster), &["HOL-ABOVE"])) < 0.02);
            assert_eq!(bench.run(QcDetach, old, 1, old_holster, from), DONE);
            assert_eq!(
                bench.log(),
                [
                    "GO-UNTIL QCD-DOWN HOL-NEAR",
                    "QC-UNLOCK",
                    "GO-UNTIL QCD-SEAT HOL-SEAT",
                    "DELTA-MOVE QCD-UP"
                ]
            );
            let end = moved(frame_of(old_holster), &["QCD-DOWN", "QCD-SEAT", "QCD-UP"]);
            assert!(bench.off(&end) < 0.05, "each from where the one before ended");
            assert_eq!((bench.world.mated, bench.world.locked), (0, false));
            assert_eq!(bench.memory.emove.status.at.unwrap_or_default().site.location.as_str(), old_holster);
            assert_eq!(bench.run(MovToHol, new, 2, new_holster, to), DONE);
            assert_eq!(bench.log(), ["GO-THRU", "GOTO-PT"], "a bare robot commands no gripper");
            assert_eq!(bench.run(QcAttach, new, 2, new_holster, to), DONE);
            let close = ["POSITION", "GRASP 50", "GRASP 100"][usize::from(to) - 1];
            assert_eq!(
                bench.log(),
                ["DELTA-MOVE QCA-FAST", "DELTA-MOVE QCA-SLOW", "QC-LOCK", close]
                    .into_iter()
                    .chain(["DELTA-MOVE QCA-BACK", "DELTA-MOVE QCA-LIFT", "DELTA-MOVE QCA-UP"])
                    .collect::<Vec<_>>()
            );
            assert!(
                bench.off(&moved(frame_of(new_holster), &["QCA-UP"])) < 0.02,
                "all from the holster's pose"
            );
            assert_eq!((bench.world.mated, bench.world.locked), (to, true));
            assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
        }
    }
}

#[test]
fn the_gripper_closes_on_the_way_to_its_holster() {
    let bench = above(1);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert_eq!(bench.memory.emove.grip.position, 100);
    let mut bench = above(2);
    assert_eq!(bench.log(), ["GRASP 50", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert_eq!(bench.run(MovToHol, "GRIPPER-2", 1, "HOLSTER-L", 2), DONE, "the robot is there");
    assert!(bench.log().is_empty());
    // Away from a part whose depart points come first.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "HOLSTER-C", 1), DONE);
    assert_eq!(bench.run(Release, "BLOCK", 1, "HOLSTER-C", 1), DONE);
    assert_eq!(bench.run(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1), DONE);
    assert_eq!(bench.log()[..3], ["GO-THRU A/D-5", "POSITION", "GO-THRU"]);
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("POSITION", Mishap::Grip(Reason::GripTimeout));
    assert_eq!(bench.run(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1), error(Reason::GripTimeout));
    let mut bench = Bench::ready("HOME", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1), error(Reason::AlreadyHolding));
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("POSITION", Mishap::Never);
    bench.command(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1);
    bench.steps(100);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU A/D-5"], "the final motion waits");
}

/// No depart path is written for a gripper: the exchange leads the robot up. Sent elsewhere before that it goes out as
/// it came in, not straight to the first point of the trajectory.
#[test]
fn a_robot_that_is_sent_away_from_above_a_holster_leaves_upward() {
    let mut bench = above(1);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
    assert_eq!(bench.log()[0], "GO-THRU A/D-5");
}

#[test]
fn detaching_begins_only_when_it_can() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(detach(&mut bench, 1), error(Reason::NotPrepared), "the robot is elsewhere");
    assert_eq!(detach(&mut bench, 2), error(Reason::WrongGripper));
    for bits in [0, 0b0001, 0b0011] {
        let mut bench = Bench::ready("HOLSTER-R", 0);
        bench.world.holsters[0] = bits;
        assert_eq!(detach(&mut bench, 1), error(Reason::WrongGripper), "it is neither on nor in its holster");
    }
    let mut bench = above(1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(detach(&mut bench, 1), error(Reason::AlreadyHolding));
    for bits in [0b0001, 0b1111] {
        let mut bench = above(1);
        bench.world.holsters[0] = bits;
        assert_eq!(detach(&mut bench, 1), error(Reason::HolsterOccupied));
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"));
    }
}

/// Something hangs in the holster from the start, or is hung there when the robot is on its way.
#[test]
fn robot_brings_no_gripper_to_a_holster_that_is_not_empty() {
    for (bits, ticks) in [(0b0001, 0), (0b1111, 0), (0b1111, 10)] {
        let mut bench = Bench::ready("HOME", 1);
        bench.command(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1);
        bench.steps(ticks);
        bench.world.holsters[0] = bits;
        assert_eq!(bench.finish(), error(Reason::HolsterOccupied), "{bits:04b} after {ticks} ticks");
        assert_eq!(bench.motions().is_empty(), ticks == 0, "{bits:04b} after {ticks} ticks");
    }
    let mut bare = Bench::ready("HOME", 0);
    assert_eq!(bare.run(MovToHol, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1), DONE, "it fetches what is there");
}

#[test]
fn attaching_begins_only_when_it_can() {
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(attach(&mut bench, 1), error(Reason::NotPrepared), "the robot is elsewhere");
    for bits in [0, 0b0011, 0b0111] {
        let mut bench = bare(1);
        bench.world.holsters[0] = bits;
        assert_eq!(attach(&mut bench, 1), error(Reason::HolsterEmpty));
    }
    let mut bench = Bench::ready("HOLSTER-L", 1);
    assert_eq!(attach(&mut bench, 2), error(Reason::WrongGripper), "another one is on");
    let mut bench = Bench::ready("HOLSTER-R", 1);
    bench.world.holsters[0] = 0b0011;
    assert_eq!(attach(&mut bench, 1), DONE, "it is on and still in its holster");
    assert_eq!(bench.log(), ["DELTA-MOVE QCA-LIFT", "DELTA-MOVE QCA-UP"]);
    // A bare robot with a locked ring is unlocked first.
    let mut bench = bare(2);
    bench.world.locked = true;
    assert_eq!(attach(&mut bench, 2), DONE);
    assert_eq!(bench.log()[..2], ["QC-UNLOCK", "DELTA-MOVE QCA-FAST"]);
}

#[test]
fn what_is_done_already_is_done_at_once() {
    let mut bench = above(3);
    assert_eq!(attach(&mut bench, 3), DONE, "it is on, locked and clear");
    assert!(bench.log().is_empty());
    assert_eq!(detach(&mut bench, 3), DONE);
    assert_eq!(detach(&mut bench, 3), DONE);
    assert!(bench.log().is_empty());
}

#[test]
fn a_guarded_move_that_sees_nothing_is_given_up() {
    for word in ["QCD-DOWN", "QCD-SEAT"] {
        let mut bench = above(1);
        bench.spoil(word, Mishap::Prim(PrimReport::NotDetected, Reason::NotDetected));
        bench.command(QcDetach, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1);
        while bench.memory.prim.status.report != PrimReport::NotDetected {
            bench.step();
        }
        let since = bench.tick;
        assert_eq!(bench.finish(), error(Reason::NotDetected), "{word}");
        let waited = bench.tick.since(since);
        assert!((25..=28).contains(&waited), "{waited} ticks are not a second");
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"));
    }
}

#[test]
fn a_quick_change_that_fails_is_named() {
    for (report, reason) in [
        (QuickChangeReport::Stuck, Reason::QuickChangeStuck),
        (QuickChangeReport::SensorMalfunction, Reason::QuickChangeFault),
    ] {
        let mut bench = above(1);
        bench.spoil("QC-UNLOCK", Mishap::Ring(report));
        assert_eq!(detach(&mut bench, 1), error(reason));
        let mut bench = bare(1);
        bench.spoil("QC-LOCK", Mishap::Ring(report));
        assert_eq!(attach(&mut bench, 1), error(reason));
        let mut bench = bare(1);
        bench.world.locked = true;
        bench.spoil("QC-UNLOCK", Mishap::Ring(report));
        assert_eq!(attach(&mut bench, 1), error(reason));
    }
    for (word, locked, report) in
        [("QC-UNLOCK", true, QuickChangeReport::Locked), ("QC-LOCK", false, QuickChangeReport::Unlocked)]
    {
        let mut bench = bare(1);
        bench.world.locked = locked;
        bench.spoil(word, Mishap::Ring(report));
        assert_eq!(attach(&mut bench, 1), error(Reason::QuickChangeFault), "{word} has no effect");
    }
    let mut bench = above(1);
    bench.spoil("QC-UNLOCK", Mishap::Ring(QuickChangeReport::Locked));
    assert_eq!(detach(&mut bench, 1), error(Reason::QuickChangeFault), "it says done and is locked");
    let mut bench = bare(1);
    bench.dead.push("Quick Change");
    assert_eq!(attach(&mut bench, 1), error(Reason::NeighbourLost));
    // A gripper that is on, clear of its holster and not locked.
    let mut bench = above(1);
    bench.world.locked = false;
    assert_eq!(attach(&mut bench, 1), error(Reason::RingNotLocked));
    // The ring has not answered yet when the command comes.
    let mut bench = bare(1);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(2);
    assert_eq!(attach(&mut bench, 1), DONE);
    // It opens by itself while the gripper is being carried.
    let mut bench = bare(1);
    bench.command(QcAttach, "GRIPPER-1", 2, "HOLSTER-R", 1);
    while !bench.log().contains(&"DELTA-MOVE QCA-LIFT") {
        bench.step();
    }
    bench.world.locked = false;
    assert_eq!(bench.finish(), error(Reason::RingNotLocked));
}

#[test]
fn a_gripper_that_does_not_come_off_is_named() {
    let mut bench = above(1);
    bench.spoil("QCD-UP", Mishap::Mated(1));
    assert_eq!(detach(&mut bench, 1), error(Reason::NotDetached));
    let mut bench = above(1);
    bench.spoil("QCD-UP", Mishap::Holster(0b0011));
    assert_eq!(detach(&mut bench, 1), error(Reason::NotDetached), "it is off, and not at its seat");
    let mut bench = above(1);
    bench.command(QcDetach, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1);
    while !bench.log().contains(&"DELTA-MOVE QCD-UP") {
        bench.step();
    }
    bench.world.mated = 0;
    bench.world.resident[0] = 1;
    bench.world.locked = true;
    assert_eq!(bench.finish(), error(Reason::QuickChangeFault), "the ring has turned back");
}

#[test]
fn a_gripper_that_does_not_come_on_is_named() {
    for (word, id, reason) in [
        ("QCA-LIFT", 0, Reason::NotAttached),
        ("QCA-LIFT", 2, Reason::WrongGripperId),
        ("QCA-UP", 0, Reason::NotAttached),
        ("QCA-SLOW", 0, Reason::NotAttached),
        ("QCA-SLOW", 3, Reason::WrongGripperId),
    ] {
        let mut bench = bare(1);
        bench.spoil(word, Mishap::Mated(id));
        assert_eq!(attach(&mut bench, 1), error(reason), "{word} {id}");
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"), "the robot holds still");
        assert_eq!(bench.log().contains(&"DELTA-MOVE QCA-UP"), word == "QCA-UP");
    }
}

#[test]
fn motions_that_fail_end_the_command() {
    for word in ["QCD-DOWN", "QCD-SEAT", "QCD-UP"] {
        let mut bench = above(2);
        bench.spoil(word, Mishap::Prim(PrimReport::SensorError, Reason::SensorError));
        assert_eq!(detach(&mut bench, 2), error(Reason::SensorError), "{word}");
    }
    for word in ["QCA-FAST", "QCA-SLOW", "QCA-BACK", "QCA-LIFT", "QCA-UP"] {
        let mut bench = bare(2);
        bench.spoil(word, Mishap::Prim(PrimReport::Error, Reason::NotAtGoal));
        assert_eq!(attach(&mut bench, 2), error(Reason::NotAtGoal), "{word}");
    }
    let mut bench = bare(2);
    bench.command(QcAttach, "GRIPPER-2", 2, "HOLSTER-L", 2);
    while !bench.log().contains(&"QC-LOCK") {
        bench.step();
    }
    bench.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost), "Prim holds the robot while the ring turns");
    let mut bench = bare(2);
    bench.spoil("GRASP", Mishap::Jaws(JawsReport::Opened));
    assert_eq!(attach(&mut bench, 2), error(Reason::JawsStuck), "it does not close");
    let mut bench = bare(2);
    bench.command(QcAttach, "GRIPPER-2", 2, "HOLSTER-L", 2);
    while !bench.log().contains(&"DELTA-MOVE QCA-UP") {
        bench.step();
    }
    bench.dead.push("gripper");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost), "its process has died on the way");
}

#[test]
fn the_parts_gripper_is_calibrated_when_it_comes() {
    let mut bench = bare(1);
    bench.grip.initialized = false;
    assert_eq!(attach(&mut bench, 1), DONE);
    assert_eq!(bench.log().last(), Some(&"UP-INIT"), "after the last motion");
    let mut bench = bare(1);
    bench.grip.initialized = false;
    bench.spoil("UP-INIT", Mishap::Grip(Reason::GripNotCalibrated));
    assert_eq!(attach(&mut bench, 1), error(Reason::GripNotCalibrated));
    let mut bench = bare(1);
    bench.grip.initialized = false;
    bench.command(QcAttach, "GRIPPER-1", 2, "HOLSTER-R", 1);
    for _ in 0..200 {
        bench.step();
        bench.memory.grip.status.initialized = false;
    }
    assert_eq!(bench.memory.emove.status.reason, Reason::GripUnattainable, "UP-INIT has no effect");
}

#[test]
fn data_for_the_holsters_must_be_there() {
    let mut bench = Bench::ready("HOLSTER-R", 1);
    assert_eq!(bench.run(QcDetach, GRIPPERS[0].1, 1, GRIPPERS[0].2, 0), error(Reason::NoHolster));
    assert_eq!(bench.run(QcDetach, "GRIPPER-9", 1, "HOLSTER-R", 1), error(Reason::UnknownGrip));
    assert_eq!(bench.run(QcDetach, "GRIPPER-1", 1, "BENCH", 1), error(Reason::NoRelativeMove));
    bench.command(QcDetach, GRIPPERS[0].1, 1, GRIPPERS[0].2, 1);
    bench.memory.subtask.emove.pose = None;
    assert_eq!(bench.finish(), error(Reason::NoDestination));
}
