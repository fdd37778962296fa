//! The true state of the cell, independent of sensors and faults, to judge the controller's reports.

use geometry::frame::{Frame, Vector as Inches};

use super::{Cell, WorkstationAction, WorkstationError};
use crate::{
    changer::GripperPlace,
    convert::to_pose,
    description::{CellDescription, PartType},
    drum::Entering,
    hand::{Hand, ROBOT_HANDS},
};

/// Fingers slower than this are at rest, in/s. Fingers that press a part follow its sway, so the limit is not zero.
const STILL: f64 = 0.05;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holders {
    pub robot: bool,
    pub pedestal: bool,
    pub vise: bool,
    pub drum: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RingState {
    Locked,
    Open,
    Between,
}

impl Cell {
    /// Number of the part that the robot holds, if any.
    #[must_use]
    pub fn held(&self) -> Option<u32> {
        let of = |hand: Hand| self.hand(hand).hold.as_ref().map(|(index, _)| *index);
        let index = ROBOT_HANDS.into_iter().find_map(of)?;
        self.parts.get(index).map(|part| part.id)
    }

    #[must_use]
    pub const fn next_part_number(&self) -> u32 {
        self.next_part
    }

    /// The devices that hold a part; `None` if the part is not in the cell.
    #[must_use]
    pub fn holders(&self, id: u32) -> Option<Holders> {
        let index = self.index_of(id)?;
        Some(Holders {
            robot: self.is_held(index),
            pedestal: self.is_held_by(Hand::Pedestal, index),
            vise: self.is_clamped(index),
            drum: self.is_in_drum(index),
        })
    }

    /// The kind of a part; `None` if the part is not in the cell.
    #[must_use]
    pub fn part_kind(&self, id: u32) -> Option<&PartType> {
        self.index_of(id).and_then(|index| self.parts.get(index)).map(|part| &part.kind)
    }

    /// Position of a part relative to its place in the tool drum; `None` if it is not in front of the drum.
    #[must_use]
    pub fn at_drum(&self, id: u32) -> Option<Entering> {
        self.drum.entering(&self.part_frame(id)?)
    }

    #[must_use]
    pub fn ring(&self) -> RingState {
        self.changer.ring_state()
    }

    /// True if the gripper with this end effector id rests in the seat of a holster.
    #[must_use]
    pub fn is_holstered(&self, end_effector_id: u8) -> bool {
        let of = |hand: &Hand| hand.end_effector_id() == Some(end_effector_id);
        match ROBOT_HANDS.into_iter().find(of).and_then(|hand| self.changer.place(hand)) {
            Some(GripperPlace::Holster(_, perch)) => {
                let aside = self.description.holsters.seat - perch.forward;
                perch.rests() && aside.abs() <= self.description.holsters.detent
            }
            Some(GripperPlace::Robot | GripperPlace::Fallen | GripperPlace::Away) | None => false,
        }
    }

    #[must_use]
    pub fn fingers_move(&self) -> bool {
        self.changer.mated().is_some_and(|hand| self.hand(hand).air.speed().abs() > STILL)
    }

    #[must_use]
    pub fn pedestal_moves(&self) -> bool {
        self.pedestal.table.moving() || self.pedestal.hand.air.speed().abs() > STILL
    }

    /// Remove a part that is free or only in the tool drum, whose fingers then stay closed. On error, the state is
    /// unchanged.
    pub fn take_part(&mut self, id: u32) -> Result<(), WorkstationError> {
        if self.index_of(id).is_some_and(|index| self.is_in_drum(index)) {
            self.free_drum();
        }
        self.workstation(&WorkstationAction::Remove { id })
    }

    /// Move a free part to a frame, world, in. On error, the state is unchanged.
    pub fn move_part(&mut self, id: u32, frame: &Frame) -> Result<(), WorkstationError> {
        let index = self.index_of(id).ok_or(WorkstationError::NoSuchPart { id })?;
        if self.is_held_or_clamped(index) {
            return Err(WorkstationError::Held { part: self.parts[index].kind.name.clone() });
        }
        let kind = self.parts[index].kind.clone();
        if let Some(by) = self.in_the_way(&kind, frame, Some(id)) {
            return Err(WorkstationError::Occupied { part: kind.name, by });
        }
        let body = &mut self.world.bodies[self.parts[index].body];
        body.set_position(to_pose(frame), true);
        body.set_linvel(rapier3d_f64::math::Vector::ZERO, true);
        body.set_angvel(rapier3d_f64::math::Vector::ZERO, true);
        Ok(())
    }

    fn index_of(&self, id: u32) -> Option<usize> {
        self.parts.iter().position(|part| part.id == id)
    }
}

impl CellDescription {
    /// All places of a kind of part in nests and trays: location, sector (0 for none), frame (world, in).
    #[must_use]
    pub fn places_of(&self, kind: &PartType) -> Vec<(String, u16, Frame)> {
        let nests: Vec<_> = self.nest.iter().filter(|nest| nest.takes(kind)).collect();
        if !nests.is_empty() {
            let of = |nest: &&crate::description::Nest| (nest.location.clone(), nest.sector, nest.frame());
            return nests.iter().map(of).collect();
        }
        let up = Inches::new(0.0, 0.0, kind.size[0] / 2.0);
        let sectors = |tray: &crate::description::Tray| {
            let sectors = (1..=tray.sectors.len()).filter_map(|sector| u16::try_from(sector).ok());
            let found = sectors.filter_map(|sector| Some((tray.unit.clone(), sector, tray.sector(sector)?)));
            found.collect::<Vec<_>>()
        };
        let raised = |(unit, sector, frame): (_, _, Frame)| {
            (unit, sector, Frame { position: frame.position + up, ..frame })
        };
        self.tray.iter().flat_map(sectors).map(raised).collect()
    }
}
