//! The grippers as the clearance check and the picture see them: worn, and in their holsters.

use rapier3d_f64::prelude::*;
use rcs_core::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::T3,
};

use super::{
    Cell,
    changing::{Place, ROBOT_HANDS},
    handling::Hand,
    picture::{DARK, Link, Outline, STEEL, Urdf, link},
};
use crate::{
    clearance::Mover,
    convert::{metres, to_metres, to_pose},
    description::Gripper,
    gripper::body_opening,
    holster::ears,
    scene::{Block, Obstacle},
};

/// Play of the ears on what carries and leads them, in: less is no contact.
const EAR_PLAY: f64 = 0.06;
/// Size of the camera, in.
const CAMERA: [f64; 3] = [2.0, 2.0, 1.5];

/// Names of the links and the joints of a gripper's left and right finger.
const fn finger_names(hand: Hand) -> [[&'static str; 2]; 2] {
    match hand {
        Hand::Parts => [["left_finger", "left_finger_slide"], ["right_finger", "right_finger_slide"]],
        Hand::V => [["v_left_finger", "v_left_finger_slide"], ["v_right_finger", "v_right_finger_slide"]],
        Hand::Tool => {
            [["tool_left_finger", "tool_left_finger_slide"], ["tool_right_finger", "tool_right_finger_slide"]]
        }
        Hand::Pedestal => [
            ["pedestal_left_finger", "pedestal_left_finger_slide"],
            ["pedestal_right_finger", "pedestal_right_finger_slide"],
        ],
    }
}

fn mover(name: &str, pose: Pose, shape: SharedShape, finger: bool) -> Mover {
    Mover { name: name.into(), pose, shape, carried: false, finger }
}

fn cuboid(size: Inches) -> SharedShape {
    let half = to_metres(&size) / 2.0;
    SharedShape::cuboid(half.x, half.y, half.z)
}

impl Cell {
    /// The tool frame where the arm is, metres: without what the fingers give way.
    fn robot_tool(&self) -> Pose {
        to_pose(&self.t3.arm().tool())
    }

    /// A plate, camera, and the gripper that the robot wears.
    pub(super) fn worn(&self) -> Vec<Mover> {
        let tool = self.robot_tool();
        let plate = self.a_plate();
        // Along the cylinder's Y, as parry has it.
        let along = to_pose(&plate)
            * Pose::from_rotation(rapier3d_f64::math::Rotation::from_rotation_z(
                -core::f64::consts::FRAC_PI_2,
            ));
        let change = &self.description.quick_change;
        let half = metres(change.length / 4.0);
        let camera = to_metres(&Inches::from(self.description.camera.position));
        let mut movers = vec![
            mover("quick_change", tool * along, SharedShape::cylinder(half, metres(change.radius)), false),
            mover("camera", tool * Pose::from_translation(camera), cuboid(Inches::from(CAMERA)), false),
        ];
        let Some(hand) = self.changer.carried() else { return movers };
        let (gripper, description) = (self.hand(hand), self.gripper_description(hand));
        for (place, size) in self.body_boxes(description, 2.0 * EAR_PLAY) {
            movers.push(mover("gripper", tool * to_pose(&place), cuboid(size), false));
        }
        // The fingers give way to what they run into; how deep the arm has led them is what counts.
        let fingers = gripper.finger_rests().into_iter().zip(gripper.finger_colliders());
        for (name, (rest, collider)) in ["left_finger", "right_finger"].into_iter().zip(fingers) {
            movers.push(mover(
                name,
                tool * rest,
                self.world.colliders[collider].shared_shape().clone(),
                true,
            ));
        }
        movers
    }

    /// The A plate, in the tool frame.
    fn a_plate(&self) -> Frame {
        let behind = T3.plate_to_tool - self.description.quick_change.length / 4.0;
        Frame { position: Inches::new(-behind, 0.0, 0.0), rotation: Rotation::identity() }
    }

    /// Body and ears of a gripper, in its tool frame, the ears smaller by `play` inches.
    fn body_boxes(&self, gripper: &Gripper, play: f64) -> Vec<(Frame, Inches)> {
        let middle = Inches::new(-gripper.fingers[0] - gripper.body[0] / 2.0, 0.0, 0.0);
        let body = Frame { position: middle, rotation: Rotation::identity() };
        let ear = Inches::from(self.description.holsters.ears) - Inches::repeat(play);
        let [left, right] = ears(&self.description.holsters, gripper);
        vec![(body, Inches::from(gripper.body)), (left, ear), (right, ear)]
    }

    /// The grippers that the robot does not wear and is not mated with, wherever they are.
    pub(super) fn gripper_obstacles(&self) -> Vec<Obstacle> {
        let apart = ROBOT_HANDS.into_iter().filter(|hand| {
            self.changer.mated() != Some(*hand) && self.changer.place(*hand) != Some(Place::Robot)
        });
        apart
            .flat_map(|hand| {
                let (gripper, description) = (self.hand(hand), self.gripper_description(hand));
                let at = crate::convert::to_frame(self.world.bodies[gripper.hand()].position());
                let change = &self.description.quick_change;
                let plate = Inches::new(-description.plate() - change.length / 4.0, 0.0, 0.0);
                let plate = Frame { position: plate, rotation: Rotation::identity() };
                // The square in the round plate: the camera looks past the round.
                let side = change.radius * core::f64::consts::SQRT_2;
                let mut boxes = self.body_boxes(description, 0.0);
                boxes.push((plate, Inches::new(change.length / 2.0, side, side)));
                boxes.into_iter().map(move |(place, size)| {
                    Obstacle::from(&Block {
                        name: hand.link().into(),
                        frame: at.compose(&place),
                        size,
                        work_surface: false,
                        jaw: false,
                        strike: None,
                    })
                })
            })
            .collect()
    }

    /// Names and poses of quick change and grippers.
    pub(super) fn gripper_links(&self) -> Vec<Link> {
        let mut links = vec![link("quick_change", "end_plate", &to_pose(&tool_on_end_plate()))];
        for hand in ROBOT_HANDS {
            let gripper = self.hand(hand);
            let at = *self.world.bodies[gripper.hand()].position();
            links.push(link(hand.link(), "world", &at));
            for ([name, _], body) in finger_names(hand).into_iter().zip(gripper.finger_bodies()) {
                links.push(link(name, hand.link(), &at.inv_mul(self.world.bodies[body].position())));
            }
        }
        links
    }

    /// Names and values of the finger joints, m.
    pub(super) fn finger_states(&self) -> Vec<(&'static str, f64)> {
        let fingers = ROBOT_HANDS.into_iter().flat_map(|hand| {
            let half = metres(body_opening(&self.world, self.hand(hand)) / 2.0);
            finger_names(hand).map(|[_, slide]| (slide, half))
        });
        fingers.collect()
    }

    /// Quick change, camera and grippers.
    pub(super) fn urdf_grippers(&self, urdf: &mut Urdf) {
        let change = &self.description.quick_change;
        urdf.begin_link("quick_change");
        urdf.shape(&self.a_plate(), &Outline::Cylinder(change.radius, change.length / 2.0), DARK);
        let camera = Frame {
            position: Inches::from(self.description.camera.position),
            rotation: Rotation::identity(),
        };
        urdf.shape(&camera, &Outline::Box(Inches::from(CAMERA)), DARK);
        urdf.end_link();
        urdf.joint("quick_change_mount", "fixed", "end_plate", "quick_change", &tool_on_end_plate(), None);
        for hand in ROBOT_HANDS {
            self.urdf_gripper(urdf, hand);
        }
    }

    /// Palm and fingers of the pedestal's hand: the robot's fingers come near them, and what it carries is put between them.
    pub(super) fn pedestal_obstacles(&self) -> Vec<Obstacle> {
        let (hand, description) = (&self.pedestal.hand, &self.description.pedestal.hand);
        let at = self.pedestal.frame();
        let (palm, size) = palm(description);
        let palm = (at.compose(&palm), size);
        let fingers = hand
            .finger_rests()
            .map(|rest| (at.compose(&crate::convert::to_frame(&rest)), Inches::from(description.fingers)));
        let named = ["pedestal_hand", "pedestal_left_finger", "pedestal_right_finger"];
        let boxes = named.into_iter().zip([palm].into_iter().chain(fingers));
        let blocks = boxes.map(|(name, (frame, size))| Block {
            name: name.into(),
            frame,
            size,
            work_surface: true,
            jaw: false,
            strike: None,
        });
        blocks.map(|block| Obstacle::from(&block)).collect()
    }

    /// Names and poses of the pedestal's hand and its fingers.
    pub(super) fn pedestal_links(&self) -> Vec<Link> {
        let hand = &self.pedestal.hand;
        let at = *self.world.bodies[hand.hand()].position();
        let mut links = vec![link(Hand::Pedestal.link(), "world", &at)];
        for ([name, _], body) in finger_names(Hand::Pedestal).into_iter().zip(hand.finger_bodies()) {
            links.push(link(name, Hand::Pedestal.link(), &at.inv_mul(self.world.bodies[body].position())));
        }
        links
    }

    /// Names and values of the joints of the pedestal: the table in radians from where its fingers move across the radial
    /// line, the fingers in metres.
    pub(super) fn pedestal_states(&self) -> Vec<(&'static str, f64)> {
        let table = self.pedestal.table.angle() - self.description.pedestal.table.square;
        let half = metres(body_opening(&self.world, &self.pedestal.hand) / 2.0);
        let fingers = finger_names(Hand::Pedestal).map(|[_, slide]| (slide, half));
        [("pedestal_table_turn", table.to_radians())].into_iter().chain(fingers).collect()
    }

    /// The pedestal's hand on its table.
    pub(super) fn urdf_pedestal(&self, urdf: &mut Urdf) {
        let pedestal = &self.description.pedestal;
        let name = Hand::Pedestal.link();
        let (palm, size) = palm(&pedestal.hand);
        urdf.begin_link(name);
        urdf.shape(&palm, &Outline::Box(size), DARK);
        urdf.end_link();
        let (square, limits) = (pedestal.table.square, pedestal.table.limits);
        let range = ((limits[0] - square).to_radians(), (limits[1] - square).to_radians());
        let turn = Some(([1.0, 0.0, 0.0], range));
        urdf.joint("pedestal_table_turn", "revolute", "world", name, &self.pedestal.square_frame(), turn);
        urdf_fingers(urdf, &pedestal.hand, Hand::Pedestal);
    }

    fn urdf_gripper(&self, urdf: &mut Urdf, hand: Hand) {
        let (gripper, change) = (self.gripper_description(hand), &self.description.quick_change);
        let name = hand.link();
        let at = |x: f64, y: f64| Frame { position: Inches::new(x, y, 0.0), rotation: Rotation::identity() };
        urdf.begin_link(name);
        let plate = at(-gripper.plate() - change.length / 4.0, 0.0);
        urdf.shape(&plate, &Outline::Cylinder(change.radius, change.length / 2.0), DARK);
        for (place, size) in self.body_boxes(gripper, 0.0) {
            urdf.shape(&place, &Outline::Box(size), DARK);
        }
        urdf.end_link();
        urdf.joint(&format!("{name}_free"), "floating", "world", name, &Frame::identity(), None);
        urdf_fingers(urdf, gripper, hand);
    }
}

/// The fingers of a hand, each on its slide.
fn urdf_fingers(urdf: &mut Urdf, gripper: &Gripper, hand: Hand) {
    let [length, thickness, width] = gripper.fingers;
    for ([finger, slide], side) in finger_names(hand).into_iter().zip([1.0, -1.0]) {
        urdf.begin_link(finger);
        urdf.shape(&Frame::identity(), &Outline::Box(Inches::new(length, thickness, width)), STEEL);
        urdf.end_link();
        let middle = Inches::new(-length / 2.0, side * thickness / 2.0, 0.0);
        let start = Frame { position: middle, rotation: Rotation::identity() };
        let range = (0.0, metres(gripper.opening[1] / 2.0));
        urdf.joint(slide, "prismatic", hand.link(), finger, &start, Some(([0.0, side, 0.0], range)));
    }
}

/// The body of a hand under its fingers, in its tool frame, and its size.
fn palm(gripper: &Gripper) -> (Frame, Inches) {
    let middle = Inches::new(-gripper.fingers[0] - gripper.body[0] / 2.0, 0.0, 0.0);
    (Frame { position: middle, rotation: Rotation::identity() }, Inches::from(gripper.body))
}

/// The tool frame on the end plate's link.
fn tool_on_end_plate() -> Frame {
    let ahead = Inches::new(T3.yaw_to_plate + T3.plate_to_tool, 0.0, 0.0);
    Frame { position: ahead, rotation: Rotation::identity() }
}
