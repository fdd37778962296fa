//! Scenarios of V-Grip and Tool-Grip with a simulated gripper.

use geometry::units::hundredths;
use interfaces::{
    CommonMemory, ExternalInputs, JawsOutputs, Reason,
    device::{JawValves, QuickChangeSensors},
    grip::Felt,
    jaws::{JawsCommand, JawsReport, JawsVerb},
    process::{Inputs, Process},
};
use proptest::prelude::*;
use rcs_core::{
    Plain,
    plain::to_bytes,
    tick::{TICK_S, Tick},
};

use super::{
    Jaws, JawsKind, POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE, ToolGrip, VGrip, preprocess::LIMIT_TICKS,
    state::State, tables::TABLES,
};
use crate::coverage::Coverage;

/// Fingers that air moves at one speed, and a potentiometer.
#[derive(Clone, Debug)]
struct Fingers {
    /// True opening, in.
    opening: f64,
    /// Ends of the way, in.
    ends: (f64, f64),
    /// in/s.
    speed: f64,
    /// Something that keeps the fingers from closing further, in.
    object: Option<f64>,
    /// Greatest noise of the potentiometer, counts.
    noise: u16,
    random: u32,
}

impl Fingers {
    fn new<K: JawsKind>(opening: f64) -> Self {
        let ends = (K::PARAMETERS.closed, K::PARAMETERS.opened);
        Self { opening, ends, speed: 3.0, object: None, noise: 1, random: 1987 }
    }

    fn advance(&mut self, air: JawValves) {
        let way = match (air.open, air.close) {
            (true, false) => self.speed * TICK_S,
            (false, true) => -self.speed * TICK_S,
            _ => return,
        };
        let least = self.object.filter(|size| *size <= self.opening).unwrap_or(self.ends.0);
        self.opening = (self.opening + way).clamp(least, self.ends.1);
    }

    fn counts(&mut self) -> u16 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = f64::from(self.random >> 16) / 65_536.0 * 2.0 - 1.0;
        (POTENTIOMETER_OFFSET + POTENTIOMETER_SCALE * self.opening + f64::from(self.noise) * noise).round()
            as u16
    }
}

/// One of the two processes, its command and output buffers, a gripper, and what was seen.
struct Bench<K> {
    process: Jaws<K>,
    command: JawsCommand,
    outputs: JawsOutputs,
    external: ExternalInputs,
    fingers: Fingers,
    tick: Tick,
    rows: Coverage,
}

/// Where the processes have their command buffers, for writing.
fn memory_with<K: JawsKind>(command: JawsCommand) -> CommonMemory {
    let mut memory = CommonMemory::default();
    match K::PARAMETERS.end_effector_id {
        2 => memory.emove.v_grip = command,
        _ => memory.emove.tool_grip = command,
    }
    memory
}

impl<K: JawsKind + Default> Bench<K> {
    /// A bench with the gripper attached, after a tick in which nothing was commanded.
    fn new(opening: f64) -> Self {
        let mut bench = Self {
            process: Jaws::default(),
            command: JawsCommand::default(),
            outputs: JawsOutputs::default(),
            external: ExternalInputs::default(),
            fingers: Fingers::new::<K>(opening),
            tick: Tick::BEFORE_START,
            rows: Coverage::default(),
        };
        bench.attach(true);
        bench.step();
        bench
    }

    fn attach(&mut self, locked: bool) {
        let end_effector_id = if locked { K::PARAMETERS.end_effector_id } else { 0 };
        self.external.devices.quick_change =
            QuickChangeSensors { locked, unlocked: !locked, end_effector_id };
    }

    fn send(&mut self, command: JawsVerb, size: f64) {
        let number = self.command.number + 1;
        self.command = JawsCommand { number, command, size: hundredths(size), ..JawsCommand::default() };
    }

    fn step(&mut self) -> JawsOutputs {
        self.tick = self.tick.next();
        let attached = self.external.devices.quick_change.locked;
        self.external.devices.grip.potentiometer = if attached { self.fingers.counts() } else { 0 };
        let memory = memory_with::<K>(self.command);
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &self.external, data: &() };
        self.process.step(&inputs, &mut self.outputs);
        let JawValves { open, close } = self.outputs.valves;
        assert!(!(open && close), "air to both sides");
        assert!(attached || !(open || close), "air without a gripper");
        assert_eq!((self.outputs.status.left_force, self.outputs.status.right_force), (0, 0));
        self.rows.note(&self.outputs.header);
        self.fingers.advance(self.outputs.valves);
        self.outputs
    }

    fn wait(&mut self, ticks: u32) -> JawsOutputs {
        (0..ticks).for_each(|_| {
            self.step();
        });
        self.outputs
    }

    /// Ticks in which the process is dormant: its outputs are republished.
    fn sleep(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick = self.tick.next();
            self.outputs.header.stamp = self.tick;
            self.outputs.header.republished = true;
        }
    }

    /// Command, and step until the command has ended.
    fn execute(&mut self, command: JawsVerb, size: f64) -> (JawsReport, Reason) {
        self.send(command, size);
        self.finish()
    }

    fn finish(&mut self) -> (JawsReport, Reason) {
        for _ in 0..=LIMIT_TICKS + 2 {
            let status = self.step().status;
            assert_eq!(status.echo, self.command.number);
            if status.report != JawsReport::Executing {
                return (status.report, status.reason);
            }
        }
        panic!("no end at tick {}: {:?}", self.tick, self.process.state);
    }
}

type VBench = Bench<super::CylindricalPartGripper>;
type ToolBench = Bench<super::ToolGripper>;

const CLOSED: (JawsReport, Reason) = (JawsReport::Closed, Reason::None);
const OPENED: (JawsReport, Reason) = (JawsReport::Opened, Reason::None);

#[test]
fn the_two_processes_differ_in_name_id_and_way() {
    assert_eq!((<VGrip as Process<()>>::NAME, <ToolGrip as Process<()>>::NAME), ("V-Grip", "Tool-Grip"));
    let mut v = VBench::new(2.0);
    let mut tool = ToolBench::new(2.0);
    assert_eq!((v.execute(JawsVerb::Grasp, 0.0), v.outputs.status.size), (CLOSED, 50));
    assert_eq!((tool.execute(JawsVerb::Grasp, 0.0), tool.outputs.status.size), (CLOSED, 100));
    assert_eq!((v.execute(JawsVerb::Release, 0.0), v.outputs.status.size), (OPENED, 350));
    assert_eq!((tool.execute(JawsVerb::Release, 0.0), tool.outputs.status.size), (OPENED, 400));
    tool.external.devices.quick_change.end_effector_id = 2;
    assert_eq!(tool.execute(JawsVerb::Grasp, 0.0), (JawsReport::Stuck, Reason::WrongGripper));
}

/// VI.4.2: which status a command ends with, wherever its fingers stop.
#[test]
fn every_command_reports_where_its_fingers_stopped() {
    use JawsReport::{AtPosition, Closed, Opened, Stuck};
    use JawsVerb::{Grasp, Pause, Pose, Release};
    // Fingers that no air moves stay where they are put: closed, between, opened.
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
        bench.fingers.speed = 0.0;
        assert_eq!(bench.execute(verb, size), (expected, reason), "{verb} {size} at {place}");
        assert_eq!(bench.wait(30).status.report, expected, "it stays until the next command");
    }
}

#[test]
fn what_is_held_is_felt_whatever_was_commanded() {
    let mut bench = VBench::new(2.0);
    let felt: Vec<_> = (0..5).map(|_| bench.step().status.felt).collect();
    assert_eq!(felt, [Felt::NotKnown, Felt::NotKnown, Felt::NotKnown, Felt::NotKnown, Felt::Something]);
    bench.fingers.object = Some(2.0);
    for (verb, felt) in [(JawsVerb::Release, Felt::Nothing), (JawsVerb::Grasp, Felt::Something)] {
        bench.send(verb, 0.0);
        assert_eq!(bench.wait(8).status.felt, Felt::NotKnown, "they move");
        bench.finish();
        assert_eq!(bench.outputs.status.felt, felt, "{verb}");
        bench.execute(JawsVerb::Pause, 0.0);
        assert_eq!(bench.outputs.status.felt, felt, "the report does not count");
    }
    bench.fingers.object = None;
    assert_eq!(bench.wait(40).status.felt, Felt::Nothing, "it was lost");
    for (dead, felt) in [(-0.3, Felt::NotKnown), (6.0, Felt::NotKnown)] {
        bench.fingers.ends = (dead, dead);
        bench.fingers.opening = dead;
        assert_eq!(bench.wait(20).status.felt, felt, "a potentiometer at {dead}");
    }
    bench.attach(false);
    assert_eq!(bench.step().status.felt, Felt::NotKnown);
}

#[test]
fn open_fingers_that_are_told_to_close_do_not_count_as_empty() {
    let mut bench = VBench::new(3.5);
    assert_eq!(bench.wait(20).status.felt, Felt::Nothing);
    bench.fingers.speed = 0.0;
    assert_eq!(bench.execute(JawsVerb::Grasp, 0.0).0, JawsReport::Opened);
    assert_eq!(bench.wait(20).status.felt, Felt::NotKnown, "there is no air");
    (bench.fingers.speed, bench.fingers.object) = (3.0, Some(2.0));
    assert_eq!(bench.wait(100).status.felt, Felt::Something, "the air is back");
}

#[test]
fn an_object_is_pressed_until_it_is_released() {
    let mut bench = VBench::new(3.5);
    bench.fingers.object = Some(2.0);
    assert_eq!(bench.execute(JawsVerb::Grasp, 1.95), CLOSED);
    assert_eq!((bench.outputs.status.size, bench.outputs.valves.close), (200, true));
    // The commander says nothing about the size: it is still the one that was commanded last.
    assert_eq!(bench.execute(JawsVerb::Pause, 0.0), (JawsReport::AtPosition, Reason::None));
    assert!(bench.wait(100).valves.close, "still pressed");
    bench.fingers.object = None;
    assert_eq!(bench.wait(30).status.size, 50, "what slips out is seen in the size");
    assert_eq!(bench.execute(JawsVerb::Release, 0.0), OPENED);
    assert!(bench.outputs.valves.open && !bench.outputs.valves.close);
}

/// The air may fail when the fingers touch the object, and come back: until they press it, it is not grasped.
#[test]
fn fingers_that_closed_on_something_have_grasped_it_when_they_have_stood_for_a_second() {
    let mut bench = VBench::new(3.5);
    bench.fingers.object = Some(2.0);
    bench.send(JawsVerb::Grasp, 2.0);
    while bench.fingers.opening > 2.0 {
        bench.step();
    }
    let arrived = bench.tick;
    assert_eq!(bench.wait(24).status.felt, Felt::NotKnown);
    bench.send(JawsVerb::Pause, 0.0);
    assert_eq!(
        (bench.finish(), bench.outputs.status.felt),
        ((JawsReport::AtPosition, Reason::None), Felt::Something)
    );
    assert!((25..=30).contains(&bench.tick.since(arrived)), "{}", bench.tick.since(arrived));
    bench.fingers.object = None;
    bench.wait(30);
    let empty = bench.tick;
    assert_eq!((bench.execute(JawsVerb::Grasp, 2.0), bench.tick.since(empty) < 5), (CLOSED, true));
}

#[test]
fn the_way_of_the_fingers_is_reported_as_executing_with_its_velocity() {
    let mut bench = ToolBench::new(4.0);
    bench.send(JawsVerb::Grasp, 0.0);
    let status = bench.wait(8).status;
    assert_eq!(status.report, JawsReport::Executing);
    assert!((-320..=-280).contains(&status.velocity), "{}", status.velocity);
    bench.send(JawsVerb::Pause, 0.0);
    let outputs = bench.step();
    assert_eq!(
        (outputs.status.report, outputs.valves.close),
        (JawsReport::Executing, true),
        "PAUSE waits too"
    );
    assert_eq!(bench.finish(), CLOSED);
    assert_eq!(bench.outputs.status.velocity.abs() / 10, 0);
}

#[test]
fn a_potentiometer_that_never_rests_or_reads_nonsense_is_not_believed() {
    let mut bench = VBench::new(2.0);
    bench.fingers.noise = 60;
    assert_eq!(bench.execute(JawsVerb::Grasp, 0.0), (JawsReport::Stuck, Reason::JawsStuck));
    assert_eq!(bench.outputs.valves, JawValves::default());
    bench.fingers.noise = 0;
    for dead in [-0.3, 6.0] {
        bench.fingers.ends = (dead, dead);
        bench.fingers.opening = dead;
        assert_eq!(bench.execute(JawsVerb::Release, 0.0), (JawsReport::Stuck, Reason::JawsStuck), "{dead}");
    }
}

#[test]
fn without_the_gripper_commands_fail_and_there_is_no_air() {
    let mut bench = VBench::new(3.5);
    bench.send(JawsVerb::Grasp, 0.0);
    bench.wait(3);
    bench.attach(false);
    assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::WrongGripper));
    assert_eq!(bench.execute(JawsVerb::Release, 0.0), (JawsReport::Stuck, Reason::WrongGripper));
    assert_eq!(bench.execute(JawsVerb::Pause, 0.0), (JawsReport::Idle, Reason::None));
    assert_eq!(bench.execute(JawsVerb::None, 0.0), (JawsReport::Stuck, Reason::UnknownCommand));
    bench.attach(true);
    bench.external.devices.quick_change.unlocked = true;
    assert_eq!(bench.execute(JawsVerb::Grasp, 0.0), (JawsReport::Stuck, Reason::WrongGripper));
    bench.attach(true);
    bench.send(JawsVerb::Grasp, 0.0);
    bench.command.end_effector_id = Some(3);
    assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::WrongGripper), "meant for another gripper");
}

/// A part in the fingers is pressed while the id pins have no contact, and while the process is restarted.
#[test]
fn the_air_stays_on_without_the_id_and_after_a_restart() {
    for id in [0, 7] {
        let mut bench = VBench::new(3.5);
        bench.fingers.object = Some(2.0);
        bench.send(JawsVerb::Grasp, 1.95);
        bench.wait(3);
        bench.external.devices.quick_change.end_effector_id = id;
        assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::WrongGripper));
        assert!(bench.wait(30).valves.close, "id {id}");
        bench.process = Jaws::default();
        assert!(bench.wait(2).valves.close, "id {id}, restarted");
        bench.attach(true);
        bench.wait(2);
        assert_eq!(bench.execute(JawsVerb::Grasp, 1.95), CLOSED);
        bench.external.devices.quick_change.end_effector_id = 3;
        assert!(!bench.step().valves.close, "another gripper");
    }
}

#[test]
fn a_process_that_starts_or_wakes_adopts_the_command_and_gives_no_air() {
    let mut bench = VBench::new(3.5);
    assert_eq!(bench.execute(JawsVerb::Release, 0.0), OPENED);
    bench.attach(false);
    bench.wait(2);
    bench.sleep(20);
    bench.send(JawsVerb::Grasp, 0.0);
    bench.attach(true);
    bench.sleep(2);
    let outputs = bench.wait(30);
    assert_eq!((outputs.status.report, outputs.status.reason), (JawsReport::Stuck, Reason::Restarted));
    assert_eq!((outputs.status.echo, outputs.valves), (bench.command.number, JawValves::default()));
    assert_eq!(bench.fingers.opening, 3.5);
    assert_eq!(bench.execute(JawsVerb::Pause, 0.0), OPENED);
    bench.send(JawsVerb::Grasp, 0.0);
    bench.process = Jaws::default();
    assert_eq!(bench.finish(), (JawsReport::Stuck, Reason::Restarted));
    assert_eq!(bench.fingers.opening, 3.5);
    let mut fresh = VBench::new(2.0);
    fresh.sleep(10);
    assert_eq!(fresh.wait(10).status.report, JawsReport::Idle, "woken before any command");
}

#[test]
fn every_row_fires() {
    let mut bench = VBench::new(2.0);
    for verb in [JawsVerb::Grasp, JawsVerb::Release] {
        for place in [0.5, 1.5, 2.0, 3.5] {
            bench.fingers.speed = 0.0;
            bench.fingers.opening = place;
            bench.execute(verb, 2.0);
        }
        bench.fingers.speed = 3.0;
        bench.execute(verb, 2.0);
        bench.fingers.noise = 60;
        bench.execute(verb, 2.0);
        bench.fingers.noise = 1;
        bench.send(verb, 2.0);
        bench.wait(3);
        bench.attach(false);
        bench.finish();
        bench.attach(true);
    }
    bench.fingers.speed = 0.0;
    for place in [0.5, 1.5, 2.0, 3.5] {
        bench.fingers.opening = place;
        bench.wait(10);
        bench.execute(JawsVerb::Pause, 2.0);
    }
    bench.fingers.noise = 60;
    bench.execute(JawsVerb::Pause, 2.0);
    bench.attach(false);
    bench.execute(JawsVerb::Pause, 2.0);
    // ACCEPT 2, 4, 5, EXECUTE 2.
    bench.execute(JawsVerb::None, 2.0);
    bench.execute(JawsVerb::Grasp, 2.0);
    bench.send(JawsVerb::Grasp, 2.0);
    bench.command.end_effector_id = Some(3);
    bench.step();
    bench.process = Jaws::default();
    bench.step();
    assert_eq!(bench.rows.missing(TABLES), [""; 0]);
}

/// From every state, with fingers that move and with fingers that do not, with and without the gripper.
#[test]
fn every_command_ends_from_every_state_whether_the_fingers_obey_or_not() {
    let mut ends = [0; 2];
    for step in super::tables::Step::ALL {
        for (open, close) in [(false, false), (true, false), (false, true)] {
            for place in [-0.3, 0.50, 1.50, 2.00, 3.50, 6.0] {
                for (attached, speed, noise) in
                    [(true, 3.0, 1), (true, 0.0, 1), (true, 3.0, 60), (false, 3.0, 1)]
                {
                    for object in [None, Some(2.0), Some(1.5)] {
                        for verb in JawsVerb::ALL {
                            let mut bench = VBench::new(place);
                            bench.attach(attached);
                            (bench.fingers.speed, bench.fingers.noise, bench.fingers.object) =
                                (speed, noise, object);
                            let state = &mut bench.process.state;
                            (state.step, state.valves) = (*step, JawValves { open, close });
                            let (report, reason) = bench.execute(*verb, 2.0);
                            assert!(
                                reason != Reason::None || report != JawsReport::Stuck,
                                "{verb} at {place}"
                            );
                            ends[usize::from(reason == Reason::None)] += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(ends.iter().all(|count| *count > 100), "failed and done: {ends:?}");
}

proptest! {
    /// Whatever is commanded and whatever the sensors read: no panic, no air both ways or without the
    /// gripper, every command ends, and the same inputs give the same bits, also after a restore.
    #[test]
    fn nonsense(ticks in prop::collection::vec((0_u8..30, any::<i32>(), any::<u8>(), any::<u16>()), 1..200)) {
        let (mut bench, mut twin) = (ToolBench::new(2.0), ToolBench::new(2.0));
        for (what, size, id, counts) in ticks {
            for bench in [&mut bench, &mut twin] {
                if let Some(verb) = JawsVerb::from_code(what) {
                    let number = bench.command.number + 1;
                    let end_effector_id = (id != 0).then_some(id);
                    bench.command =
                        JawsCommand { number, command: verb, size, end_effector_id, ..JawsCommand::default() };
                }
                match what {
                    10 => bench.process = Jaws::default(),
                    11 => bench.attach(id % 2 == 0),
                    12 => bench.fingers.opening = 1.0 + f64::from(counts) / 22_000.0,
                    13 => bench.fingers.noise = counts % 100,
                    14 => bench.sleep(3),
                    _ => {}
                }
                bench.step();
            }
            let state = *<ToolGrip as Process<()>>::state(&twin.process);
            twin.process = Jaws::default();
            Process::<()>::restore(&mut twin.process, state);
            let (one, two): ([u8; 128], [u8; 128]) = (to_bytes(&bench.outputs), to_bytes(&twin.outputs));
            prop_assert_eq!(one, two);
        }
        bench.finish();
        prop_assert!(State::SIZE < 192 && JawsOutputs::SIZE <= 128);
    }
}
