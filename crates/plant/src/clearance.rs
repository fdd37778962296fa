//! Collisions of the robot: each tick the outline of arm and gripper, and what the gripper carries, against everything that
//! stands in the cell.
//!
//! The arm is led on its path whatever it meets, as a hydraulic arm would be; so a collision must be seen, not felt. A
//! contact is reported once when it begins, with its depth.

use std::collections::BTreeSet;

use rapier3d_f64::{parry::query, prelude::*};
use serde::{Deserialize, Serialize};

use crate::{convert::inches, scene::Obstacle};

/// Contacts that are less deep are none: parts rest on things, m.
const LEAST_DEPTH: Real = 2.5e-5;

/// A finger that has been led this deep into what is there to run against presses with hundreds of pounds, m.
const PRESSED: Real = 2.5e-3;

/// A moving shape, metres.
pub struct Mover {
    /// Its name.
    pub name: String,
    /// Its place.
    pub pose: Pose,
    /// Its shape.
    pub shape: SharedShape,
    /// It is a part that is carried: it may touch what is there to work on.
    pub carried: bool,
    /// It is a finger: it may press on what is there to run against.
    pub finger: bool,
}

/// A contact that has begun.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Contact {
    /// What moves.
    pub mover: String,
    /// What it has met.
    pub obstacle: String,
    /// How deep, in.
    pub depth: f64,
}

/// Remembers which pairs are in contact.
#[derive(Debug, Default, Deserialize, Serialize)]
pub struct Clearance {
    touching: BTreeSet<(String, String)>,
}

impl Clearance {
    /// The contacts that have begun since the last check.
    pub fn check<'a>(
        &mut self,
        movers: &[Mover],
        obstacles: impl Iterator<Item = &'a Obstacle> + Clone,
    ) -> Vec<Contact> {
        let mut touching = BTreeSet::new();
        let mut begun = Vec::new();
        for mover in movers {
            let aabb = mover.shape.compute_aabb(&mover.pose);
            for obstacle in obstacles.clone().filter(|obstacle| {
                !(mover.carried && obstacle.work_surface) && obstacle.aabb.intersects(&aabb)
            }) {
                let allowed = if mover.finger && obstacle.strike { PRESSED } else { LEAST_DEPTH };
                let Some(depth) = depth(mover, obstacle).filter(|depth| *depth > allowed) else { continue };
                let pair = (mover.name.clone(), obstacle.name.clone());
                if !self.touching.contains(&pair) && !touching.contains(&pair) {
                    let (mover, obstacle) = pair.clone();
                    begun.push(Contact { mover, obstacle, depth: inches(depth) });
                }
                touching.insert(pair);
            }
        }
        self.touching = touching;
        begun
    }
}

fn depth(mover: &Mover, obstacle: &Obstacle) -> Option<Real> {
    let contact = query::contact(&obstacle.pose, &obstacle.shape, &mover.pose, &*mover.shape, 0.0).ok()??;
    Some(-contact.dist)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_is_reported_when_it_begins() {
        let shape = Cuboid::new(Vector::splat(0.1));
        let table = Obstacle {
            name: "table".into(),
            pose: Pose::IDENTITY,
            aabb: shape.aabb(&Pose::IDENTITY),
            shape,
            work_surface: false,
            strike: false,
        };
        let at = |z: Real| {
            vec![Mover {
                name: "hand".into(),
                pose: Pose::translation(0.0, 0.0, z),
                shape: SharedShape::ball(0.05),
                carried: false,
                finger: false,
            }]
        };
        let mut clearance = Clearance::default();
        let mut check = |z: Real| clearance.check(&at(z), [&table].into_iter());
        assert!(check(0.151).is_empty());
        let begun = check(0.148);
        assert_eq!(begun.len(), 1);
        assert!((begun[0].depth - 0.002 / 0.0254).abs() < 1e-6, "{begun:?}");
        assert!(check(0.147).is_empty(), "it goes on");
        assert!(check(0.2).is_empty());
        assert_eq!(check(0.14).len(), 1, "it begins again");
    }
}
