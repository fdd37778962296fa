//! Where the T3's world lies in the robot's work object, and its end plate in the robot's tool: from a file
//! such as `data/robots/same.toml`, which may describe the robot's arm too.

use std::path::{Path, PathBuf};

use depc::{Plate, plate::HALF_TURN};
use egm::{Limits, Pose, pose};
use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_vector},
    kinematics::T3,
};
use os_io::files;
use serde::Deserialize;

use crate::arm::{Arm, ArmText};

/// Millimetres of an inch.
const MM_PER_IN: f64 = 25.4;
/// Limits of DEPC (A 2.3) in mm/s and rad/s. A position may be a rounded one and the next exact: 0.01 in and
/// 0.01 degree more a period of 40 ms, on either side.
const SPEED: f64 = (14.0 + 0.5) * MM_PER_IN;
/// See [`SPEED`]: each of three angles may turn by 1.0 rad/s.
const TURN: f64 = 1.75;

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PlacementError {
    /// It cannot be read.
    #[error("the robot's frames {} cannot be read: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not what was expected.
    #[error("the robot's frames {} cannot be used: {why}", path.display())]
    Text {
        /// Which.
        path: PathBuf,
        /// What is wrong, and where.
        why: String,
    },
}

/// A pose as the file has it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Place {
    /// mm.
    position: [f64; 3],
    /// w, x, y, z.
    orientation: [f64; 4],
}

impl Place {
    /// The pose of the table `name`.
    pub(crate) fn pose(&self, name: &str) -> Result<Pose, String> {
        Pose::new(self.position, self.orientation)
            .map_err(|_| format!("{name}.orientation is a quaternion w, x, y, z of length 1"))
    }
}

/// The work space as the file has it, mm in the work object.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Space {
    low: [f64; 3],
    high: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    world: Place,
    tool: Place,
    space: Option<Space>,
    arm: Option<ArmText>,
}

/// What a file says of a robot.
#[derive(Clone, Debug)]
pub struct RobotFile {
    /// Its frames.
    pub placement: Placement,
    /// Its arm, if the file has one.
    pub arm: Option<Arm>,
}

impl RobotFile {
    /// Read a file.
    ///
    /// # Errors
    /// [`PlacementError`].
    pub fn load(path: &Path) -> Result<Self, PlacementError> {
        let text = files::read_text(path)
            .map_err(|source| PlacementError::Read { path: path.to_owned(), source })?;
        Self::from_toml(&text).map_err(|why| PlacementError::Text { path: path.to_owned(), why })
    }

    /// Read the text of a file.
    ///
    /// # Errors
    /// What is wrong, and where.
    pub fn from_toml(text: &str) -> Result<Self, String> {
        let text: Text = toml::from_str(text).map_err(|error| error.to_string())?;
        let placement = Placement::from_text(&text)?;
        let arm = text.arm.as_ref().map(Arm::from_text).transpose()?;
        Ok(Self { placement, arm })
    }
}

/// The frames of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The T3's world in the work object.
    world: Pose,
    /// The robot's tool in the T3's end plate.
    tool: Pose,
    limits: Limits,
}

impl Default for Placement {
    /// The work object is the T3's world, the tool its end plate.
    fn default() -> Self {
        Self { world: Pose::IDENTITY, tool: Pose::IDENTITY, limits: Limits::of_speed(SPEED, TURN) }
    }
}

impl Placement {
    fn from_text(text: &Text) -> Result<Self, String> {
        let (world, tool) = (text.world.pose("world")?, text.tool.pose("tool")?);
        // The tool turns about the end plate.
        let speed = SPEED + TURN * pose::norm(&tool.position);
        let mut limits = Limits::of_speed(speed, TURN);
        if let Some(Space { low, high }) = text.space {
            if low
                .iter()
                .zip(&high)
                .any(|(low, high)| low.partial_cmp(high) != Some(std::cmp::Ordering::Less))
            {
                return Err("space.low must be below space.high in x, y and z".into());
            }
            limits.space = [low, high];
        }
        Ok(Self { world, tool, limits })
    }

    /// What points and targets are checked against.
    #[must_use]
    pub const fn limits(&self) -> Limits {
        self.limits
    }

    /// The robot's tool in its work object, for the T3's end plate (inches, world).
    #[must_use]
    pub fn pose(&self, plate: &Frame) -> Pose {
        let turn = rotation_vector(&plate.rotation);
        let position = plate.position * MM_PER_IN;
        let plate = Pose { position: position.into(), orientation: pose::from_rotation_vector(&turn.into()) };
        self.world.compose(&plate).compose(&self.tool)
    }

    /// The T3's end plate in the T3's world, for the robot's tool in its work object.
    #[must_use]
    pub fn plate_pose(&self, pose: &Pose) -> Pose {
        self.world.inverse().compose(pose).compose(&self.tool.inverse())
    }

    /// The same in inches.
    #[must_use]
    pub fn plate_frame(&self, pose: &Pose) -> Frame {
        let plate = self.plate_pose(pose);
        Frame {
            position: Vector::from(plate.position) / MM_PER_IN,
            rotation: rotation_by(&pose::rotation_vector(&plate.orientation).into()),
        }
    }

    /// The T3's tool frame (inches, world), for the robot's tool in its work object.
    #[must_use]
    pub fn tool_frame(&self, pose: &Pose) -> Frame {
        self.plate_frame(pose).shifted(Vector::new(T3.plate_to_tool, 0.0, 0.0))
    }

    /// The words of a pose, with D and R near those of `near`; `None` where the line has no words.
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
        fn a_plate_comes_back(at in prop::array::uniform3(-80.0_f64..80.0), turn in prop::array::uniform3(-1.7_f64..1.7)) {
            let plate = Frame { position: at.into(), rotation: rotation_by(&turn.into()) };
            for placement in [Placement::default(), RobotFile::from_toml(TEXT).unwrap().placement] {
                let back = placement.plate_frame(&placement.pose(&plate));
                let off = back.distance(&plate);
                prop_assert!(off.inches < 1e-9 && off.radians < 1e-9, "{off:?}");
            }
        }
    }

    #[test]
    fn home_is_where_it_was_worked_out_to_be() {
        let home = T3.forward_plate(&HOME_JOINTS);
        let pose = Placement::default().pose(&home);
        assert!((pose.position[1] + 62.93 * 25.4).abs() < 0.3, "{pose:?}");
        // Turned by 90 degrees about z, y becomes -x, and the world lies 1200 mm in front.
        let placed = RobotFile::from_toml(&TEXT.replace("100.0", "0.0")).unwrap().placement.pose(&home);
        assert!((placed.position[0] - (1200.0 + 62.93 * 25.4)).abs() < 0.3, "{placed:?}");
    }

    #[test]
    fn a_file_with_a_mistake_says_which() {
        for (wrong, word) in [
            (TEXT.replace("0.7071068, 0.0", "0.9, 0.0"), "world.orientation"),
            (TEXT.replace("[tool]", "[tools]"), "tools"),
            (format!("{TEXT}[space]\nlow = [0.0, 0.0, 0.0]\nhigh = [1.0, 1.0, 0.0]\n"), "space.low"),
        ] {
            let error = RobotFile::from_toml(&wrong).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
