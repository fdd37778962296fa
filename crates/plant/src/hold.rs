//! A hold: a part between two pads, as strong as the pads' force and friction allow, and no stronger.
//!
//! Contacts between a squeezed light part and two heavy pads creep, and a rigid weld never lets go. A hold is between the
//! two: six springs with limits between the pads' body and the part, placed where the pads touch. Below its limit a spring
//! holds the part to a few micrometres. Beyond it, two things happen:
//!
//! * along the pads (X, Z, and the turn about Y) the limit is friction. The spring's rest position moves after the part: it
//!   slides against exactly the limiting force, and stays where it has slid to;
//! * across the pads (Y, and the tilts about X and Z) the limit is the pads' force. The part is pushed aside against it, and
//!   the pads bring it back to their middle, flush, as soon as they are the stronger.

use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::*;

use crate::{convert::on_the_side_of, squeeze::Squeeze};

/// The six axes in the order of limits: X, Y, Z, about X, about Y, about Z. Y is across the pads.
const AXES: [JointAxis; 6] =
    [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ, JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];

/// How stiff a hold is below its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// N/m.
    pub linear: Real,
    /// N·m/rad.
    pub angular: Real,
}

/// Force and friction of the pads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamp {
    /// Force of each pad, N.
    pub force: Real,
    /// Coefficient of friction.
    pub friction: Real,
}

/// What is held: it sets the damping of the springs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// kg.
    pub mass: Real,
    /// Greatest principal moment of inertia, kg·m².
    pub inertia: Real,
}

/// A part between two pads.
#[derive(Debug)]
pub struct Hold {
    joint: ImpulseJointHandle,
    pads: RigidBodyHandle,
    part: RigidBodyHandle,
    rest: Pose,
    anchor: Pose,
    stiffness: Stiffness,
    limits: [Real; 6],
    slipped: Real,
}

impl Hold {
    /// Take hold of a part: `flush` is where the part shall lie in the axes of the pads' body, `squeeze` what is touched.
    pub fn new(
        world: &mut PhysicsWorld,
        pads: RigidBodyHandle,
        part: RigidBodyHandle,
        flush: &Pose,
        squeeze: &Squeeze,
        stiffness: Stiffness,
        load: Load,
    ) -> Self {
        let point = Vector::new(squeeze.point.x, flush.translation.y, squeeze.point.z);
        let rest = Pose::from_translation(point);
        let anchor = flush.inv_mul(&rest);
        let inertia = load.inertia + load.mass * anchor.translation.length_squared();
        let linear_damping = 2.0 * libm::sqrt(stiffness.linear * load.mass);
        let angular_damping = 2.0 * libm::sqrt(stiffness.angular * inertia);
        let mut data =
            GenericJointBuilder::new(JointAxesMask::empty()).local_frame1(rest).local_frame2(anchor).build();
        for (index, axis) in AXES.into_iter().enumerate() {
            let (k, c) = if index < 3 {
                (stiffness.linear, linear_damping)
            } else {
                (stiffness.angular, angular_damping)
            };
            data.set_motor_model(axis, MotorModel::ForceBased).set_motor(axis, 0.0, 0.0, k, c);
            data.set_motor_max_force(axis, 0.0);
        }
        let joint = world.insert_impulse_joint(pads, part, data);
        Self { joint, pads, part, rest, anchor, stiffness, limits: [0.0; 6], slipped: 0.0 }
    }

    /// The body of the held part.
    #[must_use]
    pub fn part(&self) -> RigidBodyHandle {
        self.part
    }

    /// How far the part has slid in this hold, m.
    #[must_use]
    pub fn slipped(&self) -> Real {
        self.slipped
    }

    /// Set the limits from force, friction and the touched area.
    pub fn set_clamp(&mut self, world: &mut PhysicsWorld, clamp: Clamp, squeeze: &Squeeze) {
        let normal = 2.0 * clamp.force;
        let friction = normal * clamp.friction;
        let [span_x, span_z] = squeeze.span;
        self.limits = [
            friction,
            normal,
            friction,
            normal * span_z / 2.0,
            friction * squeeze.friction_arm(),
            normal * span_x / 2.0,
        ];
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            for (axis, limit) in AXES.into_iter().zip(self.limits) {
                joint.data.set_motor_max_force(axis, limit);
            }
        }
    }

    /// Where the part is, seen from the springs' rest position.
    fn error(&self, world: &PhysicsWorld) -> Pose {
        let pads = world.bodies[self.pads].position();
        let part = world.bodies[self.part].position();
        let error = self.rest.inv_mul(&(pads.inv_mul(part) * self.anchor));
        Pose::from_parts(error.translation, on_the_side_of(&Rotation::IDENTITY, error.rotation))
    }

    /// After a step: let the rest position follow where friction is overcome. Returns how far, m.
    pub fn give_way(&mut self, world: &mut PhysicsWorld) -> Real {
        let error = self.error(world);
        let beyond = |value: Real, limit: Real, stiffness: Real| {
            let elastic = limit / stiffness;
            value - value.clamp(-elastic, elastic)
        };
        // Friction has one limit whatever the direction in the plane.
        let plane = libm::hypot(error.translation.x, error.translation.z);
        let over = beyond(plane, self.limits[0], self.stiffness.linear);
        let share = if plane > 0.0 { over / plane } else { 0.0 };
        let slide = Vector::new(error.translation.x * share, 0.0, error.translation.z * share);
        let turn = beyond(error.rotation.to_scaled_axis().y, self.limits[4], self.stiffness.angular);
        let moved = slide.length();
        if moved > 0.0 || turn != 0.0 {
            self.set_rest(world, self.rest * Pose::new(slide, Vector::Y * turn));
            self.slipped += moved;
        }
        moved
    }

    /// Let all springs rest where the part is now: another, stronger grip has it.
    pub fn relax(&mut self, world: &mut PhysicsWorld) {
        let error = self.error(world);
        self.set_rest(world, self.rest * error);
    }

    /// The stronger grip is gone: draw the part back to the middle of the pads, flush; along the pads it stays.
    pub fn recover(&mut self, world: &mut PhysicsWorld) {
        let mut rest = self.rest;
        rest.translation.y = 0.0;
        let twist = Rotation::from_xyzw(0.0, rest.rotation.y, 0.0, rest.rotation.w);
        rest.rotation = if twist.length_squared() > 0.0 { twist } else { Rotation::IDENTITY };
        self.set_rest(world, rest);
    }

    fn set_rest(&mut self, world: &mut PhysicsWorld, rest: Pose) {
        // Rests are products of many rotations: without this their length would run away.
        let rest = Pose::from_parts(rest.translation, rest.rotation.normalize());
        self.rest = rest;
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            joint.data.set_local_frame1(rest);
        }
    }

    /// Let go.
    pub fn release(self, world: &mut PhysicsWorld) {
        world.remove_impulse_joint(self.joint);
    }
}
