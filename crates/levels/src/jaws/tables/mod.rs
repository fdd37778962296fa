//! Decision tables of V-Grip and Tool-Grip: preconditions of a new command, rows common to all commands, and one
//! file per command.

pub mod accept;
pub mod air;
pub mod grasp;
pub mod pause;
pub mod presence;
pub mod release;
pub mod valves;

pub use crate::variables::{Addressee, Attachment};
use interfaces::{
    Reason,
    device::GroupHealth,
    grip::Felt,
    jaws::{JawsReport, JawsVerb},
};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use self::valves::AttachedGripper;
use super::goals;
use crate::execution::{Asked, EXECUTE};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not begun.
    Start,
    /// The fingers have air.
    Move,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum JawsMotion {
    /// The fingers move, may not have started to, or do not press yet on the object.
    Moving,
    /// The fingers are at rest.
    Stopped,
    /// The fingers move for longer than their whole travel takes.
    Endless,
}

/// The position of the fingers between the ends of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Stop {
    /// Closed.
    Closed,
    /// Between the ends.
    Between,
    /// Opened.
    Opened,
}

/// The position of the fingers relative to `commanded-size`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Size {
    /// At the commanded size.
    Commanded,
    /// Elsewhere, or no size was commanded.
    Other,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The command.
    pub verb: JawsVerb,
    /// The gripper that the command addresses.
    pub addressee: Addressee,
    /// Whether the gripper is attached.
    pub gripper: Attachment,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// Whether the gripper is attached.
    pub gripper: Attachment,
    /// The motion of the fingers.
    pub motion: JawsMotion,
    /// The position of the fingers in their travel.
    pub stop: Stop,
    /// The position of the fingers relative to the commanded size.
    pub size: Size,
    /// The connection with the gripper.
    pub connection: GroupHealth,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    pub verb: JawsVerb,
    pub request: Request,
    pub situation: Situation,
    pub mated: AttachedGripper,
    /// The part presence.
    pub felt: Felt,
    /// `commanded-size` for an accepted command, 0.01 in.
    pub size: Option<i32>,
    /// Opening by the mean of the last readings, in.
    pub opening: f64,
    /// Opening velocity, in/s.
    pub velocity: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// The valves stay as they are.
    Wait,
    /// Air to the side that closes.
    Close,
    /// Air to the side that opens.
    Open,
    /// The valves stay as they are; the command is done, with this status.
    Report(JawsReport),
    /// The valves stay as they are; the fingers stopped at another position than commanded: an error, with this
    /// status.
    Wrong(JawsReport),
    /// The valves stay as they are; report an error.
    Refuse(Reason),
    /// Air off; report an error.
    Fail(Reason),
}

commands! {
    pub fn of_command(JawsVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, presence::PRESENCE, valves::VALVES;
        before: EXECUTE, ACCEPT(request);
        Grasp: goals::CLOSED            => air::air then grasp::grasp;
        Release | Pose: goals::OPENED   => air::air then release::release;
        None | Pause: goals::REST       => pause::pause;
    }
}
