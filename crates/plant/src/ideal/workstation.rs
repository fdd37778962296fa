//! The workstation of the ideal cell, in which actions are immediate.

use geometry::frame::Frame;

use super::Ideal;
use crate::{
    cell::{
        Placement, WorkstationAction, WorkstationError,
        machining::{SEATED, askew, check_part, check_seat},
        order::Machine,
    },
    description::{PartType, Shape},
    room::{Clamped, Placed},
    vise::Jaws,
};

impl Ideal {
    /// Execute an action. On error, the state is unchanged.
    pub fn workstation(&mut self, action: &WorkstationAction) -> Result<(), WorkstationError> {
        self.description().admits(action)?;
        match action {
            WorkstationAction::Place { part, unit, sector, placement } => {
                let kind = self.description().kind(part)?.clone();
                let frame = self.placed(&kind, unit, *sector, placement)?;
                self.put(kind, frame)?;
            }
            WorkstationAction::Put { part, frame } => {
                let kind = self.description().kind(part)?.clone();
                self.put(kind, *frame)?;
            }
            WorkstationAction::Remove { id } => return Err(WorkstationError::NoSuchPart { id: *id }),
            WorkstationAction::ViseOpen => self.open_vise(Jaws::Open),
            WorkstationAction::VisePartial => self.open_vise(Jaws::Partial),
            WorkstationAction::ViseClose => self.clamp(),
            WorkstationAction::ViseProgram { name } => {
                let programs = &self.description().vise.program;
                self.program = programs.iter().position(|one| one.name == *name).unwrap_or(self.program);
            }
            WorkstationAction::Machine { from, to, location } => self.machine(from, to, location)?,
            WorkstationAction::DrumGrip => self.set_drum_fingers(true)?,
            WorkstationAction::DrumRelease => self.set_drum_fingers(false)?,
            WorkstationAction::DrumTool { part } => {
                let kind = self.description().kind(part)?.clone();
                self.drum.set_closed(false);
                self.put(kind, self.drum.seat())?;
                self.set_drum_fingers(true)?;
            }
            WorkstationAction::Joystick(action) => self.joystick.act(*action),
            WorkstationAction::T3(key) => self.t3.press(*key)?,
            WorkstationAction::Table(key) => self.table.press(*key)?,
            WorkstationAction::Resolvers(key) => self.resolver_box.press(*key)?,
        }
        Ok(())
    }

    /// True while a control of the joystick box is held down, or a controller executes the action of a key.
    #[must_use]
    pub fn workstation_busy(&self) -> bool {
        self.joystick.busy() || self.t3.busy() || self.table.is_led_by_hand()
    }

    fn placed(
        &mut self,
        kind: &PartType,
        unit: &str,
        sector: u16,
        placement: &Placement,
    ) -> Result<Frame, WorkstationError> {
        self.room.cell().placed(kind, unit, sector, placement, &mut self.placement_noise)
    }

    fn put(&mut self, kind: PartType, frame: Frame) -> Result<(), WorkstationError> {
        let part = Placed { kind, frame };
        if let Some(by) = self.room.in_the_way(&part, &self.layout()) {
            return Err(WorkstationError::Occupied { part: part.kind.name, by });
        }
        self.parts.push(part);
        Ok(())
    }

    fn open_vise(&mut self, jaws: Jaws) {
        self.jaws = self.room.jaws(self.program, jaws);
        if let Some(part) = self.clamped.take() {
            self.recover(part);
        }
    }

    fn clamp(&mut self) {
        let mut layout = self.layout();
        let held = self.held().map(|hold| hold.part);
        let clamped = self.room.clamp(&mut layout, &self.tool());
        self.jaws = layout.jaws;
        let others: Vec<_> = (0..self.parts.len()).filter(|part| Some(*part) != held).collect();
        for (index, part) in others.iter().zip(layout.parts) {
            self.parts[*index] = part;
        }
        self.clamped = match clamped {
            Some(Clamped::Part(index)) => others.get(index).copied(),
            Some(Clamped::Held) => held,
            None => None,
        };
    }

    fn machine(&mut self, from: &str, to: &str, location: &str) -> Result<(), WorkstationError> {
        let cell = self.room.cell();
        let next = cell.kind(to)?.clone();
        let (index, allowed, seat) = match cell.machine_at(location, from)? {
            Machine::Vise => {
                let not_clamped = || WorkstationError::NotClamped { expected: from.into() };
                let index = self.clamped.ok_or_else(not_clamped)?;
                let part = self.parts.get(index).ok_or_else(not_clamped)?;
                let (seat, _) = self.room.vise_seat(self.program, part).ok_or_else(not_clamped)?;
                (index, SEATED, seat)
            }
            Machine::Nest(nest) => {
                let seat = nest.frame();
                let nothing =
                    || WorkstationError::NothingThere { expected: from.into(), location: location.into() };
                let is_there = |part: &Placed| self.room.nest_seat(part) == Some(seat);
                let index = self.parts.iter().position(is_there).ok_or_else(nothing)?;
                (index, nest.machining.unwrap_or(SEATED), seat)
            }
        };
        let part = &self.parts[index];
        check_part(from, &part.kind, &next)?;
        if self.clamped != Some(index) && self.is_held(index) {
            return Err(WorkstationError::InHand { part: from.into() });
        }
        let here = seat.inverse().compose(&part.frame);
        let shape = if self.clamped == Some(index) { Shape::Box } else { part.kind.shape };
        check_seat(&part.kind, (here.position.norm(), askew(&here, shape)), allowed)?;
        self.parts[index].kind = next;
        if self.clamped == Some(index) {
            self.clamp();
        }
        Ok(())
    }
}
