//! The cell description: one TOML file with positions, sizes and forces of all objects in the cell.
//!
//! All values are in inches, degrees, pounds and seconds, in world coordinates. Reading reports all errors at once,
//! each with its entry, its place in the text, the expected and the found value.

mod check;
mod contact;
mod hydraulics;
mod sensing;
mod tooling;

use std::path::Path;

use diagnostics::{
    At, Diagnostics, Source,
    toml::{Document, FileKind},
};
use geometry::{
    frame::{Frame, Vector},
    kinematics::Joints,
    movetable::straight_down,
};
use serde::{Deserialize, Serialize};

pub use contact::{Kind, Pattern, Permit, Permits, commands, known};
pub use hydraulics::{Actuators, Hydraulics};
pub use sensing::SensorModels;
pub use tooling::{Drum, ForceGages, Holsters, Mounted, Plate, Points, QuickChange};

/// The file of a cell description in a data directory.
pub const CELL: &str = "cell.toml";

/// Codes of the problems, and the range of magnitudes: ten times the largest number of a cell.
const KIND: FileKind = FileKind {
    whole: "the description",
    syntax: "cell.syntax",
    key: "cell.key",
    missing: "cell.missing",
    value: "cell.value",
    magnitudes: [1e-6, 1e5],
};

#[must_use]
pub fn source(text: &str) -> Source {
    Source { name: CELL.to_owned(), text: text.into() }
}

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    #[error("the cell description {path} cannot be read: {source}")]
    Unreadable {
        path: String,
        source: std::io::Error, // the error of the operating system
    },
    #[error("the cell description cannot be used: {}", .0.in_line())]
    Mistakes(Diagnostics),
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CellDescription {
    pub name: String,
    /// Greatest distance of a part from its place after a command has put it down, in.
    #[serde(default = "placing_tolerance")]
    pub placing_tolerance: f64,
    pub physics: Physics,
    pub robot: Robot,
    pub quick_change: QuickChange,
    pub gripper: Grippers,
    pub holsters: Holsters,
    pub drum: Drum,
    pub pedestal: Pedestal,
    pub sensors: SensorModels,
    pub camera: Camera,
    pub vise: Vise,
    pub tray: Vec<Tray>,
    pub tray_shape: TrayShape,
    #[serde(default)]
    pub fixture: Vec<Fixture>,
    #[serde(default)]
    pub nest: Vec<Nest>,
    #[serde(default)]
    pub contact: Permits,
    pub part: Vec<PartType>,
}

const fn yes() -> bool {
    true
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Physics {
    /// Steps in a tick of 40 ms.
    pub substeps: u32,
    /// Take several sub-steps at once while only kinematic bodies move, or a part hangs in motionless fingers.
    #[serde(default = "yes")]
    pub long_steps: bool,
    pub solver_iterations: usize,
    pub contact_frequency: f64, // Hz
    pub contact_damping: f64,
}

/// The arm's servos and outline; its lengths are [`geometry::kinematics::T3`].
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    pub servo_lag_s: f64,       // First-order lag of the joint servos, s
    pub joint_speeds: [f64; 6], // greatest speed of each joint, degrees/s
    pub start: [f64; 6],        // joint angles at the start, degrees
    pub stiffness: f64,         // stiffness of arm, wrist and fingers together at the fingertips, lb/in
    pub upper_arm_radius: f64,
    pub forearm_radius: f64,
    pub wrist_radius: f64,
    #[serde(default)]
    pub hydraulics: Hydraulics,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Grippers {
    pub weight: f64,    // lb
    pub jaw_speed: f64, // speed of the free fingers of the v-gripper and the tool gripper, in/s
    pub parts: Gripper, // end effector 1
    pub v: Gripper,     // end effector 2
    pub tool: Gripper,  // end effector 3
    pub force: ForceGages,
}

/// A gripper with two fingers, driven by air: the robot's, and the hand of the Active Pedestal (III.9.2).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Gripper {
    pub body: [f64; 3],     // size of the body along tool X, Y, Z, in
    pub fingers: [f64; 3],  // Length, thickness and width of a finger, in
    pub finger_weight: f64, // moving mass of a finger, lb
    pub opening: [f64; 2],
    pub initial_opening: f64,
    pub friction: f64,
    /// V-grooves along tool Z in the pads: position of their axis along tool X, in.
    pub groove: Option<f64>,
    /// Force that a blocked finger gains for each inch by which the air would have moved it, lb/in.
    pub compressibility: f64,
    pub greatest_force: f64, // force of a finger at full pressure, lb
    pub vent_time_s: f64,    // time until the force is zero when both sides are vented, s
    pub sensors: GripperSensors,
}

/// Offsets and scales of the gripper's sensors, in counts of 12-bit converters; UP-INIT determines them.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct GripperSensors {
    pub potentiometer_offset: f64, // at opening 0
    pub potentiometer_scale: f64,  // per inch
    /// Counts of the left and right strain gages without force; 0 for a gripper without strain gages.
    #[serde(default)]
    pub strain_offsets: [f64; 2],
    /// Counts of the left and right strain gages per pound.
    #[serde(default)]
    pub strain_scales: [f64; 2],
    pub noise: f64, // counts
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Pedestal {
    pub location: String,
    /// Position of the fingertips of the hand, which points up, on the axis of the table; world, in.
    pub position: [f64; 3],
    pub azimuth: f64, // direction of the radial line from the robot, about +Z from +X, degrees
    /// Name of the fixture for its stand, which is not bolted to the floor and can be moved (II.1.2.3).
    pub stand: String,
    pub stiffness: f64, // stiffness of stand, hand and fingers together at the fingertips, lb/in
    pub hand: Gripper,
    pub table: RotaryTable,
}

/// The rotary table of the pedestal; angles in degrees, positive to the left seen from above.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RotaryTable {
    /// Motor angles of the - and the + limit switches.
    pub limits: [f64; 2],
    pub start: f64,
    /// Motor angle and table angle at which the fingers move across the radial line.
    pub square: f64,
    /// A motor angle, and the table angle that results from it.
    pub flip: [f64; 2],
    pub speed: f64,                // degrees/s
    pub acceleration: f64,         // degrees/s²
    pub potentiometer_offset: f64, // at table angle 0
    pub potentiometer_scale: f64,  // per degree of the table
    pub noise: f64,                // counts
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    pub position: [f64; 3],      // centre of the image plane in the tool frame, in
    pub tilt: f64,               // angle of the optical axis to tool X, towards the fingers, degrees
    pub view: f64,               // half width of the picture at the reference range, in
    pub reference_range_mm: f64, // range at which `view` holds, mm
    pub flood_noise: f64,        // greatest error of the centroid from the fast flood, in
    pub precise_noise: f64,      // greatest error of the centroid from the second picture, in
    pub angle_noise: f64,        // greatest error of the angle, degrees
    pub shape_noise: f64,        // greatest error of a measured length, in
    /// Greatest difference between a measured length and that of the part asked for, in.
    pub shape_tolerance: f64,
    /// Fraction of a face that must be visible for the part to be detected.
    pub least_share: f64,
    pub resolution: f64, // parts with at most this gap between them are one blob in the picture, in
    /// Exposures in the order of the variations: least and greatest reflectance that each exposes correctly.
    pub exposures: Vec<[f64; 2]>,
    pub bloom: f64, // apparent increase in length of parts that are too bright, in
    /// Probability that a visible part is not recognised.
    pub failure: f64,
    pub flood_ticks: u32,   // to a fast flood
    pub precise_ticks: u32, // to a second picture
}

/// The programmable vise; its frame has X into the vise, Y to the left, Z up, parallel to the world's axes.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Vise {
    pub location: String,
    /// The origin: front plane of the jaws, inner face of the fixed jaw, top of the jaws; world, in.
    pub position: [f64; 3],
    pub jaw: [f64; 3],    // Depth, thickness and height of a jaw, in
    pub body_x: [f64; 2], // in
    pub body_y: [f64; 2], // in
    pub body_height: f64, // height of the body under the ledge, in
    pub speed: f64,       // in/s
    pub force: f64,       // lb
    pub friction: f64,
    /// Its programs; the first one is selected at the start.
    pub program: Vec<ViseProgram>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ViseProgram {
    pub name: String,
    pub back: f64,  // back of the step, from the front plane of the jaws, in
    pub depth: f64, // depth of its clamping faces behind the inner faces of the jaws, in
    /// Floor of the step, from the top of the jaws, in; negative.
    pub ledge: f64,
    pub opening_open: f64,    // distance of its clamping faces when open, in
    pub opening_partial: f64, // distance of its clamping faces when partially closed, in
}

/// A place whose shape keeps parts in position: a cradle, a pot, a pocket. It is made of fixtures.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Nest {
    pub location: String,
    #[serde(default)]
    pub sector: u16, // of the location; 0 if it has none
    pub parts: Vec<String>,
    pub seat: Points,
    /// Tolerance within which a part can be machined there; without it no part can.
    pub machining: Option<Tolerance>,
}

/// Greatest distance of a part from its seat.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    pub inches: f64,
    pub degrees: f64, // of its axes, degrees
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Tray {
    pub unit: String,
    pub centre: [f64; 2],
    pub floor: f64,             // top of the floor, z, in
    pub sectors: Vec<[f64; 2]>, // centres, x and y, in, from sector 1
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TrayShape {
    pub inside: f64, // inner side of the square, in
    pub wall: f64,
    pub rim: f64, // height of the rim above the floor, in
    pub floor_thickness: f64,
    pub random_offset: f64, // greatest offset in x and y of a part that is put down at random, in
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Fixture {
    pub name: String, // also of its URDF link
    pub centre: [f64; 3],
    pub size: [f64; 3],
    #[serde(default)]
    pub azimuth: f64, // about +Z, degrees
    /// Tilt of the top towards the rotated +X, degrees.
    #[serde(default)]
    pub tilt: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    #[default]
    Box,
    /// A cylinder along X: size Y and Z are its diameter.
    CylinderX,
    /// A cylinder along Z: size X and Y are its diameter.
    CylinderZ,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PartType {
    pub name: String, // object name of the task data
    #[serde(default)]
    pub shape: Shape,
    pub size: [f64; 3], // size in the part frame (X down as presented, Z along the part), in
    pub weight: f64,    // lb
    #[serde(default)]
    pub vision_id: u16, // VII.7.6; 0 for none
    /// Reflectance: the fraction of the light that it reflects.
    #[serde(default = "half")]
    pub reflectance: f64,
    #[serde(default)]
    pub tool: bool,
    /// True if it is machined in the vise on a side that was not machined before.
    #[serde(default)]
    pub other_side: bool,
}

/// More than the 0.15 in by which the data of the linkbar job place it off the centre of its sector (SPECNOTES.md).
const fn placing_tolerance() -> f64 {
    0.25
}

const fn half() -> f64 {
    0.5
}

impl Gripper {
    /// Distance of the B plate's lower side behind the tool point: body and fingers, in.
    #[must_use]
    pub fn plate(&self) -> f64 {
        self.body[0] + self.fingers[0]
    }
}

impl Nest {
    /// The frame of a part in the nest, in.
    #[must_use]
    pub fn frame(&self) -> Frame {
        self.seat.frame().unwrap_or_else(Frame::identity)
    }

    #[must_use]
    pub fn takes(&self, kind: &PartType) -> bool {
        self.parts.contains(&kind.name)
    }
}

impl Tray {
    /// Frame of a sector on the tray floor: tool axes straight down, Y to the robot's left (VIII.6), counted from 1.
    #[must_use]
    pub fn sector(&self, number: u16) -> Option<Frame> {
        let [x, y] = *self.sectors.get(usize::from(number).checked_sub(1)?)?;
        Some(straight_down(Vector::new(x, y, self.floor)))
    }
}

impl Robot {
    /// Joint angles at the start, radians.
    #[must_use]
    pub fn start_joints(&self) -> Joints {
        self.start.map(f64::to_radians)
    }
}

impl CellDescription {
    /// Read a description from TOML text and check it.
    pub fn from_toml(text: &str) -> Result<Self, Diagnostics> {
        Document::load(&source(text), KIND, |description: &Self, stand_ins, problems| {
            let (unfit, positive) = description.problems(stand_ins);
            KIND.above_zero(&positive, problems);
            problems.extend(unfit);
        })
    }

    /// The place of an entry in the text of a description, by its path, such as `gripper.parts.body[0]`, or
    /// that of the nearest table around a missing entry.
    #[must_use]
    pub fn place(text: &Source, entry: &str) -> At {
        Document::parse(text, KIND).0.place(entry)
    }

    /// Read a description from a file and check it. Fails with [`DescriptionError`] if the file cannot be read or has
    /// mistakes.
    pub fn load(path: &Path) -> Result<Self, DescriptionError> {
        let text = os_io::files::read_text(path)
            .map_err(|source| DescriptionError::Unreadable { path: path.display().to_string(), source })?;
        Self::from_toml(&text).map_err(DescriptionError::Mistakes)
    }

    #[must_use]
    pub fn part(&self, name: &str) -> Option<&PartType> {
        self.part.iter().find(|part| part.name == name)
    }

    /// The part with a vision id (VII.7.6).
    #[must_use]
    pub fn seen_as(&self, vision_id: u16) -> Option<&PartType> {
        self.part.iter().find(|part| part.vision_id == vision_id && vision_id != 0)
    }

    #[must_use]
    pub fn tray(&self, unit: &str) -> Option<&Tray> {
        self.tray.iter().find(|tray| tray.unit == unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = include_str!("../../../data/cell.toml");

    #[test]
    fn shipped_cell_has_no_errors() {
        let cell = CellDescription::from_toml(TEXT).unwrap();
        assert_eq!(cell.part("LINKBAR1_BH").unwrap().vision_id, 17);
        let sector = cell.tray("UNIT_1").unwrap().sector(4).unwrap();
        assert!((sector.position - Vector::new(-50.75, 10.25, -16.55)).norm() < 1e-12);
        assert!((sector.y() - Vector::new(0.0, -1.0, 0.0)).norm() < 1e-12, "tool Y is the robot's left: -Y");
        assert!(
            cell.tray("UNIT_1").unwrap().sector(0).is_none()
                && cell.tray("UNIT_1").unwrap().sector(5).is_none()
        );
    }

    #[test]
    fn shipped_hydraulics_equal_those_of_the_t3() {
        let cell = CellDescription::from_toml(TEXT).unwrap();
        assert_eq!(Actuators::from(&cell.robot), Actuators::default());
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = CellDescription::load(Path::new("/nowhere/cell.toml")).unwrap_err().to_string();
        assert!(error.contains("/nowhere/cell.toml"), "{error}");
    }
}
