//! The camera on the wrist and its picture analysis (V.2.1 LOCATE-OBJ, VII.7.6).
//!
//! The picture is taken in the tick of the request (a line-flash and a flood-flash box); the analysis answers some ticks
//! later. A part is seen if the middle of the face that looks at the camera lies in the field of view and nothing stands
//! before it. Positions are what a pinhole camera makes of them: a part that is nearer than the expected range looks
//! larger and farther from the axis. The second picture also measures the outline, and by that recognises the part.

use rcs_core::{
    frame::{Frame, Rotation, Vector},
    interface::device::{Picture, VisionRequest, VisionResponse, VisionStatus},
    units::{hundredths, hundredths_of_degree},
};
use serde::{Deserialize, Serialize};

use crate::{
    convert::{METRES_PER_INCH, inches},
    description::{Camera as Description, PartType},
    noise::Noise,
};

/// A part before the camera, in camera axes: X along the optical axis, Y the tool's Y; inches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// The part's frame.
    pub frame: Frame,
    /// The part's size.
    pub size: Vector,
}

/// The face of a part that looks at the camera.
struct Face {
    centre: Vector,
    /// Directions and lengths of its two edges.
    edges: [(Vector, f64); 2],
    height: f64,
}

impl Subject {
    fn face(&self) -> Face {
        let axes = [self.frame.x(), self.frame.y(), self.frame.z()];
        let sizes: [f64; 3] = self.size.into();
        let along = (0..3).max_by(|a, b| axes[*a].x.abs().total_cmp(&axes[*b].x.abs())).unwrap_or(0);
        let towards = -axes[along] * axes[along].x.signum();
        let (a, b) = ((along + 1) % 3, (along + 2) % 3);
        Face {
            centre: self.frame.position + towards * (sizes[along] / 2.0),
            edges: [(axes[a], sizes[a]), (axes[b], sizes[b])],
            height: sizes[along],
        }
    }

    /// The middle of the face that looks at the camera, camera axes, in.
    #[must_use]
    pub fn surface(&self) -> Vector {
        self.face().centre
    }
}

/// An answer that is being worked out.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct Pending {
    #[serde(with = "crate::image::record")]
    answer: VisionResponse,
    /// Until it is there.
    ticks: u32,
}

/// The camera and the analysis.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Camera {
    description: Description,
    noise: Noise,
    pending: Option<Pending>,
    #[serde(with = "crate::image::record")]
    response: VisionResponse,
    last: u32,
}

impl Camera {
    /// A camera that was not asked anything.
    #[must_use]
    pub fn new(description: &Description, noise: Noise) -> Self {
        Self {
            description: description.clone(),
            noise,
            pending: None,
            response: VisionResponse::default(),
            last: 0,
        }
    }

    /// Frame of the camera on the given tool frame: origin in the image plane, X along the optical axis, Y the tool's Y.
    #[must_use]
    pub fn frame(&self, tool: &Frame) -> Frame {
        let tilt = Rotation::from_axis_angle(&Vector::y_axis(), self.description.tilt.to_radians());
        tool.shifted(Vector::from(self.description.position)).turned(&tilt)
    }

    /// True if `request` is a new one, for which a picture must be taken.
    #[must_use]
    pub fn wants_picture(&self, request: &VisionRequest) -> bool {
        request.number != 0 && request.number != self.last && request.picture != Picture::None
    }

    /// Take the picture of a new request; `subjects` are the parts that nothing hides.
    pub fn expose(&mut self, request: &VisionRequest, subjects: &[Subject], expected: Option<&PartType>) {
        self.last = request.number;
        let answer = self.analyse(request, subjects, expected);
        let ticks = match request.picture {
            Picture::Precise => self.description.precise_ticks,
            Picture::FastFlood | Picture::None => self.description.flood_ticks,
        };
        self.pending = Some(Pending { answer, ticks });
        self.response =
            VisionResponse { echo: request.number, status: VisionStatus::Busy, ..VisionResponse::default() };
    }

    /// The answer as it stands at the end of a tick.
    pub fn answer(&mut self) -> VisionResponse {
        match &mut self.pending {
            Some(Pending { answer, ticks }) if *ticks <= 1 => {
                self.response = *answer;
                self.pending = None;
            }
            Some(Pending { ticks, .. }) => *ticks -= 1,
            None => {}
        }
        self.response
    }

    fn analyse(
        &mut self,
        request: &VisionRequest,
        subjects: &[Subject],
        expected: Option<&PartType>,
    ) -> VisionResponse {
        let mut answer = VisionResponse { echo: request.number, ..VisionResponse::default() };
        let Some(face) = self.nearest(subjects) else {
            answer.status = VisionStatus::NothingSeen;
            return answer;
        };
        let expected_range = f64::from(request.range_mm) / 1000.0 / METRES_PER_INCH;
        let scale = if expected_range > 0.0 { expected_range / face.centre.x } else { 1.0 };
        let precise = request.picture == Picture::Precise;
        let error = if precise { self.description.precise_noise } else { self.description.flood_noise };
        answer.y = hundredths(face.centre.y * scale + self.noise.within(error));
        answer.z = hundredths(face.centre.z * scale + self.noise.within(error));
        answer.status = VisionStatus::Done;
        if precise {
            let measured = face
                .edges
                .map(|(_, length)| length * scale + self.noise.within(self.description.shape_noise));
            let turn = self.noise.within(self.description.angle_noise.to_radians());
            answer.angle = grip_angle(&face.edges, request.grip, turn);
            match expected {
                Some(part) if looks_like(part, measured, self.description.shape_tolerance) => {
                    answer.recognised = part.vision_id;
                }
                _ => answer.status = VisionStatus::NotRecognised,
            }
        }
        answer
    }

    /// The face in the field of view that is nearest to the optical axis.
    fn nearest(&self, subjects: &[Subject]) -> Option<Face> {
        let widest = self.description.view / (inches(self.description.reference_range_mm / 1000.0));
        let faces = subjects.iter().map(Subject::face).filter(|face| {
            let limit = widest * face.centre.x;
            face.centre.x > 0.0
                && face.centre.y.abs() <= limit
                && face.centre.z.abs() <= limit
                && face.height > 0.0
        });
        let away = |face: &Face| libm::hypot(face.centre.y, face.centre.z);
        faces.min_by(|a, b| away(a).total_cmp(&away(b)))
    }
}

/// Right-hand roll about X, 0.01 degree, that brings Y onto the edge to grip across: the longer for grip 1, else the
/// shorter (VII.7.6).
fn grip_angle(edges: &[(Vector, f64); 2], grip: i16, noise: f64) -> i32 {
    let [first, second] = edges;
    let widest = grip.unsigned_abs() == 1;
    let (across, _) = if (first.1 > second.1) == widest { first } else { second };
    let angle = hundredths_of_degree(libm::atan2(across.z, across.y) + noise);
    // An edge has no direction: the roll of less than a quarter turn is wanted.
    let folded = angle.rem_euclid(18_000);
    if folded > 9_000 { folded - 18_000 } else { folded }
}

/// True if the two measured lengths are those of a face of the part.
fn looks_like(part: &PartType, measured: [f64; 2], tolerance: f64) -> bool {
    let [x, y, z] = part.size;
    let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
    let [first, second] = measured;
    [(x, y), (y, z), (x, z)]
        .iter()
        .any(|(a, b)| (near(first, *a) && near(second, *b)) || (near(first, *b) && near(second, *a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{description::CellDescription, noise::Stream};
    use rcs_core::{
        frame::rotation_by,
        movetable::{Line, Movetable, System, straight_down},
    };

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap()
    }

    fn camera() -> Camera {
        Camera::new(&cell().camera, Noise::new(1, Stream::Camera))
    }

    /// GR-PIC of the cell proposal.
    fn gr_pic() -> Movetable {
        let line = |system, values| Line { system, values };
        Movetable::from_lines(&[line(System::Tool, [-1468, 0, -252]), line(System::ToolOrigin, [-300, 0, 0])])
            .unwrap()
    }

    /// A bar on the place, seen from the view point above it.
    fn bar(y: f64, z: f64, roll: f64) -> Subject {
        let place = straight_down(Vector::new(-50.75, 10.25, -16.55));
        let part =
            place.shifted(Vector::new(-0.3125, y, z)).turned(&rotation_by(&Vector::new(roll, 0.0, 0.0)));
        let view = camera().frame(&gr_pic().apply(&place));
        Subject { frame: view.inverse().compose(&part), size: Vector::new(0.625, 0.625, 4.0) }
    }

    fn ask(picture: Picture, grip: i16, subjects: &[Subject]) -> VisionResponse {
        let mut camera = camera();
        let request = VisionRequest { number: 3, picture, object_id: 17, grip, range_mm: 590, variation: 0 };
        assert!(camera.wants_picture(&request));
        camera.expose(&request, subjects, cell().part("LINKBAR1_BH"));
        assert!(!camera.wants_picture(&request));
        for _ in 0..40 {
            let answer = camera.answer();
            assert_eq!(answer.echo, 3);
            if answer.status != VisionStatus::Busy {
                return answer;
            }
        }
        panic!("no answer");
    }

    #[test]
    fn the_optical_axis_points_at_the_place() {
        let place = straight_down(Vector::new(-50.75, 10.25, -16.55));
        let camera = camera().frame(&gr_pic().apply(&place));
        let seen = camera.inverse().compose(&place);
        assert!((seen.position.x * 25.4 - 605.0).abs() < 0.2, "range {} mm", seen.position.x * 25.4);
        assert!(seen.position.y.abs() < 1e-9 && seen.position.z.abs() < 0.01, "{seen:?}");
        assert!((seen.x() - Vector::x()).norm() < 1e-9, "straight down");
    }

    #[test]
    fn the_flood_is_coarse_and_the_second_picture_exact() {
        let flood = ask(Picture::FastFlood, 2, &[bar(1.5, -0.75, 0.6)]);
        assert_eq!((flood.status, flood.recognised), (VisionStatus::Done, 0));
        assert!((flood.y - 150).abs() <= 6 && (flood.z + 75).abs() <= 6, "{flood:?}");
        let precise = ask(Picture::Precise, 2, &[bar(0.03, -0.02, 0.6)]);
        assert_eq!((precise.status, precise.recognised), (VisionStatus::Done, 17));
        assert!((precise.y - 3).abs() <= 1 && (precise.z + 2).abs() <= 1, "{precise:?}");
        assert!((precise.angle - 3438).abs() <= 12, "across the width: {precise:?}");
        let along = ask(Picture::Precise, 1, &[bar(0.0, 0.0, 0.6)]);
        assert!((along.angle - (3438 - 9000)).abs() <= 12, "across the length: {along:?}");
    }

    #[test]
    fn nothing_and_strangers_are_told_apart() {
        assert_eq!(ask(Picture::FastFlood, 2, &[]).status, VisionStatus::NothingSeen);
        assert_eq!(ask(Picture::FastFlood, 2, &[bar(7.0, 0.0, 0.0)]).status, VisionStatus::NothingSeen);
        let stranger = Subject { size: Vector::new(0.625, 2.0, 2.0), ..bar(0.0, 0.0, 0.0) };
        assert_eq!(ask(Picture::Precise, 2, &[stranger]).status, VisionStatus::NotRecognised);
    }

    #[test]
    fn the_part_nearest_to_the_axis_is_meant() {
        let near = ask(Picture::FastFlood, 2, &[bar(3.0, 0.0, 0.0), bar(-1.0, 0.0, 0.0)]);
        assert!((near.y + 100).abs() <= 6, "{near:?}");
    }
}
