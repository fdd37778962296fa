use interfaces::device::{FORCE_COUNTS_PER_LB, ForceSensor};
use rcs_core::tick::TICK_S;

use super::*;

pub(super) const SCENARIOS: &[fn()] = &[
    met_condition_ends_a_guarded_move_without_motion,
    invalid_force_sensor_stops_the_robot,
    restarted_prim_keeps_the_bias,
    cal_sensor_stops_the_robot_and_takes_the_mean,
    faulty_sensor_fails_cal_sensor,
    sensor_missing_in_task_data_is_refused,
];

/// A force sensor at rest with a part in the gripper.
const LOADED: ForceSensor = ForceSensor { x: 2100, y: 2000, z: 1900, moment: 2048, valid: true };

fn pushed(pounds: i32) -> ForceSensor {
    let z = i32::from(LOADED.z) + pounds * FORCE_COUNTS_PER_LB;
    ForceSensor { z: z.clamp(0, 4095) as u16, ..LOADED }
}

/// Greatest path of a stop from the speed of the last tick, inches, at any acceleration.
pub(super) fn stopping_path(speed: f64, acceleration: f64, jerk: f64) -> f64 {
    let ramp = acceleration / jerk;
    let fastest = speed + acceleration * TICK_S + acceleration * ramp / 2.0;
    fastest * (fastest / (2.0 * acceleration) + 1.5 * ramp)
}

impl Rig {
    fn calibrated() -> Self {
        let mut rig = Self::initialized();
        rig.external.devices.force = LOADED;
        assert_eq!(rig.run(PrimVerb::CalSensor, 0), PrimReport::Done);
        rig
    }

    /// The ears come near when the robot is `x` inches from the start.
    fn step_to_holster(&mut self, x: i32) {
        let there =
            self.world.t3i.output.tool[0] >= WireFrame::from_frame(&shifted(f64::from(x), 0.0)).tool[0];
        self.external.devices.holsters.right = if there { 0x03 } else { 0x01 };
        self.step();
    }

    fn moved(&self) -> f64 {
        norm(&(self.commanded().position - start().position))
    }

    fn reason(&self) -> Reason {
        self.memory.prim.status.reason
    }
}

#[test]
fn go_until_ramps_down_and_publishes_where_it_tripped() {
    for stalls in [0, 3] {
        let mut rig = Rig::initialized();
        rig.world.stalls = stalls;
        rig.guard(PrimVerb::GoUntil, 3, "NEAR-R");
        let trip = loop {
            let speed = rig.commanded();
            rig.step_to_holster(8);
            if rig.memory.prim.status.sensed == 1 {
                break speed;
            }
            assert_eq!(rig.memory.prim.status.detected_pose, None);
        };
        // In the tick of the trip, T3I has reported the resolver frame.
        let seen = rig.pose(rig.memory.prim.status.sensor_pose).copied();
        let status = rig.memory.prim.status;
        assert_eq!(rig.pose(status.detected_pose).copied(), seen);
        assert_eq!(status.report, PrimReport::Executing, "done only at rest");
        assert_eq!(rig.finish(), PrimReport::Done);
        assert!(rig.at_rest());
        assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&rig.commanded()));
        let beyond = rig.commanded().distance(&trip).path();
        assert!(beyond > 0.5 && beyond <= stopping_path(10.0, 10.0, 500.0), "{beyond}");
        rig.check_path(&start());
        // The pose stays until the next guarded move.
        assert_eq!(rig.run(PrimVerb::GotoPt, 1), PrimReport::Done);
        assert_eq!(rig.pose(rig.memory.prim.status.detected_pose).copied(), seen);
        rig.external.devices.holsters.right = 0;
        rig.guard(PrimVerb::GoUntil, 3, "NEAR-R");
        rig.wait(2);
        assert_eq!(rig.memory.prim.status.detected_pose, None);
    }
}

#[test]
fn met_condition_ends_a_guarded_move_without_motion() {
    for (verb, report) in
        [(PrimVerb::GoUntil, PrimReport::Done), (PrimVerb::GoWhile, PrimReport::DetectedErr)]
    {
        let mut rig = Rig::initialized();
        rig.external.devices.holsters.right = 0x0C;
        rig.guard(verb, 3, "SEATED-R");
        assert_eq!(rig.finish(), report);
        rig.wait(20);
        assert_eq!((rig.moved(), rig.world.t3i.path.len(), rig.report()), (0.0, 0, report));
        let detected = rig.pose(rig.memory.prim.status.detected_pose);
        let expected = (verb == PrimVerb::GoUntil).then(|| Pose::from_frame(&start()));
        assert_eq!(detected.copied(), expected);
    }
}

#[test]
fn goal_without_condition_reports_not_detected() {
    let mut rig = Rig::initialized();
    rig.guard(PrimVerb::GoUntil, 1, "NEAR-R");
    assert_eq!(rig.finish(), PrimReport::NotDetected);
    assert_eq!(rig.memory.prim.status.reason, Reason::NotDetected);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 0.0)));
    rig.wait(100);
    assert_eq!(rig.report(), PrimReport::NotDetected);
    rig.external.devices.holsters.right = 0x03;
    rig.step();
    assert_eq!(rig.finish(), PrimReport::Done);
    assert_eq!(rig.reason(), Reason::None);
    let detected = rig.pose(rig.memory.prim.status.detected_pose);
    assert_eq!(detected, Some(&Pose::from_frame(&shifted(10.0, 0.0))));
    // A new command ends it, too.
    rig.external.devices.holsters.right = 0;
    rig.guard(PrimVerb::GoUntil, 1, "NEAR-R");
    assert_eq!(rig.finish(), PrimReport::NotDetected);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
}

#[test]
fn go_while_reaches_its_goal_or_fails() {
    let mut rig = Rig::calibrated();
    rig.external.devices.force = pushed(24);
    rig.guard(PrimVerb::GoWhile, 1, "PUSH-X");
    assert_eq!(rig.finish(), PrimReport::Done);
    assert_eq!(
        (rig.world.t3i.output, rig.memory.prim.status.sensed),
        (WireFrame::from_frame(&shifted(10.0, 0.0)), 24)
    );
    rig.guard(PrimVerb::GoWhile, 3, "PUSH-X");
    rig.wait(30);
    rig.external.devices.force = pushed(25);
    let at = rig.commanded();
    assert_eq!(rig.finish(), PrimReport::DetectedErr);
    assert_eq!(rig.reason(), Reason::Detected);
    rig.external.devices.force = pushed(0);
    rig.wait(80);
    assert_eq!(rig.report(), PrimReport::DetectedErr);
    assert!(rig.at_rest());
    assert!(rig.commanded().distance(&at).path() < stopping_path(10.0, 10.0, 500.0));
    rig.check_path(&start());
}

#[test]
fn invalid_force_sensor_stops_the_robot() {
    let dead = ForceSensor { valid: false, ..LOADED };
    let overloaded = ForceSensor { moment: 4095, ..LOADED };
    for verb in [PrimVerb::GoUntil, PrimVerb::GoWhile] {
        for force in [dead, overloaded, pushed(-200)] {
            let mut rig = Rig::calibrated();
            rig.guard(verb, 3, "PUSH-X");
            rig.wait(30);
            assert_eq!(rig.report(), PrimReport::Executing);
            rig.external.devices.force = force;
            assert_eq!(rig.finish(), PrimReport::SensorError);
            assert_eq!(rig.reason(), Reason::SensorError);
            rig.wait(80);
            assert!(rig.at_rest() && rig.moved() < 30.0);
            rig.check_path(&start());
        }
        // Without a calibration nothing moves.
        let mut rig = Rig::initialized();
        rig.external.devices.force = LOADED;
        rig.guard(verb, 3, "PUSH-X");
        assert_eq!((rig.finish(), rig.moved()), (PrimReport::SensorError, 0.0));
    }
}

#[test]
fn restarted_prim_keeps_the_bias() {
    let restarted = |power: bool| {
        let mut rig = Rig::calibrated();
        rig.restart();
        rig.external.devices.force = if power { LOADED } else { ForceSensor { valid: false, ..LOADED } };
        rig.wait(5);
        rig.external.devices.force = pushed(24);
        assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
        rig.guard(PrimVerb::GoWhile, 1, "PUSH-X");
        (rig.finish(), rig.memory.prim.status.sensed)
    };
    assert_eq!(restarted(true), (PrimReport::Done, 24));
    assert_eq!(restarted(false).0, PrimReport::SensorError, "the power was off");
}

#[test]
fn cal_sensor_stops_the_robot_and_takes_the_mean() {
    let mut rig = Rig::initialized();
    rig.external.devices.force = pushed(90);
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.command(PrimVerb::CalSensor, 0);
    let mut noise = 0_i32;
    for _ in 0..300 {
        // Readings in motion do not count; at rest the readings swing by 2 lb.
        noise = 2 - noise;
        if rig.at_rest() {
            rig.external.devices.force = pushed(noise);
        }
        rig.step();
    }
    assert_eq!(rig.report(), PrimReport::Done);
    rig.check_path(&start());
    let bias = rig.process.state().calibration.bias.unwrap();
    let expected = f64::from(LOADED.z) - 2048.0 + f64::from(FORCE_COUNTS_PER_LB);
    assert!((bias[0] - expected).abs() < 1e-9, "{bias:?}");
    // 1 lb of the bias is noise, so the 25 lb are reached at 26.
    rig.external.devices.force = pushed(25);
    rig.guard(PrimVerb::GoUntil, 1, "PUSH-X");
    rig.wait(3);
    assert_eq!((rig.report(), rig.memory.prim.status.sensed), (PrimReport::Executing, 24));
    rig.external.devices.force = pushed(26);
    rig.step();
    assert_eq!(rig.finish(), PrimReport::Done);
}

#[test]
fn faulty_sensor_fails_cal_sensor() {
    let mut rig = Rig::calibrated();
    for force in [ForceSensor { valid: false, ..LOADED }, ForceSensor { y: 0, ..LOADED }] {
        rig.external.devices.force = force;
        assert_eq!(rig.run(PrimVerb::CalSensor, 0), PrimReport::SensorError);
    }
}

#[test]
fn sensor_missing_in_task_data_is_refused() {
    let mut rig = Rig::initialized();
    for verb in [PrimVerb::GoUntil, PrimVerb::GoWhile] {
        rig.guard(verb, 3, "NOSE");
        assert_eq!((rig.finish(), rig.reason()), (PrimReport::Error, Reason::UnknownSensor));
        assert_eq!(rig.moved(), 0.0);
    }
}

#[test]
fn broken_beam_trips_a_guarded_move() {
    let mut rig = Rig::initialized();
    rig.guard(PrimVerb::GoUntil, 3, "BEAM-3");
    rig.wait(20);
    rig.external.devices.grip.beams = 0x04;
    assert_eq!(rig.finish(), PrimReport::Done);
    assert!(rig.moved() > 0.5 && rig.moved() < 10.0);
}

#[test]
fn motions_apply_movetables_and_delta_move_ends_like_goto_pt() {
    for verb in [PrimVerb::DeltaMove, PrimVerb::GoWhile, PrimVerb::GoUntil] {
        let mut rig = Rig::initialized();
        rig.guard(verb, 1, "NEAR-R");
        rig.memory.emove.prim.movetable = MovtabId::new(1);
        let over = rig.finish();
        let expected = if verb == PrimVerb::GoUntil { PrimReport::NotDetected } else { PrimReport::Done };
        let mut goal = shifted(10.0, 0.0);
        goal.position.z += 3.0;
        assert_eq!((over, rig.world.t3i.output), (expected, WireFrame::from_frame(&goal)));
        rig.check_path(&start());
    }
}
