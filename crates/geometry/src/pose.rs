//! Poses: nine integers, the wrist, tool and finger points in hundredths of an inch (VII.1).

use core::fmt;

use rcs_core::Plain;

use crate::{
    frame::{Frame, Vector, norm, rotation_from_x_y},
    units::{hundredths, inches},
};

/// Length of the vectors wrist to tool and tool to finger: 3000 counts (IV.3.3 step 11).
pub const POINT_DISTANCE: f64 = 30.0;

/// A pose as task data gives it: three points in world coordinates, hundredths of an inch (VII.1).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Pose {
    /// A point on the axis of the end effector.
    pub wrist: [i32; 3],
    /// The centre of the distal end of the end effector.
    pub tool: [i32; 3],
    /// A point along a radial vector out from the tool point.
    pub finger: [i32; 3],
}

/// VI.1.2 frame-command-in: tool point, 0.01 in, and two vectors of length 3000.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct WireFrame {
    /// Tool point, 0.01 in.
    pub tool: [i32; 3],
    /// Wrist to tool point, length 3000.
    pub wrist_to_tool: [i32; 3],
    /// Tool to finger point, length 3000.
    pub tool_to_finger: [i32; 3],
}

/// Errors of converting nine integers to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseError {
    /// Wrist and tool point, or tool and finger point, coincide, or all three points lie on a line.
    NoDirection,
}

impl fmt::Display for PoseError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("wrist, tool and finger points must be three points that are not on one line")
    }
}

impl core::error::Error for PoseError {}

#[inline]
fn vector(point: [i32; 3]) -> Vector {
    let [x, y, z] = point;
    Vector::new(inches(x), inches(y), inches(z))
}

#[inline]
fn point(v: &Vector) -> [i32; 3] {
    [hundredths(v.x), hundredths(v.y), hundredths(v.z)]
}

impl Pose {
    /// The three points of a frame, each rounded to 0.01 in.
    #[must_use]
    #[inline]
    pub fn from_frame(frame: &Frame) -> Self {
        Self {
            wrist: point(&(frame.position - frame.x() * POINT_DISTANCE)),
            tool: point(&frame.position),
            finger: point(&(frame.position + frame.y() * POINT_DISTANCE)),
        }
    }

    /// X from wrist to tool, Y towards the finger point, perpendicular to X. Errors: the points span no frame.
    #[inline]
    pub fn to_frame(&self) -> Result<Frame, PoseError> {
        let (wrist, tool, finger) = (vector(self.wrist), vector(self.tool), vector(self.finger));
        let rotation = rotation_from_x_y(&(tool - wrist), &(finger - tool)).ok_or(PoseError::NoDirection)?;
        Ok(Frame { position: tool, rotation })
    }

    /// The angle of the two directions minus 90 degrees, radians. Errors: two of the points coincide.
    #[inline]
    pub fn off_square(&self) -> Result<f64, PoseError> {
        let x = vector(self.tool) - vector(self.wrist);
        let y = vector(self.finger) - vector(self.tool);
        let lengths = norm(&x) * norm(&y);
        if lengths > 0.0 {
            Ok(-libm::asin((x.dot(&y) / lengths).clamp(-1.0, 1.0)))
        } else {
            Err(PoseError::NoDirection)
        }
    }
}

impl WireFrame {
    /// A frame rounded to RCS-II/T3 format.
    #[must_use]
    #[inline]
    pub fn from_frame(frame: &Frame) -> Self {
        Self {
            tool: point(&frame.position),
            wrist_to_tool: point(&(frame.x() * POINT_DISTANCE)),
            tool_to_finger: point(&(frame.y() * POINT_DISTANCE)),
        }
    }

    /// Tool point in inches, and rotation. Errors: [`PoseError::NoDirection`] if the vectors do not span a frame.
    #[inline]
    pub fn to_frame(&self) -> Result<Frame, PoseError> {
        let rotation = rotation_from_x_y(&vector(self.wrist_to_tool), &vector(self.tool_to_finger))
            .ok_or(PoseError::NoDirection)?;
        Ok(Frame { position: vector(self.tool), rotation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOOL_TRNS: Pose =
        Pose { wrist: [6497, -2366, 1569], tool: [9495, -2475, 1595], finger: [9523, -1460, -1228] };

    #[test]
    fn tool_trns_is_off_square_by_0_637_degrees() {
        assert!((TOOL_TRNS.off_square().unwrap().to_degrees() - 0.637).abs() < 0.001);
        assert_eq!(Pose::from_frame(&TOOL_TRNS.to_frame().unwrap()).tool, TOOL_TRNS.tool);
    }

    #[test]
    fn home_in_rcs_format_is_the_manuals() {
        // IV.3.3 step 11: within 4 counts.
        let home = Pose { wrist: [0, -5022, 636], tool: [0, -7145, -1483], finger: [3000, -7145, -1483] };
        let wire = WireFrame::from_frame(&home.to_frame().unwrap());
        assert_eq!(wire.tool, [0, -7145, -1483]);
        for (found, printed) in wire.wrist_to_tool.iter().zip([0, -2123, -2119]) {
            assert!((found - printed).abs() <= 4, "{found} for {printed}");
        }
        assert_eq!(wire.tool_to_finger, [3000, 0, 0]);
    }

    #[test]
    fn three_points_on_a_line_are_not_a_pose() {
        let flat = Pose { wrist: [0, 0, 0], tool: [100, 0, 0], finger: [200, 0, 0] };
        assert_eq!(flat.to_frame(), Err(PoseError::NoDirection));
        assert_eq!(Pose::default().to_frame(), Err(PoseError::NoDirection));
    }
}
