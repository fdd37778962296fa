//! E-move and Prim. Around them: Subtask, T3 Interface with the robot, Quick Change. The robot is bare, and goes from
//! one known location to another, by their trajectory.
//!
//! A motion is a single event: the ticks in which T3 Interface wants points, until a process says something new or half
//! of the motion is over. While the robot is at rest T3 Interface may also want none.

use geometry::{frame::Frame, pose::WireFrame};
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, PrimOutputs, Reason, StatusReport,
    emove::{EmoveCommand, EmoveVerb},
    pose_range,
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
    emove::is_done,
    image::{Image, rebase, rebase_echoes, renumber_poses},
    robot::THERE,
    search::{World, Wrong},
};

/// Ticks in which any motion of these commands ends.
const LONG: u32 = 2_000;
/// Longer than any time that counts but for that of an echo, ticks.
const LIMIT: u64 = 250;
/// The farthest that the commanded pose moves in a tick, in.
const STEP: f64 = 0.6;
/// Ticks for which a process above need not know that the robot stands elsewhere.
const LATE: u8 = 4;
/// How far a robot stands elsewhere, in.
const ASIDE: f64 = 1.0;

/// What T3 Interface and the robot do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// It wants no point, or does not come up yet.
    Busy,
    /// It wants points, or comes up after RESTART: until a process says something new.
    Goes,
    /// The same until half of the way to Prim's goal is left.
    Half,
    /// It reports an error: of the link, of the line, of a command; or the controller's DTR goes off.
    Fails(LinkFault, bool),
    /// It does not write.
    Silent,
    /// The robot stands beside the commanded pose: after RESTART T3 Interface sees it.
    Aside,
    /// It wants no point, and E-move or Prim is restarted.
    Restart(Restarted),
}

/// A process that is restarted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restarted {
    Emove,
    Prim,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// A command of Subtask: MOV-TO-LOC to a location, or PAUSE where there is no name.
    pub told: Option<&'static str>,
    pub link: Link,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    places: &'static [&'static str],
    /// Commands that may still interrupt a motion, and faults that may still come.
    left: (u8, u8),
    /// The way to Prim's goal has been halved.
    halved: bool,
    command: EmoveCommand,
    emove: emove::state::State,
    emove_out: EmoveOutputs,
    prim: prim::state::State,
    prim_out: PrimOutputs,
    quick_change: u32,
    t3i: T3iStatus,
    /// It has not written in the last tick.
    silent: bool,
    /// Ticks for which the robot has stood beside its last point.
    aside: u8,
    /// Where it was sent last.
    robot: Frame,
}

/// What makes time go on singly again: what the processes say, and whether the robot is commanded to move.
type Said = (u32, StatusReport, u32, PrimReport, u32, bool, bool);

impl Pair {
    /// A pair whose first PAUSE has found the robot at the first of these locations. So many commands may interrupt
    /// a motion, and so many faults come.
    pub fn first(places: &'static [&'static str], motions: u8, faults: u8) -> Self {
        let mut pair = Self {
            tick: Tick(10_000),
            places,
            left: (0, 0),
            halved: false,
            command: EmoveCommand::default(),
            emove: emove::state::State::default(),
            emove_out: EmoveOutputs::default(),
            prim: prim::state::State::default(),
            prim_out: PrimOutputs::default(),
            quick_change: 0,
            t3i: T3iStatus { controller_ready: true, ..T3iStatus::default() },
            silent: false,
            aside: 0,
            robot: place(places[0]).frame,
        };
        let mut told = Some("");
        for _ in 0..LONG {
            pair.step(Event { told: told.take(), link: Link::Goes }).expect("nothing is wrong at the start");
            if pair.rests() {
                pair.left = (motions, faults);
                return pair;
            }
        }
        panic!("the first PAUSE never ends");
    }

    fn tell(&mut self, location: &'static str) {
        let number = self.command.number + 1;
        self.command = if location.is_empty() {
            EmoveCommand { number, command: EmoveVerb::Pause, ..EmoveCommand::default() }
        } else {
            let pose = Some(pose_of_point(location));
            let of_object = emove_command(EmoveVerb::MovToLoc, "LINKBAR1", 2, location);
            let EmoveCommand { command, location, location_kind, location_record, .. } = of_object;
            EmoveCommand {
                number,
                command,
                location,
                location_kind,
                location_record,
                pose,
                ..EmoveCommand::default()
            }
        };
    }

    /// What the processes read.
    fn memory(&self) -> CommonMemory {
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.subtask.emove = self.command;
        (memory.emove, memory.prim, memory.t3i.status) = (self.emove_out, self.prim_out, self.t3i);
        let status = &mut memory.quick_change.status;
        (status.echo, status.report) = (self.quick_change, QuickChangeReport::Locked);
        status.ring = RingPosition::Locked;
        memory.subtask.header.stamp = before;
        memory.emove.header.stamp = before;
        memory.prim.header.stamp = before;
        memory.quick_change.header.stamp = before;
        memory.t3i.header.stamp = if self.silent { Tick::BEFORE_START } else { before };
        memory
    }

    /// T3 Interface takes what Prim has written in the tick before.
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

    /// Where the robot stands.
    fn stands(&self) -> Frame {
        let mut frame = self.robot;
        frame.position.x += if self.aside > 0 { ASIDE } else { 0.0 };
        frame
    }

    fn is_moving(&self) -> bool {
        self.prim.motion.is_some_and(|motion| !motion.is_at_rest())
    }

    /// Does a command interrupt a motion?
    fn interrupts(&self) -> bool {
        let goes = self.emove.execution.outcome == Outcome::Executing || self.emove.execution.waiting;
        self.is_moving() || (goes && self.command.command == EmoveVerb::MovToLoc)
    }

    fn said(&self) -> Said {
        let (emove, prim) = (&self.emove_out, &self.prim_out.status);
        let (moves, runs) = (self.is_moving(), self.t3i.link_running);
        (emove.status.echo, emove.status.report, prim.echo, prim.report, emove.prim.number, moves, runs)
    }

    /// One tick of both.
    fn tick(&mut self, link: Link) -> Result<(), Wrong> {
        self.tick = self.tick.next();
        let mut process = (Emove::default(), Prim::default());
        process.0.restore(self.emove);
        process.1.restore(self.prim);
        match link {
            Link::Restart(Restarted::Emove) => process.0 = Emove::default(),
            Link::Restart(Restarted::Prim) => process.1 = Prim::default(),
            _ => {}
        }
        let memory = self.memory();
        let mut external = ExternalInputs::default();
        external.devices.quick_change.locked = true;
        external.devices.joystick.velocity = 1000;
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        self.aside = if self.aside == 0 { 0 } else { (self.aside + 1).min(LATE + 1) };
        process.0.step(&inputs, &mut self.emove_out);
        process.1.step(&inputs, &mut self.prim_out);
        (self.emove, self.prim) = (*process.0.state(), *process.1.state());
        self.quick_change = old.emove_out.quick_change.number;
        self.t3i_does(&old.prim_out.t3i, link);
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    /// No jump is commanded, and what is reported done is done.
    fn judge(&self, before: &Self) -> Result<(), Wrong> {
        if let (Some(now), Some(then)) = (&self.prim.motion, &before.prim.motion)
            && now.frame().distance(&then.frame()).inches > STEP
        {
            return Err("a jump is commanded");
        }
        if matches!(before.aside, 1..=LATE) {
            return Ok(());
        }
        let stands = before.stands();
        let prim_done = |it: &Self| {
            let status = &it.prim_out.status;
            status.echo == it.emove_out.prim.number && status.report == PrimReport::Done
        };
        let goal = self.prim.target.goal.map(|goal| goal.frame.frame());
        if prim_done(self)
            && !prim_done(before)
            && self.prim.target.verb == PrimVerb::GotoPt
            && goal.is_none_or(|goal| goal.distance(&stands).inches > THERE)
        {
            return Err("Prim is done, and the robot is not at its goal");
        }
        let status = &self.emove_out.status;
        let number = self.command.number;
        if !is_done(&self.emove_out, number) || is_done(&before.emove_out, number) {
            return Ok(());
        }
        match self.command.command {
            _ if before.is_moving() => Err("done, and the robot moves"),
            EmoveVerb::Pause => Ok(()),
            EmoveVerb::MovToLoc => {
                let goal = place(self.command.location.as_str()).frame;
                let there = goal.distance(&stands).inches <= THERE;
                let known = status.at.is_some_and(|at| at.location == self.command.location);
                match (there, known) {
                    (false, _) => Err("done, and the robot is not there"),
                    (true, false) => Err("done, and E-move does not know that the robot is there"),
                    (true, true) => Ok(()),
                }
            }
            _ => Err("an unknown command is done"),
        }
    }

    /// What does not count any more begins again.
    fn renumber(&mut self) {
        renumber_poses(&mut self.emove, &mut self.emove_out);
        let (emove, out) = (&mut self.emove, &mut self.emove_out);
        let (prim, below) = (&mut self.prim, &mut self.prim_out);
        for (at, record) in (1..).zip(&mut below.poses) {
            record.number = record.number.map(|_| pose_range::PRIM | at);
        }
        let [present, sensor, ..] = below.poses;
        (below.status.present_pose, below.status.sensor_pose) = (present.number, sensor.number);
        (out.status.reference_pose, prim.newest_pose) = (None, pose_range::PRIM | 9);
        let echo = &mut emove.execution.receiver.echo;
        rebase_echoes(&mut [&mut self.command.number, echo, &mut out.status.echo]);
        let echo = &mut prim.execution.receiver.echo;
        rebase(&mut emove.prim, &mut [&mut out.prim.number, echo, &mut below.status.echo]);
        rebase(&mut emove.quick_change, &mut [&mut out.quick_change.number, &mut self.quick_change]);
        rebase(&mut prim.t3i, &mut [&mut below.t3i.number, &mut self.t3i.echo]);
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let moving = self.is_moving();
        let (motions, faults) = self.left;
        let mut links = if moving { vec![Link::Goes] } else { vec![Link::Busy, Link::Goes] };
        if moving && !self.halved && (motions, faults) != (0, 0) {
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
            links.extend([Restarted::Emove, Restarted::Prim].map(Link::Restart));
        }
        let quiet = links.iter().map(|link| (Event { told: None, link: *link }, *link == Link::Goes));
        let mut events: Vec<_> = quiet.collect();
        let status = &self.emove_out.status;
        let ended = status.echo == self.command.number && status.report != StatusReport::Executing;
        if motions > 0 || !self.interrupts() {
            let last =
                if self.command.command == EmoveVerb::Pause { "" } else { self.command.location.as_str() };
            let may = core::iter::once(&"").chain(self.places).filter(|told| ended || **told != last);
            events.extend(may.map(|told| {
                (Event { told: Some(told), link: if moving { Link::Goes } else { Link::Busy } }, false)
            }));
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        if let Some(location) = event.told {
            self.left.0 -= u8::from(self.interrupts());
            self.tell(location);
        }
        self.left.1 -= u8::from(!matches!(event.link, Link::Busy | Link::Goes | Link::Half));
        let (before, order) = (self.said(), self.emove_out.prim.number);
        self.halved |= event.link == Link::Half;
        let half = self.prim.motion.map_or(0.0, |motion| motion.distance() / 2.0);
        for _ in 0..LONG {
            self.tick(event.link)?;
            let goes = match event.link {
                Link::Goes => {
                    self.is_moving() || (self.aside > 0 && self.prim.execution.outcome == Outcome::Executing)
                }
                Link::Half => self.prim.motion.is_some_and(|motion| motion.distance() > half),
                _ => false,
            };
            if !goes || self.said() != before {
                self.halved &= self.emove_out.prim.number == order;
                return Ok(());
            }
        }
        Err("a motion that never ends")
    }

    /// Without what no row asks for any more: reasons; the nearest places; how long the robot has stood beyond what
    /// counts; when a link was restarted, since so many faults cannot come.
    fn image(&self) -> Vec<u8> {
        let mut image = Image::new(self.tick, LIMIT, &[]);
        let mut it = self.clone();
        (it.emove.execution.reason, it.prim.execution.reason) = (Reason::None, Reason::None);
        if it.emove.execution.outcome != Outcome::Executing {
            it.emove.execution.last_order = None;
            if it.command.command != EmoveVerb::Pause {
                (it.emove.step, it.emove.ordered, it.emove.uses_prim) = Default::default();
                (it.emove.route, it.emove.back, it.emove.rejoin) = Default::default();
            }
        }
        it.emove.surroundings = Default::default();
        it.emove.beliefs.placed = None;
        it.prim.restarts = Default::default();
        if it.prim.execution.outcome != Outcome::Executing {
            it.prim.standstill = Default::default();
        }
        let ended = &mut it.prim.standstill;
        ended.finished = ended.finished.min(50);
        ended.settled = ended.settled.min(3);
        ended.still = ended.still.min(3);
        image.add(&it.command);
        image.add(&it.emove);
        image.add(&it.emove_out.prim);
        image.add(&it.emove_out.poses);
        image.add(&it.emove_out.quick_change);
        image.add(&it.emove_out.status.echo);
        image.add(&it.emove_out.status.report);
        image.add(&it.prim);
        image.add(&it.prim_out.poses);
        image.add(&it.prim_out.t3i);
        let status = &it.prim_out.status;
        image.add(&status.echo);
        image.add(&status.report);
        image.add(&status.restarting);
        image.add(&status.link_running);
        image.add(&it.quick_change);
        image.add(&it.t3i);
        image.bytes.extend([u8::from(it.silent), it.aside, u8::from(it.halved), it.left.0, it.left.1]);
        image.add(&WireFrame::from_frame(&it.robot));
        image.bytes
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
