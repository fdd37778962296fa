//! Decision tables of Grip: a file a command.

mod close_grip;
mod pause;
mod position;
mod up_init;

use rcs_core::{coded_enum, interface::Reason};

pub use self::{
    close_grip::{CLOSE_GRIP, close_grip},
    pause::{PAUSE, pause},
    position::{POSITION, position},
    up_init::{UP_INIT, up_init},
};

coded_enum! {
    /// Is the parts gripper there?
    pub enum Gripper {
        /// It is mated and the quick change is locked.
        Attached = "attached",
        /// It is not.
        Detached = "detached",
    }
}

coded_enum! {
    /// Time of the command that has the duty.
    pub enum Clock {
        /// Within its limit.
        Running = "running",
        /// Over its limit.
        Expired = "expired",
    }
}

coded_enum! {
    /// Opening of the fingers, seen from the commanded one.
    pub enum Opening {
        /// Much too narrow: a coarse flow cannot overshoot.
        VeryNarrow = "very narrow",
        /// Too narrow: a medium flow cannot overshoot.
        Narrow = "narrow",
        /// A little too narrow.
        BitNarrow = "bit narrow",
        /// Within the dead band.
        Right = "right",
        /// A little too wide.
        BitWide = "bit wide",
        /// Too wide: a medium flow cannot overshoot.
        Wide = "wide",
        /// Much too wide: a coarse flow cannot overshoot.
        VeryWide = "very wide",
    }
}

coded_enum! {
    /// What the fingers feel on the way to a grasp.
    pub enum Grasp {
        /// Nothing, far from the grasp size.
        Far = "far",
        /// Nothing, where the object is expected.
        Near = "near",
        /// Nothing for some ticks, though the grasp size is passed: there is no object.
        Missed = "missed",
        /// One finger touches, the other does not.
        OneFinger = "one finger",
        /// Both touch, force much too low: a medium flow cannot overshoot.
        Loose = "loose",
        /// Force a little too low.
        Weak = "weak",
        /// Force as commanded.
        Firm = "firm",
        /// Force a little too high.
        Strong = "strong",
        /// Force much too high.
        Crushing = "crushing",
    }
}

coded_enum! {
    /// Have the readings settled since the valves went off?
    pub enum Rest {
        /// Not yet.
        Waiting = "waiting",
        /// Yes.
        Rested = "rested",
    }
}

coded_enum! {
    /// What the sensors read while calibrating.
    pub enum Calibrating {
        /// Something changes.
        Unsteady = "unsteady",
        /// Steady for long enough.
        Steady = "steady",
        /// Steady, and the sensors do not tell the ends of travel apart.
        Implausible = "implausible",
    }
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
