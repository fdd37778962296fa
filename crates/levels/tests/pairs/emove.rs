//! E-move and the process of a gripper. Around them: Subtask, the fingers with a part or without, Prim, Quick Change.
//! The robot stands at an object first. It goes to another location and back, if a search has such commands.

mod judge;
mod states;

use std::fmt::Debug;

use geometry::pose::Pose;
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, StatusReport,
    device::GripSensors,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip},
    process::{Inputs, Process},
    quick_change::{QuickChangeReport, RingPosition},
};
use levels::{
    emove::{self, Emove, gripper::Gripper},
    execution::{Execution, Outcome},
    places::robot_at,
};
use rcs_core::{handshake::Commander, tick::Tick};

use crate::{
    data::{data, emove_command, place, pose_of_point},
    image::Image,
    robot::{self, PrimDoes, Robot, is_at},
    search::{Mishap, World, Wrong, resumed},
};

/// A command of Subtask, and the location to which it goes if that is not the object's.
pub type Line = (EmoveVerb, Option<&'static str>);

/// Longer than the time limit of a gripper's command.
const LONG: u64 = 200;

/// The process of a gripper, its outputs, and its fingers.
pub trait Fingered: Clone {
    const GRIPPER: Gripper;
    /// The object, its grip, and where the robot stands.
    const OBJECT: (&'static str, i32, &'static str);
    /// The greatest age that is within the time limit of a command, ticks.
    const LIMIT: u64;
    /// Fields that count up to a greatest value.
    const COUNTERS: &'static [(&'static str, u8)];
    /// Ticks for which E-move need not know that the part has gone.
    const LATE: u8;

    type Fingers: Copy + Debug + PartialEq;
    const OPEN: Self::Fingers;

    /// A process that waits for a command, with open fingers.
    fn first() -> Self;
    /// Where the fingers can be in the next tick, and whether that is prompt.
    fn next(&self, fingers: Self::Fingers) -> Vec<(Self::Fingers, bool)>;
    /// May a long time have passed, if they are there in the next tick?
    fn may_be_long(&self, fingers: Self::Fingers, next: (Self::Fingers, bool)) -> bool;
    fn sensors(&self, fingers: Self::Fingers) -> GripSensors;
    fn are_around(fingers: Self::Fingers) -> bool;
    /// They hold the part.
    fn hold(fingers: Self::Fingers) -> bool;
    /// They touch the part, or hold it.
    fn touch(fingers: Self::Fingers) -> bool;
    fn are_open(fingers: Self::Fingers) -> bool;

    fn write(&self, memory: &mut CommonMemory, stamp: Tick);
    fn step(&mut self, inputs: &Inputs<'_, ()>);
    fn execution(&mut self) -> &mut Execution;
    fn reports_executing(&self) -> bool;
    /// Nothing moves the fingers.
    fn rests(&self) -> bool;
    /// What the fingers are around is pressed.
    fn presses(&self) -> bool;
    /// Begin again, with the outputs of before.
    fn restart(&mut self);
    fn echo(&self) -> u32;

    fn number(outputs: &mut EmoveOutputs) -> &mut u32;
    fn renumber(&mut self, commander: &mut Commander, number: &mut u32);
    fn commander(state: &mut emove::State) -> &mut Commander;
    /// Take away what no row asks for any more.
    fn forget(&mut self, tick: Tick);
    /// Take away the text of an order that has been taken.
    fn forget_order(outputs: &mut EmoveOutputs);
    fn add_to(&self, outputs: &EmoveOutputs, image: &mut Image);
}

/// Run the process of a gripper for a tick, from one state to the next.
pub fn run<P>(state: &mut P::State, inputs: &Inputs<'_, ()>, outputs: &mut P::Outputs)
where
    P: Process<(), State: Copy> + Default,
{
    let mut process = P::default();
    process.restore(*state);
    process.step(inputs, outputs);
    *state = *process.state();
}

/// Has E-move reported a command done?
pub fn is_done(outputs: &EmoveOutputs, number: u32) -> bool {
    outputs.status.echo == number && outputs.status.report == StatusReport::Done
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event<Fingers> {
    pub told: Option<Line>,
    pub fingers: Fingers,
    pub prim: PrimDoes,
    pub mishap: Mishap,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair<G: Fingered> {
    tick: Tick,
    commands: &'static [Line],
    /// Where the robot is at the object.
    object_at: Pose,
    /// Commands that may still come before the last one has ended (any number if none is given), and restarts that may.
    left: (Option<u8>, u8),
    command: EmoveCommand,
    emove: emove::State,
    emove_out: EmoveOutputs,
    gripper: G,
    fingers: G::Fingers,
    /// Ticks for which nothing has been between them.
    apart: u8,
    robot: Robot,
    quick_change: u32,
}

impl<G: Fingered> Pair<G> {
    /// The first tick of a system that is booted, with a gripper that is calibrated and open around the object. These
    /// commands can come, `early` of them before the last one has ended (any number if none is given), and so many
    /// `restarts`.
    pub fn first(commands: &'static [Line], early: Option<u8>, restarts: u8) -> Self {
        let (object, grip, location) = G::OBJECT;
        let at = place(location);
        let object = emove_command(EmoveVerb::None, object, grip, location).object.unwrap_or_default();
        let there = data().grip_movetable(&object, grip, &at.place);
        let there = there.map_or(at.frame, |there| data().moved(&at.frame, there));
        let stands = robot_at(GoneTo::Object(ObjectGrip { object, grip }), &at, &there);
        let mut pair = Self {
            tick: Tick(10_000),
            commands,
            object_at: stands.pose,
            left: (early, restarts),
            command: EmoveCommand::default(),
            emove: emove::State::default(),
            emove_out: EmoveOutputs::default(),
            gripper: G::first(),
            fingers: G::OPEN,
            apart: G::LATE + 1,
            robot: Robot::new(stands.pose),
            quick_change: 0,
        };
        pair.emove_out.beliefs.place = Some(stands);
        pair.emove.adopt(&pair.emove_out.beliefs);
        pair.emove.exchange.adopt_gripper(G::GRIPPER);
        pair.emove_out.status.end_effector_id = G::GRIPPER.id();
        pair.emove.execution.receiver.started = true;
        pair.gripper.execution().receiver.started = true;
        pair
    }

    fn tell(&mut self, (verb, to): Line) {
        let (object, grip, location) = G::OBJECT;
        let location = to.unwrap_or(location);
        let pose = robot::goes(verb).then(|| pose_of_point(location));
        let (number, end_effector_id) = (self.command.number + 1, G::GRIPPER.id());
        self.command =
            EmoveCommand { number, end_effector_id, pose, ..emove_command(verb, object, grip, location) };
    }

    /// The robot stands at the object.
    fn is_at_object(&self) -> bool {
        is_at(&self.object_at, &self.robot.at)
    }

    /// What the processes read.
    fn memory(&self) -> CommonMemory {
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.subtask.emove = self.command;
        memory.emove = self.emove_out;
        self.gripper.write(&mut memory, before);
        self.robot.write(&mut memory, before);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.quick_change, QuickChangeReport::Locked);
        (status.end_effector_id, status.ring) = (G::GRIPPER.id(), RingPosition::Locked);
        for header in [&mut memory.subtask.header, &mut memory.emove.header, &mut memory.quick_change.header]
        {
            header.stamp = before;
        }
        memory
    }
}

impl<G: Fingered> World for Pair<G> {
    type Event = Event<G::Fingers>;

    fn events(&self) -> Vec<(Event<G::Fingers>, bool)> {
        let moving = self.is_moving();
        let prim: &[PrimDoes] =
            if moving { &[PrimDoes::Goes, PrimDoes::Ends, PrimDoes::Fails] } else { &[PrimDoes::Goes] };
        let mishaps = Mishap::choices(self.left.1, Mishap::RESTARTS);
        let mut events = Vec::new();
        for told in self.commands() {
            for &prim in prim {
                for (fingers, arrive) in self.next() {
                    for &mishap in &mishaps {
                        let event = Event { told, fingers, prim, mishap, long: false };
                        let quiet = told.is_none() && mishap == Mishap::None;
                        events.push((event, quiet && arrive && (!moving || prim != PrimDoes::Goes)));
                        let waits = quiet && !moving && self.is_settled();
                        if waits && self.gripper.may_be_long(self.fingers, (fingers, arrive)) {
                            events.push((Event { long: true, ..event }, true));
                        }
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Self::Event) -> Result<(), Wrong> {
        let old = self.clone();
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut process: Emove = resumed(self.emove, event.mishap == Mishap::RestartUpper);
        if event.mishap == Mishap::RestartLower {
            self.gripper.restart();
        }
        self.left.1 -= u8::from(event.mishap != Mishap::None);
        if let Some(line) = event.told {
            if !self.has_ended() {
                self.left.0 = self.left.0.map(|early| early - 1);
            }
            self.tell(line);
        }
        let memory = self.memory();
        let mut external = ExternalInputs::default();
        let devices = &mut external.devices;
        devices.grip = self.gripper.sensors(self.fingers);
        let id = G::GRIPPER.id().unwrap_or_default();
        (devices.quick_change.locked, devices.quick_change.end_effector_id) = (true, id);
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let mut emove_out = self.emove_out;
        process.step(&inputs, &mut emove_out);
        self.gripper.step(&Inputs { tick: self.tick, memory: &memory, external: &external, data: &() });
        // Prim and Quick Change read what was written in the tick before.
        self.robot.take(&memory)?;
        self.robot.does(event.prim);
        self.quick_change = memory.emove.quick_change.number;
        self.fingers = event.fingers;
        self.apart = if G::are_around(self.fingers) { 0 } else { (self.apart + 1).min(G::LATE + 1) };
        self.emove_out = emove_out;
        self.emove = *process.state();
        self.judge(&old, &event)?;
        self.renumber();
        if event.told.is_none() { self.judge_held(&old) } else { Ok(()) }
    }

    fn image(&self) -> Vec<u8> {
        self.alike()
    }

    fn rests(&self) -> bool {
        let over = self.emove.execution.outcome != Outcome::Executing && !self.emove.execution.waiting;
        self.has_ended() && over && self.is_settled() && self.gripper.rests() && !self.is_moving()
    }

    fn pauses(&self) -> bool {
        self.command.command == EmoveVerb::Pause
    }
}

impl<G: Fingered> Pair<G> {
    fn has_ended(&self) -> bool {
        let status = &self.emove_out.status;
        status.echo == self.command.number && status.report != StatusReport::Executing
    }

    /// Where the fingers can be in the next tick. A part is only at the object's place, or between them.
    fn next(&self) -> Vec<(G::Fingers, bool)> {
        let mut next = self.gripper.next(self.fingers);
        if !self.is_at_object() && !G::touch(self.fingers) {
            next.retain(|(fingers, _)| !G::touch(*fingers));
        }
        next
    }

    /// Any command can come when the last one has ended, and another one than it before. RELEASE comes only where
    /// E-move says that the robot is at a place.
    fn commands(&self) -> Vec<Option<Line>> {
        let (ended, early) = (self.has_ended(), self.left.0 != Some(0));
        let at_place = self.emove_out.status.at.is_some();
        let may = |line: &&Line| {
            (ended || (early && line.0 != self.command.command)) && (at_place || line.0 != EmoveVerb::Release)
        };
        core::iter::once(None).chain(self.commands.iter().filter(may).map(|line| Some(*line))).collect()
    }

    /// The gripper's process has read its last command, and E-move its echo.
    fn is_settled(&self) -> bool {
        let number = *G::number(&mut { self.emove_out });
        let read = self.gripper.clone().execution().receiver.echo;
        (number == 0 || (number == self.gripper.echo() && number == read))
            && self.emove_out.quick_change.number == self.quick_change
    }

    /// Prim has not ended its last order.
    fn is_moving(&self) -> bool {
        self.robot.is_busy(&self.emove_out.prim)
    }
}
