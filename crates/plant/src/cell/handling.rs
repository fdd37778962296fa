//! What the fingers and the vise do to parts: stop at them, take hold, slip, let go.

use rapier3d_f64::prelude::*;

use super::{Cell, CellEvent};
use crate::{
    convert::{inches, metres, on_the_side_of, to_pose},
    hold::{Clamp, Hold, Stiffness},
    part::segment_meets_box,
    squeeze::{Squeeze, squeeze},
    vise::Clamped,
};

/// Below this force of a finger, lb, nothing is held.
const LEAST_FORCE: f64 = 0.25;
/// A slide in the fingers that is worth a word, in.
const SLIP: f64 = 0.02;
/// How far pads may be from a face that they count as touching, m.
const TOUCHING: Real = 1e-4;
/// Fingers and part: stiff enough that a bar sags by 0.01 mm, soft enough that friction is not a jolt.
const FINGER_STIFFNESS: Stiffness = Stiffness { linear: 2.0e5, angular: 500.0 };

impl Cell {
    /// Let the air move the fingers, and take or give up what is between them.
    pub(super) fn drive_fingers(&mut self, dt: f64, valves: u8) {
        let between = match &self.gripper.hold {
            Some((index, _)) => self.between_fingers(*index).map(|squeeze| (*index, squeeze)),
            None => self.first_between_fingers(),
        };
        let stop = between.as_ref().map(|(index, squeeze)| self.finger_stop(*index, squeeze));
        if let (Some(stop), true) = (stop, self.gripper.hold.is_some())
            && (stop - self.gripper.air.opening()).abs() > 1e-5
            && self.gripper.air.force() >= LEAST_FORCE
        {
            // The two fingers are coupled: a part that is pushed off the middle spreads them, and they follow it back.
            self.gripper.air.spread(stop);
        }
        self.gripper.air.advance(dt, valves, stop);
        self.gripper.move_fingers(&mut self.world);
        self.update_grip(between);
    }

    /// What part `index` offers to the fingers.
    fn between_fingers(&self, index: usize) -> Option<Squeeze> {
        let part = self.parts.get(index)?;
        let hand = self.world.bodies[self.gripper.hand()].position();
        squeeze(&hand.inv_mul(&part.pose(&self.world)), part.half(), &self.gripper.pads())
    }

    /// The widest part that stands free between the fingers.
    fn first_between_fingers(&self) -> Option<(usize, Squeeze)> {
        let hand = self.world.bodies[self.gripper.hand()].translation();
        let opening = metres(self.gripper.air.opening());
        let reach = 0.2;
        let near =
            self.parts.iter().enumerate().filter(|(_, part)| {
                (part.pose(&self.world).translation - hand).length() < reach + part.radius()
            });
        near.filter_map(|(index, _)| Some((index, self.between_fingers(index)?)))
            .filter(|(_, squeeze)| {
                squeeze.width <= opening + TOUCHING && squeeze.centre.abs() < opening / 2.0
            })
            .max_by(|(_, a), (_, b)| a.width.total_cmp(&b.width))
    }

    /// Opening at which a part stops the fingers, in. A part that can give way is drawn to the middle; one that is held
    /// elsewhere stops the nearer finger, and the fingers are coupled.
    fn finger_stop(&self, index: usize, squeeze: &Squeeze) -> f64 {
        let fast = self.gripper.hold.is_some() || self.is_clamped(index);
        let aside = if fast { 2.0 * squeeze.centre.abs() } else { 0.0 };
        inches(squeeze.width + aside)
    }

    pub(super) fn is_clamped(&self, index: usize) -> bool {
        self.vise.clamped.is_some_and(|clamped| clamped.part == index)
    }

    pub(super) fn is_held(&self, index: usize) -> bool {
        self.gripper.hold.as_ref().is_some_and(|(held, _)| *held == index)
    }

    /// Take hold, tighten, loosen or let go, as force and geometry have it.
    fn update_grip(&mut self, between: Option<(usize, Squeeze)>) {
        let force = self.gripper.air.force();
        let clamp = Clamp { force: self.gripper.force(), friction: self.gripper.friction() };
        match (self.gripper.hold.is_some(), between) {
            (true, Some((_, squeeze))) if force >= LEAST_FORCE => {
                if let Some((_, hold)) = &mut self.gripper.hold {
                    hold.set_clamp(&mut self.world, clamp, &squeeze);
                }
            }
            (true, between) => self.let_go(between.is_none()),
            (false, Some((index, squeeze)))
                if force >= LEAST_FORCE
                    && self.gripper.air.opening() <= self.finger_stop(index, &squeeze) + 1e-6 =>
            {
                self.take_hold(index, &squeeze, clamp);
            }
            (false, _) => {}
        }
    }

    fn take_hold(&mut self, index: usize, squeeze: &Squeeze, clamp: Clamp) {
        let fast = self.is_clamped(index);
        let part = &self.parts[index];
        part.set_held_by(&mut self.world, true, fast);
        let hand = self.gripper.hand();
        let flush = if fast {
            self.world.bodies[hand].position().inv_mul(&part.pose(&self.world))
        } else {
            let mut flush = squeeze.flush;
            flush.translation.y = 0.0;
            flush
        };
        let mut hold = Hold::new(&mut self.world, hand, part.body, &flush, FINGER_STIFFNESS, part.load());
        hold.set_clamp(&mut self.world, clamp, squeeze);
        self.gripper.hold = Some((index, hold));
        self.slip_reported = false;
    }

    /// Let go of what the fingers hold; `lost` if it was not the fingers that opened.
    pub(super) fn let_go(&mut self, lost: bool) {
        let Some((index, hold)) = self.gripper.hold.take() else { return };
        hold.release(&mut self.world);
        let clamped = self.is_clamped(index);
        let part = &self.parts[index];
        part.set_held_by(&mut self.world, false, clamped);
        if lost {
            self.events.push(CellEvent::Dropped { part: part.kind.name.clone() });
        }
    }

    /// Move the jaw of the vise; it takes along what it reaches, and stops when that lies against the fixed face.
    pub(super) fn drive_jaw(&mut self, dt: f64) {
        if !self.vise.moving() {
            return;
        }
        let between = if self.vise.closing() { self.between_jaws() } else { None };
        self.vise.advance(&mut self.world, dt, between.as_ref().map(|(_, squeeze)| inches(squeeze.width)));
        let Some((index, squeeze)) = between else { return };
        let face = self.vise.fixed_face() + metres(self.vise.opening());
        let middle = face - squeeze.width / 2.0;
        let reached = middle <= squeeze.centre || self.vise.stopped();
        if reached || self.vise.clamped.is_some() {
            self.clamp(index, &squeeze, middle);
        }
    }

    /// The widest part between the clamping faces.
    fn between_jaws(&self) -> Option<(usize, Squeeze)> {
        let base = to_pose(self.vise.frame());
        let pads = self.vise.pads();
        let face = self.vise.fixed_face();
        let far = face + metres(self.vise.opening());
        let inside = |squeeze: &Squeeze| {
            squeeze.centre - squeeze.width / 2.0 > face - 0.002
                && squeeze.centre + squeeze.width / 2.0 < far + 0.002
        };
        self.parts
            .iter()
            .enumerate()
            .filter_map(|(index, part)| {
                let pose = base.inv_mul(&part.pose(&self.world));
                Some((index, squeeze(&pose, part.half(), &pads)?))
            })
            .filter(|(_, squeeze)| inside(squeeze))
            .max_by(|(_, a), (_, b)| a.width.total_cmp(&b.width))
    }

    /// Take a part between the jaws, or lead it on: flush with the faces, its middle at `middle` (m) across them.
    pub(super) fn clamp(&mut self, index: usize, squeeze: &Squeeze, middle: Real) {
        let mut rest = squeeze.flush;
        rest.translation.y = middle;
        let body = self.parts[index].body;
        if self.vise.clamped.is_none() {
            let held = self.is_held(index);
            self.parts[index].set_held_by(&mut self.world, held, true);
            self.world.bodies[body].set_body_type(RigidBodyType::KinematicPositionBased, true);
        }
        self.vise.clamped = Some(Clamped { part: index, rest });
        let body = &mut self.world.bodies[body];
        let mut next = to_pose(self.vise.frame()) * rest;
        next.rotation = on_the_side_of(body.rotation(), next.rotation);
        body.set_next_kinematic_position(next);
    }

    /// Let go of what the vise has.
    pub(super) fn unclamp(&mut self) {
        let Some(Clamped { part, .. }) = self.vise.clamped.take() else { return };
        let held = self.is_held(part);
        if let (true, Some((_, grip))) = (held, &mut self.gripper.hold) {
            grip.recover(&mut self.world);
        }
        self.parts[part].set_held_by(&mut self.world, held, false);
        let body = &mut self.world.bodies[self.parts[part].body];
        body.set_body_type(RigidBodyType::Dynamic, true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(Vector::ZERO, true);
    }

    /// A part that the gripper pushes harder along the jaws than their friction is forced out of them.
    fn resist_in_vise(&mut self) {
        let Some(Clamped { part, .. }) = self.vise.clamped else { return };
        let collider = self.parts[part].collider;
        let fingers = self.gripper.finger_colliders();
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

    /// What part `index` offers to the jaws.
    pub(super) fn between_jaws_of(&self, index: usize) -> Option<Squeeze> {
        let part = self.parts.get(index)?;
        let base = to_pose(self.vise.frame());
        squeeze(&base.inv_mul(&part.pose(&self.world)), part.half(), &self.vise.pads())
    }

    /// After a step: holds that are asked for more than friction gives slide.
    pub(super) fn let_holds_give_way(&mut self) {
        self.resist_in_vise();
        let both = match (&self.gripper.hold, &self.vise.clamped) {
            (Some((gripped, _)), Some(clamped)) => *gripped == clamped.part,
            _ => false,
        };
        let Some((index, hold)) = &mut self.gripper.hold else { return };
        if both {
            // The vise is the stronger: the fingers keep their force, but where the part lies in them is the vise's affair.
            hold.relax(&mut self.world);
            return;
        }
        hold.give_way(&mut self.world);
        let distance = inches(hold.slipped());
        if distance > SLIP && !self.slip_reported && !self.gripper.air.relieved() {
            self.slip_reported = true;
            let part = self.parts[*index].kind.name.clone();
            self.events.push(CellEvent::Slipped { part, distance });
        }
    }

    /// The light beams between the fingers that a part breaks, one bit each.
    pub(super) fn broken_beams(&self) -> u8 {
        let tool = self.gripper.loaded_tool(&self.world);
        let near: Vec<(Pose, Vector)> = self
            .parts
            .iter()
            .map(|part| (tool.inv_mul(&part.pose(&self.world)), part.half()))
            .filter(|(pose, half)| pose.translation.length() < 0.2 + half.length())
            .collect();
        let broken = self
            .gripper
            .beams()
            .map(|(from, to)| near.iter().any(|(pose, half)| segment_meets_box(from, to, pose, *half)));
        broken.enumerate().fold(0, |bits, (beam, is_broken)| bits | (u8::from(is_broken) << beam))
    }

    /// Report parts that have come to lie on the floor.
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
