//! Prim against a model of T3I that stalls, fails and watches the order of points; in [`line`], against T3I
//! itself.

mod guarded;
mod joystick;
mod line;
mod random;
mod recovery;
mod rows;

use std::{collections::VecDeque, sync::LazyLock};

use geometry::{
    frame::{Frame, Vector, norm},
    movetable::{Movetable, MovetableLine, System, straight_down},
    pose::{Pose, WireFrame},
};
use interfaces::{
    ChangingPose, CommonMemory, ExternalInputs, Header, PrimOutputs, Reason, T3iOutputs, pose_range,
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
    t3i::{Following, LinkFault, ReportCheck, T3iReport, T3iVerb},
};
use rcs_core::{
    handshake::{Arrival, FIRST_STEP, Receiver, successor},
    name::Name10,
    tick::Tick,
};
use taskdata::{
    files::{MovtabId, MovtabRecord, PoseRecord, TaskData, TrajPara},
    load::{Source, Store},
};

use super::Prim;
use crate::coverage::Coverage;

/// Points that T3I can queue.
const QUEUE: usize = 4;

/// T3I and everything below it, as far as Prim can see.
#[derive(Default)]
struct ModelT3i {
    receiver: Receiver,
    command: T3iVerb,
    queue: VecDeque<WireFrame>,
    output: WireFrame,
    /// Ticks until the link runs.
    starting: Option<u32>,
    running: bool,
    fault: LinkFault,
    /// How each start of the link ends; the link runs then if nothing is wrong.
    broken: LinkFault,
    /// Faults that come by themselves as soon as the link runs again.
    more_faults: u32,
    /// The controller's DTR is off.
    dtr_off: bool,
    /// The robot is not where it was sent.
    elsewhere: bool,
    /// Every frame that went to the robot, without the repetitions.
    path: Vec<WireFrame>,
    /// The resolvers see this many 0.01 in beside the output.
    off: i32,
    /// No tick passes for it; its last outputs stand as they are.
    dead: bool,
    /// It is held; its last outputs are republished.
    held: bool,
    /// It reads no command, and goes on with the last one.
    deaf: bool,
    /// The robot has left its path.
    left: bool,
    /// It is off its path again after each RESTART.
    astray: bool,
}

impl ModelT3i {
    fn step(&mut self, tick: Tick, memory: &CommonMemory, stalled: bool) -> T3iOutputs {
        if self.dead {
            return memory.t3i;
        }
        if self.held {
            let header = Header { stamp: tick, republished: true, ..memory.t3i.header };
            return T3iOutputs { header, ..memory.t3i };
        }
        let command = &memory.prim.t3i;
        let expected = successor(self.receiver.echo);
        if !self.deaf && self.receiver.observe(command.number) == Arrival::New {
            self.command = command.command;
            match command.command {
                T3iVerb::Restart => {
                    (self.fault, self.running, self.starting) = (LinkFault::None, false, Some(7));
                    self.left = self.astray;
                    self.queue.clear();
                }
                T3iVerb::Point if self.fault != LinkFault::None || self.left => {}
                T3iVerb::Point => {
                    assert_eq!(command.number, expected, "a point is missing");
                    assert!(self.running, "a point before the link runs");
                    assert!(self.queue.len() < QUEUE, "the queue overruns");
                    self.queue.push_back(command.frame);
                }
                T3iVerb::Pause => {
                    self.queue.clear();
                    if self.fault == LinkFault::InvalidCommand {
                        self.fault = LinkFault::None;
                    }
                }
                T3iVerb::None => panic!("a command without a word"),
            }
        }
        if self.starting.is_some_and(|left| left == 0) {
            self.starting = None;
            self.fault = if self.dtr_off { LinkFault::NotResponding } else { self.broken };
            self.running = self.fault == LinkFault::None;
        }
        if self.running && self.more_faults > 0 {
            (self.fault, self.more_faults) = (LinkFault::Checksum, self.more_faults - 1);
        }
        self.starting = self.starting.map(|left| left - 1);
        let stalled = stalled || memory.prim.header.republished;
        if self.fault != LinkFault::None {
            self.running = false;
            self.queue.clear();
        }
        if self.left {
            self.queue.clear();
        }
        if !stalled && let Some(point) = self.queue.pop_front() {
            self.output = point;
            self.path.push(point);
        }
        self.outputs(tick)
    }

    fn outputs(&self, tick: Tick) -> T3iOutputs {
        let mut outputs =
            T3iOutputs { header: Header { stamp: tick, ..Header::default() }, ..T3iOutputs::default() };
        let status = &mut outputs.status;
        status.echo = self.receiver.echo;
        status.command = self.command;
        status.fault = self.fault;
        status.report = match self.queue.len() {
            _ if self.fault != LinkFault::None || self.left => T3iReport::Error,
            _ if self.starting.is_some() => T3iReport::Executing,
            0 => T3iReport::Finished,
            1 | 2 => T3iReport::Ready,
            _ => T3iReport::Executing,
        };
        status.following = if self.left { Following::OffPath } else { Following::OnPath };
        status.frame_feedback = self.output;
        let mut seen = self.output;
        seen.tool[0] += self.off;
        status.resolver_frame = Some(seen);
        status.link_running = self.running;
        status.controller_ready = !self.dtr_off;
        status.check = match (self.starting, self.broken) {
            (None, LinkFault::None) if self.elsewhere => ReportCheck::Elsewhere,
            (None, LinkFault::None) => ReportCheck::AsSent,
            _ => ReportCheck::NoReport,
        };
        outputs
    }
}

fn start() -> Frame {
    straight_down(Vector::new(-60.0, 0.0, -5.0))
}

fn shifted(x: f64, y: f64) -> Frame {
    Frame { position: start().position + Vector::new(x, y, 0.0), ..start() }
}

fn pose_record(name: &str, frame: Frame) -> PoseRecord {
    PoseRecord {
        name: Name10::new(name).unwrap(),
        pose: Pose::from_frame(&frame),
        movetable: MovtabId::NULL,
        frame,
    }
}

/// Sensors by name.
static SENSORS: LazyLock<Store> = LazyLock::new(|| {
    let text = "BLOCK# 1 OFFSET 21000
        -sen- NEAR-R near 1 0
        -sen- SEATED-R seated 1 0
        -sen- PUSH-X fx 0 25
        -sen- BEAM-3 beam 3 0
    ";
    let source = Source { name: "sensors.blk".to_owned(), text: text.into() };
    match Store::from_sources(vec![source]) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    }
});

/// POSE, MOVTAB and TRAJ-PARA of the tests.
struct Files {
    poses: Vec<PoseRecord>,
    movetables: Vec<MovtabRecord>,
    parameters: Vec<TrajPara>,
}

impl Files {
    fn new() -> Self {
        let up = MovetableLine { system: System::World, values: [0, 0, 300] };
        Self {
            poses: vec![
                pose_record("VIA", shifted(10.0, 0.0)),
                pose_record("END", shifted(10.0, 10.0)),
                pose_record("FAR", shifted(40.0, 3.0)),
            ],
            movetables: vec![MovtabRecord {
                name: Name10::new("UP-3").unwrap(),
                movetable: Movetable::from_lines(&[up]).unwrap(),
            }],
            parameters: vec![
                TrajPara { acc_fac: 4, vel_max: 100, smooth: 8, brk_dst: 300 },
                TrajPara { acc_fac: 4, vel_max: 0, smooth: 8, brk_dst: 300 },
            ],
        }
    }

    fn data(&self) -> TaskData<'_> {
        TaskData {
            poses: &self.poses,
            movetables: &self.movetables,
            traj_paras: &self.parameters,
            ..SENSORS.view()
        }
    }
}

/// Prim with a commander above it and the model below, with buffers by tick parity.
struct Rig {
    prim: Prim,
    t3i: ModelT3i,
    memory: CommonMemory,
    external: ExternalInputs,
    files: Files,
    tick: Tick,
    /// One in so many ticks T3I takes no point; 0 for never.
    stalls: u64,
    noise: u64,
    emove_dead: bool,
    /// Prim is not stepped; its last outputs are republished.
    held: bool,
    /// Tables and rows that fired.
    rows: Coverage,
}

impl Rig {
    fn new() -> Self {
        let mut external = ExternalInputs::default();
        external.devices.joystick.velocity = 1000;
        let t3i = ModelT3i { output: WireFrame::from_frame(&start()), ..ModelT3i::default() };
        Self {
            prim: Prim::default(),
            t3i,
            memory: CommonMemory::default(),
            external,
            files: Files::new(),
            tick: Tick::BEFORE_START,
            stalls: 0,
            noise: 1,
            emove_dead: false,
            held: false,
            rows: Coverage::default(),
        }
    }

    fn stalled(&mut self) -> bool {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 7;
        self.noise ^= self.noise << 17;
        self.stalls > 0 && self.noise.is_multiple_of(self.stalls)
    }

    fn step(&mut self) {
        self.tick = self.tick.next();
        let stalled = self.stalled();
        let data = self.files.data();
        let inputs = Inputs { tick: self.tick, memory: &self.memory, external: &self.external, data: &data };
        let mut prim: PrimOutputs = self.memory.prim;
        let recording = prim.status.recording && !self.external.devices.joystick.resume;
        if self.held || recording {
            (prim.header.stamp, prim.header.republished) = (self.tick, true);
        } else {
            self.prim.step(&inputs, &mut prim);
            self.rows.note(&prim.header);
        }
        let t3i = self.t3i.step(self.tick, &self.memory, stalled);
        self.memory.prim = prim;
        self.memory.t3i = t3i;
        if !self.emove_dead {
            self.memory.emove.header.stamp = self.tick;
        }
    }

    fn steps(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.step());
    }

    /// What E-move writes in a tick.
    fn command(&mut self, verb: PrimVerb, pose: u32) {
        let command = &mut self.memory.emove.prim;
        command.number = successor(command.number);
        command.command = verb;
        command.pose = pose;
        command.movetable = None;
        command.trajectory_parameters = 1;
    }

    /// The pose that Prim publishes under a number.
    fn pose(&self, number: Option<u32>) -> Option<&Pose> {
        self.memory.changing_pose(number?)
    }

    fn report(&self) -> PrimReport {
        self.memory.prim.status.report
    }

    /// Step until the command is answered and over.
    fn until_over(&mut self) -> PrimReport {
        for _ in 0..5000 {
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

    /// A command that watches a sensor.
    fn guard(&mut self, verb: PrimVerb, pose: u32, sensor: &str) {
        self.command(verb, pose);
        let command = &mut self.memory.emove.prim;
        (command.sensor, command.end_effector_id) = (Some(Name10::new(sensor).unwrap()), Some(1));
    }

    /// The commanded frame, without rounding.
    fn commanded(&self) -> Frame {
        self.prim.state().motion.expect("Prim commands the robot").frame()
    }

    /// Prim commands the robot, and the path has ended.
    fn at_rest(&self) -> bool {
        self.prim.state().motion.is_some_and(|motion| motion.is_at_rest())
    }

    fn initialized() -> Self {
        let mut rig = Self::new();
        rig.steps(3);
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        rig
    }

    /// The points that went to the robot never jump, and speed changes as the parameters allow.
    fn check_path(&self, from: &Frame) {
        let mut points = vec![from.position; 2];
        points.extend(self.t3i.path.iter().map(|wire| wire.to_frame().unwrap().position));
        // Rounding to 0.01 in: half a count in each of three axes at each end.
        let rounding = 0.009;
        for three in points.windows(3) {
            let (a, b) = (three[1] - three[0], three[2] - three[1]);
            assert!(norm(&b) <= 10.0 * 0.04 + 2.0 * rounding, "{b:?} in a tick");
            assert!(norm(&(b - a)) <= 10.0 * 0.0016 + 4.0 * rounding, "{a:?}, then {b:?}");
        }
    }
}

#[test]
fn starts_with_pause_and_without_a_position() {
    let mut rig = Rig::new();
    rig.steps(5);
    let out = rig.memory.prim;
    assert_eq!((out.t3i.command, out.t3i.number), (T3iVerb::Pause, FIRST_STEP));
    assert_eq!((out.status.report, out.status.present_pose), (PrimReport::Idle, None));
    assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
    assert_eq!(rig.memory.prim.t3i, out.t3i);
}

#[test]
fn robot_init_takes_the_position_over() {
    let mut rig = Rig::new();
    rig.steps(3);
    rig.command(PrimVerb::RobotInit, 0);
    rig.steps(3);
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Restart);
    assert!(rig.memory.prim.status.restarting && !rig.memory.prim.status.link_running);
    assert_eq!(rig.until_over(), PrimReport::Done);
    let status = rig.memory.prim.status;
    assert!(status.link_running && !status.restarting);
    assert_eq!(rig.pose(status.present_pose), Some(&Pose::from_frame(&start())));
    assert_eq!(rig.pose(status.sensor_pose), Some(&Pose::from_frame(&start())));
    assert_eq!(status.detected_pose, None);
}

#[test]
fn a_trajectory_ends_exactly_whatever_stalls() {
    for stalls in [0, 2, 3, 7, 50] {
        let mut rig = Rig::initialized();
        rig.stalls = stalls;
        assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
        assert!(rig.memory.prim.status.distance < 300);
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        let end = WireFrame::from_frame(&shifted(10.0, 10.0));
        assert_eq!((rig.t3i.output, rig.memory.prim.status.distance), (end, 0));
        rig.check_path(&start());
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    }
}

#[test]
fn through_point_is_not_passed_while_the_resolvers_are_far_from_it() {
    let mut rig = Rig::initialized();
    rig.t3i.off = 300;
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done, "a robot that moves follows its command");
    let mut rig = Rig::initialized();
    rig.t3i.off = 1000;
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::NotAtGoal);
}

#[test]
fn a_through_point_without_a_next_command_is_stopped_at() {
    let mut rig = Rig::initialized();
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
    rig.steps(200);
    assert_eq!(rig.t3i.output, WireFrame::from_frame(&shifted(10.0, 0.0)));
    assert_eq!(rig.report(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn pause_ramps_down_and_keeps_the_last_point() {
    for after in [1, 5, 13, 40, 60] {
        let mut rig = Rig::initialized();
        rig.stalls = 5;
        rig.command(PrimVerb::GotoPt, 3);
        rig.steps(after);
        assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
        let held = rig.memory.prim.t3i;
        rig.steps(20);
        assert_eq!((rig.memory.prim.t3i, rig.t3i.output), (held, held.frame));
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        assert_eq!(rig.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
        rig.check_path(&start());
    }
}

#[test]
fn a_goal_before_its_time_is_reached_without_a_jump() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&start());
}

#[test]
fn the_knob_stops_the_path() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(40);
    rig.external.devices.joystick.velocity = 0;
    rig.steps(60);
    let held = rig.t3i.output;
    rig.steps(60);
    assert_eq!((rig.t3i.output, rig.report()), (held, PrimReport::Executing));
    rig.external.devices.joystick.velocity = 1000;
    assert_eq!(rig.until_over(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn movetables_and_changing_poses_make_the_goal() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 1);
    rig.memory.emove.prim.movetable = Some(1);
    assert_eq!(rig.until_over(), PrimReport::Done);
    let mut goal = shifted(10.0, 0.0);
    goal.position.z += 3.0;
    assert_eq!(rig.t3i.output, WireFrame::from_frame(&goal));
    let number = pose_range::EMOVE | 5;
    rig.memory.emove.poses[1] =
        ChangingPose { number: Some(number), pose: Pose::from_frame(&shifted(4.0, 4.0)) };
    assert_eq!(rig.run(PrimVerb::GotoPt, number), PrimReport::Done);
    assert_eq!(rig.t3i.output.tool, WireFrame::from_frame(&shifted(4.0, 4.0)).tool);
}

#[test]
fn missing_records_and_bad_parameters_are_refused_and_stop_the_robot() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    assert_eq!(rig.run(PrimVerb::GotoPt, 9), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::BadRecord);
    rig.steps(100);
    assert!(rig.at_rest());
    assert_ne!(rig.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
    rig.check_path(&start());
    for (pose, movetable, parameters, reason) in [
        (pose_range::EMOVE | 77, None, 1, Reason::BadRecord),
        (1, Some(2), 1, Reason::BadRecord),
        (1, None, 0, Reason::BadRecord),
        (1, None, 2, Reason::BadParameters),
    ] {
        rig.command(PrimVerb::GoThru, pose);
        rig.memory.emove.prim.movetable = movetable;
        rig.memory.emove.prim.trajectory_parameters = parameters;
        assert_eq!(rig.until_over(), PrimReport::Error);
        assert_eq!(rig.memory.prim.status.reason, reason);
    }
    assert_eq!(rig.run(PrimVerb::None, 0), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::UnknownCommand);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
}

#[test]
fn a_silent_t3i_is_noticed() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    rig.t3i.dead = true;
    rig.steps(3);
    assert_eq!(rig.report(), PrimReport::NoRespT3i);
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Pause);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::NoRespT3i);
}

#[test]
fn a_t3i_that_does_not_echo_gets_one_point_more_and_no_other() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    rig.t3i.deaf = true;
    let number = rig.memory.prim.t3i.number;
    rig.steps(4);
    assert_eq!(rig.memory.prim.t3i.number, number + 1);
    assert_eq!(rig.until_over(), PrimReport::NoRespT3i);
}

#[test]
fn a_last_point_that_is_not_echoed_is_noticed() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 2);
    rig.steps(5);
    while !rig.at_rest() {
        rig.step();
    }
    rig.t3i.deaf = true;
    assert_eq!(rig.until_over(), PrimReport::NoRespT3i);
}

#[test]
fn a_held_t3i_is_waited_for() {
    let mut rig = Rig::initialized();
    rig.t3i.held = true;
    rig.steps(2);
    let before = rig.memory.prim.t3i;
    rig.command(PrimVerb::GotoPt, 2);
    rig.steps(20);
    assert_eq!((rig.memory.prim.t3i, rig.report()), (before, PrimReport::Executing));
    rig.t3i.held = false;
    assert_eq!(rig.until_over(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn a_point_is_sent_every_tick() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.step();
    for _ in 0..50 {
        let number = rig.memory.prim.t3i.number;
        rig.step();
        assert_eq!(rig.memory.prim.t3i.number, successor(number));
        assert_eq!(rig.memory.prim.t3i.cycle, rig.tick);
    }
}

#[test]
fn pause_is_done_when_the_resolvers_show_that_the_robot_rests() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 2);
    rig.steps(20);
    rig.command(PrimVerb::Pause, 0);
    rig.step();
    for _ in 0..20 {
        // The arm still settles: it is in another place in each tick.
        rig.t3i.off = if rig.t3i.off == 0 { 3 } else { 0 };
        rig.step();
        assert_eq!(rig.report(), PrimReport::Executing);
    }
    rig.t3i.off = 0;
    rig.steps(5);
    assert_eq!(rig.report(), PrimReport::Done);
    // A vise that closes on the part shifts the hand of a robot that pauses.
    rig.t3i.off = 6;
    rig.steps(2);
    assert_eq!(rig.report(), PrimReport::Done);
}

#[test]
fn a_robot_that_swings_through_the_goal_is_not_at_rest() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 2);
    while rig.report() != PrimReport::Error {
        rig.t3i.off = if rig.tick.0.is_multiple_of(3) { 3 } else { 0 };
        rig.step();
        assert_ne!((rig.report(), rig.memory.prim.status.echo), (PrimReport::Done, 2));
    }
    assert_eq!(rig.memory.prim.status.reason, Reason::NotAtGoal);
}

#[test]
fn without_e_move_the_robot_stops() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    rig.emove_dead = true;
    rig.steps(80);
    assert_eq!((rig.report(), rig.memory.prim.status.reason), (PrimReport::Error, Reason::NeighbourLost));
    assert!(rig.at_rest());
    assert_ne!(rig.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
    rig.check_path(&start());
}

#[test]
fn a_robot_that_does_not_arrive_is_an_error_after_two_seconds() {
    let mut rig = Rig::initialized();
    rig.t3i.off = 3;
    let before = rig.tick;
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::NotAtGoal);
    assert!(rig.tick.since(before) > 50);
    rig.t3i.off = 1;
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
}

#[test]
fn a_restarted_prim_executes_nothing() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    rig.prim = Prim::default();
    rig.steps(5);
    assert_eq!((rig.report(), rig.memory.prim.status.reason), (PrimReport::Error, Reason::Restarted));
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Pause);
    let stopped = rig.t3i.output;
    rig.steps(20);
    assert_eq!(rig.t3i.output, stopped);
}

/// Whatever is commanded whenever, points stay in order and the path has no jump.
#[test]
fn random_commands_never_make_the_robot_jump() {
    for seed in 1..=400 {
        let mut rig = Rig::initialized();
        rig.noise = seed;
        rig.stalls = 2 + seed % 9;
        for _ in 0..12 {
            rig.stalled();
            let (verb, pose) = match rig.noise % 8 {
                0 => (PrimVerb::Pause, 0),
                1 => (PrimVerb::RobotInit, 0),
                2 => (PrimVerb::GotoPt, 99),
                3..=5 => (PrimVerb::GoThru, 1 + (rig.noise >> 9) as u32 % 3),
                _ => (PrimVerb::GotoPt, 1 + (rig.noise >> 9) as u32 % 3),
            };
            rig.external.devices.joystick.velocity =
                if (rig.noise >> 20).is_multiple_of(5) { 300 } else { 1000 };
            rig.command(verb, pose);
            if (rig.noise >> 30).is_multiple_of(3) {
                rig.steps((rig.noise >> 40) as u32 % 60);
            } else {
                rig.until_over();
            }
        }
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        rig.external.devices.joystick.velocity = 1000;
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        assert_eq!(rig.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
        rig.check_path(&start());
    }
}

#[test]
fn a_restored_prim_goes_on_to_the_bit() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.steps(30);
    let state = *rig.prim.state();
    rig.prim = Prim::default();
    Process::<TaskData<'_>>::restore(&mut rig.prim, state);
    assert_eq!(rig.until_over(), PrimReport::Done);
    let restored = rig.t3i.path;
    let mut rig = Rig::initialized();
    assert_eq!(rig.run(PrimVerb::GotoPt, 3), PrimReport::Done);
    assert_eq!(rig.t3i.path, restored);
}
