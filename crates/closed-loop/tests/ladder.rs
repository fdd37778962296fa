//! The ladder in the ideal cell, in any order of the processes, with late and restarted processes.

mod rig;

use interfaces::{
    CommonMemory, DataBaseCommand, DeviceOutputs, ExternalInputs, GripOutputs, Header, OutsidePedestal,
    Reason,
    device::single_step,
    emove::{Estimates, Grasped, Located, PlacedObject},
    grip::{GripCommand, GripReport, GripVerb},
    hws::{HwsReport, Ledger},
    operator::{BOARDS, Variable, Write, board_bit, process_bit},
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
    subtask::Regrip,
};
use levels::{
    grip::Grip,
    ladder::{Ladder, LadderState, PROCESS_COUNT, ProcessId},
};
use proptest::prelude::*;
use rcs_core::{
    Plain,
    plain::{Writer, from_bytes},
    tick::Tick,
};
use rig::{Rig, ideal, store};

const FINISHED: (HwsReport, Reason) = (HwsReport::Finished, Reason::None);

#[test]
fn the_robot_moves_to_a_location_and_back() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    for location in ["SAFE", "HOME", "PFIXTURE", "HOME"] {
        rig.command("MOVE", location);
        assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED, "to {location}");
        assert!(rig.at(location), "the robot is at {location}");
    }
    assert_eq!(rig.warnings, 0);
}

#[test]
fn completed_command_finishes_at_once() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    // The arrows of the arm differ slightly from the taught pose (IV.3.3 step 19).
    rig.command("MOVE", "HOME");
    assert_eq!(rig.finish(ProcessId::ALL, 200), FINISHED);
    assert!(rig.at("HOME"));
    rig.command("MOVE", "HOME");
    let start = rig.tick;
    assert_eq!(rig.finish(ProcessId::ALL, 50), FINISHED);
    assert!(rig.tick.since(start) < 12);
}

#[test]
fn a_bad_command_is_refused_without_motion() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    let joints = rig.command_of_servos();
    for (verb, location, reason) in [
        ("DANCE", "SAFE", Reason::UnknownCommand),
        ("MOVE", "NOWHERE", Reason::UnknownLocation),
        ("MOVE", "", Reason::NoDestination),
        ("MOVE", "UNIT", Reason::UnknownLocation),
        ("TRANSFER", "SAFE", Reason::NoObjectNamed),
        // No trajectory leads from HOME directly to the pedestal's neighbour.
        ("MOVE", "UNIT-SAFE", Reason::NoTrajectory),
    ] {
        rig.command(verb, location);
        assert_eq!(rig.finish(ProcessId::ALL, 100), (HwsReport::Error, reason), "{verb} {location}");
    }
    assert_eq!(rig.command_of_servos(), joints);
}

/// docs/design/motion.md "Flying on": after a through point the goal takes one hop up and one hop down.
#[test]
fn prim_flies_on_for_two_ticks_after_a_through_point() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    let (mut passed, mut points) = (None, 0);
    for k in 0..6000 {
        if k % 2000 == 0 {
            rig.command("MOVE", ["PFIXTURE", "SAFE", "HOME"][k / 2000]);
        }
        let (was, command) = (rig.before.prim, rig.before.emove.prim.command);
        rig.step(ProcessId::ALL);
        let now = rig.before.prim;
        if let Some(tick) = passed {
            assert_ne!(now.t3i.frame, was.t3i.frame, "the robot moves on in tick {}", rig.tick);
            if now.status.echo != was.status.echo {
                assert_eq!(rig.tick.since(tick), 2);
                (passed, points) = (None, points + 1);
            }
        }
        let ends = was.status.report == PrimReport::Executing && now.status.report == PrimReport::Done;
        if ends && command == PrimVerb::GoThru {
            passed = Some(rig.tick);
        }
    }
    assert!(rig.at("HOME") && points > 1, "{points} points");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// docs/design/tick.md "Order": the order of processes within a tick does not change any bit of the result.
    #[test]
    fn order_does_not_matter(
        seed in prop::collection::vec(Just(ProcessId::ALL.to_vec()).prop_shuffle(), 1..20),
    ) {
        let run = |orders: &[Vec<ProcessId>]| {
            let mut rig = Rig::new();
            rig.command("PAUSE", "");
            for k in 0..600 {
                if k == 250 {
                    rig.command("MOVE", "SAFE");
                }
                rig.step(&orders[k % orders.len()]);
            }
            rig.digest
        };
        prop_assert_eq!(run(&seed), run(&[ProcessId::ALL.to_vec()]));
    }
}

fn take_outputs(process: ProcessId, from: &CommonMemory, into: &mut CommonMemory) {
    match process {
        ProcessId::Task => into.task = from.task,
        ProcessId::Subtask => into.subtask = from.subtask,
        ProcessId::Emove => into.emove = from.emove,
        ProcessId::Prim => into.prim = from.prim,
        ProcessId::T3i => into.t3i = from.t3i,
        ProcessId::QuickChange => into.quick_change = from.quick_change,
        ProcessId::Grip => into.grip = from.grip,
        ProcessId::VGrip => into.v_grip = from.v_grip,
        ProcessId::ToolGrip => into.tool_grip = from.tool_grip,
        ProcessId::Pedestal => into.pedestal = from.pedestal,
        ProcessId::Hand => into.hand = from.hand,
        ProcessId::RotaryTable => into.table = from.table,
    }
}

/// Ladder of each process (by its code), and the order of the processes within it.
fn partition() -> impl Strategy<Value = (Vec<usize>, Vec<ProcessId>)> {
    let boards = prop::collection::vec(0..PROCESS_COUNT, PROCESS_COUNT);
    (boards, Just(ProcessId::ALL.to_vec()).prop_shuffle())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// docs/design/tick.md "Order": the distribution over boards changes no bit, even with suspended processes.
    #[test]
    fn distribution_does_not_matter(
        (board_of, order) in partition(),
        intervals in prop::collection::vec(interval(), 1..8),
    ) {
        let mut rig = Rig::new();
        let mut boards = vec![rig.ladder.clone(); PROCESS_COUNT];
        rig.command("PAUSE", "");
        for k in 0..600_u16 {
            if k == 250 {
                rig.command("MOVE", "SAFE");
            }
            if let Some(interval) = k.checked_sub(300).and_then(|k| intervals.get(usize::from(k / 40))) {
                rig.external.devices.joystick.hold = interval.hold;
                rig.external.devices.joystick.single_step = if k % 3 == 0 { interval.single_step } else { 0 };
                rig.gripper = interval.gripper;
            }
            let (before, external, tick) = (rig.before, rig.external, rig.tick.next());
            rig.step(ProcessId::ALL);
            let mut after = CommonMemory::default();
            for (number, board) in boards.iter_mut().enumerate() {
                let on_it = |process: &ProcessId| board_of[usize::from(process.code())] == number;
                let own: Vec<ProcessId> = order.iter().copied().filter(on_it).collect();
                let mut written = CommonMemory::default();
                board.step_in_order(&own, tick, &before, &external, &store().view(), &mut written);
                own.iter().for_each(|&process| take_outputs(process, &written, &mut after));
            }
            prop_assert_eq!(after, rig.before, "tick {}", tick);
        }
    }
}

#[derive(Clone, Debug)]
enum DeliveryFault {
    /// A process is not stepped for some ticks.
    Late(ProcessId, u8),
    Restart(ProcessId),
}

fn mishap() -> impl Strategy<Value = DeliveryFault> {
    let process = || prop::sample::select(ProcessId::ALL.to_vec());
    prop_oneof![
        (process(), 1_u8..12).prop_map(|(p, n)| DeliveryFault::Late(p, n)),
        process().prop_map(DeliveryFault::Restart)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    /// With any late or restarted processes: the robot never jumps, a command reported as finished is finished, every
    /// command ends, and a PAUSE leads back to work.
    #[test]
    fn mishaps_end_in_a_stop_and_a_report(
        mishaps in prop::collection::vec((0_u16..500, mishap()), 1..5),
        order in Just(ProcessId::ALL.to_vec()).prop_shuffle(),
    ) {
        let mut rig = Rig::new();
        rig.command("PAUSE", "");
        rig.finish(&order, 2000);
        rig.command("MOVE", "SAFE");
        let mut late: Vec<(ProcessId, u8)> = Vec::new();
        for k in 0..520_u16 {
            for (_, mishap) in mishaps.iter().filter(|(at, _)| *at == k) {
                match mishap {
                    DeliveryFault::Late(process, ticks) => late.push((*process, *ticks)),
                    DeliveryFault::Restart(process) => rig.ladder.restart(*process),
                }
            }
            let stepped: Vec<ProcessId> =
                order.iter().copied().filter(|p| !late.iter().any(|(l, _)| l == p)).collect();
            late.iter_mut().for_each(|(_, ticks)| *ticks -= 1);
            late.retain(|(_, ticks)| *ticks > 0);
            rig.step(&stepped);
        }
        let (report, _) = rig.finish(&order, 5000);
        prop_assert!(report != HwsReport::Finished || rig.at("SAFE"));
        prop_assert_eq!(rig.warnings, 0, "the controller was asked for a jump");

        rig.command("PAUSE", "");
        prop_assert_eq!(rig.finish(&order, 3000), FINISHED);
        let joints = rig.command_of_servos();
        for _ in 0..50 {
            rig.step(&order);
        }
        prop_assert_eq!(rig.command_of_servos(), joints, "a pausing robot moves");
        if rig.at("SAFE") || rig.at("HOME") {
            rig.command("MOVE", "HOME");
            prop_assert_eq!(rig.finish(&order, 5000), FINISHED);
            prop_assert!(rig.at("HOME"));
        }
    }
}

/// Processes that the joystick box can hold, with their switches (III.3.3).
const HELD: [(ProcessId, u8); 4] = [
    (ProcessId::Task, single_step::TASK),
    (ProcessId::Subtask, single_step::SUBTASK),
    (ProcessId::Emove, single_step::EMOVE),
    (ProcessId::Prim, single_step::PRIM),
];

impl Rig {
    fn header(&self, process: ProcessId) -> Header {
        let memory = &self.before;
        match process {
            ProcessId::Task => memory.task.header,
            ProcessId::Subtask => memory.subtask.header,
            ProcessId::Emove => memory.emove.header,
            ProcessId::Prim => memory.prim.header,
            ProcessId::T3i => memory.t3i.header,
            ProcessId::QuickChange => memory.quick_change.header,
            ProcessId::Grip => memory.grip.header,
            ProcessId::VGrip => memory.v_grip.header,
            ProcessId::ToolGrip => memory.tool_grip.header,
            ProcessId::Pedestal => memory.pedestal.header,
            ProcessId::Hand => memory.hand.header,
            ProcessId::RotaryTable => memory.table.header,
        }
    }
}

#[test]
fn held_processes_are_not_lost_and_resume() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    rig.command("MOVE", "SAFE");
    for (process, switch) in HELD {
        for _ in 0..20 {
            rig.step(ProcessId::ALL);
        }
        rig.external.devices.joystick.hold = switch;
        for _ in 0..80 {
            rig.step(ProcessId::ALL);
            assert!(rig.header(process).republished && rig.header(process).stamp == rig.tick, "{process}");
            assert_ne!(rig.before.task.status.report, HwsReport::Error, "{process} is held, not lost");
        }
        rig.external.devices.joystick.hold = 0;
    }
    assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED);
    assert!(rig.at("SAFE"));
    assert_eq!(rig.warnings, 0, "the controller was asked for a jump");
}

#[test]
fn held_process_is_stepped_once_per_press() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    for (process, switch) in HELD {
        rig.external.devices.joystick.hold = switch;
        let mut executed = 0;
        for tick in 0..40 {
            // Pressed for three ticks, released for five; the button of another process has no effect.
            let pressed = tick % 8 < 3;
            rig.external.devices.joystick.single_step = if pressed { switch } else { !switch & 0x0F };
            rig.step(ProcessId::ALL);
            executed += u32::from(!rig.header(process).republished);
        }
        assert_eq!(executed, 5, "{process}");
        rig.external.devices.joystick.single_step = 0;
        rig.step(ProcessId::ALL);
    }
    rig.external.devices.joystick.hold = 0;
    rig.command("MOVE", "SAFE");
    assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED);
}

/// `^C` and `GO` on each board, and the pulse, in the middle of a motion (IV.2.6).
#[test]
fn a_stopped_board_pauses_and_resumes() {
    for board in BOARDS {
        let mut rig = Rig::new();
        rig.command("PAUSE", "");
        assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
        rig.command("MOVE", "SAFE");
        for _ in 0..60 {
            rig.step(ProcessId::ALL);
        }
        rig.external.operator.stopped = board_bit(board);
        for _ in 0..80 {
            rig.step(ProcessId::ALL);
            for &process in ProcessId::ALL {
                let header = rig.header(process);
                let stands = board == 0 || process.board() == board;
                assert!(header.stamp == rig.tick && (header.republished || !stands), "{board}: {process}");
            }
            let silent = board == 0 || board == 4;
            assert_eq!(rig.before.t3i.link_tx.length == 0, silent, "board {board}");
        }
        rig.external.operator.stopped = 0;
        if board == 0 || board == 4 {
            // The robot controller missed the link and shows a warning: the link is initialized again.
            assert_ne!(rig.finish(ProcessId::ALL, 5000).0, HwsReport::Executing);
            rig.command("PAUSE", "");
            assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED, "board {board}");
            rig.command("MOVE", "SAFE");
        } else {
            assert_eq!(rig.warnings, 0, "board {board}: the controller was asked for a jump");
        }
        assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED, "board {board}");
        assert!(rig.at("SAFE"), "board {board}");
    }
}

/// `PRIM-LEVEL` and the like: one pass of one process on a stopped board.
#[test]
fn a_process_of_a_stopped_board_is_executed_once() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    rig.external.operator.stopped = board_bit(2);
    for process in [ProcessId::Prim, ProcessId::Emove] {
        for pass in [false, true, true, false] {
            rig.external.operator.executed = if pass { process_bit(process) } else { 0 };
            rig.step(ProcessId::ALL);
            for other in [ProcessId::Prim, ProcessId::Emove] {
                assert_eq!(rig.header(other).republished, !pass || other != process, "{process}: {other}");
            }
        }
    }
}

fn believing() -> Rig {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    let mut state = rig.ladder.state();
    state.subtask.regrip = Some(Regrip::default());
    state.task.data_system.updates.pending[0] = Some(DataBaseCommand::default());
    state.emove.adopt(&Estimates {
        placed: Some(PlacedObject::default()),
        located: Some(Located::default()),
        held: Some(Grasped::default()),
        ..state.emove.estimates()
    });
    rig.ladder.restore(&state);
    rig.before.task.ledger = Some(Ledger::default());
    rig.before.task.updates.pending = state.task.data_system.updates.pending;
    rig.before.subtask.regrip = state.subtask.regrip;
    rig.before.emove.estimates = state.emove.estimates();
    rig
}

fn believed(memory: &CommonMemory) -> Vec<Variable> {
    let estimates = &memory.emove.estimates;
    let has = |variable: &Variable| match variable {
        Variable::Ledger => memory.task.ledger.is_some(),
        Variable::Pending => memory.task.updates.pending[0].is_some(),
        Variable::Regrip => memory.subtask.regrip.is_some(),
        Variable::Held => estimates.held.is_some(),
        Variable::Placed => estimates.placed.is_some(),
        Variable::Located => estimates.located.is_some(),
        Variable::Calibration => memory.grip.calibration.is_some(),
    };
    Variable::ALL.iter().copied().filter(has).collect()
}

const fn forget(variable: Variable) -> Option<Write> {
    Some(Write { variable, object: None, grip: 0 })
}

/// `<=` (IV.2.6): a value is written into a suspended process, and nothing else changes.
#[test]
fn a_value_is_written_into_a_stopped_process() {
    let upward: Vec<_> = ProcessId::ALL.iter().rev().copied().collect();
    for &variable in Variable::ALL {
        for order in [ProcessId::ALL, &upward] {
            let mut rig = believing();
            assert_eq!(believed(&rig.before), Variable::ALL, "the test needs a value of each");
            rig.external.operator.stopped = board_bit(0);
            rig.step(order);
            let stood = rig.before;
            rig.external.operator.writes[0] = forget(variable);
            rig.step(order);
            let rest: Vec<_> = Variable::ALL.iter().copied().filter(|other| *other != variable).collect();
            assert_eq!(believed(&rig.before), rest, "{variable}");
            for &process in ProcessId::ALL {
                rig.before.header_mut(process).stamp = stood.header(process).stamp;
            }
            assert_eq!(changes(&stood, &rig.before), [variable.owner().field()], "{variable}");
        }
    }
}

/// A running process ignores a written value: all bits are those of a run without it.
#[test]
fn a_running_process_refuses_a_written_value() {
    for &variable in Variable::ALL {
        let digests = [None, forget(variable)].map(|write| {
            let mut rig = believing();
            rig.external.operator.writes[0] = write;
            (0..3).for_each(|_| rig.step(ProcessId::ALL));
            rig.digest.value()
        });
        assert_eq!(digests[0], digests[1], "{variable}");
    }
}

fn changes(one: &CommonMemory, other: &CommonMemory) -> Vec<&'static str> {
    let images = [one, other].map(|memory| {
        let mut image = vec![0; CommonMemory::SIZE];
        memory.encode(&mut Writer::new(&mut image));
        image
    });
    let mut at = 0;
    let mut changed = Vec::new();
    for field in CommonMemory::STRUCT.fields {
        let size = field.schema.size();
        if images[0][at..at + size] != images[1][at..at + size] {
            changed.push(field.name);
        }
        at += size;
    }
    changed
}

/// A value written in the tick in which the board resumes takes effect before the step.
#[test]
fn a_process_is_written_before_it_is_stepped() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    rig.external.operator.stopped = board_bit(8);
    rig.step(ProcessId::ALL);
    rig.external.operator.stopped = 0;
    rig.external.operator.writes[0] = forget(Variable::Calibration);
    assert!(rig.before.grip.status.initialized);
    rig.step(ProcessId::ALL);
    assert!(!rig.header(ProcessId::Grip).republished && !rig.before.grip.status.initialized);
    rig.external.operator.writes[0] = None;
    (0..50).for_each(|_| rig.step(ProcessId::ALL));
    assert_eq!(
        (rig.before.grip.calibration, rig.before.grip.valves.bits),
        (None, 0),
        "nothing moves by itself"
    );
}

/// `.R` on board 2 (IV.3.3 step 2): E-move, while pausing, sends Prim ROBOT-INIT and pauses again.
#[test]
fn operator_initializes_the_link() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    let restarts = |rig: &Rig| rig.before.t3i.status.counters.restarts;
    let before = restarts(&rig);
    rig.external.operator.robot_init += 1;
    let mut seen = false;
    for _ in 0..100 {
        rig.step(ProcessId::ALL);
        seen |= rig.before.emove.prim.command == PrimVerb::RobotInit;
        assert_eq!(rig.before.task.status.report, HwsReport::Finished, "a finished command stays finished");
    }
    assert!(seen && rig.before.t3i.status.link_running);
    assert_eq!((restarts(&rig), rig.before.emove.prim.command), (before + 1, PrimVerb::Pause));
    rig.command("MOVE", "SAFE");
    for _ in 0..60 {
        rig.step(ProcessId::ALL);
    }
    rig.external.operator.robot_init += 1;
    assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED, "a motion is not disturbed");
    assert!(rig.at("SAFE") && restarts(&rig) == before + 1);
}

#[test]
fn only_the_process_of_the_attached_gripper_is_stepped() {
    const GRIPPERS: [ProcessId; 3] = [ProcessId::Grip, ProcessId::VGrip, ProcessId::ToolGrip];
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    assert!(rig.before.grip.status.initialized, "calibrated when it was booted");
    for id in [1, 0, 2, 0, 3, 2, 1] {
        rig.gripper = id;
        for _ in 0..5 {
            rig.step(ProcessId::ALL);
        }
        for (process, own) in GRIPPERS.into_iter().zip(1..) {
            assert_eq!(rig.header(process).republished, id != own, "{process} with gripper {id}");
        }
        let outputs = rig.before.device_outputs();
        assert_eq!((outputs.v_grip, outputs.tool_grip), Default::default(), "there was no command");
    }
    for _ in 0..50 {
        rig.step(ProcessId::ALL);
    }
    rig.command("MOVE", "SAFE");
    assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED, "sleeping processes are not missed");
    assert!(rig.before.grip.status.initialized, "the calibration outlasts the sleep");
}

#[derive(Clone, Copy, Debug)]
struct Interval {
    hold: u8,
    single_step: u8,
    gripper: u8,
    ticks: u8,
}

fn interval() -> impl Strategy<Value = Interval> {
    (0_u8..16, 0_u8..16, prop::sample::select(vec![1_u8, 1, 1, 0, 2, 3]), 1_u8..60)
        .prop_map(|(hold, single_step, gripper, ticks)| Interval { hold, single_step, gripper, ticks })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// Dormancy, holding and single step are decided before any process is stepped: the order changes no bit.
    #[test]
    fn suspensions_do_not_depend_on_the_order(
        intervals in prop::collection::vec(interval(), 1..12),
        order in Just(ProcessId::ALL.to_vec()).prop_shuffle(),
    ) {
        let run = |order: &[ProcessId]| {
            let mut rig = Rig::new();
            rig.command("PAUSE", "");
            rig.finish(order, 2000);
            rig.command("MOVE", "SAFE");
            for interval in &intervals {
                rig.external.devices.joystick.hold = interval.hold;
                rig.gripper = interval.gripper;
                for tick in 0..interval.ticks {
                    let pressed = if tick % 3 == 0 { interval.single_step } else { 0 };
                    rig.external.devices.joystick.single_step = pressed;
                    rig.step(order);
                }
            }
            rig
        };
        let mut rig = run(&order);
        prop_assert_eq!(rig.digest, run(ProcessId::ALL).digest);
        rig.external.devices.joystick.hold = 0;
        rig.external.devices.joystick.single_step = 0;
        rig.gripper = 1;
        let (report, _) = rig.finish(&order, 5000);
        prop_assert!(report != HwsReport::Finished || rig.at("SAFE"));
        rig.command("PAUSE", "");
        prop_assert_eq!(rig.finish(&order, 3000), FINISHED);
        prop_assert_eq!(rig.warnings, 0, "the controller was asked for a jump");
    }
}

#[test]
fn a_restored_state_continues_bit_for_bit() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    assert_eq!(rig.finish(ProcessId::ALL, 2000), FINISHED);
    rig.command("MOVE", "SAFE");
    for tick in 0..400 {
        if tick % 50 == 0 {
            let state = rig.ladder.state();
            let mut image = vec![0; LadderState::SIZE];
            state.encode(&mut Writer::new(&mut image));
            let back: LadderState = from_bytes(&image).expect("what was encoded is legal");
            assert_eq!(back, state);
            for process in ProcessId::ALL {
                rig.ladder.restart(*process);
            }
            rig.ladder.restore(&back);
            assert_eq!(rig.ladder.state(), state, "every process is restored");
        }
        rig.step(ProcessId::ALL);
    }
    assert_eq!(rig.finish(ProcessId::ALL, 5000), FINISHED);
    assert_eq!(rig.warnings, 0);
}

#[test]
fn a_lost_process_below_is_an_error() {
    let mut rig = Rig::new();
    rig.command("PAUSE", "");
    rig.finish(ProcessId::ALL, 2000);
    rig.command("MOVE", "SAFE");
    for _ in 0..100 {
        rig.step(ProcessId::ALL);
    }
    let without_emove: Vec<_> = ProcessId::ALL.iter().copied().filter(|p| *p != ProcessId::Emove).collect();
    assert_eq!(rig.finish(&without_emove, 100), (HwsReport::Error, Reason::NeighbourLost));
}

/// Its processes run in another ladder in lock step: the outputs are bit-identical.
#[test]
fn external_pedestal_is_adopted_and_lost_without_answers() {
    let pedestal = [ProcessId::Pedestal, ProcessId::Hand, ProcessId::RotaryTable];
    let (mut inside, mut outside, mut station) = (Rig::new(), Rig::new(), Ladder::default());
    let mut station_before = CommonMemory::default();
    let mut step = |rig: &mut Rig, answers: bool| {
        let mut sent = CommonMemory::default();
        let before = CommonMemory { subtask: rig.before.subtask, ..station_before };
        let data = store().view();
        let tick = rig.tick.next();
        let devices = rig.external.devices;
        let external = ExternalInputs { devices, ..ExternalInputs::default() };
        station.step_in_order(&pedestal, tick, &before, &external, &data, &mut sent);
        station_before = sent;
        let CommonMemory { mut pedestal, mut hand, mut table, .. } = sent;
        for header in [&mut pedestal.header, &mut hand.header, &mut table.header] {
            header.stamp = Tick::BEFORE_START;
        }
        rig.external.pedestal = OutsidePedestal { elsewhere: true, answers, pedestal, hand, table };
        rig.step(ProcessId::ALL);
    };
    // Both ladders ran their first tick without the pedestal.
    inside.ladder.restart(ProcessId::Pedestal);
    inside.ladder.restart(ProcessId::Hand);
    inside.ladder.restart(ProcessId::RotaryTable);
    (inside.before, outside.before) = (CommonMemory::default(), CommonMemory::default());
    for _ in 0..100 {
        inside.step(ProcessId::ALL);
        step(&mut outside, true);
        assert_eq!(outside.before, inside.before);
    }
    let last = outside.before;
    for _ in 0..3 {
        step(&mut outside, false);
        let now = &outside.before;
        assert_eq!((now.pedestal, now.hand, now.table), (last.pedestal, last.hand, last.table));
        assert_eq!(now.task.header.stamp, outside.tick);
    }
    step(&mut outside, true);
    assert_eq!(outside.before.hand.header.stamp, outside.tick);
}

#[test]
fn grip_reports_the_velocity_of_the_fingers() {
    let (mut process, mut memory, mut outputs) =
        (Grip::default(), CommonMemory::default(), GripOutputs::default());
    let (mut external, mut cell) = (ExternalInputs::default(), ideal());
    let mut fastest = 0;
    for tick in 1..600 {
        if tick == 400 {
            assert!(outputs.status.initialized, "the gripper calibrates at the start");
            memory.emove.grip = GripCommand {
                number: 1,
                command: GripVerb::Position,
                position: 100,
                velocity: 100,
                end_effector_id: Some(1),
                ..GripCommand::default()
            };
        }
        external.devices = cell.inputs();
        let inputs = Inputs { tick: Tick(tick), memory: &memory, external: &external, data: &() };
        process.step(&inputs, &mut outputs);
        cell.step(&DeviceOutputs { grip: outputs.valves, ..DeviceOutputs::default() });
        if tick > 400 {
            fastest = fastest.min(outputs.status.velocity);
        }
    }
    assert_eq!((outputs.status.report, outputs.status.velocity), (GripReport::Done, 0));
    assert!((-105..=-95).contains(&fastest), "1 in/s was commanded, {fastest} reported");
}
