//! The arm as a kinematic chain: frames of its links, and joint torques of forces on them. Lengths are those of
//! [`geometry::kinematics::T3`]; inches, pounds and radians.

use geometry::{
    frame::{Frame, Vector, rotation_by},
    kinematics::{Joints, T3},
};
use nalgebra::Vector6;

/// Axes of the joints from base to roll, in the frames of their links.
pub const AXES: [[f64; 3]; 6] =
    [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

/// Origin of each link in its parent, along the parent's X, in.
pub const STARTS: [f64; 6] = [0.0, 0.0, T3.upper_arm, T3.forearm, T3.pitch_to_yaw, 0.0];

pub const UPPER_ARM: usize = 1;
pub const FOREARM: usize = 2;
/// Index of the end plate among the links: it carries the quick change, the grippers and the parts in them.
pub const END_PLATE: usize = 5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    pub link: usize,    // 0 for the turret
    pub at: Vector,     // point of application, world, in
    pub force: Vector,  // world, lb
    pub moment: Vector, // world, lb·in
    /// Decrease of the force when the point moves with it, lb/in: 0 for a weight.
    pub stiffness: f64,
    /// Coefficient of friction perpendicular to the force: 0 for a weight.
    pub friction: f64,
}

impl Load {
    #[must_use]
    pub fn weight(link: usize, at: Vector, pounds: f64) -> Self {
        Self {
            link,
            at,
            force: Vector::new(0.0, 0.0, -pounds),
            moment: Vector::zeros(),
            stiffness: 0.0,
            friction: 0.0,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Chain {
    frames: [Frame; 6],
}

impl Chain {
    /// The links for joint angles in radians.
    #[must_use]
    pub fn new(joints: &Joints) -> Self {
        let mut frame = Frame::identity();
        let mut frames = [frame; 6];
        for (joint, angle) in joints.iter().enumerate() {
            frame = frame
                .shifted(Vector::new(STARTS[joint], 0.0, 0.0))
                .turned(&rotation_by(&(Vector::from(AXES[joint]) * *angle)));
            frames[joint] = frame;
        }
        Self { frames }
    }

    /// Frames of the links in the world, in: turret, upper arm, forearm, pitch, yaw, end plate.
    #[must_use]
    pub fn frames(&self) -> &[Frame; 6] {
        &self.frames
    }

    /// The point at a distance along a link's X, world, in.
    #[must_use]
    pub fn along(&self, link: usize, inches: f64) -> Vector {
        self.frames[link].shifted(Vector::new(inches, 0.0, 0.0)).position
    }

    /// Row of the Jacobian: speed of a point of a link along a direction, for each joint, in/rad.
    #[must_use]
    pub fn lever(&self, link: usize, at: &Vector, along: &Vector) -> Vector6<f64> {
        let joints = self.frames.iter().zip(AXES).take(link + 1).enumerate();
        joints.fold(Vector6::zeros(), |mut levers, (joint, (frame, axis))| {
            let axis = frame.rotation * Vector::from(axis);
            levers[joint] = axis.cross(&(at - frame.position)).dot(along);
            levers
        })
    }

    /// Joint torques of a load, lb·in.
    #[must_use]
    pub fn torque(&self, load: &Load) -> Vector6<f64> {
        let joints = self.frames.iter().zip(AXES).take(load.link + 1).enumerate();
        let force = self.lever(load.link, &load.at, &load.force);
        joints.fold(force, |mut torques, (joint, (frame, axis))| {
            torques[joint] += (frame.rotation * Vector::from(axis)).dot(&load.moment);
            torques
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::kinematics::HOME_JOINTS;
    use proptest::prelude::*;

    #[test]
    fn last_link_is_the_end_plate() {
        let joints = [-1.0, 0.7, -1.2, 0.3, 0.2, -0.4];
        let chain = Chain::new(&joints);
        let plate = chain.frames()[END_PLATE].shifted(Vector::new(T3.yaw_to_plate, 0.0, 0.0));
        let distance = plate.distance(&T3.forward_plate(&joints));
        assert!(distance.inches < 1e-12 && distance.radians < 1e-12, "{distance:?}");
    }

    proptest! {
        /// Virtual work: the torques of a force do its work in a small turn of each joint.
        #[test]
        fn torques_do_the_work_of_the_force(
            off in prop::array::uniform6(-0.7..0.7_f64),
            force in prop::array::uniform3(-100.0..100.0_f64),
            joint in 0..6_usize,
        ) {
            const TURN: f64 = 1e-6;
            let mut joints = HOME_JOINTS;
            joints.iter_mut().zip(off).for_each(|(joint, off)| *joint += off);
            let hand = |joints: &Joints| T3.forward(joints).position;
            let (at, force) = (hand(&joints), Vector::from(force));
            let load = Load { link: END_PLATE, at, force, moment: Vector::zeros(), stiffness: 0.0, friction: 0.0 };
            let torque = Chain::new(&joints).torque(&load)[joint];
            joints[joint] += TURN;
            let work = (hand(&joints) - at).dot(&force);
            prop_assert!((work / TURN - torque).abs() < 0.02, "{work} {torque}");
        }
    }
}
