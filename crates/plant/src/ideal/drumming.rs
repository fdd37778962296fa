//! The tool drum, and the tool in it with its contacts.

use geometry::frame::{Frame, Vector as Inches};

use super::Ideal;
use crate::{
    bodies,
    cell::WorkstationError,
    clearance::Contact,
    convert::newtons,
    description::Kind,
    drum::{Entering, Pocketed},
    force::Wrench,
    hand::{HANDS, Hand},
};

/// Distance of the fingertips from the drum's location within which they can touch the drum, in.
const NEAR: f64 = 12.0;

/// A finger that touches the strike plate, and the first face that it touched.
#[derive(Clone, Debug)]
pub(super) struct Press {
    pair: (String, String),
    away: Inches, // unit vector out of the face, world
    depth: f64,   // depth at the first contact, in
    tool: Inches,
}

impl Press {
    fn new(contact: &Contact, tool: &Frame) -> Self {
        let away = Inches::from(contact.away);
        Self { pair: contact.pair(), away, depth: contact.depth, tool: tool.position }
    }

    fn depth(&self, tool: &Frame) -> f64 {
        (self.depth + (self.tool - tool.position).dot(&self.away)).max(0.0)
    }
}

impl Ideal {
    pub(super) fn work_drum(&mut self) {
        let Some((pocketed, entering)) = self.tool_at_drum() else {
            self.drum.tool = None;
            return;
        };
        let held = HANDS.iter().any(|hand| self.is_held_by(*hand, pocketed.part));
        let fast = self.drum.grips(&pocketed) || (!held && self.drum.keeps(&pocketed, &entering));
        if fast == pocketed.fast {
            return;
        }
        if fast && self.drum.grips(&pocketed) {
            self.seat_in_drum(pocketed.part);
        }
        self.drum.lead(fast, &entering);
        if !fast {
            self.recover(pocketed.part);
        }
    }

    /// The tool in the drum or in front of it, and its position; registers a tool that arrives.
    pub(super) fn tool_at_drum(&mut self) -> Option<(Pocketed, Entering)> {
        if let Some(pocketed) = self.drum.tool {
            let entering = self.drum.entering(&self.parts.get(pocketed.part)?.frame)?;
            return Some((pocketed, entering));
        }
        let tools = self.parts.iter().enumerate().filter(|(_, part)| part.kind.tool);
        let (part, entering) =
            tools.filter_map(|(index, part)| Some((index, self.drum.entering(&part.frame)?))).next()?;
        self.drum.admit(part, &entering);
        Some((self.drum.tool?, entering))
    }

    fn seat_in_drum(&mut self, part: usize) {
        if let Some(part) = self.parts.get_mut(part) {
            part.frame = self.drum.place(&part.frame);
        }
    }

    pub(super) fn is_in_drum(&self, part: usize) -> bool {
        self.drum.tool.is_some_and(|pocketed| pocketed.part == part && pocketed.fast)
    }

    /// Close the fingers of the drum on the tool in its place, or open them.
    pub(super) fn set_drum_fingers(&mut self, closed: bool) -> Result<(), WorkstationError> {
        if closed {
            let (pocketed, entering) = self.tool_at_drum().ok_or(WorkstationError::NothingToGrip)?;
            if !self.drum.can_grip(&entering) {
                let tool = self.parts.get(pocketed.part).map(|part| part.kind.name.clone());
                return Err(entering.not_in_place(tool.unwrap_or_default()));
            }
            self.seat_in_drum(pocketed.part);
            self.drum.lead(true, &entering);
        }
        self.drum.set_closed(closed);
        Ok(())
    }

    /// The load on the tool gripper at the drum, in the axes of the tool: detents, and strike plate.
    pub(super) fn load_at_drum(&mut self, tool: &Frame) -> Wrench {
        let into = tool.rotation.inverse();
        let mut load = Wrench::default();
        if (self.drum.seat().position - tool.position).norm() > NEAR {
            return load;
        }
        if let Some((pocketed, entering)) = self.tool_at_drum()
            && self.is_held(pocketed.part)
            && !pocketed.fast
        {
            let pounds = self.drum.resist(&entering, 0.0) / newtons(1.0);
            load = load.and(&Wrench { force: into * (self.drum.axis() * pounds), moment: Inches::zeros() });
        }
        let cell = self.room.cell();
        let opening = self.fingers(Hand::Tool).air.opening();
        let mut fingers = bodies::worn(cell, &cell.gripper.tool, tool, opening);
        fingers.retain(|body| body.kind == Kind::Finger);
        let mut contacts = self.room.look(&fingers, &[], 0.0);
        contacts.retain(|contact| contact.obstacle_kind == Kind::Drum);
        self.presses.retain(|press| contacts.iter().any(|contact| contact.pair() == press.pair));
        for contact in &contacts {
            let pair = contact.pair();
            let known = self.presses.iter().find(|press| press.pair == pair).cloned();
            let press = known.unwrap_or_else(|| {
                let new = Press::new(contact, tool);
                self.presses.push(new.clone());
                new
            });
            let force = into * press.away * (press.depth(tool) * self.room.cell().robot.stiffness);
            let at = into * (Inches::from(contact.at) - tool.position);
            load = load.and(&Wrench::at(&at, force, Inches::zeros()));
        }
        load
    }
}
