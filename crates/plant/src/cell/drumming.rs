//! The tool drum and the tool in it.
//!
//! The drum fixes a tool while the drum's fingers grip it, or while only the detents hold it. While the robot holds the
//! tool and the fingers are open, only the force along the drum's axis acts on it ([`crate::drum`]).

use rapier3d_f64::prelude::*;

use super::{Cell, WorkstationError};
use crate::{
    convert::{metres, on_the_side_of, to_pose},
    description::PartType,
    drum::{Entering, Pocketed},
    hand::HANDS,
};

const NEAR: f64 = 4.0; // tools farther than this from the drum are ignored, in

impl Cell {
    /// Before a step of `dt` seconds: apply the drum's force to its tool.
    pub(super) fn work_drum(&mut self, dt: f64) {
        let Some((pocketed, entering)) = self.tool_at_drum() else {
            if let Some(left) = self.drum.tool.take() {
                self.lead_by_drum(&left, false);
            }
            return;
        };
        let held = self.is_held(pocketed.part);
        let fast = self.drum.grips(&pocketed) || (!held && self.drum.keeps(&pocketed, &entering));
        if fast != pocketed.fast {
            self.lead_by_drum(&pocketed, fast);
            self.drum.lead(fast, &entering);
            self.note_holders(pocketed.part);
        }
        if fast {
            return;
        }
        let axis = self.drum.axis();
        let axis = Vector::new(axis.x, axis.y, axis.z);
        let speed = self.world.bodies[self.parts[pocketed.part].body].linvel().dot(axis);
        let force = self.drum.resist(&entering, speed);
        if force != 0.0 {
            self.world.bodies[self.parts[pocketed.part].body].apply_impulse(axis * (force * dt), true);
        }
    }

    fn tool_at_drum(&mut self) -> Option<(Pocketed, Entering)> {
        if let Some(pocketed) = self.drum.tool {
            let frame = self.parts[pocketed.part].frame(&self.world);
            return self.drum.entering(&frame).map(|entering| (pocketed, entering));
        }
        let near = |at: Vector| (at - to_pose(&self.drum.seat()).translation).length() < metres(NEAR);
        let (part, entering) = self.parts.iter().enumerate().find_map(|(index, part)| {
            let comes = part.kind.tool && near(part.pose(&self.world).translation);
            comes.then(|| self.drum.entering(&part.frame(&self.world)))?.map(|entering| (index, entering))
        })?;
        self.drum.admit(part, &entering);
        self.drum.tool.map(|pocketed| (pocketed, entering))
    }

    fn lead_by_drum(&mut self, pocketed: &Pocketed, fast: bool) {
        if pocketed.fast == fast {
            return;
        }
        let kind = if fast { RigidBodyType::KinematicPositionBased } else { RigidBodyType::Dynamic };
        let body = &mut self.world.bodies[self.parts[pocketed.part].body];
        body.set_body_type(kind, true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(Vector::ZERO, true);
        if !fast {
            for hand in HANDS {
                self.recover(hand, pocketed.part);
            }
        }
    }

    pub(super) fn free_drum(&mut self) {
        if let Some(left) = self.drum.tool.take() {
            self.lead_by_drum(&left, false);
        }
    }

    pub(super) fn is_in_drum(&self, index: usize) -> bool {
        self.drum.tool.is_some_and(|pocketed| pocketed.part == index && pocketed.fast)
    }

    /// Distance of a tool in the drum from its place, in.
    pub(super) fn drum_error(&self, index: usize) -> Option<f64> {
        let entering = self.drum.entering(&self.parts[index].frame(&self.world))?;
        Some(libm::hypot(entering.left, entering.aside))
    }

    pub(super) fn drum_location(&self) -> &str {
        self.drum.location()
    }

    /// Close the fingers of the drum on the tool that is in its place, or open them. Fails with
    /// [`WorkstationError::NothingToGrip`] if no tool is there, [`WorkstationError::NotInPlace`] if a tool blocks the
    /// fingers.
    pub(super) fn set_drum_fingers(&mut self, closed: bool) -> Result<(), WorkstationError> {
        if closed {
            let (pocketed, entering) = self.tool_at_drum().ok_or(WorkstationError::NothingToGrip)?;
            if !self.drum.can_grip(&entering) {
                let tool = self.parts[pocketed.part].kind.name.clone();
                return Err(entering.not_in_place(tool));
            }
            self.drum.set_closed(true);
            self.lead_by_drum(&pocketed, true);
            self.drum.lead(true, &entering);
            self.note_holders(pocketed.part);
            let place = self.drum.place(&self.parts[pocketed.part].frame(&self.world));
            let mut next = to_pose(&place);
            let body = &mut self.world.bodies[self.parts[pocketed.part].body];
            next.rotation = on_the_side_of(body.rotation(), next.rotation);
            body.set_next_kinematic_position(next);
        }
        self.drum.set_closed(closed);
        Ok(())
    }

    /// Put a tool into its place in the drum, whose fingers then hold it. Fails with [`WorkstationError::Occupied`] if
    /// the place is not free.
    pub(super) fn put_into_drum(&mut self, kind: &PartType) -> Result<(), WorkstationError> {
        self.drum.set_closed(false);
        let place = self.drum.seat();
        self.put(kind, &place)?;
        self.set_drum_fingers(true)
    }

    #[must_use]
    pub fn drum_closed(&self) -> bool {
        self.drum.closed()
    }
}
