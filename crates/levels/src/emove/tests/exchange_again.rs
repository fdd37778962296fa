//! QC-ATTACH, QC-DETACH and GRASP-OBJ that are interrupted and sent again (docs/design/recovery.md "Exchange",
//! "Held").

use interfaces::{
    Reason,
    device::JawValves,
    emove::{
        EmoveVerb::{
            AcquireTool, GraspObj, InsertTool, LocateObj, MovObjTo, MovToHol, MovToLoc, MovToObj, MovToVu,
            Pause, Release,
        },
        Holding, Pins,
    },
    jaws::JawsReport,
    prim::JoystickGrip,
    quick_change::QuickChangeReport,
};

use super::{
    bench::{Bench, DONE, INTERRUPTIONS, ORDINARY, attach, detach, error, frame_of, moved, to_holster},
    doubles::DeliveryFault,
};

pub const SCENARIOS: &[fn()] = &[
    exchange_resumes_from_each_position,
    impossible_attach_is_reported,
    order_without_effect_ends_the_exchange,
    ring_that_stays_locked_ends_the_exchange,
    impossible_detach_is_reported,
    exchange_resumes_after_manual_motion_out_and_back,
    release_with_stuck_fingers_keeps_the_object,
    object_regrasped_by_the_operator_is_not_released,
    grasp_after_a_release_clears_the_placed_object,
    unknown_contents_are_treated_as_held,
    bare_robot_leaves_an_empty_holster,
    failed_id_pins_keep_the_estimates,
];

fn bare(gripper: u8) -> Bench {
    above(0, 2, gripper)
}

fn with(gripper: u8) -> Bench {
    above(gripper, 1, gripper)
}

fn above(attached: u8, grip: i32, gripper: u8) -> Bench {
    let mut bench = Bench::real("HOME", attached);
    assert_eq!(bench.perform(to_holster(grip, gripper)), DONE);
    bench.world.prim.by_steps = true;
    bench
}

#[test]
fn interrupted_attach_resumes_from_every_tick() {
    for gripper in 1..=3 {
        let (attach, seat) = (attach(gripper), frame_of(attach(gripper).3));
        bare(gripper).sent_again(
            |bench| bench.send(attach),
            INTERRUPTIONS,
            |bench| {
                assert_eq!(bench.finish(), DONE, "{:?}", bench.world.log);
                assert_eq!((bench.world.mated, bench.world.locked), (gripper, true));
                assert!(bench.off(&moved(seat, &["QCA-UP"])) < 0.31, "clear of the holster");
                assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
            },
        );
    }
}

#[test]
fn interrupted_detach_resumes_from_every_tick() {
    for gripper in 1..=3 {
        let detach = detach(gripper);
        with(gripper).sent_again(
            |bench| bench.send(detach),
            INTERRUPTIONS,
            |bench| {
                assert_eq!(bench.finish(), DONE, "{:?}", bench.world.log);
                assert_eq!((bench.world.mated, bench.world.resident[usize::from(gripper) - 1]), (0, gripper));
                assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
            },
        );
    }
}

/// Positions in an exchange, relative to the pose of the holster.
const ABOVE: &[&str] = &["QCA-SLOW", "QCD-UP"];
const BARE: &[&str] = &["HOL-BARE"];
const FAST: &[&str] = &["QCA-FAST"];
const SEAT: &[&str] = &["QCA-SLOW"];
const LOW: &[&str] = &["QCA-BACK"];
/// Between low point and seat, raised by the distance at which the large sensors see the ears.
const HIGH: &[&str] = &["HOL-HIGH"];
const OVER: &[&str] = &["HOL-OVER"];
const LIFTING: &[&str] = &["WITHDRAW"];
const LIFTED: &[&str] = &["QCA-LIFT"];
const RAISED: &[&str] = &["HOL-ABOVE"];
const CLEAR: &[&str] = &["QCA-UP"];
const AWAY: &[&str] = &["QCA-UP", "300ty", "300ty"];

/// A robot in the holster of gripper 1, with a gripper, a ring and a reading of the holster's sensors.
fn halfway(at: &[&str], mated: u8, locked: bool, holster: u8) -> Bench {
    let mut bench = Bench::ready("HOME", mated);
    bench.world.frame = moved(frame_of("HOLSTER-R"), at);
    bench.world.holsters[0] = holster;
    bench.world.locked = locked;
    bench.world.resident[0] = if mated == 0 { 1 } else { 0 };
    bench.world.grip.opening = 100;
    bench
}

/// Readings of a holster's sensors without a gripper, and with one that is not quite at its seat.
const BLIND: u8 = 0;
const SLIPPED: u8 = 0b0111;

#[test]
fn exchange_resumes_from_each_position() {
    let from = |at: &[&str], mated, locked, bits, command, first: &str| {
        let mut bench = halfway(at, mated, locked, bits);
        // The sensors of the holster read as at this position, or as specified.
        bench.world.prim.by_steps = bits != BLIND && bits != SLIPPED;
        assert_eq!(bench.perform(command), DONE, "{at:?} {:?}", bench.world.log);
        assert_eq!(bench.log().first().copied().unwrap_or_default(), first, "{at:?}");
    };
    from(BARE, 0, false, 0b1111, attach(1), "DELTA-MOVE QCA-FAST");
    from(FAST, 0, false, 0b1111, attach(1), "DELTA-MOVE QCA-SLOW");
    from(SEAT, 1, false, 0b1111, attach(1), "DELTA-MOVE QCA-SLOW");
    from(LOW, 1, false, 0b0011, attach(1), "DELTA-MOVE QCA-SLOW");
    from(SEAT, 1, true, 0b1111, attach(1), "DELTA-MOVE QCA-BACK");
    from(LOW, 1, true, 0b0011, attach(1), "DELTA-MOVE QCA-LIFT");
    from(RAISED, 1, true, 0, attach(1), "DELTA-MOVE QCA-UP");
    from(CLEAR, 1, true, 0, attach(1), "");
    from(RAISED, 1, true, 0, detach(1), "GO-UNTIL QCD-DOWN HOL-NEAR");
    from(LIFTED, 1, true, 0, detach(1), "GO-UNTIL QCD-DOWN HOL-NEAR");
    from(LOW, 1, true, BLIND, detach(1), "GO-UNTIL QCD-DOWN HOL-NEAR");
    from(LOW, 1, true, 0b0011, detach(1), "QC-UNLOCK");
    from(LOW, 1, false, 0b0011, detach(1), "GO-UNTIL QCD-SEAT HOL-SEAT");
    from(HIGH, 1, false, SLIPPED, attach(1), "DELTA-MOVE QCA-SLOW");
    from(HIGH, 1, false, SLIPPED, detach(1), "GO-UNTIL QCD-SEAT HOL-SEAT");
    from(OVER, 1, false, SLIPPED, detach(1), "GO-UNTIL QCD-SEAT HOL-SEAT");
    from(SEAT, 1, true, 0b1111, detach(1), "QC-UNLOCK");
    from(SEAT, 1, false, 0b1111, detach(1), "DELTA-MOVE QCD-UP");
    from(FAST, 0, false, 0b1111, detach(1), "DELTA-MOVE QCD-UP");
    from(FAST, 0, true, 0b1111, detach(1), "QC-UNLOCK");
    from(BARE, 0, false, 0b1111, detach(1), "DELTA-MOVE QCD-UP");
    from(ABOVE, 0, false, 0b1111, detach(1), "");
    // The gripper is at the seat, but the small sensors do not detect it yet.
    from(SEAT, 1, false, SLIPPED, detach(1), "GO-UNTIL QCD-SEAT HOL-SEAT");
    // The gripper lies at its seat, and the robot is above it, where QCD-SEAT has ended.
    let mut bench = halfway(OVER, 1, false, 0b1111);
    assert_eq!(bench.perform(detach(1)), DONE, "{:?}", bench.world.log);
    assert_eq!(bench.log(), ["DELTA-MOVE QCD-UP"]);
    // The gripper needs calibration, but the command has ended.
    let mut bench = halfway(CLEAR, 1, true, 0);
    bench.world.grip.initialized = false;
    assert_eq!(bench.perform(attach(1)), DONE);
    assert_eq!(bench.log(), ["UP-INIT"]);
}

#[test]
fn impossible_attach_is_reported() {
    let fails = |at: &[&str], mated, locked, bits, reason: Reason| {
        let mut bench = halfway(at, mated, locked, bits);
        assert_eq!(bench.perform(attach(1)), error(reason), "{at:?} {:?}", bench.world.log);
        bench.assert_stands();
    };
    fails(AWAY, 1, true, 0b0001, Reason::NotPrepared);
    fails(AWAY, 1, false, 0, Reason::RingNotLocked);
    fails(BARE, 1, true, 0, Reason::NotPrepared);
    fails(LOW, 0, false, 0b1111, Reason::NotAttached);
    fails(RAISED, 0, false, 0b1111, Reason::NotAttached);
    fails(RAISED, 1, false, 0, Reason::RingNotLocked);
    fails(FAST, 1, true, 0b0001, Reason::RingNotLocked);
    // The command is done at once far from its holster.
    let mut bench = halfway(AWAY, 1, true, 0);
    assert_eq!(bench.perform(attach(1)), DONE);
    assert!(bench.log().is_empty());
    // A loose gripper below the seat, with a ring between its ends.
    let mut bench = halfway(LOW, 1, false, 0b0011);
    bench.world.ring.half = true;
    assert_eq!(bench.perform(attach(1)), DONE);
    assert_eq!(bench.log()[..2], ["DELTA-MOVE QCA-SLOW", "QC-LOCK"]);
    // At the seat no gripper mates: the robot moves away and reports it.
    let mut bench = halfway(SEAT, 0, false, 0b1111);
    bench.world.resident[0] = 0;
    assert_eq!(bench.perform(attach(1)), error(Reason::NotAttached));
    assert_eq!(bench.log()[0], "DELTA-MOVE QCA-FAST");
}

/// Id pins without contact read as a bare robot. The ring opens before the robot leaves the seat, because it may hold
/// a gripper that is in its holster.
#[test]
fn locked_ring_at_the_seat_opens_before_the_robot_leaves() {
    let mut bench = halfway(SEAT, 0, true, 0b1111);
    bench.perform(attach(1));
    assert_eq!(bench.log()[0], "QC-UNLOCK", "{:?}", bench.log());
}

#[test]
fn ring_that_stays_locked_ends_the_exchange() {
    for command in [attach(1), detach(1)] {
        let mut bench = halfway(SEAT, 0, true, 0b1111);
        bench.spoil("QC-UNLOCK", DeliveryFault::Ring(QuickChangeReport::Locked));
        assert_eq!(bench.perform(command), error(Reason::QuickChangeFault));
        assert_eq!(bench.motions(), [""; 0], "the robot stays at the seat");
    }
}

#[test]
fn order_without_effect_ends_the_exchange() {
    for (at, mated, locked, bits, word) in [
        (FAST, 0, false, 0b1111, "QCA-SLOW"),
        (LOW, 1, false, 0b0011, "QCA-SLOW"),
        (SEAT, 0, false, 0b1111, "QCA-FAST"),
        (SEAT, 1, true, 0b1111, "QCA-BACK"),
        (LOW, 1, true, 0b0011, "QCA-LIFT"),
        (RAISED, 1, true, 0, "QCA-UP"),
        // Two rows that could alternate.
        (BARE, 0, false, 0b1111, "QCA-"),
        (LIFTING, 1, true, 0b0011, "QCA-"),
    ] {
        let mut bench = halfway(at, mated, locked, bits);
        bench.spoil(word, DeliveryFault::Stays);
        assert_eq!(bench.perform(attach(1)), error(Reason::NoEffect), "{word} {:?}", bench.world.log);
    }
    let mut bench = halfway(LOW, 1, false, 0b0011);
    bench.world.ring.half = true;
    bench.spoil("QCA-SLOW", DeliveryFault::Stays);
    assert_eq!(bench.perform(attach(1)), error(Reason::NoEffect));
}

#[test]
fn impossible_detach_is_reported() {
    let fails = |at: &[&str], mated, locked, bits, reason: Reason| {
        let mut bench = halfway(at, mated, locked, bits);
        assert_eq!(bench.perform(detach(1)), error(reason), "{at:?} {:?}", bench.world.log);
        bench.assert_stands();
    };
    fails(FAST, 1, true, 0b0001, Reason::NotDetached);
    fails(ABOVE, 1, true, 0, Reason::NotDetached);
    fails(LOW, 0, false, 0b1111, Reason::NotDetached);
    fails(RAISED, 1, false, 0, Reason::RingNotLocked);
    fails(LIFTING, 1, false, 0, Reason::RingNotLocked);
    let mut bench = halfway(LOW, 1, true, 0b0011);
    bench.spoil("QC-PAUSE", DeliveryFault::Ring(QuickChangeReport::SensorMalfunction));
    assert_eq!(bench.pause(), error(Reason::QuickChangeFault));
    assert_eq!(bench.perform(detach(1)), error(Reason::QuickChangeFault));
    // The gripper is in its holster, and the bare robot at no known location.
    let mut bench = halfway(AWAY, 0, false, 0b1111);
    assert_eq!(bench.perform(detach(1)), DONE);
    assert!(bench.log().is_empty());
    // An object detected above the holster must not enter it.
    let mut bench = halfway(RAISED, 1, true, 0);
    bench.world.object = Some(bench.world.grip.opening);
    bench.forget_empty();
    assert_eq!(bench.perform(detach(1)), error(Reason::AlreadyHolding));
    let mut bench = halfway(RAISED, 1, true, 0);
    bench.world.grip.initialized = false;
    bench.forget_empty();
    assert_eq!(bench.perform(detach(1)), error(Reason::HeldNotKnown));
    // The gripper is lost on the way down or to its seat, and is not in its place.
    for (word, at, bits) in
        [("QC-UNLOCK", LOW, 0b0011), ("QC-UNLOCK", LOW, 0b1111), ("QC-UNLOCK", CLEAR, 0b1111)]
    {
        let mut bench = halfway(LOW, 1, true, 0b0011);
        bench.begin(detach(1));
        bench.until_logged(word);
        (bench.world.mated, bench.world.holsters[0]) = (0, bits);
        bench.world.frame = moved(frame_of("HOLSTER-R"), at);
        assert_eq!(bench.finish(), error(Reason::NotDetached), "{word} {bits:b}");
    }
}

#[test]
fn robot_in_a_holster_refuses_other_commands() {
    for &line in ORDINARY {
        let mut bench = halfway(LOW, 1, true, 0b0011);
        bench.world.prim.by_steps = true;
        bench.begin(attach(1));
        bench.wait(6);
        assert_eq!(bench.pause(), DONE);
        assert_eq!(bench.perform(line), error(Reason::InHolster), "{}", line.0);
        assert!(bench.log().is_empty());
        bench.assert_stands();
        // Both ways out of the holster are possible.
        let mut other = bench.clone();
        assert_eq!(other.perform(detach(1)), DONE, "{:?}", other.world.log);
        assert_eq!(bench.perform(attach(1)), DONE, "{:?}", bench.world.log);
        assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
    }
    let mut bench = bare(1);
    bench.begin(attach(1));
    bench.wait(4);
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), error(Reason::InHolster));
    // Manual motion out of the holster ends the exchange.
    bench.lead(|bench| bench.world.frame = frame_of("HOME"));
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE);
}

#[test]
fn exchange_resumes_after_manual_motion_out_and_back() {
    let mut bench = bare(1);
    bench.begin(attach(1));
    bench.wait(4);
    assert_eq!(bench.pause(), DONE);
    let stopped = bench.world.frame;
    bench.lead(|bench| {
        bench.world.frame.position.z += 30.0;
        bench.wait(3);
        assert!(bench.memory.emove.estimates.exchange.is_some());
        bench.world.frame = stopped;
    });
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), error(Reason::InHolster));
    assert_eq!(bench.perform(attach(1)), DONE, "{:?}", bench.world.log);
}

#[test]
fn gripper_mated_in_its_holster_holds_nothing() {
    for gripper in 1..=3 {
        let mut bench = bare(gripper);
        bench.begin(attach(gripper));
        while bench.world.mated == 0 {
            bench.step();
        }
        assert_eq!(bench.pause(), DONE);
        assert_eq!(bench.memory.emove.status.end_effector_id, Some(gripper));
        assert_eq!(bench.memory.emove.status.held, Holding::Nothing);
    }
}

#[test]
fn unlocked_gripper_moved_away_keeps_its_exchange_open() {
    let mut bench = halfway(LOW, 1, true, 0b0011);
    bench.begin(detach(1));
    while bench.world.locked {
        bench.step();
    }
    assert_eq!(bench.pause(), DONE);
    let low = bench.world.frame;
    bench.world.frame = moved(frame_of("HOLSTER-R"), AWAY);
    bench.wait(3);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), error(Reason::RingNotLocked));
    assert_eq!(bench.memory.emove.status.exchange, Some(1));
    assert_eq!(bench.perform(detach(1)), error(Reason::NotPrepared));
    bench.world.frame = low;
    assert_eq!(bench.perform(detach(1)), DONE, "{:?}", bench.world.log);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
}

#[test]
fn interrupted_grasp_resumes_from_every_tick() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 204), (3, "CUTTER", 246)] {
        let grasp = (GraspObj, object, 1, "BENCH", gripper);
        for (present, end) in [(true, DONE), (false, error(Reason::GraspMissed))] {
            let mut bench = Bench::real("HOME", gripper);
            assert_eq!(bench.run(MovToObj, object, 1, "BENCH", gripper), DONE);
            bench.world.object = present.then_some(size);
            bench.sent_again(
                |bench| bench.send(grasp),
                INTERRUPTIONS,
                |bench| {
                    assert_eq!(bench.finish(), end, "{object} {:?}", bench.world.log);
                    if present {
                        assert_eq!(bench.run(MovObjTo, object, 1, "VISE", gripper), DONE);
                        assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
                    }
                },
            );
        }
    }
}

#[test]
fn release_with_stuck_fingers_keeps_the_object() {
    let mut bench = Bench::ready("HOME", 2);
    assert_eq!(bench.run(MovToObj, "SHAFT", 1, "BENCH", 2), DONE);
    bench.hold("SHAFT", 204, 2);
    let mut stuck = bench.clone();
    stuck.spoil("RELEASE", DeliveryFault::Jaws(JawsReport::Stuck));
    stuck.command(Release, "SHAFT", 1, "BENCH", 2);
    stuck.wait(2);
    stuck.world.v_grip.opening = 250;
    assert_eq!(stuck.finish(), error(Reason::JawsStuck));
    stuck.world.mishaps.clear();
    assert_eq!(stuck.pause(), DONE);
    assert_eq!(stuck.memory.emove.estimates.placed, None);
    assert!(matches!(stuck.memory.emove.status.held, Holding::Object(_)));
    // The robot does not leave with the object, with or without a restart of E-move.
    for restarted in [false, true] {
        if restarted {
            stuck.restart_and_finish();
        }
        for line in [(MovObjTo, "SHAFT", 1, "VISE", 2), (MovToLoc, "", 0, "HOME", 0)] {
            stuck.world.log.clear();
            assert_eq!(stuck.perform(line), error(Reason::ReleaseNotEnded));
            assert!(!stuck.log().iter().any(|word| word.starts_with("GO")), "{:?}", stuck.log());
        }
    }
    assert_eq!(stuck.run(MovObjTo, "SHAFT", 1, "BENCH", 2), DONE, "the robot is there");
    assert_eq!(stuck.perform((Release, "SHAFT", 1, "BENCH", 2)), DONE);
    assert_eq!(stuck.memory.emove.status.held, Holding::Nothing);
    assert!(stuck.memory.emove.estimates.placed.is_some());
    // A restarted E-move continues the release.
    bench.command(Release, "SHAFT", 1, "BENCH", 2);
    bench.wait(3);
    bench.restart_and_finish();
    bench.wait(10);
    assert_eq!(bench.pause(), DONE);
    assert!(bench.memory.emove.estimates.placed.is_some());
}

/// The operator opens the gripper a little, and closes it again.
#[test]
fn object_regrasped_by_the_operator_is_not_released() {
    let mut bench = Bench::ready("BENCH", 2);
    bench.hold("SHAFT", 204, 2);
    bench.command(Pause, "", 0, "", 0);
    bench.world.joystick = true;
    bench.wait(20);
    bench.spoil("RELEASE", DeliveryFault::Jaws(JawsReport::Stuck));
    for button in [JoystickGrip::Open, JoystickGrip::Close] {
        bench.world.button = button;
        bench.wait(20);
    }
    (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
    bench.wait(20);
    bench.restart_and_finish();
    assert!(matches!(bench.memory.emove.status.held, Holding::Object(_)));
    assert_eq!(bench.perform((MovObjTo, "SHAFT", 1, "VISE", 2)), DONE, "{:?}", bench.log());
}

#[test]
fn partly_released_object_is_grasped_again() {
    for (gripper, object, size, wide, stuck) in [
        (1, "BLOCK", 75, 140, DeliveryFault::Grip(Reason::GripUnattainable)),
        // The fingers still detect it.
        (1, "BLOCK", 75, 75, DeliveryFault::Grip(Reason::GripUnattainable)),
        (2, "SHAFT", 204, 250, DeliveryFault::Jaws(JawsReport::Stuck)),
        (3, "CUTTER", 250, 300, DeliveryFault::Jaws(JawsReport::Stuck)),
    ] {
        let mut bench = Bench::ready("BENCH", gripper);
        bench.hold(object, size, gripper);
        assert_eq!(bench.perform((GraspObj, object, 1, "BENCH", gripper)), DONE);
        assert!(bench.log().is_empty(), "held firmly: {:?}", bench.log());
        bench.spoil("RELEASE", stuck).spoil("OPEN-GRIP", stuck);
        bench.command(Release, object, 1, "BENCH", gripper);
        assert_ne!(bench.finish(), DONE, "{object}");
        bench.world.mishaps.clear();
        (bench.world.grip.opening, bench.world.v_grip.opening, bench.world.tool_grip.opening) =
            (wide, wide, wide);
        bench.wait(10);
        assert!(matches!(bench.memory.emove.status.held, Holding::Object(_)), "RELEASE can be sent again");
        let mut gone = bench.clone();
        gone.world.object = None;
        assert_eq!(gone.perform((GraspObj, object, 1, "BENCH", gripper)), error(Reason::GraspMissed));
        assert_eq!(gone.memory.emove.status.held, Holding::Nothing, "{object}");
        bench.world.object = Some(size);
        for mut fork in bench.during((GraspObj, object, 1, "BENCH", gripper)) {
            fork.stop();
            assert_eq!(fork.held(), object, "the grasped object has its name");
        }
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), DONE);
        assert!(!bench.log().is_empty(), "the fingers are closed");
        assert!(matches!(bench.memory.emove.status.held, Holding::Object(_)), "{object}");
    }
}

#[test]
fn grasp_after_a_release_clears_the_placed_object() {
    let mut bench = Bench::ready("BENCH", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.perform((Release, "BLOCK", 1, "BENCH", 1)), DONE);
    assert!(bench.memory.emove.status.placed.is_some());
    bench.world.object = None;
    assert_eq!(bench.perform((GraspObj, "BLOCK", 1, "BENCH", 1)), error(Reason::GraspMissed));
    assert_eq!(bench.memory.emove.status.placed, None);
}

/// Stuck jaws may still move where their air presses them, and hold nothing without air.
#[test]
fn pressurised_jaws_are_treated_as_moving() {
    for (close, open) in [(false, false), (true, false), (false, true)] {
        let air = JawValves { open, close };
        let mut bench = Bench::ready("HOME", 2);
        bench.memory.v_grip.valves = air;
        assert_eq!(bench.perform((Release, "SHAFT", 1, "BENCH", 2)), DONE);
        assert_eq!(bench.log().contains(&"RELEASE 350"), close, "{:?}", bench.log());
        let mut bench = Bench::ready("HOME", 2);
        bench.memory.v_grip.valves = air;
        assert_eq!(bench.perform((MovToObj, "SHAFT", 1, "BENCH", 2)), DONE);
        assert_eq!(bench.log().contains(&"POSE 350"), close, "{:?}", bench.log());
        let mut bench = Bench::ready("BENCH", 2);
        bench.hold("SHAFT", 204, 2);
        bench.world.log.clear();
        bench.memory.v_grip.valves = air;
        assert_eq!(bench.perform((GraspObj, "SHAFT", 1, "BENCH", 2)), DONE);
        assert_eq!(bench.log().is_empty(), close, "{:?}", bench.log());
    }
}

/// Jaws that do not come to rest in time have no air, wherever they stop later.
#[test]
fn jaws_without_air_have_no_grasp() {
    let mut bench = Bench::ready("BENCH", 2);
    bench.world.object = Some(204);
    bench.spoil("GRASP", DeliveryFault::Jaws(JawsReport::Stuck));
    bench.command(GraspObj, "SHAFT", 1, "BENCH", 2);
    bench.wait(2);
    bench.world.v_grip.opening = 204;
    assert_eq!(bench.finish(), error(Reason::JawsStuck));
    bench.world.mishaps.clear();
    bench.memory.v_grip.valves = JawValves::default();
    bench.wait(10);
    assert_eq!(bench.memory.emove.status.held, Holding::Something);
    bench.world.log.clear();
    assert_eq!(bench.perform((GraspObj, "SHAFT", 1, "BENCH", 2)), DONE);
    assert_eq!(bench.log(), ["GRASP 200"]);
}

#[test]
fn unknown_contents_are_treated_as_held() {
    // An uncalibrated gripper may hold an object.
    let blind = |location: &str| {
        let mut bench = Bench::new(location, 1);
        bench.world.grip.initialized = false;
        bench.forget_empty();
        assert_eq!(bench.memory.emove.status.held, Holding::NotKnown);
        bench
    };
    // An object is detected that has no name.
    let felt = |location: &str| Bench::with_unknown(location, 75);
    for (verb, object, location, something, not_known) in [
        (MovToObj, "BLOCK", "BENCH", Reason::AlreadyHolding, Reason::HeldNotKnown),
        (MovToVu, "BLOCK", "BENCH", Reason::AlreadyHolding, Reason::HeldNotKnown),
        (MovObjTo, "BLOCK", "BENCH", Reason::NothingHeld, Reason::HeldNotKnown),
        (MovToHol, "GRIPPER-1", "HOLSTER-R", Reason::AlreadyHolding, Reason::HeldNotKnown),
        (GraspObj, "BLOCK", "BENCH", Reason::AlreadyHolding, Reason::HeldNotKnown),
        (LocateObj, "BLOCK", "BENCH", Reason::AlreadyHolding, Reason::HeldNotKnown),
    ] {
        let mut bench = felt("HOME");
        assert_eq!(bench.run(verb, object, 1, location, 1), error(something), "{verb}");
        let mut bench = blind("HOME");
        assert_eq!(bench.run(verb, object, 1, location, 1), error(not_known), "{verb}");
    }
    // At the object it is grasped again.
    let mut bench = felt("BENCH");
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.held(), "BLOCK");
    // RELEASE releases any object.
    for mut bench in [felt("HOME"), blind("HOME")] {
        assert_eq!(bench.run(Release, "BLOCK", 1, "HOME", 1), DONE);
        assert_eq!(bench.log(), ["OPEN-GRIP"]);
    }
    // The gripper opens, even if the object is wider than the depart size of the command's object.
    for (size, opened) in [(75, 350), (345, 395), (480, 500)] {
        let mut bench = Bench::with_unknown("HOME", size);
        assert_eq!(bench.run(Release, "BLOCK", 1, "HOME", 1), DONE);
        assert_eq!(bench.memory.emove.grip.position, opened);
    }
    // A gripper that was never calibrated opens fully, and is calibrated on the way to the next object.
    let mut bench = blind("HOME");
    assert_eq!(bench.run(Release, "BLOCK", 1, "HOME", 1), DONE);
    assert_eq!((bench.world.grip.opening, bench.memory.emove.status.held), (500, Holding::Nothing));
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    let log = bench.log();
    let at = |word: &str| log.iter().position(|text| text.starts_with(word));
    assert!(at("GO-THRU") < at("UP-INIT") && at("UP-INIT") < at("POSITION"), "{log:?}");
    assert!(at("POSITION").is_some() && at("POSITION") < at("GOTO-PT"), "{log:?}");
}

#[test]
fn bare_robot_leaves_an_empty_holster() {
    let (full, empty, partial) = (0b1111, 0, 0b0001);
    for (at, bits, attached, detached) in [
        (ABOVE, empty, Reason::HolsterEmpty, DONE),
        (BARE, empty, Reason::HolsterEmpty, DONE),
        (BARE, partial, Reason::HolsterEmpty, DONE),
        (FAST, empty, Reason::HolsterEmpty, DONE),
        (SEAT, empty, Reason::HolsterEmpty, DONE),
        (SEAT, full, Reason::NotAttached, DONE),
        (SEAT, partial, Reason::HolsterEmpty, DONE),
        (AWAY, empty, Reason::NotPrepared, error(Reason::WrongGripper)),
    ] {
        for (command, end) in [(attach(1), error(attached)), (detach(1), detached)] {
            let mut bench = halfway(at, 0, false, bits);
            bench.world.resident[0] = 0;
            assert_eq!(bench.perform(command), end, "{at:?} {bits} {:?}", bench.world.log);
            if at != AWAY {
                assert!(bench.off(&moved(frame_of("HOLSTER-R"), ABOVE)) < 0.31, "clear of the holster");
                assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
            }
        }
        if at == BARE {
            for command in [attach(1), detach(1)] {
                let mut bench = halfway(at, 0, false, bits);
                bench.world.resident[0] = 0;
                bench.spoil("QCD-UP", DeliveryFault::Stays);
                assert_eq!(bench.perform(command), error(Reason::NoEffect));
            }
        }
    }
}

#[test]
fn gripper_torn_off_a_locked_ring_is_attached_again() {
    for gripper in 1..=3 {
        let fetch = to_holster(2, gripper);
        let mut bench = with(gripper);
        bench.world.mated = 0;
        bench.wait(4);
        assert_eq!(bench.perform(fetch), error(Reason::PinsFail));
        assert_eq!(bench.memory.emove.status.pins, Pins::Differ);
        // Its own holster detects the gripper: the robot is bare, although the ring is locked …
        let mut locked = bench.clone();
        locked.world.resident[usize::from(gripper) - 1] = gripper;
        locked.wait(10);
        let status = locked.memory.emove.status;
        assert_eq!((status.end_effector_id, status.pins), (None, Pins::Agree));
        assert_eq!(locked.perform(fetch), DONE);
        assert_eq!(locked.perform(attach(gripper)), DONE);
        assert_eq!((locked.world.mated, locked.world.locked), (gripper, true));
        // … the operator opens the ring and puts the gripper into its holster …
        let mut opened = bench.clone();
        opened.world.real.as_mut().unwrap().open_ring();
        opened.world.resident[usize::from(gripper) - 1] = gripper;
        opened.wait(10);
        assert_eq!(opened.perform(fetch), DONE);
        assert_eq!(opened.perform(attach(gripper)), DONE);
        assert_eq!((opened.world.mated, opened.world.locked), (gripper, true));
        // … or back onto the robot.
        bench.world.mated = gripper;
        bench.wait(10);
        assert_eq!(bench.perform(detach(gripper)), DONE);
        assert_eq!(bench.world.resident[usize::from(gripper) - 1], gripper);
    }
}

#[test]
fn failed_id_pins_keep_the_estimates() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 200), (3, "CUTTER", 250)] {
        let mut bench = Bench::ready("HOME", gripper);
        bench.hold(object, size, gripper);
        let held = bench.memory.emove.status.held;
        bench.world.mated = 0;
        bench.wait(4);
        assert_eq!(bench.memory.emove.status.held, Holding::NotKnown);
        assert_eq!(bench.memory.emove.status.end_effector_id, Some(gripper));
        for (verb, location) in [
            (MovToObj, "BENCH"),
            (MovToHol, "HOLSTER-R"),
            (LocateObj, "BENCH"),
            (InsertTool, "TOOL-TRNS"),
            (AcquireTool, "TOOL-TRNS"),
            (MovToLoc, "VISE"),
        ] {
            assert_eq!(bench.run(verb, object, 1, location, gripper), error(Reason::PinsFail), "{verb}");
        }
        assert_eq!(bench.pause(), DONE);
        let mut other = bench.clone();
        bench.world.mated = gripper;
        bench.wait(10);
        assert_eq!(bench.memory.emove.status.held, held);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE);
        assert_eq!(bench.memory.emove.status.held, held);
        // A ring that was open is different: the detected object has no name.
        other.world.locked = false;
        other.wait(4);
        (other.world.locked, other.world.mated) = (true, gripper);
        other.wait(10);
        assert_eq!(other.memory.emove.status.held, Holding::Something);
    }
}
