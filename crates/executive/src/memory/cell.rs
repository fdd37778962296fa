//! The view of the simulated cell for screens: published after each tick, when the cell has moved.
//!
//! It is not an input of the controller and is not logged: a log has the cell on `/tf` and `/joint_states`. A run with
//! a robot at a port has no view.

use rcs_core::{Plain, name::Name16, tick::Tick};

use super::text::Text;

pub(super) const CELL: &str = "cell";
pub const PARTS: usize = 24; // greatest number of parts in the view

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
    /// Clear width, in, and force, lb, of the fingers of the pedestal's hand.
    pub pedestal_fingers: [f64; 2],
    /// Clear width between the jaws of the vise, in.
    pub vise_opening: f64,
    /// The drum holds its tool.
    pub drum_closed: bool,
    /// Identification number of the gripper on the robot.
    pub gripper: Option<u8>,
    /// Number of parts in the cell; the view has the first [`PARTS`].
    pub part_count: u32,
    /// The parts, by their numbers.
    pub parts: [PartView; PARTS],
    /// The job.
    pub job: JobView,
    /// Who commands.
    pub commander: CommanderView,
    /// Delays of ticks.
    pub lateness: LatenessView,
}

/// The console of the robot controller (IV.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ControllerView {
    /// Stage of its start-up, such as `hydraulics enabled` or `DEPC`.
    pub stage: Text<24>,
    /// Lamps and latching keys.
    pub lamps: Lamps,
    /// The last warning or error on its screen, with its code; empty if there was none.
    pub screen: Text<96>,
    /// The tick of this warning or error.
    pub screen_tick: Tick,
    /// Cause of the loss of pressure; empty under pressure.
    pub cut: Text<48>,
    /// The tick in which the pressure is lost: that after the press of a button. [`Tick::BEFORE_START`] under pressure.
    pub cut_tick: Tick,
    /// Emergency stops that are pressed (III.6): control panel, teach pendant, terminals, joystick box, pedestal.
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
    /// The controller has power.
    pub power: bool,
    /// The mode switch is at MANUAL.
    pub manual: bool,
    /// The controller obeys its serial line.
    pub obeys: bool,
}

/// A part in the cell.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PartView {
    /// Its number in the cell, from 1; 0 for no part.
    pub id: u32,
    /// Its name at present.
    pub name: Name16,
    /// A location: a unit, the location of the vise, the drum or the pedestal, `gripper`, `floor` or `elsewhere`.
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

/// Progress of the job.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct JobView {
    /// Number of lines of the job; 0 if a workstation controller commands from the start.
    pub lines: u32,
    /// Number of the line that was begun last; 0 before the first.
    pub begun: u32,
    /// The step that was begun last: a line of the job, PAUSE, or a command of an operator.
    pub line: Text<96>,
    /// The tick after which it was begun.
    pub began: Tick,
    /// `plays`, `waits` for an operator, `over`, `failed`, `ends`, or `outside`: a workstation controller commands.
    pub phase: Text<16>,
    /// Why the job waits or has failed.
    pub reason: Text<96>,
}

/// Who commands the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct CommanderView {
    /// `job`, `operator`, or `workstation controller`.
    pub source: Text<24>,
    /// Name of the operator in command; empty for none.
    pub operator: Text<32>,
    /// An operator has stopped the robot: the velocity knob is at 0 until `go`.
    pub is_stopped: bool,
    /// The joystick box controls the robot.
    pub by_hand: bool,
}

/// Delays of the beginnings of ticks on the 40 ms grid, microseconds; all 0 in a run without one. All except `last` are
/// as of the last full second.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LatenessView {
    /// Delay of the last tick.
    pub last: f64,
    /// Median of all ticks.
    pub p50: f64,
    /// 99 of 100 ticks have at most this delay.
    pub p99: f64,
    /// The greatest delay.
    pub max: f64,
}
