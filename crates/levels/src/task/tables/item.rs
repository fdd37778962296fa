//! Updates of the database about an object (IV.4.2, IX.2; docs/design/recovery.md "Database"): which moves are
//! reported, and where the robot has released an object. The tables are consulted when a command is looked up or
//! accepted, and in each tick in which Subtask reports a released object. No header names their rows.

use interfaces::data_base::Connection;
use rcs_core::{Actions, Plain, Variables, decision_table};

use crate::{
    held::Held,
    task::{ledger::Placed, plan::TaskVerb},
};

/// The place where the object of a command was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskOrigin {
    /// The source of the command, or the object is not taken yet.
    Source,
    /// Another place: an ACQUIRE finds it in the gripper.
    Elsewhere,
}

/// The command in the ledger, compared with a new one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum InLedger {
    /// Another command.
    Other,
    /// The same command, and its update is not sent.
    Unreported,
    /// The same command, and its update is sent.
    Reported,
}

/// The area of the source, the destination or the place of a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Area {
    /// The source or the destination is in the MBD, or the object was released there.
    Mbd,
    /// All of them are outside the MBD.
    Outside,
}

/// The object that the robot carried last, compared with an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Carrying {
    /// Another object, or none.
    Other,
    /// The object. An update follows only if it is released in the MBD.
    Known,
    /// The object. An update follows wherever it is released.
    Followed,
}

/// The update of a command or of a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Notice {
    /// An update is sent.
    Send,
    /// No update is sent.
    Omit,
}

/// The target of a new command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Takes {
    /// No object that it names.
    Nothing,
    /// An object.
    Object,
    /// A tool from the drum.
    Tool,
}

/// The object that Subtask reports as released last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Released {
    /// Another object, or none.
    Other,
    /// The object of the command.
    Object,
}

/// The record of the object that a new command takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Taking {
    /// The carried object does not change.
    Keep,
    /// An update follows wherever the carried object of that name is released.
    Follow,
    /// The carried object of that name is lost.
    Drop,
    /// The carried object of that name is lost. The new one is recorded and becomes the carried object when it is
    /// held.
    Replace,
    /// The object is recorded and becomes the carried object when it is held.
    Note,
}

/// The command that takes the released object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Taker {
    /// Not the one in the ledger.
    Other,
    /// The one in the ledger: it takes the object again, or sends the update.
    Ledger,
}

/// The current or new command, compared with the one in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Continuation {
    /// The command leaves the ledger unchanged, or is the command in it.
    Same,
    /// The command is new, and replaces the one in the ledger.
    Another,
    /// The command is a POSITION, which takes nothing.
    Position,
}

/// The update about a released object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Release {
    /// No update.
    Keep,
    /// An update with its place is appended to the pending ones.
    Append,
}

/// A new command, for [`UPDATE_DUE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Move {
    /// The command.
    pub verb: TaskVerb,
    /// The place where its object was taken.
    pub origin: TaskOrigin,
    /// The command in the ledger.
    pub ledger: InLedger,
    /// The content of the gripper.
    pub held: Held,
    /// The object of a repeated command, if it is placed already.
    pub placed: Placed,
    /// The area of source and destination.
    pub area: Area,
    /// The object that the robot carried last.
    pub carrying: Carrying,
}

/// A new command, for [`FOLLOW`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct TaskFollowing {
    /// The connection of the Data System.
    pub connection: Connection,
    /// The place where the object was taken.
    pub origin: TaskOrigin,
    /// The update of the command.
    pub due: Notice,
    /// The object that the robot carried last.
    pub carrying: Carrying,
}

/// The object of a new command, for [`TAKE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Taken {
    /// The target of the command.
    pub takes: Takes,
    /// The content of the gripper.
    pub held: Held,
    /// The object that the gripper released last.
    pub released: Released,
    /// An update about the release, by [`FOLLOW`].
    pub notice: Notice,
}

/// The object that Subtask reports as released, for [`RELEASED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Place {
    /// The object that the robot carried last.
    pub carrying: Carrying,
    /// Where the object was released.
    pub area: Area,
    /// The connection of the Data System.
    pub connection: Connection,
    /// The command that takes it.
    pub taker: Taker,
    /// The command of this tick.
    pub command: Continuation,
}

decision_table! {
    /// UPDATE-DUE: the update of a new command. One is due for a move from or to the MBD, and for a TRANSFER of an
    /// object that the database has as held by the robot (an extension: SPECNOTES.md). If the command has certainly
    /// lost its object, it takes it again and sends the update again.
    pub UPDATE_DUE: fn update_due(self::Move) -> self::Notice {
        1: origin: Elsewhere                                     => Omit;
        2: ledger: Reported, held: Right | Something | NotKnown  => Omit;
        3: ledger: Reported, placed: AtDestination | Left        => Omit;
        4: area: Mbd                                             => Send;
        5: verb: Transfer, carrying: Followed                    => Send;
        6: otherwise                                             => Omit;
    }
}

decision_table! {
    /// FOLLOW: the update that is due when the object of a new command is released, even if the command never
    /// finishes.
    pub FOLLOW: fn follow(self::TaskFollowing) -> self::Notice {
        1: connection: Closed | Opening | Interrupted  => Omit;
        2: origin: Elsewhere                           => Omit;
        3: due: Send                                   => Send;
        4: carrying: Followed                          => Send;
        5: otherwise                                   => Omit;
    }
}

decision_table! {
    /// TAKE: the object that a new command takes. A held object keeps its serial number. An object that is neither
    /// held nor released by the robot is lost; the command then takes another object with the same name. A tool is
    /// recorded when the command has ended.
    pub TAKE: fn take(self::Taken) -> self::Taking {
        1: takes: Nothing                                                       => Keep;
        2: held: Right, notice: Send                                            => Follow;
        3: held: Right                                                          => Keep;
        4: takes: Object, held: Nothing | Other, released: Other, notice: Send  => Replace;
        5: held: Nothing | Other, released: Other                               => Drop;
        6: takes: Object, notice: Send                                          => Note;
        7: otherwise                                                            => Keep;
    }
}

decision_table! {
    /// RELEASED: the robot has released the carried object. If the command in the ledger takes the object, it takes
    /// it again or sends the update itself.
    pub RELEASED: fn released(self::Place) -> self::Release {
        1: carrying: Other                                              => Keep;
        2: carrying: Known, area: Outside                               => Keep;
        3: carrying: Known, connection: Closed | Opening | Interrupted  => Keep;
        4: taker: Other                                                 => Append;
        5: command: Position | Another                                  => Append;
        6: command: Same                                                => Keep;
    }
}
