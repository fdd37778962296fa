//! Bodies of the clearance check ([`crate::bodies`]). A held part is checked at its true position.

use super::{Cell, CellEvent};
use crate::{
    bodies,
    changer::GripperPlace,
    clearance::{Body, Contact},
    convert::to_frame,
    hand::ROBOT_HANDS,
};

impl Cell {
    pub(super) fn check_clearance(&mut self) {
        let mut obstacles = self.devices();
        obstacles.extend(self.part_bodies());
        obstacles.extend(self.arm_bodies());
        let all = self.obstacles.iter().chain(&obstacles);
        let movers = self.movers();
        let begun = self.clearance.check(&self.description.contact, &movers, all);
        self.events.extend(begun.into_iter().map(CellEvent::Contact));
    }

    pub(super) fn movers(&self) -> Vec<Body> {
        let mut movers = Vec::from(self.arm_bodies());
        movers.extend(self.worn_bodies());
        movers.extend(self.held_body());
        movers
    }

    /// Movable bodies except arm and parts: jaw, grippers in their holsters, the pedestal's hand.
    pub(super) fn devices(&self) -> Vec<Body> {
        let mut devices = self.jaw_bodies();
        devices.extend(self.stored_gripper_bodies());
        devices.extend(self.pedestal_bodies());
        devices
    }

    /// Contacts of the robot at the end of the last tick, and pairs nearer than the margin of
    /// [`Cell::watch_clearance`]: each pair of names once, at its deepest point. The controller does not receive them.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        self.clearance.contacts()
    }

    /// Report in [`Cell::contacts`] also pairs nearer than `margin` inches from now on.
    pub fn watch_clearance(&mut self, margin: f64) {
        self.clearance.watch(margin);
    }

    pub(super) fn arm_bodies(&self) -> [Body; 3] {
        bodies::arm(&self.description, &self.joints())
    }

    fn worn_bodies(&self) -> Vec<Body> {
        let tool = self.t3.arm().tool();
        let mut worn = Vec::from(bodies::quick_change(&self.description, &tool));
        if let Some(hand) = self.changer.carried() {
            let opening = self.hand(hand).air.opening();
            worn.extend(bodies::worn(&self.description, hand.description(&self.description), &tool, opening));
        }
        worn
    }

    fn held_body(&self) -> Option<Body> {
        let (index, _) = self.hand(self.changer.carried()?).hold.as_ref()?;
        let part = &self.parts[*index];
        Some(bodies::held(&part.kind, &part.pose(&self.world)))
    }

    fn part_bodies(&self) -> impl Iterator<Item = Body> {
        let others = (0..self.parts.len()).filter(|index| !self.is_held(*index));
        others.map(|index| bodies::part(&self.parts[index].kind, &self.parts[index].pose(&self.world)))
    }

    pub(super) fn jaw_bodies(&self) -> Vec<Body> {
        let jaw = to_frame(self.world.bodies[self.vise.jaw()].position());
        bodies::movable_jaw(&self.description, &jaw)
    }

    fn stored_gripper_bodies(&self) -> impl Iterator<Item = Body> {
        let apart = ROBOT_HANDS.into_iter().filter(|hand| {
            self.changer.mated() != Some(*hand) && self.changer.place(*hand) != Some(GripperPlace::Robot)
        });
        apart.flat_map(|hand| {
            let at = self.world.bodies[self.hand(hand).hand()].position();
            bodies::stored(&self.description, hand.description(&self.description), hand.link(), at)
        })
    }

    fn pedestal_bodies(&self) -> [Body; 3] {
        bodies::pedestal(&self.description, &self.pedestal.frame(), self.pedestal.hand.air.opening())
    }
}
