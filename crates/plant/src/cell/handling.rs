//! Parts in hands and vise: blocking, gripping, slipping, releasing.
//!
//! During a handover both hands hold the part; a part can also be in a hand and in the vise:
//!
//! * a hand that closes on a part held by something else stops where its nearer finger touches, and draws the part to
//!   its middle when the other holder releases it;
//! * the vise is stronger than a hand: the rest position of the hand's springs follows the part in the vise;
//! * two hands both hold by their springs, and each slides beyond its friction.

use rapier3d_f64::prelude::*;

use super::{Cell, CellEvent};
use crate::{
    convert::{inches, on_the_side_of, to_pose},
    grasp::{self, Grasp},
    gripper::Gripper,
    hand::{HANDS, Hand, ROBOT_HANDS},
    hold::{Clamp, Hold, Stiffness},
    jaws::Supply,
    scene::{FINGER, HAND, JAW},
    squeeze::{Squeeze, squeeze},
    vise::Clamped,
};

const SLIP: f64 = 0.02; // least slide of a part in the fingers that is reported, in
const JAW_WAIT_LIMIT: u32 = 50; // ticks after which the vise reports a jaw that does not move (2 s)
/// Greatest penetration of a part into a clamping face at which it is still between the jaws, m.
const OUTSIDE: Real = 2e-3;
/// A part is also in a step of the jaws if it covers this fraction of the largest area that it covers in any step.
const LEAST_SHARE: Real = 0.25;
/// Stiffness of the springs between fingers and part: a bar sags by only 0.01 mm, and friction does not jolt it.
const FINGER_STIFFNESS: Stiffness = Stiffness { linear: 2.0e5, angular: 500.0 };

impl Cell {
    pub(super) fn hand(&self, hand: Hand) -> &Gripper {
        hand.slot().map_or(&self.pedestal.hand, |slot| &self.grippers[slot])
    }

    pub(super) fn hand_at_work(&mut self, hand: Hand) -> (&mut Gripper, &mut PhysicsWorld) {
        let gripper = match hand.slot() {
            Some(slot) => &mut self.grippers[slot],
            None => &mut self.pedestal.hand,
        };
        (gripper, &mut self.world)
    }

    pub(super) fn drive_fingers(&mut self, dt: f64, hand: Hand, supply: Supply) {
        let between = match &self.hand(hand).hold {
            Some((index, _)) => self.between_fingers(hand, *index).map(|squeeze| (*index, squeeze)),
            None => self.first_between_fingers(hand),
        };
        let stop = between.as_ref().map(|(index, squeeze)| self.finger_stop(hand, *index, squeeze));
        let (gripper, world) = self.hand_at_work(hand);
        grasp::drive(&mut gripper.air, dt, supply, stop, gripper.hold.is_some());
        gripper.move_fingers(world);
        if hand != Hand::Pedestal {
            gripper.carry_fingers(world);
        }
        self.update_grip(hand, between, stop);
    }

    fn between_fingers(&self, hand: Hand, index: usize) -> Option<Squeeze> {
        let part = self.parts.get(index)?;
        let gripper = self.hand(hand);
        let tool = self.world.bodies[gripper.hand()].position();
        squeeze(
            &tool.inv_mul(&part.pose(&self.world)),
            &part.solid(),
            &grasp::pads(hand.description(&self.description)),
        )
    }

    fn first_between_fingers(&self, of: Hand) -> Option<(usize, Squeeze)> {
        let hand = self.world.bodies[self.hand(of).hand()].translation();
        let near = self.parts.iter().enumerate().filter(|(_, part)| {
            grasp::is_near((part.pose(&self.world).translation - hand).length(), part.radius())
        });
        let between = near.filter_map(|(index, _)| Some((index, self.between_fingers(of, index)?)));
        grasp::widest(self.hand(of).air.opening(), between)
    }

    fn finger_stop(&self, hand: Hand, index: usize, squeeze: &Squeeze) -> f64 {
        grasp::stop(squeeze, self.hand(hand).hold.is_some() || self.is_held_elsewhere(hand, index))
    }

    pub(super) fn is_clamped(&self, index: usize) -> bool {
        self.vise.clamped.is_some_and(|clamped| clamped.part == index)
    }

    pub(super) fn is_held_by(&self, hand: Hand, index: usize) -> bool {
        self.hand(hand).hold.as_ref().is_some_and(|(held, _)| *held == index)
    }

    pub(super) fn is_held(&self, index: usize) -> bool {
        ROBOT_HANDS.into_iter().any(|hand| self.is_held_by(hand, index))
    }

    pub(super) fn is_held_elsewhere(&self, hand: Hand, index: usize) -> bool {
        self.is_clamped(index)
            || self.is_in_drum(index)
            || hand.others().any(|other| self.is_held_by(other, index))
    }

    pub(super) fn is_held_or_clamped(&self, index: usize) -> bool {
        self.is_clamped(index)
            || self.is_in_drum(index)
            || HANDS.iter().any(|hand| self.is_held_by(*hand, index))
    }

    /// Update the part indices of the holders after the list of parts has changed.
    pub(super) fn renumber(&mut self, place: impl Fn(usize) -> usize) {
        for hand in HANDS {
            if let (Gripper { hold: Some((held, _)), .. }, _) = self.hand_at_work(hand) {
                *held = place(*held);
            }
        }
        if let Some(clamped) = &mut self.vise.clamped {
            clamped.part = place(clamped.part);
        }
        if let Some(tool) = &mut self.drum.tool {
            tool.part = place(tool.part);
        }
    }

    /// Disable collisions between a part and its holders.
    pub(super) fn note_holders(&mut self, index: usize) {
        let mut holders = Group::empty();
        holders.set(FINGER, self.is_held(index));
        holders.set(HAND, self.is_held_by(Hand::Pedestal, index));
        holders.set(JAW, self.is_clamped(index));
        self.parts[index].set_holders(&mut self.world, holders);
    }

    fn update_grip(&mut self, hand: Hand, between: Option<(usize, Squeeze)>, stop: Option<f64>) {
        let gripper = self.hand(hand);
        let clamp = Clamp { force: gripper.force(), friction: gripper.friction() };
        match (grasp::decide(gripper.hold.is_some(), stop, &gripper.air), between) {
            (Grasp::Keep, Some((_, squeeze))) => {
                let (gripper, world) = self.hand_at_work(hand);
                if let Some((_, hold)) = &mut gripper.hold {
                    hold.set_clamp(world, clamp, &squeeze);
                }
            }
            (Grasp::Take, Some((index, squeeze))) => self.take_hold(hand, index, &squeeze, clamp),
            (Grasp::Release, between) => self.let_go(hand, between.is_none()),
            _ => {}
        }
    }

    fn take_hold(&mut self, hand: Hand, index: usize, squeeze: &Squeeze, clamp: Clamp) {
        let fast = self.is_held_elsewhere(hand, index);
        let part = &self.parts[index];
        let (body, pose, load) = (part.body, part.pose(&self.world), part.load());
        let (gripper, world) = self.hand_at_work(hand);
        let pads = gripper.hand();
        let flush = if fast { world.bodies[pads].position().inv_mul(&pose) } else { grasp::drawn(squeeze) };
        let mut hold = Hold::new(world, pads, body, &flush, FINGER_STIFFNESS, load);
        hold.set_clamp(world, clamp, squeeze);
        gripper.hold = Some((index, hold));
        gripper.slip_reported = false;
        self.note_holders(index);
    }

    pub(super) fn let_go(&mut self, hand: Hand, lost: bool) {
        let (gripper, world) = self.hand_at_work(hand);
        let Some((index, hold)) = gripper.hold.take() else { return };
        hold.release(world);
        self.note_holders(index);
        if !self.is_clamped(index) {
            hand.others().for_each(|other| self.recover(other, index));
        }
        if lost {
            let part = self.parts[index].kind.name.clone();
            self.events.push(CellEvent::Dropped { part, hand: hand.name().into() });
        }
    }

    /// Called when the other holder has released the part. The part then moves to the middle of `hand`.
    pub(super) fn recover(&mut self, hand: Hand, index: usize) {
        let (gripper, world) = self.hand_at_work(hand);
        if let Some((_, hold)) = gripper.hold.as_mut().filter(|(held, _)| *held == index) {
            hold.recover(world);
        }
    }

    /// Move the jaw of the vise. It pushes a part along, and stops when the part touches the fixed face.
    pub(super) fn drive_jaw(&mut self, dt: f64) {
        if !self.vise.moving() {
            return;
        }
        if self.faults.jaw_stuck() {
            return;
        }
        let between = if self.vise.closing() { self.between_jaws() } else { None };
        let stop = between.as_ref().map(|(_, step, squeeze)| self.vise.stop(*step, squeeze.width));
        self.vise.advance(&mut self.world, dt, stop);
        let Some((index, step, squeeze)) = between else { return };
        let middle = self.vise.movable_face(step) - squeeze.width / 2.0;
        let reached = middle <= squeeze.centre || self.vise.stopped();
        if reached || self.vise.clamped.is_some() {
            self.clamp(index, step, &squeeze, middle);
        }
    }

    /// The part that stops the jaw first, with its step and geometry. The step is the shallowest of those whose faces
    /// the part covers well.
    fn between_jaws(&self) -> Option<(usize, usize, Squeeze)> {
        let standing = (0..self.parts.len()).filter_map(|index| {
            let offers: Vec<_> = self
                .vise
                .steps()
                .filter_map(|step| Some((step, self.between_jaws_of(index, step)?)))
                .collect();
            let most = offers.iter().map(|(_, squeeze)| squeeze.area).fold(0.0, f64::max);
            let covered = offers.into_iter().filter(|(_, squeeze)| squeeze.area >= LEAST_SHARE * most);
            let depth = |step: usize| self.vise.depth(step);
            let (step, squeeze) = covered.min_by(|(a, _), (b, _)| depth(*a).total_cmp(&depth(*b)))?;
            let (face, far) = (self.vise.fixed_face(step), self.vise.movable_face(step));
            let inside = squeeze.centre - squeeze.width / 2.0 > face - OUTSIDE
                && squeeze.centre + squeeze.width / 2.0 < far + OUTSIDE;
            inside.then_some((index, step, squeeze))
        });
        let stop = |(_, step, squeeze): &(usize, usize, Squeeze)| self.vise.stop(*step, squeeze.width);
        standing.max_by(|a, b| stop(a).total_cmp(&stop(b)))
    }

    /// Clamp a part between the jaws, or move it with them; `middle` (m) is its middle across them.
    pub(super) fn clamp(&mut self, index: usize, step: usize, squeeze: &Squeeze, middle: Real) {
        let mut rest = squeeze.flush;
        rest.translation.y = middle;
        let body = self.parts[index].body;
        let taken = self.vise.clamped.is_none();
        self.vise.clamped = Some(Clamped { part: index, step, rest });
        if taken {
            self.note_holders(index);
            self.world.bodies[body].set_body_type(RigidBodyType::KinematicPositionBased, true);
        }
        let body = &mut self.world.bodies[body];
        let mut next = to_pose(self.vise.frame()) * rest;
        next.rotation = on_the_side_of(body.rotation(), next.rotation);
        body.set_next_kinematic_position(next);
    }

    pub(super) fn unclamp(&mut self) {
        let Some(Clamped { part, .. }) = self.vise.clamped.take() else { return };
        for hand in HANDS {
            self.recover(hand, part);
        }
        self.note_holders(part);
        let body = &mut self.world.bodies[self.parts[part].body];
        body.set_body_type(RigidBodyType::Dynamic, true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(Vector::ZERO, true);
    }

    /// Force a part out of the jaws if the gripper pushes it harder along them than their friction.
    fn resist_in_vise(&mut self) {
        let Some(Clamped { part, .. }) = self.vise.clamped else { return };
        let collider = self.parts[part].collider;
        let Some(hand) = self.changer.carried() else { return };
        let fingers = self.hand(hand).finger_colliders();
        let pushes = self
            .world
            .contact_pairs_with(collider)
            .filter(|pair| fingers.contains(&pair.collider1) || fingers.contains(&pair.collider2));
        let impulse: Vector = pushes.map(ContactPair::total_impulse).sum();
        let along = libm::hypot(impulse.x, impulse.z) / self.world.integration_parameters.dt;
        if along > self.vise.friction_limit() {
            self.unclamp();
            self.events.push(CellEvent::ForcedOut { part: self.parts[part].kind.name.clone() });
        }
    }

    pub(super) fn between_jaws_of(&self, index: usize, step: usize) -> Option<Squeeze> {
        let part = self.parts.get(index)?;
        let base = to_pose(self.vise.frame());
        squeeze(&base.inv_mul(&part.pose(&self.world)), &part.solid(), &self.vise.pads(step))
    }

    pub(super) fn apply_hold_friction(&mut self, dt: f64) {
        for hand in HANDS {
            let (gripper, world) = self.hand_at_work(hand);
            if let Some((_, hold)) = &mut gripper.hold {
                hold.rub(world, dt);
            }
        }
    }

    /// After a time step: holds whose load exceeds friction slide.
    pub(super) fn slide_overloaded_holds(&mut self) {
        self.resist_in_vise();
        for hand in HANDS {
            self.slide_overloaded_hold(hand);
        }
    }

    fn slide_overloaded_hold(&mut self, hand: Hand) {
        let clamped = self.vise.clamped.map(|clamped| clamped.part);
        let (gripper, world) = self.hand_at_work(hand);
        let Some((index, hold)) = &mut gripper.hold else { return };
        if clamped == Some(*index) {
            // The vise is stronger: the fingers keep their force, but the vise determines the position of the part.
            hold.relax(world);
            return;
        }
        hold.give_way(world);
        let distance = inches(hold.slipped());
        if distance > SLIP && !gripper.slip_reported && !gripper.air.relieved() {
            gripper.slip_reported = true;
            let index = *index;
            let part = self.parts[index].kind.name.clone();
            self.events.push(CellEvent::Slipped { part, hand: hand.name().into(), distance });
        }
    }

    pub(super) fn broken_beams(&self) -> u8 {
        let gripper = self.hand(Hand::Parts);
        let tool = gripper.loaded_tool(&self.world);
        let parts = self.parts.iter().map(|part| (tool.inv_mul(&part.pose(&self.world)), part.half()));
        grasp::broken_beams(gripper.air.opening(), parts)
    }

    pub(super) fn note_jaw(&mut self) {
        let stands = self.vise.moving() && self.faults.jaw_stuck();
        self.jaw_waits = if stands { self.jaw_waits + 1 } else { 0 };
        if self.jaw_waits == JAW_WAIT_LIMIT {
            self.events.push(CellEvent::ViseStuck);
        }
    }

    pub(super) fn note_falls(&mut self) {
        for index in 0..self.parts.len() {
            let on_floor = self.part_state(index).location == "floor";
            let part = &mut self.parts[index];
            if on_floor && !part.fallen {
                self.events.push(CellEvent::Fell { part: part.kind.name.clone() });
            }
            part.fallen = on_floor;
        }
    }
}
