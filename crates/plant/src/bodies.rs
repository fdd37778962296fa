//! Collision shapes of robot and devices, from the cell description and their positions. The simulated cell and the
//! path check ([`crate::room`]) share them. Links are capsules, hands and furniture boxes.

use core::f64::consts::{FRAC_PI_2, SQRT_2};

use geometry::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::{Joints, T3},
};
use rapier3d_f64::{math::Rotation as Turn, prelude::*};

use crate::{
    clearance::Body,
    convert::{metres, to_metres, to_pose},
    description::{CellDescription, Gripper, Kind, PartType},
    finger::finger_rest,
    holster::ears,
    linkage::Chain,
    scene::{Block, jaw_blocks},
    solid::Solid,
};

pub const CAMERA: [f64; 3] = [2.0, 2.0, 1.5];

/// Positions of the links in the chain of the arm: see [`Body::chain`].
mod chain {
    pub const TURRET: u8 = 1;
    pub const UPPER_ARM: u8 = 2;
    pub const FOREARM: u8 = 3;
    pub const WRIST: u8 = 4;
    pub const HAND: u8 = 5;
}

#[must_use]
pub fn standing(cell: &CellDescription, furniture: &[Block]) -> Vec<Body> {
    let (radius, half_height) = turret(cell);
    let upright = Pose::from_rotation(Turn::from_rotation_x(FRAC_PI_2));
    let shape = SharedShape::cylinder(metres(half_height), metres(radius));
    let turret = Body::new("turret", Kind::Arm, upright, shape).at(chain::TURRET);
    furniture.iter().map(Body::from).chain([turret]).collect()
}

/// Radius and half height of the turret, in. It turns about the base axis; the shoulder is at its middle.
#[must_use]
pub fn turret(cell: &CellDescription) -> (f64, f64) {
    let radius = 1.5 * cell.robot.upper_arm_radius;
    (radius, radius)
}

fn cuboid(size: &Inches) -> SharedShape {
    let half = to_metres(size) / 2.0;
    SharedShape::cuboid(half.x, half.y, half.z)
}

/// The pose, m, of a cylinder whose axis is the X axis of `frame` (in): cylinders of the simulation lie along Y.
fn along_x(frame: &Frame) -> Pose {
    to_pose(frame) * Pose::from_rotation(Turn::from_rotation_z(-FRAC_PI_2))
}

/// Upper arm, forearm and wrist for joint angles in radians.
#[must_use]
pub fn arm(cell: &CellDescription, joints: &Joints) -> [Body; 3] {
    let [_, upper, fore, _, _, plate] = Chain::new(joints).frames().map(|frame| to_pose(&frame));
    let robot = &cell.robot;
    let capsule = |name: &'static str, pose: Pose, from: f64, to: f64, radius: f64| {
        let shape = SharedShape::capsule(Vector::X * metres(from), Vector::X * metres(to), metres(radius));
        Body::new(name, Kind::Arm, pose, shape)
    };
    let upper = capsule("upper_arm", upper, T3.upper_arm / 4.0, T3.upper_arm, robot.upper_arm_radius);
    let fore = capsule("forearm", fore, 0.0, T3.forearm, robot.forearm_radius);
    // Its round end is above the end plate, on which the quick change is mounted.
    let end = T3.yaw_to_plate - robot.wrist_radius;
    let wrist = capsule("wrist", plate, 0.0, end, robot.wrist_radius);
    [upper.at(chain::UPPER_ARM), fore.at(chain::FOREARM), wrist.at(chain::WRIST)]
}

/// The A plate, in the tool frame.
#[must_use]
pub fn a_plate(cell: &CellDescription) -> Frame {
    let behind = T3.plate_to_tool - cell.quick_change.length / 4.0;
    Frame { position: Inches::new(-behind, 0.0, 0.0), rotation: Rotation::identity() }
}

/// A plate and camera of a robot whose tool frame is `tool`, world, in.
#[must_use]
pub fn quick_change(cell: &CellDescription, tool: &Frame) -> [Body; 2] {
    let change = &cell.quick_change;
    let plate = SharedShape::cylinder(metres(change.length / 4.0), metres(change.radius));
    let camera = to_pose(tool) * Pose::from_translation(to_metres(&Inches::from(cell.camera.position)));
    [
        Body::new("quick_change", Kind::Gripper, along_x(&tool.compose(&a_plate(cell))), plate)
            .at(chain::HAND),
        Body::new("camera", Kind::Gripper, camera, cuboid(&Inches::from(CAMERA))).at(chain::HAND),
    ]
}

#[must_use]
pub fn body_boxes(cell: &CellDescription, gripper: &Gripper) -> [(Frame, Inches); 3] {
    let (body, size) = palm(gripper);
    let ear = Inches::from(cell.holsters.ears);
    let [left, right] = ears(&cell.holsters, gripper);
    [(body, size), (left, ear), (right, ear)]
}

/// Frame, in the tool frame, and size of the body of a hand above its fingers, in.
#[must_use]
pub fn palm(gripper: &Gripper) -> (Frame, Inches) {
    let middle = Inches::new(-gripper.fingers[0] - gripper.body[0] / 2.0, 0.0, 0.0);
    (Frame { position: middle, rotation: Rotation::identity() }, Inches::from(gripper.body))
}

/// The gripper on the robot. Its fingers are at the opening set by the air (in), without the deflection of their
/// springs, because the check needs the depth to which the arm has moved them.
#[must_use]
pub fn worn(cell: &CellDescription, gripper: &Gripper, tool: &Frame, opening: f64) -> Vec<Body> {
    let tool = to_pose(tool);
    let boxes = body_boxes(cell, gripper)
        .into_iter()
        .map(|(place, size)| Body::new("gripper_body", Kind::Gripper, tool * to_pose(&place), cuboid(&size)));
    let fingers = [("left_finger", 1.0), ("right_finger", -1.0)].into_iter().map(|(name, side)| {
        let rest = finger_rest(gripper, side, opening);
        Body::new(name, Kind::Finger, tool * rest, cuboid(&Inches::from(gripper.fingers)))
    });
    boxes.chain(fingers).map(|body| body.at(chain::HAND)).collect()
}

#[must_use]
pub fn part(kind: &PartType, pose: &Pose) -> Body {
    let (shape, turn) = Solid::of(kind).shape();
    Body::new(kind.name.clone(), Kind::Part, *pose * turn, shape)
}

#[must_use]
pub fn held(kind: &PartType, pose: &Pose) -> Body {
    Body { kind: Kind::HeldPart, ..part(kind, pose) }.at(chain::HAND)
}

#[must_use]
pub fn movable_jaw(cell: &CellDescription, jaw: &Frame) -> Vec<Body> {
    jaw_blocks(&cell.vise).iter().map(|block| Body::from(&block.moved(jaw))).collect()
}

#[must_use]
pub fn stored(cell: &CellDescription, gripper: &Gripper, name: &'static str, at: &Pose) -> Vec<Body> {
    let change = &cell.quick_change;
    let plate = Inches::new(-gripper.plate() - change.length / 4.0, 0.0, 0.0);
    let plate = Frame { position: plate, rotation: Rotation::identity() };
    // The inscribed square of the round plate, because the camera's view passes the round plate.
    let side = change.radius * SQRT_2;
    let boxes = body_boxes(cell, gripper).into_iter();
    boxes
        .chain([(plate, Inches::new(change.length / 2.0, side, side))])
        .map(|(place, size)| Body::new(name, Kind::StoredGripper, *at * to_pose(&place), cuboid(&size)))
        .collect()
}

/// Palm and fingers of the pedestal's hand at its frame with an opening in inches.
#[must_use]
pub fn pedestal(cell: &CellDescription, hand: &Frame, opening: f64) -> [Body; 3] {
    let description = &cell.pedestal.hand;
    let at = to_pose(hand);
    let (place, size) = palm(description);
    let finger = |name, side| {
        let pose = at * finger_rest(description, side, opening);
        Body::new(name, Kind::PedestalFinger, pose, cuboid(&Inches::from(description.fingers)))
    };
    [
        Body::new("pedestal_hand", Kind::PedestalHand, at * to_pose(&place), cuboid(&size)),
        finger("pedestal_left_finger", 1.0),
        finger("pedestal_right_finger", -1.0),
    ]
}
