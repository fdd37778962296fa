//! Position and field of view of the camera.

use geometry::frame::{Frame, Rotation, Vector};
use serde::{Deserialize, Serialize};

use crate::{convert::inches, description::Camera as Description};

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Optics {
    description: Description,
}

impl Optics {
    #[must_use]
    pub fn new(description: &Description) -> Self {
        Self { description: description.clone() }
    }

    /// Frame of the camera for a tool frame: origin in the image plane, X along the optical axis, Y the tool's Y.
    #[must_use]
    pub fn frame(&self, tool: &Frame) -> Frame {
        let tilt = Rotation::from_axis_angle(&Vector::y_axis(), self.description.tilt.to_radians());
        tool.shifted(Vector::from(self.description.position)).turned(&tilt)
    }

    /// True if a point (camera axes, in) is in the field of view.
    #[must_use]
    pub fn has_in_view(&self, point: &Vector) -> bool {
        let widest = self.description.view / inches(self.description.reference_range_mm / 1000.0);
        let limit = widest * point.x;
        point.x > 0.0 && point.y.abs() <= limit && point.z.abs() <= limit
    }
}
