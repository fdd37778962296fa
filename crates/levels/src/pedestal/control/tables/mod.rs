//! Decision tables of the pedestal process: preconditions of a new command, results of its orders, and one file per
//! command.

pub mod accept;
pub mod flip;
pub mod grip;
pub mod ordered;
pub mod pause;
pub mod pre_grip;
pub mod release;

use interfaces::{Reason, pedestal::PedestalVerb};
use rcs_core::{
    Actions, Plain, Variables, commands,
    handshake::{Arrival, Lower},
};

use super::goals;
use crate::{
    confirm::{CONFIRM, Proof},
    execution::{Asked, EXECUTE, Ending, Work},
    halt::{HALT, Replaced, Stopping},
};

/// Whether the table can turn to the commanded angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalAngle {
    /// The angle is within the limits, or the table is not to turn.
    Within,
    /// The angle is beyond the limits.
    Beyond,
    /// The angle of the table is not known, so a relative angle has no meaning.
    Unknown,
}

/// Whether the hand can reach the commanded opening and force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalOpening {
    /// Both are within its range, or the hand is not to move.
    Within,
    /// Opening or force is beyond its range.
    Beyond,
}

/// The processes that have the orders of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalRecipient {
    /// No process.
    Nothing,
    /// The hand.
    Hand,
    /// The table.
    Table,
    /// Hand and table.
    Both,
}

/// The object in the hand (VI.7.2 `grip-size`, `grip-force`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Object {
    /// The sensors do not show it, or the hand does not answer.
    NotKnown,
    /// No object, and none was gripped.
    None,
    /// The object is between the fingers.
    Held,
    /// An object was gripped, but the sensors show none, or the fingers are no wider than the grasp size.
    Lost,
}

/// Calibration of the hand's sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalCalibration {
    /// The sensors are calibrated.
    Known,
    /// The sensors are not calibrated.
    Missing,
}

/// Whether the hand was commanded to grip, and not to open afterwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Gripped {
    /// The hand holds no object of a command.
    No,
    /// The hand may hold the object of a command.
    Yes,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Whether the command is new.
    pub asked: Asked,
    /// The command.
    pub verb: PedestalVerb,
    /// Whether the table can turn to the commanded angle.
    pub angle: PedestalAngle,
    /// Whether the hand can reach the commanded opening and force.
    pub opening: PedestalOpening,
}

/// The orders of the command, for [`ordered::ORDERED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Subordinates {
    /// The command.
    pub verb: PedestalVerb,
    /// The processes that have its orders.
    pub ordered: PedestalRecipient,
    /// Status of the hand.
    pub hand: Lower,
    /// Status of the table.
    pub table: Lower,
    /// The object in the hand.
    pub object: Object,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The object in the hand.
    pub object: Object,
    /// Whether its sensors are calibrated.
    pub calibration: PedestalCalibration,
    /// Whether it was commanded to grip.
    pub gripped: Gripped,
    /// Result of its last command, for any command of the pedestal.
    pub fingers: Work,
}

#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    pub arrival: Arrival,
    pub verb: PedestalVerb,
    /// The variables of HALT.
    pub replaced: Replaced,
    pub request: Request,
    /// The orders of the command.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the statuses of hand and table.
    pub proof: Proof,
    pub situation: Situation,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Send nothing new.
    Wait,
    /// UP-INIT to the hand.
    Calibrate,
    /// OPEN-GRIP to the hand, TURN to the table.
    OpenAndTurn,
    /// CLOSE-GRIP to the hand.
    Close,
    /// TURN to the table.
    Turn,
    /// OPEN-GRIP to the hand.
    Open,
    /// PAUSE to the table.
    StopTable,
    /// Report done.
    Finish,
    /// Report an error: the hand holds no object.
    Lose(Reason),
    /// Report an error.
    Fail(Reason),
    /// Report an error with the hand's reason.
    PassUpHand,
    /// Report an error with the table's reason.
    PassUpTable,
}

impl Ending for Action {
    const WAIT: Self = Self::Wait;

    fn fail(reason: Reason) -> Self {
        Self::Fail(reason)
    }

    fn ends(&self) -> bool {
        matches!(self, Self::Finish)
    }
}

impl Stopping for Action {
    const STOP: Self = Self::StopTable;
}

commands! {
    pub fn of_command(PedestalVerb, enum Step, Situation) -> Action {
        others: EXECUTE, accept::ACCEPT, HALT, ordered::ORDERED, CONFIRM;
        before: EXECUTE, HALT, ACCEPT(request), ORDERED(subordinates);
        after: CONFIRM;
        None | Pause: goals::REST   => pause::pause;
        PreGrip: goals::READY       => pre_grip::pre_grip;
        Grip: goals::HELD           => grip::grip;
        Flip: goals::TURNED         => flip::flip;
        Release: goals::RELEASED    => release::release;
    }
}
