//! From a picture to a part frame (V.2.1 LOCATE-OBJ).
//!
//! A view movetable leads from a place to the tool frame from which the camera looks at it. Undone, it leads
//! from the tool frame at which a picture was taken to the place in the middle of the picture; no other
//! mounting data of the camera is needed. Vision answers in the axes of that place.

use rcs_core::{
    frame::{Frame, Rotation, Vector},
    interface::{
        device::{Picture, VisionRequest, VisionResponse},
        emove::EmoveCommand,
    },
    units::{inches, radians},
};
use taskdata::files::{MovtabId, TaskData, VisionId, VisionPara};

/// View parameters that a command names (VII.7.6).
#[must_use]
pub fn view_of<'a>(command: &EmoveCommand, data: &TaskData<'a>) -> Option<&'a VisionPara> {
    data.vision_para(VisionId::new(command.object_vision))
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
