//! Poses: a position in mm and a unit quaternion (w, x, y, z), as in EGM, and computations with them.

use crate::Error;

/// A vector: mm, mm/s or rad/s.
pub type Vector = [f64; 3];
/// A unit quaternion: w, x, y, z.
pub type Quaternion = [f64; 4];

const UNIT_TOLERANCE: f64 = 0.01; // of the length

/// Position and orientation of one frame in another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin, mm.
    pub position: Vector,
    /// Orientation, a unit quaternion.
    pub orientation: Quaternion,
}

/// Speed of a frame, in the axes of the frame that it moves in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Linear speed of the origin, mm/s.
    pub linear: Vector,
    /// Angular speed, rad/s.
    pub angular: Vector,
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    /// The identity: no displacement.
    pub const IDENTITY: Self = Self { position: [0.0; 3], orientation: [1.0, 0.0, 0.0, 0.0] };

    /// Normalizes the quaternion. Errors: [`Error::NotAPose`] if not finite, or if the length is not 1 within 0.01.
    pub fn new(position: Vector, orientation: Quaternion) -> Result<Self, Error> {
        let length = libm::sqrt(orientation.iter().map(|v| v * v).sum());
        let unit = (length - 1.0).abs() <= UNIT_TOLERANCE;
        if !(unit && position.iter().all(|v| v.is_finite())) {
            return Err(Error::NotAPose);
        }
        Ok(Self { position, orientation: orientation.map(|v| v / length) })
    }

    /// Transforms `inner` from this frame's coordinates to the coordinates of this frame's parent.
    #[must_use]
    pub fn compose(&self, inner: &Self) -> Self {
        Self {
            position: add(&self.position, &rotate(&self.orientation, &inner.position)),
            orientation: normalised(product(&self.orientation, &inner.orientation)),
        }
    }

    /// The inverse pose.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let orientation = conjugate(&self.orientation);
        Self { position: rotate(&orientation, &scaled(&self.position, -1.0)), orientation }
    }

    /// The displacement from this pose to another: mm, and the rotation vector of the shorter rotation, rad.
    #[must_use]
    pub fn way_to(&self, other: &Self) -> Twist {
        let turn = product(&other.orientation, &conjugate(&self.orientation));
        Twist { linear: subtract(&other.position, &self.position), angular: rotation_vector(&turn) }
    }

    /// The pose after a displacement: position moved, orientation rotated about the axes of the outer frame.
    #[must_use]
    pub fn moved(&self, way: &Twist) -> Self {
        Self {
            position: add(&self.position, &way.linear),
            orientation: normalised(product(&from_rotation_vector(&way.angular), &self.orientation)),
        }
    }

    /// Distance to another pose: mm, radians.
    #[must_use]
    pub fn distance(&self, other: &Self) -> (f64, f64) {
        let way = self.way_to(other);
        (norm(&way.linear), norm(&way.angular))
    }
}

impl Twist {
    /// Both parts multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { linear: scaled(&self.linear, factor), angular: scaled(&self.angular, factor) }
    }
}

/// The sum of two vectors.
#[must_use]
pub fn add(a: &Vector, b: &Vector) -> Vector {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [ax + bx, ay + by, az + bz]
}

/// The first vector minus the second.
#[must_use]
pub fn subtract(a: &Vector, b: &Vector) -> Vector {
    add(a, &scaled(b, -1.0))
}

/// A vector multiplied by a number.
#[must_use]
pub fn scaled(v: &Vector, factor: f64) -> Vector {
    v.map(|value| value * factor)
}

/// Length of a vector.
#[must_use]
pub fn norm(v: &Vector) -> f64 {
    let [x, y, z] = v;
    libm::sqrt(x * x + y * y + z * z)
}

/// The rotation `b` followed by the rotation `a`.
#[must_use]
pub fn product(a: &Quaternion, b: &Quaternion) -> Quaternion {
    let ([aw, ax, ay, az], [bw, bx, by, bz]) = (a, b);
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// The inverse rotation.
#[must_use]
pub fn conjugate(q: &Quaternion) -> Quaternion {
    let [w, x, y, z] = *q;
    [w, -x, -y, -z]
}

/// The vector `v` rotated by `q`.
#[must_use]
pub fn rotate(q: &Quaternion, v: &Vector) -> Vector {
    let [x, y, z] = *v;
    let [_, x, y, z] = product(&product(q, &[0.0, x, y, z]), &conjugate(q));
    [x, y, z]
}

/// The rotation vector of the shorter rotation: axis times angle in radians.
#[must_use]
pub fn rotation_vector(q: &Quaternion) -> Vector {
    let [w, x, y, z] = if q.first().is_some_and(|w| *w < 0.0) { q.map(|v| -v) } else { *q };
    let axis = [x, y, z];
    let sine = norm(&axis);
    // The sine of a smaller angle equals the angle in `f64`.
    let factor = if sine > 1e-12 { 2.0 * libm::atan2(sine, w) / sine } else { 2.0 };
    scaled(&axis, factor)
}

/// The rotation of a rotation vector: axis times angle in radians.
#[must_use]
pub fn from_rotation_vector(v: &Vector) -> Quaternion {
    let angle = norm(v);
    let factor = if angle > 1e-12 { libm::sin(angle / 2.0) / angle } else { 0.5 };
    let [x, y, z] = scaled(v, factor);
    [libm::cos(angle / 2.0), x, y, z]
}

/// The rotation by `x`, then `y`, then `z` degrees about the fixed axes x, y, z: ABB's ZYX Euler angles.
#[must_use]
pub fn from_euler(euler: Vector) -> Quaternion {
    let [x, y, z] = euler.map(f64::to_radians);
    let about = |v: Vector| from_rotation_vector(&v);
    product(&about([0.0, 0.0, z]), &product(&about([0.0, y, 0.0]), &about([x, 0.0, 0.0])))
}

fn normalised(q: Quaternion) -> Quaternion {
    let length = libm::sqrt(q.iter().map(|v| v * v).sum());
    q.map(|v| v / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Pose> {
        let numbers = prop::array::uniform3(-2000.0_f64..2000.0);
        (numbers, prop::array::uniform3(-1.8_f64..1.8))
            .prop_map(|(position, turn)| Pose { position, orientation: from_rotation_vector(&turn) })
    }

    fn near(a: &Pose, b: &Pose) -> bool {
        let (way, turn) = a.distance(b);
        way < 1e-8 && turn < 1e-9
    }

    proptest! {
        #[test]
        fn inverse_and_displacement_lead_back_and_forth(a in pose(), b in pose()) {
            prop_assert!(near(&a.compose(&a.inverse()), &Pose::IDENTITY));
            prop_assert!(near(&a.moved(&a.way_to(&b)), &b));
            prop_assert!(near(&a.compose(&b).compose(&b.inverse()), &a));
        }

        #[test]
        fn rotation_vectors_come_back(v in prop::array::uniform3(-1.7_f64..1.7)) {
            let back = rotation_vector(&from_rotation_vector(&v));
            prop_assert!(norm(&subtract(&back, &v)) < 1e-12, "{v:?} came back as {back:?}");
        }
    }

    #[test]
    fn euler_angles_turn_about_x_first() {
        // 90 degrees about x turns y to z; the rotation about z does not change that.
        let q = from_euler([90.0, 0.0, 90.0]);
        let y = rotate(&q, &[0.0, 1.0, 0.0]);
        assert!(norm(&subtract(&y, &[0.0, 0.0, 1.0])) < 1e-12, "{y:?}");
    }

    #[test]
    fn invalid_poses_are_refused() {
        assert_eq!(Pose::new([0.0, f64::NAN, 0.0], [1.0, 0.0, 0.0, 0.0]), Err(Error::NotAPose));
        assert_eq!(Pose::new([0.0; 3], [0.5, 0.0, 0.0, 0.0]), Err(Error::NotAPose));
        assert_eq!(Pose::new([0.0; 3], [f64::INFINITY, 0.0, 0.0, 0.0]), Err(Error::NotAPose));
        assert_eq!(Pose::new([0.0; 3], [1.001, 0.0, 0.0, 0.0]), Ok(Pose::IDENTITY));
    }
}
