//! The path on which the joystick box has moved the robot: an extension of E-move's outputs (docs/design/recovery.md
//! "Return").

use geometry::pose::Pose;
use rcs_core::Plain;

/// Points of a [`Track`] at most.
pub const TRACK_POINTS: usize = 32;

/// State of the record of the path from the last known place or way of the robot to its present pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Course {
    /// Its place or way has not been known since the start.
    None,
    /// Its place or way is known.
    Known,
    /// The joystick box has moved it, and all of the path is recorded.
    Tracked,
    /// The joystick box has moved it, and a part of the path is not recorded.
    Broken,
    /// It has moved without a command and without the joystick box: the arm has sunk, or the link has failed.
    Adrift,
}

/// The path on which the joystick box has moved the robot from its last known place or way, by the resolvers: straight
/// segments through points, and from the last point to the end (docs/design/recovery.md "Return").
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Track {
    /// State of the record.
    pub course: Course,
    /// The joystick box has moved the robot since the last motion that was commanded.
    pub by_hand: bool,
    /// Points that count.
    pub count: u8,
    /// The first is that at the known place or way.
    pub points: [Pose; TRACK_POINTS],
    /// Direction of the segment from the last point on, a unit vector in world coordinates.
    pub heading: [f64; 3],
    /// The end: the last recorded pose. While the place or way is known, the present pose.
    pub end: Pose,
}
