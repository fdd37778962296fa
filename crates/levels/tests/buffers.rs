//! Variables of the interfaces (chapters V and VI) that no process uses, only people and programs that observe the
//! run.

use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, GripOutputs, JawsOutputs, PedestalOutputs, T3iOutputs,
    TableOutputs,
    emove::{EmoveCommand, EmoveVerb},
    prim::PrimVerb,
    process::{Inputs, Process},
    t3i::{T3iCommand, T3iVerb},
};
use levels::{
    emove::Emove,
    grip, jaws,
    pedestal::{control, table},
    t3i::T3i,
};
use rcs_core::{Plain, tick::Tick};
use taskdata::files::TaskData;

#[test]
fn t3i_publishes_its_own_and_the_command_cycle_count() {
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
fn e_move_passes_the_pose_up_and_the_gripper_down() {
    let (mut process, mut memory, mut outputs) =
        (Emove::default(), CommonMemory::default(), EmoveOutputs::default());
    let (external, data) = (ExternalInputs::default(), TaskData::default());
    memory.prim.status.sensor_pose = Some(0x8300_0007);
    memory.quick_change.status.end_effector_id = Some(2);
    for (tick, number) in [(1, 0), (2, 1)] {
        memory.subtask.emove = EmoveCommand { number, command: EmoveVerb::Pause, ..EmoveCommand::default() };
        let inputs = Inputs { tick: Tick(tick), memory: &memory, external: &external, data: &data };
        process.step(&inputs, &mut outputs);
    }
    assert_eq!(outputs.status.reference_pose, Some(0x8300_0007));
    assert_eq!((outputs.prim.command, outputs.prim.end_effector_id), (PrimVerb::RobotInit, Some(2)));
}

#[test]
fn states_and_outputs_of_the_lowest_processes_are_small() {
    for (process, state, outputs, most) in [
        ("Grip", grip::state::State::SIZE, GripOutputs::SIZE, (512, 192)),
        ("V-Grip", jaws::state::State::SIZE, JawsOutputs::SIZE, (191, 128)),
        ("Active Pedestal", control::state::State::SIZE, PedestalOutputs::SIZE, (191, 192)),
        ("Rotary Table", table::State::SIZE, TableOutputs::SIZE, (191, 144)),
    ] {
        assert!(state <= most.0 && outputs <= most.1, "{process}: {state} and {outputs} bytes");
    }
}
