//! What Prim remembers.

use rcs_core::{Plain, handshake::Commander, interface::prim::PrimVerb, pose::WireFrame};
use taskdata::files::SensorPara;

use super::{
    manual::Manual,
    motion::{Motion, limits::Limits, segment::FrameData},
    sensors::Calibration,
    tables::{path_clock::Clock, record_pose::Recording},
};
use crate::old_execution::Execution;

/// The current command with its records looked up.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Target {
    /// What to do.
    pub verb: PrimVerb,
    /// `^-pose` with `^-movtab` applied; unused by PAUSE and ROBOT-INIT.
    pub goal: FrameData,
    /// Limits of `^-traj-para`.
    pub limits: Limits,
    /// brk-dst of `^-traj-para`, inches of path.
    pub brake_distance: f64,
    /// `"sensor"` of a guarded move.
    pub sensor: SensorPara,
    /// `endeff-id#-in`.
    pub end_effector_id: u8,
}

impl Target {
    /// The robot is not to stop at the goal.
    #[must_use]
    pub fn is_through(&self) -> bool {
        self.verb == PrimVerb::GoThru
    }

    /// A sensor is watched.
    #[must_use]
    pub fn is_guarded(&self) -> bool {
        matches!(self.verb, PrimVerb::GoUntil | PrimVerb::GoWhile)
    }
}

/// Everything that Prim remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command and how far it has come.
    pub execution: Execution,
    /// The command to T3I.
    pub t3i: Commander,
    /// What is to be done.
    pub target: Target,
    /// The robot is commanded by Prim: `motion` holds where it was told to be.
    pub positioned: bool,
    /// The commanded motion.
    pub motion: Motion,
    /// The motion of the joystick box.
    pub manual: Manual,
    /// Did the path clock run in the last tick?
    pub clock: Clock,
    /// Ticks since T3I finished the last point of a motion.
    pub finished: u32,
    /// The last ticks of them at the goal.
    pub settled: u32,
    /// The last ticks of them without motion.
    pub still: u32,
    /// Where the resolvers saw the robot in the tick before.
    pub seen: WireFrame,
    /// The force sensor.
    pub calibration: Calibration,
    /// What the sensor of the guarded move reads.
    pub sensed: i32,
    /// A recorded pose is being looked at.
    pub recording: Recording,
    /// The record button was pressed in the tick before.
    pub record_button: bool,
    /// The process is stepped singly: its switch on the joystick box was on in the tick before.
    pub single_step: bool,
    /// Number of the newest pose record.
    pub newest_pose: u32,
    /// Rows of the tables of every tick that fired last: ATTEND, PATH-CLOCK, RECORD-POSE.
    pub rows: [u8; 3],
}

impl State {
    /// What has been seen of the end of a motion does not count any more.
    pub fn forget_rest(&mut self) {
        (self.finished, self.settled, self.still) = (0, 0, 0);
    }
}
