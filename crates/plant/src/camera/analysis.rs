//! Analysis of a picture (V.2.1 LOCATE-OBJ): the centroid; for the second picture also the angle and recognition.
//!
//! It uses only the visible points of each part ([`Subject`]), so another process gets equal results. A part that is
//! cut off or half hidden has its centroid off its middle and is not recognised. Parts that touch are one blob.
//!
//! The camera is a pinhole camera. The second picture also measures the outline, which identifies the part. `variation`
//! selects the exposure: too little reflectance hides a part, too much makes it bloom.

use geometry::{
    frame::Vector,
    units::{hundredths, hundredths_of_degree},
};
use interfaces::device::{Picture, VisionRequest, VisionResponse, VisionStatus};
use rcs_core::digest::Digest;
use serde::{Deserialize, Serialize};

use super::Subject;
use crate::{
    convert::METRES_PER_INCH,
    description::{Camera as Description, CellDescription, PartType},
    fingerprint,
    noise::{Noise, Stream},
};

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Pending {
    #[serde(with = "crate::image::record")]
    answer: VisionResponse,
    ticks: u32, // ticks until the answer
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Analysis {
    description: Description,
    noise: Noise,
    pending: Option<Pending>,
    #[serde(with = "crate::image::record")]
    response: VisionResponse,
    last: u32,
}

impl Analysis {
    #[must_use]
    pub fn new(description: &Description, seed: u64) -> Self {
        Self {
            description: description.clone(),
            noise: Noise::new(seed, Stream::Camera),
            pending: None,
            response: VisionResponse::default(),
            last: 0,
        }
    }

    pub(crate) fn reseed(&mut self, seed: u64) {
        self.noise = Noise::new(seed, Stream::Camera);
    }

    /// Fingerprint of the entries on which the answers depend in addition to seed and pictures: the camera, and the
    /// parts with a vision id.
    #[must_use]
    pub fn fingerprint(cell: &CellDescription) -> u64 {
        let known = cell.part.iter().filter(|part| part.vision_id != 0);
        let known: Vec<_> = known.map(|part| (part.vision_id, part.size)).collect();
        let mut bytes = Vec::new();
        fingerprint::append(&(&cell.camera, known), &mut bytes)
            .expect("a description is plain values, which can be written down");
        let mut digest = Digest::new();
        digest.add(&bytes);
        digest.value()
    }

    #[must_use]
    pub fn wants_picture(&self, request: &VisionRequest) -> bool {
        request.number != 0 && request.number != self.last && request.picture != Picture::None
    }

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
        let exposure = self.exposure(request.variation);
        let [darkest, _] = exposure;
        let least = self.description.least_share;
        let lit = |subject: &&Subject| subject.reflectance() >= darkest && subject.share() >= least;
        let bright: Vec<&Subject> = subjects.iter().filter(lit).collect();
        let Some(blob) = self.nearest(&bright) else {
            answer.status = VisionStatus::NothingSeen;
            return answer;
        };
        let centre = blob.iter().map(|subject| subject.centroid()).sum::<Vector>() / blob.len() as f64;
        let expected_range = f64::from(request.range_mm) / 1000.0 / METRES_PER_INCH;
        let scale = if expected_range > 0.0 { expected_range / centre.x } else { 1.0 };
        let precise = request.picture == Picture::Precise;
        let error = if precise { self.description.precise_noise } else { self.description.flood_noise };
        answer.y = hundredths(centre.y * scale + self.noise.within(error));
        answer.z = hundredths(centre.z * scale + self.noise.within(error));
        answer.status = VisionStatus::Done;
        if precise {
            self.recognise(&blob, exposure, scale, request.grip, expected, &mut answer);
        }
        answer
    }

    /// Result of a second picture in addition to the centroid: the angle, and whether the part is the requested one.
    fn recognise(
        &mut self,
        blob: &[&Subject],
        [_, brightest]: [f64; 2],
        scale: f64,
        grip: i16,
        expected: Option<&PartType>,
        answer: &mut VisionResponse,
    ) {
        let Some(subject) = blob.first() else { return };
        let bloom = if subject.reflectance() > brightest { self.description.bloom } else { 0.0 };
        let noise = self.description.shape_noise;
        let measured = subject.lengths().map(|length| length * scale + bloom + self.noise.within(noise));
        let turn = self.noise.within(self.description.angle_noise.to_radians());
        answer.angle = grip_angle(&subject.face().edges, grip, turn);
        let missed = self.fails();
        let known = expected.filter(|part| looks_like(part, measured, self.description.shape_tolerance));
        match known {
            Some(part) if blob.len() == 1 && !missed => answer.recognised = Some(part.vision_id),
            _ => answer.status = VisionStatus::NotRecognised,
        }
    }

    fn fails(&mut self) -> bool {
        let chance = self.description.failure;
        chance > 0.0 && (self.noise.within(1.0) + 1.0) / 2.0 < chance
    }

    /// Least and greatest reflectance that a variation exposes correctly; the variations repeat.
    fn exposure(&self, variation: u8) -> [f64; 2] {
        let exposures = &self.description.exposures;
        exposures.get(usize::from(variation) % exposures.len().max(1)).copied().unwrap_or([0.0, 1.0])
    }

    /// The subject nearest to the optical axis, and those in one blob with it.
    fn nearest<'s>(&self, subjects: &[&'s Subject]) -> Option<Vec<&'s Subject>> {
        let away = |subject: &Subject| {
            let centre = subject.centroid();
            libm::hypot(centre.y, centre.z)
        };
        let first = subjects.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let gap = self.description.resolution;
        let others =
            subjects.iter().filter(|other| !std::ptr::eq(**other, *first) && first.touches(other, gap));
        Some([first].into_iter().chain(others).copied().collect())
    }
}

/// Right-hand roll about X, 0.01 degree, that turns Y onto the edge to grip across: for grip 1 the longer one
/// (VII.7.6).
fn grip_angle(edges: &[(Vector, f64); 2], grip: i16, noise: f64) -> i32 {
    let [first, second] = edges;
    let widest = grip.unsigned_abs() == 1;
    let (across, _) = if (first.1 > second.1) == widest { first } else { second };
    let angle = hundredths_of_degree(libm::atan2(across.z, across.y) + noise);
    // An edge has no direction, so the roll of less than a quarter turn is chosen.
    let folded = angle.rem_euclid(18_000);
    if folded > 9_000 { folded - 18_000 } else { folded }
}

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
    use crate::camera::{Face, Optics};
    use geometry::{
        frame::{Frame, rotation_by},
        movetable::{Movetable, MovetableLine, System, straight_down},
    };

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap()
    }

    fn optics() -> Optics {
        Optics::new(&cell().camera)
    }

    fn gr_pic() -> Movetable {
        let line = |system, values| MovetableLine { system, values };
        Movetable::from_lines(&[line(System::Tool, [-1468, 0, -252]), line(System::ToolOrigin, [-300, 0, 0])])
            .unwrap()
    }

    fn bar(y: f64, z: f64, roll: f64) -> Subject {
        let place = straight_down(Vector::new(-50.75, 10.25, -16.55));
        let part =
            place.shifted(Vector::new(-0.3125, y, z)).turned(&rotation_by(&Vector::new(roll, 0.0, 0.0)));
        let view = optics().frame(&gr_pic().apply(&place));
        seen(&view.inverse().compose(&part), Vector::new(0.625, 0.625, 4.0), 0.5)
    }

    fn seen(frame: &Frame, size: Vector, reflectance: f64) -> Subject {
        let optics = optics();
        Subject::new(Face::of(frame, &size), reflectance, |point| optics.has_in_view(&point))
    }

    fn ask(picture: Picture, grip: i16, subjects: &[Subject]) -> VisionResponse {
        vary(picture, grip, subjects, 0)
    }

    fn vary(picture: Picture, grip: i16, subjects: &[Subject], variation: u8) -> VisionResponse {
        let mut analysis = Analysis::new(&cell().camera, 1);
        let request = VisionRequest { number: 3, picture, object_id: 17, grip, range_mm: 590, variation };
        assert!(analysis.wants_picture(&request));
        analysis.expose(&request, subjects, cell().part("LINKBAR1_BH"));
        assert!(!analysis.wants_picture(&request));
        for _ in 0..40 {
            let answer = analysis.answer();
            assert_eq!(answer.echo, 3);
            if answer.status != VisionStatus::Busy {
                return answer;
            }
        }
        panic!("no answer");
    }

    #[test]
    fn optical_axis_points_at_the_place() {
        let place = straight_down(Vector::new(-50.75, 10.25, -16.55));
        let camera = optics().frame(&gr_pic().apply(&place));
        let seen = camera.inverse().compose(&place);
        assert!((seen.position.x * 25.4 - 605.0).abs() < 0.2, "range {} mm", seen.position.x * 25.4);
        assert!(seen.position.y.abs() < 1e-9 && seen.position.z.abs() < 0.01, "{seen:?}");
        assert!((seen.x() - Vector::x()).norm() < 1e-9, "straight down");
    }

    #[test]
    fn flood_picture_is_coarse_and_second_picture_exact() {
        let flood = ask(Picture::FastFlood, 2, &[bar(1.5, -0.75, 0.6)]);
        assert_eq!((flood.status, flood.recognised), (VisionStatus::Done, None));
        assert!((flood.y - 150).abs() <= 6 && (flood.z + 75).abs() <= 6, "{flood:?}");
        let precise = ask(Picture::Precise, 2, &[bar(0.03, -0.02, 0.6)]);
        assert_eq!((precise.status, precise.recognised), (VisionStatus::Done, Some(17)));
        assert!((precise.y - 3).abs() <= 1 && (precise.z + 2).abs() <= 1, "{precise:?}");
        assert!((precise.angle - 3438).abs() <= 12, "across the width: {precise:?}");
        let along = ask(Picture::Precise, 1, &[bar(0.0, 0.0, 0.6)]);
        assert!((along.angle - (3438 - 9000)).abs() <= 12, "across the length: {along:?}");
    }

    #[test]
    fn empty_picture_and_unknown_part_are_distinguished() {
        assert_eq!(ask(Picture::FastFlood, 2, &[]).status, VisionStatus::NothingSeen);
        assert_eq!(ask(Picture::FastFlood, 2, &[bar(7.0, 0.0, 0.0)]).status, VisionStatus::NothingSeen);
        let stranger = seen(&before(), Vector::new(0.625, 2.0, 2.0), 0.5);
        assert_eq!(ask(Picture::Precise, 2, &[stranger]).status, VisionStatus::NotRecognised);
    }

    #[test]
    fn part_nearest_to_the_axis_is_selected() {
        let near = ask(Picture::FastFlood, 2, &[bar(3.0, 0.0, 0.0), bar(-1.0, 0.0, 0.0)]);
        assert!((near.y + 100).abs() <= 6, "{near:?}");
    }

    fn before() -> Frame {
        Frame { position: Vector::new(23.54, 0.0, 0.0), ..Frame::identity() }
    }

    #[test]
    fn bar_cut_by_the_edge_is_found_but_not_recognised() {
        // Its far third is outside the picture.
        let cut = bar(0.0, 4.6, 0.0);
        let flood = ask(Picture::FastFlood, 2, &[bar(0.0, 4.6, 0.0)]);
        assert_eq!(flood.status, VisionStatus::Done);
        assert!((350..=430).contains(&flood.z), "{flood:?}");
        assert_eq!(ask(Picture::Precise, 2, &[cut]).status, VisionStatus::NotRecognised);
        assert_eq!(ask(Picture::FastFlood, 2, &[bar(0.0, 6.9, 0.0)]).status, VisionStatus::NothingSeen);
    }

    #[test]
    fn touching_parts_are_one_blob() {
        let pair = |gap: f64| {
            let half = (0.625 + gap) / 2.0;
            [bar(half, 0.0, 0.0), bar(-half, 0.0, 0.0)]
        };
        let together = ask(Picture::Precise, 2, &pair(0.02));
        assert_eq!(together.status, VisionStatus::NotRecognised);
        assert!(together.y.abs() <= 1, "in the middle of both: {together:?}");
        assert_eq!(ask(Picture::Precise, 2, &pair(0.5)).recognised, Some(17));
    }

    #[test]
    fn variations_show_different_ranges_of_light() {
        let bar = |reflectance| seen(&before(), Vector::new(0.625, 0.625, 4.0), reflectance);
        let ask = |picture, reflectance, variation| vary(picture, 2, &[bar(reflectance)], variation).status;
        let (flood, precise) = (Picture::FastFlood, Picture::Precise);
        use VisionStatus::{Done, NotRecognised, NothingSeen};
        assert_eq!([0, 1, 2].map(|v| ask(flood, 0.08, v)), [NothingSeen, Done, NothingSeen], "dark");
        assert_eq!([0, 1, 2].map(|v| ask(precise, 0.08, v)), [NothingSeen, Done, NothingSeen]);
        assert_eq!([0, 1, 2].map(|v| ask(flood, 0.95, v)), [Done; 3], "shiny");
        assert_eq!([0, 1, 2].map(|v| ask(precise, 0.95, v)), [NotRecognised, NotRecognised, Done]);
        assert_eq!([0, 3].map(|v| ask(precise, 0.5, v)), [Done; 2]);
        assert_eq!(ask(precise, 0.01, 1), NothingSeen, "too dark for all");
    }

    #[test]
    fn recognition_fails_with_its_probability() {
        let mut description = cell().camera;
        description.failure = 0.25;
        let mut analysis = Analysis::new(&description, 1);
        let bar = [seen(&before(), Vector::new(0.625, 0.625, 4.0), 0.5)];
        let (cell, mut failed) = (cell(), 0);
        for number in 1..=400 {
            let picture = Picture::Precise;
            let request =
                VisionRequest { number, picture, object_id: 17, grip: 2, range_mm: 590, variation: 0 };
            let answer = analysis.analyse(&request, &bar, cell.part("LINKBAR1_BH"));
            failed += u32::from(answer.status == VisionStatus::NotRecognised);
        }
        assert!((70..130).contains(&failed), "{failed} of 400");
    }

    #[test]
    fn fingerprint_changes_only_with_the_answers() {
        let known = Analysis::fingerprint(&cell());
        let changed = |change: fn(&mut CellDescription)| {
            let mut cell = cell();
            change(&mut cell);
            Analysis::fingerprint(&cell) != known
        };
        assert!(changed(|cell| cell.camera.failure = 0.5));
        assert!(changed(|cell| cell.camera.exposures.truncate(1)));
        assert!(changed(|cell| cell.part[0].size[1] += 0.001));
        assert!(!changed(|cell| cell.part[0].weight += 1.0));
        assert!(!changed(|cell| cell.vise.speed += 1.0));
    }
}
