//! What Prim remembers from tick to tick.

use rcs_core::{Plain, handshake::Commander, interface::prim::PrimVerb, pose::WireFrame};
use taskdata::files::SensorPara;

use super::{
    manual::Manual,
    motion::{Motion, limits::Limits, segment::FrameData},
    sensors::Calibration,
    tables::Step,
};
use crate::execution::Execution;

/// Where a motion goes.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Goal {
    /// `^-pose` with `^-movtab` applied.
    pub frame: FrameData,
    /// Limits of `^-traj-para`.
    pub limits: Limits,
    /// GO-THRU: brk-dst of `^-traj-para`, inches of path. The robot is not to stop at the goal.
    pub through: Option<f64>,
}

/// The last command that was accepted, with its records looked up.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Target {
    /// What to do.
    pub verb: PrimVerb,
    /// The goal of a motion.
    pub goal: Option<Goal>,
    /// `"sensor"` of a guarded move.
    pub sensor: Option<SensorPara>,
    /// `endeff-id#-in`.
    pub end_effector_id: u8,
}

/// How long the robot has stood since T3I finished the last point of a motion, ticks.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Standstill {
    /// Since T3I finished the last point.
    pub finished: u32,
    /// The last ticks of them at the goal.
    pub settled: u32,
    /// The last ticks of them without motion.
    pub still: u32,
}

/// Rows of the tables of every tick that fired last; the header names those of the command only.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct TickRows {
    /// Row of ATTEND.
    pub attend: u8,
    /// Row of PATH-CLOCK.
    pub path_clock: u8,
    /// Row of RECORD-POSE.
    pub record_pose: u8,
}

/// State of Prim.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of E-move and how far it has come.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// Rows of the tables of every tick.
    pub rows: TickRows,
    /// Commands to T3I.
    pub t3i: Commander,
    /// What is to be done.
    pub target: Target,
    /// The commanded motion, if Prim commands the robot.
    pub motion: Option<Motion>,
    /// The motion of the joystick box.
    pub manual: Manual,
    /// The end of a motion.
    pub standstill: Standstill,
    /// The resolver frame of the tick before, if it could be believed.
    pub resolver_frame: Option<WireFrame>,
    /// The force sensor.
    pub calibration: Calibration,
    /// What the sensor of the guarded move reads.
    pub sensed: i32,
    /// The record button was pressed in the tick before.
    pub record_button: bool,
    /// The process is stepped singly: its switch on the joystick box was on in the tick before.
    pub single_step: bool,
    /// Number of the newest pose record.
    pub newest_pose: u32,
}
