//! Positions of the grippers, on the robot, in a holster or on the floor, and their changes.
//!
//! A gripper that the ring holds moves with the arm. A released gripper lands on the holster under it, or falls. A
//! gripper is *mated* while its pins touch, locked or not. Only a mated gripper has air and sensors. Grippers at rest
//! in their holsters are not simulated.

use geometry::frame::Frame;
use interfaces::device::{HolsterSensors, QuickChangeSensors, QuickChangeValves};
use serde::{Deserialize, Serialize};

use crate::{
    cell::{RingState, WorkstationError},
    description::{CellDescription, Mounted, QuickChange},
    hand::{Hand, ROBOT_HANDS},
    holster::{Holster, HolsterSeat, ears, holsters},
    quick_change::{Gap, Ring},
    sensor::Switch,
};

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum GripperPlace {
    Robot,
    /// It is on a holster (0 right, 1 left, 2 centre).
    Holster(usize, HolsterSeat),
    Fallen,
    Away,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Changer {
    description: QuickChange,
    ring: Ring,
    holsters: [Holster; 3],
    places: [GripperPlace; 3], // places of the parts gripper, the v-gripper and the tool gripper
    mated: Option<Hand>,
    under_lips: Option<usize>, // the holster whose lips are over the ears of the gripper in the ring
    eyes: [[Switch; 4]; 3],    // the four sensors of each holster
    reflectance: [Switch; 2],  // the two sensors of the ring: locked, unlocked
}

impl Changer {
    /// The state in the description: one gripper may be on the robot; the others hang in the seats of their holsters.
    pub(crate) fn new(cell: &CellDescription) -> Self {
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
    pub(crate) fn mated(&self) -> Option<Hand> {
        self.mated
    }

    pub(crate) fn carried(&self) -> Option<Hand> {
        ROBOT_HANDS.into_iter().find(|hand| self.place(*hand) == Some(GripperPlace::Robot))
    }

    /// True if no change is in progress: the ring is at one of its ends, and it holds the gripper whose pins touch.
    pub(crate) fn rests(&self) -> bool {
        (self.ring.locked() || self.ring.unlocked()) && self.mated() == self.carried()
    }

    pub(crate) fn ring_state(&self) -> RingState {
        match (self.ring.locked(), self.ring.unlocked()) {
            (true, _) => RingState::Locked,
            (_, true) => RingState::Open,
            _ => RingState::Between,
        }
    }

    /// Place of a gripper; `None` for the pedestal's hand.
    pub(crate) fn place(&self, hand: Hand) -> Option<GripperPlace> {
        hand.slot().map(|slot| self.places[slot])
    }

    /// Tool frame of a gripper: `robot` if the ring holds it, else its frame on the holster.
    pub(crate) fn frame(&self, hand: Hand, robot: &Frame) -> Option<Frame> {
        match self.place(hand)? {
            GripperPlace::Robot => Some(*robot),
            GripperPlace::Holster(which, perch) => Some(self.holsters[which].gripper(&perch)),
            GripperPlace::Fallen | GripperPlace::Away => None,
        }
    }

    /// True if it must be simulated: it moves, can be moved, or can move another body.
    pub(crate) fn is_present(&self, hand: Hand) -> bool {
        match self.place(hand) {
            Some(GripperPlace::Holster(_, perch)) => self.mated == Some(hand) || !perch.rests(),
            Some(GripperPlace::Away) => false,
            Some(GripperPlace::Robot | GripperPlace::Fallen) | None => true,
        }
    }

    fn is_empty(&self, holster: usize) -> bool {
        !self.places.iter().any(|place| matches!(place, GripperPlace::Holster(which, _) if *which == holster))
    }

    fn land(&self, robot: &Frame) -> GripperPlace {
        let caught = self.holsters.iter().enumerate().find_map(|(which, holster)| {
            let perch = holster.catch(&holster.offset(robot)).filter(|_| self.is_empty(which))?;
            Some(GripperPlace::Holster(which, perch))
        });
        caught.unwrap_or(GripperPlace::Fallen)
    }

    /// The place of the gripper in the ring if the lips of a holster hold its ears down and detach it.
    fn torn(&mut self, robot: &Frame) -> Option<GripperPlace> {
        if let Some(which) = self.under_lips {
            let holster = &self.holsters[which];
            let offset = holster.offset(robot);
            if holster.tears(&offset) {
                self.under_lips = None;
                let forward = holster.slide(offset.forward);
                return Some(GripperPlace::Holster(which, HolsterSeat { forward, ..holster.seated() }));
            }
        }
        self.under_lips = self
            .holsters
            .iter()
            .position(|holster| holster.is_near(robot) && holster.holds_down(&holster.offset(robot)));
        None
    }

    /// A time step of a gripper on its holster: it falls, slides with an engaged A plate, and is locked by the ring.
    fn step_on_holster(
        &mut self,
        hand: Hand,
        which: usize,
        mut perch: HolsterSeat,
        step: &Step,
    ) -> GripperPlace {
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

    pub(crate) fn sensors(&mut self, hysteresis: f64) -> QuickChangeSensors {
        let [locked, unlocked] = self.ring.beyond();
        QuickChangeSensors {
            locked: self.reflectance[0].see(locked, hysteresis),
            unlocked: self.reflectance[1].see(unlocked, hysteresis),
            end_effector_id: self.mated.and_then(Hand::end_effector_id).unwrap_or(0),
        }
    }

    /// Move the ring for `dt` seconds with the robot's tool frame at `robot`, and update the grippers' places.
    pub(crate) fn advance(&mut self, dt: f64, robot: &Frame, valves: &QuickChangeValves) -> Changes {
        let mut changes = Changes::default();
        let was_locked = self.ring.locked();
        self.ring.advance(dt, valves);
        let step = Step { dt, robot: *robot, locks: self.ring.locked() && !was_locked };
        for (slot, hand) in ROBOT_HANDS.into_iter().enumerate() {
            let next = match self.places[slot] {
                GripperPlace::Robot => self.keep_or_lose(hand, robot, &mut changes),
                GripperPlace::Holster(which, perch) => Some(self.step_on_holster(hand, which, perch, &step)),
                GripperPlace::Fallen | GripperPlace::Away => None,
            };
            self.places[slot] = next.unwrap_or(self.places[slot]);
        }
        let mated = self.find_mated(robot);
        if mated != self.mated {
            changes.parted = std::mem::replace(&mut self.mated, mated);
        }
        changes
    }

    /// New place of the gripper in the ring; `None` if the ring keeps it.
    fn keep_or_lose(&mut self, hand: Hand, robot: &Frame, changes: &mut Changes) -> Option<GripperPlace> {
        if self.ring.unlocked() {
            self.under_lips = None;
            let place = self.land(robot);
            changes.fell = (place == GripperPlace::Fallen).then_some(hand);
            return Some(place);
        }
        let place = self.torn(robot)?;
        changes.torn = Some(hand);
        Some(place)
    }

    /// Place a gripper in a holster, numbered from 0 in the order of the ids, or remove it from the cell. Returns the
    /// gripper. On error, the state is unchanged.
    pub(crate) fn hang(&mut self, id: u8, holster: Option<usize>) -> Result<Hand, WorkstationError> {
        let mut hands = ROBOT_HANDS.into_iter().zip(0..);
        let named = hands.find(|(hand, _)| hand.end_effector_id() == Some(id));
        let (hand, slot): (Hand, usize) = named.ok_or(WorkstationError::NoSuchGripper { id })?;
        let name = || hand.link().to_owned();
        if self.carried() == Some(hand) || self.mated == Some(hand) {
            return Err(WorkstationError::Held { part: name() });
        }
        self.places[slot] = match holster {
            None => GripperPlace::Away,
            Some(which) => {
                let holster = self.holsters.get(which);
                let seat = holster.ok_or(WorkstationError::NoSuchHolster { number: which })?.seated();
                let is_there = |other: &Hand| {
                    *other != hand
                        && matches!(self.place(*other), Some(GripperPlace::Holster(at, _)) if at == which)
                };
                if let Some(by) = ROBOT_HANDS.into_iter().find(is_there) {
                    return Err(WorkstationError::Occupied { part: name(), by: by.link().to_owned() });
                }
                GripperPlace::Holster(which, seat)
            }
        };
        Ok(hand)
    }

    /// Readings of the proximity sensors of the holsters, with the tool frames of the grippers.
    pub(crate) fn holster_sensors(
        &mut self,
        cell: &CellDescription,
        grippers: &[Frame; 3],
    ) -> HolsterSensors {
        let nearest = |holster: &Holster| {
            ROBOT_HANDS.into_iter().zip(grippers).fold([f64::INFINITY; 4], |nearest, (hand, gripper)| {
                if !holster.is_near(gripper) {
                    return nearest;
                }
                let beyond = holster.beyond(gripper, &ears(&cell.holsters, hand.description(cell)));
                [0, 1, 2, 3].map(|eye| f64::min(nearest[eye], beyond[eye]))
            })
        };
        let beyond = [0, 1, 2].map(|which| nearest(&self.holsters[which]));
        let hysteresis = cell.sensors.proximity_hysteresis;
        let [right, left, centre] = [0, 1, 2].map(|which: usize| {
            let eyes = self.eyes[which].iter_mut().zip(beyond[which]);
            eyes.enumerate()
                .fold(0, |bits, (bit, (eye, beyond))| bits | (u8::from(eye.see(beyond, hysteresis)) << bit))
        });
        HolsterSensors { right, left, centre }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Changes {
    /// The ring has released this gripper away from a holster.
    pub(crate) fell: Option<Hand>,
    /// The lips of a holster have detached this gripper from the ring.
    pub(crate) torn: Option<Hand>,
    pub(crate) parted: Option<Hand>,
}

struct Step {
    dt: f64,
    robot: Frame,
    locks: bool, // the ring has just reached its locked end
}
