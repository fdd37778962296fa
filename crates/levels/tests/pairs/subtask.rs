//! Subtask and E-move. Around them: Task, Prim with the robot, Grip with its fingers, vision. Quick Change is locked on
//! the parts gripper.
//!
//! Abstractions: a motion is one step, after which the robot is at its goal or, after a failure or stop, at its
//! start. Fingers are open, around the part, or closed and empty; closing fingers find an object anywhere. Vision
//! sees the object at its place in the data, sees none, or does not answer.

mod judge;
mod states;

use crate::{
    data::{place, subtask_command},
    frame::{self, Choice, Event, Half, Scene},
    image::Image,
    parts_gripper::{GripDoes, PartsGripper},
    robot::{PrimDoes, Robot},
    search::{DeliveryFault, Wrong},
};
use interfaces::{
    ChangingPose, CommonMemory, ExternalInputs, StatusReport,
    device::{QuickChangeSensors, VisionResponse, VisionStatus},
    emove::GoneTo,
    quick_change::{QuickChangeReport, RingPosition},
    subtask::{SubtaskCommand, SubtaskVerb},
};
use levels::{
    emove::{Emove, gripper::EmoveGripper, tables::EmoveRecipient},
    execution::{Execution, Outcome},
    places::robot_at,
    subtask::Subtask,
};

const LIMIT: u64 = 100; // ticks until vision is silent
const OPENING: i32 = 300; // 0.01 in, opening at the start
/// Ticks until Subtask must report that the part is gone.
const LATE: u8 = 3;

/// Whether the command names an object; location, sector, and number of the pose.
pub type Line = (SubtaskVerb, bool, &'static str, Option<i32>, u32);
pub const PAUSE: Line = (SubtaskVerb::Pause, false, "SAFE", None, 3);
pub const GET: Line = (SubtaskVerb::GetObject, true, "UNIT_2", Some(1), 1);
pub const PLACE: Line = (SubtaskVerb::PlaceObj, true, "UNIT_2", Some(2), 2);
pub const GOTO: Line = (SubtaskVerb::GotoDest, false, "SAFE", None, 3);
pub const BRING: Line = (SubtaskVerb::MoveObjToDest, true, "UNIT_2", Some(2), 2);
pub const POSITION: Line = (SubtaskVerb::Position, true, "UNIT_2", Some(1), 1);
pub const RELEASE: Line = (SubtaskVerb::Release, true, "UNIT_2", Some(2), 2);
pub const GRIPPER: Line = (SubtaskVerb::GetEndeff, true, "UNIT_2", Some(1), 1);

#[derive(Clone, Copy, Debug)]
pub struct Does {
    pub prim: PrimDoes,
    pub grip: GripDoes,
    pub vision: Option<VisionStatus>,
}

#[derive(Clone)]
pub struct Around {
    robot: Robot,
    grip: PartsGripper,
    quick_change: u32,
    vision: VisionResponse,
    silent: bool, // E-move wrote nothing in the previous tick
    own: bool,    // E-move has an order of the current command
    apart: u8,    // ticks for which the fingers have been empty
    let_go: bool, // the fingers released or lost the part at its destination
}

pub type Pair = frame::Pair<Around>;

/// The robot is at SAFE with the parts gripper attached and open. `early` commands replace others.
pub fn first(object: &str, lines: &[Line], early: u8, mishaps: u8) -> Pair {
    let command = |&(verb, named, location, sector, nth): &Line| {
        subtask_command(verb, Some(object).filter(|_| named), location, sector, nth)
    };
    let commands: Vec<_> = lines.iter().map(command).collect();
    let safe = place("SAFE");
    let stands = robot_at(GoneTo::Location, &safe, &safe.frame);
    let around = Around {
        robot: Robot::new(stands.pose),
        grip: PartsGripper::new(OPENING),
        quick_change: 0,
        vision: VisionResponse::default(),
        silent: false,
        own: false,
        apart: LATE + 1,
        let_go: false,
    };
    let mut pair = Pair::new(commands, (Some(early), mishaps), Half::default(), around);
    let Half { state: emove, out } = &mut pair.lower;
    (out.estimates.place, out.estimates.empty) = (Some(stands), true);
    emove.adopt(&out.estimates);
    emove.exchange.adopt_gripper(EmoveGripper::Parts);
    out.status.end_effector_id = EmoveGripper::Parts.id();
    emove.execution.receiver.started = true;
    pair.upper.state.execution.receiver.started = true;
    pair
}

impl Scene for Around {
    type Upper = Half<Subtask>;
    type Lower = Half<Emove>;
    type Line = (SubtaskCommand, ChangingPose);
    type Command = SubtaskCommand;
    type Does = Does;
    const LONG: u64 = 2 * LIMIT;
    const DELIVERY_FAULTS: &'static [DeliveryFault] =
        &[DeliveryFault::RestartUpper, DeliveryFault::RestartLower, DeliveryFault::SilentLower];

    fn choices(pair: &Pair) -> Vec<Choice<Does>> {
        let moving = pair.scene.robot.is_busy(&pair.lower.out.prim);
        let gripping = pair.scene.grip.is_busy(&pair.lower.out.grip);
        let prim: &[_] =
            if moving { &[PrimDoes::Goes, PrimDoes::Ends, PrimDoes::LinkFails] } else { &[PrimDoes::Goes] };
        let grip: &[_] = match (gripping, pair.scene.grip.full) {
            (true, _) => &[GripDoes::Goes, GripDoes::Ends, GripDoes::Fails, GripDoes::Loses],
            (false, true) => &[GripDoes::Goes, GripDoes::Loses],
            (false, false) => &[GripDoes::Goes],
        };
        let looks = pair.awaits_vision();
        let vision: &[_] =
            if looks { &[None, Some(VisionStatus::Done), Some(VisionStatus::NothingSeen)] } else { &[None] };
        let mut choices = Vec::new();
        for &prim in prim {
            for &grip in grip {
                for &vision in vision {
                    let ends = (!moving || prim != PrimDoes::Goes)
                        && (!looks || vision.is_some())
                        && if gripping { grip != GripDoes::Goes } else { grip == GripDoes::Goes };
                    let waits = !moving && !gripping && pair.is_settled();
                    let long = looks && waits && vision.is_none() && grip == GripDoes::Goes;
                    choices.push(Choice { long, ..Choice::new(Does { prim, grip, vision }, ends) });
                }
            }
        }
        choices
    }

    fn has_ended(pair: &Pair) -> bool {
        let status = &pair.upper.out.status;
        status.echo == pair.command.number && status.report != StatusReport::Executing
    }

    fn is_other(pair: &Pair, (command, _): &Self::Line) -> bool {
        (command.command, command.pose) != (pair.command.command, pair.command.pose)
    }

    fn command(pair: &mut Pair, nth: usize) {
        pair.command = SubtaskCommand { number: pair.command.number + 1, ..pair.lines[nth].0 };
        pair.scene.own = false;
    }

    fn inputs(pair: &Pair) -> (CommonMemory, ExternalInputs) {
        let before = pair.tick.previous();
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        memory.task.subtask = pair.command;
        for (record, (_, pose)) in memory.task.poses.iter_mut().zip(pair.poses()) {
            *record = pose;
        }
        (memory.subtask, memory.emove) = (pair.upper.out, pair.lower.out);
        pair.scene.robot.write(&mut memory, before);
        pair.scene.grip.write(&mut memory, before);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (pair.scene.quick_change, QuickChangeReport::Locked);
        (status.end_effector_id, status.ring) = (EmoveGripper::Parts.id(), RingPosition::Locked);
        (memory.task.header.stamp, memory.subtask.header.stamp) = (before, before);
        (memory.quick_change.header.stamp, memory.pedestal.header.stamp) = (before, before);
        memory.emove.header.stamp = if pair.scene.silent { before.previous() } else { before };
        external.devices.quick_change =
            QuickChangeSensors { locked: true, unlocked: false, end_effector_id: 1 };
        external.devices.vision = pair.scene.vision;
        (memory, external)
    }

    fn act(pair: &mut Pair, event: &Event<Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        pair.scene.silent = event.mishap == DeliveryFault::SilentLower;
        let full = pair.scene.grip.full;
        pair.scene.robot.take(memory)?;
        pair.scene.robot.does(event.does.prim);
        pair.scene.grip.does(event.does.grip, &memory.emove.grip)?;
        pair.scene.quick_change = memory.emove.quick_change.number;
        if let Some(status) = event.does.vision {
            let request = &memory.emove.vision;
            pair.scene.vision = VisionResponse {
                echo: request.number,
                status,
                recognised: Some(request.object_id),
                ..VisionResponse::default()
            };
        }
        pair.scene.apart = if pair.scene.grip.full { 0 } else { (pair.scene.apart + 1).min(LATE + 1) };
        if full || pair.scene.grip.full {
            pair.scene.let_go = !pair.scene.grip.full && pair.is_destination(&pair.scene.robot.at);
        }
        Ok(())
    }

    fn note(pair: &mut Pair, before: &Pair) {
        let sent = pair.upper.out.emove.number != before.upper.out.emove.number;
        pair.scene.own |= sent && pair.upper.out.status.echo == pair.command.number;
    }

    fn judge(pair: &Pair, before: &Pair, event: &Event<Does>) -> Result<(), Wrong> {
        pair.judge(before, event)
    }

    fn renumber(pair: &mut Pair) {
        pair.renumber();
    }

    fn image(pair: &Pair) -> Vec<u8> {
        let mut image = Image::new(pair.tick, LIMIT, &[("unfelt", 6)]);
        let mut it = pair.clone();
        it.forget();
        image.add(&it.command);
        image.add(&it.upper.state);
        image.add(&it.upper.out.emove);
        image.add(&it.upper.out.status.echo);
        image.add(&it.upper.out.status.report);
        image.add(&it.lower.state);
        image.add(&it.lower.out.status);
        image.add(&it.lower.out.prim);
        image.add(&it.lower.out.grip);
        image.add(&it.lower.out.quick_change);
        image.add(&it.lower.out.vision);
        image.add(&it.lower.out.poses);
        it.scene.robot.add_to(&mut image);
        it.scene.grip.add_to(&mut image);
        image.add(&it.scene.quick_change);
        image.add(&it.scene.vision);
        image.bytes.extend([it.scene.silent, it.scene.own, it.scene.let_go].map(u8::from));
        image.bytes.extend([it.scene.apart, it.early.unwrap_or_default(), it.mishaps]);
        image.bytes
    }

    fn rests(pair: &Pair) -> bool {
        is_over(&pair.upper.state.execution, pair.command.number)
            && is_over(&pair.lower.state.execution, pair.upper.out.emove.number)
            && Self::has_ended(pair)
            && pair.is_settled()
            && !pair.scene.robot.is_busy(&pair.lower.out.prim)
            && !pair.scene.grip.is_busy(&pair.lower.out.grip)
    }

    fn pauses(pair: &Pair) -> bool {
        pair.command.command == SubtaskVerb::Pause
    }
}

/// The process has read the last command, and has none to accept or execute.
fn is_over(execution: &Execution, number: u32) -> bool {
    (execution.receiver.echo == number || number == 0)
        && execution.outcome != Outcome::Executing
        && !execution.waiting
}

impl Pair {
    /// The poses of the commands, each once.
    fn poses(&self) -> impl Iterator<Item = (u32, ChangingPose)> {
        let pose =
            |nth: u32| self.lines.iter().find(|(_, pose)| pose.number.is_some_and(|it| it & 0xFF == nth));
        (1..=3).filter_map(move |nth| pose(nth).map(|(_, pose)| (nth, *pose)))
    }

    fn awaits_vision(&self) -> bool {
        self.lower.state.execution.outcome == Outcome::Executing
            && self.lower.state.ordered == EmoveRecipient::Vision
            && self.scene.vision.echo != self.lower.out.vision.number
    }

    /// Every command is echoed, and its commander has read the echo.
    fn is_settled(&self) -> bool {
        let number = self.upper.out.emove.number;
        let (prim, grip) = (self.lower.out.prim.number, self.lower.out.grip.number);
        (number == 0 || number == self.lower.out.status.echo)
            && (prim == 0 || prim == self.scene.robot.echo)
            && (grip == 0 || grip == self.scene.grip.echo)
            && self.lower.out.quick_change.number == self.scene.quick_change
    }
}
