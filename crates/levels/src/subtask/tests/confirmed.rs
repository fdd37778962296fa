//! Commands whose last order E-move or the pedestal reports done, while their sensors contradict the goal.

use interfaces::{
    Reason, StatusReport, Unconfirmed,
    emove::{EmoveVerb, Holding, ObjectGrip, Offset, Pins, Seat},
    subtask::SubtaskVerb,
};
use rcs_core::name::Name16;

use super::bench::{Bench, DONE};

/// The end of a command whose status is changed after E-move reports done for its last order.
fn end(
    mut bench: Bench<'static>,
    (verb, object, grips, location): (SubtaskVerb, &str, (i32, i32), &str),
    last: EmoveVerb,
    change: impl Fn(&mut Bench<'static>),
) -> (StatusReport, Reason) {
    bench.command(verb, object, grips, location);
    for _ in 0..300 {
        let status = bench.step().status;
        if status.report != StatusReport::Executing {
            return (status.report, status.reason);
        }
        let ended = bench.world.emove.outputs.status.report == StatusReport::Done;
        if ended && bench.memory.subtask.emove.command == last {
            change(&mut bench);
            bench.memory.emove = bench.world.emove.outputs;
            bench.memory.pedestal = bench.world.pedestal.outputs;
        }
    }
    panic!("no end: {:?}", bench.process);
}

fn holds(bench: &mut Bench<'static>, object: &str, grip: i32) {
    let held = ObjectGrip { object: Name16::clipped(object), grip };
    bench.world.emove.outputs.status.held = Holding::Object(held);
}

#[test]
fn goto_is_not_done_away_from_its_location() {
    let goto = (SubtaskVerb::GotoDest, "", (0, 0), "HOME");
    let error = (StatusReport::Error, Reason::NotAtGoal);
    let away = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.at = None;
    assert_eq!(end(Bench::default(), goto, EmoveVerb::MovToLoc, away), error);
    let beside = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.offset = Offset::Off;
    assert_eq!(end(Bench::default(), goto, EmoveVerb::MovToLoc, beside), error);
    let slight = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.offset = Offset::Slight;
    assert_eq!(end(Bench::default(), goto, EmoveVerb::MovToLoc, slight), DONE);
}

#[test]
fn goto_without_resolvers_is_done_and_unconfirmed() {
    let mut bench = Bench::default();
    bench.world.emove.outputs.status.offset = Offset::NotSensed;
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "HOME"), DONE);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::Position);
    bench.world.emove.outputs.status.offset = Offset::None;
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "HOME"), DONE);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::None);
}

#[test]
fn object_is_not_placed_while_something_is_between_the_fingers() {
    let place = (SubtaskVerb::PlaceObj, "PART", (1, 1), "PFIXTURE");
    for (held, reason) in [
        (Holding::Something, Reason::UnknownHeld),
        (Holding::NotKnown, Reason::HeldNotKnown),
        (Holding::Object(ObjectGrip::default()), Reason::ReleaseNotEnded),
    ] {
        let change = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.held = held;
        let ended = end(Bench::grasped("PART", 1), place, EmoveVerb::Release, change);
        assert_eq!(ended, (StatusReport::Error, reason), "{held:?}");
    }
    let change = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.placed = None;
    let ended = end(Bench::grasped("PART", 1), place, EmoveVerb::Release, change);
    assert_eq!(ended, (StatusReport::Error, Reason::ObjectLost), "released nowhere");
}

#[test]
fn release_is_not_done_while_the_object_is_held() {
    let release = (SubtaskVerb::Release, "PART", (1, 1), "");
    let change = |bench: &mut Bench<'static>| holds(bench, "PART", 1);
    let ended = end(Bench::grasped("PART", 1), release, EmoveVerb::Release, change);
    assert_eq!(ended, (StatusReport::Error, Reason::ReleaseNotEnded));
}

#[test]
fn object_away_from_its_destination_is_not_brought() {
    let bring = (SubtaskVerb::MoveObjToDest, "PART", (1, 1), "SAFE");
    let change = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.offset = Offset::Off;
    let ended = end(Bench::grasped("PART", 1), bring, EmoveVerb::MovObjTo, change);
    assert_eq!(ended, (StatusReport::Error, Reason::NotAtGoal));
    assert_eq!(end(Bench::grasped("PART", 1), bring, EmoveVerb::MovObjTo, |_| {}), DONE);
}

#[test]
fn tool_outside_the_drum_is_not_inserted() {
    let insert = (SubtaskVerb::InsertTool, "TOOL-1", (1, 1), "");
    let change = |bench: &mut Bench<'static>| bench.world.emove.outputs.status.drum = false;
    let ended = end(Bench::grasped("TOOL-1", 1), insert, EmoveVerb::InsertTool, change);
    assert_eq!(ended, (StatusReport::Error, Reason::NotPrepared));
    let mut bench = Bench::grasped("TOOL-1", 1);
    assert_eq!(bench.run(SubtaskVerb::InsertTool, "TOOL-1", (1, 1), ""), DONE);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::ToolInDrum);
    assert_eq!(bench.run(SubtaskVerb::RemoveTool, "TOOL-1", (1, 1), ""), DONE);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::GraspForce);
}

#[test]
fn part_that_may_have_slid_is_done_and_unconfirmed() {
    let mut bench = Bench::grasped("PART", 1);
    bench.world.emove.outputs.status.seat = Seat::NotKnown;
    bench.step();
    for (verb, location) in [
        (SubtaskVerb::GetObject, "PFIXTURE"),
        (SubtaskVerb::MoveObjToDest, "SAFE"),
        (SubtaskVerb::PlaceObj, "SAFE"),
    ] {
        assert_eq!(bench.run(verb, "PART", (1, 1), location), DONE, "{verb}");
        assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::PartInFingers, "{verb}");
    }
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "HOME"), DONE);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::None);
}

/// An arm without pressure has torn the gripper off the locked ring, and the id pins no longer identify it.
#[test]
fn gripper_with_differing_id_pins_is_not_attached() {
    let mut bench = Bench::default();
    bench.world.emove.outputs.status.end_effector_id = Some(1);
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "PART", (1, 1), "PFIXTURE"), DONE);
    bench.world.emove.outputs.status.pins = Pins::Differ;
    bench.step();
    let error = (StatusReport::Error, Reason::PinsFail);
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "PART", (1, 1), "PFIXTURE"), error);
}
