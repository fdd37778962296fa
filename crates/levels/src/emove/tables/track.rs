//! Record of the path on which the joystick box moves the robot.

use rcs_core::{Actions, Plain, Variables, decision_table};

use super::Knowledge;
pub use interfaces::track::Course;

/// The source of the robot's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Mover {
    /// The joystick box controls the robot, or has controlled it since the last motion of E-move.
    Box,
    /// Prim executes a motion from E-move.
    Emove,
    /// None: Prim holds the robot, or brings it to rest.
    Hold,
}

/// The link to the robot controller, relative to the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLine {
    /// The link has not failed.
    Sound,
    /// The link has failed, or Prim restarts it: the arm may sink.
    Failed,
}

/// The present pose, relative to the end of the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TrackStep {
    /// Near the end: no farther than the robot moves in a few ticks.
    Near,
    /// Far from the end, but near another part of the record: E-move has moved the robot back along it.
    Back,
    /// Far from all parts of the record: E-move was not stepped for a while.
    Far,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Tracking {
    /// Knowledge of the robot's place or way.
    pub place: Knowledge,
    /// Knowledge of the path so far.
    pub course: Course,
    /// The source of the robot's motion.
    pub mover: Mover,
    /// The link to the robot controller.
    pub line: EmoveLine,
    /// The present pose, relative to the record.
    pub step: TrackStep,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum TrackChange {
    /// No change.
    Keep,
    /// Clear the record, and store the present pose.
    Note,
    /// Start the record at the pose of the tick before.
    Begin,
    /// Add the present pose.
    Add,
    /// Shorten the record to the present pose.
    Shorten,
    /// A part of the path is missing from now on.
    Break,
    /// The robot has moved without a command.
    Drift,
}

decision_table! {
    /// TRACK: record the path on which the joystick box moves the robot away from its last known place or way, so
    /// that the robot can retrace it (docs/design/recovery.md "Return"). Preprocess consults this table in every
    /// tick. Headers do not name its rows.
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
