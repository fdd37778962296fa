//! Decision tables of V-Grip and Tool-Grip: what a new command needs, what commands have in common, and a
//! file a command.

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
    device::Connection,
    grip::Felt,
    jaws::{JawsReport, JawsVerb},
};
use rcs_core::{Actions, Plain, Variables, commands, handshake::Arrival};

use self::valves::Mated;
use super::goals;
use crate::execution::{Asked, EXECUTE};

/// Step of all commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not begun.
    Start,
    /// The fingers have air.
    Move,
}

/// What the fingers do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum JawsMotion {
    /// They move, may not have begun to, or do not press yet what they have closed on.
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
    /// Elsewhere, or no size was commanded.
    Other,
}

/// What a new command needs, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: JawsVerb,
    /// For which gripper is it?
    pub addressee: Addressee,
    /// Is the gripper there?
    pub gripper: Attachment,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// Is the gripper there?
    pub gripper: Attachment,
    /// What the fingers do.
    pub motion: JawsMotion,
    /// Where they are on their way.
    pub stop: Stop,
    /// Where they are, seen from the commanded size.
    pub size: Size,
    /// How the controller is connected with the gripper.
    pub connection: Connection,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// The current command.
    pub verb: JawsVerb,
    /// What a new command needs.
    pub request: Request,
    /// The state variables of the command's table.
    pub situation: Situation,
    /// The gripper on the ring.
    pub mated: Mated,
    /// What is between the fingers.
    pub felt: Felt,
    /// `commanded-size` that counts once the command is accepted, 0.01 in.
    pub size: Option<i32>,
    /// Opening by the mean of the last readings, in.
    pub opening: f64,
    /// Opening velocity, in/s.
    pub velocity: f64,
}

/// What a row can ask for.
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
    /// The valves stay as they are; the fingers stopped where the command did not send them: an error, with
    /// this status.
    Wrong(JawsReport),
    /// The valves stay as they are; report an error.
    Refuse(Reason),
    /// No air; report an error.
    Fail(Reason),
}

commands! {
    /// Consult the table of a command.
    pub fn of_command(JawsVerb, Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, presence::PRESENCE, valves::VALVES;
        before: EXECUTE, ACCEPT(request);
        Grasp: goals::CLOSED            => air::air then grasp::grasp;
        Release | Pose: goals::OPENED   => air::air then release::release;
        None | Pause: goals::REST       => pause::pause;
    }
}
