//! Geometry of a part between two parallel closing faces: fingers or vise jaws.
//!
//! Two rectangular pads face each other along Y. The most nearly parallel face of a box turns towards the pads. Clipped
//! to the pad, it gives the width at which the pads stop, the area where friction acts, and the pose in which the box
//! lies flush.
//!
//! A cylinder along the pads touches each along a line, treated as a narrow strip; V-grooves (the v-gripper) touch it
//! along two lines and align it. A cylinder that stands between the pads is treated as its bounding box.

use rapier3d_f64::math::{Pose, Real, Rotation, Vector};

use crate::solid::Solid;

/// Cosine of 10 degrees: faces within this angle of the pads become flush when the pads close.
const FLUSH_COSINE: Real = 0.984_807_753;
/// Sine of 10 degrees: axes within this angle of the pads become parallel to them.
const FLUSH_SINE: Real = 0.173_648_178;
/// Half the width of the strip that a cylinder touches, in radii: on a flat pad, and between the lines of two grooves.
const STRIP: Real = 0.1;
const GROOVE_STRIP: Real = 0.7;
/// Greatest distance between the axes of a cylinder and of a groove that catches it, in radii.
const CAUGHT: Real = 0.5;
const LEAST_AREA: Real = 6.45e-6; // least contact area that stops a pad, m² (0.01 square inch)

/// The rectangle that each of two pads covers, in the axes of the grip, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pads {
    pub x: [Real; 2],
    pub z: [Real; 2],
    /// Position along X of the common axis of V-grooves along Z; `None` for flat pads.
    pub groove: Option<Real>,
}

/// A part between two pads, in the axes of the grip, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Squeeze {
    pub width: Real,  // when both touch
    pub centre: Real, // of the part, along Y
    pub point: Vector,
    pub area: Real,
    pub span: [Real; 2], // along X and Z
    /// Pose of the part turned so that its face lies on the pads, and moved into the grooves.
    pub flush: Pose,
}

impl Squeeze {
    /// Lever arm of friction about Y: two thirds of the radius of a disc with the touched area.
    #[must_use]
    pub fn friction_arm(&self) -> Real {
        2.0 / 3.0 * libm::sqrt(self.area / core::f64::consts::PI)
    }
}

/// The squeeze of a part at `pose` (in the axes of the grip); `None` if it does not touch the pads.
#[must_use]
pub fn squeeze(pose: &Pose, solid: &Solid, pads: &Pads) -> Option<Squeeze> {
    match solid.cylinder() {
        Some((axis, radius, half_length)) if (pose.rotation * axis).y.abs() <= FLUSH_SINE => {
            squeeze_cylinder(pose, axis, [radius, half_length], pads)
        }
        _ => squeeze_box(pose, solid.half(), pads),
    }
}

/// The squeeze of a cylinder whose axis lies along the pads.
fn squeeze_cylinder(
    pose: &Pose,
    axis: Vector,
    [radius, half_length]: [Real; 2],
    pads: &Pads,
) -> Option<Squeeze> {
    let direction = pose.rotation * axis;
    let caught = pads.groove.filter(|groove| {
        direction.z.abs() >= FLUSH_COSINE && (pose.translation.x - groove).abs() <= CAUGHT * radius
    });
    let (level, strip) = match caught {
        Some(_) => (Vector::Z * direction.z.signum(), GROOVE_STRIP * radius),
        None => (Vector::new(direction.x, 0.0, direction.z).normalize(), STRIP * radius),
    };
    let mut flush = turn_about(pose, &Rotation::from_rotation_arc(direction, level));
    flush.translation.x = caught.unwrap_or(flush.translation.x);
    let [x, z] = [flush.translation.x, flush.translation.z];
    let corner = |along: Real, across: Real| {
        [
            x + level.x * along * half_length + level.z * across * strip,
            z + level.z * along * half_length - level.x * across * strip,
        ]
    };
    let touched = clip(&[corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0), corner(-1.0, 1.0)], pads);
    let (area, centroid) = area_and_centroid(&touched)?;
    (area >= LEAST_AREA).then(|| Squeeze {
        width: 2.0 * radius,
        centre: pose.translation.y,
        point: Vector::new(centroid[0], pose.translation.y, centroid[1]),
        area,
        span: spans(&touched),
        flush,
    })
}

fn squeeze_box(pose: &Pose, half: Vector, pads: &Pads) -> Option<Squeeze> {
    let half = half.to_array();
    let axes = [Vector::X, Vector::Y, Vector::Z].map(|axis| pose.rotation * axis);
    let across = (0..3).max_by(|a, b| axes[*a].y.abs().total_cmp(&axes[*b].y.abs()))?;
    let cosine = axes[across].y;
    let (a, b) = ((across + 1) % 3, (across + 2) % 3);
    let corner = |sa: Real, sb: Real| {
        let at = pose.translation + axes[a] * (sa * half[a]) + axes[b] * (sb * half[b]);
        [at.x, at.z]
    };
    let face = [corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0), corner(-1.0, 1.0)];
    let touched = clip(&face, pads);
    let (area, centroid) = area_and_centroid(&touched)?;
    if area < LEAST_AREA {
        return None;
    }
    let flush = cosine.abs() >= FLUSH_COSINE;
    let width = if flush {
        2.0 * half[across]
    } else {
        2.0 * (0..3).map(|axis| half[axis] * axes[axis].y.abs()).sum::<Real>()
    };
    let turned = if flush {
        let normal = if cosine < 0.0 { -Vector::Y } else { Vector::Y };
        turn_about(pose, &Rotation::from_rotation_arc(axes[across], normal))
    } else {
        *pose
    };
    Some(Squeeze {
        width,
        centre: pose.translation.y,
        point: Vector::new(centroid[0], pose.translation.y, centroid[1]),
        area,
        span: spans(&touched),
        flush: turned,
    })
}

/// Extent of a polygon along its two axes.
fn spans(polygon: &[[Real; 2]]) -> [Real; 2] {
    [0, 1].map(|axis| {
        let values = polygon.iter().map(|p| p[axis]);
        values.clone().fold(Real::NEG_INFINITY, Real::max) - values.fold(Real::INFINITY, Real::min)
    })
}

/// The pose rotated about its own origin, in the axes in which it is given.
fn turn_about(pose: &Pose, turn: &Rotation) -> Pose {
    Pose::from_parts(pose.translation, (*turn * pose.rotation).normalize())
}

/// The intersection of a convex polygon with the rectangle.
fn clip(polygon: &[[Real; 2]], pads: &Pads) -> Vec<[Real; 2]> {
    let bounds = [(0, pads.x[0], 1.0), (0, pads.x[1], -1.0), (1, pads.z[0], 1.0), (1, pads.z[1], -1.0)];
    let mut left = polygon.to_vec();
    for (axis, bound, sign) in bounds {
        let inside = |p: &[Real; 2]| (p[axis] - bound) * sign;
        let mut kept = Vec::with_capacity(8);
        for (index, from) in left.iter().enumerate() {
            let to = &left[(index + 1) % left.len()];
            let (start, end) = (inside(from), inside(to));
            if start >= 0.0 {
                kept.push(*from);
            }
            if (start >= 0.0) != (end >= 0.0) {
                let share = start / (start - end);
                kept.push([from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]);
            }
        }
        left = kept;
    }
    left
}

/// Area and centroid of a polygon; `None` if it has no area.
fn area_and_centroid(polygon: &[[Real; 2]]) -> Option<(Real, [Real; 2])> {
    let (mut twice, mut x, mut z) = (0.0, 0.0, 0.0);
    for (index, from) in polygon.iter().enumerate() {
        let to = polygon[(index + 1) % polygon.len()];
        let cross = from[0] * to[1] - to[0] * from[1];
        twice += cross;
        x += (from[0] + to[0]) * cross;
        z += (from[1] + to[1]) * cross;
    }
    if twice.abs() < 1e-12 {
        return None;
    }
    Some((twice.abs() / 2.0, [x / (3.0 * twice), z / (3.0 * twice)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convert::{inches, metres};

    const FINGERS: Pads = Pads { x: [-0.1397, 0.0], z: [-0.01905, 0.01905], groove: None };

    fn bar() -> Solid {
        Solid::cuboid(Vector::new(metres(0.3125), metres(0.3125), metres(2.0)))
    }

    fn shaft() -> Solid {
        Solid::cylinder_z(metres(0.75), metres(2.0))
    }

    #[test]
    fn gripped_cylinder_has_its_diameter_and_is_levelled() {
        let askew = Pose::new(Vector::new(metres(-1.0), 0.001, 0.0), Vector::new(0.1, 0.0, 0.0));
        let held = squeeze(&askew, &shaft(), &FINGERS).unwrap();
        assert!((inches(held.width) - 1.5).abs() < 1e-9 && held.centre == 0.001);
        assert!((held.flush.rotation * Vector::Z).y.abs() < 1e-12);
        assert!((inches(held.span[1]) - 1.5).abs() < 1e-9, "as long as the pads are wide");
        assert!((inches(held.span[0]) - 0.15).abs() < 1e-9, "a strip");
    }

    #[test]
    fn groove_centres_its_cylinder() {
        let grooved = Pads { groove: Some(metres(-0.60)), ..FINGERS };
        let at = |x: Real| Pose::new(Vector::new(metres(x), 0.0, 0.0), Vector::new(0.05, 0.05, 0.0));
        let held = squeeze(&at(-0.4), &shaft(), &grooved).unwrap();
        assert!((inches(held.flush.translation.x) + 0.60).abs() < 1e-12, "{:?}", held.flush);
        assert!((held.flush.rotation * Vector::Z - Vector::Z).length() < 1e-12);
        let beside = squeeze(&at(-1.4), &shaft(), &grooved).unwrap();
        assert!((inches(beside.flush.translation.x) + 1.4).abs() < 1e-12, "on the flat of the pads");
    }

    #[test]
    fn standing_cylinder_is_a_box() {
        let across = Pose::new(Vector::ZERO, Vector::new(core::f64::consts::FRAC_PI_2, 0.0, 0.0));
        let held = squeeze(&across, &shaft(), &FINGERS).unwrap();
        assert!((inches(held.width) - 4.0).abs() < 1e-9);
    }

    #[test]
    fn fingers_cover_the_area_of_the_manual() {
        // Picked as in LK-GRP-1: finger centre 2.10 in from the centroid, tips 0.20 above the tray (VIII.9.5).
        let part = Pose::from_translation(Vector::new(metres(0.20 - 0.3125), metres(0.1), metres(-2.10)));
        let held = squeeze(&part, &bar(), &FINGERS).unwrap();
        assert!((inches(held.width) - 0.625).abs() < 1e-9);
        assert!((inches(held.span[1]) - 0.65).abs() < 1e-9, "0.65 of the length");
        assert!((inches(held.span[0]) - 0.425).abs() < 1e-9, "0.42 of the height");
        assert!((inches(held.point.z) + 0.425).abs() < 1e-9);
        assert!((held.area - metres(0.65) * metres(0.425)).abs() < 1e-12);
    }

    #[test]
    fn nearly_parallel_face_is_drawn_flush() {
        let turned = Pose::new(Vector::ZERO, Vector::new(0.05, 0.0, 0.0));
        let held = squeeze(&turned, &bar(), &FINGERS).unwrap();
        assert!((inches(held.width) - 0.625).abs() < 1e-9);
        assert!((held.flush.rotation * Vector::Y - Vector::Y).length() < 1e-12);
    }

    #[test]
    fn box_on_its_edges_is_wider_and_is_not_turned() {
        let turned = Pose::new(Vector::ZERO, Vector::new(0.0, 0.0, core::f64::consts::FRAC_PI_4));
        let held = squeeze(&turned, &bar(), &FINGERS).unwrap();
        assert!((inches(held.width) - 0.625 * libm::sqrt(2.0)).abs() < 1e-9);
        assert_eq!(held.flush, turned);
    }

    #[test]
    fn no_part_is_found_outside_the_pads() {
        let part = Pose::from_translation(Vector::new(metres(0.32), 0.0, 0.0));
        assert_eq!(squeeze(&part, &bar(), &FINGERS), None);
    }
}
