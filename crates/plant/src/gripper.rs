//! A gripper: two coupled fingers, driven by air, and the part that they hold. The robot has three, the pedestal one.
//!
//! [`Air`] converts the flow of the valves ([`Supply`]) to an opening and a force. The fingers are two bodies on
//! springs with the combined stiffness of arm, wrist and fingers: an arm that over-travels by 0.015 in presses with 30
//! lb. Geometry determines when fingers are blocked ([`crate::squeeze`]); the held part is then a [`Hold`].

use geometry::frame::Vector as Inches;
use interfaces::device::GripSensors;
use rapier3d_f64::{math::Rotation, prelude::*};
use serde::{Deserialize, Serialize};

use crate::{
    convert::{KILOGRAMS_PER_POUND, inches, metres, newtons, on_the_side_of, to_inches},
    description::Gripper as Description,
    finger::{Finger, Mount, finger_rest},
    force::Wrench,
    hold::Hold,
    jaws::Supply,
    noise::Noise,
    scene::{PALM, groups},
    sensor::Analog,
};

const FREE_GAP: f64 = 0.001; // fingers farther than this from a blocking part are free, in
/// Speed below which fingers that press a part with their whole force are at rest, in/s.
const SWAY: f64 = 0.05;
/// Time for which seal friction holds freed fingers before trapped air moves them, s.
const BREAKAWAY_TIME: f64 = 0.25;
/// Distance of a body from a finger within which they can touch in the next step, m, without the travel of the hand.
const TOUCHABLE: Real = 2e-3;
/// Fingers can sleep when none of their points has moved faster than this for half a second, m/s (rad/s).
const STILL: Real = 1e-9;
/// Speed of fingers that trapped air drives, in/s. It equals the speed of the coarse flow, because the same ports limit
/// both.
pub const EXPANSION_SPEED: f64 = 4.0;

/// Opening, force and air of the fingers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Air {
    opening: f64,
    force: f64,
    speed: f64,
    relieved: bool,
    free_for: f64,
    range: [f64; 2],
    compressibility: f64,
    greatest_force: f64,
    vent_time: f64,
}

impl Air {
    /// Fingers at rest at the initial opening.
    #[must_use]
    pub fn new(gripper: &Description) -> Self {
        Self {
            opening: gripper.initial_opening,
            force: 0.0,
            speed: 0.0,
            relieved: false,
            free_for: 0.0,
            range: gripper.opening,
            compressibility: gripper.compressibility,
            greatest_force: gripper.greatest_force,
            vent_time: gripper.vent_time_s,
        }
    }

    /// Distance of the finger pads, in.
    #[must_use]
    pub fn opening(&self) -> f64 {
        self.opening
    }

    /// Force of each finger on what blocks it, lb.
    #[must_use]
    pub fn force(&self) -> f64 {
        self.force
    }

    /// True if the force decreased in the last step: a part that then slides is being released.
    #[must_use]
    pub fn relieved(&self) -> bool {
        self.relieved
    }

    /// Opening speed in the last step, in/s.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// True if the fingers did not move in the last step and this supply has no effect. Fingers with their whole force
    /// follow the sway of a part, which is not a motion.
    #[must_use]
    pub fn stands(&self, supply: &Supply) -> bool {
        let presses = supply.flow < 0.0 && self.force >= self.greatest_force;
        let still = self.speed == 0.0 || (presses && self.speed.abs() < SWAY);
        still && !supply.vent && (supply.flow == 0.0 || presses)
    }

    /// Apply a supply for `dt` seconds; `stop` is the opening at which an object between the fingers blocks them.
    pub fn advance(&mut self, dt: f64, supply: Supply, stop: Option<f64>) {
        let (before, force) = (self.opening, self.force);
        let [least, greatest] = self.range;
        if supply.vent {
            self.force = (self.force - self.greatest_force * dt / self.vent_time).max(0.0);
        }
        let stop = stop.map_or(least, |stop| stop.max(least));
        self.expand(dt, stop);
        let wanted = supply.flow * dt;
        if wanted < 0.0 {
            let free = (self.opening - stop).max(0.0).min(-wanted);
            self.opening -= free;
            if self.opening <= stop {
                self.force = (self.force + (-wanted - free) * self.compressibility).min(self.greatest_force);
            }
        } else if wanted > 0.0 {
            let relieved = self.force.min(wanted * self.compressibility);
            self.force -= relieved;
            self.opening = (self.opening + wanted - relieved / self.compressibility).min(greatest);
        }
        self.speed = (self.opening - before) / dt;
        self.relieved = self.force < force;
    }

    /// Trapped air moves fingers that are no longer blocked.
    fn expand(&mut self, dt: f64, stop: f64) {
        let gap = self.opening - stop;
        if self.force <= 0.0 || gap <= FREE_GAP {
            self.free_for = 0.0;
            return;
        }
        self.free_for += dt;
        if self.free_for < BREAKAWAY_TIME {
            return;
        }
        let travel = gap.min(self.force / self.compressibility).min(EXPANSION_SPEED * dt);
        self.opening -= travel;
        self.force -= travel * self.compressibility;
    }

    /// Vent the cylinder: the force is zero, and the fingers do not move.
    pub fn cut(&mut self) {
        (self.force, self.speed, self.relieved) = (0.0, 0.0, false);
    }

    /// A part that was pushed aside between the fingers has spread them to `opening`.
    pub fn spread(&mut self, opening: f64) {
        self.opening = opening.clamp(self.range[0], self.range[1]);
    }
}

impl Description {
    /// Read the sensors of fingers; `beams` has a bit for each interrupted light beam.
    pub fn read(&self, air: &Air, noise: &mut Noise, beams: u8) -> GripSensors {
        let sensors = &self.sensors;
        let analog = |offset, scale| Analog { offset, scale, noise: sensors.noise };
        let potentiometer =
            analog(sensors.potentiometer_offset, sensors.potentiometer_scale).counts(air.opening(), noise);
        if sensors.strain_scales == [0.0; 2] {
            return GripSensors { potentiometer, ..GripSensors::default() };
        }
        let [left_offset, right_offset] = sensors.strain_offsets;
        let [left_scale, right_scale] = sensors.strain_scales;
        GripSensors {
            potentiometer,
            strain_left: analog(left_offset, left_scale).counts(air.force(), noise),
            strain_right: analog(right_offset, right_scale).counts(air.force(), noise),
            beams,
        }
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Gripper {
    description: Description,
    pub air: Air,
    pub hold: Option<(usize, Hold)>, // by its index in the list of parts
    /// True if its slide in this hold was reported.
    pub slip_reported: bool,
    hand: RigidBodyHandle,
    fingers: [Finger; 2],
    shown: (f64, f64),
}

impl Gripper {
    /// Build the gripper at a tool pose, metres. `stiffness` is that of both fingers together at the tips, lb/in;
    /// `group` is the collision group of its bodies, which do not collide with each other.
    pub fn new(
        world: &mut PhysicsWorld,
        description: &Description,
        stiffness: f64,
        tool: &Pose,
        group: Group,
    ) -> Self {
        let [body_x, body_y, body_z] = description.body.map(metres);
        let [finger_x, ..] = description.fingers.map(metres);
        let hand = world.insert_body(RigidBodyBuilder::kinematic_position_based().pose(*tool));
        let body = ColliderBuilder::cuboid(body_x / 2.0, body_y / 2.0, body_z / 2.0)
            .translation(Vector::new(-finger_x - body_x / 2.0, 0.0, 0.0))
            .collision_groups(groups(PALM, Group::ALL & !group));
        world.insert_collider(body, Some(hand));
        let air = Air::new(description);
        let mount = Mount { hand, tool, stiffness, group };
        let fingers = [1.0, -1.0].map(|side| Finger::new(world, description, &mount, side, air.opening()));
        let shown = (air.opening(), 0.0);
        Self { description: description.clone(), air, hold: None, slip_reported: false, hand, fingers, shown }
    }

    #[must_use]
    pub fn hand(&self) -> RigidBodyHandle {
        self.hand
    }

    #[must_use]
    pub fn finger_bodies(&self) -> [RigidBodyHandle; 2] {
        self.fingers.map(|finger| finger.body)
    }

    #[must_use]
    pub fn is_finger(&self, body: RigidBodyHandle) -> bool {
        self.fingers.iter().any(|finger| finger.body == body)
    }

    #[must_use]
    pub fn finger_colliders(&self) -> [ColliderHandle; 2] {
        self.fingers.map(|finger| finger.collider)
    }

    /// Rest poses of the middles of the left and the right finger for the opening of the air, tool frame, m.
    #[must_use]
    pub fn finger_rests(&self) -> [Pose; 2] {
        self.fingers.map(|finger| finger_rest(&self.description, finger.side, self.air.opening()))
    }

    /// From now on the fingers sleep while they are undisturbed; their springs are then not computed.
    pub fn let_fingers_sleep(&self, world: &mut PhysicsWorld) {
        for finger in &self.fingers {
            let activation = world.bodies[finger.body].activation_mut();
            *activation = RigidBodyActivation::active();
            activation.normalized_linear_threshold = STILL;
            activation.angular_threshold = STILL;
        }
    }

    /// Stop the hand: a moving kinematic body keeps attached bodies awake. Only a held part, which may slide, needs
    /// this.
    pub fn stand(&self, world: &mut PhysicsWorld) {
        let led = self.hold.is_some();
        let kind = if led { RigidBodyType::KinematicPositionBased } else { RigidBodyType::Fixed };
        self.become_type(world, kind);
    }

    /// Move the hand to a pose, metres, by the end of the next step.
    pub fn lead(&self, world: &mut PhysicsWorld, tool: &Pose) {
        self.become_type(world, RigidBodyType::KinematicPositionBased);
        self.wake_fingers(world);
        let hand = &mut world.bodies[self.hand];
        let rotation = on_the_side_of(hand.rotation(), tool.rotation);
        hand.set_next_kinematic_position(Pose { rotation, ..*tool });
    }

    fn become_type(&self, world: &mut PhysicsWorld, kind: RigidBodyType) {
        let hand = &mut world.bodies[self.hand];
        if hand.body_type() != kind {
            hand.set_body_type(kind, true);
        }
    }

    fn wake_fingers(&self, world: &mut PhysicsWorld) {
        for finger in &self.fingers {
            world.bodies[finger.body].wake_up(true);
        }
    }

    /// Move empty fingers with the hand if no body is near them; otherwise the springs move them.
    pub fn carry_fingers(&self, world: &mut PhysicsWorld) {
        let hand = &world.bodies[self.hand];
        let travel = (hand.next_position().translation - hand.position().translation).length();
        let is_near = |finger: &Finger| finger.is_near(world, TOUCHABLE + travel);
        if self.fingers.iter().any(is_near) {
            return self.hang_fingers(world);
        }
        self.become_fingers(world, RigidBodyType::KinematicPositionBased);
        let hand = *world.bodies[self.hand].next_position();
        for (finger, rest) in self.fingers.iter().zip(self.finger_rests()) {
            let body = &mut world.bodies[finger.body];
            let next = hand * rest;
            let rotation = on_the_side_of(body.rotation(), next.rotation);
            body.set_next_kinematic_position(Pose { rotation, ..next });
        }
    }

    pub fn hang_fingers(&self, world: &mut PhysicsWorld) {
        self.become_fingers(world, RigidBodyType::Dynamic);
    }

    /// Change the body type of the fingers and enable or disable their joints: without springs they need not be solved.
    fn become_fingers(&self, world: &mut PhysicsWorld, kind: RigidBodyType) {
        for finger in &self.fingers {
            let body = &mut world.bodies[finger.body];
            if body.body_type() == kind {
                continue;
            }
            body.set_body_type(kind, true);
            if let Some(joint) = world.impulse_joints.get_mut(finger.joint, false) {
                joint.data.set_enabled(kind == RigidBodyType::Dynamic);
            }
        }
    }

    /// Set the rest positions of the finger springs from the opening of the air.
    pub fn move_fingers(&mut self, world: &mut PhysicsWorld) {
        let now = (self.air.opening(), self.air.speed());
        if now == self.shown {
            return;
        }
        self.shown = now;
        self.wake_fingers(world);
        for finger in &self.fingers {
            if let Some(joint) = world.impulse_joints.get_mut(finger.joint, false) {
                joint.data.set_local_frame1(finger_rest(&self.description, finger.side, now.0));
                let axis = JointAxis::LinY;
                if let Some(motor) = joint.data.motor(axis).copied() {
                    let speed = metres(finger.side * now.1 / 2.0);
                    joint.data.set_motor(axis, 0.0, speed, motor.stiffness, motor.damping);
                }
            }
        }
    }

    /// Place hand and fingers, at rest, at a tool pose, metres.
    pub fn hang(&self, world: &mut PhysicsWorld, tool: &Pose) {
        world.bodies[self.hand].set_position(*tool, true);
        for (finger, rest) in self.fingers.iter().zip(self.finger_rests()) {
            world.bodies[finger.body].set_position(*tool * rest, true);
        }
    }

    /// Add the bodies to the simulation or remove them. A gripper at rest in its holster needs none.
    pub fn set_present(&self, world: &mut PhysicsWorld, present: bool) {
        for body in [self.hand, self.fingers[0].body, self.fingers[1].body] {
            world.bodies[body].set_enabled(present);
        }
    }

    /// Let the gripper fall freely, as a body of `weight` lb with its fingers.
    pub fn fall(&self, world: &mut PhysicsWorld, weight: f64) {
        let fingers = 2.0 * self.description.finger_weight;
        let own = (weight - fingers).max(0.1 * weight) * KILOGRAMS_PER_POUND;
        for collider in world.bodies[self.hand].colliders().to_vec() {
            world.colliders[collider].set_mass(own);
        }
        world.bodies[self.hand].set_body_type(RigidBodyType::Dynamic, true);
        for finger in &self.fingers {
            world.bodies[finger.body].set_gravity_scale(1.0, true);
        }
    }

    pub fn pick_up(&self, world: &mut PhysicsWorld) {
        world.bodies[self.hand].set_body_type(RigidBodyType::KinematicPositionBased, true);
        for finger in &self.fingers {
            world.bodies[finger.body].set_gravity_scale(0.0, true);
        }
    }

    /// Load on the fingers and the held part, including their weight, at the tool point in the axes of the tool.
    #[must_use]
    pub fn load(&self, world: &PhysicsWorld) -> Wrench {
        let hand = world.bodies[self.hand].position();
        let fingers = self.finger_rests().into_iter().zip(&self.fingers).map(|(rest, finger)| {
            let at = hand.inv_mul(world.bodies[finger.body].position());
            let turn = on_the_side_of(&Rotation::IDENTITY, at.rotation * rest.rotation.inverse());
            let force = (at.translation - rest.translation) * finger.stiffness.linear;
            wrench(at.translation, force, turn.to_scaled_axis() * finger.stiffness.angular)
        });
        let held = self.hold.as_ref().map(|(_, hold)| {
            let (at, force, moment) = hold.carries(world);
            wrench(at, force, moment)
        });
        fingers.chain(held).fold(Wrench::default(), |sum, one| sum.and(&one))
    }

    /// The true tool frame under load, metres: midway between the fingertips.
    #[must_use]
    pub fn loaded_tool(&self, world: &PhysicsWorld) -> Pose {
        let [left, right] = self.fingers.map(|finger| *world.bodies[finger.body].position());
        let offset = |side| finger_rest(&self.description, side, self.air.opening()).inverse();
        (left * offset(1.0)).lerp(&(right * offset(-1.0)), 0.5)
    }

    pub fn sensors(&self, noise: &mut Noise, beams: u8) -> GripSensors {
        self.description.read(&self.air, noise, beams)
    }

    /// Coefficient of friction of the pads.
    #[must_use]
    pub fn friction(&self) -> Real {
        self.description.friction
    }

    #[must_use]
    pub fn force(&self) -> Real {
        newtons(self.air.force())
    }
}

/// A wrench in lb and in·lb from a force (N) and a moment (N·m) at a point (m).
fn wrench(point: Vector, force: Vector, moment: Vector) -> Wrench {
    let pounds = |v: Vector| Inches::new(v.x, v.y, v.z) / newtons(1.0);
    Wrench::at(&to_inches(point), pounds(force), pounds(moment) / metres(1.0))
}

/// Opening between the finger bodies, in: differs from that of the air by the deflection of the springs.
#[must_use]
pub fn body_opening(world: &PhysicsWorld, gripper: &Gripper) -> f64 {
    let [left, right] = gripper.finger_bodies().map(|body| *world.bodies[body].position());
    let across = left.inv_mul(&right).translation;
    inches(across.y.abs()) - gripper.description.fingers[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;
    use interfaces::device::valve;

    fn air() -> Air {
        let cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        Air::new(&cell.gripper.parts)
    }

    fn run(air: &mut Air, seconds: f64, bits: u8, stop: Option<f64>) {
        for _ in 0..(seconds / 0.0025).round() as u32 {
            air.advance(0.0025, Supply::of_bits(bits), stop);
        }
    }

    #[test]
    fn free_fingers_move_to_their_stop() {
        let mut air = air();
        run(&mut air, 0.5, valve::SUPPLY | valve::OPEN_COARSE, None);
        assert!((air.opening() - (0.10 + 0.5 * 4.0)).abs() < 1e-9, "{}", air.opening());
        run(&mut air, 9.0, valve::SUPPLY | valve::OPEN_COARSE, None);
        assert_eq!(air.opening(), 5.0);
    }

    #[test]
    fn open_ports_remove_the_force_but_not_the_fingers() {
        let mut air = air();
        run(&mut air, 0.5, valve::SUPPLY | valve::CLOSE_MEDIUM, None);
        assert!(air.force() > 40.0, "closed on its stop");
        air.cut();
        assert_eq!((air.force(), air.opening()), (0.0, 0.10));
    }

    #[test]
    fn fingers_close_further_after_losing_their_part() {
        let mut air = air();
        run(&mut air, 0.7, valve::SUPPLY | valve::OPEN_MEDIUM, None);
        run(&mut air, 0.475, valve::SUPPLY | valve::CLOSE_MEDIUM, Some(0.625));
        assert!((air.opening() - 0.625).abs() < 1e-9 && (air.force() - 30.0).abs() < 1e-6, "{}", air.force());
        run(&mut air, 1.0, valve::SUPPLY, None);
        assert!(
            (air.opening() - 0.325).abs() < 1e-9 && air.force() < 1e-9,
            "{} {}",
            air.opening(),
            air.force()
        );
    }

    #[test]
    fn blocked_fingers_gain_force_and_keep_it() {
        let mut air = air();
        run(&mut air, 0.5, valve::SUPPLY | valve::OPEN_MEDIUM, None);
        run(&mut air, 0.3, valve::SUPPLY | valve::CLOSE_MEDIUM, Some(0.5));
        assert!((air.opening() - 0.5).abs() < 1e-9);
        assert!((air.force() - 20.0).abs() < 1e-6, "0.1 in of air at 0.2 in of lost way: {}", air.force());
        run(&mut air, 60.0, valve::SUPPLY, Some(0.5));
        assert!((air.force() - 20.0).abs() < 1e-6);
        run(&mut air, 9.0, valve::SUPPLY | valve::CLOSE_COARSE, Some(0.5));
        assert_eq!(air.force(), 80.0);
        run(&mut air, 0.1, valve::SUPPLY | valve::VENT, Some(0.5));
        assert_eq!((air.force(), air.opening()), (0.0, 0.5));
    }
}
