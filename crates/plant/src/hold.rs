//! A hold: a part between two pads, as strong as the pads' force and friction allow, and no stronger.
//!
//! Contacts between a squeezed light part and two heavy pads creep, and a rigid weld never lets go. A hold is between the
//! two: springs between the pads' body and the part, whose rest position gives way when more is asked of the pads than they
//! can bear. The load on the pads is known from the springs; what is beyond the limit moves the rest position after the
//! part, by just so much that the limit remains (a return mapping, as for plastic material):
//!
//! * along the pads (X, Z, and the turn about Y) the limit is friction, and what has slid stays where it has slid to;
//! * across the pads (Y, and the tilts about X and Z) the limit is the pads' force: the part is pushed aside, and the pads
//!   bring it back to their middle, flush, as soon as they are the stronger.
//!
//! The springs act at the middle of the part, where the six axes do not disturb each other, so that the solver has them
//! exact at once; the limits hold where the pads touch, and a bar that is gripped at its end droops about that point.

use rapier3d_f64::math::Vector;
use rapier3d_f64::prelude::*;

use crate::{convert::on_the_side_of, squeeze::Squeeze};

/// The six axes: along X, Y, Z, about X, about Y, about Z. Y is across the pads.
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

/// What the pads can bear where they touch, and where that is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Limits {
    /// Along the pads, N.
    friction: Real,
    /// Across the pads, N.
    normal: Real,
    /// About X, Y, Z, N·m.
    moments: [Real; 3],
    /// The middle of the touched area, in the axes of the pads' body.
    point: Vector,
}

/// A part between two pads.
#[derive(Debug)]
pub struct Hold {
    joint: ImpulseJointHandle,
    pads: RigidBodyHandle,
    part: RigidBodyHandle,
    /// Where the part would be without any load, as far as friction remembers: its middle, and its turn from flush.
    nominal: Pose,
    /// Where the springs rest: nominal, pushed aside.
    rest: Pose,
    /// From the part's axes to those in which it lies flush.
    attitude: Rotation,
    stiffness: Stiffness,
    /// Of the springs along and about the axes, N·s/m and N·m·s/rad.
    damping: [Real; 2],
    limits: Limits,
    sliding: bool,
    slipped: Real,
}

impl Hold {
    /// Take hold of a part: `flush` is where the part shall lie in the axes of the pads' body.
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
        set_springs(&mut data, stiffness, damping);
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
            sliding: false,
            slipped: 0.0,
        }
    }

    /// How far the part has slid in this hold, m.
    #[must_use]
    pub fn slipped(&self) -> Real {
        self.slipped
    }

    /// Set the limits from force, friction and what is touched.
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
        // Within a step the springs may not exceed what the pads bear either; a force at the middle of the part adds its
        // moment about the pads.
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

    /// Where the part is in the axes of the pads' body, turned as it is from flush.
    fn present(&self, world: &PhysicsWorld) -> Pose {
        let pads = world.bodies[self.pads].position();
        let part = pads.inv_mul(world.bodies[self.part].position());
        Pose::from_parts(part.translation, part.rotation * self.attitude)
    }

    /// After a step: let the rest position give way where the load is beyond what the pads bear.
    pub fn give_way(&mut self, world: &mut PhysicsWorld) {
        let Stiffness { linear, angular } = self.stiffness;
        let present = self.present(world);
        let away = present.translation - self.nominal.translation;
        let turn = on_the_side_of(&Rotation::IDENTITY, present.rotation * self.nominal.rotation.inverse());
        let turn = turn.to_scaled_axis();

        // Along the pads: friction has one limit whatever the direction.
        let plane = libm::hypot(away.x, away.z);
        let slid = beyond(plane, self.limits.friction / linear);
        let share = if plane > 0.0 { slid / plane } else { 0.0 };
        let slide = Vector::new(away.x * share, 0.0, away.z * share);
        let aside = Vector::Y * beyond(away.y, self.limits.normal / linear);

        // About the point where the pads touch: the springs' moment, and that of their force at the middle.
        let arm = self.nominal.translation - self.limits.point;
        let force = (away - slide - aside) * -linear;
        let moment = (turn * -angular + arm.cross(force)).to_array();
        let squares =
            [arm.y * arm.y + arm.z * arm.z, arm.x * arm.x + arm.z * arm.z, arm.x * arm.x + arm.y * arm.y];
        let [tilt_x, turned, tilt_z] = [0, 1, 2].map(|axis| {
            -beyond(moment[axis], self.limits.moments[axis]) / (angular + linear * squares[axis])
        });

        if slid > 0.0 || turned != 0.0 {
            self.nominal = about(self.limits.point, Vector::Y * turned, self.nominal);
            self.nominal.translation += slide;
            self.slipped += slid;
        }
        self.set_sliding(world, slid > 0.0 || turned != 0.0);
        let mut rest = about(self.limits.point, Vector::new(tilt_x, 0.0, tilt_z), self.nominal);
        rest.translation += aside;
        self.set_rest(world, rest);
    }

    /// Let all springs rest where the part is now: another, stronger grip has it.
    pub fn relax(&mut self, world: &mut PhysicsWorld) {
        self.nominal = normalised(self.present(world));
        self.set_rest(world, self.nominal);
    }

    /// The stronger grip is gone: draw the part back to the middle of the pads, flush; along the pads it stays.
    pub fn recover(&mut self, world: &mut PhysicsWorld) {
        self.nominal.translation.y = 0.0;
        let twist = Rotation::from_xyzw(0.0, self.nominal.rotation.y, 0.0, self.nominal.rotation.w);
        self.nominal.rotation =
            if twist.length_squared() > 0.0 { twist.normalize() } else { Rotation::IDENTITY };
        self.set_rest(world, self.nominal);
    }

    /// A part that slides meets friction, and no damping beside it.
    fn set_sliding(&mut self, world: &mut PhysicsWorld, sliding: bool) {
        if sliding == self.sliding {
            return;
        }
        self.sliding = sliding;
        if let Some(joint) = world.impulse_joints.get_mut(self.joint, false) {
            set_springs(&mut joint.data, self.stiffness, if sliding { [0.0; 2] } else { self.damping });
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

    /// Let go.
    pub fn release(self, world: &mut PhysicsWorld) {
        world.remove_impulse_joint(self.joint);
    }
}

fn set_springs(joint: &mut GenericJoint, stiffness: Stiffness, damping: [Real; 2]) {
    for (index, axis) in AXES.into_iter().enumerate() {
        let (k, c) = if index < 3 { (stiffness.linear, damping[0]) } else { (stiffness.angular, damping[1]) };
        joint.set_motor(axis, 0.0, 0.0, k, c);
    }
}

/// By how much a value is beyond plus or minus a limit.
fn beyond(value: Real, limit: Real) -> Real {
    value - value.clamp(-limit, limit)
}

/// A pose turned about a point.
fn about(point: Vector, turn: Vector, pose: Pose) -> Pose {
    if turn == Vector::ZERO {
        return pose;
    }
    let turn = Rotation::from_scaled_axis(turn);
    normalised(Pose::from_parts(point + turn * (pose.translation - point), turn * pose.rotation))
}

/// Products of many rotations do not keep their length by themselves.
fn normalised(pose: Pose) -> Pose {
    Pose::from_parts(pose.translation, pose.rotation.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_a_limit_has_its_sign() {
        assert_eq!((beyond(3.0, 2.0), beyond(-3.0, 2.0), beyond(1.0, 2.0)), (1.0, -1.0, 0.0));
    }

    #[test]
    fn a_turn_leaves_its_point_where_it_is() {
        let point = Vector::new(1.0, 2.0, 3.0);
        let turned = about(point, Vector::new(0.3, -0.2, 0.9), Pose::from_translation(point));
        assert!((turned.translation - point).length() < 1e-15);
        let beside =
            about(point, Vector::Z * core::f64::consts::FRAC_PI_2, Pose::from_translation(point + Vector::X));
        assert!((beside.translation - point - Vector::Y).length() < 1e-12);
    }
}
