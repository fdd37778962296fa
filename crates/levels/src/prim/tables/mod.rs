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
    coded_enum,
    interface::{Reason, prim::PrimVerb},
};

use self::attend::Switches;

coded_enum! {
    /// What hinders a command.
    pub enum Health {
        /// Nothing.
        Good = "good",
        /// T3I reports that the DEPC link does not respond.
        LinkOff = "link off",
        /// T3I reports an error of the DEPC link.
        LinkError = "link error",
        /// T3I refused a command.
        Refused = "refused",
        /// T3I does not answer.
        Silent = "silent",
        /// E-move does not write its buffers.
        Orphaned = "orphaned",
        /// The operator has turned a frame switch of the joystick box on.
        Operator = "operator",
    }
}

coded_enum! {
    /// Does T3I want a point (VI.1.2 status-report)?
    pub enum Pace {
        /// It has enough points, or has not answered yet.
        Busy = "busy",
        /// It is ready for a new point.
        Wanted = "wanted",
        /// It has finished all points.
        Finished = "finished",
    }
}

coded_enum! {
    /// What the robot was told to do.
    pub enum Posture {
        /// Nothing: where it is was never taken over, or is lost.
        Unpositioned = "unpositioned",
        /// The path is under way.
        Moving = "moving",
        /// The last point of the path is sent, but not finished.
        Ending = "ending",
        /// It stands where it was told to be.
        Standing = "standing",
    }
}

coded_enum! {
    /// The DEPC link after a RESTART.
    pub enum Link {
        /// It does not run yet.
        Down = "down",
        /// It runs, and T3I feeds back a frame.
        Running = "running",
    }
}

coded_enum! {
    /// A through point.
    pub enum Passage {
        /// On the way.
        UnderWay = "under way",
        /// Nearer than the brake distance: the next goal is welcome.
        Passing = "passing",
    }
}

coded_enum! {
    /// The end of a motion: at the goal (DESIGN 16 "Done"), or wherever the robot stands.
    pub enum Arrival {
        /// On the way.
        UnderWay = "under way",
        /// All points are finished; the resolvers are watched.
        Settling = "settling",
        /// The resolvers say that the robot rests there.
        Arrived = "arrived",
        /// It should have come to rest there long ago.
        Late = "late",
    }
}

coded_enum! {
    /// The sensor of a guarded move.
    pub enum Guard {
        /// The condition does not hold.
        Clear = "clear",
        /// It holds.
        Met = "met",
        /// The sensor is overloaded, not calibrated, or not there.
        Faulty = "faulty",
    }
}

coded_enum! {
    /// The readings that make a bias of the force sensor.
    pub enum Samples {
        /// Another one is wanted.
        Wanted = "wanted",
        /// There are enough.
        Complete = "complete",
        /// The sensor is overloaded, or not there.
        Faulty = "faulty",
    }
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
pub type Choice = crate::execution::Choice<Action>;

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

#[cfg(test)]
mod tests {
    use rcs_core::process::Process;
    use taskdata::files::TaskData;

    use crate::prim::Prim;

    #[test]
    fn no_row_is_dead() {
        for table in <Prim as Process<TaskData<'_>>>::TABLES {
            table.dead_rows(|row| panic!("{}: row {row} can never fire", table.name));
        }
    }
}
