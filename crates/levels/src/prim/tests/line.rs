//! Prim, T3I and the controller's end of the DEPC line together, tick by tick.

use std::sync::LazyLock;

use geometry::{
    frame::{Frame, Vector, norm, rotation_by},
    kinematics::{HOME_JOINTS, T3},
};
use interfaces::{
    CommonMemory, ExternalInputs, Reason,
    device::single_step,
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
};
use rcs_core::tick::Tick;
use taskdata::files::{PoseRecord, TaskData};

use super::{PARAMETERS, pose_record};
use crate::{
    bench::{self, World},
    environment::line::{Answer, Line},
    prim::Prim,
    t3i::T3i,
};

pub(super) const SCENARIOS: &[fn()] = &[lagging_robot_is_stopped_and_pause_takes_its_position];

type Bench = bench::Bench<Prim, Whole, TaskData<'static>>;

struct Whole {
    t3i: T3i,
    line: Line,
    track: Vec<Vector>,
}

impl World<Prim> for Whole {
    fn act(
        &mut self,
        tick: Tick,
        memory: &CommonMemory,
        after: &mut CommonMemory,
        external: &mut ExternalInputs,
    ) {
        self.t3i.step(&Inputs { tick, memory, external, data: &() }, &mut after.t3i);
        after.emove.header.stamp = tick;
        self.line.step(&after.t3i.link_tx, &mut external.devices);
        self.track.push(self.line.robot.at.to_tool(&T3).position);
    }
}

fn home() -> Frame {
    T3.forward(&HOME_JOINTS)
}

/// Three frames around HOME that turn the tool.
fn goals() -> [Frame; 3] {
    [
        (Vector::new(8.0, 4.0, 2.0), Vector::new(0.2, 0.0, 0.1)),
        (Vector::new(-6.0, 6.0, 5.0), Vector::new(0.0, 0.25, -0.2)),
        (Vector::new(0.0, 0.0, 4.0), Vector::new(0.0, 0.0, 0.3)),
    ]
    .map(|(by, turn)| Frame {
        position: home().position + by,
        rotation: rotation_by(&turn) * home().rotation,
    })
}

static GOALS: LazyLock<[PoseRecord; 3]> = LazyLock::new(|| goals().map(|goal| pose_record("GOAL", goal)));

impl Bench {
    fn new() -> Self {
        let mut external = ExternalInputs::default();
        let line = Line::new(&mut external.devices);
        external.devices.joystick.velocity = 1000;
        let data = TaskData { poses: &*GOALS, traj_paras: &PARAMETERS[..1], ..TaskData::default() };
        let world = Whole { t3i: T3i::default(), line, track: Vec::new() };
        let mut bench = Self { external, ..Self::with(world, data) };
        bench.step();
        bench
    }

    fn initialized() -> Self {
        let mut bench = Self::new();
        assert_eq!(bench.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        bench
    }

    /// A robot that has moved towards the first goal for some ticks.
    fn going(ticks: u32) -> Self {
        let mut bench = Self::initialized();
        bench.command(PrimVerb::GotoPt, 1);
        bench.wait(ticks);
        bench
    }

    fn off(&self, goal: &Frame) -> f64 {
        self.world.line.robot.at.to_tool(&T3).distance(goal).path()
    }

    /// The robot never moves faster than the parameters allow.
    fn check_track(&self) {
        for two in self.world.track.windows(2) {
            let step = norm(&(two[1] - two[0]));
            // The end plate is rounded to words; the tool point is 20 in from it.
            assert!(step < 10.0 * 0.04 + 0.03, "{step} in per tick");
        }
    }

    /// The command continues and ends at the first goal.
    fn arrives(&mut self, case: &str) {
        assert_eq!(self.finish(), PrimReport::Done, "{case}");
        assert!(self.off(&goals()[0]) < 0.03, "{case}");
        self.check_track();
    }

    fn hold_prim(&mut self, on: bool) {
        self.held = on;
        self.external.devices.joystick.hold = if on { single_step::PRIM } else { 0 };
    }

    fn last_ways(&self, ticks: usize) -> Vec<f64> {
        let ways: Vec<f64> = self.world.track.windows(2).map(|two| norm(&(two[1] - two[0]))).collect();
        ways[ways.len() - ticks..].to_vec()
    }
}

#[test]
fn robot_init_starts_the_line_at_the_robot_position() {
    let bench = Bench::initialized();
    assert!(bench.memory.prim.status.link_running);
    assert!(bench.process.state().motion.unwrap().frame().distance(&home()).path() < 0.05);
    assert!(bench.off(&home()) < 0.05);
}

#[test]
fn trajectory_reaches_its_end() {
    let mut bench = Bench::initialized();
    for _ in 0..3 {
        assert_eq!(bench.run(PrimVerb::GoThru, 1), PrimReport::Done);
        assert_eq!(bench.run(PrimVerb::GoThru, 2), PrimReport::Done);
        assert_eq!(bench.run(PrimVerb::GotoPt, 3), PrimReport::Done);
        assert!(bench.off(&goals()[2]) < 0.03, "{}", bench.off(&goals()[2]));
    }
    bench.check_track();
    let counters = bench.memory.t3i.status.counters;
    assert_eq!((counters.naks, counters.timeouts, counters.restarts), (0, 0, 1));
}

#[test]
fn held_robot_only_delays_the_path() {
    let mut bench = Bench::initialized();
    bench.command(PrimVerb::GotoPt, 1);
    for tick in 0..200 {
        // Three ticks without an answer are a lost link; a hold of one or two is only a delay.
        bench.world.line.hold = tick % 9 == 0;
        bench.step();
    }
    bench.world.line.hold = false;
    bench.arrives("");
}

/// One answer is lost, damaged or late, in each of many ticks of a motion; the motion ends at its goal.
#[test]
fn motion_survives_a_lost_damaged_or_late_answer() {
    for answer in [Answer::IsLost, Answer::IsDamaged, Answer::IsLate(2), Answer::IsLate(5)] {
        for after in (1..46).step_by(3) {
            let mut bench = Bench::going(after);
            bench.world.line.answer = answer;
            bench.step();
            bench.world.line.answer = Answer::Comes;
            bench.arrives(&format!("{answer:?} {after}"));
            let counters = bench.memory.t3i.status.counters;
            let restarted = counters.restarts > 1;
            assert_eq!(restarted, answer != Answer::IsLate(2), "{answer:?} {after}: {counters:?}");
        }
    }
}

#[test]
fn panel_hold_only_delays_a_motion() {
    for after in [1, 10, 25, 45] {
        for held in [3, 10, 75, 400] {
            let mut bench = Bench::going(after);
            bench.world.line.hold = true;
            bench.wait(held);
            assert_eq!(bench.memory.t3i.status.silent, held > 10, "{after} {held}");
            bench.world.line.hold = false;
            bench.arrives(&format!("{after} {held}"));
        }
    }
}

#[test]
fn cut_line_is_lost_after_a_wait() {
    for (cut, over) in [(90, PrimReport::Done), (140, PrimReport::T3LinkOff)] {
        let mut bench = Bench::initialized();
        bench.external.devices.link_patience = Some(125);
        bench.command(PrimVerb::GotoPt, 1);
        bench.wait(25);
        bench.world.line.connected = false;
        bench.wait(4);
        let stopped = bench.world.line.robot.at;
        bench.wait(cut);
        bench.world.line.connected = true;
        assert_eq!(bench.finish(), over);
        if over != PrimReport::Done {
            assert_eq!(
                (bench.memory.prim.status.reason, bench.world.line.robot.at),
                (Reason::LinkOff, stopped)
            );
            assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done, "the next motion restarts it");
        }
        assert!(bench.off(&goals()[0]) < 0.03);
        bench.check_track();
    }
}

#[test]
fn robot_moved_by_hand_waits_for_robot_init() {
    let mut bench = Bench::going(25);
    bench.world.line.connected = false;
    bench.wait(5);
    bench.world.line.robot.at.words[2] += 200;
    bench.world.track.clear();
    bench.world.line.connected = true;
    let led = bench.world.line.robot.at;
    assert_eq!(bench.finish(), PrimReport::Error);
    assert_eq!((bench.memory.prim.status.reason, bench.world.line.robot.at), (Reason::RobotElsewhere, led));
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Error);
    assert_eq!((bench.memory.prim.status.reason, bench.world.line.robot.at), (Reason::RobotElsewhere, led));
    assert_eq!(bench.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done);
    bench.check_track();
}

#[test]
fn lagging_robot_is_stopped_and_pause_takes_its_position() {
    let mut bench = Bench::initialized();
    bench.wait(30);
    bench.command(PrimVerb::GotoPt, 1);
    let frozen = bench.external.devices.resolvers.counts;
    for _ in 0..60 {
        bench.step();
        bench.external.devices.resolvers.counts = frozen;
    }
    let is_off_path = |bench: &Bench| {
        let status = bench.memory.prim.status;
        assert_eq!((status.report, status.reason), (PrimReport::Error, Reason::OffPath));
        assert!(!status.link_running && status.present_pose.is_none(), "no ramp");
    };
    is_off_path(&bench);
    let stood = bench.world.line.robot.at;
    // The robot is off by the limit, plus its path in the expected lag and in the ticks between Prim and the line.
    assert!((0.5..2.0).contains(&bench.off(&home())), "{}", bench.off(&home()));
    // The resolvers are correct again, but only ROBOT-INIT permits motion.
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Error);
    is_off_path(&bench);
    assert_eq!(bench.run(PrimVerb::Pause, 0), PrimReport::Error);
    is_off_path(&bench);
    assert_eq!(bench.world.line.robot.at, stood);
    assert_eq!(bench.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!((bench.world.line.robot.at, bench.memory.t3i.status.left), (stood, None));
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done);
    assert!(bench.off(&goals()[0]) < 0.03);
}

#[test]
fn prim_restarts_the_link_of_a_restarted_t3i_in_motion() {
    for after in [2, 30, 60] {
        let mut bench = Bench::going(after);
        bench.world.t3i = T3i::default();
        bench.arrives(&format!("{after}"));
    }
}

#[test]
fn held_prim_stops_the_robot_and_resumes_from_rest() {
    let mut bench = Bench::initialized();
    bench.command(PrimVerb::GotoPt, 1);
    bench.wait(30);
    assert!(bench.last_ways(1)[0] > 0.2);
    bench.hold_prim(true);
    bench.wait(12);
    // The point of the previous tick is still sent; then the robot rests, and the line stays up.
    assert!(bench.last_ways(10).iter().all(|way| *way < 1e-9), "{:?}", bench.last_ways(12));
    for _ in 0..3 {
        bench.held = false;
        bench.step();
        bench.held = true;
        bench.wait(4);
        let ways = bench.last_ways(4);
        assert!(ways[0] > 0.2 && ways[1..].iter().all(|way| *way < 1e-9), "one knot point: {ways:?}");
    }
    bench.hold_prim(false);
    bench.wait(6);
    assert!(bench.last_ways(5).iter().all(|way| *way < 0.1), "{:?}", bench.last_ways(6));
    bench.arrives("");
    let counters = bench.memory.t3i.status.counters;
    assert_eq!((counters.naks, counters.timeouts, counters.restarts), (0, 0, 1));
}

#[test]
fn joystick_box_moves_the_robot_and_records_its_pose() {
    let mut bench = Bench::initialized();
    assert_eq!(bench.run(PrimVerb::Pause, 0), PrimReport::Done);
    for (frame, x, y) in [(1, 1000, 0), (2, 0, -1000), (4, 1000, 0), (8, 0, 1000)] {
        let joystick = &mut bench.external.devices.joystick;
        (joystick.frame, joystick.x, joystick.y) = (frame, x, y);
        bench.wait(40);
        let joystick = &mut bench.external.devices.joystick;
        (joystick.x, joystick.y) = (0, 0);
        bench.wait(40);
    }
    assert!(bench.off(&home()) > 5.0);
    bench.external.devices.joystick.record = true;
    bench.step();
    let status = bench.memory.prim.status;
    let recorded = bench.memory.changing_pose(status.recorded_pose.unwrap()).unwrap().to_frame().unwrap();
    assert!(status.recording && bench.off(&recorded) < 0.05, "{}", bench.off(&recorded));
    bench.external.devices.joystick.x = 1000;
    let at = bench.world.line.robot.at;
    bench.wait(50);
    assert_eq!(bench.world.line.robot.at, at, "suspended");
    bench.external.devices.joystick.resume = true;
    bench.wait(20);
    assert_ne!(bench.world.line.robot.at, at);
    bench.external.devices.joystick.frame = 0;
    assert_eq!(bench.run(PrimVerb::GotoPt, 3), PrimReport::Done);
    assert!(bench.off(&goals()[2]) < 0.03);
    bench.check_track();
    let counters = bench.memory.t3i.status.counters;
    assert_eq!((counters.naks, counters.timeouts, counters.restarts), (0, 0, 1));
}
