//! E-move and Prim. Around them: Subtask, T3 Interface with the robot, Quick Change. Either the robot is bare, and
//! moves from one known location to another by their trajectory; or it moves by guarded moves: with the tool
//! gripper, to take a tool out of the drum and put it in, or to take the parts gripper from its holster and leave
//! it there.
//!
//! A motion is a single event: the ticks in which T3 Interface requests points, until a process reports something
//! new or half of the motion is over. While the robot is at rest T3 Interface may also request none.

mod change;
mod judge;
mod states;
mod tool;

use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, PrimOutputs, StatusReport,
    emove::{EmoveCommand, EmoveVerb},
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
    quick_change::{QuickChangeReport, RingPosition},
    t3i::{LinkFault, ReportCheck, T3iCommand, T3iReport, T3iStatus, T3iVerb},
};
use levels::{
    emove::{self, Emove},
    execution::Outcome,
    prim::{self, Prim},
};
use rcs_core::tick::Tick;

use crate::{
    data::{data, emove_command, place, pose_of_point},
    holster,
    search::{DeliveryFault, World, Wrong, resumed},
};
use change::Change;
pub use tool::DRUM;
use tool::{GRIPPER, Happens, TOOL, Tool};

const LONG: u32 = 2_000; // ticks, the time limit of any motion
/// Ticks until a process above must report that the robot is elsewhere.
const LATE: u8 = 4;
const ASIDE: f64 = 1.0; // in, from its place to a displaced robot

pub type Line = (EmoveVerb, &'static str);

/// The location of commands for the parts gripper in its holster.
pub const HOLSTER: &str = holster::GRIPPER.2;

const PAUSE: Line = (EmoveVerb::Pause, "");

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// T3 Interface requests no point, or does not start yet.
    Busy,
    /// T3 Interface requests points, or starts after RESTART, until a process reports something new.
    Goes,
    /// The same until half of the way to Prim's goal is left; for a GO-UNTIL a quarter, where its condition is met.
    Half,
    /// T3 Interface reports an error of the link, the line or a command, or the controller's DTR goes off.
    Fails(LinkFault, bool),
    Silent, // T3 Interface does not write
    /// The robot is off the commanded pose, which T3 Interface detects after RESTART.
    Aside,
    /// T3 Interface requests no point, and E-move or Prim is restarted.
    Restart(DeliveryFault),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub told: Option<Line>,
    pub link: Link,
    pub happens: Happens,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    commands: &'static [Line],
    /// Commands that may still interrupt a motion, and faults that may still occur.
    left: (u8, u8),
    halved: bool, // the way to Prim's goal has been halved
    command: EmoveCommand,
    emove: emove::State,
    emove_out: EmoveOutputs,
    prim: prim::state::State,
    prim_out: PrimOutputs,
    quick_change: u32, // the echo of a Quick Change that is not in the scene
    t3i: T3iStatus,
    silent: bool, // T3 Interface has not written in the last tick
    aside: u8,    // ticks for which the robot has been off its last point
    robot: Frame, // the last commanded place
    tool: Option<Tool>,
    /// The parts gripper and its holster. Without it and a tool gripper the robot is bare.
    change: Option<Change>,
    /// Unusual events that can still happen: fingers that stick, and a GO-UNTIL that ends without its condition.
    unusual: u8,
    /// The condition of a guarded move was met since Prim took it, or since the robot rested.
    contact: bool,
    stops: bool, // the condition was met, or its sensor was faulty
    brakes: u32, // ticks for which the robot has moved since then
    /// Whether the bias of the force sensor was taken at TOOL-SAFE; `None` without a bias.
    biased_at_safe: Option<bool>,
}

/// Changes of these values end a motion event: the reports of the processes, and whether the robot is commanded to
/// move.
type Said = (u32, StatusReport, u32, PrimReport, u32, bool, bool);

impl Pair {
    /// The bare robot is at a location that E-move has not found yet.
    pub fn first(location: &'static str, commands: &'static [Line], motions: u8, faults: u8) -> Self {
        Self { commands, left: (motions, faults), ..Self::at(location, None, None) }
    }

    /// The robot is before the drum, with open fingers.
    pub fn at_drum(commands: &'static [Line], unusual: u8, motions: u8, faults: u8) -> Self {
        let mut pair = Self::at("SAFE", Some(Tool::new()), None);
        pair.runs(PAUSE);
        pair.runs((EmoveVerb::MovToLoc, "TOOL-SAFE"));
        Self { commands, left: (motions, faults), unusual, ..pair }
    }

    /// The bare robot is above the parts gripper in its holster, which it has just left.
    pub fn at_holster(commands: &'static [Line], unusual: u8, motions: u8, faults: u8) -> Self {
        let mut pair = Self::at("SAFE", None, Some(Change::new()));
        pair.runs(PAUSE);
        for verb in [EmoveVerb::MovToHol, EmoveVerb::QcAttach, EmoveVerb::QcDetach] {
            pair.runs((verb, HOLSTER));
        }
        Self { commands, left: (motions, faults), unusual, ..pair }
    }

    fn at(location: &str, tool: Option<Tool>, change: Option<Change>) -> Self {
        let mut pair = Self {
            tick: Tick(10_000),
            commands: &[],
            left: (0, 0),
            halved: false,
            command: EmoveCommand::default(),
            emove: emove::State::default(),
            emove_out: EmoveOutputs::default(),
            prim: prim::state::State::default(),
            prim_out: PrimOutputs::default(),
            quick_change: 0,
            t3i: T3iStatus { controller_ready: true, ..T3iStatus::default() },
            silent: false,
            aside: 0,
            robot: place(location).frame,
            tool,
            change,
            unusual: 0,
            contact: false,
            stops: false,
            brakes: 0,
            biased_at_safe: None,
        };
        pair.tick(Link::Goes, Happens::Nothing).expect("no fault at the start");
        pair
    }

    fn runs(&mut self, line: Line) {
        let mut told = Some(line);
        for _ in 0..LONG {
            let happens = if self.awaits_arrival() { Happens::Arrive } else { Happens::Nothing };
            let event = Event { told: told.take(), link: Link::Goes, happens };
            self.step(event).expect("no fault at the start");
            if self.rests() {
                assert_eq!(self.emove_out.status.report, StatusReport::Done, "{line:?}");
                return;
            }
        }
        panic!("{line:?} never ends");
    }

    fn tell(&mut self, (verb, location): Line) {
        let number = self.command.number + 1;
        if location == HOLSTER {
            self.command = holster::command(number, verb);
            return;
        }
        if verb == EmoveVerb::Pause {
            self.command = EmoveCommand { number, command: verb, ..EmoveCommand::default() };
            return;
        }
        let (object, grip, _) = TOOL;
        let pose = Some(pose_of_point(location));
        let of_object = EmoveCommand { number, pose, ..emove_command(verb, object, grip, location) };
        let site = of_object.site;
        self.command = if verb == EmoveVerb::MovToLoc {
            EmoveCommand { number, command: verb, site, pose, ..EmoveCommand::default() }
        } else {
            EmoveCommand { end_effector_id: Some(GRIPPER), ..of_object }
        };
    }

    fn inputs(&self) -> (CommonMemory, ExternalInputs) {
        let before = self.tick.previous();
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        external.devices.quick_change.locked = true;
        external.devices.joystick.velocity = 1000;
        memory.subtask.emove = self.command;
        (memory.emove, memory.prim, memory.t3i.status) = (self.emove_out, self.prim_out, self.t3i);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.quick_change, QuickChangeReport::Locked);
        status.ring = RingPosition::Locked;
        memory.subtask.header.stamp = before;
        memory.emove.header.stamp = before;
        memory.prim.header.stamp = before;
        memory.quick_change.header.stamp = before;
        memory.grip.header.stamp = before;
        memory.t3i.header.stamp = if self.silent { Tick::BEFORE_START } else { before };
        if let Some(tool) = &self.tool {
            tool.write(&mut memory, &mut external.devices, before);
        }
        if let Some(change) = &self.change {
            change.write(&self.robot, &mut memory, &mut external.devices, before);
        }
        (memory, external)
    }

    fn t3i_does(&mut self, sent: &T3iCommand, link: Link) {
        self.silent = link == Link::Silent;
        if self.silent {
            return;
        }
        let new = sent.number != self.t3i.echo && sent.number != 0;
        let stands = self.stands();
        let status = &mut self.t3i;
        if new && sent.command == T3iVerb::Restart {
            (status.link_running, status.check, status.fault) =
                (false, ReportCheck::NoReport, LinkFault::None);
            (status.report, status.controller_ready) = (T3iReport::Executing, true);
        }
        (status.echo, status.command) = (sent.number, sent.command);
        let restarts = status.command == T3iVerb::Restart && !status.link_running;
        let failed = status.report == T3iReport::Error;
        match link {
            Link::Fails(fault, ready) => {
                (status.report, status.fault, status.controller_ready) = (T3iReport::Error, fault, ready);
                status.link_running &= fault == LinkFault::InvalidCommand;
                status.check = if ready { status.check } else { ReportCheck::NoReport };
            }
            Link::Aside => self.aside = 1,
            _ if failed => {}
            Link::Busy | Link::Silent | Link::Restart(_) => status.report = T3iReport::Executing,
            Link::Goes | Link::Half => {
                if restarts {
                    let seen = if self.aside > 0 { ReportCheck::Elsewhere } else { ReportCheck::AsSent };
                    (status.link_running, status.check) = (true, seen);
                    self.robot = stands;
                    self.aside = 0;
                }
                status.report = T3iReport::Finished;
            }
        }
        if new && sent.command == T3iVerb::Point && self.t3i.link_running {
            self.robot = sent.frame.to_frame().expect("Prim commands frames");
        }
        let stands = WireFrame::from_frame(&self.stands());
        self.t3i.resolver_frame = Some(stands);
        let commanded = WireFrame::from_frame(&self.robot);
        self.t3i.frame_feedback = if self.t3i.link_running { commanded } else { stands };
    }

    fn stands(&self) -> Frame {
        let mut frame = self.robot;
        frame.position.x += if self.aside > 0 { ASIDE } else { 0.0 };
        frame
    }

    fn is_moving(&self) -> bool {
        self.prim.motion.is_some_and(|motion| !motion.is_at_rest())
    }

    fn interrupts(&self) -> bool {
        let goes = self.emove.execution.outcome == Outcome::Executing || self.emove.execution.waiting;
        self.is_moving() || (goes && self.command.command != EmoveVerb::Pause)
    }

    fn said(&self) -> Said {
        let (emove, prim) = (&self.emove_out, &self.prim_out.status);
        let (moves, runs) = (self.is_moving(), self.t3i.link_running);
        (emove.status.echo, emove.status.report, prim.echo, prim.report, emove.prim.number, moves, runs)
    }

    fn tick(&mut self, link: Link, happens: Happens) -> Result<(), Wrong> {
        self.tick = self.tick.next();
        let mut upper: Emove = resumed(self.emove, link == Link::Restart(DeliveryFault::RestartUpper));
        let mut lower: Prim = resumed(self.prim, link == Link::Restart(DeliveryFault::RestartLower));
        let (memory, external) = self.inputs();
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        self.aside = if self.aside == 0 { 0 } else { (self.aside + 1).min(LATE + 1) };
        upper.step(&inputs, &mut self.emove_out);
        lower.step(&inputs, &mut self.prim_out);
        (self.emove, self.prim) = (*upper.state(), *lower.state());
        self.quick_change = old.emove_out.quick_change.number;
        self.t3i_does(&old.prim_out.t3i, link);
        if let Some(tool) = &mut self.tool {
            tool.does(happens, &self.robot, &memory, &self.prim)?;
        }
        if let Some(change) = &mut self.change {
            change.does(happens, &self.robot, &memory, &self.prim)?;
        }
        self.watch(&old);
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let moving = self.is_moving();
        let (motions, faults) = self.left;
        let mut links =
            if moving || self.is_guarded() { vec![Link::Goes] } else { vec![Link::Busy, Link::Goes] };
        if moving && !self.halved && (self.awaits() || (motions, faults) != (0, 0)) {
            links.push(Link::Half);
        }
        if faults > 0 {
            let faults = [
                (LinkFault::NotResponding, true),
                (LinkFault::NotResponding, false),
                (LinkFault::DepcError, true),
                (LinkFault::InvalidCommand, true),
            ];
            links.extend(faults.map(|(fault, ready)| Link::Fails(fault, ready)));
            links.extend([Link::Silent, Link::Aside]);
            links.extend(DeliveryFault::RESTARTS.iter().copied().map(Link::Restart));
        }
        let prompt = |link: Link| link == Link::Goes && !self.awaits_arrival();
        let quiet = |link| Event { told: None, link, happens: Happens::Nothing };
        let mut events: Vec<_> = links.iter().map(|link| (quiet(*link), prompt(*link))).collect();
        events.extend(
            self.happenings()
                .into_iter()
                .map(|(happens, prompt)| (Event { happens, ..quiet(Link::Goes) }, prompt)),
        );
        let status = &self.emove_out.status;
        let ended = status.echo == self.command.number && status.report != StatusReport::Executing;
        if motions > 0 || !self.interrupts() {
            let last = (self.command.command, self.command.site.location);
            let may = self
                .commands
                .iter()
                .filter(|(verb, location)| ended || (*verb, *location) != (last.0, last.1.as_str()));
            events.extend(may.map(|line| {
                let link = if moving { Link::Goes } else { Link::Busy };
                (Event { told: Some(*line), ..quiet(link) }, false)
            }));
        }
        events.retain(|(event, _)| !self.is_unusual(event) || self.unusual > 0);
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.unusual -= u8::from(self.is_unusual(&event));
        if let Some(line) = event.told {
            self.left.0 -= u8::from(self.interrupts());
            self.tell(line);
        }
        let goes = matches!(event.link, Link::Busy | Link::Goes | Link::Half);
        self.left.1 -= u8::from(!goes || self.is_fault(event.happens));
        let mut happens = event.happens;
        let (before, order) = (self.said(), self.emove_out.prim.number);
        self.halved |= event.link == Link::Half;
        let part = if self.awaits() { 4.0 } else { 2.0 };
        let left = self.prim.motion.map_or(0.0, |motion| motion.distance() / part);
        for _ in 0..LONG {
            self.tick(event.link, happens)?;
            happens = Happens::Nothing;
            let goes = match event.link {
                Link::Goes => {
                    self.is_moving() || (self.aside > 0 && self.prim.execution.outcome == Outcome::Executing)
                }
                Link::Half => self.prim.motion.is_some_and(|motion| motion.distance() > left),
                _ => false,
            };
            if !goes || self.said() != before {
                self.halved &= self.emove_out.prim.number == order;
                return Ok(());
            }
        }
        Err("a motion that never ends")
    }

    fn image(&self) -> Vec<u8> {
        self.alike()
    }

    fn rests(&self) -> bool {
        let status = &self.emove_out.status;
        let (emove, prim) = (&self.emove.execution, &self.prim.execution);
        let number = self.emove_out.prim.number;
        let settled = number == 0 || (number == prim.receiver.echo && number == self.prim_out.status.echo);
        status.echo == self.command.number
            && emove.outcome != Outcome::Executing
            && !emove.waiting
            && settled
            && prim.outcome != Outcome::Executing
            && !self.is_moving()
    }

    fn pauses(&self) -> bool {
        self.command.command == EmoveVerb::Pause
    }
}

impl Pair {
    const fn is_guarded(&self) -> bool {
        self.tool.is_some() || self.change.is_some()
    }

    fn awaits_arrival(&self) -> bool {
        self.tool.is_some_and(|tool| tool.moves()) || self.change.is_some_and(|change| change.turns())
    }

    /// The condition of a GO-UNTIL should be met. The condition of a GO-WHILE should not be met.
    fn is_fault(&self, happens: Happens) -> bool {
        match happens {
            Happens::Nothing | Happens::Arrive | Happens::Stick => false,
            Happens::Contact => self.prim.target.verb != PrimVerb::GoUntil,
            Happens::Free | Happens::Dead => true,
        }
    }

    fn awaits(&self) -> bool {
        let executes = self.prim.execution.outcome == Outcome::Executing;
        executes && self.prim.target.verb == PrimVerb::GoUntil && !self.contact
    }

    fn is_unusual(&self, event: &Event) -> bool {
        let awaits = self.tool.is_some() && self.awaits();
        match event.happens {
            Happens::Stick => true,
            Happens::Contact => awaits && !self.halved,
            Happens::Nothing => {
                awaits && self.is_moving() && event.link == Link::Goes && event.told.is_none()
            }
            Happens::Arrive | Happens::Free | Happens::Dead => false,
        }
    }

    /// Possible events at the gripper, and whether they are prompt.
    fn happenings(&self) -> Vec<(Happens, bool)> {
        if self.awaits_arrival() {
            return vec![(Happens::Arrive, true), (Happens::Stick, true)];
        }
        let executes = self.prim.execution.outcome == Outcome::Executing;
        let watches = executes && self.prim.target.sensor.is_some() && !self.contact;
        let mut all = Vec::new();
        if let Some(tool) = &self.tool {
            all.extend(watches.then_some((Happens::Contact, true)));
            all.extend(executes.then_some((Happens::Dead, false)));
            all.extend((tool.is_loaded() && executes).then_some((Happens::Free, false)));
        }
        let sees = self.change.is_some_and(|change| !change.is_dark());
        all.extend((sees && watches).then_some((Happens::Dead, false)));
        all.retain(|(happens, _)| self.left.1 > 0 || !self.is_fault(*happens));
        all
    }
}
