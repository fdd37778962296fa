//! What the clearance check looks at: everything of the robot that moves, and everything that it can run into.
//!
//! Links of the arm are capsules, hands and furniture boxes, plates and round parts cylinders. Fingers stand where arm and
//! air want them, not where their springs have given way to: how deep the arm has led them into something is what counts.
//! Likewise a part that the robot has stands where it is: it gives way by itself, in the fingers.

use core::f64::consts::{FRAC_PI_2, SQRT_2};

use rapier3d_f64::{math::Rotation as Turn, prelude::*};
use rcs_core::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::T3,
};

use super::{
    Cell, CellEvent,
    changing::{GripperPlace, ROBOT_HANDS},
    outline::{CAMERA, palm},
};
use crate::{
    clearance::{Body, Contact},
    convert::{metres, to_frame, to_metres, to_pose},
    description::{CellDescription, Kind},
    linkage::Chain,
    scene::{Block, jaw_blocks},
};

/// Places in the chain of the arm: see [`Body::chain`].
mod chain {
    pub const TURRET: u8 = 1;
    pub const UPPER_ARM: u8 = 2;
    pub const FOREARM: u8 = 3;
    pub const WRIST: u8 = 4;
    pub const HAND: u8 = 5;
}

/// Everything that stands still: the furniture, and the turret, which is round.
pub(super) fn standing(cell: &CellDescription, furniture: &[Block]) -> Vec<Body> {
    let (radius, half_height) = turret(cell);
    let upright = Pose::from_rotation(Turn::from_rotation_x(FRAC_PI_2));
    let shape = SharedShape::cylinder(metres(half_height), metres(radius));
    let turret = Body::new("turret", Kind::Arm, upright, shape).at(chain::TURRET);
    furniture.iter().map(Body::from).chain([turret]).collect()
}

/// Radius and half height of the turret, which turns about the base axis with the shoulder in its middle, in.
pub(super) fn turret(cell: &CellDescription) -> (f64, f64) {
    let radius = 1.5 * cell.robot.upper_arm_radius;
    (radius, radius)
}

fn cuboid(size: &Inches) -> SharedShape {
    let half = to_metres(size) / 2.0;
    SharedShape::cuboid(half.x, half.y, half.z)
}

/// A cylinder of the simulation lies along its Y; this one along X.
fn along_x(frame: &Frame) -> Pose {
    to_pose(frame) * Pose::from_rotation(Turn::from_rotation_z(-FRAC_PI_2))
}

impl Cell {
    /// Once a tick: see what has been run into.
    pub(super) fn check_clearance(&mut self) {
        let mut obstacles = self.devices();
        obstacles.extend(self.part_bodies());
        obstacles.extend(self.arm_bodies());
        let all = self.obstacles.iter().chain(&obstacles);
        let movers = self.movers();
        let begun = self.clearance.check(&self.description.contact, &movers, all);
        self.events.extend(begun.into_iter().map(CellEvent::Contact));
    }

    /// The robot and what it carries.
    pub(super) fn movers(&self) -> Vec<Body> {
        let mut movers = self.arm_bodies();
        movers.extend(self.worn_bodies());
        movers.extend(self.held_body());
        movers
    }

    /// What moves or is moved, but for arm and parts: jaw, grippers in their holsters, the pedestal's hand.
    pub(super) fn devices(&self) -> Vec<Body> {
        let mut devices = self.jaw_bodies();
        devices.extend(self.stored_gripper_bodies());
        devices.extend(self.pedestal_bodies());
        devices
    }

    /// What of the robot touches what at the end of the last tick, and what is nearer to it than [`Cell::watch_clearance`] asks
    /// for: each pair of names once, where it is deepest, but for pairs that may always touch. The truth: a T3 has no sensor
    /// for it.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        self.clearance.contacts()
    }

    /// From now on [`Cell::contacts`] has what is nearer than `margin` inches too.
    pub fn watch_clearance(&mut self, margin: f64) {
        self.clearance.watch(margin);
    }

    /// Upper arm, forearm and wrist.
    pub(super) fn arm_bodies(&self) -> Vec<Body> {
        let [_, upper, fore, _, _, plate] = Chain::new(&self.joints()).frames().map(|frame| to_pose(&frame));
        let robot = &self.description.robot;
        let capsule = |name: &'static str, pose: Pose, from: f64, to: f64, radius: f64| {
            let shape =
                SharedShape::capsule(Vector::X * metres(from), Vector::X * metres(to), metres(radius));
            Body::new(name, Kind::Arm, pose, shape)
        };
        let upper = capsule("upper_arm", upper, T3.upper_arm / 4.0, T3.upper_arm, robot.upper_arm_radius);
        let fore = capsule("forearm", fore, 0.0, T3.forearm, robot.forearm_radius);
        // Its round end is behind the end plate, before which the quick change sits.
        let end = T3.yaw_to_plate - robot.wrist_radius;
        let wrist = capsule("wrist", plate, 0.0, end, robot.wrist_radius);
        vec![upper.at(chain::UPPER_ARM), fore.at(chain::FOREARM), wrist.at(chain::WRIST)]
    }

    /// A plate, camera, and the gripper that the robot wears.
    fn worn_bodies(&self) -> Vec<Body> {
        let arm = self.t3.arm().tool();
        let tool = to_pose(&arm);
        let change = &self.description.quick_change;
        let plate = SharedShape::cylinder(metres(change.length / 4.0), metres(change.radius));
        let camera = to_metres(&Inches::from(self.description.camera.position));
        let camera = tool * Pose::from_translation(camera);
        let mut bodies = vec![
            Body::new("quick_change", Kind::Gripper, along_x(&arm.compose(&self.a_plate())), plate),
            Body::new("camera", Kind::Gripper, camera, cuboid(&Inches::from(CAMERA))),
        ];
        if let Some(hand) = self.changer.carried() {
            let (gripper, description) = (self.hand(hand), self.gripper_description(hand));
            bodies.extend(self.body_boxes(description).into_iter().map(|(place, size)| {
                Body::new("gripper_body", Kind::Gripper, tool * to_pose(&place), cuboid(&size))
            }));
            let fingers = gripper.finger_rests().into_iter().zip(gripper.finger_colliders());
            bodies.extend(["left_finger", "right_finger"].into_iter().zip(fingers).map(
                |(name, (rest, collider))| {
                    let shape = self.world.colliders[collider].shared_shape().clone();
                    Body::new(name, Kind::Finger, tool * rest, shape)
                },
            ));
        }
        bodies.into_iter().map(|body| body.at(chain::HAND)).collect()
    }

    /// The part that the robot has.
    fn held_body(&self) -> Option<Body> {
        let (index, _) = self.hand(self.changer.carried()?).hold.as_ref()?;
        Some(self.part_body(*index, Kind::HeldPart).at(chain::HAND))
    }

    /// The parts that the robot does not have.
    fn part_bodies(&self) -> impl Iterator<Item = Body> {
        let others = (0..self.parts.len()).filter(|index| !self.is_held(*index));
        others.map(|index| self.part_body(index, Kind::Part))
    }

    fn part_body(&self, index: usize, kind: Kind) -> Body {
        let part = &self.parts[index];
        let (shape, turn) = part.solid().shape();
        Body::new(part.kind.name.clone(), kind, part.pose(&self.world) * turn, shape)
    }

    /// The movable jaw where it is now.
    pub(super) fn jaw_bodies(&self) -> Vec<Body> {
        let jaw = to_frame(self.world.bodies[self.vise.jaw()].position());
        jaw_blocks(&self.description.vise).iter().map(|block| Body::from(&block.moved(&jaw))).collect()
    }

    /// The grippers that the robot does not wear and is not mated with, wherever they are.
    fn stored_gripper_bodies(&self) -> impl Iterator<Item = Body> {
        let apart = ROBOT_HANDS.into_iter().filter(|hand| {
            self.changer.mated() != Some(*hand) && self.changer.place(*hand) != Some(GripperPlace::Robot)
        });
        apart.flat_map(|hand| {
            let (gripper, description) = (self.hand(hand), self.gripper_description(hand));
            let at = *self.world.bodies[gripper.hand()].position();
            let change = &self.description.quick_change;
            let plate = Inches::new(-description.plate() - change.length / 4.0, 0.0, 0.0);
            let plate = Frame { position: plate, rotation: Rotation::identity() };
            // The square in the round plate: the camera looks past the round.
            let side = change.radius * SQRT_2;
            let mut boxes = self.body_boxes(description);
            boxes.push((plate, Inches::new(change.length / 2.0, side, side)));
            boxes.into_iter().map(move |(place, size)| {
                Body::new(hand.link(), Kind::StoredGripper, at * to_pose(&place), cuboid(&size))
            })
        })
    }

    /// Palm and fingers of the pedestal's hand: the robot's fingers come near them, and what it carries is put between them.
    fn pedestal_bodies(&self) -> [Body; 3] {
        let description = &self.description.pedestal.hand;
        let at = to_pose(&self.pedestal.frame());
        let (place, size) = palm(description);
        let [left, right] = self.pedestal.hand.finger_rests().map(|rest| at * rest);
        let finger = |name, pose| {
            Body::new(name, Kind::PedestalFinger, pose, cuboid(&Inches::from(description.fingers)))
        };
        [
            Body::new("pedestal_hand", Kind::PedestalHand, at * to_pose(&place), cuboid(&size)),
            finger("pedestal_left_finger", left),
            finger("pedestal_right_finger", right),
        ]
    }
}
