use interfaces::{
    CommonMemory, EmoveOutputs, GripOutputs,
    device::GripSensors,
    grip::{Felt, GripCommand, GripReport, GripVerb},
    process::Inputs,
};
use levels::{
    emove::{self, gripper::EmoveGripper},
    execution::{Execution, Outcome},
    grip::{self, tables::GripPhase},
};
use rcs_core::{handshake::Commander, tick::Tick};

use crate::{
    emove::Fingered,
    fingers::{Fingers, Sizes, calibration, flow},
    frame::{Data, Half, Stepped},
    image::{Image, rebase},
};

/// Depart size of the object, slightly more than its grasp size, 0.01 in, and its force, lb.
const SIZES: Sizes = Sizes { open: 350, part: 66, force: 30 };

#[derive(Clone)]
pub struct Grip {
    half: Half<grip::Grip>,
    /// Open fingers are at the last opening to which air has moved them.
    sizes: Sizes,
    /// Air moves them to an opening wider than the part.
    positions: bool,
}

impl Stepped for Grip {
    fn step(&mut self, inputs: &Inputs<'_, Data>) {
        self.half.step(inputs);
        let GripCommand { command, position, .. } = inputs.memory.emove.grip;
        let (opens, closes) = flow(self.half.out.valves.bits);
        self.positions = command == GripVerb::Position && (opens || closes);
        if self.positions || (opens && command == GripVerb::OpenGrip) {
            self.sizes.open = u16::try_from(position).unwrap_or_default();
        }
    }

    fn restart(&mut self) {
        self.half.restart();
    }
}

impl Fingered for Grip {
    const GRIPPER: EmoveGripper = EmoveGripper::Parts;
    const OBJECT: (&'static str, i32, &'static str) = ("LINKBAR1", 2, "PFIXTURE");
    const LIMIT: u64 = 150;
    const COUNTERS: &'static [(&'static str, u8)] =
        &[("settled", 6), ("missed", 3), ("touch_ticks", 5), ("still_ticks", 5), ("unfelt", 6)];
    const LATE: u8 = 0;

    type Fingers = Fingers;
    const OPEN: Fingers = Fingers::Open;

    fn first() -> Self {
        let calibration = Some(calibration());
        let mut out = GripOutputs { calibration, ..GripOutputs::default() };
        let status = &mut out.status;
        (status.initialized, status.position, status.felt) = (true, i32::from(SIZES.open), Felt::Nothing);
        Self {
            half: Half {
                state: grip::state::State {
                    phase: GripPhase::Valid,
                    calibration,
                    ..grip::state::State::default()
                },
                out,
            },
            sizes: SIZES,
            positions: false,
        }
    }

    /// Fingers that release may stop while one of them touches the part.
    fn next(&self, fingers: Fingers) -> Vec<(Fingers, bool)> {
        if self.positions {
            return vec![(fingers, false), (Fingers::Open, true)];
        }
        let bits = self.half.out.valves.bits;
        let mut next = fingers.next(bits);
        if fingers == Fingers::Holding && flow(bits).0 {
            next.push((Fingers::Touching, false));
        }
        next
    }

    fn may_be_long(&self, fingers: Fingers, (next, arrive): (Fingers, bool)) -> bool {
        let it = &self.half.state;
        let read = it.sensed.map(|sensed| sensed.last) == Some(self.sensors(fingers));
        next == fingers && !arrive && read && it.still_ticks >= 5 && it.touch_ticks >= 5
    }

    fn sensors(&self, fingers: Fingers) -> GripSensors {
        fingers.sensors(&self.sizes)
    }

    fn are_around(fingers: Fingers) -> bool {
        matches!(fingers, Fingers::Holding | Fingers::Emptied)
    }

    fn hold(fingers: Fingers) -> bool {
        fingers == Fingers::Holding
    }

    fn touch(fingers: Fingers) -> bool {
        matches!(fingers, Fingers::Touching | Fingers::Holding)
    }

    fn are_open(fingers: Fingers) -> bool {
        matches!(fingers, Fingers::Open | Fingers::Drifted)
    }

    fn write(&self, memory: &mut CommonMemory, stamp: Tick) {
        memory.grip = self.half.out;
        memory.grip.header.stamp = stamp;
    }

    fn execution(&mut self) -> &mut Execution {
        &mut self.half.state.execution
    }

    fn reports_executing(&self) -> bool {
        self.half.out.status.report == GripReport::Executing
    }

    fn rests(&self) -> bool {
        self.half.state.execution.outcome != Outcome::Executing
            && flow(self.half.out.valves.bits) == (false, false)
    }

    /// They also hold it without air.
    fn presses(&self) -> bool {
        true
    }

    fn echo(&self) -> u32 {
        self.half.out.status.echo
    }

    fn number(outputs: &mut EmoveOutputs) -> &mut u32 {
        &mut outputs.grip.number
    }

    fn renumber(&mut self, commander: &mut Commander, number: &mut u32) {
        let read = &mut self.half.state.execution.receiver.echo;
        rebase(commander, &mut [number, read, &mut self.half.out.status.echo]);
    }

    fn commander(state: &mut emove::State) -> &mut Commander {
        state.grippers.commander(EmoveGripper::Parts)
    }

    fn forget(&mut self, tick: Tick) {
        let state = &mut self.half.state;
        if state.execution.outcome != Outcome::Executing {
            (state.step, state.goal, state.settled, state.missed) = Default::default();
            state.since = tick;
        }
        state.steady = Default::default();
    }

    fn forget_order(outputs: &mut EmoveOutputs) {
        let GripCommand { number, command, .. } = outputs.grip;
        outputs.grip = GripCommand { number, command, ..GripCommand::default() };
    }

    fn add_to(&self, outputs: &EmoveOutputs, image: &mut Image) {
        let status = &self.half.out.status;
        image.add(&outputs.grip);
        image.add(&self.half.state);
        image.add(&status.echo);
        image.add(&status.report);
        image.add(&status.felt);
        image.add(&status.initialized);
        image.add(&status.position);
        image.add(&status.left_force);
        image.add(&status.right_force);
        image.add(&status.velocity);
        image.bytes.extend([self.half.out.valves.bits, self.positions.into()]);
    }
}
