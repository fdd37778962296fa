//! Decision tables of V-Grip and Tool-Grip: a file a command.

mod grasp;
mod pause;
mod release;

use rcs_core::{
    coded_enum,
    interface::{Reason, jaws::JawsReport},
};

pub use self::{
    grasp::{GRASP, Step, grasp},
    pause::{PAUSE, pause},
    release::{RELEASE, release},
};

coded_enum! {
    /// Is the gripper of this process there?
    pub enum Gripper {
        /// It is mated and the quick change is locked.
        Attached = "attached",
        /// It is not.
        Detached = "detached",
    }
}

coded_enum! {
    /// What the fingers do.
    pub enum Motion {
        /// They move, or may not have begun to.
        Moving = "moving",
        /// They stand still.
        Stopped = "stopped",
        /// They move for longer than the whole way takes.
        Endless = "endless",
    }
}

coded_enum! {
    /// Where the fingers are, seen from the ends of their way.
    pub enum Stop {
        /// Closed.
        Closed = "closed",
        /// Somewhere between.
        Between = "between",
        /// Opened.
        Opened = "opened",
    }
}

coded_enum! {
    /// Where the fingers are, seen from `commanded-size`.
    pub enum Size {
        /// There.
        Commanded = "commanded",
        /// Elsewhere, or nothing was commanded.
        Other = "other",
    }
}

/// What a row wants of the valves and the status; the first two are for ticks in which no table of a command is consulted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Everything stays as it is.
    Keep,
    /// The valves stay as they are; the command is refused.
    Refuse,
    /// Air to the side that closes; executing.
    Close,
    /// Air to the side that opens; executing.
    Open,
    /// The valves stay as they are; executing.
    Wait,
    /// The valves stay as they are; the command has ended with this status.
    Report(JawsReport),
    /// The valves stay as they are; the fingers ended where the command did not send them.
    Wrong(JawsReport),
    /// No air; the command has failed.
    Fail(Reason),
}
