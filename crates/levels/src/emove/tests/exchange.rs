use interfaces::{
    Reason,
    emove::EmoveVerb::{MovToLoc, MovToObj, Pause, QcDetach, Release},
    jaws::JawsReport,
    prim::PrimReport,
    quick_change::QuickChangeReport,
};

use super::{
    bench::{Bench, DONE, attach, detach, error, frame_of, moved, to_holster},
    doubles::DeliveryFault,
};

pub const SCENARIOS: &[fn()] = &[
    detach_without_its_preconditions_is_refused,
    gripper_is_not_brought_to_an_occupied_holster,
    attach_without_its_preconditions_is_refused,
    repeated_exchange_is_done_at_once,
    exchange_fails_a_second_after_a_guarded_move_detects_nothing,
    quick_change_failure_is_reported,
    gripper_still_attached_after_detach_is_reported,
    missing_gripper_after_attach_is_reported,
    motion_failure_ends_the_exchange,
    uncalibrated_parts_gripper_is_calibrated_after_attaching,
    exchange_without_holster_data_is_refused,
];

/// A robot above the holster of its gripper, with the fingers closed for it.
fn above(gripper: u8) -> Bench {
    let mut bench = Bench::ready("HOME", gripper);
    assert_eq!(bench.perform(to_holster(1, gripper)), DONE);
    bench
}

fn bare(gripper: u8) -> Bench {
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(bench.perform(to_holster(2, gripper)), DONE);
    bench
}

#[test]
fn gripper_exchange_follows_the_order_of_the_manual() {
    for from in 1..=3 {
        for to in (1..=3).filter(|to| *to != from) {
            let (old_holster, new_holster) = (detach(from).3, attach(to).3);
            let mut bench = above(from);
            assert!(bench.off(&moved(frame_of(old_holster), &["HOL-ABOVE"])) < 0.02);
            assert_eq!(bench.perform(detach(from)), DONE);
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
            assert!(bench.off(&end) < 0.05, "each move starts at the end of the one before");
            assert_eq!((bench.world.mated, bench.world.locked), (0, false));
            assert_eq!(bench.at(), old_holster);
            assert_eq!(bench.perform(to_holster(2, to)), DONE);
            assert_eq!(bench.log(), ["GO-THRU", "GOTO-PT"], "a bare robot commands no gripper");
            assert_eq!(bench.perform(attach(to)), DONE);
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
                "all moves start at the holster's pose"
            );
            assert_eq!((bench.world.mated, bench.world.locked), (to, true));
            assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
        }
    }
}

#[test]
fn gripper_closes_on_the_way_to_its_holster() {
    let bench = above(1);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert_eq!(bench.memory.emove.grip.position, 100);
    let mut bench = above(2);
    assert_eq!(bench.log(), ["GRASP 50", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert_eq!(bench.perform(to_holster(1, 2)), DONE, "the robot is at the holster");
    assert!(bench.log().is_empty());
    // The robot leaves a part, with depart points first.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "HOLSTER-C", 1), DONE);
    assert_eq!(bench.run(Release, "BLOCK", 1, "HOLSTER-C", 1), DONE);
    assert_eq!(bench.perform(to_holster(1, 1)), DONE);
    assert_eq!(bench.log()[..3], ["GO-THRU A/D-5", "POSITION", "GO-THRU"]);
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("POSITION", DeliveryFault::Grip(Reason::GripTimeout));
    assert_eq!(bench.perform(to_holster(1, 1)), error(Reason::GripTimeout));
    let mut bench = Bench::ready("HOME", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.perform(to_holster(1, 1)), error(Reason::AlreadyHolding));
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("POSITION", DeliveryFault::Never);
    bench.begin(to_holster(1, 1));
    bench.wait(100);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU A/D-5"], "the final motion waits");
}

/// No depart path is written for a gripper: the exchange moves the robot up. For another goal it first leaves along its
/// approach, not straight to the first point of the trajectory.
#[test]
fn robot_above_a_holster_leaves_upward() {
    let mut bench = above(1);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
    assert_eq!(bench.log()[0], "GO-THRU A/D-5");
}

#[test]
fn detach_without_its_preconditions_is_refused() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform(detach(1)), error(Reason::NotPrepared), "the robot is elsewhere");
    assert_eq!(bench.perform(detach(2)), error(Reason::WrongGripper));
    for bits in [0, 0b0001, 0b0011] {
        let mut bench = Bench::ready("HOLSTER-R", 0);
        bench.world.holsters[0] = bits;
        assert_eq!(
            bench.perform(detach(1)),
            error(Reason::WrongGripper),
            "the gripper is neither attached nor in its holster"
        );
    }
    let mut bench = above(1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.perform(detach(1)), error(Reason::AlreadyHolding));
    for bits in [0b0001, 0b1111] {
        let mut bench = above(1);
        bench.world.holsters[0] = bits;
        assert_eq!(bench.perform(detach(1)), error(Reason::HolsterOccupied));
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"));
    }
}

/// The holster is occupied from the start, or during the motion.
#[test]
fn gripper_is_not_brought_to_an_occupied_holster() {
    for (bits, ticks) in [(0b0001, 0), (0b1111, 0), (0b1111, 10)] {
        let mut bench = Bench::ready("HOME", 1);
        bench.begin(to_holster(1, 1));
        bench.wait(ticks);
        bench.world.holsters[0] = bits;
        assert_eq!(bench.finish(), error(Reason::HolsterOccupied), "{bits:04b} after {ticks} ticks");
        assert_eq!(bench.motions().is_empty(), ticks == 0, "{bits:04b} after {ticks} ticks");
    }
    let mut bare = Bench::ready("HOME", 0);
    assert_eq!(bare.perform(to_holster(1, 1)), DONE, "a bare robot fetches the gripper");
}

#[test]
fn attach_without_its_preconditions_is_refused() {
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(bench.perform(attach(1)), error(Reason::NotPrepared), "the robot is elsewhere");
    for bits in [0, 0b0011, 0b0111] {
        let mut bench = bare(1);
        bench.world.holsters[0] = bits;
        assert_eq!(bench.perform(attach(1)), error(Reason::HolsterEmpty));
    }
    let mut bench = Bench::ready("HOLSTER-L", 1);
    assert_eq!(bench.perform(attach(2)), error(Reason::WrongGripper), "another gripper is attached");
    let mut bench = Bench::ready("HOLSTER-R", 1);
    bench.world.holsters[0] = 0b0011;
    assert_eq!(bench.perform(attach(1)), DONE, "the gripper is attached and still in its holster");
    assert_eq!(bench.log(), ["DELTA-MOVE QCA-LIFT", "DELTA-MOVE QCA-UP"]);
    // A bare robot with a locked ring first unlocks it.
    let mut bench = bare(2);
    bench.world.locked = true;
    assert_eq!(bench.perform(attach(2)), DONE);
    assert_eq!(bench.log()[..2], ["QC-UNLOCK", "DELTA-MOVE QCA-FAST"]);
}

#[test]
fn repeated_exchange_is_done_at_once() {
    let mut bench = above(3);
    assert_eq!(bench.perform(attach(3)), DONE, "the gripper is attached, locked and clear");
    assert!(bench.log().is_empty());
    assert_eq!(bench.perform(detach(3)), DONE);
    assert_eq!(bench.perform(detach(3)), DONE);
    assert!(bench.log().is_empty());
}

#[test]
fn exchange_fails_a_second_after_a_guarded_move_detects_nothing() {
    for word in ["QCD-DOWN", "QCD-SEAT"] {
        let mut bench = above(1);
        bench.spoil(word, DeliveryFault::Prim(PrimReport::NotDetected, Reason::NotDetected));
        bench.begin(detach(1));
        while bench.memory.prim.status.report != PrimReport::NotDetected {
            bench.step();
        }
        let since = bench.tick;
        assert_eq!(bench.finish(), error(Reason::NotDetected), "{word}");
        let waited = bench.tick.since(since);
        assert!((25..=28).contains(&waited), "{waited} ticks instead of a second");
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"));
    }
}

#[test]
fn quick_change_failure_is_reported() {
    for (report, reason) in [
        (QuickChangeReport::Stuck, Reason::QuickChangeStuck),
        (QuickChangeReport::SensorMalfunction, Reason::QuickChangeFault),
    ] {
        let mut bench = above(1);
        bench.spoil("QC-UNLOCK", DeliveryFault::Ring(report));
        assert_eq!(bench.perform(detach(1)), error(reason));
        let mut bench = bare(1);
        bench.spoil("QC-LOCK", DeliveryFault::Ring(report));
        assert_eq!(bench.perform(attach(1)), error(reason));
        let mut bench = bare(1);
        bench.world.locked = true;
        bench.spoil("QC-UNLOCK", DeliveryFault::Ring(report));
        assert_eq!(bench.perform(attach(1)), error(reason));
    }
    for (word, locked, report) in
        [("QC-UNLOCK", true, QuickChangeReport::Locked), ("QC-LOCK", false, QuickChangeReport::Unlocked)]
    {
        let mut bench = bare(1);
        bench.world.locked = locked;
        bench.spoil(word, DeliveryFault::Ring(report));
        assert_eq!(bench.perform(attach(1)), error(Reason::QuickChangeFault), "{word} has no effect");
    }
    let mut bench = above(1);
    bench.spoil("QC-UNLOCK", DeliveryFault::Ring(QuickChangeReport::Locked));
    assert_eq!(
        bench.perform(detach(1)),
        error(Reason::QuickChangeFault),
        "Quick Change reports done, but the ring is locked"
    );
    let mut bench = bare(1);
    bench.world.dead.push("Quick Change");
    assert_eq!(bench.perform(attach(1)), error(Reason::NeighbourLost));
    // A gripper is attached, clear of its holster, and not locked.
    let mut bench = above(1);
    bench.world.locked = false;
    assert_eq!(bench.perform(attach(1)), error(Reason::RingNotLocked));
    // The command arrives before the ring has answered.
    let mut bench = bare(1);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(2);
    assert_eq!(bench.perform(attach(1)), DONE);
    // The ring opens by itself while the gripper is carried.
    let mut bench = bare(1);
    bench.begin(attach(1));
    bench.until_logged("DELTA-MOVE QCA-LIFT");
    bench.world.locked = false;
    assert_eq!(bench.finish(), error(Reason::RingNotLocked));
}

#[test]
fn gripper_still_attached_after_detach_is_reported() {
    let mut bench = above(1);
    bench.spoil("QCD-UP", DeliveryFault::AttachedGripper(1));
    assert_eq!(bench.perform(detach(1)), error(Reason::NotDetached));
    let mut bench = above(1);
    bench.spoil("QCD-UP", DeliveryFault::Holster(0b0011));
    assert_eq!(
        bench.perform(detach(1)),
        error(Reason::NotDetached),
        "the gripper is detached, but not at its seat"
    );
    let mut bench = above(1);
    bench.begin(detach(1));
    bench.until_logged("DELTA-MOVE QCD-UP");
    bench.world.mated = 0;
    bench.world.resident[0] = 1;
    bench.world.locked = true;
    assert_eq!(bench.finish(), error(Reason::QuickChangeFault), "the ring has turned back");
}

#[test]
fn missing_gripper_after_attach_is_reported() {
    for (word, id, reason) in [
        ("QCA-LIFT", 0, Reason::NotAttached),
        ("QCA-LIFT", 2, Reason::WrongGripperId),
        ("QCA-UP", 0, Reason::NotAttached),
        ("QCA-SLOW", 0, Reason::NotAttached),
        ("QCA-SLOW", 3, Reason::WrongGripperId),
    ] {
        let mut bench = bare(1);
        bench.spoil(word, DeliveryFault::AttachedGripper(id));
        assert_eq!(bench.perform(attach(1)), error(reason), "{word} {id}");
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"), "the robot stops");
        assert_eq!(bench.log().contains(&"DELTA-MOVE QCA-UP"), word == "QCA-UP");
    }
}

#[test]
fn motion_failure_ends_the_exchange() {
    for word in ["QCD-DOWN", "QCD-SEAT", "QCD-UP"] {
        let mut bench = above(2);
        bench.spoil(word, DeliveryFault::Prim(PrimReport::SensorError, Reason::SensorError));
        assert_eq!(bench.perform(detach(2)), error(Reason::SensorError), "{word}");
    }
    for word in ["QCA-FAST", "QCA-SLOW", "QCA-BACK", "QCA-LIFT", "QCA-UP"] {
        let mut bench = bare(2);
        bench.spoil(word, DeliveryFault::Prim(PrimReport::Error, Reason::NotAtGoal));
        assert_eq!(bench.perform(attach(2)), error(Reason::NotAtGoal), "{word}");
    }
    let mut bench = bare(2);
    bench.begin(attach(2));
    bench.until_logged("QC-LOCK");
    bench.world.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost), "Prim holds the robot while the ring turns");
    let mut bench = bare(2);
    bench.spoil("GRASP", DeliveryFault::Jaws(JawsReport::Opened));
    assert_eq!(bench.perform(attach(2)), error(Reason::JawsStuck), "the gripper does not close");
    let mut bench = bare(2);
    bench.begin(attach(2));
    bench.until_logged("DELTA-MOVE QCA-UP");
    bench.world.dead.push("gripper");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost), "the gripper process stopped during the motion");
}

#[test]
fn uncalibrated_parts_gripper_is_calibrated_after_attaching() {
    let mut bench = bare(1);
    bench.world.grip.initialized = false;
    assert_eq!(bench.perform(attach(1)), DONE);
    assert_eq!(bench.log().last(), Some(&"UP-INIT"), "after the last motion");
    let mut bench = bare(1);
    bench.world.grip.initialized = false;
    bench.spoil("UP-INIT", DeliveryFault::Grip(Reason::GripNotCalibrated));
    assert_eq!(bench.perform(attach(1)), error(Reason::GripNotCalibrated));
    let mut bench = bare(1);
    bench.world.grip.initialized = false;
    bench.begin(attach(1));
    for _ in 0..200 {
        bench.step();
        bench.memory.grip.status.initialized = false;
    }
    assert_eq!(bench.memory.emove.status.reason, Reason::GripUnattainable, "UP-INIT has no effect");
}

#[test]
fn exchange_without_holster_data_is_refused() {
    let mut bench = Bench::ready("HOLSTER-R", 1);
    assert_eq!(bench.run(QcDetach, "GRIPPER-1", 1, "HOLSTER-R", 0), error(Reason::NoHolster));
    assert_eq!(bench.run(QcDetach, "GRIPPER-9", 1, "HOLSTER-R", 1), error(Reason::UnknownGrip));
    assert_eq!(bench.run(QcDetach, "GRIPPER-1", 1, "BENCH", 1), error(Reason::NoRelativeMove));
    bench.begin(detach(1));
    bench.memory.subtask.emove.pose = None;
    assert_eq!(bench.finish(), error(Reason::NoDestination));
}
