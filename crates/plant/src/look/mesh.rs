//! Closed solids of triangles, in inches, and the functions that build them.
//!
//! Each piece is closed and has one material; pieces may overlap. Nearly all pieces are lofts: rings with equal numbers
//! of points, joined by quadrangles, with caps.

use core::f64::consts::{PI, TAU};

use geometry::frame::{Frame, Rotation, Vector};

use crate::scene::Material;

/// Faces that meet at a smaller angle than this are shaded as one surface: the cosine of 63 degrees.
const CREASE: f64 = 0.454;
/// Points of a circle large enough to show its corners.
pub const ROUND: usize = 24;
pub const SMALL: usize = 10;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    pub position: Vector, // inches
    pub normal: Vector,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    pub material: Material,
    pub triangles: Vec<[Vector; 3]>, // Triangles, counter-clockwise as seen from outside, inches
}

impl Piece {
    /// The corners of the triangles with their normals. Surfaces that meet at a crease have separate normals.
    #[must_use]
    pub fn corners(&self) -> Vec<[Corner; 3]> {
        let key = |point: &Vector| point.map(|value| (value * 1e4).round());
        let mut around: Vec<([f64; 3], Vector)> = Vec::with_capacity(3 * self.triangles.len());
        for triangle in &self.triangles {
            let normal = doubled_area(triangle);
            around.extend(triangle.iter().map(|point| (key(point).into(), normal)));
        }
        around.sort_by(|(a, _), (b, _)| {
            a.iter()
                .zip(b)
                .map(|(a, b)| a.total_cmp(b))
                .find(|order| order.is_ne())
                .unwrap_or(core::cmp::Ordering::Equal)
        });
        let at = |point: &Vector| {
            let wanted: [f64; 3] = key(point).into();
            let before = |other: &[f64; 3]| {
                let order =
                    other.iter().zip(wanted).map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
                order.unwrap_or(core::cmp::Ordering::Equal)
            };
            let start = around.partition_point(|(other, _)| before(other).is_lt());
            let end = around.partition_point(|(other, _)| before(other).is_le());
            &around[start..end]
        };
        let corners = self.triangles.iter().map(|triangle| {
            let own = unit(&doubled_area(triangle));
            triangle.map(|position| {
                let near = at(&position).iter().map(|(_, normal)| normal);
                let sum: Vector = near.filter(|normal| unit(normal).dot(&own) > CREASE).sum();
                Corner { position, normal: unit(&sum) }
            })
        });
        corners.collect()
    }
}

/// Normal of a triangle; its length is twice the triangle's area.
fn doubled_area([a, b, c]: &[Vector; 3]) -> Vector {
    (b - a).cross(&(c - a))
}

fn unit(v: &Vector) -> Vector {
    let length = libm::sqrt(v.dot(v));
    if length > 0.0 { v / length } else { Vector::x() }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pieces: Vec<Piece>,
}

impl Mesh {
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    #[must_use]
    pub fn triangles(&self) -> usize {
        self.pieces.iter().map(|piece| piece.triangles.len()).sum()
    }

    pub fn add(&mut self, frame: &Frame, other: &Self) {
        let at = |point: &Vector| frame.shifted(*point).position;
        self.pieces.extend(other.pieces.iter().map(|piece| Piece {
            material: piece.material,
            triangles: piece.triangles.iter().map(|triangle| [0, 1, 2].map(|i| at(&triangle[i]))).collect(),
        }));
    }

    /// Adds a loft of rings with equal numbers of points, each convex and counter-clockwise as seen from the next.
    pub fn loft(&mut self, material: Material, rings: &[Vec<Vector>]) {
        let mut triangles = Vec::new();
        let mut face = |a: Vector, b: Vector, c: Vector| {
            if doubled_area(&[a, b, c]).norm_squared() > 1e-16 {
                triangles.push([a, b, c]);
            }
        };
        for pair in rings.windows(2) {
            let [low, high] = pair else { continue };
            for (i, j) in (0..low.len()).map(|i| (i, (i + 1) % low.len())) {
                face(low[i], low[j], high[j]);
                face(low[i], high[j], high[i]);
            }
        }
        if let (Some(first), Some(last)) = (rings.first(), rings.last()) {
            for i in 1..first.len().saturating_sub(1) {
                face(first[0], first[i + 1], first[i]);
                face(last[0], last[i], last[i + 1]);
            }
        }
        self.pieces.push(Piece { material, triangles });
    }

    /// Adds a box between two corners, with chamfered edges.
    pub fn cuboid(&mut self, material: Material, low: [f64; 3], high: [f64; 3], chamfer: f64) {
        let c = (0..3).map(|i| (high[i] - low[i]) / 4.0).fold(chamfer, f64::min);
        let ring = |z: f64, inset: f64| {
            let [x0, y0, x1, y1] = [low[0] + inset, low[1] + inset, high[0] - inset, high[1] - inset];
            if c <= 0.0 {
                return vec![(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)];
            }
            let cut = c - inset;
            vec![
                (x0 + cut, y0, z),
                (x1 - cut, y0, z),
                (x1, y0 + cut, z),
                (x1, y1 - cut, z),
                (x1 - cut, y1, z),
                (x0 + cut, y1, z),
                (x0, y1 - cut, z),
                (x0, y0 + cut, z),
            ]
        };
        let points =
            |ring: Vec<(f64, f64, f64)>| ring.into_iter().map(|(x, y, z)| Vector::new(x, y, z)).collect();
        let rings = if c <= 0.0 {
            vec![ring(low[2], 0.0), ring(high[2], 0.0)]
        } else {
            vec![ring(low[2], c), ring(low[2] + c, 0.0), ring(high[2] - c, 0.0), ring(high[2], c)]
        };
        let rings: Vec<Vec<Vector>> = rings.into_iter().map(points).collect();
        self.loft(material, &rings);
    }

    pub fn block(&mut self, material: Material, middle: [f64; 3], size: [f64; 3], chamfer: f64) {
        let low = [0, 1, 2].map(|i| middle[i] - size[i] / 2.0);
        let high = [0, 1, 2].map(|i| middle[i] + size[i] / 2.0);
        self.cuboid(material, low, high, chamfer);
    }

    /// Adds a solid of revolution from pairs of distance along the line and radius. The polygon of `points` corners
    /// circumscribes the circle.
    pub fn lathe(
        &mut self,
        material: Material,
        from: [f64; 3],
        to: [f64; 3],
        points: usize,
        profile: &[(f64, f64)],
    ) {
        let (from, axis) = (Vector::from(from), unit(&(Vector::from(to) - Vector::from(from))));
        let (across, up) = across(&axis);
        let around = 1.0 / libm::cos(PI / count(points));
        let ring = |(along, radius): &(f64, f64)| -> Vec<Vector> {
            let point = |i: usize| {
                let angle = TAU * (count(i) + 0.5) / count(points);
                let out = across * libm::cos(angle) + up * libm::sin(angle);
                from + axis * *along + out * (radius * around)
            };
            (0..points).map(point).collect()
        };
        let rings: Vec<Vec<Vector>> = profile.iter().map(ring).collect();
        self.loft(material, &rings);
    }

    /// Adds a cylinder from one point to another, with chamfered edges.
    pub fn rod(
        &mut self,
        material: Material,
        from: [f64; 3],
        to: [f64; 3],
        radius: f64,
        chamfer: f64,
        points: usize,
    ) {
        let length = (Vector::from(to) - Vector::from(from)).norm();
        let c = chamfer.min(length / 4.0).min(radius / 2.0);
        let profile = [(0.0, radius - c), (c, radius), (length - c, radius), (length, radius - c)];
        let profile = if c > 0.0 { &profile[..] } else { &[(0.0, radius), (length, radius)] };
        self.lathe(material, from, to, points, profile);
    }

    /// Adds a hose: a smooth curve through the given points.
    pub fn hose(&mut self, material: Material, through: &[[f64; 3]], radius: f64) {
        const STEPS: usize = 5;
        const POINTS: usize = 7;
        let knots: Vec<Vector> = through.iter().copied().map(Vector::from).collect();
        let knot = |i: usize, back: usize| knots[(i + 1).saturating_sub(back).min(knots.len() - 1)];
        let mut path = Vec::new();
        for i in 0..knots.len().saturating_sub(1) {
            let [a, b, c, d] = [knot(i, 2), knot(i, 1), knot(i + 1, 1), knot(i + 2, 1)];
            path.extend((0..STEPS).map(|step| {
                let t = count(step) / count(STEPS);
                (b * 2.0
                    + (c - a) * t
                    + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t)
                    + (b * 3.0 - a - c * 3.0 + d) * (t * t * t))
                    / 2.0
            }));
        }
        path.extend(knots.last());
        let mut side = Vector::zeros();
        let rings = (0..path.len()).map(|i| {
            let along = unit(&(path[(i + 1).min(path.len() - 1)] - path[i.saturating_sub(1)]));
            // The cross section is carried along without twist about the hose.
            side -= along * side.dot(&along);
            side = if side.norm_squared() < 1e-6 { across(&along).0 } else { unit(&side) };
            let up = along.cross(&side);
            let point = |k: usize| {
                let angle = TAU * count(k) / count(POINTS);
                path[i] + (side * libm::cos(angle) + up * libm::sin(angle)) * radius
            };
            (0..POINTS).map(point).collect()
        });
        let rings: Vec<Vec<Vector>> = rings.collect();
        self.loft(material, &rings);
    }

    /// Adds a plate: a convex polygon, counter-clockwise in x and y of `frame`, between two heights.
    pub fn plate(&mut self, material: Material, frame: &Frame, outline: &[(f64, f64)], from: f64, to: f64) {
        let ring =
            |z: f64| outline.iter().map(|(x, y)| frame.shifted(Vector::new(*x, *y, z)).position).collect();
        self.loft(material, &[ring(from), ring(to)]);
    }
}

#[must_use]
pub fn count(n: usize) -> f64 {
    u32::try_from(n).map_or(f64::MAX, f64::from)
}

/// Two unit vectors perpendicular to an axis; the axis and the two form a right-handed system.
fn across(axis: &Vector) -> (Vector, Vector) {
    let other = if axis.x.abs() < 0.9 { Vector::x() } else { Vector::y() };
    let first = unit(&axis.cross(&other));
    (first, axis.cross(&first))
}

/// A rectangle with rounded corners, from its half width and half height, as a ring in the plane `x` that faces +X.
#[must_use]
pub fn rounded(x: f64, half: [f64; 2], radius: f64) -> Vec<Vector> {
    const STEPS: usize = 5;
    let radius = radius.min(half[0]).min(half[1]);
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let corner = |(quarter, (y, z)): (usize, (f64, f64))| {
        (0..STEPS).map(move |step| {
            let angle = (count(quarter) + count(step) / count(STEPS - 1)) * PI / 2.0;
            let (middle_y, middle_z) = (y * (half[0] - radius), z * (half[1] - radius));
            Vector::new(x, middle_y + radius * libm::cos(angle), middle_z + radius * libm::sin(angle))
        })
    };
    corners.into_iter().enumerate().flat_map(corner).collect()
}

#[must_use]
pub fn standing(position: [f64; 3], degrees: f64) -> Frame {
    Frame {
        position: Vector::from(position),
        rotation: Rotation::from_axis_angle(&Vector::z_axis(), degrees.to_radians()),
    }
}
