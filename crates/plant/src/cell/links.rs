//! The poses of the links of [`Scene`] in a cell, each relative to its parent, as in the URDF.

use rapier3d_f64::prelude::*;

use super::Cell;
use crate::{
    convert::{metres, to_pose},
    gripper::body_opening,
    hand::Hand,
    linkage::{AXES, STARTS},
    scene::{Finger, Moving, ROOT, Scene, tool_on_end_plate},
};

#[derive(Clone, Debug, PartialEq)]
pub struct LinkPose {
    pub name: String,
    /// The link in whose frame the pose is given; `world` for the world.
    pub parent: &'static str,
    /// x, y, z in metres.
    pub position: [f64; 3],
    pub rotation: [f64; 4],
}

impl LinkPose {
    fn new(name: &str, parent: &'static str, pose: &Pose) -> Self {
        let (position, rotation) = (pose.translation.to_array(), pose.rotation.to_array());
        Self { name: name.into(), parent, position, rotation }
    }
}

impl Cell {
    /// The cell with its present and later parts, given by their names in that order, so that a log has the geometry
    /// before its first tick. Unknown names are omitted.
    #[must_use]
    pub fn scene(&self, coming: &[&str]) -> Scene<'_> {
        let present = self.parts.iter().map(|part| (part.id, &part.kind));
        let coming = coming.iter().filter_map(|name| self.description.part(name));
        Scene::new(&self.description, present.chain((self.next_part..).zip(coming)))
    }

    /// Names and poses of all moving bodies; a parent is before its children.
    #[must_use]
    pub fn links(&self) -> Vec<LinkPose> {
        let moving = Moving::all();
        let mut links: Vec<LinkPose> = moving
            .map(|moving| LinkPose::new(moving.name(), moving.parent(), &self.moving_pose(moving)))
            .collect();
        let parts = self.parts.iter();
        links.extend(parts.map(|part| LinkPose::new(&part_link(part.id), ROOT, &part.pose(&self.world))));
        links
    }

    /// Names and poses of the fixed links, which [`Cell::links`] does not return.
    #[must_use]
    pub fn fixed_links(&self) -> Vec<LinkPose> {
        let standing = self.furniture.iter().filter(|block| !block.is_of_vise());
        standing.map(|block| LinkPose::new(&block.name, ROOT, &to_pose(&block.frame))).collect()
    }

    /// Names and values of all revolute and prismatic joints: radians, or metres. The pedestal's table is at 0 where
    /// the fingers move across the radial line.
    #[must_use]
    pub fn joint_states(&self) -> Vec<(&'static str, f64)> {
        let value = |moving| match moving {
            Moving::Arm(joint) => Some(self.joints()[joint]),
            Moving::Finger(hand, _) => Some(metres(body_opening(&self.world, self.hand(hand)) / 2.0)),
            Moving::Hand(Hand::Pedestal) => {
                Some((self.pedestal.table.angle() - self.description.pedestal.table.square).to_radians())
            }
            Moving::Jaw => Some(metres(self.vise.gap())),
            Moving::Hand(_) | Moving::QuickChange | Moving::Vise => None,
        };
        Moving::all().filter_map(|moving| moving.joint().zip(value(moving))).collect()
    }

    fn moving_pose(&self, moving: Moving) -> Pose {
        let of = |body: RigidBodyHandle| *self.world.bodies[body].position();
        match moving {
            Moving::Arm(joint) => {
                let turn = Vector::from_array(AXES[joint]) * self.joints()[joint];
                Pose::new(Vector::X * metres(STARTS[joint]), turn)
            }
            Moving::QuickChange => to_pose(&tool_on_end_plate()),
            Moving::Hand(hand) => of(self.hand(hand).hand()),
            Moving::Finger(hand, finger) => {
                let hand = self.hand(hand);
                let [left, right] = hand.finger_bodies();
                of(hand.hand()).inv_mul(&of(match finger {
                    Finger::Left => left,
                    Finger::Right => right,
                }))
            }
            Moving::Vise => to_pose(self.vise.frame()),
            Moving::Jaw => to_pose(self.vise.frame()).inv_mul(&of(self.vise.jaw())),
        }
    }
}

#[must_use]
pub fn part_link(id: u32) -> String {
    format!("part_{id}")
}
