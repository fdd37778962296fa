//! Tool changing: quick change, holsters, tool drum.

use geometry::{frame::Frame, pose::Pose};
use serde::{Deserialize, Serialize};

/// A pose in the format of a pose form: three points, 0.01 in (VII.1).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// A point on the axis of the end effector.
    pub wrist: [i32; 3],
    pub tool: [i32; 3],
    /// A point to the left of the tool point.
    pub finger: [i32; 3],
}

impl Points {
    /// The frame of the three points, in; `None` if they do not define one, which [`super::CellDescription::validate`]
    /// reports.
    #[must_use]
    pub fn frame(&self) -> Option<Frame> {
        Pose { wrist: self.wrist, tool: self.tool, finger: self.finger }.to_frame().ok()
    }
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mounted {
    None,
    Parts,
    V,
    Tool,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct QuickChange {
    /// Length of both plates together, from the end plate, in.
    pub length: f64,
    pub radius: f64,
    /// The gripper on the robot at the start; the others are in their holsters.
    pub mounted: Mounted,
    /// Time that the locking ring takes from end to end, s.
    pub travel_time_s: f64,
    /// Distance of the plates at which the id pins still touch, in.
    pub pins_reach: f64,
    /// Lateral offset up to which the plates stay engaged, in.
    pub pins_play: f64,
    /// Greatest distance between the plates, axial or lateral, at which the ring catches, in.
    pub tolerance: f64,
    /// Greatest angle between the plates at which the ring catches, degrees.
    pub tolerance_degrees: f64,
}

/// The holsters: for each, the tool frame of a gripper whose ears rest on it before it slides to the seat; and their
/// common values.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Holsters {
    /// Holster of the parts gripper, to the right of the robot's base.
    pub right: Points,
    /// Holster of the v-gripper, to the left.
    pub left: Points,
    /// Holster of the tool gripper, freestanding in front.
    pub centre: Points,
    /// Distance of the seat, forward along tool +Z, in.
    pub seat: f64,
    /// Distance from the seat within which the detent draws a gripper to it, in.
    pub detent: f64,
    /// Size of a gripper's ears along tool X, Y and Z, in; on either side of its body, 1 in under its B plate.
    pub ears: [f64; 3],
    /// Greatest height above its rest at which a released gripper still lands on the holster, in.
    pub catch_height: f64,
    /// Greatest distance from the holster's middle at which a released gripper still lands on it, in.
    pub catch_aside: f64,
    /// Height up to which the large sensors detect ears, in.
    pub large_range: f64,
    /// Distance to the seat at which the small sensors detect ears, in.
    pub small_range: f64,
}

/// The tool drum at the transfer position, in the tool frame of that location: X into the drum.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    pub location: String,
    /// Its tool frame.
    pub pose: Points,
    /// Centre of a tool in its place, along X, in.
    pub middle: f64,
    /// Distance before its place at which closed fingers stop a tool, in.
    pub finger_reach: f64,
    /// Length of the last part of the insertion, against the force of the detents, in.
    pub detent_length: f64,
    /// Force of the detents at the end of the insertion, lb.
    pub insertion_force: f64,
    /// Force of the detents at the beginning of the extraction, lb.
    pub extraction_force: f64,
    /// Force with which an obstacle in the drum stops a tool, lb.
    pub stop_force: f64,
    /// Greatest distance of a tool from its place at which the fingers can close on it, in.
    pub seated: f64,
    /// Greatest angle of a tool to its place at which the fingers can close on it, degrees.
    pub seated_degrees: f64,
    /// Coefficient of friction of the strike plate.
    pub friction: f64,
    /// The boxes of the strike plate.
    pub plate: Vec<Plate>,
}

/// A box of the strike plate.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Its name and that of its URDF link.
    pub name: String,
    /// Corner of least X, Y, Z in the frame of the drum, in.
    pub low: [f64; 3],
    /// Corner of greatest X, Y, Z, in.
    pub high: [f64; 3],
}

/// The force sensor of the tool gripper (III.3.8).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ForceGages {
    /// Distance of its middle behind the tool point, in.
    pub behind_tool: f64,
    /// Weight that hangs on it, lb.
    pub weight: f64,
    /// Distance of the centre of that weight behind the tool point, in.
    pub weight_at: f64,
    /// Offsets of the bridges without load from the nominal zero, counts: sensor X, Y, Z and the moment.
    pub offsets: [f64; 4],
    /// Greatest noise, counts.
    pub noise: f64,
}
