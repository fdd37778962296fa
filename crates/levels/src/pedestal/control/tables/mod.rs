//! Decision tables of the pedestal process: what a new command needs, what has become of its orders, and a
//! file a command.

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

/// Can the table turn as a command asks?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalAngle {
    /// Yes, or it is not to turn.
    Within,
    /// The angle is beyond the limits.
    Beyond,
    /// The angle of the table is not known: a relative angle leads nowhere.
    Unknown,
}

/// Can the hand do what a command asks?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalOpening {
    /// Yes, or it is not to move.
    Within,
    /// Opening or force are beyond its range.
    Beyond,
}

/// The processes that have the orders of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalRecipient {
    /// Nothing was ordered yet.
    Nothing,
    /// The hand.
    Hand,
    /// The table.
    Table,
    /// Both.
    Both,
}

/// What the hand feels (VI.7.2 `grip-size`, `grip-force`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Object {
    /// Its sensors cannot tell, or it does not answer.
    NotKnown,
    /// Nothing, and nothing was gripped.
    None,
    /// The object between its fingers.
    Held,
    /// Nothing, or fingers that stand no wider than the grasp size, though an object was gripped.
    Lost,
}

/// Are the sensors of the hand calibrated?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalCalibration {
    /// Yes.
    Known,
    /// No.
    Missing,
}

/// Was the hand told to grip, and not to open since?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Gripped {
    /// No: it holds nothing that it was to hold.
    No,
    /// Yes: it may hold the object.
    Yes,
}

/// What a new command needs, for [`accept::ACCEPT`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// Is the command new?
    pub asked: Asked,
    /// The command.
    pub verb: PedestalVerb,
    /// Can the table turn as it asks?
    pub angle: PedestalAngle,
    /// Can the hand do what it asks?
    pub opening: PedestalOpening,
}

/// How the orders of the command stand, for [`ordered::ORDERED`].
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
    /// What the hand holds.
    pub object: Object,
}

/// The state variables of a tick, for the tables of the commands.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// What the hand holds.
    pub object: Object,
    /// Are its sensors calibrated?
    pub calibration: PedestalCalibration,
    /// Was it told to grip?
    pub gripped: Gripped,
    /// What has become of its last command, whichever command of the pedestal that was for.
    pub fingers: Work,
}

/// What preprocess has found in a tick.
#[derive(Clone, Copy, Debug)]
pub struct StateVariables {
    /// What the command buffer holds.
    pub arrival: Arrival,
    /// The current command.
    pub verb: PedestalVerb,
    /// What a new command replaces.
    pub replaced: Replaced,
    /// What a new command needs.
    pub request: Request,
    /// How the orders of the command stand.
    pub subordinates: Subordinates,
    /// The goal of the command, compared with the statuses of hand and table.
    pub proof: Proof,
    /// The state variables of the command's table.
    pub situation: Situation,
}

/// What a row can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new.
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
    /// Report an error: the hand holds nothing.
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
    /// Consult the table of a command.
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
