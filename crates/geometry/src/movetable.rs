//! Movetables (VII.2): each line acts in the frame that results from the lines before it.

use core::f64::consts::FRAC_PI_2;

use rcs_core::Plain;

use crate::{
    frame::{Frame, Rotation, Vector},
    pose::POINT_DISTANCE,
    units::{inches, radians},
};

/// Greatest number of lines in a movetable (VII.2).
pub const MAX_LINES: usize = 8;

/// Coordinate systems of Table VII.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum System {
    /// No line.
    #[text = ""]
    None,
    /// `rw` x, y, z: translate in world coordinates.
    #[text = "rw"]
    World,
    /// `t` x, y, z: translate in tool coordinates.
    #[text = "t"]
    Tool,
    /// `to` pit, yaw: rotate about the tool point.
    #[text = "to"]
    ToolOrigin,
    /// `wo` pit, yaw: rotate about the wrist point.
    #[text = "wo"]
    WristOrigin,
    /// `ro` roll: rotate about the end effector axis.
    #[text = "ro"]
    Roll,
}

/// A line of a movetable: values in 0.01 in or 0.01 degree.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct MovetableLine {
    /// Coordinate system of the values.
    pub system: System,
    /// x, y, z; or pitch, yaw; or roll.
    pub values: [i32; 3],
}

/// A movetable: its lines in order; lines after the last have [`System::None`].
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Movetable {
    /// The lines.
    pub lines: [MovetableLine; MAX_LINES],
}

impl MovetableLine {
    /// Apply the line to a frame.
    #[must_use]
    #[inline]
    pub fn apply(&self, frame: &Frame) -> Frame {
        let [a, b, c] = self.values;
        match self.system {
            System::None => *frame,
            System::World => {
                Frame { position: frame.position + Vector::new(inches(a), inches(b), inches(c)), ..*frame }
            }
            System::Tool => frame.shifted(Vector::new(inches(a), inches(b), inches(c))),
            System::ToolOrigin => frame.turned(&pitch_yaw(a, b)),
            System::WristOrigin => {
                let back = Vector::new(-POINT_DISTANCE, 0.0, 0.0);
                frame.shifted(back).turned(&pitch_yaw(a, b)).shifted(-back)
            }
            System::Roll => frame.turned(&Rotation::from_axis_angle(&Vector::x_axis(), radians(a))),
        }
    }
}

/// Pitch about tool Y, then yaw about the new tool Z (the order is ASSUMED, SPECNOTES).
#[inline]
fn pitch_yaw(pitch: i32, yaw: i32) -> Rotation {
    Rotation::from_axis_angle(&Vector::y_axis(), radians(pitch))
        * Rotation::from_axis_angle(&Vector::z_axis(), radians(yaw))
}

impl Movetable {
    /// `None` for more than [`MAX_LINES`] lines.
    #[must_use]
    #[inline]
    pub fn from_lines(lines: &[MovetableLine]) -> Option<Self> {
        let mut table = Self::default();
        table.lines.get_mut(..lines.len())?.copy_from_slice(lines);
        Some(table)
    }

    /// Apply all lines to a frame, in order.
    #[must_use]
    #[inline]
    pub fn apply(&self, frame: &Frame) -> Frame {
        self.lines.iter().fold(*frame, |f, line| line.apply(&f))
    }

    /// The frame that `apply` turns into `frame`, such as the place that a camera at `frame` looks at.
    #[must_use]
    #[inline]
    pub fn unapply(&self, frame: &Frame) -> Frame {
        self.lines.iter().rev().fold(*frame, |f, line| line.unapply(&f))
    }
}

impl MovetableLine {
    /// Finds the frame that this line turns into `frame`.
    #[must_use]
    #[inline]
    fn unapply(&self, frame: &Frame) -> Frame {
        let [a, b, c] = self.values;
        match self.system {
            System::None => *frame,
            System::World => {
                Frame { position: frame.position - Vector::new(inches(a), inches(b), inches(c)), ..*frame }
            }
            System::Tool => frame.shifted(-Vector::new(inches(a), inches(b), inches(c))),
            System::ToolOrigin => frame.turned(&pitch_yaw(a, b).inverse()),
            System::WristOrigin => {
                let back = Vector::new(-POINT_DISTANCE, 0.0, 0.0);
                frame.shifted(back).turned(&pitch_yaw(a, b).inverse()).shifted(-back)
            }
            System::Roll => frame.turned(&Rotation::from_axis_angle(&Vector::x_axis(), -radians(a))),
        }
    }
}

/// A tool frame that points straight down, with tool Y along world -Y, as over a tray at -X of the robot.
#[must_use]
#[inline]
pub fn straight_down(position: Vector) -> Frame {
    let down = Rotation::from_axis_angle(&Vector::y_axis(), FRAC_PI_2);
    Frame { position, rotation: Rotation::from_axis_angle(&Vector::z_axis(), core::f64::consts::PI) * down }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(system: System, values: [i32; 3]) -> MovetableLine {
        MovetableLine { system, values }
    }

    #[test]
    fn the_vise_is_approached_with_x_in_y_left_z_up() {
        // LK-GRP-FX1 (VIII.9.5) on PFIX-P, level along +X.
        let fixture = Frame { position: Vector::new(68.0, -44.0, -4.0), rotation: Rotation::identity() };
        let grip = Movetable::from_lines(&[
            line(System::Tool, [15, 19, 100]),
            line(System::ToolOrigin, [-300, 0, 0]),
        ]);
        let at = grip.unwrap().apply(&fixture);
        assert!((at.position - Vector::new(68.15, -43.81, -3.0)).norm() < 1e-12);
        // Up by 3 degrees: the body leans back.
        assert!((at.x().z - libm::sin(radians(300))).abs() < 1e-12);
    }

    #[test]
    fn world_translation_does_not_turn_with_the_tool() {
        let over = straight_down(Vector::new(-66.5, -5.5, -14.0));
        let up = line(System::World, [0, 0, 1000]).apply(&over);
        assert!((up.position.z - -4.0).abs() < 1e-12);
        let back = line(System::Tool, [-1000, 0, 0]).apply(&over);
        assert!((back.position - up.position).norm() < 1e-12);
    }

    #[test]
    fn rolled_trays_keep_their_order() {
        // VIII.11: after a roll of -90 degrees, +Y points along the former -Z.
        let tray = Frame::identity();
        let rolled = line(System::Roll, [-9000, 0, 0]).apply(&tray);
        assert!((rolled.y() - Vector::new(0.0, 0.0, -1.0)).norm() < 1e-12);
    }

    proptest! {
        #[test]
        fn unapply_undoes_apply(
            lines in prop::collection::vec(
                (1_u8..6, -18_000_i32..18_000, -9000_i32..9000, -9000_i32..9000),
                0..=8,
            ),
            x in -90.0_f64..90.0,
            angle in -3.0_f64..3.0,
        ) {
            let lines: Vec<MovetableLine> = lines.into_iter()
                .map(|(s, a, b, c)| line(System::from_code(s).unwrap(), [a, b, c])).collect();
            let table = Movetable::from_lines(&lines).unwrap();
            let rotation = Rotation::from_axis_angle(&Vector::z_axis(), angle);
            let frame = Frame { position: Vector::new(x, 3.0, -7.0), rotation };
            let d = table.unapply(&table.apply(&frame)).distance(&frame);
            prop_assert!(d.inches < 1e-9 && d.radians < 1e-7, "{d:?}");
        }
    }

    #[test]
    fn nine_lines_are_too_many() {
        assert_eq!(Movetable::from_lines(&[line(System::Roll, [1, 0, 0]); 9]), None);
    }
}
