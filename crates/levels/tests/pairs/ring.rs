//! E-move and Quick Change. Around them: Subtask, the locking ring with its sensors and id pins, the gripper and its
//! holster, Prim with the robot, Grip with its fingers.
//!
//! What is abstracted: a motion is one step, and half of it can be seen once. A guarded move ends where its sensor sees
//! the gripper, or at its end without that. The ring obeys, stands still for any time, or stands half-way, and only
//! moves with air and an open port. A gripper mates at its seat, and stays there if the robot rises from an open ring.

mod judge;
mod states;

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, QuickChangeOutputs, StatusReport,
    device::QuickChangeSensors,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip},
    prim::{PrimReport, PrimVerb},
    process::{Inputs, Process},
    quick_change::RingPosition,
};
use levels::{
    emove::{self, Emove},
    execution::Outcome,
    places::robot_at,
    quick_change::{self, QuickChange},
};
use rcs_core::tick::Tick;

use crate::{
    data::{data, emove_command, place},
    emove::run,
    holster::{self, GRIPPER, Ring, SEAT, holster},
    parts_gripper::{GripDoes, PartsGripper},
    robot::{PrimDoes, Robot, SETTLED},
    search::{Mishap, World, Wrong, resumed},
};

/// Longer than the time in which the ring must arrive.
const LONG: u64 = 50;
/// Ticks for which a reading counts at most.
const STEADY: u8 = 12;
/// Opening of the fingers at the start, 0.01 in.
const OPENING: i32 = 300;

/// What the sensors say instead of the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The truth.
    None,
    /// Both sensors see the ring.
    Both,
    /// The id pins read this.
    Pins(u8),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub told: Option<EmoveVerb>,
    pub prim: PrimDoes,
    pub grip: GripDoes,
    /// Where the ring stands then.
    pub ring: Ring,
    /// The sensors fail so from then on.
    pub fault: Option<Fault>,
    pub mishap: Mishap,
    /// A long time has passed in which nothing else happened.
    pub long: bool,
}

#[derive(Clone)]
pub struct Pair {
    tick: Tick,
    /// Prim, Grip and the ring do not fail, and no motion is seen half-way.
    obeys: bool,
    /// Commands that may still come before the last one has ended, and faults or restarts that may.
    left: (u8, u8),
    command: EmoveCommand,
    emove: emove::State,
    emove_out: EmoveOutputs,
    quick_change: quick_change::state::State,
    quick_change_out: QuickChangeOutputs,
    ring: Ring,
    fault: Fault,
    robot: Robot,
    grip: PartsGripper,
    /// The gripper is on the quick change; else it is in its holster.
    mated: bool,
}

/// A gripper is seated within this, in.
const SEATED: f64 = 0.06;

impl Pair {
    /// A bare robot above the gripper with an open ring. `early` commands may come before the last one has ended, and
    /// `faults` faults or restarts may happen; if any may, Prim, Grip and the ring do not fail.
    pub fn first(early: u8, faults: u8) -> Self {
        let (_, object, location) = GRIPPER;
        let at = place(location);
        let command = emove_command(EmoveVerb::None, object, 2, location);
        let object = command.object.unwrap_or_default();
        let bare = data().grip_movetable(&object, 2, &at.place).expect("the data have the grip");
        let above = data().moved(&at.frame, bare);
        let stands = robot_at(GoneTo::Object(ObjectGrip { object, grip: 2 }), &at, &above);
        let mut pair = Self {
            tick: Tick(10_000),
            obeys: faults > 0,
            left: (early, faults),
            command: EmoveCommand::default(),
            emove: emove::State::default(),
            emove_out: EmoveOutputs::default(),
            quick_change: quick_change::state::State {
                ring: RingPosition::Unlocked,
                reading: RingPosition::Unlocked,
                reading_ticks: STEADY,
                ..quick_change::state::State::default()
            },
            quick_change_out: QuickChangeOutputs::default(),
            ring: Ring::Unlocked,
            fault: Fault::None,
            robot: Robot::new(stands.pose),
            grip: PartsGripper::new(OPENING),
            mated: false,
        };
        (pair.emove_out.beliefs.place, pair.emove_out.beliefs.empty) = (Some(stands), true);
        pair.emove.adopt(&pair.emove_out.beliefs);
        pair.emove.execution.receiver.started = true;
        pair.quick_change.execution.receiver.started = true;
        pair.quick_change_out.status.ring = RingPosition::Unlocked;
        pair.emove_out.dormant.grip = true;
        pair
    }

    fn tell(&mut self, verb: EmoveVerb) {
        self.command = holster::command(self.command.number + 1, verb);
    }

    /// Where the robot stands.
    fn stands(&self) -> Frame {
        self.robot.at.to_frame().expect("the robot stands at frames")
    }

    /// Something mates at the seat, or stays there.
    fn mate(&mut self) {
        let (x, z) = holster::within(&self.stands());
        let seated = (z - SEAT).abs() < SEATED;
        if seated && x > -0.05 {
            self.mated = true;
        } else if seated && self.ring == Ring::Unlocked {
            self.mated = false;
        }
    }

    /// What the sensors of the holster see.
    fn holster_sensors(&self) -> u8 {
        let (x, z) = holster::within(&self.stands());
        match self.mated {
            false => 0b1111,
            true if (z - SEAT).abs() < SEATED && x > -0.05 => 0b1111,
            true if x > -0.05 => 0b0011,
            true if x > -1.0 => 0b0001,
            true => 0,
        }
    }

    fn sensors(&self) -> QuickChangeSensors {
        let both = self.fault == Fault::Both;
        let id = if self.mated { GRIPPER.0 } else { 0 };
        QuickChangeSensors {
            locked: both || self.ring == Ring::Locked,
            unlocked: both || self.ring == Ring::Unlocked,
            end_effector_id: if let Fault::Pins(id) = self.fault { id } else { id },
        }
    }

    /// What the processes read.
    fn memory(&self) -> CommonMemory {
        let before = self.tick.previous();
        let mut memory = CommonMemory::default();
        memory.subtask.emove = self.command;
        (memory.emove, memory.quick_change) = (self.emove_out, self.quick_change_out);
        self.robot.write(&mut memory, before);
        memory.prim.status.holster_right = self.holster_sensors();
        self.grip.write(&mut memory, before);
        (memory.subtask.header.stamp, memory.emove.header.stamp) = (before, before);
        memory.quick_change.header.stamp = before;
        memory
    }

    /// Prim, Grip and the ring do something.
    fn surroundings(&mut self, event: Event, memory: &CommonMemory) -> Result<(), Wrong> {
        let new = memory.emove.prim.number != self.robot.echo;
        self.robot.take(memory)?;
        if new && memory.emove.prim.command == PrimVerb::GoUntil {
            // The sensors see the gripper where it stands before its seat, or at it.
            let seats = memory.emove.prim.sensor.is_some_and(|sensor| sensor.as_str().ends_with("SEAT"));
            let seat = Frame { position: holster().position + holster().z() * SEAT, ..holster() };
            self.robot.goal = Some(Pose::from_frame(&if seats { seat } else { holster() }));
        }
        self.robot.does(event.prim);
        if memory.emove.dormant.grip {
            self.grip.sleep(&memory.emove.grip);
        } else {
            self.grip.does(event.grip, &memory.emove.grip)?;
        }
        (self.ring, self.fault) = (event.ring, event.fault.unwrap_or(self.fault));
        self.mate();
        Ok(())
    }

    /// Is the ring given air, so that it turns?
    fn is_driven(&self) -> bool {
        self.quick_change_out.valves.port
    }

    fn has_ended(&self) -> bool {
        let status = &self.emove_out.status;
        status.echo == self.command.number && status.report != StatusReport::Executing
    }

    fn grips(&self) -> bool {
        !self.emove_out.dormant.grip && self.grip.is_busy(&self.emove_out.grip)
    }

    /// Any command can come when the last one has ended, and another one than it before.
    fn commands(&self) -> Vec<Option<EmoveVerb>> {
        let all = [EmoveVerb::Pause, EmoveVerb::QcAttach, EmoveVerb::QcDetach];
        let may = |verb: &EmoveVerb| self.has_ended() || (*verb != self.command.command && self.left.0 > 0);
        core::iter::once(None).chain(all.into_iter().filter(may).map(Some)).collect()
    }

    /// Prim has taken its last order.
    fn has_taken(&self) -> bool {
        self.emove_out.prim.number == 0 || self.emove_out.prim.number == self.robot.echo
    }

    /// What Prim may do: a motion ends when the robot has come to rest at its goal.
    fn prim_may(&self) -> Vec<PrimDoes> {
        let robot = &self.robot;
        let mut may = vec![PrimDoes::Goes];
        if robot.report != PrimReport::Executing || !self.has_taken() {
            return may;
        }
        may.extend((!self.obeys).then_some(PrimDoes::Fails));
        if robot.goal.is_none() {
            may.push(PrimDoes::Ends);
        } else if robot.there == 0 {
            may.push(PrimDoes::Arrives);
            may.extend((!robot.half && !self.obeys).then_some(PrimDoes::Half));
            may.extend((self.emove_out.prim.command == PrimVerb::GoUntil).then_some(PrimDoes::Misses));
        } else if robot.there == SETTLED {
            may.push(PrimDoes::Ends);
        }
        may
    }

    /// What can go wrong beside.
    fn mishaps(&self) -> Vec<(Option<Fault>, Mishap)> {
        let mishaps = Mishap::choices(self.left.1, Mishap::RESTARTS).into_iter().map(|mishap| (None, mishap));
        let faults = [Fault::Both, Fault::Pins(0), Fault::Pins(2), Fault::Pins(7)];
        let faults = faults.into_iter().filter(|_| self.left.1 > 0).map(|fault| (Some(fault), Mishap::None));
        mishaps.chain(faults).collect()
    }
}

impl World for Pair {
    type Event = Event;

    fn events(&self) -> Vec<(Event, bool)> {
        let (moving, gripping) = (self.robot.is_busy(&self.emove_out.prim), self.grips());
        let prim = self.prim_may();
        let grip: &[_] = match (gripping, self.obeys) {
            (true, false) => &[GripDoes::Goes, GripDoes::Ends, GripDoes::Fails],
            (true, true) => &[GripDoes::Goes, GripDoes::Ends],
            (false, _) => &[GripDoes::Goes],
        };
        let driven = self.is_driven();
        let arrived = if self.quick_change_out.valves.lock { Ring::Locked } else { Ring::Unlocked };
        let mut rings = vec![self.ring];
        if driven && self.ring != arrived {
            rings.push(arrived);
            rings.extend((self.ring != Ring::Between && !self.obeys).then_some(Ring::Between));
        }
        let mut events = Vec::new();
        for told in self.commands() {
            for &prim in &prim {
                for &grip in grip {
                    for &ring in &rings {
                        for (fault, mishap) in self.mishaps() {
                            let event = Event { told, prim, grip, ring, fault, mishap, long: false };
                            let quiet = told.is_none() && fault.is_none() && mishap == Mishap::None;
                            if !quiet && told.is_some() && (fault.is_some() || mishap != Mishap::None) {
                                continue;
                            }
                            let ends = (prim != PrimDoes::Half
                                && (prim != PrimDoes::Goes
                                    || !moving
                                    || (1..SETTLED).contains(&self.robot.there)
                                    || !self.has_taken()))
                                && (!gripping || grip != GripDoes::Goes)
                                && (!driven || ring == arrived);
                            events.push((event, quiet && ends));
                            let waits = quiet && !moving && !gripping && driven && ring == self.ring;
                            if waits && self.is_steady() {
                                events.push((Event { long: true, ..event }, true));
                            }
                        }
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Event) -> Result<(), Wrong> {
        self.tick = if event.long { Tick(self.tick.0 + LONG) } else { self.tick.next() };
        let mut process: Emove = resumed(self.emove, event.mishap == Mishap::RestartUpper);
        if event.mishap == Mishap::RestartLower {
            self.quick_change = quick_change::state::State::default();
        }
        let fails = event.fault.is_some_and(|fault| fault != Fault::None);
        self.left.1 -= u8::from(event.mishap != Mishap::None) + u8::from(fails);
        if let Some(verb) = event.told {
            self.left.0 -= u8::from(!self.has_ended());
            self.tell(verb);
        }
        let memory = self.memory();
        let mut external = ExternalInputs::default();
        external.devices.quick_change = self.sensors();
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        let old = self.clone();
        process.step(&inputs, &mut self.emove_out);
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &() };
        self.emove = *process.state();
        run::<QuickChange>(&mut self.quick_change, &inputs, &mut self.quick_change_out);
        self.surroundings(event, &memory)?;
        let wrong = self.judge(&old);
        self.renumber();
        wrong
    }

    fn image(&self) -> Vec<u8> {
        self.alike()
    }

    fn rests(&self) -> bool {
        let (emove, ring) = (&self.emove.execution, &self.quick_change.execution);
        self.has_ended()
            && emove.outcome != Outcome::Executing
            && !emove.waiting
            && self.is_settled()
            && ring.outcome != Outcome::Executing
            && !self.is_driven()
            && !self.robot.is_busy(&self.emove_out.prim)
            && self.robot.report != PrimReport::NotDetected
            && !self.grips()
    }

    fn pauses(&self) -> bool {
        self.command.command == EmoveVerb::Pause
    }
}
