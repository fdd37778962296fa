//! Prim, T3I and the controller's end of the DEPC line together, tick by tick: what one sends is what the
//! next takes.

use std::collections::VecDeque;

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs},
};
use geometry::{
    frame::{Frame, Vector, norm, rotation_by},
    kinematics::{HOME_JOINTS, T3},
};
use interfaces::{
    CommonMemory, ExternalInputs, Reason,
    device::{LinkBytes, RESOLVER_COUNTS, single_step},
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
};
use rcs_core::{handshake::successor, tick::Tick};
use taskdata::files::{TaskData, TrajPara};

use super::pose_record;
use crate::{exact_robot::Exact, prim::Prim, t3i::T3i};

/// What happens to an answer on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Answer {
    Comes,
    IsLost,
    IsDamaged,
    /// With all that follow, by so many ticks, until the line is empty.
    IsLate(usize),
}

/// The test is E-move.
struct Bench {
    prim: Prim,
    t3i: T3i,
    memory: CommonMemory,
    external: ExternalInputs,
    tick: Tick,
    controller: Controller,
    robot: Exact,
    hold: bool,
    /// The line carries nothing.
    cut: bool,
    /// What happens to the controller's answer in this tick.
    answer: Answer,
    /// Answers that come late.
    late: VecDeque<LinkBytes>,
    /// Prim is held by its switch on the joystick box.
    held: bool,
    /// Where the robot was after each tick.
    track: Vec<Vector>,
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

impl Bench {
    fn new() -> Self {
        let at = Plate::from_tool(&home(), &T3, &Plate::default()).unwrap();
        let mut bench = Self {
            prim: Prim::default(),
            t3i: T3i::default(),
            memory: CommonMemory::default(),
            external: ExternalInputs::default(),
            tick: Tick::BEFORE_START,
            controller: Controller::new(Limits::NBS),
            robot: Exact { joints: HOME_JOINTS, at },
            hold: false,
            cut: false,
            answer: Answer::Comes,
            late: VecDeque::new(),
            held: false,
            track: Vec::new(),
        };
        bench.external.devices.joystick.velocity = 1000;
        bench.external.devices.resolvers.valid = true;
        bench.cell(&LinkBytes::default(), true);
        bench.step();
        bench
    }

    fn initialized() -> Self {
        let mut bench = Self::new();
        bench.command(PrimVerb::RobotInit, 0);
        assert_eq!(bench.until_over(), PrimReport::Done);
        bench
    }

    fn cell(&mut self, tx: &LinkBytes, start: bool) {
        let hold = self.hold;
        let rx = if self.cut { LinkBytes::default() } else { *tx };
        let inputs = ControllerInputs { rx, cts: true, board: true, start, hold, ..Default::default() };
        let out = self.controller.step(&inputs, &mut self.robot);
        let mut rx = if self.cut || self.answer == Answer::IsLost { LinkBytes::default() } else { out.tx };
        match self.answer {
            Answer::IsDamaged => {
                rx.bytes.iter_mut().take(usize::from(rx.length)).for_each(|byte| *byte ^= 0x40)
            }
            Answer::IsLate(ticks) => self.late.extend(vec![LinkBytes::default(); ticks]),
            Answer::Comes | Answer::IsLost => {}
        }
        if !self.late.is_empty() {
            self.late.push_back(rx);
            rx = self.late.pop_front().unwrap_or_default();
        }
        if self.late.iter().all(|bytes| bytes.length == 0) {
            self.late.clear();
        }
        self.external.devices.link_rx = rx;
        self.external.devices.link_ready = out.dtr;
        self.external.devices.resolvers.counts = self.robot.joints.map(|angle| {
            let turns = (angle / (2.0 * std::f64::consts::PI)).rem_euclid(1.0);
            (turns * f64::from(RESOLVER_COUNTS)).round() as u32 % RESOLVER_COUNTS
        });
    }

    fn step(&mut self) {
        self.tick = self.tick.next();
        let poses = goals().map(|goal| pose_record("GOAL", goal));
        let parameters = [TrajPara { acc_fac: 4, vel_max: 100, smooth: 8, brk_dst: 300 }];
        let data = TaskData { poses: &poses, traj_paras: &parameters, ..TaskData::default() };
        let inputs = Inputs { tick: self.tick, memory: &self.memory, external: &self.external, data: &data };
        let (mut prim, mut t3i) = (self.memory.prim, self.memory.t3i);
        let suspended = prim.status.recording && !self.external.devices.joystick.resume;
        if self.held || suspended {
            (prim.header.stamp, prim.header.republished) = (self.tick, true);
        } else {
            self.prim.step(&inputs, &mut prim);
        }
        self.t3i.step(&inputs, &mut t3i);
        (self.memory.prim, self.memory.t3i) = (prim, t3i);
        self.memory.emove.header.stamp = self.tick;
        self.cell(&t3i.link_tx, false);
        self.track.push(self.robot.at.to_tool(&T3).position);
    }

    fn command(&mut self, verb: PrimVerb, pose: u32) {
        let command = &mut self.memory.emove.prim;
        command.number = successor(command.number);
        command.command = verb;
        command.pose = pose;
        command.trajectory_parameters = 1;
    }

    fn until_over(&mut self) -> PrimReport {
        for _ in 0..3000 {
            self.step();
            let status = &self.memory.prim.status;
            if status.echo == self.memory.emove.prim.number && status.report != PrimReport::Executing {
                return status.report;
            }
        }
        panic!("never over: {:#?}", self.prim.state());
    }

    fn run(&mut self, verb: PrimVerb, pose: u32) -> PrimReport {
        self.command(verb, pose);
        self.until_over()
    }

    /// How far the robot is from a goal.
    fn off(&self, goal: &Frame) -> f64 {
        self.robot.at.to_tool(&T3).distance(goal).path()
    }

    /// The robot never moves faster than the parameters say.
    fn check_track(&self) {
        for two in self.track.windows(2) {
            let step = norm(&(two[1] - two[0]));
            // The end plate is rounded to words; the tool point stands 20 in off it.
            assert!(step < 10.0 * 0.04 + 0.03, "{step} in in a tick");
        }
    }
}

#[test]
fn robot_init_brings_the_line_up_where_the_robot_is() {
    let bench = Bench::initialized();
    assert!(bench.memory.prim.status.link_running);
    assert!(bench.prim.state().motion.unwrap().frame().distance(&home()).path() < 0.05);
    assert!(bench.off(&home()) < 0.05);
}

#[test]
fn a_trajectory_is_flown_and_its_end_is_reached() {
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
fn a_held_robot_delays_the_path_and_loses_nothing() {
    let mut bench = Bench::initialized();
    bench.command(PrimVerb::GotoPt, 1);
    for tick in 0..200 {
        // Three ticks without an answer are a lost link; a hold of one or two is only a delay.
        bench.hold = tick % 9 == 0;
        bench.step();
    }
    bench.hold = false;
    assert_eq!(bench.until_over(), PrimReport::Done);
    assert!(bench.off(&goals()[0]) < 0.03);
    bench.check_track();
}

/// One answer is lost, damaged or late, in each of many ticks of a motion: it goes on and ends at its goal.
#[test]
fn a_motion_survives_an_answer_that_is_lost_damaged_or_late() {
    for answer in [Answer::IsLost, Answer::IsDamaged, Answer::IsLate(2), Answer::IsLate(5)] {
        for after in (1..46).step_by(3) {
            let mut bench = Bench::initialized();
            bench.command(PrimVerb::GotoPt, 1);
            (0..after).for_each(|_| bench.step());
            bench.answer = answer;
            bench.step();
            bench.answer = Answer::Comes;
            assert_eq!(bench.until_over(), PrimReport::Done, "{answer:?} {after}");
            assert!(bench.off(&goals()[0]) < 0.03, "{answer:?} {after}");
            bench.check_track();
            let counters = bench.memory.t3i.status.counters;
            let restarted = counters.restarts > 1;
            assert_eq!(restarted, answer != Answer::IsLate(2), "{answer:?} {after}: {counters:?}");
        }
    }
}

#[test]
fn hold_on_the_panel_only_delays_a_motion() {
    for after in [1, 10, 25, 45] {
        for held in [3, 10, 75, 400] {
            let mut bench = Bench::initialized();
            bench.command(PrimVerb::GotoPt, 1);
            (0..after).for_each(|_| bench.step());
            bench.hold = true;
            (0..held).for_each(|_| bench.step());
            assert_eq!(bench.memory.t3i.status.silent, held > 10, "{after} {held}");
            bench.hold = false;
            assert_eq!(bench.until_over(), PrimReport::Done, "{after} {held}");
            assert!(bench.off(&goals()[0]) < 0.03, "{after} {held}");
            bench.check_track();
        }
    }
}

#[test]
fn a_cut_line_is_waited_for_and_then_lost() {
    for (cut, over) in [(90, PrimReport::Done), (140, PrimReport::T3LinkOff)] {
        let mut bench = Bench::initialized();
        bench.external.devices.link_patience = Some(125);
        bench.command(PrimVerb::GotoPt, 1);
        (0..25).for_each(|_| bench.step());
        bench.cut = true;
        (0..4).for_each(|_| bench.step());
        let stopped = bench.robot.at;
        (0..cut).for_each(|_| bench.step());
        bench.cut = false;
        assert_eq!(bench.until_over(), over);
        if over != PrimReport::Done {
            assert_eq!((bench.memory.prim.status.reason, bench.robot.at), (Reason::LinkOff, stopped));
            assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done, "the next motion restarts it");
        }
        assert!(bench.off(&goals()[0]) < 0.03);
        bench.check_track();
    }
}

#[test]
fn a_robot_that_was_led_away_meanwhile_is_not_moved_before_robot_init() {
    let mut bench = Bench::initialized();
    bench.command(PrimVerb::GotoPt, 1);
    (0..25).for_each(|_| bench.step());
    bench.cut = true;
    (0..5).for_each(|_| bench.step());
    bench.robot.at.words[2] += 200;
    bench.track.clear();
    bench.cut = false;
    let led = bench.robot.at;
    assert_eq!(bench.until_over(), PrimReport::Error);
    assert_eq!((bench.memory.prim.status.reason, bench.robot.at), (Reason::RobotElsewhere, led));
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Error);
    assert_eq!((bench.memory.prim.status.reason, bench.robot.at), (Reason::RobotElsewhere, led));
    assert_eq!(bench.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done);
    bench.check_track();
}

#[test]
fn a_robot_that_lags_too_far_is_stopped_and_pause_takes_its_position_over() {
    let mut bench = Bench::initialized();
    bench.steps(30);
    bench.command(PrimVerb::GotoPt, 1);
    let frozen = bench.external.devices.resolvers.counts;
    for _ in 0..60 {
        bench.step();
        bench.external.devices.resolvers.counts = frozen;
    }
    let is_off_path = |bench: &Bench| {
        let status = bench.memory.prim.status;
        assert_eq!((status.report, status.reason), (PrimReport::Error, Reason::OffPath));
        assert!(!status.link_running && status.present_pose.is_none(), "nothing is ramped down");
    };
    is_off_path(&bench);
    let stood = bench.robot.at;
    // The limit, and the way in the expected lag and in the ticks between Prim and the line.
    assert!((0.5..2.0).contains(&bench.off(&home())), "{}", bench.off(&home()));
    // The resolvers tell the truth again: only ROBOT-INIT, which PAUSE sends, lets the robot move.
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Error);
    is_off_path(&bench);
    assert_eq!(bench.run(PrimVerb::Pause, 0), PrimReport::Error);
    is_off_path(&bench);
    assert_eq!(bench.robot.at, stood);
    assert_eq!(bench.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!((bench.robot.at, bench.memory.t3i.status.left), (stood, None));
    assert_eq!(bench.run(PrimVerb::GotoPt, 1), PrimReport::Done);
    assert!(bench.off(&goals()[0]) < 0.03);
}

#[test]
fn a_restarted_t3i_is_restarted_by_prim_in_the_middle_of_a_motion() {
    for after in [2, 30, 60] {
        let mut bench = Bench::initialized();
        bench.command(PrimVerb::GotoPt, 1);
        (0..after).for_each(|_| bench.step());
        bench.t3i = T3i::default();
        assert_eq!(bench.until_over(), PrimReport::Done, "{after}");
        assert!(bench.off(&goals()[0]) < 0.03);
        bench.check_track();
    }
}

impl Bench {
    fn steps(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.step());
    }

    fn hold_prim(&mut self, on: bool) {
        self.held = on;
        self.external.devices.joystick.hold = if on { single_step::PRIM } else { 0 };
    }

    /// Inches that the robot moved in each of the last ticks.
    fn last_ways(&self, ticks: usize) -> Vec<f64> {
        let ways: Vec<f64> = self.track.windows(2).map(|two| norm(&(two[1] - two[0]))).collect();
        ways[ways.len() - ticks..].to_vec()
    }
}

#[test]
fn a_held_prim_holds_the_robot_at_once_and_goes_on_from_rest() {
    let mut bench = Bench::initialized();
    bench.command(PrimVerb::GotoPt, 1);
    bench.steps(30);
    assert!(bench.last_ways(1)[0] > 0.2);
    bench.hold_prim(true);
    bench.steps(12);
    // The point of the tick before is still sent; then the robot stands, and the line is kept up.
    assert!(bench.last_ways(10).iter().all(|way| *way < 1e-9), "{:?}", bench.last_ways(12));
    for _ in 0..3 {
        bench.held = false;
        bench.step();
        bench.held = true;
        bench.steps(4);
        let ways = bench.last_ways(4);
        assert!(ways[0] > 0.2 && ways[1..].iter().all(|way| *way < 1e-9), "one knot point: {ways:?}");
    }
    bench.hold_prim(false);
    bench.steps(6);
    assert!(bench.last_ways(5).iter().all(|way| *way < 0.1), "{:?}", bench.last_ways(6));
    assert_eq!(bench.until_over(), PrimReport::Done);
    assert!(bench.off(&goals()[0]) < 0.03);
    bench.check_track();
    let counters = bench.memory.t3i.status.counters;
    assert_eq!((counters.naks, counters.timeouts, counters.restarts), (0, 0, 1));
}

#[test]
fn the_joystick_box_moves_the_robot_and_records_where_it_stands() {
    let mut bench = Bench::initialized();
    assert_eq!(bench.run(PrimVerb::Pause, 0), PrimReport::Done);
    for (frame, x, y) in [(1, 1000, 0), (2, 0, -1000), (4, 1000, 0), (8, 0, 1000)] {
        let joystick = &mut bench.external.devices.joystick;
        (joystick.frame, joystick.x, joystick.y) = (frame, x, y);
        bench.steps(40);
        let joystick = &mut bench.external.devices.joystick;
        (joystick.x, joystick.y) = (0, 0);
        bench.steps(40);
    }
    assert!(bench.off(&home()) > 5.0);
    bench.external.devices.joystick.record = true;
    bench.step();
    let status = bench.memory.prim.status;
    let recorded = bench.memory.changing_pose(status.recorded_pose.unwrap()).unwrap().to_frame().unwrap();
    assert!(status.recording && bench.off(&recorded) < 0.05, "{}", bench.off(&recorded));
    bench.external.devices.joystick.x = 1000;
    let at = bench.robot.at;
    bench.steps(50);
    assert_eq!(bench.robot.at, at, "suspended");
    bench.external.devices.joystick.resume = true;
    bench.steps(20);
    assert_ne!(bench.robot.at, at);
    bench.external.devices.joystick.frame = 0;
    assert_eq!(bench.run(PrimVerb::GotoPt, 3), PrimReport::Done);
    assert!(bench.off(&goals()[2]) < 0.03);
    bench.check_track();
    let counters = bench.memory.t3i.status.counters;
    assert_eq!((counters.naks, counters.timeouts, counters.restarts), (0, 0, 1));
}
