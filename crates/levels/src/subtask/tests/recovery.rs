//! Subtask after an interruption: it stops its orders and continues with the same command (docs/design/recovery.md).

use geometry::pose::Pose;
use interfaces::{
    ChangingPose, Reason, StatusReport, Unconfirmed,
    emove::{EmoveVerb, Holding, LocatedObject, ObjectGrip, PlacedObject, Seat, Standing},
    grip::Felt,
    location::Site,
    operator::HandOrder,
    pedestal::{PedestalReport, PedestalVerb},
    subtask::{Regrip, SubtaskVerb},
};
use rcs_core::name::{Name10, Name16};

use super::{
    bench::{Bench, DONE, DeliveryFault},
    error,
};

pub(super) const SCENARIOS: &[fn()] = &[
    lost_task_stops_robot_and_pedestal,
    part_in_the_pedestal_blocks_other_commands,
    regrip_ends_from_every_state,
    interrupted_exchange_is_finished_first,
    unknown_object_is_neither_taken_nor_placed,
    placed_object_is_not_placed_again,
    object_that_may_have_slid_is_released_and_located_again,
    lost_pictures_are_taken_again_before_the_grasp,
    open_fingers_move_out_of_the_drum,
    pause_waits_for_robot_and_pedestal,
    manual_orders_grip_turn_and_release_a_part,
    manual_orders_are_refused_while_subtask_or_robot_use_the_pedestal,
    manual_release_is_accepted_while_the_robot_holds_the_part,
];

fn fix(bench: &mut Bench<'_>) -> (StatusReport, Reason) {
    bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), "")
}

fn is_under_way(bench: &Bench<'_>) -> bool {
    let (subtask, emove, pedestal) =
        (&bench.memory.subtask, &bench.memory.emove.status, &bench.memory.pedestal.status);
    let robot = emove.report == StatusReport::Executing || emove.echo != subtask.emove.number;
    let part = pedestal.report == PedestalReport::Executing || pedestal.echo != subtask.pedestal.number;
    (robot && subtask.emove.command != EmoveVerb::Pause)
        || (part && subtask.pedestal.command != PedestalVerb::Pause)
}

#[test]
fn new_command_stops_the_running_one_before_it_is_answered() {
    for (verb, object, location) in [
        (SubtaskVerb::Pause, "", ""),
        (SubtaskVerb::None, "", ""),
        (SubtaskVerb::FixGrip, "BAR", ""),
        (SubtaskVerb::GotoDest, "", "SAFE"),
        (SubtaskVerb::Release, "PART", ""),
    ] {
        for mut bench in Bench::fixing().at_every_tick() {
            let tick = bench.tick;
            bench.command(verb, object, (1, 2), location);
            let (end, under_way) = (bench.finish(), is_under_way(&bench));
            assert!(!under_way, "{verb} at tick {tick} ends with {end:?} during a motion");
            assert_eq!(bench.memory.emove.status.echo, bench.memory.subtask.emove.number);
            assert_eq!(bench.memory.pedestal.status.echo, bench.memory.subtask.pedestal.number);
        }
    }
}

/// The joystick box takes the robot during a stop. The next command must not wait for that stop.
#[test]
fn stop_ended_by_the_joystick_does_not_delay_the_next_command() {
    let mut bench = Bench::grasped("PART", 1);
    bench.command(SubtaskVerb::GotoDest, "", (0, 0), "SAFE");
    bench.wait(3);
    bench.world.emove.mishap = Some((EmoveVerb::Pause, DeliveryFault::Special(Reason::JoystickOn)));
    bench.command(SubtaskVerb::GotoDest, "", (0, 0), "HOME");
    bench.until(|bench| bench.world.emove.outputs.status.report == StatusReport::JoystickOn);
    bench.world.emove.mishap = None;
    bench.until(|bench| bench.sent().last() == Some(&EmoveVerb::MovToLoc.text()));
    bench.command(SubtaskVerb::Pause, "", (0, 0), "");
    bench.step();
    assert_eq!(bench.memory.subtask.emove.command, EmoveVerb::Pause);
    assert_eq!(bench.finish(), DONE);
}

#[test]
fn restarted_subtask_stops_its_orders() {
    for mut bench in Bench::fixing().at_every_tick() {
        let tick = bench.tick;
        bench.restart();
        bench.finish();
        bench.wait(10);
        assert!(!is_under_way(&bench), "tick {tick}");
        assert_eq!(bench.memory.subtask.status.reason, Reason::Restarted);
    }
}

/// A lost Task stops everything that it has commanded. When it is back, it repeats the command.
#[test]
fn lost_task_stops_robot_and_pedestal() {
    for mut bench in Bench::fixing().at_every_tick() {
        let tick = bench.tick;
        bench.world.task_is_lost = true;
        bench.wait(20);
        assert!(!is_under_way(&bench), "tick {tick}");
        let status = bench.memory.subtask.status;
        let ends = [(StatusReport::Error, Reason::NeighbourLost), DONE];
        assert!(ends.contains(&(status.report, status.reason)), "tick {tick}: {status:?}");
        bench.world.task_is_lost = false;
        bench.step();
        assert_eq!(fix(&mut bench), DONE, "tick {tick}");
    }
}

#[test]
fn interrupted_regrip_resumes() {
    let restarts = |bench: &mut Bench<'static>| {
        bench.restart();
        bench.finish();
        bench.wait(10);
    };
    let pauses = |bench: &mut Bench<'static>| {
        assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    };
    let send = |bench: &mut Bench<'static>| bench.command(SubtaskVerb::FixGrip, "PART", (1, -1), "");
    Bench::grasped("PART", 1).sent_again(send, &[pauses, restarts], |bench| {
        assert_eq!(bench.finish(), DONE, "at tick {}", bench.tick);
        assert_eq!(bench.memory.pedestal.status.table_position, Some(-2135 + 1835), "the angle is absolute");
        assert_eq!(bench.memory.emove.status.held, holding("destination"));
        assert_eq!(bench.memory.subtask.regrip, None);
    });
}

#[test]
fn interrupted_table_turns_by_the_remaining_angle() {
    let mut bench = Bench::fixing();
    bench.until(|bench| bench.memory.subtask.pedestal.command == PedestalVerb::Flip);
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    bench.world.pedestal.outputs.status.table_position = Some(-1000);
    bench.step();
    assert_eq!(fix(&mut bench), DONE);
    let flip = bench.world.pedestal.received[0];
    assert_eq!((flip.command, flip.table_angle), (PedestalVerb::Flip, 1000 - 300));
}

#[test]
fn part_in_the_pedestal_blocks_other_commands() {
    let mut bench = Bench::fixing();
    bench.until(|bench| bench.memory.subtask.pedestal.command == PedestalVerb::Flip);
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    assert!(bench.memory.subtask.status.pedestal_part);
    for verb in [
        SubtaskVerb::GetObject,
        SubtaskVerb::PlaceObj,
        SubtaskVerb::MoveObjToDest,
        SubtaskVerb::InsertTool,
        SubtaskVerb::ReleaseTool,
        SubtaskVerb::AcquireTool,
        SubtaskVerb::RemoveTool,
    ] {
        assert_eq!(bench.run(verb, "PART", (1, 1), "SAFE"), error(Reason::PartInPedestal), "{verb}");
        assert!(bench.sent().is_empty());
    }
    leaves_only_empty_and_clear(&mut bench);
    let other = bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "");
    assert_eq!(other, error(Reason::PartInPedestal));
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "PART", (1, 1), ""), DONE);
    assert_eq!(fix(&mut bench), DONE);
    assert!(!bench.memory.subtask.status.pedestal_part);
    // A hand that is opened at the pedestal is free.
    let mut bench = Bench::fixing();
    bench.until(|bench| bench.memory.subtask.pedestal.command == PedestalVerb::Flip);
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    bench.world.pedestal.outputs.status.felt = Felt::Nothing;
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "SAFE"), DONE);
}

fn holding(held: &str) -> Holding {
    let object = |name: &str, grip| Holding::Object(ObjectGrip { object: Name16::new(name).unwrap(), grip });
    match held {
        "source" => object("PART", 1),
        "destination" => object("PART", -1),
        "neither" => object("PART", 2),
        "other" => object("BAR", 1),
        "something" => Holding::Something,
        "not known" => Holding::NotKnown,
        _ => Holding::Nothing,
    }
}

fn standing(bench: &Bench<'_>, at: Option<(&str, Option<i32>)>) -> Option<Standing> {
    at.map(|(name, grip)| {
        let location = Name10::new(name).unwrap();
        let record = bench.data.locpt_named(&location).unwrap();
        Standing { site: Site::point(location, record), grip }
    })
}

/// FIX-GRIP ends from every combination of its state variables, also if the world ignores it. Returns the number of
/// successes, and of all states.
fn regrips(ignores: (bool, bool)) -> (usize, usize) {
    let (mut done, mut worlds) = (0, 0);
    let places = [
        None,
        Some(("SAFE", None)),
        Some(("PED-SAFE", None)),
        Some(("PEDESTAL", Some(1))),
        Some(("PEDESTAL", Some(-1))),
    ];
    for held in ["", "source", "destination", "neither", "other", "something", "not known"] {
        for (in_hand, felt) in [
            (None, Felt::Nothing),
            (Some("PART"), Felt::Something),
            (Some("BAR"), Felt::Something),
            (Some("PART"), Felt::NotKnown),
        ] {
            for table_position in [Some(-2135), Some(-300), Some(-1000), None] {
                for open in [500, 0] {
                    for at in places {
                        let mut bench = Bench::default();
                        let grip_size = if in_hand.is_some() { 255 } else { open };
                        let status = &mut bench.world.pedestal.outputs.status;
                        (status.grip_size, status.table_position) = (grip_size, table_position);
                        (status.felt, status.gripped) = (felt, in_hand.is_some());
                        bench.world.emove.outputs.status.held = holding(held);
                        bench.world.emove.outputs.status.at = standing(&bench, at);
                        bench.step();
                        let object = |name| Name16::new(name).unwrap();
                        bench.process.state.regrip = in_hand.map(|name| Regrip { object: object(name) });
                        (bench.world.emove.ignores, bench.world.pedestal.ignores) = ignores;
                        bench.step();
                        let end = fix(&mut bench);
                        let is_right = bench.memory.emove.status.held == holding("destination");
                        assert_eq!(
                            end == DONE,
                            is_right && !bench.memory.subtask.status.pedestal_part,
                            "{held}, {in_hand:?}, {table_position:?}, {open}, {at:?}: {end:?}"
                        );
                        if ignores == (false, false) && held == "source" && in_hand.is_none() {
                            assert_eq!(
                                end, DONE,
                                "the robot has the part: {table_position:?}, {open}, {at:?}"
                            );
                        }
                        if ignores == (false, false)
                            && held.is_empty()
                            && (in_hand, felt) == (Some("PART"), Felt::Something)
                            && table_position.is_some()
                        {
                            assert_eq!(end, DONE, "the pedestal has the part: {table_position:?}, {at:?}");
                        }
                        assert_ne!(end.0, StatusReport::Executing);
                        done += usize::from(end == DONE);
                        worlds += 1;
                    }
                }
            }
        }
    }
    (done, worlds)
}

#[test]
fn regrip_ends_from_every_state() {
    let (obeys, worlds) = regrips((false, false));
    let (ignores, _) = regrips((true, true));
    regrips((true, false));
    regrips((false, true));
    assert!(obeys > ignores && obeys < worlds, "{obeys} and {ignores} of {worlds}");
}

/// GET-ENDEFF ends from every gripper and exchange. It is done only with the gripper attached and clear of its
/// holster.
fn exchanges(ignores: bool) {
    for held in ["", "source", "something", "not known"] {
        for attached in [None, Some(1), Some(2)] {
            for exchange in [None, Some(1), Some(2)] {
                let mut bench = Bench::default();
                let status = &mut bench.world.emove.outputs.status;
                (status.end_effector_id, status.exchange, status.held) = (attached, exchange, holding(held));
                bench.world.emove.ignores = ignores;
                bench.step();
                let end = bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "");
                let status = &bench.memory.emove.status;
                let right = (status.end_effector_id, status.exchange) == (Some(2), None);
                assert_eq!(end == DONE, right, "{held}, {attached:?}, {exchange:?}: {end:?}");
                assert!(ignores || !held.is_empty() || end == DONE, "{attached:?}, {exchange:?}: {end:?}");
                if let Some(id) = exchange {
                    let word = if id == 2 { "QC-ATTACH" } else { "QC-DETACH" };
                    assert_eq!(bench.sent()[0], word, "the exchange is finished first");
                    assert_eq!(bench.world.emove.received[0].end_effector_id, exchange, "in its own holster");
                }
            }
        }
    }
}

#[test]
fn interrupted_exchange_is_finished_first() {
    for ignores in [false, true] {
        exchanges(ignores);
    }
    // A command that names no gripper accepts the one in whose holster the robot is.
    let mut bench = Bench::default();
    bench.world.emove.outputs.status.exchange = Some(1);
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "GRIPPER-1", (1, 1), ""), DONE);
    assert_eq!(bench.sent(), ["QC-ATTACH"]);
}

/// GET-OBJECT, PLACE-OBJ and MOVE-OBJ>D with every content of the gripper.
fn handling(ignores: bool) {
    for verb in [SubtaskVerb::GetObject, SubtaskVerb::PlaceObj, SubtaskVerb::MoveObjToDest] {
        for held in ["", "source", "destination", "neither", "other", "something", "not known"] {
            for at in [None, Some(("PFIXTURE", Some(1))), Some(("PFIXTURE", Some(-1))), Some(("SAFE", None))]
            {
                let mut bench = Bench::default();
                bench.world.emove.outputs.status.held = holding(held);
                bench.world.emove.outputs.status.at = standing(&bench, at);
                bench.world.emove.ignores = ignores;
                bench.step();
                let end = bench.run(verb, "PART", (1, 1), "PFIXTURE");
                if held == "something" && verb == SubtaskVerb::GetObject && !ignores {
                    let there = at == Some(("PFIXTURE", Some(1)));
                    assert_eq!(end, if there { DONE } else { error(Reason::UnknownHeld) }, "{at:?}");
                    assert_eq!(bench.sent(), if there { vec!["GRASP-OBJ"] } else { vec![] });
                }
                if held == "neither" {
                    assert_eq!(end, error(Reason::RegripNeeded), "{verb}");
                }
                if held == "not known" {
                    assert_eq!(end, error(Reason::HeldNotKnown), "{verb}");
                }
            }
        }
    }
    for (verb, emove) in [
        (SubtaskVerb::GetObject, EmoveVerb::GraspObj),
        (SubtaskVerb::PlaceObj, EmoveVerb::MovObjTo),
        (SubtaskVerb::MoveObjToDest, EmoveVerb::MovObjTo),
        (SubtaskVerb::InsertTool, EmoveVerb::InsertTool),
        (SubtaskVerb::AcquireTool, EmoveVerb::AcquireTool),
        (SubtaskVerb::RemoveTool, EmoveVerb::RemoveTool),
    ] {
        for after in ["something", "not known"] {
            let get = matches!(verb, SubtaskVerb::GetObject | SubtaskVerb::AcquireTool);
            let object = if emove as u8 >= EmoveVerb::InsertTool as u8 { "TOOL-1" } else { "PART" };
            let mut bench = if get { Bench::default() } else { Bench::grasped(object, 1) };
            bench.world.emove.mishap = Some((emove, DeliveryFault::NoEffect));
            bench.command(verb, object, (1, 1), "PFIXTURE");
            bench.until(|bench| bench.memory.subtask.emove.command == emove);
            bench.world.emove.outputs.status.held = holding(after);
            let reason = if after == "something" { Reason::UnknownHeld } else { Reason::HeldNotKnown };
            assert_eq!(bench.finish(), error(reason), "{verb}, {after}");
        }
    }
}

#[test]
fn unknown_object_is_neither_taken_nor_placed() {
    for ignores in [false, true] {
        handling(ignores);
    }
}

#[test]
fn held_object_is_grasped_again_in_its_grip() {
    for grip in [1, -1] {
        let mut bench = Bench::grasped("PART", grip);
        assert_eq!(bench.run(SubtaskVerb::GetObject, "PART", (1, -1), "PFIXTURE"), DONE);
        assert_eq!(bench.sent(), ["GRASP-OBJ"]);
        let sent = bench.world.emove.received[0];
        let part = bench.data.object(&Name16::new("PART").unwrap(), grip).unwrap().0;
        assert_eq!((sent.grip, sent.object_parameters), (grip, part));
        // An interrupted release has left nothing between the fingers.
        bench.world.emove.mishap = Some((EmoveVerb::GraspObj, DeliveryFault::Error(Reason::GraspMissed)));
        let end = bench.run(SubtaskVerb::GetObject, "PART", (1, -1), "PFIXTURE");
        assert_eq!(end, error(Reason::GraspMissed));
    }
}

#[test]
fn placed_object_is_not_placed_again() {
    let mut bench = Bench::grasped("PART", 1);
    assert_eq!(bench.run(SubtaskVerb::PlaceObj, "PART", (1, 1), "SAFE"), DONE);
    assert_eq!(bench.run(SubtaskVerb::PlaceObj, "PART", (1, 1), "SAFE"), DONE);
    assert!(bench.sent().is_empty());
    let placed = bench.memory.subtask.status.placed.unwrap();
    let expected = PlacedObject { object: Name16::new("PART").unwrap(), grip: 1, ..placed };
    assert_eq!((placed.site.location.as_str(), placed), ("SAFE", expected));
    for (object, grips, location) in
        [("PART", (1, 1), "HOME"), ("PART", (1, 2), "SAFE"), ("BAR", (1, 1), "SAFE")]
    {
        let end = bench.run(SubtaskVerb::PlaceObj, object, grips, location);
        assert_eq!(end, error(Reason::NothingHeld), "{object} {grips:?} {location}");
    }
}

#[test]
fn located_object_is_not_located_again() {
    let mut bench = Bench::default();
    let name = Name10::new("UNIT_1").unwrap();
    let site = Site::point(name, bench.data.locpt_named(&name).unwrap());
    let object = Name16::new("BAR").unwrap();
    bench.world.emove.outputs.status.located = Some(LocatedObject { object, site });
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE);
    assert_eq!(bench.sent(), ["MOV-TO-OBJ", "GRASP-OBJ"]);
}

/// A robot at BAR, which lies where pictures are taken, after a person moved the robot with BAR between the fingers.
fn led_with_a_part(held: Holding) -> Bench<'static> {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE);
    bench.world.emove.received.clear();
    let status = &mut bench.world.emove.outputs.status;
    (status.held, status.seat) = (held, Seat::NotKnown);
    bench.step();
    bench
}

#[test]
fn object_that_may_have_slid_is_released_and_located_again() {
    let object = Holding::Object(ObjectGrip { object: Name16::new("BAR").unwrap(), grip: 1 });
    for held in [object, Holding::Something] {
        let mut bench = led_with_a_part(held);
        assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE, "{held:?}");
        assert_eq!(bench.sent(), ["RELEASE", "MOV-TO-VU", "LOCATE-OBJ", "MOV-TO-OBJ", "GRASP-OBJ"]);
    }
    // Elsewhere the object would fall.
    let mut bench = led_with_a_part(object);
    bench.world.emove.outputs.status.at = None;
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE);
    assert_eq!(bench.sent(), ["GRASP-OBJ"]);
    assert_eq!(bench.memory.subtask.status.unconfirmed, Unconfirmed::PartInFingers);
}

/// GET-OBJECT whose pictures are lost during the motion to the object.
pub fn pictures_lost() -> Bench<'static> {
    let mut bench = Bench::default();
    bench.command(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1");
    bench.until(|bench| bench.memory.subtask.emove.command == EmoveVerb::MovToObj);
    bench.world.emove.outputs.status.located = None;
    bench
}

#[test]
fn lost_pictures_are_taken_again_before_the_grasp() {
    let mut bench = pictures_lost();
    bench.finish();
    let sent = ["MOV-TO-VU", "LOCATE-OBJ", "MOV-TO-OBJ"];
    let sent = [&sent[..], &sent[..], &["GRASP-OBJ"]].concat();
    assert_eq!(bench.sent(), sent);
}

/// GET-OBJECT at another sector of the array: its location has the same records, but another pose.
fn at_another_sector(bench: &mut Bench<'_>) {
    bench.command(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1");
    let pose = &mut bench.memory.task.poses[0].pose;
    for point in [&mut pose.wrist, &mut pose.tool, &mut pose.finger] {
        point[0] += 6_000;
    }
}

#[test]
fn sectors_of_an_array_are_distinguished() {
    let begun = |until: EmoveVerb| {
        let mut bench = Bench::default();
        bench.command(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1");
        bench.until(|bench| bench.memory.subtask.emove.command == until);
        bench
    };
    let mut bench = begun(EmoveVerb::MovToObj);
    bench.world.emove.received.clear();
    at_another_sector(&mut bench);
    assert_eq!(bench.finish(), DONE);
    let sent = ["MOV-TO-OBJ", "E-PAUSE", "MOV-TO-VU", "LOCATE-OBJ", "MOV-TO-OBJ", "GRASP-OBJ"];
    assert_eq!(bench.sent(), sent, "pictures of this sector");
    // An interrupted grasp has closed on something at the first sector.
    let mut bench = begun(EmoveVerb::GraspObj);
    bench.world.emove.outputs.status.held = Holding::Something;
    bench.world.emove.mishap = Some((EmoveVerb::GraspObj, DeliveryFault::NoEffect));
    bench.world.emove.received.clear();
    at_another_sector(&mut bench);
    assert_eq!(bench.finish(), error(Reason::UnknownHeld));
    assert_eq!(bench.sent(), ["GRASP-OBJ", "E-PAUSE"]);
}

/// The tool commands with fingers in the drum, outside, or at no known place.
#[test]
fn open_fingers_move_out_of_the_drum() {
    for verb in
        [SubtaskVerb::InsertTool, SubtaskVerb::ReleaseTool, SubtaskVerb::AcquireTool, SubtaskVerb::RemoveTool]
    {
        for held in ["", "other", "something", "not known"] {
            for (drum, at) in
                [(true, Some(("TOOL-TRNS", None))), (false, Some(("SAFE", None))), (false, None)]
            {
                let mut bench = Bench::default();
                bench.world.emove.outputs.status.held = holding(held);
                bench.world.emove.outputs.status.at = standing(&bench, at);
                bench.world.emove.outputs.status.drum = drum;
                bench.step();
                let end = bench.run(verb, "TOOL-1", (1, 1), "");
                if verb == SubtaskVerb::ReleaseTool {
                    let led_out = (drum && held != "other") || (held.is_empty() && at.is_none());
                    let hindered = match held {
                        "something" => Reason::UnknownHeld,
                        "not known" => Reason::HeldNotKnown,
                        _ => Reason::NothingHeld,
                    };
                    let expected = if led_out { DONE } else { error(hindered) };
                    assert_eq!(end, expected, "{held}, {drum}, {at:?}");
                }
            }
        }
    }
}

/// An interrupted grasp has closed on something in the drum, which can only be the tool.
#[test]
fn interrupted_grasp_of_a_tool_is_repeated() {
    for (drum, end, sent) in [(true, DONE, &["ACQUIRE-TOOL"][..]), (false, error(Reason::UnknownHeld), &[])] {
        let mut bench = Bench::default();
        bench.world.emove.outputs.status.held = holding("something");
        bench.world.emove.outputs.status.at = standing(&bench, Some(("TOOL-TRNS", None)));
        bench.world.emove.outputs.status.drum = drum;
        bench.step();
        assert_eq!(bench.run(SubtaskVerb::AcquireTool, "TOOL-1", (1, 1), ""), end);
        assert_eq!(bench.sent(), sent);
    }
}

#[test]
fn pause_waits_for_robot_and_pedestal() {
    let moving = |verb, mishap| {
        let mut bench = Bench::grasped("PART", 1);
        bench.world.pedestal.mishap = mishap;
        bench.command(SubtaskVerb::FixGrip, "PART", (1, -1), "");
        bench.until(|bench| bench.memory.subtask.pedestal.command == verb);
        bench.step();
        bench
    };
    // The pedestal does not answer the pause; then it does, but E-move fails.
    let mut bench = moving(PedestalVerb::Flip, Some((PedestalVerb::Pause, DeliveryFault::Silence)));
    let end = bench.run(SubtaskVerb::Pause, "", (0, 0), "");
    assert_eq!(end, DONE);
    let mut bench = moving(PedestalVerb::Flip, None);
    bench.world.emove.mishap = Some((EmoveVerb::Pause, DeliveryFault::Error(Reason::LinkOff)));
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), error(Reason::LinkOff));
    // The next command waits for a replaced pause.
    let mut bench = moving(PedestalVerb::Flip, None);
    bench.command(SubtaskVerb::Pause, "", (0, 0), "");
    bench.step();
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), DONE);
    assert!(!bench.sent_to_pedestal().contains(&"PAUSE"));
    // A restarted Subtask finds a pause that is still executing.
    let mut bench = moving(PedestalVerb::Flip, None);
    bench.command(SubtaskVerb::Pause, "", (0, 0), "");
    bench.step();
    bench.step();
    bench.restart();
    bench.finish();
    let mut bench = moving(PedestalVerb::Flip, None);
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "SAFE"), DONE);
}

/// With the part in the pedestal and the robot at PED-SAFE, the robot may leave. It may not leave from the pedestal,
/// with something in its fingers, or from no known place with its tool near PEDESTAL.
fn leaves_only_empty_and_clear(bench: &mut Bench<'_>) {
    let safe = bench.world.emove.outputs.status.at;
    for verb in [SubtaskVerb::GotoEndpt, SubtaskVerb::GotoDest, SubtaskVerb::Position] {
        let refused = |bench: &mut Bench<'_>, why: &str| {
            bench.step();
            assert_eq!(bench.run(verb, "", (0, 0), "SAFE"), error(Reason::PartInPedestal), "{verb}: {why}");
            assert!(bench.sent().is_empty());
        };
        let name = Name10::clipped("PEDESTAL");
        let site = Site::point(name, bench.data.locpt_named(&name).unwrap());
        bench.memory.prim.status.sensor_pose = None;
        bench.world.emove.outputs.status.at = safe.map(|at| Standing { site, ..at });
        refused(bench, "at the pedestal");
        bench.world.emove.outputs.status.at = None;
        refused(bench, "at no known place, without sensor pose");
        tool_above_pedestal(bench, 3.0);
        refused(bench, "at no known place, 3 in from PEDESTAL");
        bench.world.emove.outputs.status.at = safe;
        bench.world.emove.outputs.status.held = Holding::NotKnown;
        refused(bench, "it may hold something");
        bench.world.emove.outputs.status.held = Holding::Nothing;
        bench.world.emove.outputs.status.at = None;
        tool_above_pedestal(bench, 6.0);
        bench.step();
        assert_eq!(bench.run(verb, "", (0, 0), "SAFE"), DONE, "{verb}");
        bench.world.emove.outputs.status.at = safe;
        bench.step();
    }
}

/// The resolvers show the tool at this height above PEDESTAL, in.
fn tool_above_pedestal(bench: &mut Bench<'_>, inches: f64) {
    let id = bench.data.locpt_named(&Name10::clipped("PEDESTAL")).unwrap();
    let mut frame = bench.data.locpt(id).unwrap().frame;
    frame.position.z += inches;
    let record = ChangingPose { number: Some(0x8300_0001), pose: Pose::from_frame(&frame) };
    bench.memory.prim.poses[0] = record;
    bench.memory.prim.status.sensor_pose = record.number;
}

/// The commands that the pedestal receives for a manual order.
fn order(bench: &mut Bench<'_>, order: HandOrder) -> Vec<&'static str> {
    bench.world.pedestal.received.clear();
    bench.external.operator.pedestal = Some(order);
    bench.step();
    bench.external.operator.pedestal = None;
    bench.wait(8);
    bench.sent_to_pedestal()
}

const fn by_hand(command: PedestalVerb) -> HandOrder {
    HandOrder { command, object: None, table_angle: 0, by_hand: false }
}

fn of_part(command: PedestalVerb) -> HandOrder {
    HandOrder { object: Some(Name16::clipped("PART")), ..by_hand(command) }
}

/// A bench whose robot is empty at a place and whose Subtask is idle.
fn resting(at: &str) -> Bench<'static> {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), at), DONE);
    bench
}

#[test]
fn manual_orders_grip_turn_and_release_a_part() {
    let mut bench = resting("PED-SAFE");
    assert_eq!(order(&mut bench, of_part(PedestalVerb::PreGrip)), ["PRE-GRIP"]);
    assert_eq!(order(&mut bench, of_part(PedestalVerb::Grip)), ["GRIP"]);
    let regrip = |bench: &Bench<'_>| bench.memory.subtask.regrip.map(|regrip| regrip.object.to_string());
    assert_eq!(regrip(&bench).as_deref(), Some("PART"));
    let flip = HandOrder { table_angle: 900, ..by_hand(PedestalVerb::Flip) };
    assert_eq!(order(&mut bench, flip), ["FLIP"]);
    assert_eq!(bench.world.pedestal.outputs.status.table_position, Some(-1235));
    assert!(order(&mut bench, of_part(PedestalVerb::PreGrip)).is_empty(), "it would drop the part");
    assert!(order(&mut bench, by_hand(PedestalVerb::Release)).is_empty(), "the part would fall");
    let held = HandOrder { by_hand: true, ..by_hand(PedestalVerb::Release) };
    assert_eq!(order(&mut bench, held), ["RELEASE"]);
    assert_eq!(bench.world.pedestal.received[0].grasp_size, 450);
    assert_eq!(regrip(&bench), None, "the hand is empty");
    assert_eq!(order(&mut bench, by_hand(PedestalVerb::Release)), ["RELEASE"], "the hand is empty");
    assert_eq!(order(&mut bench, by_hand(PedestalVerb::Pause)), ["PAUSE"]);
    bench.world.pedestal.part = 0;
    order(&mut bench, of_part(PedestalVerb::Grip));
    assert_eq!(regrip(&bench), None, "the hand has closed on nothing");
}

#[test]
fn manual_orders_are_refused_while_subtask_or_robot_use_the_pedestal() {
    for ticks in [1, 10, 30] {
        let mut bench = Bench::fixing();
        bench.wait(ticks);
        bench.external.operator.pedestal = Some(by_hand(PedestalVerb::Release));
        let before = bench.memory.subtask.pedestal.number;
        bench.step();
        let sent = bench.memory.subtask.pedestal;
        assert!(sent.number == before || sent.command != PedestalVerb::Release, "tick {ticks}");
        bench.external.operator.pedestal = None;
        assert_eq!(bench.finish(), DONE, "tick {ticks}");
    }
    let mut bench = resting("PEDESTAL");
    let flip = HandOrder { table_angle: 900, ..by_hand(PedestalVerb::Flip) };
    assert!(order(&mut bench, flip).is_empty(), "the robot is at the pedestal");
    assert!(order(&mut bench, of_part(PedestalVerb::PreGrip)).is_empty());
    let unknown = HandOrder { object: Some(Name16::clipped("BAR")), ..by_hand(PedestalVerb::Grip) };
    assert!(order(&mut bench, unknown).is_empty(), "no PED-PARA record");
    assert!(order(&mut bench, by_hand(PedestalVerb::Grip)).is_empty(), "no object");
    bench.world.pedestal.mishap = Some((PedestalVerb::Grip, DeliveryFault::Hang));
    assert_eq!(order(&mut bench, of_part(PedestalVerb::Grip)), ["GRIP"]);
    assert!(order(&mut bench, of_part(PedestalVerb::Grip)).is_empty(), "the hand moves");
    assert_eq!(order(&mut bench, by_hand(PedestalVerb::Pause)), ["PAUSE"]);
    bench.world.pedestal.mishap = Some((PedestalVerb::Pause, DeliveryFault::Silence));
    order(&mut bench, by_hand(PedestalVerb::Pause));
    let sent = bench.memory.subtask.pedestal.number;
    order(&mut bench, by_hand(PedestalVerb::Pause));
    assert_eq!(bench.memory.subtask.pedestal.number, sent, "the pedestal does not answer");
}

/// Robot and pedestal both hold the part, so the hand may open without a person.
#[test]
fn manual_release_is_accepted_while_the_robot_holds_the_part() {
    let mut bench = Bench::fixing();
    bench.until(|bench| bench.memory.subtask.emove.command == EmoveVerb::Release);
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    assert!(bench.world.emove.outputs.status.held.is_held() && bench.memory.subtask.status.pedestal_part);
    assert_eq!(order(&mut bench, by_hand(PedestalVerb::Release)), ["RELEASE"]);
}
