use geometry::units::hundredths;
use interfaces::{
    CommonMemory, ExternalInputs, JawsOutputs, Reason,
    device::{GroupHealth, JawValves},
    grip::Felt,
    jaws::{JawsCommand, JawsReport, JawsVerb},
    process::Process,
};
use proptest::prelude::*;
use rcs_core::tick::Tick;

use super::{
    CylindricalPartGripper, Jaws, JawsKind, ToolGrip, ToolGripper, VGrip, preprocess::LIMIT_TICKS,
    tables::Step,
};
use crate::{
    bench::{self, Buffers, Tested, World},
    coverage::silent,
    environment::{jaws::Fingers, ring::mated},
};

type Bench<K> = bench::Bench<Jaws<K>, Fingers>;
type VBench = Bench<CylindricalPartGripper>;
type ToolBench = Bench<ToolGripper>;

impl<K: JawsKind + Default> Tested<()> for Jaws<K>
where
    Self: Buffers<Outputs = JawsOutputs>,
{
    type Order = JawsCommand;
    type End = (JawsReport, Reason);
    const LONGEST: u64 = LIMIT_TICKS + 3;

    fn order(memory: &mut CommonMemory, order: JawsCommand, number: u32) {
        let to = &mut memory.emove;
        let buffer = if K::PARAMETERS.end_effector_id == 2 { &mut to.v_grip } else { &mut to.tool_grip };
        *buffer = JawsCommand { number, ..order };
    }

    fn end(outputs: &JawsOutputs) -> Option<(JawsReport, Reason)> {
        let status = outputs.status;
        (status.report != JawsReport::Executing).then_some((status.report, status.reason))
    }

    fn check(outputs: &JawsOutputs, _: &CommonMemory, external: &ExternalInputs) {
        let JawValves { open, close } = outputs.valves;
        assert!(!(open && close), "air to both sides");
        assert!(external.devices.quick_change.locked || !(open || close), "air without a gripper");
        assert_eq!((outputs.status.left_force, outputs.status.right_force), (0, 0));
    }
}

impl<P: Buffers<Outputs = JawsOutputs>> World<P> for Fingers {
    fn sense(&mut self, _: Tick, _: &mut CommonMemory, external: &mut ExternalInputs) {
        let devices = &mut external.devices;
        devices.grip.potentiometer = if devices.quick_change.locked { self.counts() } else { 0 };
    }

    fn act(&mut self, _: Tick, _: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        self.advance(P::outputs(after).valves);
    }
}

fn order(command: JawsVerb, size: f64) -> JawsCommand {
    JawsCommand { command, size: hundredths(size), ..JawsCommand::default() }
}

impl<K: JawsKind + Default> Bench<K>
where
    Jaws<K>: Buffers<Outputs = JawsOutputs>,
{
    /// A bench with the gripper attached, after a tick without a command.
    fn new(opening: f64) -> Self {
        let mut bench = Self::before(Fingers::new::<K>(opening));
        bench.attach(true);
        bench.step();
        bench
    }

    fn attach(&mut self, locked: bool) {
        self.external.devices.quick_change = mated(locked, K::PARAMETERS.end_effector_id);
    }
}

const CLOSED: (JawsReport, Reason) = (JawsReport::Closed, Reason::None);
const OPENED: (JawsReport, Reason) = (JawsReport::Opened, Reason::None);

#[test]
fn processes_differ_in_name_id_and_travel() {
    assert_eq!((<VGrip as Process<()>>::NAME, <ToolGrip as Process<()>>::NAME), ("V-Grip", "Tool-Grip"));
    let mut v = VBench::new(2.0);
    let mut tool = ToolBench::new(2.0);
    assert_eq!((v.execute(order(JawsVerb::Grasp, 0.0)), v.memory.v_grip.status.size), (CLOSED, 50));
    assert_eq!((tool.execute(order(JawsVerb::Grasp, 0.0)), tool.memory.tool_grip.status.size), (CLOSED, 100));
    assert_eq!((v.execute(order(JawsVerb::Release, 0.0)), v.memory.v_grip.status.size), (OPENED, 350));
    assert_eq!(
        (tool.execute(order(JawsVerb::Release, 0.0)), tool.memory.tool_grip.status.size),
        (OPENED, 400)
    );
    tool.external.devices.quick_change.end_effector_id = 2;
    assert_eq!(tool.execute(order(JawsVerb::Grasp, 0.0)), (JawsReport::Stuck, Reason::WrongGripper));
}

/// VI.4.2: the status at the end of each command, for each position of the fingers.
#[test]
fn every_command_reports_where_its_fingers_stopped() {
    use JawsReport::{AtPosition, Closed, Opened, Stuck};
    use JawsVerb::{Grasp, Pause, Pose, Release};
    // Fingers without effective air stay in place: closed, between, opened.
    for (verb, place, size, expected, reason) in [
        (Grasp, 0.50, 2.0, Closed, Reason::None),
        (Grasp, 2.00, 2.0, Closed, Reason::None),
        (Grasp, 3.50, 3.5, Closed, Reason::None),
        (Grasp, 1.50, 2.0, Stuck, Reason::JawsStuck),
        (Grasp, 3.50, 2.0, Opened, Reason::JawsStuck),
        (Release, 3.50, 2.0, Opened, Reason::None),
        (Release, 2.00, 2.0, Opened, Reason::None),
        (Release, 0.50, 0.5, Opened, Reason::None),
        (Release, 1.50, 2.0, Stuck, Reason::JawsStuck),
        (Release, 0.50, 2.0, Closed, Reason::JawsStuck),
        (Pose, 3.50, 2.0, Opened, Reason::None),
        (Pose, 1.50, 2.0, Stuck, Reason::JawsStuck),
        (Pose, 0.50, 2.0, Closed, Reason::JawsStuck),
        (Pause, 0.50, 2.0, Closed, Reason::None),
        (Pause, 3.50, 2.0, Opened, Reason::None),
        (Pause, 2.00, 2.0, AtPosition, Reason::None),
        (Pause, 1.50, 2.0, Stuck, Reason::JawsStuck),
    ] {
        let mut bench = VBench::new(place);
        bench.world.speed = 0.0;
        assert_eq!(bench.execute(order(verb, size)), (expected, reason), "{verb} {size} at {place}");
        assert_eq!(bench.wait(30).status.report, expected, "the report stays until the next command");
    }
}

#[test]
fn part_presence_is_reported_after_every_command() {
    let mut bench = VBench::new(2.0);
    let felt: Vec<_> = (0..5).map(|_| bench.step().status.felt).collect();
    assert_eq!(felt, [Felt::NotKnown, Felt::NotKnown, Felt::NotKnown, Felt::NotKnown, Felt::Something]);
    bench.world.object = Some(2.0);
    for (verb, felt) in [(JawsVerb::Release, Felt::Nothing), (JawsVerb::Grasp, Felt::Something)] {
        bench.send(order(verb, 0.0));
        assert_eq!(bench.wait(8).status.felt, Felt::NotKnown, "they move");
        bench.finish();
        assert_eq!(bench.outputs().status.felt, felt, "{verb}");
        bench.execute(order(JawsVerb::Pause, 0.0));
        assert_eq!(bench.outputs().status.felt, felt, "the report does not count");
    }
    bench.world.object = None;
    assert_eq!(bench.wait(40).status.felt, Felt::Nothing, "it was lost");
    for (dead, felt) in [(-0.3, Felt::NotKnown), (6.0, Felt::NotKnown)] {
        bench.world.ends = (dead, dead);
        bench.world.opening = dead;
        assert_eq!(bench.wait(20).status.felt, felt, "a potentiometer at {dead}");
    }
    bench.attach(false);
    assert_eq!(bench.step().status.felt, Felt::NotKnown);
}

#[test]
fn open_fingers_with_closing_air_are_not_empty() {
    let mut bench = VBench::new(3.5);
    assert_eq!(bench.wait(20).status.felt, Felt::Nothing);
    bench.world.speed = 0.0;
    assert_eq!(bench.execute(order(JawsVerb::Grasp, 0.0)).0, JawsReport::Opened);
    assert_eq!(bench.wait(20).status.felt, Felt::NotKnown, "the air is off");
    (bench.world.speed, bench.world.object) = (3.0, Some(2.0));
    assert_eq!(bench.wait(100).status.felt, Felt::Something, "the air is back");
}

#[test]
fn fingers_press_until_release() {
    let mut bench = VBench::new(3.5);
    bench.world.object = Some(2.0);
    assert_eq!(bench.execute(order(JawsVerb::Grasp, 1.95)), CLOSED);
    assert_eq!((bench.outputs().status.size, bench.outputs().valves.close), (200, true));
    // The next command has no size, so the last one stays valid.
    assert_eq!(bench.execute(order(JawsVerb::Pause, 0.0)), (JawsReport::AtPosition, Reason::None));
    assert!(bench.wait(100).valves.close, "still pressed");
    bench.world.object = None;
    assert_eq!(bench.wait(30).status.size, 50, "the size shows that the object has slipped out");
    assert_eq!(bench.execute(order(JawsVerb::Release, 0.0)), OPENED);
    assert!(bench.outputs().valves.open && !bench.outputs().valves.close);
}

/// Air may fail when the fingers touch the object, and return: the object is grasped only once they press it.
#[test]
fn grasp_is_done_after_a_second_at_rest() {
    let mut bench = VBench::new(3.5);
    bench.world.object = Some(2.0);
    bench.send(order(JawsVerb::Grasp, 2.0));
    bench.until(|bench| bench.world.opening <= 2.0);
    let arrived = bench.tick;
    assert_eq!(bench.wait(24).status.felt, Felt::NotKnown);
    bench.send(order(JawsVerb::Pause, 0.0));
    assert_eq!(
        (bench.finish(), bench.outputs().status.felt),
        ((JawsReport::AtPosition, Reason::None), Felt::Something)
    );
    assert!((25..=30).contains(&bench.tick.since(arrived)), "{}", bench.tick.since(arrived));
    bench.world.object = None;
    bench.wait(30);
    let empty = bench.tick;
    assert_eq!((bench.execute(order(JawsVerb::Grasp, 2.0)), bench.tick.since(empty) < 5), (CLOSED, true));
}

#[test]
fn moving_fingers_report_executing_with_their_velocity() {
    let mut bench = ToolBench::new(4.0);
    bench.send(order(JawsVerb::Grasp, 0.0));
    let status = bench.wait(8).status;
    assert_eq!(status.report, JawsReport::Executing);
    assert!((-320..=-280).contains(&status.velocity), "{}", status.velocity);
    bench.send(order(JawsVerb::Pause, 0.0));
    let outputs = bench.step();
    assert_eq!(
        (outputs.status.report, outputs.valves.close),
        (JawsReport::Executing, true),
        "PAUSE waits too"
    );
    assert_eq!(bench.finish(), CLOSED);
    assert_eq!(bench.outputs().status.velocity.abs() / 10, 0);
}

#[test]
fn implausible_potentiometer_is_an_error() {
    let mut bench = VBench::new(2.0);
    bench.world.noise = 60;
    assert_eq!(bench.execute(order(JawsVerb::Grasp, 0.0)), (JawsReport::Stuck, Reason::JawsStuck));
    assert_eq!(bench.outputs().valves, JawValves::default());
    bench.world.noise = 0;
    for dead in [-0.3, 6.0] {
        bench.world.ends = (dead, dead);
        bench.world.opening = dead;
        assert_eq!(
            bench.execute(order(JawsVerb::Release, 0.0)),
            (JawsReport::Stuck, Reason::JawsStuck),
            "{dead}"
        );
    }
}

#[test]
fn missing_gripper_fails_commands_and_turns_the_air_off() {
    let mut bench = VBench::new(3.5);
    bench.send(order(JawsVerb::Grasp, 0.0));
    bench.wait(3);
    bench.attach(false);
    assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::WrongGripper));
    assert_eq!(bench.execute(order(JawsVerb::Release, 0.0)), (JawsReport::Stuck, Reason::WrongGripper));
    assert_eq!(bench.execute(order(JawsVerb::Pause, 0.0)), (JawsReport::Idle, Reason::None));
    assert_eq!(bench.execute(order(JawsVerb::None, 0.0)), (JawsReport::Stuck, Reason::UnknownCommand));
    bench.attach(true);
    bench.external.devices.quick_change.unlocked = true;
    assert_eq!(bench.execute(order(JawsVerb::Grasp, 0.0)), (JawsReport::Stuck, Reason::WrongGripper));
    bench.attach(true);
    let other = JawsCommand { end_effector_id: Some(3), ..order(JawsVerb::Grasp, 0.0) };
    assert_eq!(bench.execute(other), (JawsReport::Stuck, Reason::WrongGripper), "for another gripper");
}

/// The fingers press a part while the id pins have no contact, and while the process is restarted.
#[test]
fn air_stays_on_without_the_id_and_after_a_restart() {
    for id in [0, 7] {
        let mut bench = VBench::new(3.5);
        bench.world.object = Some(2.0);
        bench.send(order(JawsVerb::Grasp, 1.95));
        bench.wait(3);
        bench.external.devices.quick_change.end_effector_id = id;
        assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::WrongGripper));
        assert!(bench.wait(30).valves.close, "id {id}");
        bench.restart();
        assert!(bench.wait(2).valves.close, "id {id}, restarted");
        bench.attach(true);
        bench.wait(2);
        assert_eq!(bench.execute(order(JawsVerb::Grasp, 1.95)), CLOSED);
        bench.external.devices.quick_change.end_effector_id = 3;
        assert!(!bench.step().valves.close, "another gripper");
    }
}

#[test]
fn starting_or_waking_process_executes_nothing() {
    let mut bench = VBench::new(3.5);
    assert_eq!(bench.execute(order(JawsVerb::Release, 0.0)), OPENED);
    bench.attach(false);
    bench.wait(2);
    bench.sleep(20);
    bench.send(order(JawsVerb::Grasp, 0.0));
    bench.attach(true);
    bench.sleep(2);
    let outputs = bench.wait(30);
    assert_eq!((outputs.status.report, outputs.status.reason), (JawsReport::Stuck, Reason::Restarted));
    assert_eq!(
        (outputs.status.echo, outputs.valves),
        (bench.memory.emove.v_grip.number, JawValves::default())
    );
    assert_eq!(bench.world.opening, 3.5);
    assert_eq!(bench.execute(order(JawsVerb::Pause, 0.0)), OPENED);
    bench.send(order(JawsVerb::Grasp, 0.0));
    bench.restart();
    assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::Restarted));
    assert_eq!(bench.world.opening, 3.5);
    let mut fresh = VBench::new(2.0);
    fresh.sleep(10);
    assert_eq!(fresh.wait(10).status.report, JawsReport::Idle, "woken before any command");
}

#[test]
fn late_device_only_delays_a_command() {
    let mut bench = VBench::new(3.5);
    bench.world.object = Some(2.0);
    bench.send(order(JawsVerb::Grasp, 2.0));
    bench.wait(3);
    bench.external.devices.field.grip = GroupHealth::Stale;
    let outputs = bench.wait(LIMIT_TICKS as u32 + 10);
    assert_eq!((outputs.status.report, outputs.status.felt), (JawsReport::Executing, Felt::NotKnown));
    assert!(outputs.valves.close, "the air stays as it is");
    bench.external.devices.field.grip = GroupHealth::Fresh;
    assert_eq!(bench.finish(), CLOSED);
    for (connection, reason) in
        [(GroupHealth::Lost, Reason::DeviceSilent), (GroupHealth::Tripped, Reason::DeviceTripped)]
    {
        bench.external.devices.field.grip = connection;
        assert_eq!(bench.execute(order(JawsVerb::Release, 3.0)), (JawsReport::Stuck, reason));
        assert_eq!(bench.memory.v_grip.valves, JawValves::default());
    }
}

#[test]
fn tripped_device_ends_the_air_that_opens_and_keeps_the_air_that_closes() {
    let mut bench = VBench::new(2.0);
    assert_eq!(bench.execute(order(JawsVerb::Release, 3.0)), OPENED);
    for (connection, opens) in
        [(GroupHealth::Stale, true), (GroupHealth::Lost, true), (GroupHealth::Tripped, false)]
    {
        bench.external.devices.field.grip = connection;
        assert_eq!(bench.wait(5).valves, JawValves { open: opens, close: false }, "{connection:?}");
    }
    bench.external.devices.field.grip = GroupHealth::Fresh;
    assert_eq!(bench.wait(5).valves, JawValves::default(), "the air does not return by itself");
    assert_eq!(bench.execute(order(JawsVerb::Grasp, 0.0)), CLOSED);
    bench.external.devices.field.grip = GroupHealth::Tripped;
    assert_eq!(bench.wait(5).valves, JawValves { open: false, close: true });
}

#[test]
fn every_row_fires() {
    let mut silent = silent::<VGrip, ()>(&[
        every_command_reports_where_its_fingers_stopped,
        implausible_potentiometer_is_an_error,
        missing_gripper_fails_commands_and_turns_the_air_off,
        starting_or_waking_process_executes_nothing,
        late_device_only_delays_a_command,
    ]);
    silent.retain(|row| !["PRESENCE ", "VALVES "].iter().any(|table| row.starts_with(table)));
    assert_eq!(silent, [""; 0]);
}

/// The search starts from every state, with fingers that move or do not, with and without the gripper.
#[test]
fn every_command_ends_from_every_state() {
    let worlds: Vec<_> = [(true, 3.0, 1), (true, 0.0, 1), (true, 3.0, 60), (false, 3.0, 1)]
        .into_iter()
        .flat_map(|world| [None, Some(2.0), Some(1.5)].map(|object| (world, object)))
        .flat_map(|world| [-0.3, 0.50, 1.50, 2.00, 3.50, 6.0].map(|place| (world, place)))
        .collect();
    let mut ends = [0; 2];
    for (step, verb) in Step::ALL.iter().flat_map(|s| JawsVerb::ALL.iter().map(move |verb| (s, verb))) {
        for (open, close) in [(false, false), (true, false), (false, true)] {
            for &(((attached, speed, noise), object), place) in &worlds {
                let mut bench = VBench::new(place);
                bench.attach(attached);
                (bench.world.speed, bench.world.noise, bench.world.object) = (speed, noise, object);
                let state = &mut bench.process.state;
                (state.step, state.valves) = (*step, JawValves { open, close });
                let (report, reason) = bench.execute(order(*verb, 2.0));
                assert!(reason != Reason::None || report != JawsReport::Stuck, "{verb} at {place}");
                ends[usize::from(reason == Reason::None)] += 1;
            }
        }
    }
    assert!(ends.iter().all(|count| *count > 100), "failed and done: {ends:?}");
}

proptest! {
    /// Random commands and sensors cause no panic, and no air to both sides or without the gripper. Every command ends,
    /// and the same inputs give the same bytes, also after a restore.
    #[test]
    fn nonsense(ticks in prop::collection::vec((0_u8..30, any::<i32>(), any::<u8>(), any::<u16>()), 1..200)) {
        let (mut bench, mut twin) = (ToolBench::new(2.0), ToolBench::new(2.0));
        for (what, size, id, counts) in ticks {
            for bench in [&mut bench, &mut twin] {
                if let Some(command) = JawsVerb::from_code(what) {
                    let end_effector_id = (id != 0).then_some(id);
                    bench.send(JawsCommand { command, size, end_effector_id, ..JawsCommand::default() });
                }
                match what {
                    10 => bench.restart(),
                    11 => bench.attach(id % 2 == 0),
                    12 => bench.world.opening = 1.0 + f64::from(counts) / 22_000.0,
                    13 => bench.world.noise = counts % 100,
                    14 => bench.sleep(3),
                    _ => {}
                }
                bench.step();
            }
            twin.restore();
            prop_assert_eq!(bench.image(), twin.image());
        }
        bench.finish();
    }
}
