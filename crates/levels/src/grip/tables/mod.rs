//! Decision tables of Grip: a file a command.

mod close_grip;
mod pause;
mod position;
mod up_init;

use rcs_core::{Plain, interface::Reason};

pub use self::{
    close_grip::{CLOSE_GRIP, close_grip},
    pause::{PAUSE, pause},
    position::{POSITION, position},
    up_init::{UP_INIT, up_init},
};

/// Is the parts gripper there?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Gripper {
    /// It is mated and the quick change is locked.
    Attached,
    /// It is not.
    Detached,
}

/// Time of the command that has the duty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// Within its limit.
    Running,
    /// Over its limit.
    Expired,
}

/// Opening of the fingers, seen from the commanded one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Opening {
    /// Much too narrow: a coarse flow cannot overshoot.
    #[text = "very narrow"]
    VeryNarrow,
    /// Too narrow: a medium flow cannot overshoot.
    Narrow,
    /// A little too narrow.
    #[text = "bit narrow"]
    BitNarrow,
    /// Within the dead band.
    Right,
    /// A little too wide.
    #[text = "bit wide"]
    BitWide,
    /// Too wide: a medium flow cannot overshoot.
    Wide,
    /// Much too wide: a coarse flow cannot overshoot.
    #[text = "very wide"]
    VeryWide,
}

/// What the fingers feel on the way to a grasp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grasp {
    /// Nothing, far from the grasp size.
    Far,
    /// Nothing, where the object is expected.
    Near,
    /// Nothing for some ticks, though the grasp size is passed: there is no object.
    Missed,
    /// One finger touches, the other does not.
    #[text = "one finger"]
    OneFinger,
    /// Both touch, force much too low: a medium flow cannot overshoot.
    Loose,
    /// Force a little too low.
    Weak,
    /// Force as commanded.
    Firm,
    /// Force a little too high.
    Strong,
    /// Force much too high.
    Crushing,
}

/// Have the readings settled since the valves went off?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Rest {
    /// Not yet.
    Waiting,
    /// Yes.
    Rested,
}

/// What the sensors read while calibrating.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Calibrating {
    /// Something changes.
    Unsteady,
    /// Steady for long enough.
    Steady,
    /// Steady, and the sensors do not tell the ends of travel apart.
    Implausible,
}

/// How much air flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flow {
    /// 0.25 in/s.
    Fine,
    /// 1 in/s.
    Medium,
    /// 4 in/s.
    Coarse,
}

/// What a row wants of the valves and the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// All valves off: trapped air holds opening and force.
    Stop,
    /// All valves off; the command is done.
    Finish,
    /// The valves stay as they were.
    Keep,
    /// The valves stay as they were; the command is done.
    Pause,
    /// Open with a flow, or a smaller one if the commanded speed asks for that.
    Open(Flow),
    /// Close with a flow, or a smaller one if the commanded speed asks for that.
    Close(Flow),
    /// Close on with one finger in contact; reports `paused`.
    AwaitFinger,
    /// All valves off; the command has failed.
    Fail(Reason),
    /// All close flows.
    CloseFully,
    /// The readings are those of the closed end; all open flows.
    NoteClosed,
    /// All open flows.
    OpenFully,
    /// The readings are those of the open end; vent.
    NoteOpen,
    /// Vent both sides.
    Vent,
    /// The readings are those without force: set scale and offset of the sensors; valves off.
    Calibrate,
}
