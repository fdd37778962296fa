//! A hold: a part between two pads, limited by the pads' force and friction.
//!
//! Simulated contacts between a squeezed light part and two heavy pads creep, and a rigid joint never slides. A
//! hold combines both: springs with force limits between the pads' body and the part.
//!
//! * Along the pads (X, Z, about Y) the limit is friction: an ellipse of force and moment. Below it the part *sticks*
//!   to its springs; beyond it the part *slides* without springs until it is at rest.
//! * Across the pads (Y, about X and Z) the limit is the pads' force. A greater force pushes the part aside until the
//!   pads are stronger again.
//!
//! The springs act at the middle of the part, where the six axes are decoupled and the solver is exact without
//! iteration. The limits apply where the pads touch.

use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    convert::on_the_side_of,
    friction::{Motion, TouchedBody},
    squeeze::Squeeze,
};

/// The six axes: along X, Y, Z, about X, about Y, about Z. Y is across the pads.
const AXES: [JointAxis; 6] =
    [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ, JointAxis::AngX, JointAxis::AngY, JointAxis::AngZ];

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Stiffness {
    pub linear: Real,
    pub angular: Real,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Clamp {
    pub force: Real,
    pub friction: Real,
}

/// Mass and inertia of the held part, for the damping of the springs.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Load {
    pub mass: Real,    // kg
    pub inertia: Real, // greatest principal moment of inertia, kg·m²
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
struct Limits {
    friction: Real,
    normal: Real,
    moments: [Real; 3], // about X, Y, Z, N·m
    point: Vector,      // the middle of the touched area, in the axes of the pads' body
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Hold {
    joint: ImpulseJointHandle,
    pads: RigidBodyHandle,
    part: RigidBodyHandle,
    /// Position of the part without load, changed by slides: its middle, and its rotation from flush.
    nominal: Pose,
    rest: Pose,         // rest pose of the springs: the nominal pose, pushed aside
    attitude: Rotation, // rotation from the part's axes to those in which it lies flush
    stiffness: Stiffness,
    damping: [Real; 2], // damping of the springs along and about the axes, N·s/m and N·m·s/rad
    load: Load,
    limits: Limits,
    grip: Grip,
    slipped: Real,
    /// Force of friction on the sliding part in the last step, N, in the axes of the pads' body.
    rubbed: Vector,
}

/// The part sticks if friction holds it along the pads; otherwise it slides.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
enum Grip {
    Sticks,
    Slides,
}

impl Hold {
    /// Grip a part: `flush` is its flush position in the axes of the pads' body.
    pub fn new(
        world: &mut PhysicsWorld,
        pads: RigidBodyHandle,
        part: RigidBodyHandle,
        flush: &Pose,
        stiffness: Stiffness,
        load: Load,
    ) -> Self {
        let nominal = Pose::from_translation(flush.translation);
        let attitude = flush.rotation.inverse();
        let damping = [
            2.0 * libm::sqrt(stiffness.linear * load.mass),
            2.0 * libm::sqrt(stiffness.angular * load.inertia),
        ];
        let mut data = GenericJointBuilder::new(JointAxesMask::empty())
            .local_frame1(nominal)
            .local_frame2(Pose::from_rotation(attitude))
            .build();
        set_springs(&mut data, stiffness, damping, Grip::Sticks);
        for axis in AXES {
            data.set_motor_model(axis, MotorModel::ForceBased).set_motor_max_force(axis, 0.0);
        }
        let joint = world.insert_impulse_joint(pads, part, data);
        let limits = Limits::default();
        Self {
            joint,
            pads,
            part,
            nominal,
            rest: nominal,
            attitude,
            stiffness,
            damping,
            limits,
            load,
            grip: Grip::Sticks,
            slipped: 0.0,
            rubbed: Vector::ZERO,
        }
    }

    /// Distance that the part has slid in this hold, m.
    #[must_use]
    pub fn slipped(&self) -> Real {
        self.slipped
    }

    /// True if friction holds the part along the pads.
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.grip == Grip::Sticks
    }

    /// Load of the part on the pads' body with its weight: its middle (m), force (N), moment (N·m); axes of the pads'
    /// body.
    #[must_use]
    pub fn carries(&self, world: &PhysicsWorld) -> (Vector, Vector, Vector) {
        let present = self.present(world);
        let turn = on_the_side_of(&Rotation::IDENTITY, present.rotation * self.rest.rotation.inverse());
        let mut force = (present.translation - self.rest.translation) * self.stiffness.linear;
        let mut moment = turn.to_scaled_axis() * self.stiffness.angular;
        if self.grip == Grip::Slides {
            (force.x, force.z, moment.y) = (-self.rubbed.x, -self.rubbed.z, 0.0);
        }
        (present.translation, force, moment)
    }

    pub fn set_clamp(&mut self, world: &mut PhysicsWorld, clamp: Clamp, squeeze: &Squeeze) {
        let normal = 2.0 * clamp.force;
        let friction = normal * clamp.friction;
        let [span_x, span_z] = squeeze.span;
        let moments = [normal * span_z / 2.0, friction * squeeze.friction_arm(), normal * span_x / 2.0];
        let limits = Limits { friction, normal, moments, point: squeeze.point };
        if limits == self.limits {
            return;
        }
        self.limits = limits;
        // The springs must not exceed the limits of the pads within a step either. A force at the middle of the
        // part adds its moment about the pads.
        let arm = (self.nominal.translation - squeeze.point).length();
        let [about_x, about_y, about_z] = moments;
        let greatest = [
            friction,
            normal,
            friction,
            about_x + normal * arm,
            about_y + friction * arm,
            about_z + normal * arm,
        ];
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            for (axis, limit) in AXES.into_iter().zip(greatest) {
                joint.data.set_motor_max_force(axis, limit);
            }
        }
    }

    fn present(&self, world: &PhysicsWorld) -> Pose {
        let pads = world.bodies[self.pads].position();
        let part = pads.inv_mul(world.bodies[self.part].position());
        Pose::from_parts(part.translation, part.rotation * self.attitude)
    }

    /// Before a step of `dt` seconds: apply friction to a part that slides.
    pub fn rub(&mut self, world: &mut PhysicsWorld, dt: Real) {
        if self.grip == Grip::Sticks {
            return;
        }
        let pads = &world.bodies[self.pads];
        let axes = pads.position().rotation;
        let local = |v: Vector| axes.inverse() * v;
        let part = &world.bodies[self.part];
        let middle = part.center_of_mass();
        let relative = local(part.linvel() + world.gravity * dt - pads.velocity_at_point(middle));
        let turn = local(part.angvel() - pads.angvel()).y;
        let offset = *pads.position() * self.limits.point - middle;
        let reach = local(offset) * Vector::new(1.0, 0.0, 1.0);
        let towards = if reach.length() > 1e-9 { reach.normalize() } else { Vector::X };
        let across = Vector::Y.cross(towards);
        let motion = Motion { along: relative.dot(towards), across: relative.dot(across), turn };
        let Load { mass, inertia } = self.load;
        let rubbed = TouchedBody { mass, inertia, reach: reach.length(), arm: self.friction_arm() };
        let Some(left) = rubbed.after(&motion, self.limits.friction * dt) else {
            self.set_grip(world, Grip::Sticks);
            return;
        };
        let push = towards * (left.along - motion.along) + across * (left.across - motion.across);
        self.rubbed = push * (mass / dt);
        let part = &mut world.bodies[self.part];
        part.apply_impulse(axes * (push * mass), true);
        part.apply_torque_impulse(axes * (Vector::Y * ((left.turn - turn) * inertia)), true);
    }

    /// Lever arm of friction about Y, m.
    fn friction_arm(&self) -> Real {
        if self.limits.friction > 0.0 { self.limits.moments[1] / self.limits.friction } else { 0.0 }
    }

    /// After a step: let the part slide if the load exceeds friction, and push it aside if it exceeds the pads' force.
    pub fn give_way(&mut self, world: &mut PhysicsWorld) {
        let Stiffness { linear, angular } = self.stiffness;
        let present = self.present(world);
        if self.grip == Grip::Slides {
            self.follow(&present);
        }
        let away = present.translation - self.nominal.translation;
        let turn = on_the_side_of(&Rotation::IDENTITY, present.rotation * self.nominal.rotation.inverse());
        let turn = turn.to_scaled_axis();
        let aside = Vector::Y * beyond(away.y, self.limits.normal / linear);
        // Moments are about the point where the pads touch.
        let arm = self.nominal.translation - self.limits.point;
        let force = (away - aside) * -linear;
        let moment = turn * -angular + arm.cross(force);
        if self.grip == Grip::Sticks {
            let force = libm::hypot(force.x, force.z) / self.limits.friction;
            let used = libm::hypot(force, moment.y / self.limits.moments[1]);
            if used > 1.0 {
                // The springs stay at the limit. Before the next step it is decided whether the part sticks or slides.
                let excess = 1.0 - 1.0 / used;
                let slide = Vector::new(away.x, 0.0, away.z) * excess;
                self.nominal.translation += slide;
                let turned = Rotation::from_scaled_axis(Vector::Y * (turn.y * excess));
                self.nominal.rotation = (turned * self.nominal.rotation).normalize();
                self.slipped += slide.length();
                self.set_grip(world, Grip::Slides);
            }
        }
        let tilt = |moment: Real, limit: Real, across: Real| {
            -beyond(moment, limit) / (angular + linear * (across * across + arm.y * arm.y))
        };
        let [limit_x, _, limit_z] = self.limits.moments;
        let tilts = Vector::new(tilt(moment.x, limit_x, arm.z), 0.0, tilt(moment.z, limit_z, arm.x));
        let mut rest = about(self.limits.point, tilts, self.nominal);
        rest.translation += aside;
        self.set_rest(world, rest);
    }

    /// Set the rest pose of all springs to the present pose, because a stronger grip holds the part.
    pub fn relax(&mut self, world: &mut PhysicsWorld) {
        self.nominal = normalised(self.present(world));
        if self.grip != Grip::Sticks {
            self.set_grip(world, Grip::Sticks);
        }
        self.set_rest(world, self.nominal);
    }

    /// The stronger grip has released the part: draw it to the middle of the pads, flush, not along them.
    pub fn recover(&mut self, world: &mut PhysicsWorld) {
        self.nominal.translation.y = 0.0;
        let twist = Rotation::from_xyzw(0.0, self.nominal.rotation.y, 0.0, self.nominal.rotation.w);
        self.nominal.rotation =
            if twist.length_squared() > 0.0 { twist.normalize() } else { Rotation::IDENTITY };
        self.set_rest(world, self.nominal);
    }

    fn follow(&mut self, present: &Pose) {
        let touched = self.nominal.inverse_transform_point(self.limits.point);
        self.nominal.translation.x = present.translation.x;
        self.nominal.translation.z = present.translation.z;
        self.nominal.rotation = about_y(present.rotation);
        self.slipped += (self.nominal.transform_point(touched) - self.limits.point).length();
    }

    fn set_grip(&mut self, world: &mut PhysicsWorld, grip: Grip) {
        self.grip = grip;
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            set_springs(&mut joint.data, self.stiffness, self.damping, grip);
        }
    }

    fn set_rest(&mut self, world: &mut PhysicsWorld, rest: Pose) {
        if rest == self.rest {
            return;
        }
        self.rest = normalised(rest);
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            joint.data.set_local_frame1(self.rest);
        }
    }

    pub fn release(self, world: &mut PhysicsWorld) {
        world.remove_impulse_joint(self.joint);
    }
}

fn set_springs(joint: &mut GenericJoint, stiffness: Stiffness, damping: [Real; 2], grip: Grip) {
    for (index, axis) in AXES.into_iter().enumerate() {
        let along = matches!(axis, JointAxis::LinX | JointAxis::LinZ | JointAxis::AngY);
        let (k, c) = if index < 3 { (stiffness.linear, damping[0]) } else { (stiffness.angular, damping[1]) };
        joint.set_motor(axis, 0.0, 0.0, k, c);
        if along && grip != Grip::Sticks {
            joint.motor_axes.remove(axis.into());
        }
    }
}

fn about_y(rotation: Rotation) -> Rotation {
    let twist = Rotation::from_xyzw(0.0, rotation.y, 0.0, rotation.w);
    if twist.length_squared() > 0.0 { twist.normalize() } else { Rotation::IDENTITY }
}

/// The amount by which a value exceeds plus or minus a limit, with its sign; 0 within the limit.
fn beyond(value: Real, limit: Real) -> Real {
    value - value.clamp(-limit, limit)
}

fn about(point: Vector, turn: Vector, pose: Pose) -> Pose {
    if turn == Vector::ZERO {
        return pose;
    }
    let turn = Rotation::from_scaled_axis(turn);
    normalised(Pose::from_parts(point + turn * (pose.translation - point), turn * pose.rotation))
}

/// Normalize the rotation: rounding changes the length of products of many rotations.
fn normalised(pose: Pose) -> Pose {
    Pose::from_parts(pose.translation, pose.rotation.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excess_over_a_limit_is_signed() {
        assert_eq!((beyond(3.0, 2.0), beyond(-3.0, 2.0), beyond(1.0, 2.0)), (1.0, -1.0, 0.0));
    }

    #[test]
    fn rotation_keeps_its_centre() {
        let point = Vector::new(1.0, 2.0, 3.0);
        let turned = about(point, Vector::new(0.3, -0.2, 0.9), Pose::from_translation(point));
        assert!((turned.translation - point).length() < 1e-15);
        let beside =
            about(point, Vector::Z * core::f64::consts::FRAC_PI_2, Pose::from_translation(point + Vector::X));
        assert!((beside.translation - point - Vector::Y).length() < 1e-12);
    }
}
