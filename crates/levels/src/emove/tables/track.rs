//! Record of the path on which the joystick box moves the robot.

use rcs_core::{Actions, Plain, Variables, decision_table};

use super::Knowledge;
pub use interfaces::track::Course;

/// The process or person that moves the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Mover {
    /// The joystick box has the robot, or has had it since the last motion of E-move.
    Box,
    /// Prim has a motion from E-move.
    Emove,
    /// Neither: Prim holds the robot, or brings it to rest.
    Hold,
}

/// The link to the robot controller, seen from the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLine {
    /// It has not failed.
    Sound,
    /// It has failed, or Prim restarts it: the arm may sink.
    Failed,
}

/// The present pose, seen from the end of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TrackStep {
    /// Near it: no farther than the robot moves in a few ticks.
    Near,
    /// Far from it, and near another part of the record: E-move has moved the robot back along it.
    Back,
    /// Far from all of it: E-move was not stepped for a while.
    Far,
}

/// The state variables.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Tracking {
    /// Is the place or the way of the robot known?
    pub place: Knowledge,
    /// What is known of the path so far.
    pub course: Course,
    /// What moves the robot.
    pub mover: Mover,
    /// The link.
    pub line: EmoveLine,
    /// The present pose.
    pub step: TrackStep,
}

/// What is done with the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum TrackChange {
    /// Nothing.
    Keep,
    /// Drop it, and note the present pose.
    Note,
    /// Begin it at the pose of the tick before.
    Begin,
    /// Add the present pose.
    Add,
    /// Shorten it to the present pose.
    Shorten,
    /// A part of the path is missing from now on.
    Break,
    /// The robot has moved by itself.
    Drift,
}

decision_table! {
    /// TRACK: the path on which the joystick box moves the robot away from its last known place or way is recorded,
    /// so that the robot can go back on it (docs/design/recovery.md "Return"). Preprocess consults it every tick;
    /// no header names its rows.
    pub TRACK: fn track(self::Tracking) -> self::TrackChange {
        1:  place: Known                                          => Note;
        2:  course: None | Adrift                                 => Keep;
        3:  line: Failed                                          => Drift;
        4:  course: Broken                                        => Keep;
        5:  course: Known,   mover: Emove | Hold                  => Drift;
        6:  course: Known,   mover: Box,        step: Near        => Begin;
        7:  course: Known,   mover: Box,        step: Back | Far  => Break;
        8:  course: Tracked, mover: Emove                         => Keep;
        9:  course: Tracked, mover: Box | Hold, step: Near        => Add;
        10: course: Tracked, mover: Box | Hold, step: Back        => Shorten;
        11: course: Tracked, mover: Box | Hold, step: Far         => Break;
    }
}
