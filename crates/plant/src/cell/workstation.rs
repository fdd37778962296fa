//! What the workstation does beside the robot: parts are put down and taken away, the vise is worked, parts are machined.

use rapier3d_f64::{parry::query, prelude::*};
use rcs_core::frame::{Frame, Vector as Inches, rotation_by, rotation_vector};

use super::{Cell, Hand};
use crate::{
    convert::{inches, to_pose},
    description::PartType,
    joystick::BoxAction,
    part::{Part, PartState},
    vise::Jaws,
};

/// How far a part may be from its seat in the vise to be machined, in (ASSUMED).
const SEATED: f64 = 0.03;
/// How far a part may be turned from its seat to be machined, radians (1 degree, ASSUMED).
const SQUARE: f64 = 0.0175;
/// Overlap that counts as one, when a part is put down, m.
const OVERLAP: Real = 1e-4;
/// What stands or is stacked this high above a tray's floor is in the tray, in (ASSUMED: tall tools).
const IN_TRAY: f64 = 10.0;
/// A part is put down this far above what it comes to rest on, in.
const DROP: f64 = 0.002;

/// Where in a sector a part is put down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// At an offset from the centre of the sector.
    At {
        /// World X, in.
        x: f64,
        /// World Y, in.
        y: f64,
        /// Right-hand roll about the tool's X (down), degrees; at 0 the part's Z is the tool's Z.
        angle: f64,
    },
    /// Anywhere within the tray's random offset, at any angle, as the seed has it.
    Random,
}

/// What the workstation can be told to do.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkstationAction {
    /// Put a part into a sector of a tray.
    Place {
        /// Name of a part of the description.
        part: String,
        /// Name of the unit.
        unit: String,
        /// Sector, from 1.
        sector: u16,
        /// Where in the sector.
        placement: Placement,
    },
    /// Put a part anywhere.
    Put {
        /// Name of a part of the description.
        part: String,
        /// Its frame, in.
        frame: Frame,
    },
    /// Take away the part of a number.
    Remove {
        /// Its number.
        id: u32,
    },
    /// Open the vise.
    ViseOpen,
    /// Close the vise so far that a blank goes in.
    VisePartial,
    /// Close the vise.
    ViseClose,
    /// Machine the part that is clamped in the vise.
    Machine {
        /// What it must be.
        from: String,
        /// What it becomes.
        to: String,
    },
    /// Close the fingers of the tool drum.
    DrumGrip,
    /// Open the fingers of the tool drum.
    DrumRelease,
    /// Put a tool into its place in the drum, whose fingers then hold it.
    DrumTool {
        /// Name of a part of the description.
        part: String,
    },
    /// Do something at the joystick box.
    Joystick(BoxAction),
}

/// Why the workstation cannot do that.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkstationError {
    /// No part of that name in the description.
    #[error("no part named {name}; the cell description has {known}")]
    UnknownPart {
        /// The name.
        name: String,
        /// All names.
        known: String,
    },
    /// No unit of that name.
    #[error("no unit named {name}; the cell description has {known}")]
    UnknownUnit {
        /// The name.
        name: String,
        /// All names.
        known: String,
    },
    /// The unit has no such sector.
    #[error("{unit} has sectors 1 to {sectors}, not {sector}")]
    UnknownSector {
        /// The unit.
        unit: String,
        /// The sector asked for.
        sector: u16,
        /// How many there are.
        sectors: usize,
    },
    /// Something is there already.
    #[error("{part} cannot be put there: {by} is in the way")]
    Occupied {
        /// The part.
        part: String,
        /// What is there.
        by: String,
    },
    /// There is no part of that number.
    #[error("there is no part number {id} in the cell")]
    NoSuchPart {
        /// The number.
        id: u32,
    },
    /// A part that is held cannot be taken away.
    #[error("{part} is held and cannot be taken away")]
    Held {
        /// The part.
        part: String,
    },
    /// The vise is moving.
    #[error("the vise is still moving")]
    Busy,
    /// Nothing is clamped.
    #[error("{expected} is to be machined, but nothing is clamped in the vise")]
    NotClamped {
        /// What was expected.
        expected: String,
    },
    /// Something else is clamped.
    #[error("{expected} is to be machined, but {found} is clamped in the vise")]
    WrongPart {
        /// What was expected.
        expected: String,
        /// What is there.
        found: String,
    },
    /// The fingers of the drum cannot close on the tool that is there.
    #[error("the drum cannot grip {tool}: it is {distance:.3} in and {degrees:.2} degrees from its place")]
    NotInPlace {
        /// The tool.
        tool: String,
        /// How far its middle is from its place, in.
        distance: f64,
        /// How far its axis is turned, degrees.
        degrees: f64,
    },
    /// The part is clamped, but not where it belongs.
    #[error(
        "{part} is clamped {distance:.3} in and {degrees:.2} degrees from its seat; {SEATED} in and 1 degree are allowed"
    )]
    NotSeated {
        /// The part.
        part: String,
        /// How far its middle is from the seat, in.
        distance: f64,
        /// How far it is turned, degrees.
        degrees: f64,
    },
    /// The next part does not fit into the blank.
    #[error("{to} does not fit into {from}")]
    TooLarge {
        /// The blank.
        from: String,
        /// The next part.
        to: String,
    },
}

impl Cell {
    /// Do something beside the robot. The jaw of the vise then moves with the ticks; see [`Cell::workstation_busy`].
    ///
    /// # Errors
    /// [`WorkstationError`]; then nothing has changed.
    pub fn workstation(&mut self, action: &WorkstationAction) -> Result<(), WorkstationError> {
        match action {
            WorkstationAction::Place { part, unit, sector, placement } => {
                let kind = self.kind(part)?;
                let frame = self.place_frame(&kind, unit, *sector, placement)?;
                self.put(&kind, &frame)
            }
            WorkstationAction::Put { part, frame } => {
                let kind = self.kind(part)?;
                self.put(&kind, frame)
            }
            WorkstationAction::Remove { id } => self.remove(*id),
            WorkstationAction::ViseOpen => self.work_vise(Jaws::Open),
            WorkstationAction::VisePartial => self.work_vise(Jaws::Partial),
            WorkstationAction::ViseClose => self.work_vise(Jaws::Closed),
            WorkstationAction::Machine { from, to } => self.machine(from, to),
            WorkstationAction::DrumGrip => self.set_drum_fingers(true),
            WorkstationAction::DrumRelease => self.set_drum_fingers(false),
            WorkstationAction::DrumTool { part } => {
                let kind = self.kind(part)?;
                self.put_into_drum(&kind)
            }
            WorkstationAction::Joystick(action) => {
                self.joystick.act(*action);
                Ok(())
            }
        }
    }

    /// True while the vise is moving, or something at the joystick box is held down.
    #[must_use]
    pub fn workstation_busy(&self) -> bool {
        self.vise.moving() || self.joystick.busy()
    }

    fn kind(&self, name: &str) -> Result<PartType, WorkstationError> {
        self.description.part(name).cloned().ok_or_else(|| WorkstationError::UnknownPart {
            name: name.into(),
            known: list(self.description.part.iter().map(|kind| kind.name.as_str())),
        })
    }

    fn place_frame(
        &mut self,
        kind: &PartType,
        unit: &str,
        sector: u16,
        placement: &Placement,
    ) -> Result<Frame, WorkstationError> {
        let tray = self.description.tray(unit).ok_or_else(|| WorkstationError::UnknownUnit {
            name: unit.into(),
            known: list(self.description.tray.iter().map(|tray| tray.unit.as_str())),
        })?;
        let place = tray.sector(sector).ok_or(WorkstationError::UnknownSector {
            unit: unit.into(),
            sector,
            sectors: tray.sectors.len(),
        })?;
        let (x, y, angle) = match *placement {
            Placement::At { x, y, angle } => (x, y, angle),
            Placement::Random => {
                let greatest = self.description.tray_shape.random_offset;
                let noise = &mut self.placement_noise;
                (noise.within(greatest), noise.within(greatest), noise.within(180.0))
            }
        };
        let turned = place.turned(&rotation_by(&Inches::new(angle.to_radians(), 0.0, 0.0)));
        let up = kind.size[0] / 2.0 + DROP;
        Ok(Frame { position: turned.position + Inches::new(x, y, up), ..turned })
    }

    pub(super) fn put(&mut self, kind: &PartType, frame: &Frame) -> Result<(), WorkstationError> {
        if let Some(by) = self.in_the_way(kind, frame) {
            return Err(WorkstationError::Occupied { part: kind.name.clone(), by });
        }
        let part = Part::new(&mut self.world, self.next_part, kind, frame);
        self.next_part += 1;
        self.parts.push(part);
        Ok(())
    }

    /// What a part at `frame` would overlap.
    fn in_the_way(&self, kind: &PartType, frame: &Frame) -> Option<String> {
        let pose = to_pose(frame);
        let shape = Cuboid::new(crate::convert::to_metres(&Inches::from(kind.size)) / 2.0);
        let overlaps = |other: &Pose, other_shape: &Cuboid| {
            let contact = query::contact(&pose, &shape, other, other_shape, 0.0);
            matches!(contact, Ok(Some(contact)) if contact.dist < -OVERLAP)
        };
        let jaw = self.jaw_obstacles();
        let furniture =
            self.obstacles.iter().chain(&jaw).find(|obstacle| overlaps(&obstacle.pose, &obstacle.shape));
        let parts =
            self.parts.iter().find(|part| overlaps(&part.pose(&self.world), &Cuboid::new(part.half())));
        furniture.map(|obstacle| obstacle.name.clone()).or_else(|| parts.map(|part| part.kind.name.clone()))
    }

    fn remove(&mut self, id: u32) -> Result<(), WorkstationError> {
        let index =
            self.parts.iter().position(|part| part.id == id).ok_or(WorkstationError::NoSuchPart { id })?;
        if self.is_had(index) {
            return Err(WorkstationError::Held { part: self.parts[index].kind.name.clone() });
        }
        let part = self.parts.remove(index);
        self.world.remove_body(part.body);
        // What is held is known by its place in the list.
        self.renumber(|held| if held > index { held - 1 } else { held });
        Ok(())
    }

    fn work_vise(&mut self, jaws: Jaws) -> Result<(), WorkstationError> {
        if self.vise.moving() {
            return Err(WorkstationError::Busy);
        }
        for part in &self.parts {
            self.world.bodies[part.body].wake_up(true);
        }
        self.vise.command(jaws);
        if self.vise.opening_commanded() {
            self.unclamp();
        }
        Ok(())
    }

    fn machine(&mut self, from: &str, to: &str) -> Result<(), WorkstationError> {
        let next = self.kind(to)?;
        let not_clamped = || WorkstationError::NotClamped { expected: from.into() };
        let index = self.vise.clamped.map(|clamped| clamped.part).ok_or_else(not_clamped)?;
        let part = &self.parts[index];
        if part.kind.name != from {
            return Err(WorkstationError::WrongPart { expected: from.into(), found: part.kind.name.clone() });
        }
        let (distance, angle) = self.seat_error(part);
        if distance > SEATED || angle > SQUARE {
            return Err(WorkstationError::NotSeated {
                part: from.into(),
                distance,
                degrees: angle.to_degrees(),
            });
        }
        if next.size.iter().zip(part.kind.size).any(|(new, old)| *new > old + 1e-9) {
            return Err(WorkstationError::TooLarge { from: from.into(), to: to.into() });
        }
        let here = self.vise.frame().inverse().compose(&part.frame(&self.world));
        let along = |kind: &PartType| sizes_along(&here, kind);
        let shift = self.vise.seat(&along(&next)) - self.vise.seat(&along(&part.kind));
        let shift = here.rotation.inverse() * shift;
        self.unclamp();
        self.parts[index].become_kind(&mut self.world, &next, shift);
        if let Some(squeeze) = self.between_jaws_of(index) {
            self.vise.follow(&mut self.world, inches(squeeze.width));
            let middle = self.vise.fixed_face() + squeeze.width / 2.0;
            self.clamp(index, &squeeze, middle);
        }
        Ok(())
    }

    /// How far a part in the vise is from its seat: inches of its middle, radians of its nearest axes.
    fn seat_error(&self, part: &Part) -> (f64, f64) {
        let here = self.vise.frame().inverse().compose(&part.frame(&self.world));
        let seat = self.vise.seat(&sizes_along(&here, &part.kind));
        let square = nearest_square(&here);
        ((here.position - seat).norm(), rotation_vector(&(here.rotation * square.rotation.inverse())).norm())
    }

    /// The report of a part.
    pub(super) fn part_state(&self, index: usize) -> PartState {
        let part = &self.parts[index];
        let frame = part.frame(&self.world);
        let (location, sector, error) = self.locate(index, part, &frame);
        PartState {
            id: part.id,
            name: part.kind.name.clone(),
            location,
            sector,
            held: self.is_held(index),
            clamped: self.is_clamped(index),
            position: frame.position.into(),
            error,
        }
    }

    fn locate(&self, index: usize, part: &Part, frame: &Frame) -> (String, u16, Option<f64>) {
        let at = frame.position;
        if self.is_in_drum(index) {
            return (self.drum_location().into(), 0, self.drum_error(index));
        }
        if self.is_held(index) && !self.is_clamped(index) {
            return ("gripper".into(), 0, None);
        }
        if self.is_held_by(Hand::Pedestal, index) {
            return (self.description.pedestal.location.clone(), 0, None);
        }
        for tray in &self.description.tray {
            let shape = &self.description.tray_shape;
            let [x, y] = tray.centre;
            let inside = (at.x - x).abs() < shape.inside / 2.0 && (at.y - y).abs() < shape.inside / 2.0;
            if inside && (tray.floor..tray.floor + IN_TRAY).contains(&at.z) {
                let away = |centre: &[f64; 2]| libm::hypot(at.x - centre[0], at.y - centre[1]);
                let nearest = (1_u16..).zip(&tray.sectors).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
                return match nearest {
                    Some((sector, centre)) => (tray.unit.clone(), sector, Some(away(centre))),
                    None => (tray.unit.clone(), 0, None),
                };
            }
        }
        if self.vise.contains(&self.vise.frame().inverse().compose(frame).position) {
            return (self.vise.location().into(), 0, Some(self.seat_error(part).0));
        }
        let lowest = self
            .furniture
            .iter()
            .map(|block| block.frame.position.z + block.size.z / 2.0)
            .fold(0.0, f64::min);
        let on_floor = at.z < lowest + inches(part.radius()) + 0.1;
        (if on_floor { "floor" } else { "elsewhere" }.into(), 0, None)
    }
}

fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

/// Sizes of a part along the axes of the frame that `here` is given in.
fn sizes_along(here: &Frame, kind: &PartType) -> Inches {
    let square = nearest_square(here);
    let sizes = square.rotation * Inches::from(kind.size);
    sizes.map(f64::abs)
}

/// The frame with its axes turned onto the nearest axes of the frame it is given in.
fn nearest_square(here: &Frame) -> Frame {
    let snapped = |v: Inches| {
        let longest = (0..3).max_by(|a, b| v[*a].abs().total_cmp(&v[*b].abs())).unwrap_or(0);
        let mut axis = Inches::zeros();
        axis[longest] = v[longest].signum();
        axis
    };
    rcs_core::frame::rotation_from_x_y(&snapped(here.x()), &snapped(here.y()))
        .map_or(*here, |rotation| Frame { position: here.position, rotation })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_its_sizes_along_the_vise() {
        let kind =
            PartType { name: "P".into(), size: [1.0, 2.0, 3.0], weight: 1.0, vision_id: 0, tool: false };
        // Part X down, Y along vise X, a little askew.
        let upright =
            rcs_core::frame::rotation_from_x_y(&Inches::new(0.02, 0.01, -1.0), &Inches::x()).unwrap();
        let here = Frame { position: Inches::zeros(), rotation: upright };
        assert!((sizes_along(&here, &kind) - Inches::new(2.0, 3.0, 1.0)).norm() < 1e-12);
    }
}
