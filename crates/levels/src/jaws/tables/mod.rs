//! Decision tables of V-Grip and Tool-Grip: a file a command.

mod grasp;
mod pause;
mod release;

use rcs_core::{
    Plain,
    interface::{Reason, jaws::JawsReport},
};

pub use self::{
    grasp::{GRASP, Step, grasp},
    pause::{PAUSE, pause},
    release::{RELEASE, release},
};

/// Is the gripper of this process there?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Gripper {
    /// It is mated and the quick change is locked.
    Attached,
    /// It is not.
    Detached,
}

/// What the fingers do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Motion {
    /// They move, or may not have begun to.
    Moving,
    /// They stand still.
    Stopped,
    /// They move for longer than the whole way takes.
    Endless,
}

/// Where the fingers are, seen from the ends of their way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Stop {
    /// Closed.
    Closed,
    /// Somewhere between.
    Between,
    /// Opened.
    Opened,
}

/// Where the fingers are, seen from `commanded-size`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Size {
    /// There.
    Commanded,
    /// Elsewhere, or nothing was commanded.
    Other,
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
