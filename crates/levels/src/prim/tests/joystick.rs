use geometry::{
    frame::{Rotation, rotation_vector},
    pose::POINT_DISTANCE,
};
use interfaces::{
    device::{joystick_frame, single_step},
    prim::JoystickGrip,
};
use rcs_core::tick::TICK_S;

use super::*;
use crate::prim::manual::{ACCELERATION, SPEED};

pub(super) const SCENARIOS: &[fn()] = &[
    manual_motion_ends_when_the_robot_rests,
    box_waits_until_a_motion_has_ramped_down,
    two_frame_switches_select_no_frame,
    stick_is_reported_after_a_motion_is_done,
    box_without_a_position_moves_nothing,
    recorded_pose_suspends_until_the_operator_continues,
];

const FULL: i16 = 1000;

impl Rig {
    pub(super) fn paused() -> Self {
        let mut rig = Self::initialized();
        assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::Done);
        rig
    }

    pub(super) fn frame_switch(&mut self, frame: u8) {
        self.external.devices.joystick.frame = frame;
    }

    pub(super) fn stick(&mut self, x: i16, y: i16) {
        let joystick = &mut self.external.devices.joystick;
        (joystick.x, joystick.y) = (x, y);
    }

    /// Centre both sticks, release the buttons, and wait for rest.
    fn let_go(&mut self) {
        let joystick = &mut self.external.devices.joystick;
        (joystick.x, joystick.y) = (0, 0);
        (joystick.up, joystick.down, joystick.roll_plus, joystick.roll_minus) = (false, false, false, false);
        self.wait(40);
        assert!(!self.process.state().manual.is_moving());
    }

    fn leds(&self) -> u8 {
        self.memory.prim.joystick_leds
    }
}

/// The wrist point of the pose (VII.1).
fn wrist(frame: &Frame) -> Vector {
    frame.position - frame.x() * POINT_DISTANCE
}

fn turn(from: &Frame, to: &Frame) -> Vector {
    let by: Rotation = to.rotation * from.rotation.inverse();
    rotation_vector(&by)
}

#[test]
fn translations_follow_the_frame_axes_at_knob_speed() {
    let mut rig = Rig::paused();
    let at = rig.commanded();
    for (switch, axes) in [
        (joystick_frame::WORLD, [Vector::x(), Vector::y(), Vector::z()]),
        (joystick_frame::TOOL, [at.x(), at.y(), at.z()]),
    ] {
        for (axis, (x, y, up)) in axes.iter().zip([(FULL, 0, false), (0, FULL, false), (0, 0, true)]) {
            for (sign, knob) in [(1_i16, 1000_u16), (-1, 500)] {
                rig.external.devices.joystick.velocity = knob;
                rig.frame_switch(switch);
                rig.stick(sign * x, sign * y);
                rig.external.devices.joystick.up = up && sign > 0;
                rig.external.devices.joystick.down = up && sign < 0;
                let before = rig.commanded();
                rig.wait(60);
                let here = rig.commanded();
                rig.step();
                let speed = (rig.commanded().position - here.position) / TICK_S;
                let expected = axis * (SPEED * f64::from(sign) * f64::from(knob) / 1000.0);
                assert!(norm(&(speed - expected)) < 1e-9, "{speed:?} for {expected:?}");
                assert!(norm(&turn(&before, &rig.commanded())) < 1e-9);
                assert_eq!((rig.report(), rig.leds()), (PrimReport::JoystickOn, switch));
                rig.let_go();
            }
        }
    }
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&rig.commanded()));
}

#[test]
fn rotations_keep_their_centre() {
    for (switch, x, y, roll) in [
        (joystick_frame::TOOL_ORIGIN, FULL, 0, false),
        (joystick_frame::TOOL_ORIGIN, 0, FULL, false),
        (joystick_frame::WRIST_ORIGIN, FULL, 0, false),
        (joystick_frame::WRIST_ORIGIN, 0, -FULL, false),
        (joystick_frame::WORLD, 0, 0, true),
        (joystick_frame::TOOL, 0, 0, true),
        (joystick_frame::TOOL_ORIGIN, 0, 0, true),
        (joystick_frame::WRIST_ORIGIN, 0, 0, true),
    ] {
        let mut rig = Rig::paused();
        let at = rig.commanded();
        rig.frame_switch(switch);
        rig.stick(x, y);
        rig.external.devices.joystick.roll_plus = roll;
        rig.wait(60);
        let here = rig.commanded();
        let axis = at.y() * f64::from(x.signum()) + at.z() * f64::from(y.signum());
        let axis = if roll { at.x() } else { axis };
        let by = turn(&at, &here);
        assert!(norm(&by) > 0.2 && norm(&(by.normalize() - axis)) < 1e-6, "{by:?} about {axis:?}");
        let (tool, wrist) = (norm(&(here.position - at.position)), norm(&(wrist(&here) - wrist(&at))));
        if switch == joystick_frame::WRIST_ORIGIN {
            assert!(wrist < 1e-9, "{wrist}");
        } else {
            assert!(tool < 1e-9, "{tool}");
        }
        // The point that is farther away has the speed of a translation.
        rig.step();
        let lever = if switch == joystick_frame::WRIST_ORIGIN { POINT_DISTANCE } else { 14.0 };
        let rate = norm(&turn(&here, &rig.commanded())) / TICK_S;
        assert!((rate * lever - SPEED).abs() < 1e-6, "{rate} rad/s");
        rig.external.devices.joystick.roll_minus = roll;
        rig.let_go();
    }
}

#[test]
fn stick_within_its_play_moves_nothing() {
    let mut rig = Rig::paused();
    let at = rig.commanded();
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(30, -30);
    rig.external.devices.joystick.up = true;
    rig.external.devices.joystick.down = true;
    rig.wait(50);
    assert_eq!((rig.commanded(), rig.report()), (at, PrimReport::JoystickOn));
}

#[test]
fn manual_motion_ends_when_the_robot_rests() {
    let mut rig = Rig::paused();
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(FULL, FULL);
    rig.wait(30);
    rig.frame_switch(0);
    rig.step();
    assert_eq!((rig.report(), rig.leds()), (PrimReport::Executing, 0));
    let at = rig.commanded();
    assert_eq!(rig.finish(), PrimReport::Done);
    let path = rig.commanded().distance(&at).path();
    assert!(path > 0.5 && path < SPEED * SPEED / ACCELERATION, "{path}");
    let held = rig.commanded();
    rig.wait(20);
    assert_eq!((rig.commanded(), rig.world.t3i.output), (held, WireFrame::from_frame(&held)));
    // The same PAUSE permits another manual motion.
    rig.frame_switch(joystick_frame::TOOL);
    rig.wait(20);
    assert_eq!(rig.report(), PrimReport::JoystickOn);
    assert_ne!(rig.commanded(), held);
}

#[test]
fn box_waits_until_a_motion_has_ramped_down() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(30);
    rig.command(PrimVerb::Pause, 0);
    rig.wait(3);
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(FULL, 0);
    rig.step();
    assert_eq!((rig.report(), rig.leds()), (PrimReport::JoystickOn, 0));
    rig.wait(60);
    assert_eq!(rig.leds(), joystick_frame::WORLD);
    rig.check_path(&start());
}

#[test]
fn two_frame_switches_select_no_frame() {
    let mut rig = Rig::paused();
    let at = rig.commanded();
    rig.frame_switch(joystick_frame::WORLD | joystick_frame::TOOL);
    rig.stick(FULL, 0);
    rig.wait(30);
    assert_eq!((rig.commanded(), rig.report(), rig.leds()), (at, PrimReport::JoystickOn, 0));
    // A bit without a switch selects no frame.
    rig.frame_switch(0x40);
    rig.wait(30);
    assert_eq!((rig.commanded(), rig.report(), rig.leds()), (at, PrimReport::JoystickOn, 0));
    rig.frame_switch(joystick_frame::WORLD);
    rig.wait(30);
    assert_eq!(rig.leds(), joystick_frame::WORLD);
    // A second switch during the motion causes a ramp down.
    rig.frame_switch(joystick_frame::WORLD | joystick_frame::WRIST_ORIGIN);
    rig.wait(40);
    let held = rig.commanded();
    rig.wait(10);
    assert_eq!((rig.commanded(), rig.report(), rig.leds()), (held, PrimReport::JoystickOn, 0));
}

#[test]
fn stick_stops_every_motion_and_is_reported() {
    for verb in
        [PrimVerb::GoThru, PrimVerb::GotoPt, PrimVerb::GoUntil, PrimVerb::GoWhile, PrimVerb::DeltaMove]
    {
        let mut rig = Rig::initialized();
        rig.guard(verb, 3, "NEAR-R");
        // A stick without a switch, a switch with a stick in its play, and the box with the knob at zero.
        for (frame, x, knob) in
            [(0, FULL, 1000), (joystick_frame::WORLD, 30, 1000), (joystick_frame::WORLD, FULL, 0)]
        {
            rig.frame_switch(frame);
            rig.stick(x, 0);
            rig.external.devices.joystick.velocity = knob;
            rig.wait(10);
            assert_eq!(rig.report(), PrimReport::Executing, "{verb} {frame} {x} {knob}");
        }
        rig.external.devices.joystick.velocity = 1000;
        rig.frame_switch(joystick_frame::WORLD);
        rig.step();
        assert_eq!(
            (rig.report(), rig.memory.prim.status.reason),
            (PrimReport::JoystickOn, Reason::JoystickOn)
        );
        rig.wait(80);
        assert!(rig.at_rest());
        assert_eq!(rig.leds(), 0, "the box moves the robot only during PAUSE");
        let held = rig.commanded();
        rig.frame_switch(0);
        rig.wait(20);
        assert_eq!(
            (rig.report(), rig.commanded()),
            (PrimReport::JoystickOn, held),
            "the motion is not resumed"
        );
        rig.check_path(&start());
        rig.command(PrimVerb::Pause, 0);
        assert_eq!(rig.finish(), PrimReport::Done);
        rig.frame_switch(joystick_frame::WORLD);
        rig.wait(20);
        assert_ne!(rig.commanded(), held);
        // With the switch on and the stick at rest a motion continues until the stick is moved.
        rig.let_go();
        rig.guard(verb, 2, "SEATED-R");
        rig.wait(10);
        assert_eq!(rig.report(), PrimReport::Executing);
        rig.external.devices.joystick.roll_plus = true;
        rig.step();
        assert_eq!(rig.report(), PrimReport::JoystickOn);
    }
}

#[test]
fn stick_is_reported_after_a_motion_is_done() {
    let mut rig = Rig::initialized();
    assert_eq!(rig.run(PrimVerb::GoThru, 1), PrimReport::Done);
    let flying = rig.commanded();
    rig.frame_switch(joystick_frame::TOOL);
    rig.step();
    assert_eq!(rig.report(), PrimReport::Done, "the switch alone has no effect");
    rig.external.devices.joystick.up = true;
    rig.step();
    assert_eq!(rig.report(), PrimReport::JoystickOn);
    rig.wait(80);
    assert!(rig.at_rest());
    assert!(rig.commanded().distance(&flying).path() < 10.0);
    rig.check_path(&start());
}

#[test]
fn command_waits_until_a_manual_motion_has_ramped_down() {
    let mut rig = Rig::paused();
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(-FULL, FULL);
    rig.wait(30);
    rig.frame_switch(0);
    assert_eq!(rig.run(PrimVerb::GotoPt, 2), PrimReport::Done);
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    rig.check_path(&start());
}

#[test]
fn box_without_a_position_moves_nothing() {
    let mut rig = Rig::new();
    rig.wait(3);
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(FULL, 0);
    assert_eq!(rig.run(PrimVerb::Pause, 0), PrimReport::JoystickOn);
    rig.wait(10);
    assert_eq!((rig.leds(), rig.memory.prim.t3i.command), (0, T3iVerb::Pause));
    rig.external.devices.joystick.record = true;
    let status = rig.step().status;
    assert_eq!((status.recording, status.recorded_pose), (false, None));
    // ROBOT-INIT moves nothing and is executed.
    assert_eq!(rig.run(PrimVerb::RobotInit, 0), PrimReport::Done);
    assert_eq!(rig.run(PrimVerb::CalSensor, 0), PrimReport::JoystickOn);
}

#[test]
fn gripper_buttons_are_published_while_the_box_is_on() {
    let mut rig = Rig::paused();
    let joystick = |rig: &mut Rig, frame, open, close| {
        let joystick = &mut rig.external.devices.joystick;
        (joystick.frame, joystick.open, joystick.close) = (frame, open, close);
        rig.step();
        rig.memory.prim.status.joystick_grip
    };
    assert_eq!(joystick(&mut rig, 0, true, false), JoystickGrip::None);
    assert_eq!(joystick(&mut rig, joystick_frame::TOOL, true, false), JoystickGrip::Open);
    assert_eq!(joystick(&mut rig, joystick_frame::TOOL, false, true), JoystickGrip::Close);
    assert_eq!(joystick(&mut rig, joystick_frame::TOOL, true, true), JoystickGrip::None);
    assert_eq!(
        joystick(&mut rig, joystick_frame::TOOL | joystick_frame::WORLD, true, false),
        JoystickGrip::None
    );
}

#[test]
fn recorded_pose_suspends_until_the_operator_continues() {
    let mut rig = Rig::paused();
    assert_eq!((rig.memory.prim.status.recorded_pose, rig.memory.prim.status.recording), (None, false));
    rig.frame_switch(joystick_frame::WORLD);
    rig.stick(FULL, 0);
    rig.wait(30);
    rig.external.devices.joystick.record = true;
    rig.step();
    let status = rig.memory.prim.status;
    assert!(status.recording);
    let pose = rig.pose(status.recorded_pose).copied();
    assert_eq!(pose, Some(Pose::from_frame(&rig.commanded())));
    assert_eq!(pose, rig.pose(status.present_pose).copied());
    // The last point is the recorded one, and the robot stays there.
    rig.wait(2);
    let held = rig.world.t3i.output;
    assert_eq!(held, WireFrame::from_frame(&rig.commanded()));
    rig.wait(50);
    assert_eq!((rig.world.t3i.output, rig.memory.prim.header.republished), (held, true));
    rig.world.t3i.path.clear();
    rig.external.devices.joystick.resume = true;
    rig.step();
    assert!(!rig.memory.prim.status.recording && !rig.memory.prim.header.republished);
    rig.external.devices.joystick.resume = false;
    rig.wait(40);
    assert!(!rig.memory.prim.status.recording, "the button was never released");
    assert_eq!(rig.pose(rig.memory.prim.status.recorded_pose).copied(), pose);
    // The stick was deflected all the time, but the motion starts from rest.
    rig.check_path(&held.to_frame().unwrap());
    assert_ne!(rig.world.t3i.output, held);
}

#[test]
fn held_prim_resumes_from_rest_to_its_goal() {
    for verb in [PrimVerb::GotoPt, PrimVerb::GoThru, PrimVerb::Pause] {
        let mut rig = Rig::initialized();
        if verb == PrimVerb::Pause {
            rig.command(PrimVerb::GotoPt, 3);
            rig.wait(30);
        }
        rig.command(verb, 3);
        rig.wait(if verb == PrimVerb::Pause { 5 } else { 30 });
        (rig.held, rig.external.devices.joystick.hold) = (true, single_step::PRIM);
        rig.wait(2);
        let held = rig.world.t3i.output;
        rig.wait(30);
        assert_eq!(rig.world.t3i.output, held);
        (rig.held, rig.external.devices.joystick.hold) = (false, 0);
        rig.world.t3i.path.clear();
        assert_eq!(rig.finish(), PrimReport::Done);
        rig.check_path(&held.to_frame().unwrap());
        if verb == PrimVerb::Pause {
            assert_eq!(rig.world.t3i.output, held, "the motion has already ramped down");
        } else {
            rig.wait(100);
            assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(40.0, 3.0)));
        }
    }
}

#[test]
fn single_step_is_one_trajectory_point() {
    let mut rig = Rig::initialized();
    rig.command(PrimVerb::GotoPt, 3);
    rig.wait(60);
    (rig.held, rig.external.devices.joystick.hold) = (true, single_step::PRIM);
    rig.wait(10);
    for _ in 0..5 {
        let before = rig.world.t3i.path.len();
        rig.held = false;
        rig.step();
        rig.held = true;
        rig.wait(10);
        let [.., a, b] = rig.world.t3i.path.as_slice() else { panic!("no path") };
        assert_eq!(rig.world.t3i.path.len(), before + 1);
        let step = a.to_frame().unwrap().distance(&b.to_frame().unwrap()).inches;
        assert!((step - 0.4).abs() < 0.02, "{step} in: the points are unchanged");
    }
    // After a release in the tick after a step, the motion also starts from rest.
    let held = rig.world.t3i.output;
    (rig.held, rig.external.devices.joystick.hold) = (false, 0);
    rig.world.t3i.path.clear();
    assert_eq!(rig.finish(), PrimReport::Done);
    rig.check_path(&held.to_frame().unwrap());
}
