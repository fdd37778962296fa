//! Parts in front of the camera: for each part its face towards the camera, as a raster of visible and hidden points.

use geometry::frame::{Frame, Vector};

/// Points of the raster along an edge of a face; odd, so that one is in the middle.
pub const RASTER: usize = 9;

/// A part in front of the camera, in camera axes: X along the optical axis, Y the tool's Y; inches.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    face: Face,
    reflectance: f64, // Reflectance: the fraction of the light that it reflects
    seen: Vec<bool>,  // the visible points of the raster, row by row
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    pub centre: Vector,
    /// Directions and lengths of its two edges.
    pub edges: [(Vector, f64); 2],
}

impl Face {
    /// The face of a part, from its frame (camera axes) and its size.
    #[must_use]
    pub fn of(frame: &Frame, size: &Vector) -> Self {
        let axes = [frame.x(), frame.y(), frame.z()];
        let sizes: [f64; 3] = (*size).into();
        let along = (0..3).max_by(|a, b| axes[*a].x.abs().total_cmp(&axes[*b].x.abs())).unwrap_or(0);
        let towards = -axes[along] * axes[along].x.signum();
        let (a, b) = ((along + 1) % 3, (along + 2) % 3);
        Self {
            centre: frame.position + towards * (sizes[along] / 2.0),
            edges: [(axes[a], sizes[a]), (axes[b], sizes[b])],
        }
    }

    /// The points of the raster, row by row: the centres of equal fields.
    pub fn points(&self) -> impl Iterator<Item = Vector> + use<> {
        let Self { centre, edges: [(a, long), (b, wide)] } = *self;
        let step = |index: usize| (2 * index + 1) as f64 / (2 * RASTER) as f64 - 0.5;
        (0..RASTER).flat_map(move |row| {
            (0..RASTER).map(move |column| centre + a * (long * step(row)) + b * (wide * step(column)))
        })
    }
}

impl Subject {
    /// A face of which the points for which `sees` returns true are visible.
    pub fn new(face: Face, reflectance: f64, sees: impl FnMut(Vector) -> bool) -> Self {
        Self { face, reflectance, seen: face.points().map(sees).collect() }
    }

    /// A face of which the points with a set bit are visible: bit n is the nth point of the raster, row by row.
    #[must_use]
    pub fn from_raster(face: Face, reflectance: f64, raster: u128) -> Self {
        let seen = (0..RASTER * RASTER).map(|point| raster >> point & 1 == 1).collect();
        Self { face, reflectance, seen }
    }

    /// The visible points, as the bits of [`Subject::from_raster`].
    #[must_use]
    pub fn raster(&self) -> u128 {
        self.seen.iter().rev().fold(0, |bits, seen| bits << 1 | u128::from(*seen))
    }

    #[must_use]
    pub const fn face(&self) -> &Face {
        &self.face
    }

    /// Reflectance: the fraction of the light that it reflects.
    #[must_use]
    pub const fn reflectance(&self) -> f64 {
        self.reflectance
    }

    #[must_use]
    pub fn share(&self) -> f64 {
        self.seen.iter().filter(|seen| **seen).count() as f64 / self.seen.len() as f64
    }

    fn seen_points(&self) -> impl Iterator<Item = Vector> {
        self.face.points().zip(&self.seen).filter(|(_, seen)| **seen).map(|(point, _)| point)
    }

    /// The corners of the fields whose centres are visible.
    fn seen_corners(&self) -> impl Iterator<Item = Vector> {
        let [a, b] = self.face.edges.map(|(edge, length)| edge * (length / (2 * RASTER) as f64));
        self.seen_points().flat_map(move |point| [a + b, a - b, b - a, -a - b].map(|corner| point + corner))
    }

    #[must_use]
    pub fn centroid(&self) -> Vector {
        let count = self.seen.iter().filter(|seen| **seen).count();
        if count == self.seen.len() || count == 0 {
            return self.face.centre;
        }
        self.seen_points().sum::<Vector>() / count as f64
    }

    /// Lengths of the visible area along the two edges.
    #[must_use]
    pub fn lengths(&self) -> [f64; 2] {
        let along = |index: fn(usize) -> usize| {
            let seen = || self.seen.iter().enumerate().filter(|(_, seen)| **seen).map(|(at, _)| index(at));
            match (seen().min(), seen().max()) {
                (Some(first), Some(last)) => (last - first + 1) as f64 / RASTER as f64,
                _ => 0.0,
            }
        };
        let [(_, long), (_, wide)] = self.face.edges;
        [long * along(|at| at / RASTER), wide * along(|at| at % RASTER)]
    }

    /// True if, along the rays of the camera, a point is on the visible area of this face or within `gap` of it.
    fn covers(&self, point: &Vector, gap: f64) -> bool {
        let on_face = *point * (self.face.centre.x / point.x);
        self.seen_points().any(|field| {
            let reach = |length: f64| length / (2 * RASTER) as f64 + gap;
            let mut edges = self.face.edges.iter();
            edges.all(|(edge, length)| (on_face - field).dot(edge).abs() <= reach(*length))
        })
    }

    /// True if this part and another are one blob in the picture: their visible areas are within `gap` of each other.
    #[must_use]
    pub fn touches(&self, other: &Self, gap: f64) -> bool {
        self.seen_corners().any(|point| other.covers(&point, gap))
            || other.seen_corners().any(|point| self.covers(&point, gap))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate of 4 by 2 in, in front of the camera at 20 in, of which only some points are visible.
    fn plate(y: f64, z: f64, sees: impl FnMut(Vector) -> bool) -> Subject {
        let frame = Frame { position: Vector::new(20.5, y, z), ..Frame::identity() };
        Subject::new(Face::of(&frame, &Vector::new(1.0, 4.0, 2.0)), 0.5, sees)
    }

    #[test]
    fn visible_face_has_its_middle_and_lengths() {
        let subject = plate(1.0, -2.0, |_| true);
        assert_eq!((subject.share(), subject.lengths()), (1.0, [4.0, 2.0]));
        assert_eq!(subject.centroid(), Vector::new(20.0, 1.0, -2.0));
    }

    #[test]
    fn occluded_end_shifts_the_centre_and_shortens_the_face() {
        let subject = plate(0.0, 0.0, |point| point.y < 0.7);
        let [long, wide] = subject.lengths();
        assert!((long - 4.0 * 6.0 / 9.0).abs() < 1e-12 && wide == 2.0, "{long} {wide}");
        let centroid = subject.centroid();
        assert!((centroid.y + 4.0 / 6.0).abs() < 1e-12 && centroid.z.abs() < 1e-12, "{centroid:?}");
        assert!((subject.share() - 6.0 / 9.0).abs() < 1e-12);
        let hidden = plate(0.0, 0.0, |_| false);
        assert_eq!((hidden.share(), hidden.lengths()), (0.0, [0.0, 0.0]));
    }

    #[test]
    fn subject_round_trips_through_its_raster() {
        let subject = plate(1.0, -2.0, |point| point.y + 2.0 * point.z < -3.0);
        assert!((0.2..0.8).contains(&subject.share()), "{}", subject.share());
        let again = Subject::from_raster(*subject.face(), subject.reflectance(), subject.raster());
        assert_eq!(again, subject);
        assert_eq!(plate(0.0, 0.0, |_| true).raster(), (1 << 81) - 1);
    }

    #[test]
    fn neighbours_without_a_visible_gap_are_one_blob() {
        let subject = plate(0.0, 0.0, |_| true);
        assert!(subject.touches(&plate(3.9, 0.0, |_| true), 0.05));
        assert!(!subject.touches(&plate(4.4, 0.0, |_| true), 0.05));
        assert!(!subject.touches(&plate(3.9, 0.0, |_| false), 0.0), "a hidden part is not part of a blob");
    }
}
