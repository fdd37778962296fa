//! Draws the picture of the wrist camera, with the answer of the vision system.
//!
//! It shows the faces that vision evaluated ([`crate::camera::Subject`]), tool Y to the left and tool Z up. The part in
//! the answer is green if recognised, else yellow. The cross marks the centroid, its line the motion of the fingers. A
//! red border means that no part was found.

use crate::{
    camera::{Face, Subject, subject::RASTER},
    convert::inches,
    description::Camera,
};
use geometry::frame::Vector;
use interfaces::device::{VisionResponse, VisionStatus};
use png::{ColorType, Compression, Encoder, EncodingError};

const SIZE: usize = 160; // width and height of the picture, pixels
/// Palette: index 0 is the background, 1 to 11 are greys from dark to bright, then the colours of the marks.
const GREYS: u8 = 11;
const FOUND: u8 = GREYS + 1;
const DOUBT: u8 = GREYS + 2;
const NOTHING: u8 = GREYS + 3;

struct Canvas {
    pixels: Vec<u8>,
    widest: f64, // half the width of the field of view, divided by the distance
}

impl Canvas {
    fn place(&self, point: &Vector) -> [f64; 2] {
        let half = SIZE as f64 / 2.0;
        let scale = half / (self.widest * point.x.max(1e-3));
        [half - point.y * scale, half - point.z * scale]
    }

    fn dot(&mut self, [x, y]: [f64; 2], colour: u8) {
        let inside = |value: f64| (0.0..SIZE as f64).contains(&value);
        if inside(x) && inside(y) {
            self.pixels[y as usize * SIZE + x as usize] = colour;
        }
    }

    fn line(&mut self, [ax, ay]: [f64; 2], [bx, by]: [f64; 2], colour: u8) {
        let steps = ((bx - ax).abs().max((by - ay).abs()).min(4.0 * SIZE as f64) * 2.0) as usize + 1;
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let (x, y) = (ax + (bx - ax) * share, ay + (by - ay) * share);
            [[x, y], [x + 1.0, y], [x, y + 1.0]].into_iter().for_each(|point| self.dot(point, colour));
        }
    }

    /// Draws a face: each visible cell of its raster, as dense points.
    fn face(&mut self, subject: &Subject) {
        const FINE: usize = 12;
        let colour = 1 + (subject.reflectance().clamp(0.0, 1.0) * f64::from(GREYS - 1)).round() as u8;
        let [a, b] = subject.face().edges.map(|(edge, length)| edge * (length / RASTER as f64));
        let step = |index: usize| (index as f64 + 0.5) / FINE as f64 - 0.5;
        let seen = subject.raster();
        for (_, middle) in subject.face().points().enumerate().filter(|(at, _)| seen >> at & 1 == 1) {
            for (row, column) in (0..FINE).flat_map(|row| (0..FINE).map(move |column| (row, column))) {
                self.dot(self.place(&(middle + a * step(row) + b * step(column))), colour);
            }
        }
    }

    fn outline(&mut self, face: &Face, colour: u8) {
        let [a, b] = face.edges.map(|(edge, length)| edge * (length / 2.0));
        let corners = [a + b, a - b, -a - b, b - a].map(|corner| self.place(&(face.centre + corner)));
        (0..4).for_each(|i| self.line(corners[i], corners[(i + 1) % 4], colour));
    }
}

/// The picture of an answer as a PNG file. `subjects` are the visible faces at the time of the request.
#[must_use]
pub fn draw(camera: &Camera, subjects: &[Subject], answer: &VisionResponse) -> Vec<u8> {
    let widest = camera.view / inches(camera.reference_range_mm / 1000.0);
    let mut canvas = Canvas { pixels: vec![0; SIZE * SIZE], widest };
    subjects.iter().for_each(|subject| canvas.face(subject));
    let off_axis = |subject: &&Subject| {
        let centre = subject.centroid();
        centre.y.abs() + centre.z.abs()
    };
    let found = subjects.iter().min_by(|a, b| off_axis(a).total_cmp(&off_axis(b)));
    match (answer.status, found) {
        (VisionStatus::Done | VisionStatus::NotRecognised, Some(subject)) => {
            let colour = if answer.recognised.is_some() { FOUND } else { DOUBT };
            canvas.outline(subject.face(), colour);
            if answer.status == VisionStatus::Done {
                cross(&mut canvas, subject, answer, colour);
            }
        }
        _ => {
            let far = SIZE as f64 - 2.0;
            let corners = [[0.0, 0.0], [far, 0.0], [far, far], [0.0, far]];
            (0..4).for_each(|i| canvas.line(corners[i], corners[(i + 1) % 4], NOTHING));
        }
    }
    let mut palette = vec![[0x22, 0x3A, 0x55]];
    palette.extend((0..GREYS).map(|grey| [60 + 18 * grey; 3]));
    palette.extend([[0x3C, 0xE0, 0x78], [0xFF, 0xC8, 0x2E], [0xE0, 0x3C, 0x3C]]);
    png(&canvas.pixels, &palette).unwrap_or_default()
}

fn png(pixels: &[u8], palette: &[[u8; 3]]) -> Result<Vec<u8>, EncodingError> {
    let (mut file, side) = (Vec::new(), SIZE as u32);
    let mut encoder = Encoder::new(&mut file, side, side);
    encoder.set_color(ColorType::Indexed);
    encoder.set_palette(palette.as_flattened());
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(file)
}

/// Draws the centroid of an answer and the direction in which the fingers close.
fn cross(canvas: &mut Canvas, subject: &Subject, answer: &VisionResponse, colour: u8) {
    const ARM: f64 = 7.0;
    let hundredths = |value: i32| f64::from(value) / 100.0;
    let middle = Vector::new(subject.face().centre.x, hundredths(answer.y), hundredths(answer.z));
    let [x, y] = canvas.place(&middle);
    canvas.line([x - ARM, y], [x + ARM, y], colour);
    canvas.line([x, y - ARM], [x, y + ARM], colour);
    if answer.recognised.is_some() {
        let angle = hundredths(answer.angle).to_radians();
        let along = Vector::new(0.0, libm::cos(angle), libm::sin(angle)) * 1.5;
        let ends = [canvas.place(&(middle + along)), canvas.place(&(middle - along))];
        canvas.line(ends[0], ends[1], DOUBT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CellDescription;
    use geometry::frame::Frame;

    fn bar() -> Subject {
        let frame = Frame { position: Vector::new(23.54, 1.0, 0.0), ..Frame::identity() };
        Subject::new(Face::of(&frame, &Vector::new(0.625, 0.625, 4.0)), 0.5, |_| true)
    }

    fn picture(subjects: &[Subject], answer: &VisionResponse) -> Vec<u8> {
        let cell = CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap();
        draw(&cell.camera, subjects, answer)
    }

    #[test]
    fn picture_is_small_and_shows_the_answer() {
        let found =
            VisionResponse { status: VisionStatus::Done, y: 100, recognised: Some(17), ..Default::default() };
        let doubt = VisionResponse { status: VisionStatus::NotRecognised, ..Default::default() };
        let nothing = VisionResponse { status: VisionStatus::NothingSeen, ..Default::default() };
        let pictures = [picture(&[bar()], &found), picture(&[bar()], &doubt), picture(&[], &nothing)];
        for (i, one) in pictures.iter().enumerate() {
            assert!(one.len() < 4_000, "{} bytes", one.len());
            assert!(pictures[..i].iter().all(|other| other != one), "each answer looks otherwise");
        }
    }

    #[test]
    fn png_has_the_pixels_and_the_palette() {
        let mut pixels = vec![0; SIZE * SIZE];
        pixels[3 * SIZE + 7] = 2;
        let palette = [[1, 2, 3], [4, 5, 6], [7, 8, 9]];
        let file = png(&pixels, &palette).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        assert_eq!(reader.info().palette.as_deref(), Some(palette.as_flattened()));
        let mut read = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut read).unwrap();
        assert_eq!((frame.width, frame.height, frame.color_type), (160, 160, ColorType::Indexed));
        assert!(read == pixels, "the pixels are read as they were written");
    }

    #[test]
    fn left_of_the_tool_is_left_in_the_picture() {
        let camera = CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap().camera;
        let widest = camera.view / inches(camera.reference_range_mm / 1000.0);
        let canvas = Canvas { pixels: vec![0; SIZE * SIZE], widest };
        let [x, y] = canvas.place(&Vector::new(inches(0.605), 5.25, 0.0));
        assert!(x.abs() < 1e-6 && (y - 80.0).abs() < 1e-6, "the edge of the field of view: {x} {y}");
        assert!(canvas.place(&Vector::new(20.0, 0.0, 1.0))[1] < 80.0, "Z is up");
    }
}
