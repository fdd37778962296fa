//! The path along which the joystick box has moved the robot: an extension (docs/design/recovery.md "Return").

use geometry::pose::Pose;
use rcs_core::Plain;

/// Maximum number of points of a [`Track`].
pub const TRACK_POINTS: usize = 32;

/// State of the record of the path from the robot's last known place or way to its present pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Course {
    /// The robot's place or way has not been known since the start.
    None,
    /// The robot's place or way is known.
    Known,
    /// The joystick box has moved the robot, and the whole path is recorded.
    Tracked,
    /// The joystick box has moved the robot, and part of the path is not recorded.
    Broken,
    /// The robot has moved without a command and without the joystick box: the arm has sunk, or the link has failed.
    Adrift,
}

/// The path of the robot under the joystick box since its last known place or way, by the resolvers: straight
/// segments through points, and from the last point to the end (docs/design/recovery.md "Return").
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Track {
    /// State of the record.
    pub course: Course,
    /// The joystick box has moved the robot since the last commanded motion.
    pub by_hand: bool,
    /// Number of valid points.
    pub count: u8,
    /// Points; the first is at the known place or way.
    pub points: [Pose; TRACK_POINTS],
    /// Direction of the last segment, a unit vector in world coordinates.
    pub heading: [f64; 3],
    /// The last recorded pose. While the place or way is known, the present pose.
    pub end: Pose,
}
