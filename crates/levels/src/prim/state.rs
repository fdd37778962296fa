use geometry::pose::WireFrame;
use interfaces::prim::PrimVerb;
use rcs_core::{Plain, handshake::Commander, tick::Tick};
use taskdata::files::SensorPara;

use super::{
    manual::PrimManual,
    motion::{PrimMotion, limits::Limits, segment::FrameData},
    sensors::ForceCalibration,
    tables::{PrimPath, Restarts, Step, link::LinkStep},
};
use crate::execution::Execution;

/// The goal of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimGoal {
    /// `^-pose` with `^-movtab` applied.
    pub frame: FrameData,
    /// Limits of `^-traj-para`.
    pub limits: Limits,
    /// GO-THRU: brk-dst of `^-traj-para`, inches of path. The robot does not stop at the goal.
    pub through: Option<f64>,
}

/// The last command that was accepted, with its records looked up.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimTarget {
    /// What to do.
    pub verb: PrimVerb,
    /// The goal of a motion.
    pub goal: Option<PrimGoal>,
    /// `"sensor"` of a guarded move.
    pub sensor: Option<SensorPara>,
    /// `endeff-id#-in`.
    pub end_effector_id: Option<u8>,
}

/// How long the robot has been at rest since T3I finished the last point of a motion, ticks.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Standstill {
    /// Since T3I finished the last point.
    pub finished: u32,
    /// The most recent of these ticks that were at the goal.
    pub settled: u32,
    /// The most recent of these ticks without motion.
    pub still: u32,
}

/// Greatest number of RESTARTs in [`RESTART_TICKS`].
pub const MOST_RESTARTS: usize = 10;
/// Period for [`MOST_RESTARTS`], ticks: 10 s. ASSUMED.
pub const RESTART_TICKS: u64 = 250;

/// The last RESTARTs that Prim has sent by itself, the latest first.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RestartTimes {
    /// When they were sent.
    pub ticks: [Option<Tick>; MOST_RESTARTS],
}

impl RestartTimes {
    pub(super) fn add(&mut self, now: Tick) {
        self.ticks.rotate_right(1);
        if let Some(latest) = self.ticks.first_mut() {
            *latest = Some(now);
        }
    }

    pub(super) fn so_far(&self, now: Tick) -> Restarts {
        let recent = |time: &Option<Tick>| time.is_some_and(|time| now.since(time) <= RESTART_TICKS);
        if self.ticks.iter().all(recent) { Restarts::Many } else { Restarts::Few }
    }
}

/// State of Prim.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of E-move and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// Step of LINK.
    pub link: LinkStep,
    /// The last restarts.
    pub restarts: RestartTimes,
    /// The path to the goal.
    pub way: PrimPath,
    /// Commands to T3I.
    pub t3i: Commander,
    /// What is to be done.
    pub target: PrimTarget,
    /// The commanded motion; none while Prim has no position.
    pub motion: Option<PrimMotion>,
    /// The motion of the joystick box.
    pub manual: PrimManual,
    /// The end of a motion.
    pub standstill: Standstill,
    /// The resolver frame of the previous tick, if it was valid.
    pub resolver_frame: Option<WireFrame>,
    /// The force sensor.
    pub calibration: ForceCalibration,
    /// Reading of the sensor of the guarded move.
    pub sensed: i32,
    /// The record button was pressed in the previous tick.
    pub record_button: bool,
    /// The process is stepped singly: its switch on the joystick box was on in the previous tick.
    pub single_step: bool,
    /// Number of the newest pose record.
    pub newest_pose: u32,
}
