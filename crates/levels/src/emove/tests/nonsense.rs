use interfaces::{
    EmoveOutputs, Header, Reason,
    emove::EmoveVerb,
    grip::GripReport,
    jaws::JawsReport,
    prim::{JoystickGrip, PrimReport},
    process::{Inputs, Process},
    quick_change::{QuickChangeReport, RingPosition},
};
use proptest::prelude::*;
use rcs_core::{Plain, plain::to_bytes};

use super::bench::{Bench, frame_of, given, moved};
use crate::emove::{Emove, gripper::EmoveGripper};

const OBJECTS: [&str; 6] = ["", "BLOCK", "SHAFT", "CUTTER", "GRIPPER-1", "GRIPPER-3"];
const LOCATIONS: [&str; 6] = ["", "HOME", "BENCH", "HOLSTER-R", "HOLSTER-C", "TOOL-TRNS"];

/// The inputs of a tick: a command or none, and the outputs of each neighbour.
#[derive(Clone, Debug)]
struct InvalidCommands {
    command: Option<(u8, usize, i32, usize, u8)>,
    prim: (u8, u8, bool, u8),
    ring: (u8, u8, bool),
    grip: (u8, i32, i32),
    jaws: (u8, i32, i32),
    echoes: bool,
    at: usize,
}

fn nonsense() -> impl Strategy<Value = InvalidCommands> {
    let command = (0_u8..17, 0_usize..6, -1_i32..3, 0_usize..6, 0_u8..5);
    (
        prop::option::weighted(0.2, command),
        (0_u8..12, any::<u8>(), any::<bool>(), 0_u8..3),
        (0_u8..6, 0_u8..6, any::<bool>()),
        (0_u8..5, any::<i32>(), any::<i32>()),
        (0_u8..6, 0_i32..500, -50_i32..50),
        prop::bool::weighted(0.9),
        0_usize..6,
    )
        .prop_map(|(command, prim, ring, grip, jaws, echoes, at)| InvalidCommands {
            command,
            prim,
            ring,
            grip,
            jaws,
            echoes,
            at,
        })
}

fn bring(bench: &mut Bench, tick: &InvalidCommands) {
    if let Some((verb, object, grip, location, gripper)) = tick.command {
        let verb = EmoveVerb::from_code(verb).unwrap();
        bench.send((verb, OBJECTS[object], grip, LOCATIONS[location], gripper));
    }
    if !LOCATIONS[tick.at].is_empty() {
        bench.world.frame = frame_of(LOCATIONS[tick.at]);
    } else {
        bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
    }
    let header = Header { stamp: bench.tick, republished: !tick.echoes, ..Header::default() };
    let commands = bench.memory.emove;
    let memory = &mut bench.memory;
    let (report, bits, link, button) = tick.prim;
    let status = &mut memory.prim.status;
    memory.prim.header.stamp = bench.tick;
    status.report = PrimReport::from_code(report).unwrap();
    status.reason = Reason::from_code(bits).unwrap_or_default();
    [status.holster_right, status.holster_left, status.holster_centre] = [bits, bits >> 4, bits >> 2];
    (status.link_running, status.joystick_grip) = (link, JoystickGrip::from_code(button).unwrap());
    memory.quick_change.header = header;
    memory.quick_change.status.report = QuickChangeReport::from_code(tick.ring.0).unwrap();
    memory.quick_change.status.end_effector_id = given(tick.ring.1);
    memory.grip.header = header;
    memory.grip.status.report = GripReport::from_code(tick.grip.0).unwrap();
    (memory.grip.status.position, memory.grip.status.velocity) = (tick.grip.1, tick.grip.2);
    memory.grip.status.initialized = tick.ring.2;
    for jaws in [&mut memory.v_grip, &mut memory.tool_grip] {
        jaws.header = header;
        jaws.status.report = JawsReport::from_code(tick.jaws.0).unwrap();
        (jaws.status.size, jaws.status.velocity) = (tick.jaws.1, tick.jaws.2);
    }
    if tick.echoes {
        memory.prim.status.echo = commands.prim.number;
        memory.quick_change.status.echo = commands.quick_change.number;
        memory.grip.status.echo = commands.grip.number;
        memory.v_grip.status.echo = commands.v_grip.number;
        memory.tool_grip.status.echo = commands.tool_grip.number;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Nothing panics; only the attached gripper is commanded, only its process runs; a restored process writes the
    /// same bits.
    #[test]
    fn arbitrary_inputs_cause_no_panic(
        gripper in 0_u8..4,
        at in 1_usize..6,
        ticks in prop::collection::vec(nonsense(), 1..150),
    ) {
        let mut bench = Bench::ready(LOCATIONS[at], gripper);
        for tick in &ticks {
            bring(&mut bench, tick);
            bench.tick = bench.tick.next();
            let before = bench.memory;
            let inputs =
                Inputs { tick: bench.tick, memory: &before, external: &bench.external, data: &bench.data };
            let mut restored = Emove::default();
            Process::<taskdata::files::TaskData<'_>>::restore(&mut restored, *bench.process.state());
            let mut again = before.emove;
            restored.step(&inputs, &mut again);
            bench.process.step(&inputs, &mut bench.memory.emove);
            let (was, is) = (&before.emove, &bench.memory.emove);
            let image: [u8; EmoveOutputs::SIZE] = to_bytes(is);
            let twice: [u8; EmoveOutputs::SIZE] = to_bytes(&again);
            prop_assert!(image == twice);
            let attached = EmoveGripper::attached(&before);
            prop_assert_eq!(is.dormant, attached.dormancy());
            prop_assert!(was.grip.number == is.grip.number || attached == EmoveGripper::Parts);
            prop_assert!(was.v_grip.number == is.v_grip.number || attached == EmoveGripper::V);
            prop_assert!(was.tool_grip.number == is.tool_grip.number || attached == EmoveGripper::Tool);
            // Without a gripper id, the pins are ignored while the ring is locked.
            let locked = before.quick_change.status.ring == RingPosition::Locked;
            prop_assert!(!is.status.held.is_held() || attached != EmoveGripper::None || locked);
        }
    }
}
