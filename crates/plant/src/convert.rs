//! Inches to metres and back: the only place where the cell's units become SI (docs/design/units.md "Cell").

use geometry::frame::{Frame, Vector};
use nalgebra::{Matrix3, Rotation3};
use rapier3d_f64::math::{Pose, Real, Rotation, Vector as Metres};
use rapier3d_f64::parry::glamx::DMat3;

pub const METRES_PER_INCH: f64 = 0.0254;
pub const NEWTONS_PER_POUND: f64 = 4.448_221_615_260_5;
pub const KILOGRAMS_PER_POUND: f64 = 0.453_592_37;
pub const GRAVITY: f64 = 9.806_65;

#[must_use]
pub const fn metres(inches: f64) -> Real {
    inches * METRES_PER_INCH
}

#[must_use]
pub const fn inches(metres: Real) -> f64 {
    metres / METRES_PER_INCH
}

#[must_use]
pub const fn newtons(pounds: f64) -> Real {
    pounds * NEWTONS_PER_POUND
}

#[must_use]
pub fn to_metres(v: &Vector) -> Metres {
    Metres::new(metres(v.x), metres(v.y), metres(v.z))
}

#[must_use]
pub fn to_inches(v: Metres) -> Vector {
    Vector::new(inches(v.x), inches(v.y), inches(v.z))
}

#[must_use]
pub fn to_pose(frame: &Frame) -> Pose {
    let axis = |v: Vector| Metres::new(v.x, v.y, v.z);
    let columns = DMat3::from_cols(axis(frame.x()), axis(frame.y()), axis(frame.z()));
    Pose::from_parts(to_metres(&frame.position), Rotation::from_mat3(&columns).normalize())
}

#[must_use]
pub fn to_frame(pose: &Pose) -> Frame {
    let axis = |v: Metres| {
        let turned = pose.rotation * v;
        Vector::new(turned.x, turned.y, turned.z)
    };
    let columns = [axis(Metres::X), axis(Metres::Y), axis(Metres::Z)];
    Frame {
        position: to_inches(pose.translation),
        rotation: Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns)),
    }
}

/// The quaternion of the same rotation with the sign that makes it nearer to `near`.
#[must_use]
pub fn on_the_side_of(near: &Rotation, rotation: Rotation) -> Rotation {
    if near.dot(rotation) < 0.0 { -rotation } else { rotation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::frame::rotation_by;

    #[test]
    fn frame_round_trips_through_metres() {
        let frame = Frame {
            position: Vector::new(68.0, -44.0, -4.0),
            rotation: rotation_by(&Vector::new(0.3, -2.0, 1.1)),
        };
        let distance = to_frame(&to_pose(&frame)).distance(&frame);
        assert!(distance.inches < 1e-12 && distance.radians < 1e-12, "{distance:?}");
    }

    #[test]
    fn inch_is_exactly_25_4_mm() {
        assert_eq!(metres(1.0), 0.0254);
        assert!((newtons(1.0) - KILOGRAMS_PER_POUND * GRAVITY).abs() < 1e-12);
    }
}
