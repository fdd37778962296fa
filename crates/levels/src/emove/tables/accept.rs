//! Preconditions of a command before anything moves.

use rcs_core::{Plain, Variables, decision_table};

use super::Knowledge;
use crate::execution::Asked;

/// The class of a command, by its preconditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum CommandClass {
    /// No command.
    None,
    /// E-PAUSE.
    Pause,
    /// A motion that needs no object: MOV-TO-LOC, WITHDRAW.
    Plain,
    /// A motion to an object or with one: MOV-TO-OBJ, MOV-OBJ-TO, MOV-TO-VU.
    ObjectMove,
    /// A motion to a holster: MOV-TO-HOL.
    HolsterMove,
    /// A gripper exchange: QC-ATTACH, QC-DETACH.
    Exchange,
    /// Work at an object: LOCATE-OBJ, GRASP-OBJ.
    AtObject,
    /// A tool command: INSERT-TOOL, RELEASE-TOOL, ACQUIRE-TOOL, REMOVE-TOOL.
    Tool,
    /// RELEASE.
    Release,
}

/// The gripper on the robot, for a command that needs one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Attached {
    /// The one that the command names, or any if it names none.
    Right,
    /// Another one.
    Wrong,
    /// None: the robot is bare.
    None,
}

/// The connection of the gripper to the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Coupling {
    /// No gripper is mated.
    Bare,
    /// The gripper is mated, and the ring is locked.
    Locked,
    /// The gripper is mated, and the ring is not locked.
    Loose,
    /// The ring stayed locked after a gripper was mated, but the id pins no longer report it.
    Misread,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ExchangeWork {
    /// No exchange is under way.
    None,
    /// The robot is in a holster, between the first and the last point of an exchange.
    HalfDone,
}

/// The tool command at the drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ToolWork {
    /// No tool command is under way.
    None,
    /// The robot is at the tool drum, between the first and the last point of a tool command.
    HalfDone,
}

/// The location of a motion command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveTarget {
    /// No holster, or the command is the one that moves to a holster.
    Plain,
    /// A holster, as a plain location.
    Holster,
}

/// A new command and the state of the robot, for [`ACCEPT`].
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Request {
    /// The decision on a new command is due.
    pub asked: Asked,
    /// The class of the command.
    pub class: CommandClass,
    /// The gripper on the robot.
    pub gripper: Attached,
    /// Knowledge of the robot's place. An unfinished tool command is sufficient.
    pub start: Knowledge,
    /// The connection of the gripper.
    pub coupling: Coupling,
    /// The gripper exchange.
    pub exchange: ExchangeWork,
    /// The tool command at the drum.
    pub drum: ToolWork,
    /// The location of the command.
    pub target: EmoveTarget,
}

decision_table! {
    /// ACCEPT: states of the robot in which a new command is refused. No order has been sent, since HALT has stopped
    /// the robot. A robot in a gripper exchange, in a tool command at the drum, or with a gripper that is not locked
    /// cannot move elsewhere. A robot with failed id pins moves only to a plain location. E-PAUSE and RELEASE have no
    /// preconditions. RECORDS decides next.
    pub ACCEPT: fn accept(self::Request) -> super::Action or () {
        1:  asked: Before                                                       => consult;
        2:  class: None                                                         => Refuse(UnknownCommand);
        3:  class: ObjectMove | HolsterMove | Exchange | AtObject | Tool, coupling: Misread
                                                                                => Refuse(PinsFail);
        4:  class: HolsterMove, gripper: Wrong                                  => Refuse(WrongGripper);
        5:  class: ObjectMove | AtObject | Tool, gripper: Wrong | None          => Refuse(WrongGripper);
        6:  class: Plain | ObjectMove | HolsterMove | AtObject | Tool, exchange: HalfDone
                                                                                => Refuse(InHolster);
        7:  class: Plain | ObjectMove | HolsterMove | Exchange, drum: HalfDone  => Refuse(InDrum);
        8:  class: Plain | ObjectMove | HolsterMove | AtObject | Tool, coupling: Loose
                                                                                => Refuse(RingNotLocked);
        9:  target: Holster                                                     => Refuse(HolsterOnly);
        10: class: Tool, start: Unknown                                         => Refuse(UnknownStart);
        11: target: Plain                                                       => consult;
    }
}
