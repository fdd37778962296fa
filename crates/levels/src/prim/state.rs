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

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimGoal {
    pub frame: FrameData, // `^-pose` with `^-movtab` applied
    pub limits: Limits,   // `^-traj-para`
    /// GO-THRU: brk-dst of `^-traj-para`, inches of path.
    pub through: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimTarget {
    pub verb: PrimVerb,
    pub goal: Option<PrimGoal>,
    pub sensor: Option<SensorPara>,  // the sensor of a guarded move
    pub end_effector_id: Option<u8>, // `endeff-id#-in`
}

/// Ticks since T3I finished the last point of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Standstill {
    pub finished: u32, // all of them
    pub settled: u32,  // the last consecutive ones at the goal
    pub still: u32,    // the last consecutive ones without motion
}

pub const MOST_RESTARTS: usize = 10;
/// 10 s. ASSUMED.
pub const RESTART_TICKS: u64 = 250;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct RestartTimes {
    pub ticks: [Option<Tick>; MOST_RESTARTS], // RESTARTs that Prim has sent by itself, the latest first
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

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub link: LinkStep, // step of LINK
    pub restarts: RestartTimes,
    pub way: PrimPath,
    pub t3i: Commander,
    pub target: PrimTarget,
    pub motion: Option<PrimMotion>, // `None` while Prim has no position
    pub manual: PrimManual,
    pub standstill: Standstill,
    pub resolver_frame: Option<WireFrame>, // the valid frame of the previous tick
    pub calibration: ForceCalibration,
    pub sensed: i32,         // reading of the sensor of the guarded move
    pub record_button: bool, // state in the previous tick
    pub single_step: bool,   // switch of Prim on the joystick box in the previous tick
    pub newest_pose: u32,
}
