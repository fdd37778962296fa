//! E-move and Quick Change. Around them: Subtask, the locking ring with its sensors and id pins, the gripper and its
//! holster, Prim with the robot, Grip with its fingers.
//!
//! Abstractions: a motion is one step, and half of it can be seen once. A guarded move ends where its sensor
//! detects the gripper, or at its end without that. The ring obeys, does not move for any time, or stops half-way,
//! and only moves with air and an open port. A gripper mates at its seat, and stays there if the robot rises from
//! an open ring.

mod judge;
mod states;

use crate::{
    data::{data, emove_command, place},
    frame::{self, Choice, Event, Half, Scene},
    holster::{self, GRIPPER, Ring, SEAT, holster},
    parts_gripper::{GripDoes, PartsGripper},
    robot::{PrimDoes, Robot, SETTLED},
    search::Wrong,
};
use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory, ExternalInputs, StatusReport,
    device::QuickChangeSensors,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip},
    prim::{PrimReport, PrimVerb},
    quick_change::RingPosition,
};
use levels::{emove::Emove, execution::Outcome, places::robot_at, quick_change::QuickChange};

/// Greatest count of equal readings, ticks.
const STEADY: u8 = 12;
const OPENING: i32 = 300; // 0.01 in, opening at the start

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    None,
    Both,
    Pins(u8),
}

#[derive(Clone, Copy, Debug)]
pub struct Does {
    pub prim: PrimDoes,
    pub grip: GripDoes,
    pub ring: Ring,
    pub fault: Option<Fault>, // the fault of the sensors from now on
}

#[derive(Clone)]
pub struct Around {
    obeys: bool, // Prim, Grip and the ring do not fail, and no motion ends half-way
    ring: Ring,
    fault: Fault,
    robot: Robot,
    grip: PartsGripper,
    mated: bool, // the gripper is on the quick change; otherwise in its holster
}

pub type Pair = frame::Pair<Around>;

/// A gripper is seated within this distance, in.
const SEATED: f64 = 0.06;

/// A bare robot above the gripper with an open ring. If `faults` may happen, Prim, Grip and the ring do not fail.
pub fn first(early: u8, faults: u8) -> Pair {
    let (_, object, location) = GRIPPER;
    let at = place(location);
    let command = emove_command(EmoveVerb::None, object, 2, location);
    let object = command.object.unwrap_or_default();
    let bare = data().grip_movetable(&object, 2, &at.place).expect("the data have the grip");
    let above = data().moved(&at.frame, bare);
    let stands = robot_at(GoneTo::Object(ObjectGrip { object, grip: 2 }), &at, &above);
    let mut ring = Half::<QuickChange>::default();
    (ring.state.ring, ring.state.reading) = (RingPosition::Unlocked, RingPosition::Unlocked);
    (ring.state.reading_ticks, ring.out.status.ring) = (STEADY, RingPosition::Unlocked);
    let around = Around {
        obeys: faults > 0,
        ring: Ring::Unlocked,
        fault: Fault::None,
        robot: Robot::new(stands.pose),
        grip: PartsGripper::new(OPENING),
        mated: false,
    };
    let commands = [EmoveVerb::Pause, EmoveVerb::QcAttach, EmoveVerb::QcDetach];
    let mut pair = Pair::new(commands, (Some(early), faults), ring, around);
    let (emove, out) = (&mut pair.upper.state, &mut pair.upper.out);
    (out.estimates.place, out.estimates.empty) = (Some(stands), true);
    emove.adopt(&out.estimates);
    emove.execution.receiver.started = true;
    pair.lower.state.execution.receiver.started = true;
    out.dormant.grip = true;
    pair
}

impl Pair {
    fn stands(&self) -> Frame {
        self.scene.robot.at.to_frame().expect("the robot is at a valid frame")
    }

    /// The gripper mates at the seat, or stays there.
    fn mate(&mut self) {
        let (x, z) = holster::within(&self.stands());
        let seated = (z - SEAT).abs() < SEATED;
        if seated && x > -0.05 {
            self.scene.mated = true;
        } else if seated && self.scene.ring == Ring::Unlocked {
            self.scene.mated = false;
        }
    }

    fn holster_sensors(&self) -> u8 {
        let (x, z) = holster::within(&self.stands());
        match self.scene.mated {
            false => 0b1111,
            true if (z - SEAT).abs() < SEATED && x > -0.05 => 0b1111,
            true if x > -0.05 => 0b0011,
            true if x > -1.0 => 0b0001,
            true => 0,
        }
    }

    fn sensors(&self) -> QuickChangeSensors {
        let both = self.scene.fault == Fault::Both;
        let id = if self.scene.mated { GRIPPER.0 } else { 0 };
        QuickChangeSensors {
            locked: both || self.scene.ring == Ring::Locked,
            unlocked: both || self.scene.ring == Ring::Unlocked,
            end_effector_id: if let Fault::Pins(id) = self.scene.fault { id } else { id },
        }
    }

    fn is_driven(&self) -> bool {
        self.lower.out.valves.port
    }

    fn grips(&self) -> bool {
        !self.upper.out.dormant.grip && self.scene.grip.is_busy(&self.upper.out.grip)
    }

    fn has_taken(&self) -> bool {
        self.upper.out.prim.number == 0 || self.upper.out.prim.number == self.scene.robot.echo
    }

    /// A motion ends when the robot is at rest at its goal.
    fn prim_may(&self) -> Vec<PrimDoes> {
        let robot = &self.scene.robot;
        let mut may = vec![PrimDoes::Goes];
        if robot.report != PrimReport::Executing || !self.has_taken() {
            return may;
        }
        may.extend((!self.scene.obeys).then_some(PrimDoes::Fails));
        if robot.goal.is_none() {
            may.push(PrimDoes::Ends);
        } else if robot.there == 0 {
            may.push(PrimDoes::Arrives);
            may.extend((!robot.half && !self.scene.obeys).then_some(PrimDoes::Half));
            may.extend((self.upper.out.prim.command == PrimVerb::GoUntil).then_some(PrimDoes::Misses));
        } else if robot.there == SETTLED {
            may.push(PrimDoes::Ends);
        }
        may
    }
}

impl Scene for Around {
    type Upper = Half<Emove>;
    type Lower = Half<QuickChange>;
    type Line = EmoveVerb;
    type Command = EmoveCommand;
    type Does = Does;
    /// Longer than the time limit of the ring.
    const LONG: u64 = 50;

    fn choices(pair: &Pair) -> Vec<Choice<Does>> {
        let (moving, gripping) = (pair.scene.robot.is_busy(&pair.upper.out.prim), pair.grips());
        let prim = pair.prim_may();
        let grip: &[_] = match (gripping, pair.scene.obeys) {
            (true, false) => &[GripDoes::Goes, GripDoes::Ends, GripDoes::Fails],
            (true, true) => &[GripDoes::Goes, GripDoes::Ends],
            (false, _) => &[GripDoes::Goes],
        };
        let driven = pair.is_driven();
        let arrived = if pair.lower.out.valves.lock { Ring::Locked } else { Ring::Unlocked };
        let mut rings = vec![pair.scene.ring];
        if driven && pair.scene.ring != arrived {
            rings.push(arrived);
            rings.extend((pair.scene.ring != Ring::Between && !pair.scene.obeys).then_some(Ring::Between));
        }
        let faults = [Fault::Both, Fault::Pins(0), Fault::Pins(2), Fault::Pins(7)];
        let mut choices = Vec::new();
        for &prim in &prim {
            for &grip in grip {
                for &ring in &rings {
                    let ends = (prim != PrimDoes::Half
                        && (prim != PrimDoes::Goes
                            || !moving
                            || (1..SETTLED).contains(&pair.scene.robot.there)
                            || !pair.has_taken()))
                        && (!gripping || grip != GripDoes::Goes)
                        && (!driven || ring == arrived);
                    let waits = !moving && !gripping && driven && ring == pair.scene.ring;
                    let does = Does { prim, grip, ring, fault: None };
                    choices.push(Choice { long: waits && pair.is_steady(), ..Choice::new(does, ends) });
                    choices.extend(faults.map(|fault| {
                        let does = Does { fault: Some(fault), ..does };
                        Choice { mishaps: 1, ..Choice::new(does, false) }
                    }));
                }
            }
        }
        choices
    }

    fn has_ended(pair: &Pair) -> bool {
        let status = &pair.upper.out.status;
        status.echo == pair.command.number && status.report != StatusReport::Executing
    }

    fn is_other(pair: &Pair, verb: &EmoveVerb) -> bool {
        *verb != pair.command.command
    }

    fn command(pair: &mut Pair, nth: usize) {
        pair.command = holster::command(pair.command.number + 1, pair.lines[nth]);
    }

    fn inputs(pair: &Pair) -> (CommonMemory, ExternalInputs) {
        let before = pair.tick.previous();
        let (mut memory, mut external) = (CommonMemory::default(), ExternalInputs::default());
        memory.subtask.emove = pair.command;
        (memory.emove, memory.quick_change) = (pair.upper.out, pair.lower.out);
        pair.scene.robot.write(&mut memory, before);
        memory.prim.status.holster_right = pair.holster_sensors();
        pair.scene.grip.write(&mut memory, before);
        (memory.subtask.header.stamp, memory.emove.header.stamp) = (before, before);
        memory.quick_change.header.stamp = before;
        external.devices.quick_change = pair.sensors();
        (memory, external)
    }

    fn act(pair: &mut Pair, event: &Event<Does>, memory: &CommonMemory) -> Result<(), Wrong> {
        let new = memory.emove.prim.number != pair.scene.robot.echo;
        pair.scene.robot.take(memory)?;
        if new && memory.emove.prim.command == PrimVerb::GoUntil {
            // The sensors detect the gripper before its seat, or at it.
            let seats = memory.emove.prim.sensor.is_some_and(|sensor| sensor.as_str().ends_with("SEAT"));
            let seat = Frame { position: holster().position + holster().z() * SEAT, ..holster() };
            pair.scene.robot.goal = Some(Pose::from_frame(&if seats { seat } else { holster() }));
        }
        pair.scene.robot.does(event.does.prim);
        if memory.emove.dormant.grip {
            pair.scene.grip.sleep(&memory.emove.grip);
        } else {
            pair.scene.grip.does(event.does.grip, &memory.emove.grip)?;
        }
        (pair.scene.ring, pair.scene.fault) = (event.does.ring, event.does.fault.unwrap_or(pair.scene.fault));
        pair.mate();
        Ok(())
    }

    fn judge(pair: &Pair, before: &Pair, _: &Event<Does>) -> Result<(), Wrong> {
        pair.judge(before)
    }

    fn renumber(pair: &mut Pair) {
        pair.renumber();
    }

    fn image(pair: &Pair) -> Vec<u8> {
        pair.alike()
    }

    fn rests(pair: &Pair) -> bool {
        let (emove, ring) = (&pair.upper.state.execution, &pair.lower.state.execution);
        Self::has_ended(pair)
            && emove.outcome != Outcome::Executing
            && !emove.waiting
            && pair.is_settled()
            && ring.outcome != Outcome::Executing
            && !pair.is_driven()
            && !pair.scene.robot.is_busy(&pair.upper.out.prim)
            && pair.scene.robot.report != PrimReport::NotDetected
            && !pair.grips()
    }

    fn pauses(pair: &Pair) -> bool {
        pair.command.command == EmoveVerb::Pause
    }
}
