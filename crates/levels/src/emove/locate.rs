//! From a picture to a part frame (V.2.1 LOCATE-OBJ).
//!
//! A view movetable leads from a place to the tool frame from which the camera looks at it. Its inverse leads from the
//! tool frame at which a picture was taken to the place in the middle of the picture; no other mounting data of the
//! camera is needed. Vision answers in the axes of that place.

use geometry::{
    frame::{Frame, Rotation, Vector},
    units::{inches, radians},
};
use interfaces::{
    device::{Picture, VisionRequest, VisionResponse},
    emove::EmoveCommand,
};
use taskdata::files::{MovtabId, TaskData, VisionId, VisionPara};

/// Millimetres in an inch: vision's range is in millimetres (VII.7.6).
const MM_PER_INCH: f64 = 25.4;

/// View parameters that a command names (VII.7.6).
#[must_use]
pub fn view_of<'a>(command: &EmoveCommand, data: &TaskData<'a>) -> Option<&'a VisionPara> {
    data.vision_para(VisionId::from_option(command.object_vision))
}

/// The place in the middle of a picture taken with the tool at `tool`.
#[must_use]
pub fn looked_at(tool: &Frame, view: MovtabId, data: &TaskData<'_>) -> Frame {
    data.movetable(view).map_or(*tool, |movetable| movetable.unapply(tool))
}

/// The place moved to the centroid that vision reports.
#[must_use]
pub fn centred(place: &Frame, seen: &VisionResponse) -> Frame {
    place.shifted(Vector::new(0.0, inches(seen.y), inches(seen.z)))
}

/// The part frame: at the centroid, turned so that tool Y lies across the dimension to grip.
#[must_use]
pub fn part_frame(place: &Frame, seen: &VisionResponse) -> Frame {
    centred(place, seen).turned(&Rotation::from_axis_angle(&Vector::x_axis(), radians(seen.angle)))
}

/// Half a turn about the tool's X changes nothing for two fingers: no answer needs more than a quarter, 0.01
/// degree.
const QUARTER_TURN: u32 = 9_000;

/// False if no picture can show what vision answers: then the arm must not be sent there. The centroid lies
/// at most half the expected range beside the optical axis (ASSUMED: as with a lens of 53 degrees), and the
/// roll is within a quarter turn.
#[must_use]
pub fn is_plausible(request: &VisionRequest, answer: &VisionResponse) -> bool {
    let widest = f64::from(request.range_mm) / (2.0 * MM_PER_INCH);
    let inside = |hundredths: i32| inches(hundredths).abs() <= widest;
    inside(answer.y) && inside(answer.z) && answer.angle.unsigned_abs() <= QUARTER_TURN
}

/// A finger of any gripper: 0.50 in thick along the tool's Y (ASSUMED), and 1.50 in wide along its Z (VIII.9.5).
const FINGER: [f64; 2] = [0.50, 1.50];

/// True if the fingers, open by `opening` in at the tool frame `grip`, stay within the array of their `sector`: half a
/// step from the middle of its outer sectors stands the wall of the tray (VIII.6). `out` are the steps out of the
/// array, in, in the axes of the sector.
#[must_use]
pub fn stays_in_array(sector: &Frame, grip: &Frame, opening: f64, out: &[Option<Vector>]) -> bool {
    let axes = sector.rotation.inverse();
    let aside = axes * (grip.position - sector.position);
    let [across, along] = [axes * grip.y(), axes * grip.z()];
    let [thick, wide] = FINGER;
    let [reach, half_wide] = [opening / 2.0 + thick, wide / 2.0];
    out.iter().flatten().all(|step| {
        let farthest = aside.dot(step) + reach * across.dot(step).abs() + half_wide * along.dot(step).abs();
        farthest <= step.dot(step) / 2.0
    })
}

/// True if vision has recognised another object than the requested one (V.2.1: recognition is part of the second
/// picture).
#[must_use]
pub fn is_another(request: &VisionRequest, answer: &VisionResponse) -> bool {
    request.picture == Picture::Precise && answer.recognised != Some(request.object_id)
}

/// A request for a picture.
#[must_use]
pub fn request(number: u32, picture: Picture, variation: u8, view: &VisionPara) -> VisionRequest {
    VisionRequest {
        number,
        picture,
        object_id: u16::try_from(view.id).unwrap_or(0),
        grip: i16::try_from(view.grip).unwrap_or(0),
        range_mm: u16::try_from(view.range).unwrap_or(0),
        variation,
    }
}
