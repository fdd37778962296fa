//! Decision tables of the pedestal process: a file a command.

mod flip;
mod grip;
mod pause;
mod pre_grip;
mod release;

use rcs_core::{Plain, interface::Reason};

pub use self::{
    flip::{FLIP, flip},
    grip::{GRIP, grip},
    pause::{PAUSE, pause},
    pre_grip::{PRE_GRIP, pre_grip},
    release::{RELEASE, release},
};

/// Reference action of all commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing sent yet.
    Start,
    /// Hand, table or both have their commands.
    Move,
}

/// What the hand holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Object {
    /// Nothing that it was to hold.
    None,
    /// The object between its fingers.
    Held,
    /// Nothing, though it gripped an object.
    Lost,
}

/// What a row wants of hand, table and status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// No new command.
    Wait,
    /// Open the hand, turn the table to the angle.
    OpenAndTurn,
    /// Close the hand on the object.
    Close,
    /// Turn the table by the angle.
    TurnOver,
    /// Open the hand.
    Open,
    /// Stop the table.
    StopTable,
    /// The command is done.
    Finish,
    /// The command is done: the hand holds the object.
    Gripped,
    /// The command has failed.
    Fail(Reason),
    /// The hand has failed; pass its reason up.
    FailHand,
    /// The table has failed; pass its reason up.
    FailTable,
}
