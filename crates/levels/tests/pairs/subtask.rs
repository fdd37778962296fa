//! Subtask and E-move. Around them: Task, Prim with the robot, Grip with its fingers, vision. Quick Change is locked on
//! the parts gripper.
//!
//! What is abstracted: a motion is one step, after which the robot is at its goal or, if it fails or is stopped, where
//! it was. Fingers are open, around the part, or have closed on nothing; closing fingers find something anywhere.
//! Vision sees the object where the data have it, sees nothing, or does not answer.

mod judge;
mod states;

use std::sync::Arc;

use interfaces::{
    ChangingPose, CommonMemory, EmoveOutputs, ExternalInputs, StatusReport, SubtaskOutputs,
    device::{QuickChangeSensors, VisionResponse, VisionStatus},
    emove::GoneTo,
    process::{Inputs, Process},
    quick_change::{QuickChangeReport, RingPosition},
    subtask::{SubtaskCommand, SubtaskVerb},
};
use levels::{
    emove::{self, Emove, gripper::Gripper, tables::Ordered},
    execution::{Execution, Outcome},
    places::robot_at,
    subtask::{self, Subtask},
};
use rcs_core::tick::Tick;

use crate::{
    data::{data, place, subtask_command},
    image::Image,
    parts_gripper::{GripDoes, PartsGripper},
    robot::{PrimDoes, Robot},
    search::{Mishap, World, Wrong, resumed},
};

/// Ticks after which vision counts as silent, and more than that.
const LIMIT: u64 = 100;
const LONG: u64 = 200;
/// Opening of the fingers at the start, 0.01 in.
const OPENING: i32 = 300;
/// Ticks for which Subtask need not know that the part has gone.
const LATE: u8 = 3;

/// A command: its object, which is named or not, location, sector, and the number of its pose.
pub type Line = (SubtaskVerb, bool, &'static str, Option<i32>, u32);
pub const PAUSE: Line = (SubtaskVerb::Pause, false, "SAFE", None, 3);
pub const GET: Line = (SubtaskVerb::GetObject, true, "UNIT_2", Some(1), 1);
pub const PLACE: Line = (SubtaskVerb::PlaceObj, true, "UNIT_2", Some(2), 2);
pub const GOTO: Line = (SubtaskVerb::GotoDest, false, "SAFE", None, 3);
pub const BRING: Line = (SubtaskVerb::MoveObjToDest, true, "UNIT_2", Some(2), 2);
pub const POSITION: Line = (SubtaskVerb::Position, true, "UNIT_2", Some(1), 1);
pub const RELEASE: Line = (SubtaskVerb::Release, true, "UNIT_2", Some(2), 2);
pub const GRIPPER: Line = (SubtaskVerb::GetEndeff, true, "UNIT_2", Some(1), 1);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// A command that comes, from 0 in the list of commands.
    pub told: Option<usize>,
    pub prim: PrimDoes,
    pub grip: GripDoes,
    /// Vision answers.
    pub vision: Option<VisionStatus>,
    pub mishap: Mishap,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    /// Commands that may still come before the last one has ended, and mishaps that may.
    left: (u8, u8),
    commands: Arc<[(SubtaskCommand, ChangingPose)]>,
    command: SubtaskCommand,
    subtask: subtask::state::State,
    subtask_out: SubtaskOutputs,
    emove: emove::State,
    emove_out: EmoveOutputs,
    robot: Robot,
    grip: PartsGripper,
    quick_change: u32,
    vision: VisionResponse,
    /// E-move has written nothing in the last tick.
    silent: bool,
    /// Subtask has sent E-move an order of the current command.
    own: bool,
    /// Ticks for which nothing has been between the fingers.
    apart: u8,
    /// The fingers have let go of the part, or lost it, where it is to be placed.
    let_go: bool,
}

impl Pair {
    /// A robot at SAFE whose parts gripper is on and open. These commands can come, so many of them before the last one
    /// has ended, and so many mishaps.
    pub fn first(object: &str, lines: &[Line], early: u8, mishaps: u8) -> Self {
        let command = |&(verb, named, location, sector, nth): &Line| {
            subtask_command(verb, Some(object).filter(|_| named), location, sector, nth)
        };
        let commands: Vec<_> = lines.iter().map(command).collect();
        let safe = place("SAFE");
        let stands = robot_at(GoneTo::Location, &safe, &safe.frame);
        let mut pair = Self {
            tick: Tick(10_000),
            left: (early, mishaps),
            commands: commands.into(),
            command: SubtaskCommand::default(),
            subtask: subtask::state::State::default(),
            subtask_out: SubtaskOutputs::default(),
            emove: emove::State::default(),
            emove_out: EmoveOutputs::default(),
            robot: Robot::new(stands.pose),
            grip: PartsGripper::new(OPENING),
            quick_change: 0,
            vision: VisionResponse::default(),
            silent: false,
            own: false,
            apart: LATE + 1,
            let_go: false,
        };
        (pair.emove_out.beliefs.place, pair.emove_out.beliefs.empty) = (Some(stands), true);
        pair.emove.adopt(&pair.emove_out.beliefs);
        pair.emove.exchange.adopt_gripper(Gripper::Parts);
        pair.emove_out.status.end_effector_id = Gripper::Parts.id();
        pair.emove.execution.receiver.started = true;
        pair.subtask.execution.receiver.started = true;
        pair
    }

    /// What the processes read.
    fn memory(&self) -> CommonMemory {
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.task.subtask = self.command;
        for (record, (_, pose)) in memory.task.poses.iter_mut().zip(self.poses()) {
            *record = pose;
        }
        (memory.subtask, memory.emove) = (self.subtask_out, self.emove_out);
        self.robot.write(&mut memory, before);
        self.grip.write(&mut memory, before);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.quick_change, QuickChangeReport::Locked);
        (status.end_effector_id, status.ring) = (Gripper::Parts.id(), RingPosition::Locked);
        (memory.task.header.stamp, memory.subtask.header.stamp) = (before, before);
        (memory.quick_change.header.stamp, memory.pedestal.header.stamp) = (before, before);
        memory.emove.header.stamp = if self.silent { before.previous() } else { before };
        memory
    }

    /// The poses of the commands, each once.
    fn poses(&self) -> impl Iterator<Item = (u32, ChangingPose)> {
        let pose =
            |nth: u32| self.commands.iter().find(|(_, pose)| pose.number.is_some_and(|it| it & 0xFF == nth));
        (1..=3).filter_map(move |nth| pose(nth).map(|(_, pose)| (nth, *pose)))
    }

    /// The last command has ended, as Task reads it.
    fn has_ended(&self) -> bool {
        let status = &self.subtask_out.status;
        status.echo == self.command.number && status.report != StatusReport::Executing
    }

    /// E-move waits for a picture.
    fn awaits_vision(&self) -> bool {
        self.emove.execution.outcome == Outcome::Executing
            && self.emove.ordered == Ordered::Vision
            && self.vision.echo != self.emove_out.vision.number
    }

    /// Grip, Prim and vision read what E-move wrote in the tick before.
    fn surroundings(&mut self, event: Event, memory: &CommonMemory) -> Result<(), Wrong> {
        let full = self.grip.full;
        self.robot.take(memory)?;
        self.robot.does(event.prim);
        self.grip.does(event.grip, &memory.emove.grip)?;
        self.quick_change = memory.emove.quick_change.number;
        if let Some(status) = event.vision {
            let request = &memory.emove.vision;
            self.vision = VisionResponse {
                echo: request.number,
                status,
                recognised: Some(request.object_id),
                ..VisionResponse::default()
            };
        }
        self.apart = if self.grip.full { 0 } else { (self.apart + 1).min(LATE + 1) };
        if full || self.grip.full {
            self.let_go = !self.grip.full && self.is_destination(&self.robot.at);
        }
        Ok(())
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let moving = self.robot.is_busy(&self.emove_out.prim);
        let gripping = self.grip.is_busy(&self.emove_out.grip);
        let prim: &[_] =
            if moving { &[PrimDoes::Goes, PrimDoes::Ends, PrimDoes::LinkFails] } else { &[PrimDoes::Goes] };
        let grip: &[_] = match (gripping, self.grip.full) {
            (true, _) => &[GripDoes::Goes, GripDoes::Ends, GripDoes::Fails, GripDoes::Loses],
            (false, true) => &[GripDoes::Goes, GripDoes::Loses],
            (false, false) => &[GripDoes::Goes],
        };
        let looks = self.awaits_vision();
        let vision: &[_] =
            if looks { &[None, Some(VisionStatus::Done), Some(VisionStatus::NothingSeen)] } else { &[None] };
        let mut events = Vec::new();
        for told in self.commands() {
            for &prim in prim {
                for &grip in grip {
                    for &vision in vision {
                        let event = Event { told, prim, grip, vision, mishap: Mishap::None, long: false };
                        let ends = (!moving || prim != PrimDoes::Goes)
                            && (!looks || vision.is_some())
                            && if gripping { grip != GripDoes::Goes } else { grip == GripDoes::Goes };
                        events.push((event, told.is_none() && ends));
                        if told.is_none() && self.left.1 > 0 {
                            let all = [Mishap::RestartUpper, Mishap::RestartLower, Mishap::SilentLower];
                            events.extend(all.map(|mishap| (Event { mishap, ..event }, false)));
                        }
                        let waits = !moving && !gripping && self.is_settled() && told.is_none();
                        if looks && waits && vision.is_none() && grip == GripDoes::Goes {
                            events.push((Event { long: true, ..event }, true));
                        }
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut upper: Subtask = resumed(self.subtask, event.mishap == Mishap::RestartUpper);
        let mut lower: Emove = resumed(self.emove, event.mishap == Mishap::RestartLower);
        self.left.1 -= u8::from(event.mishap != Mishap::None);
        if let Some(nth) = event.told {
            self.left.0 -= u8::from(!self.has_ended() && self.command.number != 0);
            let number = self.command.number + 1;
            self.command = SubtaskCommand { number, ..self.commands[nth].0 };
            self.own = false;
        }
        let memory = self.memory();
        let mut external = ExternalInputs::default();
        external.devices.quick_change =
            QuickChangeSensors { locked: true, unlocked: false, end_effector_id: 1 };
        external.devices.vision = self.vision;
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        upper.step(&inputs, &mut self.subtask_out);
        self.subtask = *upper.state();
        self.silent = event.mishap == Mishap::SilentLower;
        if !self.silent {
            lower.step(&inputs, &mut self.emove_out);
            self.emove = *lower.state();
        }
        let sent = self.subtask_out.emove.number != old.subtask_out.emove.number;
        self.own |= sent && self.subtask_out.status.echo == self.command.number;
        self.surroundings(event, &memory)?;
        let wrong = self.judge(&old, event);
        self.renumber();
        wrong
    }

    fn image(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, LIMIT, &[("unfelt", 6)]);
        let mut it = self.clone();
        it.forget();
        image.add(&it.command);
        image.add(&it.subtask);
        image.add(&it.subtask_out.emove);
        image.add(&it.subtask_out.status.echo);
        image.add(&it.subtask_out.status.report);
        image.add(&it.emove);
        image.add(&it.emove_out.status);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.grip);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.vision);
        image.add(&it.emove_out.poses);
        it.robot.add_to(&mut image);
        it.grip.add_to(&mut image);
        image.add(&it.quick_change);
        image.add(&it.vision);
        image.bytes.extend([it.silent, it.own, it.let_go].map(u8::from));
        image.bytes.extend([it.apart, it.left.0, it.left.1]);
        image.bytes
    }

    fn rests(&self) -> bool {
        is_over(&self.subtask.execution, self.command.number)
            && is_over(&self.emove.execution, self.subtask_out.emove.number)
            && self.has_ended()
            && self.is_settled()
            && !self.robot.is_busy(&self.emove_out.prim)
            && !self.grip.is_busy(&self.emove_out.grip)
    }

    fn pauses(&self) -> bool {
        self.command.command == SubtaskVerb::Pause
    }
}

/// The process has read the last command, and has neither to accept nor to execute one.
fn is_over(execution: &Execution, number: u32) -> bool {
    (execution.receiver.echo == number || number == 0)
        && execution.outcome != Outcome::Executing
        && !execution.waiting
}

impl Pair {
    /// Any command can come when the last one has ended, and another one than it before.
    fn commands(&self) -> Vec<Option<usize>> {
        let ended = self.has_ended() || self.command.number == 0;
        let may = |nth: &usize| {
            let command = &self.commands[*nth].0;
            let other = (command.command, command.pose) != (self.command.command, self.command.pose);
            ended || (other && self.left.0 > 0)
        };
        core::iter::once(None).chain((0..self.commands.len()).filter(may).map(Some)).collect()
    }

    /// Every command is echoed, and its commander has read the echo.
    fn is_settled(&self) -> bool {
        let number = self.subtask_out.emove.number;
        let (prim, grip) = (self.emove_out.prim.number, self.emove_out.grip.number);
        (number == 0 || number == self.emove_out.status.echo)
            && (prim == 0 || prim == self.robot.echo)
            && (grip == 0 || grip == self.grip.echo)
            && self.emove_out.quick_change.number == self.quick_change
    }
}
