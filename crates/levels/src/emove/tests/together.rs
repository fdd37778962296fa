//! E-move with the real Quick Change, Grip, V-Grip and Tool-Grip and their simulated devices: sleep and wake.

use interfaces::{
    CommonMemory, ExternalInputs, Header, Reason, StatusReport,
    device::GripSensors,
    emove::EmoveVerb::{GraspObj, MovObjTo, MovToLoc, MovToObj, Release},
    prim::JoystickGrip,
    process::{Inputs, Process},
};
use rcs_core::tick::Tick;

use super::{
    bench::{Bench, DONE, attach, detach, error, to_holster},
    doubles::Scene,
};
use crate::{
    environment::{
        air::{Gripper, Object},
        jaws::Fingers,
        ring::Ring,
    },
    grip::Grip,
    jaws::{CylindricalPartGripper, ToolGrip, ToolGripper, VGrip},
    quick_change::QuickChange,
};

#[derive(Clone)]
pub struct Real {
    quick_change: QuickChange,
    grip: Grip,
    v_grip: VGrip,
    tool_grip: ToolGrip,
    ring: Ring,
    parts: Gripper,
    jaws: [Fingers; 2],
}

/// Step a process, or publish its last output again.
fn step<P: Process<()>>(
    process: &mut P,
    dormant: bool,
    inputs: &Inputs<'_, ()>,
    outputs: &mut P::Outputs,
    header: impl FnOnce(&mut P::Outputs) -> &mut Header,
) {
    if dormant {
        let header = header(outputs);
        (header.stamp, header.republished) = (inputs.tick, true);
    } else {
        process.step(inputs, outputs);
    }
}

impl Real {
    pub fn new(is_locked: bool) -> Self {
        let jaws = [Fingers::new::<CylindricalPartGripper>(3.5), Fingers::new::<ToolGripper>(4.0)];
        Self {
            quick_change: QuickChange::default(),
            grip: Grip::default(),
            v_grip: VGrip::default(),
            tool_grip: ToolGrip::default(),
            ring: Ring::at(f64::from(u8::from(is_locked))),
            parts: Gripper::new(2.0, 1987),
            jaws,
        }
    }

    pub fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &mut ExternalInputs,
        world: &mut Scene,
        after: &mut CommonMemory,
    ) {
        self.devices(before, external, world);
        let inputs = Inputs { tick, memory: before, external, data: &() };
        let dormant = before.emove.dormant;
        self.quick_change.step(&inputs, &mut after.quick_change);
        step(&mut self.grip, dormant.grip, &inputs, &mut after.grip, |o| &mut o.header);
        step(&mut self.v_grip, dormant.v_grip, &inputs, &mut after.v_grip, |o| &mut o.header);
        step(&mut self.tool_grip, dormant.tool_grip, &inputs, &mut after.tool_grip, |o| &mut o.header);
    }

    pub const fn open_ring(&mut self) {
        self.ring.place = 0.0;
    }

    fn opening(&self, gripper: u8) -> (f64, (f64, f64)) {
        match gripper {
            1 => (self.parts.opening, (0.10, 5.00)),
            _ => self.jaws.get(usize::from(gripper) - 2).map(|jaws| (jaws.opening, jaws.ends)).unwrap(),
        }
    }

    fn devices(&mut self, before: &CommonMemory, external: &mut ExternalInputs, world: &mut Scene) {
        let outputs = before.device_outputs();
        self.ring.turn(outputs.quick_change);
        self.ring.id = world.mated;
        world.locked = self.ring.place > 0.5;
        let devices = &mut external.devices;
        devices.quick_change = self.ring.sensors();
        let size = world.object.map(|size| f64::from(size) / 100.0);
        self.parts.object = size.map(|size| Object { size, off_centre: 0.0 });
        let press = |jaws: &mut Fingers, valves| {
            jaws.object = size;
            jaws.advance(valves);
            GripSensors { potentiometer: jaws.counts(), ..GripSensors::default() }
        };
        devices.grip = match world.mated {
            1 => {
                self.parts.advance(outputs.grip.bits);
                self.parts.sensors()
            }
            2 => press(&mut self.jaws[0], outputs.v_grip),
            3 => press(&mut self.jaws[1], outputs.tool_grip),
            _ => GripSensors::default(),
        };
    }
}

fn exchange(bench: &mut Bench, from: u8, to: u8) {
    if from != 0 {
        assert_eq!(bench.perform(to_holster(1, from)), DONE);
        assert_eq!(bench.perform(detach(from)), DONE, "{:?}", bench.world.log);
    }
    assert_eq!(bench.perform(to_holster(2, to)), DONE);
    assert_eq!(bench.perform(attach(to)), DONE, "{:?}", bench.world.log);
    assert_eq!(bench.memory.emove.status.end_effector_id, Some(to));
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
}

/// Grasp an object at the bench, carry it to the vise, release it there and move home.
fn carry(bench: &mut Bench, object: &'static str, size: i32, gripper: u8) {
    assert_eq!(bench.run(MovToObj, object, 1, "BENCH", gripper), DONE);
    bench.world.object = Some(size);
    assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), DONE);
    assert_eq!(bench.run(MovObjTo, object, 1, "VISE", gripper), DONE);
    assert_eq!(bench.pause(), DONE);
    assert!(bench.memory.emove.status.held.is_held(), "{object} is held through a pause");
    assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
    assert!(!bench.memory.emove.status.held.is_held());
    bench.world.object = None;
    assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
}

#[test]
fn real_grippers_carry_their_parts_and_are_exchanged() {
    let mut bench = Bench::real("HOME", 1);
    assert!(bench.memory.grip.status.initialized, "calibrated at the start");
    carry(&mut bench, "BLOCK", 75, 1);
    exchange(&mut bench, 1, 2);
    carry(&mut bench, "SHAFT", 204, 2);
    exchange(&mut bench, 2, 3);
    carry(&mut bench, "CUTTER", 247, 3);
    exchange(&mut bench, 3, 1);
    carry(&mut bench, "BLOCK", 75, 1);
}

#[test]
fn parts_gripper_attached_after_the_start_is_calibrated() {
    let mut bench = Bench::real("HOME", 0);
    assert!(!bench.memory.grip.status.initialized);
    exchange(&mut bench, 0, 1);
    assert!(bench.memory.grip.status.initialized);
    carry(&mut bench, "BLOCK", 75, 1);
}

#[test]
fn part_slipping_out_of_a_real_gripper_is_reported() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 204), (3, "CUTTER", 247)] {
        let mut bench = Bench::real("HOME", gripper);
        assert_eq!(bench.run(MovToObj, object, 1, "BENCH", gripper), DONE);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), error(Reason::GraspMissed));
        assert_eq!(bench.run(Release, object, 1, "BENCH", gripper), DONE);
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), DONE);
        bench.command(MovObjTo, object, 1, "VISE", gripper);
        bench.wait(4);
        bench.world.object = None;
        assert_eq!(bench.finish(), error(Reason::ObjectLost), "air closes the fingers when {object} is gone");
    }
}

#[test]
fn operator_opens_and_closes_each_real_gripper() {
    for gripper in 1..=3 {
        let mut bench = Bench::real("HOME", gripper);
        bench.world.joystick = true;
        bench.wait(5);
        assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn);
        for (button, opened) in [(JoystickGrip::Open, true), (JoystickGrip::Close, false)] {
            bench.world.button = button;
            bench.wait(150);
            let (opening, ends) = bench.world.real.as_ref().unwrap().opening(gripper);
            let goal = if opened { ends.1 } else { ends.0 };
            assert!((opening - goal).abs() < 0.03, "gripper {gripper}: {opening}");
        }
        (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
        bench.wait(10);
        assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
        assert_eq!(bench.pause(), DONE);
    }
}
