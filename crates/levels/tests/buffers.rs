//! Variables of the interfaces (chapters V and VI) that are carried along: no scenario depends on them, people and programs
//! that look on do.

use levels::{emove::Emove, grip::Grip, t3i::T3i};
use rcs_core::{
    interface::{
        CommonMemory, EmoveOutputs, ExternalInputs, GripOutputs, T3iOutputs,
        device::valve,
        emove::{EmoveCommand, EmoveVerb},
        grip::{GripCommand, GripReport, GripVerb},
        prim::PrimVerb,
        t3i::{T3iCommand, T3iVerb},
    },
    process::{Inputs, Process},
    tick::Tick,
};
use taskdata::files::TaskData;

#[test]
fn t3i_gives_its_cycle_count_and_echoes_that_of_the_command() {
    let (mut process, mut memory, mut outputs) =
        (T3i::default(), CommonMemory::default(), T3iOutputs::default());
    let (external, data) = (ExternalInputs::default(), TaskData::default());
    let mut step = |memory: &CommonMemory, tick| {
        let inputs = Inputs { tick: Tick(tick), memory, external: &external, data: &data };
        process.step(&inputs, &mut outputs);
        outputs.status
    };
    step(&memory, 1);
    memory.prim.t3i =
        T3iCommand { cycle: Tick(5), number: 9, command: T3iVerb::Pause, ..T3iCommand::default() };
    memory.prim.header.stamp = Tick(5);
    let status = step(&memory, 6);
    assert_eq!((status.cycle, status.cycle_echo), (Tick(6), Tick(5)));
    assert_eq!((status.echo, status.command), (9, T3iVerb::Pause));
}

#[test]
fn e_move_passes_the_feedback_pose_up_and_the_gripper_down() {
    let (mut process, mut memory, mut outputs) =
        (Emove::default(), CommonMemory::default(), EmoveOutputs::default());
    let (external, data) = (ExternalInputs::default(), TaskData::default());
    memory.prim.status.sensor_pose = 0x8300_0007;
    memory.quick_change.status.end_effector_id = 2;
    for (tick, number) in [(1, 0), (2, 1)] {
        memory.subtask.emove = EmoveCommand { number, command: EmoveVerb::Pause, ..EmoveCommand::default() };
        let inputs = Inputs { tick: Tick(tick), memory: &memory, external: &external, data: &data };
        process.step(&inputs, &mut outputs);
    }
    assert_eq!(outputs.status.reference_pose, 0x8300_0007);
    assert_eq!((outputs.prim.command, outputs.prim.end_effector_id), (PrimVerb::RobotInit, 2));
}

/// The fingers of a parts gripper without a part: opening, in, and the force with which they press on each other, lb.
struct Fingers {
    opening: f64,
    force: f64,
}

impl Fingers {
    /// A tick with the valves as commanded.
    fn advance(&mut self, bits: u8) {
        if bits & valve::VENT != 0 {
            self.force = 0.0;
        }
        if bits & valve::SUPPLY == 0 || bits & valve::VENT != 0 {
            return;
        }
        let flows = [
            (valve::OPEN_FINE, 0.25),
            (valve::OPEN_MEDIUM, 1.0),
            (valve::OPEN_COARSE, 4.0),
            (valve::CLOSE_FINE, -0.25),
            (valve::CLOSE_MEDIUM, -1.0),
            (valve::CLOSE_COARSE, -4.0),
        ];
        let speed: f64 = flows.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, flow)| flow).sum();
        self.opening = (self.opening + speed * 0.04).clamp(0.1, 5.0);
        self.force = if self.opening > 0.1 { 0.0 } else { (self.force - speed * 20.0).clamp(0.0, 80.0) };
    }
}

#[test]
fn grip_reports_how_fast_the_fingers_move() {
    let (mut process, mut memory, mut outputs) =
        (Grip::default(), CommonMemory::default(), GripOutputs::default());
    let (mut external, mut fingers) = (ExternalInputs::default(), Fingers { opening: 2.0, force: 0.0 });
    external.devices.quick_change.locked = true;
    external.devices.quick_change.end_effector_id = 1;
    let mut fastest = 0;
    for tick in 1..600 {
        if tick == 400 {
            assert!(outputs.status.initialized, "the gripper calibrates at the start");
            memory.emove.grip = GripCommand {
                number: 1,
                command: GripVerb::Position,
                position: 100,
                velocity: 100,
                end_effector_id: 1,
                ..GripCommand::default()
            };
        }
        let grip = &mut external.devices.grip;
        grip.potentiometer = (200.0 + 700.0 * fingers.opening) as u16;
        let strain = (100.0 + 40.0 * fingers.force) as u16;
        (grip.strain_left, grip.strain_right) = (strain, strain);
        let inputs = Inputs { tick: Tick(tick), memory: &memory, external: &external, data: &() };
        process.step(&inputs, &mut outputs);
        fingers.advance(outputs.valves.bits);
        if tick > 400 {
            fastest = fastest.min(outputs.status.velocity);
        }
    }
    assert_eq!((outputs.status.report, outputs.status.velocity), (GripReport::Done, 0));
    assert!((-105..=-95).contains(&fastest), "1 in/s was commanded, {fastest} reported");
}
