//! E-move and the process of a gripper. Around them: Subtask, the fingers with or without a part, Prim, Quick
//! Change. The robot is at an object first. It moves to another location and back, if a search has such commands.

mod judge;
mod states;

use std::fmt::Debug;

use geometry::pose::Pose;
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, StatusReport,
    device::GripSensors,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip},
    quick_change::{QuickChangeReport, RingPosition},
};
use levels::{
    emove::{self, Emove, gripper::EmoveGripper},
    execution::{Execution, Outcome},
    places::robot_at,
};
use rcs_core::{handshake::Commander, tick::Tick};

use crate::{
    data::{data, emove_command, place, pose_of_point},
    frame::{self, Choice, Event, Half, Scene, Stepped},
    image::Image,
    robot::{self, PrimDoes, Robot, is_at},
    search::Wrong,
};

pub type Line = (EmoveVerb, Option<&'static str>); // a location other than the object's

pub trait Fingered: Stepped {
    const GRIPPER: EmoveGripper;
    const OBJECT: (&'static str, i32, &'static str); // object, grip, location of the robot
    const LIMIT: u64; // ticks, the greatest age within the time limit of a command
    const COUNTERS: &'static [(&'static str, u8)];
    /// Ticks until E-move must report that the part is gone.
    const LATE: u8;

    type Fingers: Copy + Debug + PartialEq;
    const OPEN: Self::Fingers;

    fn first() -> Self;
    /// Next states of the fingers, and whether they are prompt.
    fn next(&self, fingers: Self::Fingers) -> Vec<(Self::Fingers, bool)>;
    /// True if a long time may have passed when the fingers reach this state.
    fn may_be_long(&self, fingers: Self::Fingers, next: (Self::Fingers, bool)) -> bool;
    fn sensors(&self, fingers: Self::Fingers) -> GripSensors;
    fn are_around(fingers: Self::Fingers) -> bool;
    fn hold(fingers: Self::Fingers) -> bool;
    fn touch(fingers: Self::Fingers) -> bool;
    fn are_open(fingers: Self::Fingers) -> bool;

    fn write(&self, memory: &mut CommonMemory, stamp: Tick);
    fn execution(&mut self) -> &mut Execution;
    fn reports_executing(&self) -> bool;
    fn rests(&self) -> bool;
    fn presses(&self) -> bool;
    fn echo(&self) -> u32;

    fn number(outputs: &mut EmoveOutputs) -> &mut u32;
    fn renumber(&mut self, commander: &mut Commander, number: &mut u32);
    fn commander(state: &mut emove::State) -> &mut Commander;
    fn forget(&mut self, tick: Tick);
    fn forget_order(outputs: &mut EmoveOutputs);
    fn add_to(&self, outputs: &EmoveOutputs, image: &mut Image);
}

pub fn is_done(outputs: &EmoveOutputs, number: u32) -> bool {
    outputs.status.echo == number && outputs.status.report == StatusReport::Done
}

#[derive(Clone)]
pub struct Around<G: Fingered> {
    object_at: Pose, // pose of the robot at the object
    fingers: G::Fingers,
    apart: u8, // ticks for which the fingers have been empty
    robot: Robot,
    quick_change: u32,
}

pub type Pair<G> = frame::Pair<Around<G>>;

/// The first tick of a started system, with a calibrated gripper that is open around the object. The commands can
/// arrive, `early` of them before the last one has ended (any number for `None`), and `restarts` restarts occur.
pub fn first<G: Fingered>(commands: &[Line], early: Option<u8>, restarts: u8) -> Pair<G> {
    let (object, grip, location) = G::OBJECT;
    let at = place(location);
    let object = emove_command(EmoveVerb::None, object, grip, location).object.unwrap_or_default();
    let there = data().grip_movetable(&object, grip, &at.place);
    let there = there.map_or(at.frame, |there| data().moved(&at.frame, there));
    let stands = robot_at(GoneTo::Object(ObjectGrip { object, grip }), &at, &there);
    let around = Around {
        object_at: stands.pose,
        fingers: G::OPEN,
        apart: G::LATE + 1,
        robot: Robot::new(stands.pose),
        quick_change: 0,
    };
    let mut pair = Pair::new(commands, (early, restarts), G::first(), around);
    let Half { state: emove, out } = &mut pair.upper;
    out.estimates.place = Some(stands);
    emove.adopt(&out.estimates);
    emove.exchange.adopt_gripper(G::GRIPPER);
    out.status.end_effector_id = G::GRIPPER.id();
    emove.execution.receiver.started = true;
    pair.lower.execution().receiver.started = true;
    pair
}

impl<G: Fingered> Scene for Around<G> {
    type Upper = Half<Emove>;
    type Lower = G;
    type Line = Line;
    type Command = EmoveCommand;
    type Does = (G::Fingers, PrimDoes);
    /// Longer than the time limit of a gripper's command.
    const LONG: u64 = 200;
    const COMMANDS_IN_MISHAPS: bool = true;

    fn choices(pair: &Pair<G>) -> Vec<Choice<Self::Does>> {
        let moving = pair.is_moving();
        let prim: &[PrimDoes] =
            if moving { &[PrimDoes::Goes, PrimDoes::Ends, PrimDoes::Fails] } else { &[PrimDoes::Goes] };
        let mut choices = Vec::new();
        for &prim in prim {
            for (fingers, arrive) in pair.next() {
                let waits = !moving && pair.is_settled();
                let long = waits && pair.lower.may_be_long(pair.scene.fingers, (fingers, arrive));
                let prompt = arrive && (!moving || prim != PrimDoes::Goes);
                choices.push(Choice { long, ..Choice::new((fingers, prim), prompt) });
            }
        }
        choices
    }

    fn has_ended(pair: &Pair<G>) -> bool {
        let status = &pair.upper.out.status;
        status.echo == pair.command.number && status.report != StatusReport::Executing
    }

    fn is_other(pair: &Pair<G>, (verb, _): &Line) -> bool {
        *verb != pair.command.command
    }

    /// RELEASE arrives only where E-move reports that the robot is at a place.
    fn may(pair: &Pair<G>, (verb, _): &Line) -> bool {
        *verb != EmoveVerb::Release || pair.upper.out.status.at.is_some()
    }

    fn command(pair: &mut Pair<G>, nth: usize) {
        let (verb, to) = pair.lines[nth];
        let (object, grip, location) = G::OBJECT;
        let location = to.unwrap_or(location);
        let pose = robot::goes(verb).then(|| pose_of_point(location));
        let (number, end_effector_id) = (pair.command.number + 1, G::GRIPPER.id());
        pair.command =
            EmoveCommand { number, end_effector_id, pose, ..emove_command(verb, object, grip, location) };
    }

    fn inputs(pair: &Pair<G>) -> (CommonMemory, ExternalInputs) {
        let before = pair.tick.previous();
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        memory.subtask.emove = pair.command;
        memory.emove = pair.upper.out;
        pair.lower.write(&mut memory, before);
        pair.scene.robot.write(&mut memory, before);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (pair.scene.quick_change, QuickChangeReport::Locked);
        (status.end_effector_id, status.ring) = (G::GRIPPER.id(), RingPosition::Locked);
        for header in [&mut memory.subtask.header, &mut memory.emove.header, &mut memory.quick_change.header]
        {
            header.stamp = before;
        }
        let devices = &mut external.devices;
        devices.grip = pair.lower.sensors(pair.scene.fingers);
        let id = G::GRIPPER.id().unwrap_or_default();
        (devices.quick_change.locked, devices.quick_change.end_effector_id) = (true, id);
        (memory, external)
    }

    fn act(pair: &mut Pair<G>, event: &Event<Self::Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        let (fingers, prim) = event.does;
        let around = &mut pair.scene;
        around.robot.take(memory)?;
        around.robot.does(prim);
        around.quick_change = memory.emove.quick_change.number;
        around.fingers = fingers;
        around.apart = if G::are_around(fingers) { 0 } else { (around.apart + 1).min(G::LATE + 1) };
        Ok(())
    }

    fn judge(pair: &Pair<G>, before: &Pair<G>, event: &Event<Self::Does>) -> Result<(), Wrong> {
        pair.judge(before, event)
    }

    fn judge_rest(pair: &Pair<G>, before: &Pair<G>, event: &Event<Self::Does>) -> Result<(), Wrong> {
        if event.told.is_none() && event.mishaps == 0 { pair.judge_held(before) } else { Ok(()) }
    }

    fn renumber(pair: &mut Pair<G>) {
        pair.renumber();
    }

    fn image(pair: &Pair<G>) -> Vec<u8> {
        pair.alike()
    }

    fn rests(pair: &Pair<G>) -> bool {
        let over =
            pair.upper.state.execution.outcome != Outcome::Executing && !pair.upper.state.execution.waiting;
        Self::has_ended(pair) && over && pair.is_settled() && pair.lower.rests() && !pair.is_moving()
    }

    fn pauses(pair: &Pair<G>) -> bool {
        pair.command.command == EmoveVerb::Pause
    }
}

impl<G: Fingered> Pair<G> {
    fn is_at_object(&self) -> bool {
        is_at(&self.scene.object_at, &self.scene.robot.at)
    }

    /// A part is only at the object's place, or between the fingers.
    fn next(&self) -> Vec<(G::Fingers, bool)> {
        let mut next = self.lower.next(self.scene.fingers);
        if !self.is_at_object() && !G::touch(self.scene.fingers) {
            next.retain(|(fingers, _)| !G::touch(*fingers));
        }
        next
    }

    /// The gripper's process has read its last command, and E-move its echo.
    fn is_settled(&self) -> bool {
        let number = *G::number(&mut { self.upper.out });
        let read = self.lower.clone().execution().receiver.echo;
        (number == 0 || (number == self.lower.echo() && number == read))
            && self.upper.out.quick_change.number == self.scene.quick_change
    }

    fn is_moving(&self) -> bool {
        self.scene.robot.is_busy(&self.upper.out.prim)
    }
}
