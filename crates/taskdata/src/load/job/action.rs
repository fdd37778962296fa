//! Actions of the workstation, and of an operator at the joystick box.

use interfaces::station::{BoxAction, EStop, Key, ResolverKey, TableKey, ViseOpening};
use rcs_core::name::Name16;

use crate::files::Location;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    pub x: i32,     // from the centre along world X, 0.01 in
    pub y: i32,     // from the centre along world Y, 0.01 in
    pub angle: i32, // about world Z, 0.01 degree
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drum {
    Grip,
    Release,
    Tool(Name16),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Workstation {
    Tray {
        location: Location, // resolved for the part
        object: Name16,
        offset: Option<Offset>, // `None`: random, from the seed of the run
    },
    Vise {
        opening: ViseOpening,
        location: Location,
        program: Option<Name16>, // from now on; `None` keeps the present one
    },
    /// A blank in a vise or a nest is machined.
    Machine {
        blank: Name16,
        part: Name16,
        location: Location,
    },
    Drum(Drum),
    Joystick(BoxAction),
    Press(EStop),
    Release(EStop),
    Panel(Key),             // at the robot controller
    Table(TableKey),        // at the rotary table's controller
    Resolvers(ResolverKey), // at the resolver electronics
    Load {
        number: u32, // of the reload, from 1
    },
    Wait {
        ticks: u32, // duration
    },
    /// Gives the command to the workstation controller until it disconnects (IV.4.1).
    HandOver,
}
