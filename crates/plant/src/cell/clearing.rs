//! What the clearance check looks at: everything of the robot that moves, and everything that it can run into
//! ([`crate::bodies`]).
//!
//! A part that the robot has stands where it is, not where the fingers want it: it gives way by itself, in the fingers.

use super::{
    Cell, CellEvent,
    changing::{GripperPlace, ROBOT_HANDS},
};
use crate::{
    bodies,
    clearance::{Body, Contact},
    convert::to_frame,
};

impl Cell {
    /// Once a tick: see what has been run into.
    pub(super) fn check_clearance(&mut self) {
        let mut obstacles = self.devices();
        obstacles.extend(self.part_bodies());
        obstacles.extend(self.arm_bodies());
        let all = self.obstacles.iter().chain(&obstacles);
        let movers = self.movers();
        let begun = self.clearance.check(&self.description.contact, &movers, all);
        self.events.extend(begun.into_iter().map(CellEvent::Contact));
    }

    /// The robot and what it carries.
    pub(super) fn movers(&self) -> Vec<Body> {
        let mut movers = Vec::from(self.arm_bodies());
        movers.extend(self.worn_bodies());
        movers.extend(self.held_body());
        movers
    }

    /// What moves or is moved, but for arm and parts: jaw, grippers in their holsters, the pedestal's hand.
    pub(super) fn devices(&self) -> Vec<Body> {
        let mut devices = self.jaw_bodies();
        devices.extend(self.stored_gripper_bodies());
        devices.extend(self.pedestal_bodies());
        devices
    }

    /// What of the robot touches what at the end of the last tick, and what is nearer to it than
    /// [`Cell::watch_clearance`] asks for: each pair of names once, where it is deepest, but for pairs that
    /// may always touch. The truth: a T3 has no sensor for it.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        self.clearance.contacts()
    }

    /// From now on [`Cell::contacts`] has what is nearer than `margin` inches too.
    pub fn watch_clearance(&mut self, margin: f64) {
        self.clearance.watch(margin);
    }

    /// Upper arm, forearm and wrist.
    pub(super) fn arm_bodies(&self) -> [Body; 3] {
        bodies::arm(&self.description, &self.joints())
    }

    /// A plate, camera, and the gripper that the robot wears.
    fn worn_bodies(&self) -> Vec<Body> {
        let tool = self.t3.arm().tool();
        let mut worn = Vec::from(bodies::quick_change(&self.description, &tool));
        if let Some(hand) = self.changer.carried() {
            let opening = self.hand(hand).air.opening();
            worn.extend(bodies::worn(&self.description, self.gripper_description(hand), &tool, opening));
        }
        worn
    }

    /// The part that the robot has.
    fn held_body(&self) -> Option<Body> {
        let (index, _) = self.hand(self.changer.carried()?).hold.as_ref()?;
        let part = &self.parts[*index];
        Some(bodies::held(&part.kind, &part.pose(&self.world)))
    }

    /// The parts that the robot does not have.
    fn part_bodies(&self) -> impl Iterator<Item = Body> {
        let others = (0..self.parts.len()).filter(|index| !self.is_held(*index));
        others.map(|index| bodies::part(&self.parts[index].kind, &self.parts[index].pose(&self.world)))
    }

    /// The movable jaw where it is now.
    pub(super) fn jaw_bodies(&self) -> Vec<Body> {
        let jaw = to_frame(self.world.bodies[self.vise.jaw()].position());
        bodies::movable_jaw(&self.description, &jaw)
    }

    /// The grippers that the robot does not wear and is not mated with, wherever they are.
    fn stored_gripper_bodies(&self) -> impl Iterator<Item = Body> {
        let apart = ROBOT_HANDS.into_iter().filter(|hand| {
            self.changer.mated() != Some(*hand) && self.changer.place(*hand) != Some(GripperPlace::Robot)
        });
        apart.flat_map(|hand| {
            let at = self.world.bodies[self.hand(hand).hand()].position();
            bodies::stored(&self.description, self.gripper_description(hand), hand.link(), at)
        })
    }

    /// Palm and fingers of the pedestal's hand.
    fn pedestal_bodies(&self) -> [Body; 3] {
        bodies::pedestal(&self.description, &self.pedestal.frame(), self.pedestal.hand.air.opening())
    }
}
