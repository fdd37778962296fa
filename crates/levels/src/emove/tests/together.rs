//! E-move with the real Quick Change, Grip, V-Grip and Tool-Grip, their devices simulated: what one sends is
//! what the other takes, sleeping and waking included. Prim and vision are doubles.

use interfaces::{
    CommonMemory, ExternalInputs, Header, Reason, StatusReport,
    device::valve,
    emove::EmoveVerb::{GraspObj, MovObjTo, MovToHol, MovToLoc, MovToObj, QcAttach, QcDetach, Release},
    prim::JoystickGrip,
    process::{Inputs, Process},
};
use rcs_core::tick::{TICK_S, Tick};
use taskdata::files::TaskData;

use super::{
    bench::{Bench, DONE, error},
    doubles::World,
};
use crate::{
    grip::Grip,
    jaws::{POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE, ToolGrip, VGrip},
    quick_change::QuickChange,
};

/// Flows of the parts gripper, in/s.
const FLOWS: [(u8, f64); 6] = [
    (valve::OPEN_FINE, 0.25),
    (valve::OPEN_MEDIUM, 1.0),
    (valve::OPEN_COARSE, 4.0),
    (valve::CLOSE_FINE, -0.25),
    (valve::CLOSE_MEDIUM, -1.0),
    (valve::CLOSE_COARSE, -4.0),
];
/// Ways of the fingers of the three grippers, in.
const WAYS: [(f64, f64); 3] = [(0.10, 5.00), (0.50, 3.50), (1.00, 4.00)];

/// The processes and their devices.
#[derive(Clone, Default)]
pub struct Real {
    quick_change: QuickChange,
    grip: Grip,
    v_grip: VGrip,
    tool_grip: ToolGrip,
    /// Openings of the three grippers, in.
    openings: [f64; 3],
    /// Force of the parts gripper, lb.
    force: f64,
    /// Position of the ring: 0 unlocked, 1 locked.
    ring: f64,
    started: bool,
}

/// Step a process, or publish again what it wrote last.
fn step<'d, P: Process<TaskData<'d>>>(
    process: &mut P,
    dormant: bool,
    inputs: &Inputs<'_, TaskData<'d>>,
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
    pub fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &mut ExternalInputs,
        data: &TaskData<'_>,
        world: &mut World,
        after: &mut CommonMemory,
    ) {
        self.devices(before, external, world);
        let inputs = Inputs { tick, memory: before, external, data };
        let dormant = before.emove.dormant;
        self.quick_change.step(&inputs, &mut after.quick_change);
        step(&mut self.grip, dormant.grip, &inputs, &mut after.grip, |o| &mut o.header);
        step(&mut self.v_grip, dormant.v_grip, &inputs, &mut after.v_grip, |o| &mut o.header);
        step(&mut self.tool_grip, dormant.tool_grip, &inputs, &mut after.tool_grip, |o| &mut o.header);
    }

    /// A person opens the ring.
    pub const fn open_ring(&mut self) {
        self.ring = 0.0;
    }

    /// What the valves of the tick before have done, and what the sensors see of it.
    fn devices(&mut self, before: &CommonMemory, external: &mut ExternalInputs, world: &mut World) {
        if !self.started {
            (self.started, self.ring, self.openings) =
                (true, if world.locked { 1.0 } else { 0.0 }, [2.0, 3.5, 4.0]);
        }
        let outputs = before.device_outputs();
        let ring = &outputs.quick_change;
        if ring.port {
            let turn = f64::from(i8::from(ring.lock) - i8::from(ring.unlock)) * 0.2;
            self.ring = (self.ring + turn).clamp(0.0, 1.0);
        }
        world.locked = self.ring > 0.5;
        let sensors = &mut external.devices.quick_change;
        (sensors.locked, sensors.unlocked) = (self.ring > 0.99, self.ring < 0.01);
        sensors.end_effector_id = world.mated;
        self.move_fingers(&outputs, world);
        let attached = usize::from(world.mated).checked_sub(1);
        let grip = &mut external.devices.grip;
        let opening = attached.map_or(0.0, |at| self.openings[at]);
        let (zero, scale) =
            if attached == Some(0) { (200.0, 700.0) } else { (POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE) };
        grip.potentiometer = (zero + scale * opening) as u16;
        let strain = (100.0 + 40.0 * if attached == Some(0) { self.force } else { 0.0 }) as u16;
        (grip.strain_left, grip.strain_right) = (strain, strain);
    }

    fn move_fingers(&mut self, outputs: &interfaces::DeviceOutputs, world: &World) {
        let Some(at) = usize::from(world.mated).checked_sub(1) else { return };
        let (closed, open) = WAYS[at];
        let object = world.object.map_or(closed, |size| f64::from(size) / 100.0);
        let bits = outputs.grip.bits;
        let speed = match at {
            0 if bits & valve::VENT != 0 => {
                self.force = 0.0;
                0.0
            }
            0 if bits & valve::SUPPLY == 0 => 0.0,
            0 => FLOWS.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, flow)| flow).sum(),
            _ => {
                let valves = if at == 1 { outputs.v_grip } else { outputs.tool_grip };
                f64::from(i8::from(valves.open) - i8::from(valves.close)) * 4.0
            }
        };
        if at == 0 {
            // Trapped air drives the fingers on when what they held is gone.
            let gap = (self.openings[0] - object.max(closed)).max(0.0).min(self.force / 100.0);
            self.openings[0] -= gap;
            self.force -= gap * 100.0;
        }
        let way = speed * TICK_S;
        let wanted = self.openings[at] + way;
        self.openings[at] = wanted.clamp(object.max(closed), open);
        if way < 0.0 {
            self.force = (self.force + (self.openings[at] - wanted) * 100.0).min(80.0);
        } else if way > 0.0 {
            self.force = 0.0;
        }
    }
}

/// A cell with the real processes, after E-PAUSE.
fn ready(location: &str, gripper: u8) -> Bench {
    let mut bench = Bench::with(location, gripper, Some(Real::default()));
    assert_eq!(bench.pause(), DONE);
    bench
}

/// The robot with one gripper fetches another.
fn exchange(bench: &mut Bench, from: u8, to: u8) {
    const HOLSTERS: [(&str, &str); 3] =
        [("GRIPPER-1", "HOLSTER-R"), ("GRIPPER-2", "HOLSTER-L"), ("GRIPPER-3", "HOLSTER-C")];
    if from != 0 {
        let (object, holster) = HOLSTERS[usize::from(from) - 1];
        assert_eq!(bench.run(MovToHol, object, 1, holster, from), DONE);
        assert_eq!(bench.run(QcDetach, object, 1, holster, from), DONE, "{:?}", bench.world.log);
    }
    let (object, holster) = HOLSTERS[usize::from(to) - 1];
    assert_eq!(bench.run(MovToHol, object, 2, holster, to), DONE);
    assert_eq!(bench.run(QcAttach, object, 2, holster, to), DONE, "{:?}", bench.world.log);
    assert_eq!(bench.memory.emove.status.end_effector_id, Some(to));
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
}

/// Take an object at the bench, carry it to the vise, leave it there and go home.
fn carry(bench: &mut Bench, object: &str, size: i32, gripper: u8) {
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
fn a_shift_with_all_grippers() {
    let mut bench = ready("HOME", 1);
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
fn a_parts_gripper_that_comes_first_after_the_start_is_calibrated() {
    let mut bench = ready("HOME", 0);
    assert!(!bench.memory.grip.status.initialized);
    exchange(&mut bench, 0, 1);
    assert!(bench.memory.grip.status.initialized);
    carry(&mut bench, "BLOCK", 75, 1);
}

#[test]
fn a_part_that_slips_out_of_any_gripper_is_reported() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 204), (3, "CUTTER", 247)] {
        let mut bench = ready("HOME", gripper);
        assert_eq!(bench.run(MovToObj, object, 1, "BENCH", gripper), DONE);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), error(Reason::GraspMissed));
        assert_eq!(bench.run(Release, object, 1, "BENCH", gripper), DONE);
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), DONE);
        bench.command(MovObjTo, object, 1, "VISE", gripper);
        bench.steps(4);
        bench.world.object = None;
        assert_eq!(bench.finish(), error(Reason::ObjectLost), "air closes the fingers when {object} is gone");
    }
}

#[test]
fn the_operator_opens_and_closes_any_gripper() {
    for gripper in 1..=3 {
        let mut bench = ready("HOME", gripper);
        bench.world.joystick = true;
        bench.steps(5);
        assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn);
        for (button, opened) in [(JoystickGrip::Open, true), (JoystickGrip::Close, false)] {
            bench.world.button = button;
            bench.steps(150);
            let real = bench.real.as_ref().unwrap();
            let at = usize::from(gripper) - 1;
            let goal = if opened { WAYS[at].1 } else { WAYS[at].0 };
            assert!((real.openings[at] - goal).abs() < 0.03, "gripper {gripper}: {}", real.openings[at]);
        }
        (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
        bench.steps(10);
        assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
        assert_eq!(bench.pause(), DONE);
    }
}
