//! The frames of a robot, from a file such as `data/robots/same.toml`: the T3's world in its work object, and its tool
//! in the T3's end plate.

use std::path::{Path, PathBuf};

use depc::{Plate, plate::HALF_TURN, track::MOST_LAG_MS};
use diagnostics::{
    Diagnostics, Problem, Source, UnknownFile,
    toml::{Document, element},
};
use egm::{Limits, Pose, pose};
use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_vector},
    kinematics::T3,
};
use os_io::files;
use serde::Deserialize;

use crate::egm::{
    arm::{Arm, ArmText},
    pose_entry::{KIND, PoseEntry},
};

const MM_PER_IN: f64 = 25.4; // millimetres per inch
/// Limits of DEPC (A 2.3) in mm/s and rad/s. Rounding adds 0.01 in and 0.01 degree at each end of a 40 ms period.
const SPEED: f64 = (14.0 + 0.5) * MM_PER_IN;
/// See [`SPEED`]: each of three angles may turn by 1.0 rad/s.
const TURN: f64 = 1.75;

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlacementError {
    #[error(transparent)]
    Unknown(#[from] UnknownFile),
    #[error("the robot's frames {} cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("the robot's file cannot be used: {}", .0.in_line())]
    Text(Box<Diagnostics>),
}

/// The work space in the file, mm in the work object.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Space {
    low: [f64; 3],
    high: [f64; 3],
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Following {
    lag: f64, // expected lag behind the positions sent, ms
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    world: PoseEntry,
    tool: PoseEntry,
    space: Option<Space>,
    following: Option<Following>,
    arm: Option<ArmText>,
}

/// Contents of a robot's file. By default it is at the place of the T3.
#[derive(Clone, Debug, Default)]
pub struct RobotFile {
    pub placement: Placement,
    /// Expected lag behind the positions sent, ms, if the file states it.
    pub lag_ms: Option<u16>,
    pub arm: Option<Arm>,
}

impl Following {
    /// The lag; adds an error to `problems`.
    fn lag_ms(self, problems: &mut Vec<Problem>) -> Option<u16> {
        let whole = (0.0..=f64::from(MOST_LAG_MS)).contains(&self.lag) && self.lag.fract() == 0.0;
        if !whole {
            let expected = format!("a whole number of ms from 0 to {MOST_LAG_MS}");
            problems.push(Problem::unlike(KIND.value, "following.lag", &expected, self.lag));
        }
        whole.then_some(self.lag as u16)
    }
}

impl RobotFile {
    pub fn load(path: &Path) -> Result<Self, PlacementError> {
        let text = files::read_text(path)
            .map_err(|source| PlacementError::Read { path: path.to_owned(), source })?;
        let source = Source { name: path.display().to_string(), text: text.into() };
        Self::from_toml(&source).map_err(|report| PlacementError::Text(Box::new(report)))
    }

    /// Parses the text of a robot's file. Errors: all problems of the text, with their places.
    pub fn from_toml(source: &Source) -> Result<Self, Diagnostics> {
        let mut file = None;
        Document::load(source, KIND, |text: &Text, stand_ins, problems| {
            let mut found = Vec::new();
            let placement = Placement::from_text(text, &mut found);
            let arm = text.arm.as_ref().map(|arm| Arm::from_text(arm, &mut found));
            let lag_ms = text.following.and_then(|following| following.lag_ms(&mut found));
            found.retain(|problem| problem.entry.as_ref().is_none_or(|entry| stand_ins.trusts(entry)));
            problems.extend(found);
            file = placement.map(|placement| Self { placement, lag_ms, arm: arm.flatten() });
        })?;
        let unusable = || Problem::of_entry(KIND.value, "", "the file has no frames".to_owned());
        file.ok_or_else(|| Diagnostics::of_file(unusable().into(), source))
    }
}

#[cfg(test)]
pub(crate) fn source(text: &str) -> Source {
    Source { name: "robot.toml".to_owned(), text: text.into() }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    world: Pose, // pose of the T3's world in the work object
    tool: Pose,  // pose of the robot's tool in the T3's end plate
    limits: Limits,
}

impl Default for Placement {
    /// The work object coincides with the T3's world, and the tool with its end plate.
    fn default() -> Self {
        Self { world: Pose::IDENTITY, tool: Pose::IDENTITY, limits: Limits::of_speed(SPEED, TURN) }
    }
}

impl Placement {
    fn from_text(text: &Text, problems: &mut Vec<Problem>) -> Option<Self> {
        let (world, tool) = (text.world.pose("world", problems), text.tool.pose("tool", problems));
        for (axis, (low, high)) in
            text.space.iter().flat_map(|space| space.low.iter().zip(space.high)).enumerate()
        {
            if *low >= high {
                let expected = format!("less than the {high} of space.high");
                problems.push(Problem::unlike(KIND.value, &element("space.low", axis), expected, low));
            }
        }
        let (world, tool) = (world?, tool?);
        // The tool point turns about the end plate, so a rotation adds to its speed.
        let speed = SPEED + TURN * pose::norm(&tool.position);
        let mut limits = Limits::of_speed(speed, TURN);
        if let Some(Space { low, high }) = text.space {
            limits.space = [low, high];
        }
        Some(Self { world, tool, limits })
    }

    #[must_use]
    pub const fn limits(&self) -> Limits {
        self.limits
    }

    /// Pose of the robot's tool in its work object, mm, for an end-plate frame (inches, world).
    #[must_use]
    pub fn pose(&self, plate: &Frame) -> Pose {
        let turn = rotation_vector(&plate.rotation);
        let position = plate.position * MM_PER_IN;
        let plate = Pose { position: position.into(), orientation: pose::from_rotation_vector(&turn.into()) };
        self.world.compose(&plate).compose(&self.tool)
    }

    /// Pose of the T3's end plate in the T3's world, mm, for a pose of the robot's tool in its work object.
    #[must_use]
    pub fn plate_pose(&self, pose: &Pose) -> Pose {
        self.world.inverse().compose(pose).compose(&self.tool.inverse())
    }

    /// As [`Self::plate_pose`], in inches.
    #[must_use]
    pub fn plate_frame(&self, pose: &Pose) -> Frame {
        let plate = self.plate_pose(pose);
        Frame {
            position: Vector::from(plate.position) / MM_PER_IN,
            rotation: rotation_by(&pose::rotation_vector(&plate.orientation).into()),
        }
    }

    /// The T3's tool frame (inches, world) for a pose of the robot's tool in its work object.
    #[must_use]
    pub fn tool_frame(&self, pose: &Pose) -> Frame {
        self.plate_frame(pose).shifted(Vector::new(T3.plate_to_tool, 0.0, 0.0))
    }

    /// DEPC words of a pose, with D and R near those of `near`; `None` if DEPC cannot express the pose.
    #[must_use]
    pub fn words(&self, pose: &Pose, near: &Plate) -> Option<Plate> {
        let words = Plate::from_frame(&self.plate_frame(pose), near).ok()?;
        let [.., e, _] = words.words;
        (0..=HALF_TURN).contains(&e.into()).then_some(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::kinematics::HOME_JOINTS;
    use proptest::prelude::*;

    const TEXT: &str = "[world]\nposition = [1200.0, 0.0, 900.0]\norientation = [0.7071068, 0.0, 0.0, 0.7071068]\n\
                        [tool]\nposition = [0.0, 0.0, 100.0]\norientation = [0.5, 0.5, 0.5, 0.5]\n";

    proptest! {
        #[test]
        fn plate_round_trips_through_the_robot_frames(at in prop::array::uniform3(-80.0_f64..80.0), turn in prop::array::uniform3(-1.7_f64..1.7)) {
            let plate = Frame { position: at.into(), rotation: rotation_by(&turn.into()) };
            for placement in [Placement::default(), RobotFile::from_toml(&source(TEXT)).unwrap().placement] {
                let back = placement.plate_frame(&placement.pose(&plate));
                let off = back.distance(&plate);
                prop_assert!(off.inches < 1e-9 && off.radians < 1e-9, "{off:?}");
            }
        }
    }

    #[test]
    fn home_equals_the_calculated_pose() {
        let home = T3.forward_plate(&HOME_JOINTS);
        let pose = Placement::default().pose(&home);
        assert!((pose.position[1] + 62.93 * 25.4).abs() < 0.3, "{pose:?}");
        // Turned by 90 degrees about z, y becomes -x; the world lies 1200 mm in front.
        let placed =
            RobotFile::from_toml(&source(&TEXT.replace("100.0", "0.0"))).unwrap().placement.pose(&home);
        assert!((placed.position[0] - (1200.0 + 62.93 * 25.4)).abs() < 0.3, "{placed:?}");
    }

    #[test]
    fn error_in_a_robot_file_is_named() {
        for (wrong, word) in [
            (TEXT.replace("0.7071068, 0.0", "0.9, 0.0"), "world.orientation"),
            (TEXT.replace("[tool]", "[tools]"), "tools"),
            (format!("{TEXT}[following]\nlag = 1001.0\n"), "following.lag"),
            (format!("{TEXT}[space]\nlow = [0.0, 0.0, 0.0]\nhigh = [1.0, 1.0, 0.0]\n"), "space.low"),
        ] {
            let said = RobotFile::from_toml(&source(&wrong)).unwrap_err().in_line();
            assert!(said.contains(word), "{said}");
        }
    }
}
