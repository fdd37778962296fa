//! V-Grip and Tool-Grip, the processes of the grippers that open and close, and their fingers. The fingers have no
//! force sensor, and air presses them until another command arrives.

use std::marker::PhantomData;

use interfaces::{
    CommonMemory, EmoveOutputs, JawsOutputs,
    device::GripSensors,
    grip::Felt,
    jaws::{JawsCommand, JawsReport},
    process::Inputs,
};
use levels::{
    emove::{self, gripper::EmoveGripper},
    execution::{Execution, Outcome},
    jaws::{
        CylindricalPartGripper, Jaws as Real, JawsKind, POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE,
        ToolGripper, state::State,
    },
};
use rcs_core::{handshake::Commander, tick::Tick};

use crate::{
    emove::Fingered,
    frame::{Data, Half, Stepped},
    image::{Image, rebase},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fingers {
    Open,
    Wide,
    Holding,
    Closed,
}

pub trait Side: JawsKind + Clone + Default {
    const GRIPPER: EmoveGripper;
    const OBJECT: (&'static str, i32, &'static str);
    /// Grasp size of the object, in.
    const PART: f64;

    fn commander(state: &mut emove::State) -> &mut Commander;
    fn order(outputs: &mut EmoveOutputs) -> &mut JawsCommand;
    fn outputs(memory: &mut CommonMemory) -> &mut JawsOutputs;
}

impl Side for CylindricalPartGripper {
    const GRIPPER: EmoveGripper = EmoveGripper::V;
    const OBJECT: (&'static str, i32, &'static str) = ("SHAFT", -1, "V-VFIXTURE");
    const PART: f64 = 1.4;

    fn commander(state: &mut emove::State) -> &mut Commander {
        state.grippers.commander(EmoveGripper::V)
    }

    fn order(outputs: &mut EmoveOutputs) -> &mut JawsCommand {
        &mut outputs.v_grip
    }

    fn outputs(memory: &mut CommonMemory) -> &mut JawsOutputs {
        &mut memory.v_grip
    }
}

impl Side for ToolGripper {
    const GRIPPER: EmoveGripper = EmoveGripper::Tool;
    const OBJECT: (&'static str, i32, &'static str) = ("DRILL-2", 1, "TOOL-SAFE");
    const PART: f64 = 1.75;

    fn commander(state: &mut emove::State) -> &mut Commander {
        state.grippers.commander(EmoveGripper::Tool)
    }

    fn order(outputs: &mut EmoveOutputs) -> &mut JawsCommand {
        &mut outputs.tool_grip
    }

    fn outputs(memory: &mut CommonMemory) -> &mut JawsOutputs {
        &mut memory.tool_grip
    }
}

#[derive(Clone)]
pub struct Jaws<S: Side> {
    half: Half<Real<S>>,
    side: PhantomData<S>,
}

impl<S: Side> Jaws<S> {
    fn reading(fingers: Fingers) -> u16 {
        let opening = match fingers {
            Fingers::Open => S::PARAMETERS.opened,
            Fingers::Wide => S::PART + 1.0,
            Fingers::Holding => S::PART,
            Fingers::Closed => S::PARAMETERS.closed,
        };
        (POTENTIOMETER_OFFSET + POTENTIOMETER_SCALE * opening).round() as u16
    }
}

impl<S: Side> Stepped for Jaws<S> {
    fn step(&mut self, inputs: &Inputs<'_, Data>) {
        self.half.step(inputs);
    }

    fn restart(&mut self) {
        self.half.restart();
    }
}

impl<S: Side> Fingered for Jaws<S> {
    const GRIPPER: EmoveGripper = S::GRIPPER;
    const OBJECT: (&'static str, i32, &'static str) = S::OBJECT;
    const LIMIT: u64 = 100;
    const COUNTERS: &'static [(&'static str, u8)] =
        &[("attached_ticks", 5), ("air_ticks", 6), ("gripping_ticks", 25)];
    /// The process reads the fingers one tick later, and E-move its status another tick later.
    const LATE: u8 = 2;

    type Fingers = Fingers;
    const OPEN: Fingers = Fingers::Open;

    fn first() -> Self {
        let counts = Self::reading(Fingers::Open);
        let state =
            State { window: Some([counts; 4]), attached_ticks: 10, air_ticks: 10, ..State::default() };
        let mut out = JawsOutputs::default();
        (out.status.size, out.status.felt) = (S::GRIPPER.closed() + 300, Felt::Nothing);
        Self { half: Half { state, out }, side: PhantomData }
    }

    /// The process treats fingers at rest as stopped, at any place.
    fn next(&self, fingers: Fingers) -> Vec<(Fingers, bool)> {
        use Fingers::{Closed, Holding, Open, Wide};
        let valves = self.half.out.valves;
        let also: &[(Fingers, bool)] = match (valves.open, valves.close, fingers) {
            (true, _, Closed | Holding) => &[(Wide, true), (Open, true)],
            (true, _, Wide) => &[(Open, true)],
            (_, true, Open) => &[(Wide, true), (Holding, true), (Closed, true)],
            (_, true, Wide) => &[(Holding, true), (Closed, true)],
            // The part slips out.
            (_, true, Holding) => &[(Closed, false)],
            _ => &[],
        };
        [&[(fingers, true)], also].concat()
    }

    /// The fingers moved, and will not rest within the time limit.
    fn may_be_long(&self, fingers: Fingers, (next, _): (Fingers, bool)) -> bool {
        let still =
            self.half.state.window.is_some_and(|window| window.iter().all(|counts| *counts == window[0]));
        let goes = self.half.out.valves.open || self.half.out.valves.close;
        next == fingers && goes && !still && self.half.state.execution.outcome == Outcome::Executing
    }

    fn sensors(&self, fingers: Fingers) -> GripSensors {
        GripSensors { potentiometer: Self::reading(fingers), strain_left: 0, strain_right: 0, beams: 0 }
    }

    fn are_around(fingers: Fingers) -> bool {
        fingers == Fingers::Holding
    }

    fn hold(fingers: Fingers) -> bool {
        Self::are_around(fingers)
    }

    fn touch(fingers: Fingers) -> bool {
        Self::are_around(fingers)
    }

    fn are_open(fingers: Fingers) -> bool {
        fingers == Fingers::Open
    }

    fn write(&self, memory: &mut CommonMemory, stamp: Tick) {
        let outputs = S::outputs(memory);
        *outputs = self.half.out;
        outputs.header.stamp = stamp;
    }

    fn execution(&mut self) -> &mut Execution {
        &mut self.half.state.execution
    }

    fn reports_executing(&self) -> bool {
        self.half.out.status.report == JawsReport::Executing
    }

    fn rests(&self) -> bool {
        self.half.state.execution.outcome != Outcome::Executing
    }

    fn presses(&self) -> bool {
        self.half.out.valves.close
    }

    fn echo(&self) -> u32 {
        self.half.out.status.echo
    }

    fn number(outputs: &mut EmoveOutputs) -> &mut u32 {
        &mut S::order(outputs).number
    }

    fn renumber(&mut self, commander: &mut Commander, number: &mut u32) {
        let read = &mut self.half.state.execution.receiver.echo;
        rebase(commander, &mut [number, read, &mut self.half.out.status.echo]);
    }

    fn commander(state: &mut emove::State) -> &mut Commander {
        S::commander(state)
    }

    fn forget(&mut self, tick: Tick) {
        let state = &mut self.half.state;
        if state.execution.outcome != Outcome::Executing {
            (state.step, state.verb, state.since) = (Default::default(), Default::default(), tick);
        }
    }

    fn forget_order(outputs: &mut EmoveOutputs) {
        let order = S::order(outputs);
        let JawsCommand { number, command, size, .. } = *order;
        *order = JawsCommand { number, command, size, ..JawsCommand::default() };
    }

    fn add_to(&self, outputs: &EmoveOutputs, image: &mut Image) {
        let status = &self.half.out.status;
        image.add(S::order(&mut { *outputs }));
        image.add(&self.half.state);
        image.add(&status.echo);
        image.add(&status.report);
        image.add(&status.felt);
        image.add(&status.size);
        image.add(&status.velocity);
        image.add(&self.half.out.valves);
    }
}
