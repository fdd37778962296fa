//! Commands whose last order Subtask reports done, while its status contradicts the goal.

use interfaces::{
    Reason, StatusReport, Unconfirmed,
    emove::{Holding, ObjectGrip, Offset, Seat},
    hws::HwsReport,
    subtask::{SubtaskStatus, SubtaskVerb},
};

use super::{
    bench::{Bench, FINISHED},
    error,
};

pub(super) const SCENARIOS: &[fn()] = &[
    transfer_is_not_finished_before_its_object_is_placed,
    position_is_not_finished_while_the_object_is_held,
    missing_object_is_not_acquired,
];

/// The end of a command whose status is changed after Subtask reports done for its last order.
fn end(
    (line, gripper, object, at): (&str, u8, &str, &str),
    last: SubtaskVerb,
    change: impl Fn(&mut SubtaskStatus),
) -> (HwsReport, Reason) {
    let mut bench = Bench::default();
    bench.set(gripper, object, at);
    bench.command(line);
    for _ in 0..300 {
        let status = bench.step().status;
        if status.report != HwsReport::Executing {
            return (status.report, status.reason);
        }
        let ended = bench.world.subtask.outputs.status.report == StatusReport::Done;
        if ended && bench.memory.task.subtask.command == last {
            change(&mut bench.world.subtask.outputs.status);
            bench.memory.subtask = bench.world.subtask.outputs;
        }
    }
    panic!("no end: {:?}", bench.process);
}

#[test]
fn move_is_not_finished_away_from_its_destination() {
    let home = ("MOVE -- 0 -- 0 0 SAFE 0 -- 0", 1, "", "PFIXTURE");
    assert_eq!(end(home, SubtaskVerb::GotoDest, |_| {}), FINISHED);
    assert_eq!(end(home, SubtaskVerb::GotoDest, |status| status.at = None), error(Reason::NotAtGoal));
    let beside = |status: &mut SubtaskStatus| status.offset = Offset::Off;
    assert_eq!(end(home, SubtaskVerb::GotoDest, beside), error(Reason::NotAtGoal));
}

#[test]
fn transfer_is_not_finished_before_its_object_is_placed() {
    let transfer = ("TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 SAFE 0", 1, "", "PFIXTURE");
    assert_eq!(end(transfer, SubtaskVerb::GotoEndpt, |_| {}), FINISHED);
    let held = |status: &mut SubtaskStatus| status.held = Holding::Something;
    assert_eq!(end(transfer, SubtaskVerb::GotoEndpt, held), error(Reason::UnknownHeld));
    let lost = |status: &mut SubtaskStatus| status.placed = None;
    assert_eq!(end(transfer, SubtaskVerb::GotoEndpt, lost), error(Reason::ObjectLost));
    let beside = |status: &mut SubtaskStatus| status.offset = Offset::Off;
    assert_eq!(end(transfer, SubtaskVerb::GotoEndpt, beside), error(Reason::NotAtGoal));
}

#[test]
fn position_is_not_finished_while_the_object_is_held() {
    let position = ("POSITION -- 0 -- 0 0 SAFE 0 -- 0", 1, "", "PFIXTURE");
    let held = |status: &mut SubtaskStatus| status.held = Holding::Object(ObjectGrip::default());
    assert_eq!(end(position, SubtaskVerb::Position, |_| {}), FINISHED);
    assert_eq!(end(position, SubtaskVerb::Position, held), error(Reason::ReleaseNotEnded));
}

#[test]
fn missing_object_is_not_acquired() {
    let acquire = ("ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0", 1, "", "PFIXTURE");
    let gone = |status: &mut SubtaskStatus| status.held = Holding::Nothing;
    assert_eq!(end(acquire, SubtaskVerb::GetObject, |_| {}), FINISHED);
    assert_eq!(end(acquire, SubtaskVerb::GetObject, gone), error(Reason::ObjectLost));
    let unknown = |status: &mut SubtaskStatus| status.held = Holding::NotKnown;
    assert_eq!(end(acquire, SubtaskVerb::GetObject, unknown), error(Reason::HeldNotKnown));
}

#[test]
fn offset_robot_is_not_at_its_end_at_location() {
    let remove = "REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 TOOL-SAFE 0";
    let mut bench = Bench::default();
    bench.set(3, "TOOL-1", "TOOL-SAFE");
    assert_eq!(bench.run(remove), FINISHED, "the tool is there already");
    bench.world.subtask.outputs.status.offset = Offset::Slight;
    bench.step();
    assert_eq!(bench.run(remove).0, HwsReport::Error, "a place off its location is not the end");
}

#[test]
fn tool_in_the_drum_is_finished_and_unconfirmed() {
    let mut bench = Bench::default();
    bench.set(3, "TOOL-1", "TOOL-SAFE");
    assert_eq!(bench.run("INSERT-TOOL TOOL-1 +1 TOOL-SAFE 0 0 -- 0 -- 0"), FINISHED);
    assert_eq!(bench.memory.task.status.unconfirmed, Unconfirmed::ToolInDrum);
    assert_eq!(bench.run("RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 TOOL-SAFE 0"), FINISHED);
    assert_eq!(bench.memory.task.status.unconfirmed, Unconfirmed::ToolInDrum);
    assert_eq!(bench.run("MOVE -- 0 -- 0 0 SAFE 0 -- 0"), FINISHED);
    assert_eq!(bench.memory.task.status.unconfirmed, Unconfirmed::None);
}

#[test]
fn part_that_may_have_slid_is_finished_and_unconfirmed() {
    let mut bench = Bench::default();
    bench.set(1, "PART", "PFIXTURE");
    bench.world.subtask.outputs.status.seat = Seat::NotKnown;
    bench.step();
    assert_eq!(bench.run("MOVE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0"), FINISHED);
    assert_eq!(bench.memory.task.status.unconfirmed, Unconfirmed::PartInFingers);
    assert_eq!(bench.run("MOVE -- 0 -- 0 0 HOME 0 -- 0"), FINISHED);
    assert_eq!(bench.memory.task.status.unconfirmed, Unconfirmed::None);
}
