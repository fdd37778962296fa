//! Updates of the data base about an object (IV.4.2, IX.2; docs/design/recovery.md "Data base"): which moves are
//! reported, and where the robot has released an object. The tables are consulted while a command is looked up or
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
    /// The source of the command, or it is not taken yet.
    Source,
    /// Another place: an ACQUIRE finds it in the gripper.
    Elsewhere,
}

/// The command in the ledger, compared with a new one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum InLedger {
    /// It is another command.
    Other,
    /// It is the same, and has sent no update.
    Unreported,
    /// It is the same, and has sent its update.
    Reported,
}

/// Places of the MBD.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Area {
    /// The source or the destination is in the MBD, or the object was released there.
    Mbd,
    /// None of them is.
    Outside,
}

/// What the robot carried last, compared with an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Carrying {
    /// It is another object, or nothing.
    Other,
    /// It is the object. An update follows only if it is released in the MBD.
    Known,
    /// It is the object. An update follows wherever it is released.
    Followed,
}

/// Is an update sent?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Notice {
    /// An update is sent.
    Send,
    /// None is sent.
    Omit,
}

/// What a new command takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Takes {
    /// Nothing that it names.
    Nothing,
    /// An object.
    Object,
    /// A tool from the drum.
    Tool,
}

/// The object that Subtask reports as released last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Released {
    /// It is another object, or none.
    Other,
    /// It is the object of the command.
    Object,
}

/// What is noted of the object that a new command takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Taking {
    /// What the robot carries stays noted.
    Keep,
    /// An update follows wherever the carried object of that name is released.
    Follow,
    /// The carried object of that name is lost.
    Drop,
    /// The same, and the object is noted; it counts as carried as soon as it is held.
    Replace,
    /// The object is noted; it counts as carried as soon as it is held.
    Note,
}

/// Does the command in the ledger take the released object?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Taker {
    /// No.
    Other,
    /// It does: it takes the object again, or sends the update.
    Ledger,
}

/// The current or new command, compared with the one in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Continuation {
    /// It leaves the ledger as it is, or is the command in it.
    Same,
    /// It is new, and replaces the one in the ledger.
    Another,
    /// It is a POSITION, which takes nothing.
    Position,
}

/// What is done about a released object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Release {
    /// Nothing.
    Keep,
    /// An update with its place is appended to those that are not accepted yet.
    Append,
}

/// A new command, for [`UPDATE_DUE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Move {
    /// The command.
    pub verb: TaskVerb,
    /// Where its object was taken.
    pub origin: TaskOrigin,
    /// The command in the ledger.
    pub ledger: InLedger,
    /// What the gripper holds.
    pub held: Held,
    /// Has the command placed its object already?
    pub placed: Placed,
    /// Source and destination.
    pub area: Area,
    /// What the robot carried last.
    pub carrying: Carrying,
}

/// A new command, for [`FOLLOW`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct TaskFollowing {
    /// Is the Data System connected?
    pub connection: Connection,
    /// Where the object was taken.
    pub origin: TaskOrigin,
    /// The update of the command.
    pub due: Notice,
    /// What the robot carried last.
    pub carrying: Carrying,
}

/// The object of a new command, for [`TAKE`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Taken {
    /// What the command takes.
    pub takes: Takes,
    /// What the gripper holds.
    pub held: Held,
    /// What it has released last.
    pub released: Released,
    /// An update about the release, by [`FOLLOW`].
    pub notice: Notice,
}

/// The object that Subtask reports as released, for [`RELEASED`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct Place {
    /// What the robot carried last.
    pub carrying: Carrying,
    /// Where the object was released.
    pub area: Area,
    /// Is the Data System connected?
    pub connection: Connection,
    /// The command that takes it.
    pub taker: Taker,
    /// The command of this tick.
    pub command: Continuation,
}

decision_table! {
    /// UPDATE-DUE: does a new command send an update? It does for moves from and to the MBD, and as a TRANSFER of an
    /// object that the data base has in the robot (an extension: SPECNOTES.md). If the command has certainly lost its
    /// object, it takes it again and sends the update again.
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
    /// FOLLOW: does an update follow when the object of a new command is released, also if the command is never
    /// finished?
    pub FOLLOW: fn follow(self::TaskFollowing) -> self::Notice {
        1: connection: Closed | Opening | Interrupted  => Omit;
        2: origin: Elsewhere                           => Omit;
        3: due: Send                                   => Send;
        4: carrying: Followed                          => Send;
        5: otherwise                                   => Omit;
    }
}

decision_table! {
    /// TAKE: what a new command takes. What the gripper holds keeps its serial number. An object that is neither held
    /// nor released by the robot is lost: what the command takes under its name is another one. A tool is noted when
    /// the command has ended.
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
    /// RELEASED: the robot has released what it carried. The command in the ledger that takes the object takes it again,
    /// or sends the update itself.
    pub RELEASED: fn released(self::Place) -> self::Release {
        1: carrying: Other                                              => Keep;
        2: carrying: Known, area: Outside                               => Keep;
        3: carrying: Known, connection: Closed | Opening | Interrupted  => Keep;
        4: taker: Other                                                 => Append;
        5: command: Position | Another                                  => Append;
        6: command: Same                                                => Keep;
    }
}
