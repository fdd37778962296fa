//! Frames inside the controller: a position in inches and a rotation, in `f64`.
//!
//! World frame (SPECNOTES): right-handed, +Z up, origin on the base axis at shoulder height; at HOME the arm
//! points along -Y. Tool frame (VII.1): X along the gripper axis out of the fingertips, Y from the tool point
//! to the finger point, Z = X x Y.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Inches or unitless; world coordinates by default.
pub type Vector = Vector3<f64>;
/// The columns are the tool's X, Y, Z in world coordinates.
pub type Rotation = Rotation3<f64>;

/// Position in inches, and orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The tool point, inches.
    pub position: Vector,
    /// Tool axes in world coordinates.
    pub rotation: Rotation,
}

impl Frame {
    /// The world frame itself.
    #[must_use]
    #[inline]
    pub fn identity() -> Self {
        Self { position: Vector::zeros(), rotation: Rotation::identity() }
    }

    /// Tool X: along the gripper axis, out of the fingertips.
    #[must_use]
    #[inline]
    pub fn x(&self) -> Vector {
        self.rotation.matrix().column(0).into_owned()
    }

    /// Tool Y: to the left when the gripper is level and the camera on top.
    #[must_use]
    #[inline]
    pub fn y(&self) -> Vector {
        self.rotation.matrix().column(1).into_owned()
    }

    /// Tool Z: up when the gripper is level.
    #[must_use]
    #[inline]
    pub fn z(&self) -> Vector {
        self.rotation.matrix().column(2).into_owned()
    }

    /// The frame moved by `offset` inches in its own axes.
    #[must_use]
    #[inline]
    pub fn shifted(&self, offset: Vector) -> Self {
        Self { position: self.position + self.rotation * offset, rotation: self.rotation }
    }

    /// The frame rotated about its own origin by `turn`, given in its own axes.
    #[must_use]
    #[inline]
    pub fn turned(&self, turn: &Rotation) -> Self {
        Self { position: self.position, rotation: self.rotation * turn }
    }

    /// Transforms `inner` from this frame's coordinates to the coordinates of this frame's parent: `self * inner`.
    #[must_use]
    #[inline]
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            position: self.position + self.rotation * inner.position,
            rotation: self.rotation * inner.rotation,
        }
    }

    /// The inverse transform: `f.compose(&f.inverse())` is the identity.
    #[must_use]
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { position: rotation * -self.position, rotation }
    }

    /// Distance to `other`: inches between the origins, radians between the orientations.
    #[must_use]
    #[inline]
    pub fn distance(&self, other: &Self) -> Distance {
        Distance {
            inches: norm(&(other.position - self.position)),
            radians: norm(&rotation_vector(&(other.rotation * self.rotation.inverse()))),
        }
    }

    /// True if every number is finite.
    #[must_use]
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.position.iter().all(|v| v.is_finite()) && self.rotation.matrix().iter().all(|v| v.is_finite())
    }
}

/// Distance between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Between the origins, inches.
    pub inches: f64,
    /// Between the orientations: angle of the single rotation that turns one into the other, radians.
    pub radians: f64,
}

/// Translation in inches that weighs as one radian: the ratio of the DEPC limits 14 in/s and 1.0 rad/s (A 2.3).
pub const INCHES_PER_RADIAN: f64 = 14.0;

impl Distance {
    /// The larger of the translation and the rotation times [`INCHES_PER_RADIAN`], inches.
    #[must_use]
    #[inline]
    pub fn path(&self) -> f64 {
        self.inches.max(self.radians * INCHES_PER_RADIAN)
    }
}

/// Length of a vector.
#[must_use]
#[inline]
pub fn norm(v: &Vector) -> f64 {
    libm::sqrt(v.dot(v))
}

/// Axis times angle, radians, up to pi. Accurate near 0 and pi, where the arc cosine of the trace is not.
#[must_use]
#[inline]
pub fn rotation_vector(rotation: &Rotation) -> Vector {
    let m = rotation.matrix();
    let at = |r: usize, c: usize| m.get((r, c)).copied().unwrap_or(0.0);
    let skew = Vector::new(at(2, 1) - at(1, 2), at(0, 2) - at(2, 0), at(1, 0) - at(0, 1));
    let double_sine = norm(&skew);
    let double_cosine = at(0, 0) + at(1, 1) + at(2, 2) - 1.0;
    let angle = libm::atan2(double_sine, double_cosine);
    if double_sine > 1e-6 {
        return skew * (angle / double_sine);
    }
    if double_cosine > 0.0 {
        return skew * 0.5;
    }
    // Half a turn: the axis is the longest column of R + 1.
    let symmetric = m + Matrix3::identity();
    let mut longest = Vector::x();
    let mut length = 0.0;
    for column in symmetric.column_iter() {
        let candidate = column.into_owned();
        if norm(&candidate) > length {
            length = norm(&candidate);
            longest = candidate;
        }
    }
    if length > 0.0 { longest * (angle / length) } else { Vector::zeros() }
}

/// The rotation of a rotation vector: `v` is the axis times the angle in radians.
#[must_use]
#[inline]
pub fn rotation_by(v: &Vector) -> Rotation {
    let angle = norm(v);
    if angle > 1e-12 {
        Rotation::from_axis_angle(&Unit::new_unchecked(v / angle), angle)
    } else {
        Rotation::identity()
    }
}

/// Tool X along `x`, Y as near to `y` as possible (Gram-Schmidt); `None` if parallel or zero.
#[must_use]
#[inline]
pub fn rotation_from_x_y(x: &Vector, y: &Vector) -> Option<Rotation> {
    let length = norm(x);
    if length.is_nan() || length < 1e-9 {
        return None;
    }
    let x = x / length;
    let across = y - x * x.dot(y);
    let length = norm(&across);
    if length.is_nan() || length < 1e-9 {
        return None;
    }
    let y = across / length;
    let z = x.cross(&y);
    Some(Rotation::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rotation_vectors_come_back(
            x in -3.0_f64..3.0,
            y in -3.0_f64..3.0,
            z in -3.0_f64..3.0,
            angle in 0.0_f64..3.1,
        ) {
            prop_assume!(x * x + y * y + z * z > 1e-3);
            let v = Vector::new(x, y, z).normalize() * angle;
            let back = rotation_vector(&rotation_by(&v));
            prop_assert!(norm(&(back - v)) < 1e-7, "{v:?} came back as {back:?}");
        }

        #[test]
        fn an_inverse_undoes(
            x in -90.0_f64..90.0,
            y in -90.0_f64..90.0,
            a in -3.0_f64..3.0,
            b in -3.0_f64..3.0,
        ) {
            let rotation = rotation_by(&Vector::new(a, b, 0.3));
            let f = Frame { position: Vector::new(x, y, 12.0), rotation };
            let none = f.compose(&f.inverse()).distance(&Frame::identity());
            prop_assert!(none.inches < 1e-9 && none.radians < 1e-9);
        }
    }

    #[test]
    fn half_a_turn_has_an_axis() {
        let v = rotation_vector(&rotation_by(&Vector::new(0.0, core::f64::consts::PI, 0.0)));
        assert!((norm(&v) - core::f64::consts::PI).abs() < 1e-9);
        assert!(v.y.abs() > 3.0);
    }
}
