//! Actions of a job other than commands: of the workstation, and of an operator at the joystick box.

use interfaces::station::{BoxAction, EStop, Key, ResolverKey, TableKey, ViseOpening};
use rcs_core::name::Name16;

use crate::files::Location;

/// Position of a part in its sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// Distance from the centre of the sector along world X, 0.01 in.
    pub x: i32,
    /// Distance from the centre of the sector along world Y, 0.01 in.
    pub y: i32,
    /// Angle about world Z, 0.01 degree.
    pub angle: i32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drum {
    Grip,
    Release,
    /// A tool is inserted into the drum.
    Tool(Name16),
}

/// An action other than a command to the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Workstation {
    /// A part is delivered into a sector of a tray.
    Tray {
        /// The sector, resolved for the part.
        location: Location,
        object: Name16,
        /// Position in the sector; `None`: random, from the seed of the run.
        offset: Option<Offset>,
    },
    Vise {
        opening: ViseOpening,
        location: Location,
        /// Program of the vise from now on; `None` keeps the present one.
        program: Option<Name16>,
    },
    /// A part is machined in a vise or a nest.
    Machine {
        blank: Name16,
        part: Name16,
        location: Location,
    },
    /// An action of the tool drum.
    Drum(Drum),
    Joystick(BoxAction),
    Press(EStop),
    /// An emergency stop is released.
    Release(EStop),
    /// An action at the robot controller's panel.
    Panel(Key),
    /// An action at the panel of the rotary table's controller.
    Table(TableKey),
    /// An action at the resolver electronics.
    Resolvers(ResolverKey),
    /// Blocks are loaded into the running system.
    Load {
        /// Number of the reload in the job, from 1.
        number: u32,
    },
    Wait {
        /// Duration, ticks.
        ticks: u32,
    },
    /// Transfer the command to the workstation controller until it disconnects (IV.4.1).
    HandOver,
}
