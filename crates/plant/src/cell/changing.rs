//! Positions of the grippers, on the robot, in a holster or on the floor, and their changes.
//!
//! The state of the ring decides, not the command of the controller ([`crate::quick_change`]). A gripper that the ring
//! holds moves with the arm. A released gripper lands on the holster under it, or falls. It rests on its holster, and
//! slides with an A plate that engages it. A gripper is *mated* while its pins touch, locked or not: only then it has
//! air and its sensors are connected. The bodies of a gripper at rest in its holster are not simulated.

use geometry::frame::Frame;
use interfaces::device::{HolsterSensors, QuickChangeSensors, QuickChangeValves};
use rapier3d_f64::math::{Pose, Vector};
use serde::{Deserialize, Serialize};

use super::{Cell, CellEvent, handling::Hand, truth::RingState, workstation::WorkstationError};
use crate::{
    convert::{on_the_side_of, to_frame, to_pose},
    description::{CellDescription, Mounted, QuickChange},
    holster::{Holster, Perch, ears, holsters},
    quick_change::{Gap, Ring},
    sensor::Switch,
};

/// The grippers of the robot, in the order of their end effector ids.
pub(super) const ROBOT_HANDS: [Hand; 3] = [Hand::Parts, Hand::V, Hand::Tool];

/// Where a gripper is that a person has taken out of the cell, m: far below the floor.
const AWAY: Vector = Vector::new(0.0, 0.0, -100.0);

/// Place of a gripper.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(super) enum GripperPlace {
    /// The ring of the quick change holds it.
    Robot,
    /// It is on a holster (0 right, 1 left, 2 centre).
    Holster(usize, Perch),
    /// It was released away from a holster.
    Fallen,
    /// A person has taken it out of the cell.
    Away,
}

/// Quick change, holsters, and the places of the grippers.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Changer {
    description: QuickChange,
    ring: Ring,
    holsters: [Holster; 3],
    /// Places of the parts gripper, the v-gripper and the tool gripper.
    places: [GripperPlace; 3],
    /// The gripper whose pins touch.
    mated: Option<Hand>,
    /// The holster whose lips are over the ears of the gripper in the ring.
    under_lips: Option<usize>,
    /// The four sensors of each holster.
    eyes: [[Switch; 4]; 3],
    /// The two sensors of the ring: locked, unlocked.
    reflectance: [Switch; 2],
}

impl Changer {
    /// The state in the description: one gripper may be on the robot; the others hang in the seats of their holsters.
    pub(super) fn new(cell: &CellDescription) -> Self {
        let holsters = holsters(cell);
        let mated = match cell.quick_change.mounted {
            Mounted::None => None,
            Mounted::Parts => Some(Hand::Parts),
            Mounted::V => Some(Hand::V),
            Mounted::Tool => Some(Hand::Tool),
        };
        let mut places = [0, 1, 2].map(|which| GripperPlace::Holster(which, holsters[which].seated()));
        if let Some(slot) = mated.and_then(Hand::slot) {
            places[slot] = GripperPlace::Robot;
        }
        let ring = Ring::new(&cell.quick_change, mated.is_some());
        Self {
            description: cell.quick_change.clone(),
            ring,
            holsters,
            places,
            mated,
            under_lips: None,
            eyes: Default::default(),
            reflectance: Default::default(),
        }
    }

    /// The gripper whose pins touch: it has air, and its sensors are connected.
    pub(super) fn mated(&self) -> Option<Hand> {
        self.mated
    }

    /// The gripper that the ring holds.
    pub(super) fn carried(&self) -> Option<Hand> {
        ROBOT_HANDS.into_iter().find(|hand| self.place(*hand) == Some(GripperPlace::Robot))
    }

    /// True if no change is in progress: the ring is at one of its ends, and it holds the gripper whose pins touch.
    pub(super) fn rests(&self) -> bool {
        (self.ring.locked() || self.ring.unlocked()) && self.mated() == self.carried()
    }

    /// The locking ring.
    pub(super) fn ring_state(&self) -> RingState {
        match (self.ring.locked(), self.ring.unlocked()) {
            (true, _) => RingState::Locked,
            (_, true) => RingState::Open,
            _ => RingState::Between,
        }
    }

    /// Place of a gripper; `None` for the pedestal's hand.
    pub(super) fn place(&self, hand: Hand) -> Option<GripperPlace> {
        hand.slot().map(|slot| self.places[slot])
    }

    /// Tool frame of a gripper: `robot` if the ring holds it, else its frame on the holster.
    fn frame(&self, hand: Hand, robot: &Frame) -> Option<Frame> {
        match self.place(hand)? {
            GripperPlace::Robot => Some(*robot),
            GripperPlace::Holster(which, perch) => Some(self.holsters[which].gripper(&perch)),
            GripperPlace::Fallen | GripperPlace::Away => None,
        }
    }

    /// True if it must be simulated: it moves, can be moved, or can move something.
    fn is_present(&self, hand: Hand) -> bool {
        match self.place(hand) {
            Some(GripperPlace::Holster(_, perch)) => self.mated == Some(hand) || !perch.rests(),
            Some(GripperPlace::Away) => false,
            Some(GripperPlace::Robot | GripperPlace::Fallen) | None => true,
        }
    }

    fn is_empty(&self, holster: usize) -> bool {
        !self.places.iter().any(|place| matches!(place, GripperPlace::Holster(which, _) if *which == holster))
    }

    /// Where a gripper lands if the ring releases it at `robot`.
    fn land(&self, robot: &Frame) -> GripperPlace {
        let caught = self.holsters.iter().enumerate().find_map(|(which, holster)| {
            let perch = holster.catch(&holster.offset(robot)).filter(|_| self.is_empty(which))?;
            Some(GripperPlace::Holster(which, perch))
        });
        caught.unwrap_or(GripperPlace::Fallen)
    }

    /// The place of the gripper in the ring if the lips of a holster hold its ears down and tear it off; `None` if not.
    fn torn(&mut self, robot: &Frame) -> Option<GripperPlace> {
        if let Some(which) = self.under_lips {
            let holster = &self.holsters[which];
            let offset = holster.offset(robot);
            if holster.tears(&offset) {
                self.under_lips = None;
                let forward = holster.slide(offset.forward);
                return Some(GripperPlace::Holster(which, Perch { forward, ..holster.seated() }));
            }
        }
        self.under_lips = self
            .holsters
            .iter()
            .position(|holster| holster.is_near(robot) && holster.holds_down(&holster.offset(robot)));
        None
    }

    /// A time step of a gripper on its holster: it falls as far as there is room, slides with an engaged A plate, and
    /// is caught if the ring has just locked.
    fn step_on_holster(&mut self, hand: Hand, which: usize, mut perch: Perch, step: &Step) -> GripperPlace {
        let holster = &self.holsters[which];
        perch.fall(step.dt);
        let here = holster.gripper(&perch);
        if step.locks && Gap::between(&step.robot, &here).lies_together(&self.description) {
            return GripperPlace::Robot;
        }
        if self.mated == Some(hand) {
            let play = self.description.tolerance;
            let robot = holster.offset(&step.robot).forward;
            perch.forward = holster.slide(perch.forward.clamp(robot - play, robot + play));
        }
        GripperPlace::Holster(which, perch)
    }

    /// The gripper whose pins touch with the robot at `robot`.
    fn find_mated(&self, robot: &Frame) -> Option<Hand> {
        self.carried().or_else(|| {
            ROBOT_HANDS.into_iter().find(|hand| match self.place(*hand) {
                Some(GripperPlace::Holster(which, perch)) if self.holsters[which].is_near(robot) => {
                    Gap::between(robot, &self.holsters[which].gripper(&perch)).engaged(&self.description)
                }
                _ => false,
            })
        })
    }

    /// The sensors of the ring and the id pins.
    pub(super) fn sensors(&mut self, hysteresis: f64) -> QuickChangeSensors {
        let [locked, unlocked] = self.ring.beyond();
        QuickChangeSensors {
            locked: self.reflectance[0].see(locked, hysteresis),
            unlocked: self.reflectance[1].see(unlocked, hysteresis),
            end_effector_id: self.mated.and_then(Hand::end_effector_id).unwrap_or(0),
        }
    }
}

/// Inputs of the grippers in a step of the simulation.
struct Step {
    dt: f64,
    robot: Frame,
    /// The ring has just reached its locked end.
    locks: bool,
}

impl Cell {
    /// Move the ring, catch or release grippers, and update their places.
    pub(super) fn change_grippers(&mut self, dt: f64, valves: &QuickChangeValves) {
        let robot = self.t3.arm().tool();
        let was_locked = self.changer.ring.locked();
        self.changer.ring.advance(dt, valves);
        let step = Step { dt, robot, locks: self.changer.ring.locked() && !was_locked };
        for hand in ROBOT_HANDS {
            let next = match self.changer.place(hand) {
                Some(GripperPlace::Robot) => self.keep_or_lose(hand, &robot),
                Some(GripperPlace::Holster(which, perch)) => {
                    Some(self.changer.step_on_holster(hand, which, perch, &step))
                }
                _ => None,
            };
            if let (Some(place), Some(slot)) = (next, hand.slot()) {
                self.changer.places[slot] = place;
            }
        }
        self.mate(&robot);
        self.lead_grippers(&robot);
    }

    /// Move the bodies of the grippers to their start positions.
    pub(super) fn hang_grippers(&mut self) {
        let robot = self.t3.arm().tool();
        for hand in ROBOT_HANDS {
            let Some(frame) = self.changer.frame(hand, &robot) else { continue };
            let present = self.changer.is_present(hand);
            let (gripper, world) = self.hand_at_work(hand);
            gripper.hang(world, &to_pose(&frame));
            gripper.set_present(world, present);
        }
    }

    /// Hang a gripper that is not on the robot in a holster, numbered from 0 in the order of the grippers' ids, or take it
    /// out of the cell, as a person does.
    ///
    /// # Errors
    /// [`WorkstationError`] if there is no such gripper or holster, the quick change has the gripper, or another one is
    /// in the holster; the state is unchanged.
    pub fn hang_gripper(&mut self, id: u8, holster: Option<usize>) -> Result<(), WorkstationError> {
        let none = WorkstationError::NoSuchGripper { id };
        let hand = ROBOT_HANDS.into_iter().find(|hand| hand.end_effector_id() == Some(id)).ok_or(none)?;
        let name = || hand.link().to_owned();
        if self.changer.carried() == Some(hand) || self.changer.mated() == Some(hand) {
            return Err(WorkstationError::Held { part: name() });
        }
        let place = match holster {
            None => GripperPlace::Away,
            Some(which) => {
                let holster = self.changer.holsters.get(which);
                let seat = holster.ok_or(WorkstationError::NoSuchHolster { number: which })?.seated();
                let by = ROBOT_HANDS.into_iter().find(|other| {
                    *other != hand
                        && matches!(self.changer.place(*other), Some(GripperPlace::Holster(at, _)) if at == which)
                });
                if let Some(by) = by {
                    return Err(WorkstationError::Occupied { part: name(), by: by.link().to_owned() });
                }
                GripperPlace::Holster(which, seat)
            }
        };
        if let Some(slot) = hand.slot() {
            self.changer.places[slot] = place;
        }
        let (gripper, world) = self.hand_at_work(hand);
        gripper.pick_up(world);
        gripper.hang(world, &Pose::from_translation(AWAY));
        self.hang_grippers();
        Ok(())
    }

    /// New place of the gripper in the ring; `None` if the ring keeps it.
    fn keep_or_lose(&mut self, hand: Hand, robot: &Frame) -> Option<GripperPlace> {
        if self.changer.ring.unlocked() {
            self.changer.under_lips = None;
            let place = self.changer.land(robot);
            if place == GripperPlace::Fallen {
                let weight = self.description.gripper.weight;
                let (gripper, world) = self.hand_at_work(hand);
                gripper.fall(world, weight);
                self.events.push(CellEvent::GripperFell { gripper: hand.link().into() });
            }
            return Some(place);
        }
        let place = self.changer.torn(robot)?;
        self.events.push(CellEvent::GripperTorn { gripper: hand.link().into() });
        Some(place)
    }

    /// Find the mated gripper; a gripper whose pins disconnect loses its air.
    fn mate(&mut self, robot: &Frame) {
        let mated = self.changer.find_mated(robot);
        if mated == self.changer.mated {
            return;
        }
        let parted = std::mem::replace(&mut self.changer.mated, mated);
        if let Some(hand) = parted {
            self.let_go(hand, true);
            let (gripper, world) = self.hand_at_work(hand);
            gripper.air.cut();
            gripper.move_fingers(world);
            gripper.hang_fingers(world);
        }
    }

    /// Move the bodies of the grippers to their places on robot and holsters.
    fn lead_grippers(&mut self, robot: &Frame) {
        for (slot, hand) in ROBOT_HANDS.into_iter().enumerate() {
            let present = self.changer.is_present(hand);
            let gripper = &self.grippers[slot];
            if self.world.bodies[gripper.hand()].is_enabled() != present {
                gripper.set_present(&mut self.world, present);
            }
            let Some(frame) = self.changer.frame(hand, robot).filter(|_| present) else { continue };
            let mut next = to_pose(&frame);
            let body = &mut self.world.bodies[gripper.hand()];
            next.rotation = on_the_side_of(body.rotation(), next.rotation);
            body.set_next_kinematic_position(next);
        }
    }

    /// Readings of the proximity sensors of the holsters.
    pub(super) fn holster_sensors(&mut self) -> HolsterSensors {
        let nearest = |holster: &Holster| {
            ROBOT_HANDS.into_iter().enumerate().fold([f64::INFINITY; 4], |nearest, (slot, hand)| {
                let gripper = to_frame(self.world.bodies[self.grippers[slot].hand()].position());
                if !holster.is_near(&gripper) {
                    return nearest;
                }
                let ears = ears(&self.description.holsters, self.gripper_description(hand));
                let beyond = holster.beyond(&gripper, &ears);
                [0, 1, 2, 3].map(|eye| f64::min(nearest[eye], beyond[eye]))
            })
        };
        let beyond = [0, 1, 2].map(|which| nearest(&self.changer.holsters[which]));
        let hysteresis = self.description.sensors.proximity_hysteresis;
        let [right, left, centre] = [0, 1, 2].map(|which: usize| {
            let eyes = self.changer.eyes[which].iter_mut().zip(beyond[which]);
            eyes.enumerate()
                .fold(0, |bits, (bit, (eye, beyond))| bits | (u8::from(eye.see(beyond, hysteresis)) << bit))
        });
        HolsterSensors { right, left, centre }
    }

    /// The description of a gripper of the robot.
    pub(super) fn gripper_description(&self, hand: Hand) -> &crate::description::Gripper {
        let grippers = &self.description.gripper;
        match hand {
            Hand::Parts => &grippers.parts,
            Hand::V => &grippers.v,
            Hand::Tool => &grippers.tool,
            Hand::Pedestal => &self.description.pedestal.hand,
        }
    }

    /// End effector id of the gripper that the ring of the quick change holds, if any. The id pins also read a gripper
    /// that is mated and not locked.
    #[must_use]
    pub fn gripper(&self) -> Option<u8> {
        self.changer.carried().and_then(Hand::end_effector_id)
    }
}
