//! The cell for viewers: a tree of links derived from the description. [`Scene::urdf`] prints it, [`Scene::models`]
//! gives meshes ([`crate::look`]); [`furniture`] makes the fixed bodies.

mod furniture;
mod material;
mod moving;
mod urdf;

use core::f64::consts::FRAC_PI_2;

use geometry::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::T3,
};

pub use furniture::{Block, FINGER, HAND, JAW, PALM, PART, WORLD, furniture, groups, jaw_blocks, vise_frame};
pub use material::Material;
pub(crate) use moving::{Finger, Moving};

use crate::{
    bodies::{CAMERA, a_plate, body_boxes, palm, turret},
    cell::part_link,
    convert::{metres, newtons},
    description::{CellDescription, Gripper, PartType},
    gripper::EXPANSION_SPEED,
    hand::Hand,
    linkage::{AXES, STARTS},
    pedestal::hand_frame,
    solid::along,
};

pub const ROOT: &str = "world";

#[derive(Clone, Debug)]
pub struct Scene<'c> {
    pub(crate) cell: &'c CellDescription,
    links: Vec<Link<'c>>,
}

/// A body with a frame of its own.
#[derive(Clone, Debug)]
pub struct Link<'c> {
    pub name: String, // unique in the scene
    /// The link in whose frame its joint starts; [`ROOT`] for the world.
    pub parent: &'static str,
    pub joint: Joint,
    pub visuals: Vec<Visual>,
    pub(crate) body: Body<'c>,
}

#[derive(Clone, Debug)]
pub(crate) enum Body<'c> {
    Moving(Moving),
    Fixed(Block),
    Part(&'c PartType),
}

#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String, // unique in the scene
    pub start: Frame, // the link in its parent with the joint at 0, in
    pub kind: JointKind,
}

#[derive(Clone, Copy, Debug)]
pub enum JointKind {
    Fixed,
    Floating,
    Revolute(Motion),
    Prismatic(Motion),
}

impl JointKind {
    fn name_at(self, link: &str) -> String {
        let suffix = if matches!(self, Self::Fixed) { "mount" } else { "free" };
        format!("{link}_{suffix}")
    }
}

/// Range, speed and effort of a joint: radians or metres.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub axis: [f64; 3], // in the frame of the link
    pub range: (f64, f64),
    /// Greatest speed, rad/s or m/s.
    pub speed: f64,
    /// Greatest force, N, or moment, N·m; 0 where the description does not give it.
    pub effort: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Visual {
    pub frame: Frame, // its place in the link, in
    pub shape: Shape,
    pub colour: Material,
}

/// A simple solid around the origin, in.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A box by its size along the axes.
    Box(Inches),
    /// A cylinder along X: radius and length.
    Cylinder(f64, f64),
}

impl Visual {
    fn cuboid(frame: Frame, size: Inches, colour: Material) -> Self {
        Self { frame, shape: Shape::Box(size), colour }
    }

    fn cylinder(frame: Frame, radius: f64, length: f64, colour: Material) -> Self {
        Self { frame, shape: Shape::Cylinder(radius, length), colour }
    }
}

impl<'c> Scene<'c> {
    /// The scene of a valid description, with parts by their numbers and types.
    #[must_use]
    pub fn new(cell: &'c CellDescription, parts: impl IntoIterator<Item = (u32, &'c PartType)>) -> Self {
        let furniture = furniture(cell);
        let moving = Moving::all().map(|moving| Link::moving(moving, cell, &furniture));
        let mut links: Vec<Link<'c>> = moving.collect();
        links.extend(furniture.into_iter().filter(|block| !block.is_of_vise()).map(Link::fixed));
        links.extend(parts.into_iter().map(|(id, kind)| Link::part(id, kind)));
        Self { cell, links }
    }

    /// All links; a parent is before its children.
    #[must_use]
    pub fn links(&self) -> &[Link<'c>] {
        &self.links
    }

    pub(crate) fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.links.iter().filter_map(|link| match &link.body {
            Body::Fixed(block) => Some(block),
            Body::Moving(_) | Body::Part(_) => None,
        })
    }
}

impl<'c> Link<'c> {
    fn moving(moving: Moving, cell: &CellDescription, furniture: &[Block]) -> Self {
        Self {
            name: moving.name().into(),
            parent: moving.parent(),
            joint: joint(moving, cell),
            visuals: visuals(moving, cell, furniture),
            body: Body::Moving(moving),
        }
    }

    fn fixed(block: Block) -> Self {
        let kind = JointKind::Fixed;
        let joint = Joint { name: kind.name_at(&block.name), start: block.frame, kind };
        let visuals = vec![Visual::cuboid(Frame::identity(), block.size, block.colour())];
        Self { name: block.name.clone(), parent: ROOT, joint, visuals, body: Body::Fixed(block) }
    }

    fn part(id: u32, kind: &'c PartType) -> Self {
        let name = part_link(id);
        let colour = Material::of_part(kind);
        let visual = match along(kind) {
            Some((axis, radius, length)) => Visual::cylinder(axis, radius, length, colour),
            None => Visual::cuboid(Frame::identity(), Inches::from(kind.size), colour),
        };
        let joint = JointKind::Floating;
        let joint = Joint { name: joint.name_at(&name), start: Frame::identity(), kind: joint };
        let body = Body::Part(kind);
        Self { name, parent: ROOT, joint, visuals: vec![visual], body }
    }
}

/// The tool frame on the end plate's link, without the quick change.
pub(crate) fn tool_on_end_plate() -> Frame {
    at(T3.yaw_to_plate + T3.plate_to_tool, 0.0)
}

fn at(x: f64, y: f64) -> Frame {
    Frame { position: Inches::new(x, y, 0.0), rotation: Rotation::identity() }
}

fn joint(moving: Moving, cell: &CellDescription) -> Joint {
    let (start, kind) = match moving {
        Moving::Arm(joint) => {
            let speed = cell.robot.joint_speeds[joint].to_radians();
            let motion = Motion { axis: AXES[joint], range: T3.limits[joint], speed, effort: 0.0 };
            (at(STARTS[joint], 0.0), JointKind::Revolute(motion))
        }
        Moving::QuickChange => (tool_on_end_plate(), JointKind::Fixed),
        Moving::Hand(Hand::Pedestal) => {
            let table = &cell.pedestal.table;
            let range = table.limits.map(|limit| (limit - table.square).to_radians());
            let speed = (table.speed * table.flip[1] / table.flip[0]).to_radians();
            let motion = Motion { axis: [1.0, 0.0, 0.0], range: range.into(), speed, effort: 0.0 };
            (hand_frame(&cell.pedestal, table.square), JointKind::Revolute(motion))
        }
        Moving::Hand(_) => (Frame::identity(), JointKind::Floating),
        Moving::Finger(hand, finger) => {
            let gripper = hand.description(cell);
            let [length, thickness, _] = gripper.fingers;
            let motion = Motion {
                axis: [0.0, finger.sign(), 0.0],
                range: (0.0, metres(gripper.opening[1] / 2.0)),
                speed: metres(EXPANSION_SPEED),
                effort: newtons(gripper.greatest_force),
            };
            (at(-length / 2.0, finger.sign() * thickness / 2.0), JointKind::Prismatic(motion))
        }
        Moving::Vise => (vise_frame(&cell.vise), JointKind::Fixed),
        Moving::Jaw => {
            let vise = &cell.vise;
            let widest = vise.program.iter().map(|program| program.opening_open).fold(0.0, f64::max);
            let motion = Motion {
                axis: [0.0, 1.0, 0.0],
                range: (0.0, metres(widest)),
                speed: metres(vise.speed),
                effort: newtons(vise.force),
            };
            (Frame::identity(), JointKind::Prismatic(motion))
        }
    };
    let name = moving.joint().map_or_else(|| kind.name_at(moving.name()), Into::into);
    Joint { name, start, kind }
}

fn visuals(moving: Moving, cell: &CellDescription, furniture: &[Block]) -> Vec<Visual> {
    let change = &cell.quick_change;
    match moving {
        Moving::Arm(joint) => arm(joint, cell),
        Moving::QuickChange => {
            let [x, y, z] = cell.camera.position;
            let camera = Frame { position: Inches::new(x, y, z), rotation: Rotation::identity() };
            vec![
                Visual::cylinder(a_plate(cell), change.radius, change.length / 2.0, Material::Charcoal),
                Visual::cuboid(camera, Inches::from(CAMERA), Material::Cream),
            ]
        }
        Moving::Hand(Hand::Pedestal) => {
            let (frame, size) = palm(&cell.pedestal.hand);
            vec![Visual::cuboid(frame, size, Material::Charcoal)]
        }
        Moving::Hand(hand) => {
            let gripper = hand.description(cell);
            let plate = at(-gripper.plate() - change.length / 4.0, 0.0);
            let mut visuals =
                vec![Visual::cylinder(plate, change.radius, change.length / 2.0, Material::Steel)];
            let colours = [Material::Charcoal, Material::Yellow, Material::Yellow];
            let boxes = body_boxes(cell, gripper).into_iter().zip(colours);
            visuals.extend(boxes.map(|((frame, size), colour)| Visual::cuboid(frame, size, colour)));
            visuals
        }
        Moving::Finger(hand, _) => {
            let Gripper { fingers: [length, thickness, width], .. } = hand.description(cell);
            let size = Inches::new(*length, *thickness, *width);
            vec![Visual::cuboid(Frame::identity(), size, Material::Steel)]
        }
        Moving::Vise => {
            let inverse = vise_frame(&cell.vise).inverse();
            let blocks =
                furniture.iter().filter(|block| block.is_of_vise()).map(|block| block.moved(&inverse));
            blocks.map(|block| Visual::cuboid(block.frame, block.size, block.colour())).collect()
        }
        Moving::Jaw => {
            let blocks = jaw_blocks(&cell.vise).into_iter();
            blocks.map(|block| Visual::cuboid(block.frame, block.size, block.colour())).collect()
        }
    }
}

/// The shapes of a link of the arm: a cylinder along it, and the axle that it turns about.
fn arm(joint: usize, cell: &CellDescription) -> Vec<Visual> {
    let robot = &cell.robot;
    let (turret_radius, turret_height) = turret(cell);
    let outlines = [
        (turret_radius, 2.0 * turret_height, -turret_height),
        (robot.upper_arm_radius * 0.8, T3.upper_arm, 0.0),
        (robot.forearm_radius, T3.forearm, 0.0),
        (robot.wrist_radius, T3.pitch_to_yaw, 0.0),
        (robot.wrist_radius, 2.0, -1.0),
        (robot.wrist_radius, T3.yaw_to_plate, 0.0),
    ];
    let (radius, length, from) = outlines[joint];
    let turned = |axis, quarter| Frame {
        rotation: Rotation::from_axis_angle(&axis, quarter * FRAC_PI_2),
        ..Frame::identity()
    };
    // The turret is upright.
    let middle = if joint == 0 { turned(Inches::y_axis(), -1.0) } else { at(from + length / 2.0, 0.0) };
    let colour = if joint == 4 { Material::Charcoal } else { Material::Orange };
    let mut visuals = vec![Visual::cylinder(middle, radius, length, colour)];
    let axle = match joint {
        1 => Some(turret_radius + 3.0),
        2 => Some(robot.upper_arm_radius + 1.0),
        _ => None,
    };
    visuals.extend(axle.map(|half| {
        Visual::cylinder(
            turned(Inches::z_axis(), 1.0),
            0.8 * robot.upper_arm_radius,
            2.0 * half,
            Material::Charcoal,
        )
    }));
    visuals
}
