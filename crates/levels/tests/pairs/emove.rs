//! E-move and Grip. Around them: Subtask, the fingers with a part or without, Prim, Quick Change. The robot stands at
//! an object and does not move.

use interfaces::{
    ChangingPose, CommonMemory, EmoveOutputs, ExternalInputs, GripOutputs, Reason, StatusReport,
    emove::{EmoveCommand, EmoveVerb, GoneTo, Holding, ObjectGrip},
    grip::{Felt, GripCommand, GripReport},
    pose_range,
    prim::PrimReport,
    process::{Inputs, Process},
    quick_change::{QuickChangeReport, RingPosition},
};
use levels::{
    emove::{self, Emove, gripper::Gripper},
    execution::Outcome,
    grip::{self, Grip, tables::Phase},
    places::robot_at,
};
use rcs_core::tick::Tick;

use crate::{
    data::{data, emove_command, place},
    fingers::{Fingers, Sizes, calibration, flow},
    image::{Image, rebase, rebase_echoes},
    search::{World, Wrong},
};

/// Longer than the time limit of the gripper's commands.
const LONG: u64 = 200;
/// The greatest age that is within it, ticks.
const LIMIT: u64 = 150;
/// The object, its grip, and where the robot stands.
const OBJECT: (&str, i32, &str) = ("LINKBAR1", 2, "PFIXTURE");
/// Its depart size, a little more than its grasp size, and its force.
const SIZES: Sizes = Sizes { open: 350, part: 66, force: 30 };

/// What Prim does with its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrimDoes {
    /// Nothing new; an order that has just come is taken.
    Goes,
    Ends,
    Fails,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub told: Option<EmoveVerb>,
    pub fingers: Fingers,
    pub prim: PrimDoes,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    commands: &'static [EmoveVerb],
    command: EmoveCommand,
    emove: emove::state::State,
    emove_out: EmoveOutputs,
    grip: grip::state::State,
    grip_out: GripOutputs,
    fingers: Fingers,
    prim: (u32, PrimReport),
    quick_change: u32,
}

impl Pair {
    /// The first tick of a system that is booted, with a gripper that is calibrated and open around the object;
    /// these commands can come.
    pub fn first(commands: &'static [EmoveVerb]) -> Self {
        let calibration = Some(calibration());
        let mut pair = Self {
            tick: Tick(10_000),
            commands,
            command: EmoveCommand::default(),
            emove: emove::state::State {
                started: true,
                attached: Gripper::Parts,
                ..emove::state::State::default()
            },
            emove_out: EmoveOutputs::default(),
            grip: grip::state::State { phase: Phase::Valid, calibration, ..grip::state::State::default() },
            grip_out: GripOutputs { calibration, ..GripOutputs::default() },
            fingers: Fingers::Open,
            prim: (0, PrimReport::Idle),
            quick_change: 0,
        };
        let (object, grip, location) = OBJECT;
        let at = place(location);
        let object = emove_command(EmoveVerb::None, object, grip, location).object.unwrap_or_default();
        let stands = robot_at(GoneTo::Object(ObjectGrip { object, grip }), &at, &at.frame);
        pair.emove.beliefs.place = Some(stands);
        pair.emove_out.beliefs = pair.emove.beliefs;
        pair.emove_out.status.end_effector_id = Some(1);
        let status = &mut pair.grip_out.status;
        (status.initialized, status.position, status.felt) = (true, i32::from(SIZES.open), Felt::Nothing);
        for execution in [&mut pair.emove.execution, &mut pair.grip.execution] {
            execution.receiver.started = true;
        }
        pair
    }

    fn tell(&mut self, verb: EmoveVerb) {
        let (object, grip, location) = OBJECT;
        let number = self.command.number + 1;
        self.command = EmoveCommand { number, ..emove_command(verb, object, grip, location) };
    }

    fn prim_does(&mut self, does: PrimDoes) {
        let order = &self.emove_out.prim;
        if order.number != self.prim.0 && order.number != 0 {
            self.prim = (order.number, PrimReport::Executing);
        }
        match does {
            PrimDoes::Goes => {}
            PrimDoes::Ends => self.prim.1 = PrimReport::Done,
            PrimDoes::Fails => self.prim.1 = PrimReport::T3LinkErr,
        }
    }

    /// What the processes read.
    fn memory(&self) -> CommonMemory {
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.subtask.emove = self.command;
        (memory.emove, memory.grip) = (self.emove_out, self.grip_out);
        let status = &mut memory.prim.status;
        (status.echo, status.report, status.link_running) = (self.prim.0, self.prim.1, true);
        let pose = self.emove.beliefs.place.map(|place| place.pose).unwrap_or_default();
        memory.prim.poses[0] = ChangingPose { number: Some(pose_range::PRIM + 1), pose };
        (status.present_pose, status.sensor_pose) =
            (memory.prim.poses[0].number, memory.prim.poses[0].number);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.quick_change, QuickChangeReport::Locked);
        (status.end_effector_id, status.ring) = (Some(1), RingPosition::Locked);
        let headers = [&mut memory.emove.header, &mut memory.grip.header, &mut memory.prim.header];
        headers.into_iter().for_each(|header| header.stamp = before);
        (memory.subtask.header.stamp, memory.quick_change.header.stamp) = (before, before);
        memory
    }

    /// What is reported done is done.
    ///
    /// `before` is the pair as it was when the processes read it.
    fn judge(&self, before: &Self) -> Result<(), Wrong> {
        let status = &self.emove_out.status;
        let ended = |it: &Self| {
            let status = &it.emove_out.status;
            status.echo == self.command.number && status.report == StatusReport::Done
        };
        if !ended(self) || ended(before) {
            return Ok(());
        }
        let between = matches!(before.fingers, Fingers::Holding | Fingers::Emptied);
        match self.command.command {
            EmoveVerb::GraspObj if !between => Err("done, and nothing is between the fingers"),
            EmoveVerb::GraspObj if status.held.object() != self.command.object => {
                Err("done, and the object is not held")
            }
            EmoveVerb::Release if !matches!(before.fingers, Fingers::Open | Fingers::Drifted) => {
                Err("done, and the fingers are not open")
            }
            EmoveVerb::Release if status.held != Holding::Nothing => Err("done, and something is held"),
            EmoveVerb::Pause if before.grip_out.status.report == GripReport::Executing => {
                Err("done, and the fingers move")
            }
            EmoveVerb::Pause if before.prim.1 == PrimReport::Executing => Err("done, and the robot moves"),
            EmoveVerb::None => Err("an unknown command is done"),
            _ => Ok(()),
        }
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let moving = self.is_moving();
        let prim: &[PrimDoes] =
            if moving { &[PrimDoes::Goes, PrimDoes::Ends, PrimDoes::Fails] } else { &[PrimDoes::Goes] };
        let mut events = Vec::new();
        for told in self.commands() {
            for &prim in prim {
                for (fingers, arrive) in self.fingers.next(self.grip_out.valves.bits) {
                    let event = Event { told, fingers, prim, long: false };
                    let quiet = told.is_none();
                    events.push((event, quiet && arrive && (!moving || prim != PrimDoes::Goes)));
                    let waits = quiet && fingers == self.fingers && !arrive;
                    if waits && !moving && self.is_settled() && self.is_still() {
                        events.push((Event { long: true, ..event }, true));
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut process = (Emove::default(), Grip::default());
        process.0.restore(self.emove);
        Process::<()>::restore(&mut process.1, self.grip);
        if let Some(verb) = event.told {
            self.tell(verb);
        }
        let memory = self.memory();
        let mut external = ExternalInputs::default();
        let devices = &mut external.devices;
        devices.grip = self.fingers.sensors(&SIZES);
        (devices.quick_change.locked, devices.quick_change.end_effector_id) = (true, 1);
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        let (mut emove_out, mut grip_out) = (self.emove_out, self.grip_out);
        process.0.step(&inputs, &mut emove_out);
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &() };
        process.1.step(&inputs, &mut grip_out);
        // Prim and Quick Change read what was written in the tick before.
        self.prim_does(event.prim);
        self.quick_change = self.emove_out.quick_change.number;
        self.fingers = event.fingers;
        (self.emove_out, self.grip_out) = (emove_out, grip_out);
        self.emove = *process.0.state();
        self.grip = *Process::<()>::state(&process.1);
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    /// Without what no row asks for any more: reasons; what a process that executes nothing has of its command.
    fn image(&self) -> Vec<u8> {
        let counters =
            &[("settled", 6), ("missed", 3), ("touch_ticks", 5), ("still_ticks", 5), ("unfelt", UNFELT)];
        let mut image = Image::new(self.tick, LIMIT, counters);
        let mut it = self.clone();
        (it.emove.execution.reason, it.grip.execution.reason) = (Reason::None, Reason::None);
        let executes = it.emove.execution.outcome == Outcome::Executing;
        if !executes && it.command.command != EmoveVerb::Pause {
            (it.emove.step, it.emove.ordered, it.emove.uses_prim) = Default::default();
        }
        // Rows that order something lead to later steps: none of them fires twice in a command.
        it.emove.execution.last_order = None;
        if !executes {
            it.emove.carrying = false;
        }
        let beliefs = &mut it.emove.beliefs;
        beliefs.placed = None;
        match &mut beliefs.grasping {
            grasping if beliefs.held.is_some() || beliefs.empty => *grasping = None,
            Some(grasping) => grasping.opening = 0,
            None => {}
        }
        if beliefs.held.is_none() {
            it.emove.unfelt = 0;
        }
        if it.is_settled() {
            it.emove_out.grip = GripCommand { number: it.emove_out.grip.number, ..GripCommand::default() };
        }
        if it.grip.execution.outcome != Outcome::Executing {
            (it.grip.step, it.grip.goal, it.grip.settled, it.grip.missed) = Default::default();
            it.grip.since = it.tick;
        }
        it.grip.steady = Default::default();
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.grip);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        image.add(&it.grip);
        let status = &it.grip_out.status;
        image.add(&status.echo);
        image.add(&status.report);
        image.add(&status.felt);
        image.add(&status.initialized);
        image.add(&status.position);
        image.add(&status.left_force);
        image.add(&status.right_force);
        image.add(&status.velocity);
        image.add(&it.fingers.sensors(&SIZES));
        image.add(&it.prim.0);
        image.add(&it.prim.1);
        image.add(&it.quick_change);
        image.bytes.push(it.grip_out.valves.bits);
        image.bytes
    }

    fn rests(&self) -> bool {
        let status = &self.emove_out.status;
        let over = self.emove.execution.outcome != Outcome::Executing && !self.emove.execution.waiting;
        status.echo == self.command.number
            && over
            && self.is_settled()
            && self.grip.execution.outcome != Outcome::Executing
            && !self.is_moving()
            && flow(self.grip_out.valves.bits) == (false, false)
    }

    fn pauses(&self) -> bool {
        self.command.command == EmoveVerb::Pause
    }
}

/// Ticks for which the fingers feel nothing that make no more difference.
const UNFELT: u8 = 6;

impl Pair {
    /// Any command can come when the last one has ended, and another one than it before.
    fn commands(&self) -> Vec<Option<EmoveVerb>> {
        let status = &self.emove_out.status;
        let ended = status.echo == self.command.number && status.report != StatusReport::Executing;
        let may = |verb: &&EmoveVerb| ended || **verb != self.command.command;
        core::iter::once(None).chain(self.commands.iter().filter(may).map(|verb| Some(*verb))).collect()
    }

    /// Grip has read its last command, and E-move its echo.
    fn is_settled(&self) -> bool {
        let number = self.emove_out.grip.number;
        (number == 0 || (number == self.grip_out.status.echo && number == self.grip.execution.receiver.echo))
            && self.emove_out.quick_change.number == self.quick_change
    }

    /// Prim has not ended its last order.
    fn is_moving(&self) -> bool {
        let number = self.emove_out.prim.number;
        (number != self.prim.0 && number != 0) || self.prim.1 == PrimReport::Executing
    }

    /// The fingers have stood for so long that their process has noted it.
    fn is_still(&self) -> bool {
        let read = self.grip.sensed.map(|sensed| sensed.last);
        read == Some(self.fingers.sensors(&SIZES)) && self.grip.still_ticks >= 5 && self.grip.touch_ticks >= 5
    }

    /// What does not count any more begins again.
    fn renumber(&mut self) {
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut self.grip.execution.receiver.echo;
        let parts = &mut emove.grippers.parts;
        rebase(parts, &mut [&mut out.grip.number, echo, &mut self.grip_out.status.echo]);
        rebase(&mut emove.prim, &mut [&mut out.prim.number, &mut self.prim.0]);
        rebase(&mut emove.quick_change, &mut [&mut out.quick_change.number, &mut self.quick_change]);
    }
}
