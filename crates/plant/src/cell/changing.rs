//! The bodies of the grippers, on the robot, in a holster or on the floor ([`crate::changer`]).

use geometry::frame::Frame;
use interfaces::device::{HolsterSensors, QuickChangeValves};
use rapier3d_f64::math::{Pose, Vector};

use super::{Cell, CellEvent, WorkstationError};
use crate::{
    convert::{on_the_side_of, to_frame, to_pose},
    hand::{Hand, ROBOT_HANDS},
};

/// Position of a gripper that a person has removed from the cell, m: far below the floor.
const AWAY: Vector = Vector::new(0.0, 0.0, -100.0);

impl Cell {
    pub(super) fn change_grippers(&mut self, dt: f64, valves: &QuickChangeValves) {
        let robot = self.t3.arm().tool();
        let changes = self.changer.advance(dt, &robot, valves);
        if let Some(hand) = changes.fell {
            let weight = self.description.gripper.weight;
            let (gripper, world) = self.hand_at_work(hand);
            gripper.fall(world, weight);
            self.events.push(CellEvent::GripperFell { gripper: hand.link().into() });
        }
        if let Some(hand) = changes.torn {
            self.events.push(CellEvent::GripperTorn { gripper: hand.link().into() });
        }
        if let Some(hand) = changes.parted {
            self.let_go(hand, true);
            let (gripper, world) = self.hand_at_work(hand);
            gripper.air.cut();
            gripper.move_fingers(world);
            gripper.hang_fingers(world);
        }
        self.lead_grippers(&robot);
    }

    pub(super) fn hang_grippers(&mut self) {
        let robot = self.t3.arm().tool();
        for hand in ROBOT_HANDS {
            let Some(frame) = self.changer.frame(hand, &robot) else { continue };
            let present = self.changer.is_present(hand);
            let (gripper, world) = self.hand_at_work(hand);
            gripper.hang(world, &to_pose(&frame));
            gripper.set_present(world, present);
        }
    }

    /// Place a gripper in a holster, numbered from 0 in the order of the ids, or remove it from the cell, like a
    /// person. On error, the state is unchanged.
    pub fn hang_gripper(&mut self, id: u8, holster: Option<usize>) -> Result<(), WorkstationError> {
        let hand = self.changer.hang(id, holster)?;
        let (gripper, world) = self.hand_at_work(hand);
        gripper.pick_up(world);
        gripper.hang(world, &Pose::from_translation(AWAY));
        self.hang_grippers();
        Ok(())
    }

    fn lead_grippers(&mut self, robot: &Frame) {
        for (slot, hand) in ROBOT_HANDS.into_iter().enumerate() {
            let present = self.changer.is_present(hand);
            let gripper = &self.grippers[slot];
            if self.world.bodies[gripper.hand()].is_enabled() != present {
                gripper.set_present(&mut self.world, present);
            }
            let Some(frame) = self.changer.frame(hand, robot).filter(|_| present) else { continue };
            let mut next = to_pose(&frame);
            let body = &mut self.world.bodies[gripper.hand()];
            next.rotation = on_the_side_of(body.rotation(), next.rotation);
            body.set_next_kinematic_position(next);
        }
    }

    pub(super) fn holster_sensors(&mut self) -> HolsterSensors {
        let frames = [0, 1, 2].map(|slot| to_frame(self.world.bodies[self.grippers[slot].hand()].position()));
        self.changer.holster_sensors(&self.description, &frames)
    }

    /// End effector id of the gripper that the ring of the quick change holds, if any. The id pins also read a
    /// gripper that is mated but not locked.
    #[must_use]
    pub fn gripper(&self) -> Option<u8> {
        self.changer.carried().and_then(Hand::end_effector_id)
    }
}
