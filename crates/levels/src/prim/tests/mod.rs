//! Tests Prim against a model of T3I that stalls, fails and checks the order of points, and in [`line`] against T3I.

mod guarded;
mod joystick;
mod line;
mod random;
mod recovery;

use std::sync::LazyLock;

use geometry::{
    frame::{Frame, Vector, norm},
    movetable::{Movetable, MovetableLine, System, straight_down},
    pose::{Pose, WireFrame},
};
use interfaces::{
    ChangingPose, CommonMemory, ExternalInputs, PrimOutputs, Reason,
    device::{ForceSensor, GroupHealth},
    pose_range,
    prim::{PrimCommand, PrimReport, PrimStatus, PrimVerb},
    process::Process,
    t3i::{LinkFault, T3iVerb},
};
use rcs_core::{
    handshake::{FIRST_STEP, successor},
    name::Name10,
    tick::Tick,
};
use taskdata::{
    files::{MovtabId, MovtabRecord, PoseRecord, TaskData, TrajPara, TrajParaId},
    load::{Source, Store},
};

use super::Prim;
use crate::{
    bench::{self, Tested, World},
    coverage::silent,
    environment::t3i::ModelT3i,
};

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

static FILES: LazyLock<(Vec<PoseRecord>, Vec<MovtabRecord>)> = LazyLock::new(|| {
    let up = MovetableLine { system: System::World, values: [0, 0, 300] };
    let poses = vec![
        pose_record("VIA", shifted(10.0, 0.0)),
        pose_record("END", shifted(10.0, 10.0)),
        pose_record("FAR", shifted(40.0, 3.0)),
    ];
    let movetable = Movetable::from_lines(&[up]).unwrap();
    (poses, vec![MovtabRecord { name: Name10::new("UP-3").unwrap(), movetable }])
});
static PARAMETERS: [TrajPara; 4] = [
    TrajPara { acc_fac: 4, vel_max: 100, smooth: 8, brk_dst: 300 },
    TrajPara { acc_fac: 4, vel_max: 0, smooth: 8, brk_dst: 300 },
    TrajPara { acc_fac: 4, vel_max: 30, smooth: 4, brk_dst: 0 },
    TrajPara { acc_fac: 4, vel_max: 60, smooth: 40, brk_dst: 0 },
];

fn data() -> TaskData<'static> {
    let (poses, movetables) = &*FILES;
    TaskData { poses, movetables, traj_paras: &PARAMETERS, ..SENSORS.view() }
}

type Rig = bench::Bench<Prim, Below, TaskData<'static>>;

#[derive(Clone)]
struct Below {
    t3i: ModelT3i,
    /// T3I takes no point in one of this many ticks; 0 for never.
    stalls: u64,
    noise: u64,
    emove_dead: bool,
}

impl Below {
    fn stalled(&mut self) -> bool {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 7;
        self.noise ^= self.noise << 17;
        self.stalls > 0 && self.noise.is_multiple_of(self.stalls)
    }
}

impl World<Prim> for Below {
    fn act(&mut self, tick: Tick, before: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        let stalled = self.stalled();
        after.t3i = self.t3i.step(tick, before, stalled);
        if !self.emove_dead {
            after.emove.header.stamp = tick;
        }
    }
}

impl<'d> Tested<TaskData<'d>> for Prim {
    type Order = PrimCommand;
    type End = PrimReport;
    const LONGEST: u64 = 5000;

    fn order(memory: &mut CommonMemory, order: PrimCommand, number: u32) {
        memory.emove.prim = PrimCommand { number, ..order };
    }

    fn end(outputs: &PrimOutputs) -> Option<PrimReport> {
        Some(outputs.status.report).filter(|report| *report != PrimReport::Executing)
    }

    fn is_suspended(outputs: &PrimOutputs, external: &ExternalInputs) -> bool {
        outputs.status.recording && !external.devices.joystick.resume
    }
}

impl<W: World<Prim>> bench::Bench<Prim, W, TaskData<'static>> {
    fn command(&mut self, command: PrimVerb, pose: u32) {
        let before = self.memory.emove.prim;
        self.send(PrimCommand {
            command,
            pose,
            movetable: MovtabId::NULL,
            trajectory_parameters: TrajParaId::new(1),
            ..before
        });
    }

    fn run(&mut self, verb: PrimVerb, pose: u32) -> PrimReport {
        self.command(verb, pose);
        self.finish()
    }
}

impl Rig {
    fn new() -> Self {
        let t3i = ModelT3i { output: WireFrame::from_frame(&start()), ..ModelT3i::default() };
        let mut rig = Self::with(Below { t3i, stalls: 0, noise: 1, emove_dead: false }, data());
        rig.external.devices.joystick.velocity = 1000;
        rig
    }

    fn pose(&self, number: Option<u32>) -> Option<&Pose> {
        self.memory.changing_pose(number?)
    }

    fn report(&self) -> PrimReport {
        self.memory.prim.status.report
    }

    fn guard(&mut self, verb: PrimVerb, pose: u32, sensor: &str) {
        self.command(verb, pose);
        let command = &mut self.memory.emove.prim;
        (command.sensor, command.end_effector_id) = (Some(Name10::new(sensor).unwrap()), Some(1));
    }

    fn commanded(&self) -> Frame {
        self.process.state().motion.expect("Prim commands the robot").frame()
    }

    fn at_rest(&self) -> bool {
        self.process.state().motion.is_some_and(|motion| motion.is_at_rest())
    }

    fn initialized() -> Self {
        let mut rig = Self::new();
        rig.wait(3);
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        rig
    }

    /// The sent points never jump, and speed changes as the parameters allow.
    fn check_path(&self, from: &Frame) {
        let mut points = vec![from.position; 2];
        points.extend(self.world.t3i.path.iter().map(|wire| wire.to_frame().unwrap().position));
        // Rounding to 0.01 in: half a count in each of three axes at each end.
        let rounding = 0.009;
        for three in points.windows(3) {
            let (a, b) = (three[1] - three[0], three[2] - three[1]);
            assert!(norm(&b) <= 10.0 * 0.04 + 2.0 * rounding, "{b:?} per tick");
            assert!(norm(&(b - a)) <= 10.0 * 0.0016 + 4.0 * rounding, "{a:?}, then {b:?}");
        }
    }
}

#[test]
fn starting_prim_sends_pause_and_has_no_position() {
    let mut rig = Rig::new();
    rig.wait(5);
    let out = rig.memory.prim;
    assert_eq!((out.t3i.command, out.t3i.number), (T3iVerb::Pause, FIRST_STEP));
    assert_eq!((out.status.report, out.status.present_pose), (PrimReport::Idle, None));
    assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
    assert_eq!(rig.memory.prim.t3i, out.t3i);
}

#[test]
fn robot_init_takes_over_the_position() {
    let mut rig = Rig::new();
    rig.wait(3);
    rig.command(PrimVerb::RobotInit, 0);
    rig.wait(3);
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Restart);
    assert!(rig.memory.prim.status.restarting && !rig.memory.prim.status.link_running);
    assert_eq!(rig.finish(), PrimReport::Done);
    let status = rig.memory.prim.status;
    assert!(status.link_running && !status.restarting);
    assert_eq!(rig.pose(status.present_pose), Some(&Pose::from_frame(&start())));
    assert_eq!(rig.pose(status.sensor_pose), Some(&Pose::from_frame(&start())));
    assert_eq!(status.detected_pose, None);
}

#[test]
fn stalled_trajectory_ends_exactly() {
    for stalls in [0, 2, 3, 7, 50] {
        let mut rig = Rig::initialized();
        rig.world.stalls = stalls;
        assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
        assert!(rig.memory.prim.status.distance < 300);
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        let end = WireFrame::from_frame(&shifted(10.0, 10.0));
        assert_eq!((rig.world.t3i.output, rig.memory.prim.status.distance), (end, 0));
        rig.check_path(&start());
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    }
}

#[test]
fn through_point_is_not_passed_while_the_resolvers_are_far_from_it() {
    let mut rig = Rig::initialized();
    rig.world.t3i.off = 300;
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done, "a moving robot follows its command");
    let mut rig = Rig::initialized();
    rig.world.t3i.off = 1000;
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::NotAtGoal);
}

#[test]
fn through_point_without_a_next_command_stops_the_robot() {
    let mut rig = Rig::initialized();
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
    rig.wait(200);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 0.0)));
    assert_eq!(rig.report(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn pause_ramps_down_and_repeats_the_last_point() {
    for after in [1, 5, 13, 40, 60] {
        let mut rig = Rig::initialized();
        rig.world.stalls = 5;
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(after);
        assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
        let held = rig.memory.prim.t3i;
        rig.wait(20);
        assert_eq!((rig.memory.prim.t3i, rig.world.t3i.output), (held, held.frame));
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
        rig.check_path(&start());
    }
}

#[test]
fn early_goal_is_reached_without_a_jump() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&start());
}

#[test]
fn knob_at_zero_stops_the_path() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(40);
    rig.external.devices.joystick.velocity = 0;
    rig.wait(60);
    let held = rig.world.t3i.output;
    rig.wait(60);
    assert_eq!((rig.world.t3i.output, rig.report()), (held, PrimReport::Executing));
    rig.external.devices.joystick.velocity = 1000;
    assert_eq!(rig.finish(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn goal_is_a_changing_pose_with_its_movetable() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 1);
    rig.memory.emove.prim.movetable = MovtabId::new(1);
    assert_eq!(rig.finish(), PrimReport::Done);
    let mut goal = shifted(10.0, 0.0);
    goal.position.z += 3.0;
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&goal));
    let number = pose_range::EMOVE | 5;
    rig.memory.emove.poses[1] =
        ChangingPose { number: Some(number), pose: Pose::from_frame(&shifted(4.0, 4.0)) };
    assert_eq!(rig.run(PrimVerb::GotoPt, number), PrimReport::Done);
    assert_eq!(rig.world.t3i.output.tool, WireFrame::from_frame(&shifted(4.0, 4.0)).tool);
}

#[test]
fn unusable_records_are_refused_and_stop_the_robot() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    assert_eq!(rig.run(PrimVerb::GotoPt, 9), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::BadRecord);
    rig.wait(100);
    assert!(rig.at_rest());
    assert_ne!(rig.world.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
    rig.check_path(&start());
    for (pose, movetable, parameters, reason) in [
        (pose_range::EMOVE | 77, 0, 1, Reason::BadRecord),
        (1, 2, 1, Reason::BadRecord),
        (1, 0, 0, Reason::BadRecord),
        (1, 0, 2, Reason::BadParameters),
    ] {
        rig.command(PrimVerb::GoThru, pose);
        rig.memory.emove.prim.movetable = MovtabId::new(movetable);
        rig.memory.emove.prim.trajectory_parameters = TrajParaId::new(parameters);
        assert_eq!(rig.finish(), PrimReport::Error);
        assert_eq!(rig.memory.prim.status.reason, reason);
    }
    assert_eq!(rig.run(PrimVerb::None, 0), PrimReport::Error);
    assert_eq!(rig.memory.prim.status.reason, Reason::UnknownCommand);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
}

#[test]
fn silent_t3i_is_reported() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.world.t3i.dead = true;
    rig.wait(3);
    assert_eq!(rig.report(), PrimReport::NoRespT3i);
    assert_eq!(rig.memory.prim.t3i.command, T3iVerb::Pause);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::NoRespT3i);
    let mut rig = Rig::paused();
    rig.world.t3i.dead = true;
    rig.wait(3);
    assert_eq!(rig.report(), PrimReport::NoRespT3i, "PAUSE stands");
}

#[test]
fn t3i_without_echo_gets_only_one_more_point() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.world.t3i.deaf = true;
    let number = rig.memory.prim.t3i.number;
    rig.wait(4);
    assert_eq!(rig.memory.prim.t3i.number, number + 1);
    assert_eq!(rig.finish(), PrimReport::NoRespT3i);
}

#[test]
fn unechoed_last_point_is_reported() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 2);
    rig.wait(5);
    rig.until(|rig| rig.at_rest());
    rig.world.t3i.deaf = true;
    assert_eq!(rig.finish(), PrimReport::NoRespT3i);
}

#[test]
fn prim_waits_for_a_held_t3i() {
    let mut rig = Rig::initialized();
    rig.world.t3i.held = true;
    rig.wait(2);
    let before = rig.memory.prim.t3i;
    rig.command(PrimVerb::GotoPt, 2);
    rig.wait(20);
    assert_eq!((rig.memory.prim.t3i, rig.report()), (before, PrimReport::Executing));
    rig.world.t3i.held = false;
    assert_eq!(rig.finish(), PrimReport::Done);
    rig.check_path(&start());
}

#[test]
fn one_point_is_sent_per_tick() {
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
fn pause_is_done_when_the_resolvers_show_rest() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 2);
    rig.wait(20);
    rig.command(PrimVerb::Pause, 0);
    rig.step();
    for _ in 0..20 {
        // The arm still settles: its position differs in each tick.
        rig.world.t3i.off = if rig.world.t3i.off == 0 { 3 } else { 0 };
        rig.step();
        assert_eq!(rig.report(), PrimReport::Executing);
    }
    rig.world.t3i.off = 0;
    rig.wait(5);
    assert_eq!(rig.report(), PrimReport::Done);
    // A vise that closes on the part shifts the hand of a paused robot.
    rig.world.t3i.off = 6;
    rig.wait(2);
    assert_eq!(rig.report(), PrimReport::Done);
}

/// The arm swings by 0.03 in until the command ends.
fn swing(rig: &mut Rig) -> (PrimReport, Reason) {
    for _ in 0..300 {
        rig.world.t3i.off = if rig.tick.0.is_multiple_of(3) { 3 } else { 0 };
        rig.step();
        let PrimStatus { echo, report, reason, .. } = rig.memory.prim.status;
        if echo == rig.memory.emove.prim.number && report != PrimReport::Executing {
            return (report, reason);
        }
    }
    panic!("never over: {:#?}", rig.process.state());
}

#[test]
fn robot_swinging_through_its_goal_is_not_at_rest() {
    for verb in [PrimVerb::GotoPt, PrimVerb::CalSensor, PrimVerb::Pause, PrimVerb::GoUntil] {
        let mut rig = Rig::initialized();
        rig.external.devices.force = ForceSensor { x: 2048, y: 2048, z: 2048, moment: 2048, valid: true };
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(20 * u32::from(verb == PrimVerb::Pause));
        rig.guard(verb, 1, "NEAR-R");
        rig.wait(10 * u32::from(verb == PrimVerb::GoUntil));
        rig.external.devices.holsters.right = 3;
        assert_eq!(swing(&mut rig), (PrimReport::Error, Reason::NotAtGoal), "{verb}");
    }
}

#[test]
fn robot_init_during_a_motion_stops_the_robot_first() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert!(rig.at_rest());
    rig.check_path(&start());
}

#[test]
fn loss_of_e_move_stops_the_robot() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.world.emove_dead = true;
    rig.wait(80);
    assert_eq!((rig.report(), rig.memory.prim.status.reason), (PrimReport::Error, Reason::NeighbourLost));
    assert!(rig.at_rest());
    assert_ne!(rig.world.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
    rig.check_path(&start());
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::RobotInit, 0);
    rig.wait(2);
    rig.world.emove_dead = true;
    assert_eq!((rig.finish(), rig.memory.prim.status.reason), (PrimReport::Error, Reason::NeighbourLost));
}

#[test]
fn robot_not_arriving_fails_after_two_seconds() {
    for verb in [PrimVerb::GotoPt, PrimVerb::GoUntil, PrimVerb::DeltaMove] {
        let mut rig = Rig::initialized();
        rig.world.t3i.off = 3;
        let before = rig.tick;
        rig.guard(verb, 2, "NEAR-R");
        assert_eq!(rig.finish(), PrimReport::Error, "{verb}");
        assert_eq!(rig.memory.prim.status.reason, Reason::NotAtGoal, "{verb}");
        assert!(rig.tick.since(before) > 50);
        rig.world.t3i.off = 1;
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    }
}

/// With random commands at random times, points stay in order and the path has no jump.
#[test]
fn random_commands_cause_no_jump() {
    for seed in 1..=400 {
        let mut rig = Rig::initialized();
        rig.world.noise = seed;
        rig.world.stalls = 2 + seed % 9;
        for _ in 0..12 {
            rig.world.stalled();
            let (verb, pose) = match rig.world.noise % 8 {
                0 => (PrimVerb::Pause, 0),
                1 => (PrimVerb::RobotInit, 0),
                2 => (PrimVerb::GotoPt, 99),
                3..=5 => (PrimVerb::GoThru, 1 + (rig.world.noise >> 9) as u32 % 3),
                _ => (PrimVerb::GotoPt, 1 + (rig.world.noise >> 9) as u32 % 3),
            };
            rig.external.devices.joystick.velocity =
                if (rig.world.noise >> 20).is_multiple_of(5) { 300 } else { 1000 };
            rig.command(verb, pose);
            if (rig.world.noise >> 30).is_multiple_of(3) {
                rig.wait((rig.world.noise >> 40) as u32 % 60);
            } else {
                rig.finish();
            }
        }
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        rig.external.devices.joystick.velocity = 1000;
        assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
        assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
        rig.check_path(&start());
    }
}

#[test]
fn restored_prim_continues_identically() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    let mut restored = rig.clone();
    restored.restore();
    assert_eq!([rig.finish(), restored.finish()], [PrimReport::Done; 2]);
    assert_eq!(rig.world.t3i.path, restored.world.t3i.path);
}

#[test]
fn lost_or_tripped_device_stops_the_robot() {
    for (connection, reason) in
        [(GroupHealth::Lost, Reason::DeviceSilent), (GroupHealth::Tripped, Reason::DeviceTripped)]
    {
        let mut rig = Rig::initialized();
        rig.command(PrimVerb::GotoPt, 3);
        rig.wait(30);
        rig.external.devices.field.any = GroupHealth::Stale;
        rig.external.devices.joystick.velocity = 0;
        rig.wait(60);
        assert_eq!(rig.report(), PrimReport::Executing, "Prim waits for a late device");
        rig.external.devices.field.any = connection;
        assert_eq!((rig.finish(), rig.memory.prim.status.reason), (PrimReport::Error, reason));
        rig.wait(60);
        assert!(rig.at_rest());
        assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
        rig.external.devices.field.any = GroupHealth::Fresh;
        rig.external.devices.joystick.velocity = 1000;
        assert_eq!(rig.run(PrimVerb::GotoPt, 3), PrimReport::Done);
        rig.check_path(&start());
    }
}

#[test]
fn every_row_fires() {
    const SCENARIOS: &[fn()] = &[
        starting_prim_sends_pause_and_has_no_position,
        lost_or_tripped_device_stops_the_robot,
        through_point_is_not_passed_while_the_resolvers_are_far_from_it,
        unusable_records_are_refused_and_stop_the_robot,
        silent_t3i_is_reported,
        t3i_without_echo_gets_only_one_more_point,
        robot_swinging_through_its_goal_is_not_at_rest,
        robot_init_during_a_motion_stops_the_robot_first,
        loss_of_e_move_stops_the_robot,
        robot_not_arriving_fails_after_two_seconds,
    ];
    let scenarios =
        [SCENARIOS, line::SCENARIOS, guarded::SCENARIOS, joystick::SCENARIOS, recovery::SCENARIOS].concat();
    assert_eq!(silent::<Prim, TaskData<'_>>(&scenarios), [""; 0]);
}
