//! Decision tables of the table process: a file a command.

mod calibrate;
mod pause;
mod turn;

use rcs_core::{Plain, interface::Reason};

pub use self::{
    calibrate::{CALIBRATE, calibrate},
    pause::{PAUSE, pause},
    turn::{Step, TURN, turn},
};

/// What the motor does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Motor {
    /// Its controller has not taken the last order yet.
    Pending,
    /// It turns, or has come to rest only just now.
    Turning,
    /// It stands.
    Standing,
    /// Its controller does not take the last order.
    Silent,
}

/// Where the table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Place {
    /// Where the step that is under way wants it: at the + limit, with the counter set, at the angle.
    There,
    /// Anywhere else.
    Elsewhere,
}

/// Time of what has the duty.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Clock {
    /// Within its limit.
    Running,
    /// Over its limit.
    Expired,
}

/// What a row wants of the motor and the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// No new order.
    Wait,
    /// Turn towards the + limit.
    SeekLimit,
    /// The table stands at the + limit: give the counter the angle of the limit.
    SetCounter,
    /// The counter is set: the table is calibrated.
    Calibrated,
    /// Turn to the commanded angle.
    Turn,
    /// Stop.
    Stop,
    /// The command is done.
    Finish,
    /// Stop; the command has failed, and the angle is not known any more.
    Lose(Reason),
}
