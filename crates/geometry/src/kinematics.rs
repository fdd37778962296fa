//! Forward and inverse kinematics of the T3 arm in closed form.
//!
//! Joints: base, shoulder, elbow, pitch, yaw, roll. Shoulder, elbow and pitch axes are parallel and horizontal; roll
//! runs along the gripper and intersects yaw. The wrist is not spherical (`pitch_to_yaw`). HOME (IV.3.3) gives the
//! upper arm and the sum of the other lengths; their split is ASSUMED (SPECNOTES).

use core::{f64::consts::PI, fmt};

use nalgebra::Rotation3;

use crate::frame::{Frame, Rotation, Vector};

/// Six joint angles in radians: base, shoulder, elbow, pitch, yaw, roll.
pub type Joints = [f64; 6];

/// Names of the joints, in order.
pub const JOINT_NAMES: [&str; 6] = ["base", "shoulder", "elbow", "pitch", "yaw", "roll"];

/// Link lengths in inches, joint limits in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arm {
    /// Shoulder to elbow.
    pub upper_arm: f64,
    /// Elbow to pitch axis.
    pub forearm: f64,
    /// Pitch axis to yaw axis.
    pub pitch_to_yaw: f64,
    /// Yaw axis to end plate.
    pub yaw_to_plate: f64,
    /// End plate to tool point; one value for all grippers, since T3I takes no end effector id (VI.1.2).
    pub plate_to_tool: f64,
    /// Least and greatest angle of each joint.
    pub limits: [(f64, f64); 6],
}

#[inline]
const fn deg(degrees: f64) -> f64 {
    degrees * (PI / 180.0)
}

/// The arm of this project ("model B", SPECNOTES).
pub const T3: Arm = Arm {
    upper_arm: 40.0,
    forearm: 40.0,
    pitch_to_yaw: 3.0,
    yaw_to_plate: 6.0,
    plate_to_tool: 12.0,
    limits: [
        (deg(-210.0), deg(30.0)),
        (deg(0.0), deg(90.0)),
        (deg(-165.0), deg(-10.0)),
        (deg(-90.0), deg(90.0)),
        (deg(-90.0), deg(90.0)),
        (deg(-135.0), deg(135.0)),
    ],
};

/// Joint angles at HOME (IV.3.3 step 9), radians.
pub const HOME_JOINTS: Joints = [deg(-90.0), deg(45.0), deg(-90.0), 0.0, 0.0, 0.0];

/// Errors of the inverse kinematics: why no joint angles reach a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReachError {
    /// The gripper axis is parallel to the pitch axis: error P9P of the T3's controller.
    WristSingularity,
    /// The wrist would be beyond the reach of the stretched arm.
    TooFar {
        /// Inches beyond the reach.
        by: f64,
    },
    /// The wrist would be nearer to the shoulder than the folded arm allows.
    TooNear {
        /// Inches missing to the least reach.
        by: f64,
    },
    /// A coordinate is NaN or infinite.
    NotFinite,
}

impl fmt::Display for ReachError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WristSingularity => {
                f.write_str("the wrist is singular: the gripper axis is parallel to the pitch axis")
            }
            Self::TooFar { by } => write!(f, "out of reach by {by:.2} in"),
            Self::TooNear { by } => write!(f, "too near to the shoulder by {by:.2} in"),
            Self::NotFinite => f.write_str("not a position"),
        }
    }
}

impl core::error::Error for ReachError {}

/// The joint that is nearest to a limit or farthest beyond one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Index of the joint, from 0.
    pub joint: usize,
    /// Radians to the nearer limit; negative if beyond it.
    pub radians: f64,
}

impl Arm {
    /// Tool frame at the given joint angles.
    #[must_use]
    #[inline]
    pub fn forward(&self, joints: &Joints) -> Frame {
        self.frame_at(joints, self.yaw_to_plate + self.plate_to_tool)
    }

    /// End-plate frame at the given joint angles: the frame that DEPC commands and reports (VI.1).
    #[must_use]
    #[inline]
    pub fn forward_plate(&self, joints: &Joints) -> Frame {
        self.frame_at(joints, self.yaw_to_plate)
    }

    #[inline]
    fn frame_at(&self, joints: &Joints, beyond_yaw: f64) -> Frame {
        let [base, shoulder, elbow, pitch, yaw, roll] = *joints;
        let rotation = Rotation3::from_axis_angle(&Vector::z_axis(), base)
            * Rotation3::from_axis_angle(&Vector::y_axis(), -(shoulder + elbow + pitch))
            * Rotation3::from_axis_angle(&Vector::z_axis(), yaw)
            * Rotation3::from_axis_angle(&Vector::x_axis(), roll);
        let along = |elevation: f64| {
            Vector::new(
                libm::cos(elevation) * libm::cos(base),
                libm::cos(elevation) * libm::sin(base),
                libm::sin(elevation),
            )
        };
        let axis = rotation * Vector::x();
        let position = along(shoulder) * self.upper_arm
            + along(shoulder + elbow) * self.forearm
            + along(shoulder + elbow + pitch) * self.pitch_to_yaw
            + axis * beyond_yaw;
        Frame { position, rotation }
    }

    /// Joint angles, radians, for a tool frame: arm in front, yaw within 90 degrees, elbow up, limits ignored. `near`
    /// sets an arbitrary base angle, and the turns of base and roll. Errors: [`ReachError`] if no joint angles exist.
    #[inline]
    pub fn inverse(&self, tool: &Frame, near: &Joints) -> Result<Joints, ReachError> {
        if !tool.is_finite() {
            return Err(ReachError::NotFinite);
        }
        let [near_base, .., near_roll] = *near;
        let axis = tool.x();
        let yaw_centre = tool.position - axis * (self.yaw_to_plate + self.plate_to_tool);
        let planar = libm::hypot(yaw_centre.x, yaw_centre.y);
        let base = if planar > 1e-9 { libm::atan2(yaw_centre.y, yaw_centre.x) } else { near_base };
        let left = Vector::new(-libm::sin(base), libm::cos(base), 0.0);
        let front = Vector::new(libm::cos(base), libm::sin(base), 0.0);

        let sin_yaw = axis.dot(&left).clamp(-1.0, 1.0);
        let cos_yaw = libm::sqrt(1.0 - sin_yaw * sin_yaw);
        if cos_yaw < 1e-3 {
            return Err(ReachError::WristSingularity);
        }
        let yaw = libm::atan2(sin_yaw, cos_yaw);
        let pitch_direction = (axis - left * sin_yaw) / cos_yaw;
        let elevation = libm::atan2(pitch_direction.z, pitch_direction.dot(&front));
        let pitch_axis = yaw_centre - pitch_direction * self.pitch_to_yaw;

        let (r, z) = (pitch_axis.dot(&front), pitch_axis.z);
        let reach = libm::hypot(r, z);
        let (longest, shortest) = (self.upper_arm + self.forearm, (self.upper_arm - self.forearm).abs());
        if reach > longest {
            return Err(ReachError::TooFar { by: reach - longest });
        }
        if reach < shortest {
            return Err(ReachError::TooNear { by: shortest - reach });
        }
        let cos_elbow = (reach * reach - self.upper_arm * self.upper_arm - self.forearm * self.forearm)
            / (2.0 * self.upper_arm * self.forearm);
        let elbow = -libm::acos(cos_elbow.clamp(-1.0, 1.0));
        let shoulder = libm::atan2(z, r)
            - libm::atan2(self.forearm * libm::sin(elbow), self.upper_arm + self.forearm * libm::cos(elbow));
        let pitch = elevation - shoulder - elbow;

        let without_roll = Rotation3::from_axis_angle(&Vector::z_axis(), base)
            * Rotation3::from_axis_angle(&Vector::y_axis(), -elevation)
            * Rotation3::from_axis_angle(&Vector::z_axis(), yaw);
        let rolled: Rotation = without_roll.inverse() * tool.rotation;
        let rolled_y = rolled * Vector::y();
        let roll = libm::atan2(rolled_y.z, rolled_y.y);
        Ok([
            turned_near(base, near_base),
            wrapped(shoulder),
            elbow,
            wrapped(pitch),
            yaw,
            turned_near(roll, near_roll),
        ])
    }

    /// The joint with the least margin to its limits.
    #[must_use]
    #[inline]
    pub fn margin(&self, joints: &Joints) -> Margin {
        let mut least = Margin { joint: 0, radians: f64::INFINITY };
        for (joint, (angle, (low, high))) in joints.iter().zip(self.limits).enumerate() {
            let radians = (angle - low).min(high - angle);
            if radians < least.radians {
                least = Margin { joint, radians };
            }
        }
        least
    }

    /// The same angles with whole turns added, so that each joint lies within its limits where possible.
    #[must_use]
    #[inline]
    pub fn within_limits(&self, joints: &Joints) -> Joints {
        let mut all = *joints;
        for (angle, (low, high)) in all.iter_mut().zip(self.limits) {
            *angle = turned_near(*angle, 0.5 * (low + high));
        }
        all
    }
}

#[inline]
fn wrapped(angle: f64) -> f64 {
    turned_near(angle, 0.0)
}

/// `angle` plus the whole turns that bring it nearest to `near`, radians.
#[must_use]
#[inline]
pub fn turned_near(angle: f64, near: f64) -> f64 {
    let turns = libm::round((near - angle) / (2.0 * PI));
    if turns.is_finite() { angle + turns * (2.0 * PI) } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Pose, WireFrame};
    use proptest::prelude::*;

    const HOME: WireFrame =
        WireFrame { tool: [0, -7145, -1483], wrist_to_tool: [0, -2123, -2119], tool_to_finger: [3000, 0, 0] };

    fn close(found: &Joints, degrees: [f64; 6], within: f64) {
        for ((found, expected), name) in found.iter().zip(degrees).zip(JOINT_NAMES) {
            assert!(
                (found.to_degrees() - expected).abs() < within,
                "{name}: {} for {expected}",
                found.to_degrees()
            );
        }
    }

    #[test]
    fn home_joints_give_the_nine_numbers_of_the_manual() {
        let wire = WireFrame::from_frame(&T3.forward(&HOME_JOINTS));
        for (found, printed) in [wire.tool, wire.wrist_to_tool, wire.tool_to_finger]
            .concat()
            .iter()
            .zip([HOME.tool, HOME.wrist_to_tool, HOME.tool_to_finger].concat())
        {
            assert!((found - printed).abs() <= 4, "{found} for {printed}");
        }
    }

    #[test]
    fn printed_poses_have_the_worked_joints() {
        let home = T3.inverse(&HOME.to_frame().unwrap(), &HOME_JOINTS).unwrap();
        close(&home, [-90.0, 44.99, -89.96, 0.03, 0.0, 0.0], 0.01);
        let pose =
            Pose { wrist: [6497, -2366, 1569], tool: [9495, -2475, 1595], finger: [9523, -1460, -1228] };
        let transfer = T3.inverse(&pose.to_frame().unwrap(), &HOME_JOINTS).unwrap();
        close(&transfer, [-17.38, 19.43, -15.90, -3.01, 15.30, -70.08], 0.02);
    }

    #[test]
    fn a_gripper_along_the_pitch_axis_is_singular() {
        let mut joints = HOME_JOINTS;
        joints[4] = PI / 2.0;
        assert_eq!(T3.inverse(&T3.forward(&joints), &joints), Err(ReachError::WristSingularity));
    }

    #[test]
    fn a_pose_beyond_the_arm_has_no_joints() {
        let mut far = T3.forward(&HOME_JOINTS);
        far.position.y = -150.0;
        assert!(matches!(T3.inverse(&far, &HOME_JOINTS), Err(ReachError::TooFar { by }) if by > 0.0));
        far.position.y = f64::NAN;
        assert_eq!(T3.inverse(&far, &HOME_JOINTS), Err(ReachError::NotFinite));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]
        #[test]
        fn forward_then_inverse_is_the_identity(
            base in -209.0_f64..29.0, shoulder in 1.0_f64..89.0, elbow in -164.0_f64..-11.0,
            pitch in -89.0_f64..89.0, yaw in -89.0_f64..89.0, roll in -134.0_f64..134.0,
        ) {
            let joints = [base, shoulder, elbow, pitch, yaw, roll].map(f64::to_radians);
            // The pitch axis must be in front of the base axis for this branch.
            let (s, e) = (joints[1], joints[1] + joints[2]);
            let p = e + joints[3];
            let arm = 40.0 * s.cos() + 40.0 * e.cos();
            prop_assume!(arm + 3.0 * p.cos() > 0.5 && arm > 0.5);
            let back = T3.inverse(&T3.forward(&joints), &joints).unwrap();
            for ((a, b), name) in joints.iter().zip(back).zip(JOINT_NAMES) {
                prop_assert!((a - b).abs() < 1e-7, "{name}: {a} came back as {b}");
            }
        }
    }
}
