//! The cell for viewers: links with poses, and a URDF of boxes and cylinders.
//!
//! The pose of every link is given relative to its parent in the URDF, so that a stream of transforms, a stream of
//! joint angles and the URDF agree.

use std::fmt::Write as _;

use geometry::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::{JOINT_NAMES, T3},
};
use rapier3d_f64::prelude::*;

use super::Cell;
use crate::{
    bodies::turret,
    convert::{metres, newtons, to_metres, to_pose},
    description::{Kind, PartType},
    linkage::{AXES, STARTS},
    scene::{Block, along_x, jaw_blocks},
    solid::{Family, along},
};

/// A moving body, metres, in the frame of its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The name of its URDF link.
    pub name: String,
    /// The link in whose frame the pose is given; `world` for the world.
    pub parent: &'static str,
    /// x, y, z in metres.
    pub position: [f64; 3],
    /// Quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// Links of the arm from the base, and their parents.
const ARM: [(&str, &str); 6] = [
    ("turret", "world"),
    ("upper_arm", "turret"),
    ("forearm", "upper_arm"),
    ("wrist_pitch", "forearm"),
    ("wrist_yaw", "wrist_pitch"),
    ("end_plate", "wrist_yaw"),
];

/// Furniture blocks that belong to the link of the vise.
const VISE_BLOCKS: [&str; 2] = ["vise_body", "fixed_jaw"];

/// A shape of a link, in the link's frame.
pub(super) enum Outline {
    Box(Inches),
    /// A cylinder along the X axis: radius and length.
    Cylinder(f64, f64),
}

impl Cell {
    /// Names and poses of all moving bodies and their parents; a parent comes before its children.
    #[must_use]
    pub fn links(&self) -> Vec<Link> {
        let mut links = Vec::with_capacity(11 + self.parts.len());
        for (joint, angle) in self.joints().into_iter().enumerate() {
            let (name, parent) = ARM[joint];
            let pose = Pose::new(Vector::X * metres(STARTS[joint]), Vector::from_array(AXES[joint]) * angle);
            links.push(link(name, parent, &pose));
        }
        links.extend(self.gripper_links());
        links.extend(self.pedestal_links());
        let vise = to_pose(self.vise.frame());
        let jaw = vise.inv_mul(self.world.bodies[self.vise.jaw()].position());
        links.push(link("vise", "world", &vise));
        links.push(link("movable_jaw", "vise", &jaw));
        for part in &self.parts {
            links.push(link(&part_link(part.id), "world", &part.pose(&self.world)));
        }
        links
    }

    /// Names and poses of the fixed links of the URDF, which [`Cell::links`] does not return.
    #[must_use]
    pub fn fixed_links(&self) -> Vec<Link> {
        let standing = self.furniture.iter().filter(|block| !VISE_BLOCKS.contains(&block.name.as_str()));
        standing.map(|block| link(&block.name, "world", &to_pose(&block.frame))).collect()
    }

    /// Names and values of all revolute and prismatic joints of the URDF: radians, or metres for fingers and jaw.
    #[must_use]
    pub fn joint_states(&self) -> Vec<(&'static str, f64)> {
        let mut states: Vec<_> = JOINT_NAMES.into_iter().zip(self.joints()).collect();
        states.extend(self.finger_states());
        states.extend(self.pedestal_states());
        states.push(("jaw_slide", metres(self.vise.gap())));
        states
    }

    /// A URDF of the whole cell as it is now; parts that are put down later are not in it.
    #[must_use]
    pub fn urdf(&self) -> String {
        self.urdf_with(&[])
    }

    /// A URDF of the whole cell with the parts that will be put down later, given by their names in the description and
    /// in that order: so a log has the geometry before its first tick. Unknown names are left out.
    #[must_use]
    pub fn urdf_with(&self, coming: &[&str]) -> String {
        let mut urdf = Urdf::new(&self.description.name);
        self.urdf_arm(&mut urdf);
        self.urdf_grippers(&mut urdf);
        self.urdf_pedestal(&mut urdf);
        for block in &self.furniture {
            if !VISE_BLOCKS.contains(&block.name.as_str()) {
                urdf.begin_link(&block.name);
                urdf.block(&Block { frame: Frame::identity(), ..block.clone() }, colour(block));
                urdf.end_link();
                urdf.joint(
                    &format!("{}_mount", block.name),
                    "fixed",
                    "world",
                    &block.name,
                    &block.frame,
                    None,
                );
            }
        }
        self.urdf_vise(&mut urdf);
        for (name, kind) in self.part_kinds(coming) {
            urdf.begin_link(&name);
            match along(kind) {
                Some((axis, radius, length)) => {
                    urdf.shape(&axis, &Outline::Cylinder(radius, length), part_colour(kind));
                }
                None => {
                    urdf.shape(&Frame::identity(), &Outline::Box(Inches::from(kind.size)), part_colour(kind));
                }
            }
            urdf.end_link();
            urdf.joint(&format!("{name}_free"), "floating", "world", &name, &Frame::identity(), None);
        }
        urdf.finish()
    }

    /// Link names and kinds of the present parts, and of those that will be put down: see [`Cell::urdf_with`].
    #[must_use]
    pub fn part_kinds(&self, coming: &[&str]) -> Vec<(String, &PartType)> {
        let present = self.parts.iter().map(|part| (part.id, &part.kind));
        let coming = coming.iter().filter_map(|name| self.description.part(name));
        let all = present.chain((self.next_part..).zip(coming));
        all.map(|(id, kind)| (part_link(id), kind)).collect()
    }

    fn urdf_arm(&self, urdf: &mut Urdf) {
        let robot = &self.description.robot;
        let (turret_radius, turret_height) = turret(&self.description);
        let outlines = [
            (turret_radius, 2.0 * turret_height, -turret_height),
            (robot.upper_arm_radius * 0.8, T3.upper_arm, 0.0),
            (robot.forearm_radius, T3.forearm, 0.0),
            (robot.wrist_radius, T3.pitch_to_yaw, 0.0),
            (robot.wrist_radius, 2.0, -1.0),
            (robot.wrist_radius, T3.yaw_to_plate, 0.0),
        ];
        for (joint, (radius, length, from)) in outlines.into_iter().enumerate() {
            let (name, parent) = ARM[joint];
            let middle = Frame {
                position: Inches::new(from + length / 2.0, 0.0, 0.0),
                rotation: Rotation::identity(),
            };
            // The turret is upright.
            let middle = if joint == 0 { Frame { rotation: upright(), ..Frame::identity() } } else { middle };
            urdf.begin_link(name);
            urdf.shape(&middle, &Outline::Cylinder(radius, length), ROBOT);
            let axle = match joint {
                1 => Some(turret_radius + 3.0),
                2 => Some(robot.upper_arm_radius + 1.0),
                _ => None,
            };
            if let Some(half) = axle {
                // The axle about which the link turns.
                let across = Frame { rotation: sideways(), ..Frame::identity() };
                urdf.shape(&across, &Outline::Cylinder(0.8 * robot.upper_arm_radius, 2.0 * half), DARK);
            }
            urdf.end_link();
            let start =
                Frame { position: Inches::new(STARTS[joint], 0.0, 0.0), rotation: Rotation::identity() };
            let speed = robot.joint_speeds[joint].to_radians();
            let motion = Motion { axis: AXES[joint], range: T3.limits[joint], speed, effort: 0.0 };
            urdf.joint(JOINT_NAMES[joint], "revolute", parent, name, &start, Some(motion));
        }
    }

    fn urdf_vise(&self, urdf: &mut Urdf) {
        let vise = &self.description.vise;
        urdf.begin_link("vise");
        let inverse = self.vise.frame().inverse();
        for block in &self.furniture {
            if VISE_BLOCKS.contains(&block.name.as_str()) {
                urdf.block(&block.moved(&inverse), DARK);
            }
        }
        urdf.end_link();
        urdf.joint("vise_mount", "fixed", "world", "vise", self.vise.frame(), None);
        urdf.begin_link("movable_jaw");
        for block in jaw_blocks(vise) {
            urdf.block(&block, STEEL);
        }
        urdf.end_link();
        let widest = vise.program.iter().map(|program| program.opening_open).fold(0.0, f64::max);
        let motion = Motion {
            axis: [0.0, 1.0, 0.0],
            range: (0.0, metres(widest)),
            speed: metres(vise.speed),
            effort: newtons(vise.force),
        };
        urdf.joint("jaw_slide", "prismatic", "vise", "movable_jaw", &Frame::identity(), Some(motion));
    }
}

/// The rotation of a cylinder along X onto the Z axis of a link.
fn upright() -> Rotation {
    Rotation::from_axis_angle(&Inches::y_axis(), -core::f64::consts::FRAC_PI_2)
}

/// The rotation of a cylinder along X onto the Y axis of a link.
fn sideways() -> Rotation {
    Rotation::from_axis_angle(&Inches::z_axis(), core::f64::consts::FRAC_PI_2)
}

/// Name of the link of a part.
#[must_use]
pub fn part_link(id: u32) -> String {
    format!("part_{id}")
}

pub(super) fn link(name: &str, parent: &'static str, pose: &Pose) -> Link {
    Link {
        name: name.into(),
        parent,
        position: pose.translation.to_array(),
        rotation: pose.rotation.to_array(),
    }
}

const ROBOT: &str = "0.91 0.42 0.11 1";
pub(super) const STEEL: &str = "0.60 0.62 0.65 1";
pub(super) const DARK: &str = "0.25 0.27 0.30 1";
const TRAY: &str = "0.22 0.44 0.70 1";
const YELLOW: &str = "0.96 0.77 0.09 1";
const MACHINE: &str = "0.30 0.52 0.58 1";
const BENCH: &str = "0.79 0.68 0.50 1";
const FLOOR: &str = "0.73 0.73 0.72 1";

/// The colour of a fixed block.
fn colour(block: &Block) -> &'static str {
    match (block.kind, block.name.as_str()) {
        (Kind::Tray, _) => TRAY,
        (Kind::Holster | Kind::Drum, _) => YELLOW,
        (_, "floor") => FLOOR,
        (_, "robot_base") => DARK,
        (_, name) if name.starts_with("machine_") || name == "tool_drum" => MACHINE,
        _ if block.size.min() >= 8.0 => BENCH,
        _ => STEEL,
    }
}

/// The colour of a part, by its family.
fn part_colour(kind: &PartType) -> &'static str {
    match Family::of(kind) {
        Family::Tool => "0.82 0.23 0.20 1",
        Family::Round => "0.85 0.66 0.16 1",
        Family::Block => "0.47 0.32 0.72 1",
        Family::Bar => "0.18 0.62 0.34 1",
    }
}

/// Range, speed and effort of a joint: radians or metres.
pub(super) struct Motion {
    pub axis: [f64; 3],
    /// Least and greatest value.
    pub range: (f64, f64),
    /// Greatest speed, rad/s or m/s.
    pub speed: f64,
    /// Greatest force, N, or moment, N·m; 0 where the description does not give it.
    pub effort: f64,
}

/// Writes URDF text.
pub(super) struct Urdf(String);

impl Urdf {
    fn new(name: &str) -> Self {
        Self(format!(
            "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"world\"/>\n",
            escaped(name)
        ))
    }

    fn line(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {text}");
    }

    pub(super) fn begin_link(&mut self, name: &str) {
        self.line(format_args!("<link name=\"{}\">", escaped(name)));
    }

    pub(super) fn end_link(&mut self) {
        self.line(format_args!("</link>"));
    }

    fn block(&mut self, block: &Block, colour: &str) {
        self.shape(&block.frame, &Outline::Box(block.size), colour);
    }

    pub(super) fn shape(&mut self, frame: &Frame, outline: &Outline, colour: &str) {
        let (frame, geometry) = match outline {
            Outline::Box(size) => {
                let size = to_metres(size);
                (*frame, format!("<box size=\"{} {} {}\"/>", size.x, size.y, size.z))
            }
            Outline::Cylinder(radius, length) => {
                let geometry =
                    format!("<cylinder radius=\"{}\" length=\"{}\"/>", metres(*radius), metres(*length));
                (frame.turned(&along_x()), geometry)
            }
        };
        self.line(format_args!(
            "  <visual>{}<geometry>{geometry}</geometry><material name=\"{1}\"><color rgba=\"{1}\"/></material></visual>",
            origin(&frame),
            colour
        ));
    }

    pub(super) fn joint(
        &mut self,
        name: &str,
        kind: &str,
        parent: &str,
        child: &str,
        start: &Frame,
        motion: Option<Motion>,
    ) {
        let motion = motion.map_or_else(
            String::new,
            |Motion { axis: [x, y, z], range: (low, high), speed, effort }| {
                format!(
                    "<axis xyz=\"{x} {y} {z}\"/><limit lower=\"{low}\" upper=\"{high}\" effort=\"{effort}\" \
                 velocity=\"{speed}\"/>"
                )
            },
        );
        self.line(format_args!(
            "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{}\"/>{}{motion}</joint>",
            escaped(name),
            escaped(child),
            origin(start),
        ));
    }

    fn finish(mut self) -> String {
        self.0.push_str("</robot>\n");
        self.0
    }
}

/// An origin element: metres, and fixed-axis roll, pitch, yaw.
fn origin(frame: &Frame) -> String {
    let p = to_metres(&frame.position);
    let (roll, pitch, yaw) = frame.rotation.euler_angles();
    format!("<origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>", p.x, p.y, p.z)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
