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
    pub length: f64, // length of both plates together, from the end plate, in
    pub radius: f64,
    pub mounted: Mounted,
    pub travel_time_s: f64, // time that the locking ring takes from end to end, s
    pub pins_reach: f64,    // distance of the plates at which the id pins still touch, in
    pub pins_play: f64,     // lateral offset up to which the plates stay engaged, in
    /// Greatest distance between the plates, axial or lateral, at which the ring catches, in.
    pub tolerance: f64,
    pub tolerance_degrees: f64, // greatest angle between the plates at which the ring catches, degrees
}

/// For each holster, the tool frame of a gripper whose ears rest on it before it slides to the seat.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Holsters {
    pub right: Points,  // to the right of the robot's base
    pub left: Points,   // to the left
    pub centre: Points, // freestanding in front
    pub seat: f64,      // distance of the seat, forward along tool +Z, in
    pub detent: f64,    // distance from the seat within which the detent draws a gripper to it, in
    /// Size of a gripper's ears along tool X, Y and Z, in; on either side of its body, 1 in under its B plate.
    pub ears: [f64; 3],
    /// Greatest height above its rest at which a released gripper still lands on the holster, in.
    pub catch_height: f64,
    /// Greatest distance from the holster's middle at which a released gripper still lands on it, in.
    pub catch_aside: f64,
    pub large_range: f64, // height up to which the large sensors detect ears, in
    pub small_range: f64, // distance to the seat at which the small sensors detect ears, in
}

/// The tool drum at the transfer position, in the tool frame of that location: X into the drum.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    pub location: String,
    pub pose: Points,
    pub middle: f64,       // centre of a tool in its place, along X, in
    pub finger_reach: f64, // distance before its place at which closed fingers stop a tool, in
    /// Length of the last part of the insertion, against the force of the detents, in.
    pub detent_length: f64,
    pub insertion_force: f64,  // force of the detents at the end of the insertion, lb
    pub extraction_force: f64, // force of the detents at the beginning of the extraction, lb
    pub stop_force: f64,       // force with which an obstacle in the drum stops a tool, lb
    /// Greatest distance of a tool from its place at which the fingers can close on it, in.
    pub seated: f64,
    /// Greatest angle of a tool to its place at which the fingers can close on it, degrees.
    pub seated_degrees: f64,
    pub friction: f64, // of the strike plate
    pub plate: Vec<Plate>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    pub name: String,   // also of its URDF link
    pub low: [f64; 3],  // corner of least X, Y, Z in the frame of the drum, in
    pub high: [f64; 3], // corner of greatest X, Y, Z, in
}

/// The force sensor of the tool gripper (III.3.8).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ForceGages {
    pub behind_tool: f64, // distance of its middle behind the tool point, in
    pub weight: f64,      // lb
    pub weight_at: f64,   // distance of the centre of that weight behind the tool point, in
    /// Offsets of the bridges without load from the nominal zero, counts: sensor X, Y, Z and the moment.
    pub offsets: [f64; 4],
    pub noise: f64, // counts
}
