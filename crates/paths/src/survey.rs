//! Contacts and clearances of arm, gripper and held part, with the contact permits of the cell, as in a run.

use std::{collections::BTreeMap, fmt};

use geometry::{kinematics::Joints, units::Point};
use plant::{
    clearance::{Body, Contact},
    description::Kind,
    room::{Layout, Room},
    swept::Swept,
};
use serde::Serialize;

pub const MARGIN: f64 = 2.0;
/// Range of the clearance check, inches. A greater one skips more ticks, but makes each check slower.
pub(crate) const SIGHT: f64 = 4.0;
const FREE: f64 = 0.05; // in: ends a permitted contact
/// Additional depth (in, ASSUMED) for a part in nest or vise, because vision determines its place in the fingers.
pub const FIT: f64 = 0.02;
const PUSH_FIT: f64 = 0.05; // more depth for a pushed part, in (ASSUMED): it lies as it fell
/// Greatest displacement of any point of the robot, in per radian of each joint, base to roll.
const LEVERS: Joints = [105.0, 105.0, 65.0, 30.0, 27.0, 12.0];

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Passing {
    pub mover: String, // body of the robot, or its part
    pub obstacle: String,
    pub clearance_in: f64,     // negative if they touch
    pub position_in: [f64; 3], // inches, world
}

impl From<&Contact> for Passing {
    fn from(contact: &Contact) -> Self {
        Self {
            mover: contact.mover.clone(),
            obstacle: contact.obstacle.clone(),
            clearance_in: -contact.depth,
            position_in: contact.at,
        }
    }
}

impl fmt::Display for Passing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mover, obstacle, clearance_in, position_in } = self;
        let at = Point(*position_in);
        if *clearance_in < 0.0 {
            write!(f, "{mover} runs into {obstacle}, {:.2} in deep at {at}", -clearance_in)
        } else {
            write!(f, "{mover} passes {obstacle} by {clearance_in:.2} in at {at}")
        }
    }
}

/// The least clearance and the deepest contact of a leg.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub nearest: Option<Passing>, // within `MARGIN`
    pub touched: Option<Passing>, // not permitted
}

#[derive(Debug)]
pub struct Survey<'a> {
    room: &'a Room,
    layout: Layout,
    devices: &'a [Body],
    swept: Swept,
    commands: [&'static str; 2],              // of E-move and Subtask
    allowed: BTreeMap<(String, String), f64>, // greatest depth of each permitted contact, by pair of bodies
    at: Joints,
    free: f64, // in: displacement without a further check
    leg: Option<usize>,
    seen: Seen,
}

impl<'a> Survey<'a> {
    /// Joint angles in radians. `before`, the commands that brought the robot here, permit contacts at the start.
    #[must_use]
    pub fn new(
        room: &'a Room,
        layout: &Layout,
        devices: &'a [Body],
        commands: [&'static str; 2],
        start: &Joints,
        before: &[[&'static str; 2]],
    ) -> Self {
        let mut survey = Self {
            room,
            layout: layout.clone(),
            devices,
            swept: Swept::default(),
            commands,
            allowed: BTreeMap::new(),
            at: *start,
            free: 0.0,
            leg: None,
            seen: Seen::default(),
        };
        let permits = &room.cell().contact;
        let movers = room.movers(layout, start);
        survey.swept.begin(&movers);
        for contact in room.look(&movers, devices, 0.0) {
            let most = before.iter().map(|one| permits.during(contact.mover(), contact.obstacle(), *one));
            let most = most.fold(0.0, f64::max);
            if most > 0.0 {
                survey.allowed.insert(contact.pair(), contact.depth.max(most) + FIT);
            }
        }
        survey
    }

    pub fn take(&mut self) -> Seen {
        (self.leg, self.free) = (None, 0.0);
        std::mem::take(&mut self.seen)
    }

    /// True if the motion to the present point has a forbidden contact.
    #[must_use]
    pub const fn touches(&self) -> bool {
        self.seen.touched.is_some()
    }

    #[must_use]
    pub fn into_swept(self) -> Swept {
        self.swept
    }

    /// Opening of the fingers, in.
    pub fn open(&mut self, opening: f64) {
        if self.layout.opening != opening {
            (self.layout.opening, self.free) = (opening, 0.0);
        }
    }

    /// Skips the check if the robot has moved too little for a smaller clearance.
    pub fn look(&mut self, leg: usize, joints: &Joints) {
        let begins = self.leg != Some(leg);
        let moved: f64 = joints
            .iter()
            .zip(self.at)
            .zip(LEVERS)
            .map(|((now, then), lever)| (now - then).abs() * lever)
            .sum();
        if !begins && moved < self.free {
            return;
        }
        self.leg = Some(leg);
        let movers = self.room.movers(&self.layout, joints);
        if begins {
            self.swept.begin(&movers);
        } else {
            self.swept.add(&movers);
        }
        let contacts = self.room.look(&movers, self.devices, SIGHT);
        self.allowed.retain(|pair, _| contacts.iter().any(|one| one.depth > -FREE && one.pair() == *pair));
        let mut least = SIGHT;
        for contact in &contacts {
            if !self.permitted(contact) {
                least = least.min(-contact.depth);
                self.note(contact);
            }
        }
        let known = self.seen.nearest.as_ref().map_or(MARGIN, |nearest| nearest.clearance_in);
        (self.at, self.free) = (*joints, least - known.max(0.0));
    }

    /// Remains true while a permitted contact lasts.
    fn permitted(&mut self, contact: &Contact) -> bool {
        let permits = &self.room.cell().contact;
        let most = permits.during(contact.mover(), contact.obstacle(), self.commands);
        let fit = if contact.mover_kind == Kind::Finger { PUSH_FIT } else { FIT };
        if most > 0.0 && contact.depth <= most + fit {
            if contact.touches() {
                self.allowed.insert(contact.pair(), most + fit);
            }
            return true;
        }
        self.allowed.get(&contact.pair()).is_some_and(|depth| contact.depth <= *depth)
    }

    fn note(&mut self, contact: &Contact) {
        let nearer =
            |known: &Option<Passing>| known.as_ref().is_none_or(|known| -contact.depth < known.clearance_in);
        if -contact.depth < MARGIN && nearer(&self.seen.nearest) {
            self.seen.nearest = Some(Passing::from(contact));
        }
        // The position of a part in the fingers is known only within `FIT`.
        let sure = contact.mover_kind != Kind::HeldPart || contact.depth > FIT;
        if contact.touches() && sure && nearer(&self.seen.touched) {
            self.seen.touched = Some(Passing::from(contact));
        }
    }
}
