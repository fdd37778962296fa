//! A pose in the file of a robot, and the form of messages about the file.

use diagnostics::{
    Problem,
    toml::{FileKind, join},
};
use egm::Pose;
use serde::Deserialize;

/// Codes of the problems, and magnitudes: mm, degrees, and components of quaternions, which can be very small.
pub(crate) const KIND: FileKind = FileKind {
    whole: "the file",
    syntax: "robot.syntax",
    key: "robot.key",
    missing: "robot.missing",
    value: "robot.value",
    magnitudes: [0.0, 1e6],
};

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseEntry {
    position: [f64; 3],    // mm
    orientation: [f64; 4], // unit quaternion w, x, y, z
}

impl PoseEntry {
    /// The pose of the table `name`; adds its errors to `problems`.
    pub(crate) fn pose(&self, name: &str, problems: &mut Vec<Problem>) -> Option<Pose> {
        let pose = Pose::new(self.position, self.orientation);
        if pose.is_err() {
            let expected = "a quaternion w, x, y, z of length 1";
            let found = format!("{:?}", self.orientation);
            problems.push(Problem::unlike(KIND.value, &join(name, "orientation"), expected, found));
        }
        pose.ok()
    }
}
