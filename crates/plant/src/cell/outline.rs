//! The grippers in the URDF, on the robot and in their holsters, and their boxes.

use geometry::{
    frame::{Frame, Rotation, Vector as Inches},
    kinematics::T3,
};

use super::{
    Cell,
    picture::{DARK, Link, Motion, Outline, STEEL, Urdf, link},
};
use crate::{
    bodies::{CAMERA, a_plate, body_boxes, palm},
    convert::{metres, newtons, to_pose},
    description::Gripper,
    gripper::{EXPANSION_SPEED, body_opening},
    hand::{Hand, ROBOT_HANDS},
};

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

impl Cell {
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
        urdf.shape(&a_plate(&self.description), &Outline::Cylinder(change.radius, change.length / 2.0), DARK);
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

    /// Names and values of the joints of the pedestal: the table in radians, 0 where the fingers move across the radial
    /// line; the fingers in metres.
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
        let speed = (pedestal.table.speed * pedestal.table.flip[1] / pedestal.table.flip[0]).to_radians();
        let turn = Some(Motion { axis: [1.0, 0.0, 0.0], range, speed, effort: 0.0 });
        urdf.joint("pedestal_table_turn", "revolute", "world", name, &self.pedestal.square_frame(), turn);
        urdf_fingers(urdf, &pedestal.hand, Hand::Pedestal);
    }

    fn urdf_gripper(&self, urdf: &mut Urdf, hand: Hand) {
        let (gripper, change) = (hand.description(&self.description), &self.description.quick_change);
        let name = hand.link();
        let at = |x: f64, y: f64| Frame { position: Inches::new(x, y, 0.0), rotation: Rotation::identity() };
        urdf.begin_link(name);
        let plate = at(-gripper.plate() - change.length / 4.0, 0.0);
        urdf.shape(&plate, &Outline::Cylinder(change.radius, change.length / 2.0), DARK);
        for (place, size) in body_boxes(&self.description, gripper) {
            urdf.shape(&place, &Outline::Box(size), DARK);
        }
        urdf.end_link();
        urdf.joint(&format!("{name}_free"), "floating", "world", name, &Frame::identity(), None);
        urdf_fingers(urdf, gripper, hand);
    }
}

/// The fingers of a hand, each with a prismatic joint.
fn urdf_fingers(urdf: &mut Urdf, gripper: &Gripper, hand: Hand) {
    let [length, thickness, width] = gripper.fingers;
    for ([finger, slide], side) in finger_names(hand).into_iter().zip([1.0, -1.0]) {
        urdf.begin_link(finger);
        urdf.shape(&Frame::identity(), &Outline::Box(Inches::new(length, thickness, width)), STEEL);
        urdf.end_link();
        let middle = Inches::new(-length / 2.0, side * thickness / 2.0, 0.0);
        let start = Frame { position: middle, rotation: Rotation::identity() };
        let range = (0.0, metres(gripper.opening[1] / 2.0));
        let effort = newtons(gripper.greatest_force);
        let motion = Motion { axis: [0.0, side, 0.0], range, speed: metres(EXPANSION_SPEED), effort };
        urdf.joint(slide, "prismatic", hand.link(), finger, &start, Some(motion));
    }
}

/// The tool frame on the end plate's link.
fn tool_on_end_plate() -> Frame {
    let ahead = Inches::new(T3.yaw_to_plate + T3.plate_to_tool, 0.0, 0.0);
    Frame { position: ahead, rotation: Rotation::identity() }
}
