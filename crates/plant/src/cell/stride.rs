//! Length of a step of the simulation.
//!
//! The description sets the number of sub-steps per tick. The arm always moves in sub-steps. The physics takes a whole
//! tick at once while only kinematic bodies move, a quarter while parts hang free in motionless fingers, and single
//! sub-steps while any body is nearer to the hand than [`NEAR`].

use geometry::frame::Frame;
use interfaces::device::DeviceOutputs;
use rapier3d_f64::{
    parry::bounding_volume::{Aabb, BoundingVolume},
    prelude::*,
};
use rcs_core::tick::TICK_S;

use super::Cell;
use crate::{
    clearance::Body,
    convert::{metres, to_pose},
    hand::Hand,
};

/// Distance to hand, fingers or held part, m, below which contact is possible in the next sub-step.
const NEAR: Real = 0.004;
const SLACK: Real = 0.001; // least distance of the fingers from all bodies in a long step, m
/// Distance from hand, fingers and held part beyond which no body is within reach in a tick, m.
const REACH: Real = 0.5;

struct TickSteps {
    most: u32,                            // greatest number of sub-steps that the physics takes at once
    around: Vec<Aabb>,                    // bounding boxes of all bodies that the hand may approach
    carried: Vec<(ColliderHandle, Pose)>, // colliders of hand and held part, and their poses in the hand
    tool: Frame,                          // the tool frame of the arm after the last sub-step
    /// [`NEAR`], or more if the fingers move by more than that in a tick.
    near: Real,
}

impl Cell {
    pub(super) fn step_bodies(&mut self, outputs: &DeviceOutputs, substeps: u32) {
        let near = self.near_arm();
        let mut stride = self.stride(outputs);
        let mut left = substeps;
        while left > 0 {
            left -= self.step_physics(outputs, &near, &mut stride, left);
        }
    }

    /// Take one step of at most `left` sub-steps; returns their number. `near`: what an arm without pressure may touch.
    fn step_physics(
        &mut self,
        outputs: &DeviceOutputs,
        near: &[Body],
        stride: &mut TickSteps,
        left: u32,
    ) -> u32 {
        let substep = TICK_S / f64::from(self.description.physics.substeps);
        let mut taken = 0;
        while taken < stride.most.min(left) {
            self.t3.advance(substep, &self.loads(near));
            taken += 1;
            if stride.most > 1 && !self.is_clear(stride) {
                stride.most = 1;
            }
        }
        let dt = substep * f64::from(taken);
        self.world.integration_parameters.dt = dt;
        self.change_grippers(dt, &outputs.quick_change);
        self.pedestal.turn(&mut self.world, dt);
        if let Some(hand) = self.changer.mated() {
            self.drive_fingers(dt, hand, hand.supply(&self.description, outputs));
        }
        self.drive_fingers(dt, Hand::Pedestal, Hand::Pedestal.supply(&self.description, outputs));
        self.drive_jaw(dt);
        self.apply_hold_friction(dt);
        self.work_drum(dt);
        self.world.step();
        self.slide_overloaded_holds();
        taken
    }

    fn stride(&self, outputs: &DeviceOutputs) -> TickSteps {
        let most = self.most_at_once(outputs);
        let hand = self.changer.mated().filter(|_| most > 1);
        let carried = hand.map_or_else(Vec::new, |hand| self.carried_by(hand));
        let around = self.around(&carried);
        let flow = hand.map_or(0.0, |hand| hand.supply(&self.description, outputs).flow.abs());
        let near = NEAR.max(SLACK + metres(flow / 2.0 * TICK_S));
        TickSteps { most, around, carried, tool: self.t3.arm().tool(), near }
    }

    fn most_at_once(&self, outputs: &DeviceOutputs) -> u32 {
        let whole = self.description.physics.substeps;
        let always_small = !self.description.physics.long_steps;
        if always_small || !self.t3.arm().has_pressure() || self.something_works(outputs) {
            return 1;
        }
        let is_loose = |body: &RigidBody| body.is_dynamic() && body.is_enabled() && !body.is_sleeping();
        let mut loose = self.world.bodies.iter().filter(|(_, body)| is_loose(body)).peekable();
        if loose.peek().is_none() {
            return whole;
        }
        if loose.all(|(body, _)| self.hangs_free(body, outputs)) { (whole / 4).max(1) } else { 1 }
    }

    /// True if a device other than the arm and the free fingers of its hand moves or is about to move.
    fn something_works(&self, outputs: &DeviceOutputs) -> bool {
        let pedestal = Hand::Pedestal.supply(&self.description, outputs);
        self.vise.moving()
            || self.pedestal.table.moving()
            || !self.pedestal.hand.air.stands(&pedestal)
            || self.drum.tool.is_some_and(|pocketed| !pocketed.fast)
            || !self.changer.rests()
    }

    /// True for a part in the motionless fingers of one hand that touches no other body, and the pedestal's fingers
    /// around it.
    fn hangs_free(&self, body: RigidBodyHandle, outputs: &DeviceOutputs) -> bool {
        self.changer.mated().into_iter().chain([Hand::Pedestal]).any(|hand| {
            let gripper = self.hand(hand);
            // The parts gripper may be about to take a part from the pedestal's hand, so steps are small while
            // it moves.
            let works = if hand == Hand::Pedestal { Hand::Parts } else { hand };
            let Some((index, hold)) = &gripper.hold else { return false };
            let part = &self.parts[*index];
            (part.body == body || (hand == Hand::Pedestal && gripper.is_finger(body)))
                && hold.sticks()
                && gripper.air.stands(&works.supply(&self.description, outputs))
                && !self.is_held_elsewhere(hand, *index)
                && !self.world.contact_pairs_with(part.collider).any(ContactPair::has_any_active_contact)
        })
    }

    fn carried_by(&self, hand: Hand) -> Vec<(ColliderHandle, Pose)> {
        let gripper = self.hand(hand);
        let held = gripper.hold.as_ref().map(|(index, _)| self.parts[*index].collider);
        let palm = self.world.bodies[gripper.hand()].colliders().iter().copied();
        let tool = self.world.bodies[gripper.hand()].position();
        palm.chain(gripper.finger_colliders())
            .chain(held)
            .map(|handle| (handle, tool.inv_mul(self.world.colliders[handle].position())))
            .collect()
    }

    fn around(&self, carried: &[(ColliderHandle, Pose)]) -> Vec<Aabb> {
        let colliders = &self.world.colliders;
        let own = carried.iter().map(|(own, _)| colliders[*own].compute_aabb());
        let Some(reach) = own.reduce(|all, one| all.merged(&one)).map(|all| all.loosened(REACH)) else {
            return Vec::new();
        };
        let others = colliders.iter().filter(|(handle, collider)| {
            collider.is_enabled() && !carried.iter().any(|(own, _)| own == handle)
        });
        others.map(|(_, collider)| collider.compute_aabb()).filter(|other| other.intersects(&reach)).collect()
    }

    fn is_clear(&self, stride: &mut TickSteps) -> bool {
        let tool = self.t3.arm().tool();
        let travel = metres((tool.position - stride.tool.position).norm());
        stride.tool = tool;
        let tool = to_pose(&tool);
        stride.carried.iter().all(|(handle, at)| {
            let own = self.world.colliders[*handle].shape().compute_aabb(&(tool * *at));
            let own = own.loosened(stride.near + 2.0 * travel);
            !stride.around.iter().any(|other| other.intersects(&own))
        })
    }
}
