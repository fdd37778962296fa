//! Preprocess of E-move: held object, place of the robot, and the state variables of the tables.

use core::mem;

use geometry::pose::Pose;
use interfaces::{
    CommonMemory, EmoveOutputs,
    device::VisionStatus,
    emove::{EmoveCommand, EmoveVerb, GoneTo, RobotPlace},
    prim::{JoystickGrip, PrimReport, PrimVerb},
    process::Inputs,
    quick_change::{QuickChangeReport, QuickChangeVerb, RingPosition},
};
use rcs_core::handshake::Lower;
use taskdata::files::TaskData;

use super::{
    gripper::Gripper,
    locate::{is_another, is_plausible},
    order::FingerVerb,
    robot_place::{place, place_named, present_frame},
    route::{near, same_location},
    state::State,
    tables::{
        At, Contact, Holster, Initialization, Knowledge, Link, Load, Lock, Mate, Motion, Pause, Readiness,
        Request, Ring, Seen, Sight, Situation, Step, Subordinates, Tooling, Tries, Vision, Watch,
        e_pause::EPauseStep,
        number,
        search::{Look, search},
    },
    whereabouts::{LOST_INCHES, LOST_RADIANS},
};
use crate::{
    execution::{Asked, Work},
    halt::{Above, Below, BoxState, Intake, Kind, Replaced},
    held::Held,
    places::named,
};

/// Ticks after which vision counts as silent (4 s).
const VISION_LIMIT: u64 = 100;
/// Pictures of a kind that are taken in vain before LOCATE-OBJ gives up.
const MAX_TRIES: u8 = 3;
/// Ticks for which a GO-UNTIL may stay not-detected (1 s): the robot stands, and what has not come by then
/// does not come.
const PATIENCE: u32 = 25;
/// A picture says where a part is if the robot is within this of where it was sent, in …
const STANDS_INCHES: f64 = 0.1;
/// … and radians (half a degree).
const STANDS_RADIANS: f64 = 0.5 * core::f64::consts::PI / 180.0;
/// Bits of the four sensors of a holster (V.1.2).
const HOLSTER_SENSORS: u8 = 0x0F;

/// What the sensors of a gripper's own holster see: parts gripper right, v-gripper left, tool gripper centre
/// (ASSUMED).
pub(super) fn holster(gripper: Option<u8>, memory: &CommonMemory) -> Holster {
    let status = &memory.prim.status;
    let bits = match Gripper::of(gripper) {
        Gripper::None => return Holster::Empty,
        Gripper::Parts => status.holster_right,
        Gripper::V => status.holster_left,
        Gripper::Tool => status.holster_centre,
    };
    match bits & HOLSTER_SENSORS {
        0 => Holster::Empty,
        HOLSTER_SENSORS => Holster::Full,
        _ => Holster::Partial,
    }
}

const fn known(known: bool) -> Knowledge {
    if known { Knowledge::Known } else { Knowledge::Unknown }
}

impl State {
    /// Read the inputs of a tick.
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &EmoveOutputs) -> Seen {
        let command = &inputs.memory.subtask.emove;
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        self.adopt(inputs, outputs);
        self.sense_neighbours(inputs);
        self.sense_way(inputs.memory, inputs.data);
        self.sense_pictures(inputs.memory);
        self.sense_held(command, inputs);
        let watch = self.sense_place(command, inputs);
        self.sense_exchange(inputs);
        self.sense_drum(inputs);
        let replaced = self.replaced(&watch, inputs);
        let at_rest = replaced.below == Below::AtRest || replaced.joystick == BoxState::On;
        let request = if asked == Asked::Now && (at_rest || replaced.kind == Kind::Pause) {
            self.look_up(command, replaced.joystick, inputs)
        } else {
            Request::default()
        };
        let subordinates = self.subordinates(command, inputs);
        let situation = self.situation(command, &subordinates, inputs);
        let seen = Seen {
            arrival,
            verb: command.command,
            asked,
            replaced,
            progress: self.progress(),
            request,
            watch,
            subordinates,
            proof: self.proof(command, &situation, inputs, outputs),
            situation,
        };
        self.button = inputs.memory.prim.status.joystick_grip;
        seen
    }

    /// In its first tick E-move adopts its beliefs from before a restart.
    fn adopt(&mut self, inputs: &Inputs<'_, TaskData<'_>>, outputs: &EmoveOutputs) {
        if !mem::replace(&mut self.started, true) {
            let memory = inputs.memory;
            self.robot_init = inputs.external.operator.robot_init;
            self.beliefs = outputs.beliefs;
            // Another gripper may have come in the meantime; one whose pins read as none may still be on.
            let (before, now) = (Gripper::of(outputs.status.end_effector_id), Gripper::attached(memory));
            self.attached = if now == Gripper::None || now == before { before } else { Gripper::None };
            self.grippers.adopt(memory);
            let cut_off = self.beliefs.held.is_some() && self.beliefs.grasping.is_none();
            self.releasing = cut_off || self.grippers.order == FingerVerb::Release;
        }
    }

    /// What a new command replaces: motion, ring or fingers that are under way.
    fn replaced(&self, watch: &Watch, inputs: &Inputs<'_, TaskData<'_>>) -> Replaced {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let written = &memory.emove;
        let robot = self.robot(inputs);
        let fingers = self.grippers.status(tick, memory);
        let below = Below::of(robot, written.prim.command == PrimVerb::Pause)
            .and(Below::of(fingers, self.grippers.order == FingerVerb::Pause))
            .and(Below::of(self.ring_order(inputs), written.quick_change.command == QuickChangeVerb::Pause));
        Replaced {
            intake: Intake::Taken,
            kind: if watch.pause == Pause::Other { Kind::Other } else { Kind::Pause },
            above: Above::of(&memory.subtask.header, tick),
            joystick: if robot == Lower::Joystick { BoxState::On } else { BoxState::Off },
            below,
        }
    }

    /// Where in its command E-move is, beside the state variables: the points that were sent, on, back and onto
    /// the way, and the pictures that were tried. Above bit 40, which the number of the state variables does
    /// not reach.
    fn progress(&self) -> u64 {
        let back = self.back.map_or(0, |back| u64::from(back.next & 0xFF) << 1 | u64::from(back.complete));
        let on = self.route.map_or(0, |route| u64::from(route.commanded & 0xFF));
        let beside = self.rejoin.map_or(0, |rejoin| u64::from(rejoin.ahead() & 0x1F));
        (beside << 19 | back << 10 | on << 2 | u64::from(self.tries & 0x3)) << 40
    }

    /// Follow the echoes until the first command, and count how long Prim has not detected anything.
    fn sense_neighbours(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        let (tick, written) = (inputs.tick, &memory.emove);
        self.prim.start_from(tick, written.prim.number, memory.prim.status.echo);
        self.grippers.start(tick, memory);
        self.quick_change.start_from(tick, written.quick_change.number, memory.quick_change.status.echo);
        self.vision.start(inputs.external.devices.vision.echo);
        let prim = &memory.prim.status;
        let undetected = prim.echo == self.prim.number && prim.report == PrimReport::NotDetected;
        self.undetected = if undetected { self.undetected.saturating_add(1) } else { 0 };
    }

    /// Is the robot still where its last move ended? If [`search`] says so, look where else it is.
    fn sense_place(&mut self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Watch {
        let present = present_frame(inputs.memory);
        if let Some(present) = &present {
            let there = |pose: &Pose| {
                pose.to_frame().is_ok_and(|frame| near(&frame, present, LOST_INCHES, LOST_RADIANS))
            };
            self.away = self.beliefs.place.is_some_and(|place| !there(&place.pose));
        }
        let pause = match (command.command, self.step) {
            (
                EmoveVerb::Pause,
                Step::EPause(EPauseStep::Standing | EPauseStep::Led | EPauseStep::Resting),
            ) => Pause::Standing,
            (EmoveVerb::Pause, _) => Pause::UnderWay,
            _ => Pause::Other,
        };
        let watch = Watch {
            initialization: self.initialization(pause, inputs),
            pause,
            outcome: self.execution.outcome,
            place: self.whereabouts(inputs),
            resolvers: known(present.is_some()),
        };
        self.sense_track(watch.place, inputs.memory);
        self.look_around(watch.place, present.as_ref(), inputs.data);
        let decision = search(self.step, &watch);
        self.execution.rows.beside(&decision.of(number::SEARCH));
        match (decision.action, &present) {
            (Look::Look, Some(present)) => self.search(present, inputs.data),
            (Look::Look, None) | (Look::Rest, _) => {}
        }
        watch
    }

    /// `.R`: what is to be done for it, or was. It waits for a pause that stands.
    fn initialization(&self, pause: Pause, inputs: &Inputs<'_, TaskData<'_>>) -> Initialization {
        if pause != Pause::Standing {
            return Initialization::None;
        }
        let below = self.prim.status_of(inputs.tick, &inputs.memory.prim);
        let ended = matches!(below, Lower::Done | Lower::Error);
        if inputs.external.operator.robot_init != self.robot_init {
            Initialization::Asked
        } else if inputs.memory.emove.prim.command == PrimVerb::RobotInit && ended {
            Initialization::Over
        } else {
            Initialization::None
        }
    }

    /// How the last order stands.
    fn subordinates(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Subordinates {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let gripper = self.grippers.status(tick, memory);
        Subordinates {
            verb: command.command,
            load: match self.beliefs.held {
                None if self.carrying && self.gripper_gone => Load::GripperGone,
                None if self.carrying => Load::Lost,
                Some(_) if self.carrying && self.is_misread(memory) => Load::PinsFail,
                _ => Load::Kept,
            },
            ordered: self.ordered,
            prim: if self.uses_prim { self.prim.status_of(tick, &memory.prim) } else { Lower::Done },
            contact: match memory.prim.status.report {
                PrimReport::DetectedErr => Contact::Met,
                _ if self.undetected > PATIENCE => Contact::Missed,
                _ => Contact::Awaited,
            },
            opening: self.opening(gripper, inputs),
            gripper,
            ring: self.ring(inputs),
            vision: self.vision(inputs),
        }
    }

    /// Set the state variables of the commands.
    fn situation(
        &self,
        command: &EmoveCommand,
        subordinates: &Subordinates,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Situation {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let &Subordinates { prim, opening, gripper, ring, .. } = subordinates;
        Situation {
            work: Work::Busy,
            ahead: self.ahead(inputs.data),
            opening,
            held: Held::of(self.holding(memory), command.object),
            fingers: self.fingers(command, inputs),
            spread: self.spread(gripper, command, inputs),
            readiness: self.readiness(gripper, memory),
            mate: match memory.quick_change.status.end_effector_id {
                None => Mate::None,
                id if id == command.end_effector_id => Mate::Right,
                _ => Mate::Wrong,
            },
            holster: holster(command.end_effector_id, memory),
            lock: self.lock(inputs),
            along: self.along(command, inputs),
            shut: self.shut(command, inputs),
            at: self.at(command),
            drum: self.at_drum(command, inputs),
            bias: self.bias(memory),
            sight: sight(self.beliefs.place.as_ref(), inputs),
            aim: known(self.aim(command, inputs).is_some()),
            reach: self.reach(command, inputs),
            tries: if self.tries.saturating_add(1) < MAX_TRIES { Tries::Left } else { Tries::Spent },
            link: if memory.prim.status.link_running { Link::Up } else { Link::Down },
            prim,
            motion: if self.grippers.are_moving(tick, memory) { Motion::Moving } else { Motion::AtRest },
            tooling: self.tooling(ring, gripper, inputs),
            place: self.whereabouts(inputs),
            button: match memory.prim.status.joystick_grip {
                pressed if pressed == self.button => JoystickGrip::None,
                pressed => pressed,
            },
        }
    }

    /// State of the attached gripper after its last order; without an order, the initial state.
    fn readiness(&self, gripper: Lower, memory: &CommonMemory) -> Readiness {
        let attached = Gripper::attached(memory);
        let idle = gripper == Lower::Done || self.grippers.to != attached;
        match (idle, attached.is_uncalibrated(memory)) {
            (true, true) => Readiness::Uncalibrated,
            (true, false) => Readiness::Ready,
            (false, _) => Readiness::Faulty,
        }
    }

    /// Where the robot is, seen from the command's location.
    fn at(&self, command: &EmoveCommand) -> At {
        match self.place() {
            Some(at) if same_location(&place(&at), &place_named(command)) => match at.gone_to {
                GoneTo::Drum => At::InDrum,
                GoneTo::Location | GoneTo::Object(_) | GoneTo::View(_) | GoneTo::Brought(_) => At::There,
            },
            Some(at) if at.location.as_str() == named::TOOL_SAFE => At::Before,
            _ => At::Elsewhere,
        }
    }

    /// What Quick Change has made of its last command.
    fn ring_order(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        self.quick_change.status_of(inputs.tick, &inputs.memory.quick_change)
    }

    /// Where the sensors see the locking ring.
    fn lock(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lock {
        match (self.ring_order(inputs), inputs.memory.quick_change.status.ring) {
            (Lower::Lost, _) | (_, RingPosition::Implausible) => Lock::Faulty,
            (_, RingPosition::Locked) => Lock::Locked,
            (_, RingPosition::Unlocked) => Lock::Unlocked,
            (_, RingPosition::Unread | RingPosition::Between) => Lock::Between,
        }
    }

    /// What Quick Change says of its ring to the last command.
    fn ring(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Ring {
        match (self.ring_order(inputs), inputs.memory.quick_change.status.report) {
            (Lower::Pending | Lower::Executing, _) => Ring::Busy,
            (Lower::Error | Lower::Joystick | Lower::Lost, _) => Ring::Faulty,
            (Lower::Done, QuickChangeReport::Locked) => Ring::Locked,
            (Lower::Done, QuickChangeReport::Unlocked) => Ring::Unlocked,
            (Lower::Done, _) => Ring::Busy,
        }
    }

    /// Quick change and gripper while pausing. Grip's PAUSE is done only when a calibration at the start is (VI.3.1
    /// UP-INIT); with no gripper, or one that has come since, there is nothing to wait for. A ring that stands half-way
    /// is at rest, too: ACCEPT decides which commands it prevents.
    fn tooling(&self, ring: Ring, gripper: Lower, inputs: &Inputs<'_, TaskData<'_>>) -> Tooling {
        let asked = self.grippers.to == Gripper::attached(inputs.memory);
        match (ring, gripper) {
            (Ring::Faulty, _) if self.lock(inputs) != Lock::Between => Tooling::RingFaulty,
            (Ring::Busy, _) => Tooling::Busy,
            (_, Lower::Error | Lower::Joystick | Lower::Lost) if asked => Tooling::GripFaulty,
            (_, Lower::Pending | Lower::Executing) => Tooling::Busy,
            (Ring::Faulty | Ring::Locked | Ring::Unlocked, _) => Tooling::Ready,
        }
    }

    /// Has vision answered?
    fn vision(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Vision {
        let answer = &inputs.external.devices.vision;
        let over = matches!(
            answer.status,
            VisionStatus::Done | VisionStatus::NothingSeen | VisionStatus::NotRecognised
        );
        if over && answer.echo == self.vision.number {
            Vision::Answered
        } else if inputs.tick.since(self.vision.sent) > VISION_LIMIT {
            Vision::Silent
        } else {
            Vision::Waiting
        }
    }
}

/// Does the robot stand where it was sent, as far as that is known? An arm that sinks has moved since the
/// picture was taken.
fn is_where_sent(place: Option<&RobotPlace>, memory: &CommonMemory) -> bool {
    let sent = place.and_then(|place| place.pose.to_frame().ok());
    match (sent, present_frame(memory)) {
        (Some(sent), Some(present)) => near(&sent, &present, STANDS_INCHES, STANDS_RADIANS),
        _ => true,
    }
}

/// What vision has answered.
fn sight(place: Option<&RobotPlace>, inputs: &Inputs<'_, TaskData<'_>>) -> Sight {
    let (request, answer) = (&inputs.memory.emove.vision, &inputs.external.devices.vision);
    match answer.status {
        VisionStatus::NotRecognised => Sight::Unrecognised,
        VisionStatus::Done if !is_plausible(request, answer) || !is_where_sent(place, inputs.memory) => {
            Sight::Implausible
        }
        VisionStatus::Done if is_another(request, answer) => Sight::Unrecognised,
        VisionStatus::Done => Sight::Seen,
        _ => Sight::Missing,
    }
}
