//! A straight line from one frame to another, with a simultaneous rotation about one axis.

use geometry::frame::{Distance, Frame, Rotation, Vector, norm, rotation_by, rotation_vector};
use nalgebra::Matrix3;
use rcs_core::Plain;

use super::{
    limits::Limits,
    profile::{NO_PATH, Profile},
};

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct FrameData {
    pub position: [f64; 3], // tool point, inches
    pub rotation: [f64; 9], // matrix, row by row
}

impl From<&Frame> for FrameData {
    fn from(frame: &Frame) -> Self {
        let m = frame.rotation.matrix();
        Self {
            position: frame.position.into(),
            rotation: [m.m11, m.m12, m.m13, m.m21, m.m22, m.m23, m.m31, m.m32, m.m33],
        }
    }
}

impl FrameData {
    #[must_use]
    pub fn frame(&self) -> Frame {
        let [a, b, c, d, e, f, g, h, i] = self.rotation;
        Frame {
            position: self.position.into(),
            rotation: Rotation::from_matrix_unchecked(Matrix3::new(a, b, c, d, e, f, g, h, i)),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct SegmentOrder {
    pub goal: FrameData,
    /// GO-THRU: the next segment may start when this path remains, inches; 0 at the point itself.
    pub through: Option<f64>,
    pub limits: Limits,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Segment {
    pub order: SegmentOrder,
    pub translation: [f64; 3], // from start to goal, inches
    pub rotation: [f64; 3],    // from start to goal, axis times angle, radians
    pub length: f64,           // path from start to goal, inches
    pub profile: Profile,
    pub velocity: f64, // in/s, for which the profile was planned
}

/// A small displacement: inches, and axis times angle in radians.
#[derive(Clone, Copy, Debug)]
pub struct Displacement {
    translation: Vector,
    rotation: Vector,
}

impl Displacement {
    #[must_use]
    pub fn apply(&self, frame: &Frame) -> Frame {
        Frame {
            position: frame.position + self.translation,
            rotation: rotation_by(&self.rotation) * frame.rotation,
        }
    }
}

impl Segment {
    #[must_use]
    pub fn new(start: &Frame, order: &SegmentOrder) -> Self {
        let goal = order.goal.frame();
        let translation = goal.position - start.position;
        let rotation = rotation_vector(&(goal.rotation * start.rotation.inverse()));
        Self {
            order: *order,
            translation: translation.into(),
            rotation: rotation.into(),
            length: Distance { inches: norm(&translation), radians: norm(&rotation) }.path(),
            profile: Profile::default(),
            velocity: 0.0,
        }
    }

    /// Zero once the profile has ended at the goal, so the last point is exactly the goal.
    #[must_use]
    pub fn missing(&self) -> Displacement {
        let over = self.profile.to_goal && self.profile.remaining() <= 0.0;
        let share =
            if over || self.length < NO_PATH { 0.0 } else { self.profile.now().position / self.length - 1.0 };
        Displacement {
            translation: Vector::from(self.translation) * share,
            rotation: Vector::from(self.rotation) * share,
        }
    }

    /// True at the goal, and where a profile to rest has ended.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.profile.remaining() <= 0.0
    }
}
