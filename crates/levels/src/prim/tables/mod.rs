//! Decision tables of Prim: a file a command, and those of every tick: what becomes of finished commands,
//! the path clock, the record button.

pub mod attend;
pub mod cal_sensor;
pub mod delta_move;
pub mod go_thru;
pub mod go_until;
pub mod go_while;
pub mod goto_pt;
pub mod path_clock;
pub mod pause;
pub mod record_pose;
pub mod robot_init;

use rcs_core::{
    Plain,
    interface::{Reason, prim::PrimVerb},
};

use self::attend::Switches;

/// What hinders a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Health {
    /// Nothing.
    Good,
    /// T3I reports that the DEPC link does not respond.
    #[text = "link off"]
    LinkOff,
    /// T3I reports an error of the DEPC link.
    #[text = "link error"]
    LinkError,
    /// T3I refused a command.
    Refused,
    /// T3I does not answer.
    Silent,
    /// E-move does not write its buffers.
    Orphaned,
    /// The operator has turned a frame switch of the joystick box on.
    Operator,
}

/// Does T3I want a point (VI.1.2 status-report)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pace {
    /// It has enough points, or has not answered yet.
    Busy,
    /// It is ready for a new point.
    Wanted,
    /// It has finished all points.
    Finished,
}

/// What the robot was told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Posture {
    /// Nothing: where it is was never taken over, or is lost.
    Unpositioned,
    /// The path is under way.
    Moving,
    /// The last point of the path is sent, but not finished.
    Ending,
    /// It stands where it was told to be.
    Standing,
}

/// The DEPC link after a RESTART.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Link {
    /// It does not run yet.
    Down,
    /// It runs, and T3I feeds back a frame.
    Running,
}

/// A through point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Passage {
    /// On the way.
    #[text = "under way"]
    UnderWay,
    /// Nearer than the brake distance: the next goal is welcome.
    Passing,
}

/// The end of a motion: at the goal (docs/design/motion.md "Rest"), or wherever the robot stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Arrival {
    /// On the way.
    #[text = "under way"]
    UnderWay,
    /// All points are finished; the resolvers are watched.
    Settling,
    /// The resolvers say that the robot rests there.
    Arrived,
    /// It should have come to rest there long ago.
    Late,
}

/// The sensor of a guarded move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Guard {
    /// The condition does not hold.
    Clear,
    /// It holds.
    Met,
    /// The sensor is overloaded, not calibrated, or not there.
    Faulty,
}

/// The readings that make a bias of the force sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Samples {
    /// Another one is wanted.
    Wanted,
    /// There are enough.
    Complete,
    /// The sensor is overloaded, or not there.
    Faulty,
}

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// What hinders the command.
    pub health: Health,
    /// Does T3I want a point?
    pub pace: Pace,
    /// What the robot was told to do.
    pub posture: Posture,
    /// The link after a RESTART.
    pub link: Link,
    /// The through point of a GO-THRU.
    pub passage: Passage,
    /// The goal of a motion that stops there.
    pub arrival: Arrival,
    /// Wherever the robot stands.
    pub rest: Arrival,
    /// The sensor of a guarded move.
    pub guard: Guard,
    /// The bias of the force sensor.
    pub samples: Samples,
    /// The frame switches of the joystick box.
    pub switches: Switches,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Nothing new; a motion goes on.
    Wait,
    /// Move to the goal.
    Go,
    /// Ramp down and stop.
    Halt,
    /// RESTART to T3I.
    Restart,
    /// Take the frame that T3I feeds back as the commanded one; report done.
    TakePosition,
    /// Report `joystick-on`, ramp down and stop.
    Yield,
    /// Report `joystick-on`, and move as the box asks for.
    Drive,
    /// Publish where the robot is, ramp down and stop.
    Detect,
    /// Report `not-detected`.
    Miss,
    /// Take a reading of the force sensor.
    Sample,
    /// Take the mean of the readings as no force; report done.
    Calibrate,
    /// Report done.
    Finish,
    /// Report an error, ramp down and stop.
    Fail(Reason),
}

/// What the table of the current command decided.
pub type Choice = crate::old_execution::Choice<Action>;

/// Consult the table of a command. A step that the command does not have counts as its first.
#[must_use]
pub fn decide(verb: PrimVerb, step: u8, s: &Situation) -> Choice {
    match verb {
        PrimVerb::None | PrimVerb::Pause => pause::consult(step, s),
        PrimVerb::RobotInit => robot_init::consult(step, s),
        PrimVerb::GoThru => go_thru::consult(step, s),
        PrimVerb::GotoPt => goto_pt::consult(step, s),
        PrimVerb::GoUntil => go_until::consult(step, s),
        PrimVerb::GoWhile => go_while::consult(step, s),
        PrimVerb::DeltaMove => delta_move::consult(step, s),
        PrimVerb::CalSensor => cal_sensor::consult(step, s),
    }
}
