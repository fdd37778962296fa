//! Actions of the workstation itself: put down and remove parts, operate the vise, machine parts.

use geometry::{frame::Frame, units::Length};
use interfaces::station::{BoxAction, Key, ResolverKey, TableKey};

use super::Cell;
use crate::{
    description::Tolerance, pedestal::TableRefusal, resolver_box::ResolverRefusal, t3::Refusal, vise::Jaws,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// At an offset from the centre of the sector.
    At {
        x: f64,
        y: f64,
        /// Right-hand roll about the tool's X (down), degrees. At 0 the part's Z is the tool's Z.
        angle: f64,
    },
    /// At random within the random offset of the tray, at any angle, drawn from the seed.
    Random,
}

#[derive(Clone, Debug, PartialEq)]
pub enum WorkstationAction {
    Place {
        part: String, // name of a part of the description
        unit: String,
        sector: u16, // Sector, from 1
        placement: Placement,
    },
    Put {
        part: String, // name of a part of the description
        frame: Frame,
    },
    Remove {
        id: u32,
    },
    ViseOpen,
    /// Close the vise to an opening just wide enough for a blank.
    VisePartial,
    ViseClose,
    /// Select another program of the vise. The jaw does not move before an opening is commanded.
    ViseProgram {
        name: String,
    },
    /// Machine the part that is clamped in the vise or in a nest.
    Machine {
        from: String, // the required part
        to: String,
        location: String, // name of the location of the vise or the nest
    },
    DrumGrip,
    DrumRelease,
    /// Put a tool into its place in the drum, whose fingers then hold it.
    DrumTool {
        part: String, // name of a part of the description
    },
    Joystick(BoxAction),
    T3(Key),
    Table(TableKey),
    Resolvers(ResolverKey),
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkstationError {
    #[error("no part named {name}; the cell description has {}", list(.known))]
    UnknownPart { name: String, known: Vec<String> },
    #[error("no unit named {name}; the cell description has {}", list(.known))]
    UnknownUnit { name: String, known: Vec<String> },
    #[error("{unit} has sectors 1 to {sectors} in the cell description, not {sector}")]
    UnknownSector {
        unit: String,
        sector: u16,
        sectors: usize, // number of sectors of the unit
    },
    #[error("no place for {part} in sector {sector} of {unit}; the cell description has {}", places(.known))]
    NoNest {
        part: String,
        unit: String,
        sector: u16,
        known: Vec<(String, u16)>, // locations and sectors of its nests; 0 for a nest without a sector
    },
    #[error("there is no vise at {location}; the cell description has one at {known}")]
    NoVise { location: String, known: String },
    #[error("the vise has no program {name}; the cell description has {}", list(.known))]
    UnknownProgram { name: String, known: Vec<String> },
    #[error("{name} is not a tool; the cell description has {}", list(.known))]
    NoTool { name: String, known: Vec<String> },
    #[error("nothing can be machined at {location}; the cell description has machines at {}", list(.known))]
    NoMachine {
        location: String,
        known: Vec<String>, // all locations with a machine
    },
    #[error("no gripper has the end effector id {id}; the grippers have 1 to 3")]
    NoSuchGripper { id: u8 },
    #[error("no holster has the number {number}; the holsters have 0 to 2")]
    NoSuchHolster { number: usize },
    #[error("{part} cannot be put there: {by} is in the way")]
    Occupied { part: String, by: String },
    #[error("there is no part number {id} in the cell")]
    NoSuchPart { id: u32 },
    #[error("{part} is held and cannot be taken away")]
    Held { part: String },
    /// A part that the robot still holds cannot be machined in a nest.
    #[error("{part} is to be machined, but the robot still has it")]
    InHand { part: String },
    #[error("the vise is still moving")]
    Busy,
    #[error("{expected} is to be machined, but nothing is clamped in the vise")]
    NotClamped { expected: String },
    #[error("{expected} is to be machined, but nothing is at {location}")]
    NothingThere { expected: String, location: String },
    #[error("{expected} is to be machined, but {found} is there")]
    WrongPart { expected: String, found: String },
    /// The fingers of the drum cannot close on the tool that is there.
    #[error("the drum cannot grip {tool}: it is {distance:.3} in and {degrees:.2} degrees from its place")]
    NotInPlace {
        tool: String,
        distance: f64, // distance of its centre from its place, in
        degrees: f64,  // angle of its axis to that of its place, degrees
    },
    #[error("the drum has nothing to grip: no tool is in its place")]
    NothingToGrip,
    #[error(
        "{part} is to be machined on its other side, but the one in front was machined before: turn it round first"
    )]
    SameSide { part: String },
    #[error(
        "{part} is {distance:.3} in and {degrees:.2} degrees from its seat; {} and {} degrees are allowed",
        Length(.allowed.inches), .allowed.degrees
    )]
    NotSeated {
        part: String,
        distance: f64, // distance of its centre from the seat, in
        degrees: f64,  // angle of the part to the seat, degrees
        allowed: Tolerance,
    },
    #[error(transparent)]
    Refused(#[from] Refusal),
    #[error(transparent)]
    TableRefused(#[from] TableRefusal),
    #[error(transparent)]
    ResolversRefused(#[from] ResolverRefusal),
    #[error("{to} does not fit into {from}")]
    TooLarge { from: String, to: String },
}

impl Cell {
    /// Begin an action. A jaw of the vise then moves tick by tick; see [`Cell::workstation_busy`]. On error, the state
    /// is unchanged.
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
            WorkstationAction::Resolvers(key) => Ok(self.resolver_box.press(*key)?),
        }
    }

    /// Release stick, buttons and frame of the joystick box; the knob keeps its setting.
    pub fn release_joystick(&mut self) {
        self.joystick.release();
    }

    /// Release the keys of the rotary table's panel: a motion by hand ramps down.
    pub fn release_table_keys(&mut self) {
        self.pedestal.table.release_keys();
    }

    #[must_use]
    pub fn is_table_led_by_hand(&self) -> bool {
        self.pedestal.table.is_led_by_hand()
    }

    /// True while the vise moves, a control of the joystick box is held down, or a key's action is in progress.
    #[must_use]
    pub fn workstation_busy(&self) -> bool {
        self.vise.moving() || self.joystick.busy() || self.t3.busy() || self.pedestal.table.is_led_by_hand()
    }

    fn remove(&mut self, id: u32) -> Result<(), WorkstationError> {
        let index =
            self.parts.iter().position(|part| part.id == id).ok_or(WorkstationError::NoSuchPart { id })?;
        if self.is_held_or_clamped(index) {
            return Err(WorkstationError::Held { part: self.parts[index].kind.name.clone() });
        }
        let part = self.parts.remove(index);
        self.world.remove_body(part.body);
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

fn list(names: &[String]) -> String {
    names.join(", ")
}

fn places(places: &[(String, u16)]) -> String {
    let place = |(location, sector): &(String, u16)| match sector {
        0 => location.clone(),
        sector => format!("{location} {sector}"),
    };
    places.iter().map(place).collect::<Vec<_>>().join(", ")
}
