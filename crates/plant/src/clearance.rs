//! Collision check of the robot: each tick, arm, gripper and held part against all other bodies and the arm itself.
//!
//! The simulated arm follows its path even through contact, so collisions come from geometry. Of the pairs that are not
//! always permitted ([`crate::description::Permits`]), the check keeps those that touch or are near. The caller knows
//! the present command, and decides which are permitted.

use std::{borrow::Cow, collections::BTreeSet};

use geometry::frame::Vector as Inches;
use rapier3d_f64::{parry::query, prelude::*};
use serde::{Deserialize, Serialize};

use crate::{
    convert::{inches, metres, to_inches},
    description::{Kind, Permits},
};

/// Least depth of a contact, in: resting parts penetrate less.
pub const LEAST_DEPTH: f64 = 0.001;

const OVERLAP: Real = 1e-4; // least overlap of a new part with a body that blocks it, m
const SAME_PLACE: Real = 1e-3; // bodies whose centres are nearer than this to each other overlap, m

#[derive(Clone, Debug)]
pub struct Body {
    pub name: Cow<'static, str>,
    pub kind: Kind,
    pub pose: Pose,
    pub shape: SharedShape,
    pub aabb: Aabb,
    /// Its position in the chain of the arm, from 1 at the base; 0 for other bodies. Adjacent links do not collide.
    pub chain: u8,
}

impl Body {
    pub fn new(name: impl Into<Cow<'static, str>>, kind: Kind, pose: Pose, shape: SharedShape) -> Self {
        Self { name: name.into(), kind, aabb: shape.compute_aabb(&pose), pose, shape, chain: 0 }
    }

    #[must_use]
    pub fn at(self, chain: u8) -> Self {
        Self { chain, ..self }
    }

    fn id(&self) -> (&str, Kind) {
        (&self.name, self.kind)
    }

    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        self.id() == other.id() && self.pose == other.pose && self.aabb == other.aabb
    }

    /// True if they overlap, so that one cannot be put where the other is.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        // Round shapes inside each other have neither a separating direction nor a depth.
        let same = (self.pose.translation - other.pose.translation).length() < SAME_PLACE;
        let contact = query::contact(&self.pose, &*self.shape, &other.pose, &*other.shape, 0.0);
        same || matches!(contact, Ok(Some(contact)) if contact.dist < -OVERLAP)
    }

    /// True if they are neighbours in the chain of the arm, or the same link.
    #[must_use]
    pub fn is_joined_to(&self, other: &Self) -> bool {
        self.chain != 0 && other.chain != 0 && self.chain.abs_diff(other.chain) <= 1
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Contact {
    pub mover: String,
    pub mover_kind: Kind,
    pub obstacle: String,
    pub obstacle_kind: Kind,
    /// Penetration depth, in; a negative value is a distance.
    pub depth: f64,
    pub at: [f64; 3], // world, in
    /// Unit vector, world: direction from the obstacle to the mover.
    pub away: [f64; 3],
}

impl Contact {
    #[must_use]
    pub fn touches(&self) -> bool {
        self.depth > LEAST_DEPTH
    }

    #[must_use]
    pub fn mover(&self) -> (&str, Kind) {
        (&self.mover, self.mover_kind)
    }

    #[must_use]
    pub fn obstacle(&self) -> (&str, Kind) {
        (&self.obstacle, self.obstacle_kind)
    }

    /// Names of the two bodies; all pieces of a body have the same name.
    #[must_use]
    pub fn pair(&self) -> (String, String) {
        (self.mover.clone(), self.obstacle.clone())
    }

    fn is_of(&self, mover: &Body, obstacle: &Body) -> bool {
        self.mover() == mover.id() && self.obstacle() == obstacle.id()
    }
}

#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Clearance {
    margin: Real, // distance within which pairs are reported, m
    contacts: Vec<Contact>,
    touching: BTreeSet<(String, String)>,
}

impl Clearance {
    /// Report pairs nearer than `margin` inches; by default only contacts are reported.
    pub fn watch(&mut self, margin: f64) {
        self.margin = metres(margin.max(0.0));
    }

    /// Contacts and near pairs of the last check, each pair of names once, at its deepest point.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    #[must_use]
    pub fn into_contacts(self) -> Vec<Contact> {
        self.contacts
    }

    /// Check all pairs. Returns the contacts that have just become deeper than any command permits.
    pub fn check<'a>(
        &mut self,
        permits: &Permits,
        movers: &[Body],
        obstacles: impl Iterator<Item = &'a Body> + Clone,
    ) -> Vec<Contact> {
        self.contacts.clear();
        for mover in movers {
            let around = mover.aabb.loosened(self.margin);
            let near = obstacles.clone().filter(|obstacle| obstacle.aabb.intersects(&around));
            for obstacle in near {
                if !mover.is_joined_to(obstacle) && !permits.ignores(mover.kind, obstacle.kind) {
                    self.look(mover, obstacle);
                }
            }
        }
        let always = |contact: &Contact| permits.always(contact.mover(), contact.obstacle());
        self.contacts.retain(|contact| always(contact) < f64::INFINITY);
        let most = |contact: &Contact| permits.at_most(contact.mover(), contact.obstacle());
        let deep = self.contacts.iter().filter(|one| one.touches() && one.depth > most(one));
        let begun = deep.clone().filter(|one| !self.touching.contains(&one.pair())).cloned().collect();
        self.touching = deep.map(Contact::pair).collect();
        begun
    }

    fn look(&mut self, mover: &Body, obstacle: &Body) {
        let met = query::contact(&obstacle.pose, &*obstacle.shape, &mover.pose, &*mover.shape, self.margin);
        let Ok(Some(met)) = met else { return };
        let depth = inches(-met.dist);
        if depth <= LEAST_DEPTH && self.margin == 0.0 {
            return;
        }
        let known = self.contacts.iter().position(|one| one.is_of(mover, obstacle));
        if known.is_some_and(|known| self.contacts[known].depth >= depth) {
            return;
        }
        let at = to_inches(met.point2);
        let contact = Contact {
            mover: mover.name.to_string(),
            mover_kind: mover.kind,
            obstacle: obstacle.name.to_string(),
            obstacle_kind: obstacle.kind,
            depth,
            at: Inches::into(at),
            away: met.normal1.to_array(),
        };
        match known {
            Some(known) => self.contacts[known] = contact,
            None => self.contacts.push(contact),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{Pattern, Permit};

    fn table() -> Body {
        Body::new("table", Kind::Fixture, Pose::IDENTITY, SharedShape::cuboid(0.1, 0.1, 0.1))
    }

    fn hand(z: Real) -> Vec<Body> {
        let pose = Pose::translation(0.0, 0.0, z);
        vec![Body::new("hand", Kind::Gripper, pose, SharedShape::ball(0.05))]
    }

    fn permit(depth: Option<f64>) -> Permits {
        let pattern = |text: &str| vec![Pattern(text.into())];
        let during = Vec::new();
        Permits(vec![Permit {
            mover: pattern("gripper"),
            obstacle: pattern("table"),
            during,
            depth,
            why: String::new(),
        }])
    }

    #[test]
    fn contact_is_reported_when_it_begins() {
        let (mut clearance, table) = (Clearance::default(), table());
        let mut check = |z: Real| clearance.check(&Permits::default(), &hand(z), [&table].into_iter());
        assert!(check(0.151).is_empty());
        let begun = check(0.148);
        assert_eq!(begun.len(), 1);
        assert!((begun[0].depth - 0.002 / 0.0254).abs() < 1e-6, "{begun:?}");
        assert!((begun[0].away[2] - 1.0).abs() < 1e-6, "up it is free: {begun:?}");
        assert!(check(0.147).is_empty(), "it continues");
        assert!(check(0.2).is_empty());
        assert_eq!(check(0.14).len(), 1, "it begins again");
    }

    #[test]
    fn near_pairs_are_listed_with_their_distance() {
        let (mut clearance, table) = (Clearance::default(), table());
        let near = |clearance: &mut Clearance, z: Real| {
            assert!(clearance.check(&Permits::default(), &hand(z), [&table].into_iter()).is_empty());
            clearance.contacts().iter().map(|one| one.depth).collect::<Vec<_>>()
        };
        let gap = 0.15 + metres(0.5);
        assert_eq!(near(&mut clearance, gap), [], "it is not watched");
        clearance.watch(1.0);
        let listed = near(&mut clearance, gap);
        assert!(listed.len() == 1 && (listed[0] + 0.5).abs() < 1e-6, "{listed:?}");
        clearance.watch(0.4);
        assert_eq!(near(&mut clearance, gap), []);
    }

    #[test]
    fn permitted_contacts_are_reported_where_too_deep() {
        let (mut clearance, table) = (Clearance::default(), table());
        let some = permit(Some(0.1));
        assert!(clearance.check(&some, &hand(0.15 - metres(0.09)), [&table].into_iter()).is_empty());
        assert_eq!(clearance.contacts().len(), 1, "but it is there for the caller that moves the arm");
        assert_eq!(clearance.check(&some, &hand(0.15 - metres(0.11)), [&table].into_iter()).len(), 1);
        assert!(clearance.check(&permit(None), &hand(0.1), [&table].into_iter()).is_empty());
        assert!(clearance.contacts().is_empty());
    }

    #[test]
    fn deepest_piece_of_a_body_is_reported() {
        let low = Body { pose: Pose::translation(0.0, 0.0, -0.001), ..table() };
        let mut clearance = Clearance::default();
        let begun = clearance.check(&Permits::default(), &hand(0.14), [&low, &table(), &low].into_iter());
        assert!(begun.len() == 1 && (begun[0].depth - inches(0.01)).abs() < 1e-6, "{begun:?}");
    }

    #[test]
    fn adjacent_links_do_not_collide() {
        let link = |chain| Body { chain, kind: Kind::Arm, ..table() };
        let mut clearance = Clearance::default();
        let mut met = |mover: u8, obstacle: u8| {
            let movers = [Body { chain: mover, ..hand(0.1).remove(0) }];
            clearance.check(&Permits::default(), &movers, [&link(obstacle)].into_iter());
            clearance.contacts().len()
        };
        assert_eq!([met(3, 2), met(3, 3), met(3, 4), met(3, 1), met(0, 3)], [0, 0, 0, 1, 1]);
    }
}
