//! A finger of a gripper: a box attached to the hand by springs.

use rapier3d_f64::{
    parry::{bounding_volume::BoundingVolume, query},
    prelude::*,
};
use serde::{Deserialize, Serialize};

use crate::{
    convert::{KILOGRAMS_PER_POUND, metres, newtons},
    description::Gripper as Description,
    hold::Stiffness,
    scene::groups,
};

#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub struct Finger {
    /// +1 left (tool +Y), -1 right.
    pub side: Real,
    pub body: RigidBodyHandle,
    pub collider: ColliderHandle,
    pub joint: ImpulseJointHandle,
    /// Stiffness of its springs, N/m and N·m/rad.
    pub stiffness: Stiffness,
}

/// Rest pose of a finger's middle in the tool frame, metres; `side` is 1 for the left finger, -1 for the right one.
pub fn finger_rest(description: &Description, side: Real, opening: f64) -> Pose {
    let [length, thickness, _] = description.fingers;
    Pose::from_translation(Vector::new(
        -metres(length / 2.0),
        side * metres((opening + thickness) / 2.0),
        0.0,
    ))
}

pub struct Mount<'a> {
    pub hand: RigidBodyHandle,
    pub tool: &'a Pose, // m
    pub stiffness: f64, // stiffness of both fingers together at the tips, lb/in
    pub group: Group,
}

impl Finger {
    /// True if a body that it may touch is nearer than `distance`, m.
    pub fn is_near(&self, world: &PhysicsWorld, distance: Real) -> bool {
        world.narrow_phase.contact_pairs_with(self.collider).any(|pair| {
            let pair = [pair.collider1, pair.collider2].map(|collider| world.colliders.get(collider));
            let [Some(one), Some(other)] = pair else { return false };
            one.collision_groups().test(other.collision_groups())
                && one.compute_aabb().loosened(distance).intersects(&other.compute_aabb())
                && query::distance(one.position(), one.shape(), other.position(), other.shape())
                    .is_ok_and(|between| between.distance < distance)
        })
    }

    /// Build the left finger (`side` 1) or the right one (-1) at an opening in inches.
    pub fn new(
        world: &mut PhysicsWorld,
        description: &Description,
        mount: &Mount<'_>,
        side: Real,
        opening: f64,
    ) -> Self {
        let &Mount { hand, tool, stiffness, group } = mount;
        let rest = finger_rest(description, side, opening);
        let mass = description.finger_weight * KILOGRAMS_PER_POUND;
        let [x, y, z] = description.fingers.map(|size| metres(size / 2.0));
        // The arm's calibration includes the weight of the fingers: springs at rest do not carry it.
        let body = world
            .insert_body(RigidBodyBuilder::dynamic().pose(*tool * rest).gravity_scale(0.0).can_sleep(false));
        let collider = ColliderBuilder::cuboid(x, y, z)
            .mass(mass)
            .friction(description.friction)
            // Fixed bodies must also be detected as near while the fingers are kinematic.
            .active_collision_types(ActiveCollisionTypes::all())
            .collision_groups(groups(group, Group::ALL & !group));
        let collider = world.insert_collider(collider, Some(body));
        let linear = newtons(stiffness) / metres(1.0) / 2.0;
        // The angular springs about the middle add only a hundredth to the deflection of the tip.
        let angular = 100.0 * linear * x * x;
        let inertia = mass / 3.0 * (x * x + z * z);
        let mut data = GenericJointBuilder::new(JointAxesMask::empty())
            .local_frame1(rest)
            .contacts_enabled(false)
            .build();
        for axis in [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ] {
            let damping = 2.0 * libm::sqrt(linear * mass);
            data.set_motor_model(axis, MotorModel::ForceBased).set_motor(axis, 0.0, 0.0, linear, damping);
        }
        for axis in [JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ] {
            let damping = 2.0 * libm::sqrt(angular * inertia);
            data.set_motor_model(axis, MotorModel::ForceBased).set_motor(axis, 0.0, 0.0, angular, damping);
        }
        let joint = world.insert_impulse_joint(hand, body, data);
        Self { side, body, collider, joint, stiffness: Stiffness { linear, angular } }
    }
}
