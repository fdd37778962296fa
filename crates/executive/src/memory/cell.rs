//! The view of the simulated cell for screens: published after each tick, when the cell has moved.
//!
//! It is not an input of the controller and is not logged: a log has the cell on `/tf` and `/joint_states`. A run with
//! a robot at a port has none.

use rcs_core::{Plain, name::Name16, tick::Tick};

use super::text::Text;

/// The name of the service.
pub(super) const CELL: &str = "cell";
/// Parts of a cell that are shown.
pub const PARTS: usize = 24;

/// The view of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct CellView {
    /// The tick after which it was taken; [`Tick::BEFORE_START`] if there is none yet.
    pub tick: Tick,
    /// The robot controller.
    pub controller: ControllerView,
    /// The panel of the rotary table's controller.
    pub table: TableView,
    /// Joint angles of the arm, base to roll, radians.
    pub joints: [f64; 6],
    /// The tool point in world coordinates, in.
    pub tool: [f64; 3],
    /// Clear width between the fingers of the robot's gripper, and their force, in and lb.
    pub fingers: [f64; 2],
    /// The same of the pedestal's hand.
    pub pedestal_fingers: [f64; 2],
    /// Clear width between the jaws of the vise, in.
    pub vise_opening: f64,
    /// The drum holds its tool.
    pub drum_closed: bool,
    /// Identification number of the gripper on the robot.
    pub gripper: Option<u8>,
    /// How many parts there are; the first [`PARTS`] are shown.
    pub part_count: u32,
    /// The parts, by their numbers.
    pub parts: [PartView; PARTS],
    /// The job.
    pub job: JobView,
    /// How late ticks begin.
    pub lateness: LatenessView,
}

/// The console of the robot controller (IV.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ControllerView {
    /// Stage of its start-up: `hydraulics enabled`, `DEPC`.
    pub stage: Text<24>,
    /// Lamps and keys that stay.
    pub lamps: Lamps,
    /// The last warning or error on its screen, with its code; empty if there was none.
    pub screen: Text<96>,
    /// The tick of this warning or error.
    pub screen_tick: Tick,
    /// Why the actuators have no pressure; empty while they have it.
    pub cut: Text<48>,
    /// Emergency stops that are in (III.6): control panel, teach pendant, terminals, joystick box, pedestal.
    pub estops: [bool; 5],
    /// Axes with an asterisk on the screen.
    pub aligned: [bool; 6],
    /// The arm is at rest at its commanded position.
    pub at_rest: bool,
}

/// Lamps and keys of the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Lamps {
    /// Control power is on.
    pub power: bool,
    /// FAULT RESET is lit.
    pub fault_reset: bool,
    /// HYD ENABLED is lit.
    pub hydraulics_enabled: bool,
    /// MANUAL is on: the actuators have pressure.
    pub hydraulics_on: bool,
    /// Auto mode.
    pub auto: bool,
    /// Hold is on.
    pub hold: bool,
}

/// The panel of the rotary table's controller (IV.1 step 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct TableView {
    /// It has power.
    pub power: bool,
    /// The mode switch stands at MANUAL.
    pub manual: bool,
    /// It obeys its serial line.
    pub obeys: bool,
}

/// A part in the cell.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PartView {
    /// Its number in the cell, from 1; 0 for no part.
    pub id: u32,
    /// Its name at present.
    pub name: Name16,
    /// Where it is: a unit, the vise's, the drum's or the pedestal's location, `gripper`, `floor` or `elsewhere`.
    pub location: Name16,
    /// The nearest sector of the unit; 0 elsewhere.
    pub sector: u16,
    /// The gripper holds it.
    pub held: bool,
    /// The vise holds it.
    pub clamped: bool,
    /// Its middle in world coordinates, in.
    pub position: [f64; 3],
}

/// How far the job is.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JobView {
    /// Lines that the job has, the first PAUSE not counted.
    pub lines: u32,
    /// Lines that were begun, the first PAUSE counted; 0 before it.
    pub begun: u32,
    /// The line that was begun last.
    pub line: Text<96>,
    /// The tick after which it was begun.
    pub began: Tick,
}

/// How late ticks begin on the 40 ms grid, microseconds; all 0 in a run without one. All but the last tick as of
/// the last full second.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LatenessView {
    /// The last tick.
    pub last: f64,
    /// Median of all ticks.
    pub p50: f64,
    /// 99 of 100 ticks are at most so late.
    pub p99: f64,
    /// The latest tick.
    pub max: f64,
}
