//! Actions of the workstation besides the robot: put down and remove parts, operate the vise, machine parts.

use geometry::frame::Frame;

use super::Cell;
use crate::{
    description::Tolerance,
    joystick::BoxAction,
    pedestal::{TableKey, TableRefusal},
    t3::{Key, Refusal},
    vise::Jaws,
};

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
    /// At random within the tray's random offset, at any angle, from the seed.
    Random,
}

/// An action of the workstation.
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
    /// Go on with another program of the vise; the jaw stays until an opening is commanded.
    ViseProgram {
        /// Its name.
        name: String,
    },
    /// Machine the part that is clamped in the vise, or stands in a nest.
    Machine {
        /// What it must be.
        from: String,
        /// What it becomes.
        to: String,
        /// Name of the location of the vise or the nest.
        location: String,
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
    /// Do something at the T3 controller, or an emergency stop.
    T3(Key),
    /// Do something at the panel of the rotary table's controller.
    Table(TableKey),
}

/// Why the workstation refuses an action.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkstationError {
    /// No part of that name in the description.
    #[error("no part named {name}; the cell description has {}", list(.known))]
    UnknownPart {
        /// The name.
        name: String,
        /// All names.
        known: Vec<String>,
    },
    /// No unit of that name.
    #[error("no unit named {name}; the cell description has {}", list(.known))]
    UnknownUnit {
        /// The name.
        name: String,
        /// All names.
        known: Vec<String>,
    },
    /// The unit has no such sector.
    #[error("{unit} has sectors 1 to {sectors} in the cell description, not {sector}")]
    UnknownSector {
        /// The unit.
        unit: String,
        /// The sector asked for.
        sector: u16,
        /// How many there are.
        sectors: usize,
    },
    /// The part is made for a nest, and there is none.
    #[error("no place for {part} in sector {sector} of {unit}; the cell description has {}", places(.known))]
    NoNest {
        /// The part.
        part: String,
        /// The unit.
        unit: String,
        /// The sector asked for.
        sector: u16,
        /// Locations and sectors of its nests; sector 0 is none.
        known: Vec<(String, u16)>,
    },
    /// The cell has its vise elsewhere.
    #[error("there is no vise at {location}; the cell description has one at {known}")]
    NoVise {
        /// The location asked for.
        location: String,
        /// That of the vise.
        known: String,
    },
    /// The vise has no such program.
    #[error("the vise has no program {name}; the cell description has {}", list(.known))]
    UnknownProgram {
        /// The name.
        name: String,
        /// All names.
        known: Vec<String>,
    },
    /// The part is none that fits into the drum.
    #[error("{name} is no tool; the cell description has {}", list(.known))]
    NoTool {
        /// The name.
        name: String,
        /// All tools.
        known: Vec<String>,
    },
    /// Nothing can be machined there.
    #[error("nothing can be machined at {location}; the cell description has machines at {}", list(.known))]
    NoMachine {
        /// The location asked for.
        location: String,
        /// All locations where something can.
        known: Vec<String>,
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
    /// A part that the robot still has cannot be machined in a nest.
    #[error("{part} is to be machined, but the robot still has it")]
    InHand {
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
    /// The nest is empty.
    #[error("{expected} is to be machined, but nothing is at {location}")]
    NothingThere {
        /// What was expected.
        expected: String,
        /// Where.
        location: String,
    },
    /// Something else is there.
    #[error("{expected} is to be machined, but {found} is there")]
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
    /// The fingers of the drum would close on nothing.
    #[error("the drum has nothing to grip: no tool is in its place")]
    NothingToGrip,
    /// The side was machined before.
    #[error(
        "{part} is to be machined on its other side, but the one in front was machined before: turn it round first"
    )]
    SameSide {
        /// The part.
        part: String,
    },
    /// The part is there, but not where it belongs.
    #[error(
        "{part} is {distance:.3} in and {degrees:.2} degrees from its seat; {} in and {} degrees are allowed",
        .allowed.inches, .allowed.degrees
    )]
    NotSeated {
        /// The part.
        part: String,
        /// How far its middle is from the seat, in.
        distance: f64,
        /// How far it is turned, degrees.
        degrees: f64,
        /// What is allowed.
        allowed: Tolerance,
    },
    /// The T3 controller does not do that now.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// The rotary table's controller does not do that now.
    #[error(transparent)]
    TableRefused(#[from] TableRefusal),
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
    /// Begin an action. The jaw of the vise then moves with the ticks; see [`Cell::workstation_busy`].
    ///
    /// # Errors
    /// [`WorkstationError`]; then nothing has changed.
    pub fn workstation(&mut self, action: &WorkstationAction) -> Result<(), WorkstationError> {
        self.description.admits(action)?;
        match action {
            WorkstationAction::Place { part, unit, sector, placement } => {
                self.deliver(part, unit, *sector, placement)
            }
            WorkstationAction::Put { part, frame } => {
                let kind = self.description.kind(part)?.clone();
                self.put(&kind, frame)
            }
            WorkstationAction::Remove { id } => self.remove(*id),
            WorkstationAction::ViseOpen => self.work_vise(Jaws::Open),
            WorkstationAction::VisePartial => self.work_vise(Jaws::Partial),
            WorkstationAction::ViseClose => self.work_vise(Jaws::Closed),
            WorkstationAction::ViseProgram { name } => self.select_program(name),
            WorkstationAction::Machine { from, to, location } => self.machine(from, to, location),
            WorkstationAction::DrumGrip => self.set_drum_fingers(true),
            WorkstationAction::DrumRelease => self.set_drum_fingers(false),
            WorkstationAction::DrumTool { part } => {
                let kind = self.description.kind(part)?.clone();
                self.put_into_drum(&kind)
            }
            WorkstationAction::Joystick(action) => {
                self.joystick.act(*action);
                Ok(())
            }
            WorkstationAction::T3(key) => Ok(self.press(*key)?),
            WorkstationAction::Table(key) => Ok(self.pedestal.table.press(*key)?),
        }
    }

    /// True while the vise is moving, something at the joystick box is held down, or the T3 controller or that of the
    /// rotary table does what a key has begun.
    #[must_use]
    pub fn workstation_busy(&self) -> bool {
        self.vise.moving() || self.joystick.busy() || self.t3.busy() || self.pedestal.table.is_led_by_hand()
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

    fn select_program(&mut self, name: &str) -> Result<(), WorkstationError> {
        if self.vise.moving() {
            return Err(WorkstationError::Busy);
        }
        self.vise.select(name);
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
}

/// Names in a row.
fn list(names: &[String]) -> String {
    names.join(", ")
}

/// Places in a row.
fn places(places: &[(String, u16)]) -> String {
    let place = |(location, sector): &(String, u16)| match sector {
        0 => location.clone(),
        sector => format!("{location} {sector}"),
    };
    places.iter().map(place).collect::<Vec<_>>().join(", ")
}
