//! The values of the state variables of Subtask.

use rcs_core::Plain;

/// With which grip the object of the command is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripHeld {
    /// The grip for the source location.
    Source,
    /// The grip for the destination location, which may be the same.
    Destination,
    /// Neither of the two, or the object is not held.
    Neither,
}

/// Must the object be found by vision (VII.7.6, en)?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskVision {
    /// Its location is known well enough.
    #[text = "not needed"]
    NotNeeded,
    /// It must be found.
    Needed,
    /// It has been found, and nothing has moved it since.
    Done,
}

/// Is there something where the command wants it?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Where {
    /// At the location of the command, in its grip.
    There,
    /// Elsewhere, or nowhere.
    Elsewhere,
}

/// An exchange of grippers that is half done: the robot stands in a holster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskExchange {
    /// None: the robot is clear of the holsters.
    None,
    /// In the holster of the wanted gripper.
    Wanted,
    /// In that of another one.
    Other,
}

/// End effector state (V.3.1): right, wrong, none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskGripper {
    /// No gripper is attached.
    None,
    /// The gripper for the object is attached.
    Right,
    /// Another one is attached.
    Wrong,
}

/// What a position is named by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Named {
    /// The location alone.
    Location,
    /// An object, real or virtual, at the location.
    Object,
}

/// Pedestal status (V.3.1): what the Active Pedestal makes of the last command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskPedestal {
    /// Hand or table are moving, or the command is not echoed yet.
    Moving,
    /// The command is done.
    Done,
    /// It cannot be executed.
    #[text = "can't-do"]
    Cannot,
    /// An error prevents it from finishing.
    #[text = "error"]
    Faulty,
    /// The pedestal does not answer.
    Silent,
}

/// The robot and the tool drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskDrum {
    /// The fingers are around a tool in the drum.
    Inside,
    /// The robot stands at a place outside.
    Outside,
    /// It stands at no place: it may be on its way into the drum or out of it.
    Unplaced,
}

/// Who has the part that is regripped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskPart {
    /// The robot.
    Robot,
    /// Robot and pedestal.
    Both,
    /// The pedestal, and something is between the robot's fingers, which may be the part, or they do not tell.
    Touched,
    /// The pedestal.
    Hand,
    /// Neither of them.
    Neither,
    /// The pedestal has another object.
    Other,
    /// The pedestal has nothing, and the robot something unknown.
    Unknown,
    /// The robot's gripper does not tell, and the pedestal does not have the object.
    NotKnown,
    /// The pedestal's hand does not tell.
    Unsure,
}

/// Where the rotary table stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Turn {
    /// At the angle in which it receives the object.
    Receive,
    /// At the angle to which it turns the object.
    Turned,
    /// Between, or beyond them.
    Between,
    /// At no known angle.
    Unknown,
}

/// The hand of the pedestal, by its opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HandOpening {
    /// As wide as the object needs it to come in.
    Open,
    /// Narrower.
    Narrow,
}

/// Where the robot is, for FIX-GRIP.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskRobot {
    /// At the pedestal, for the source grip.
    First,
    /// At the pedestal, for the destination grip.
    Third,
    /// At PED-SAFE.
    Safe,
    /// Elsewhere, or on a way.
    Away,
}

/// May the robot leave while the pedestal holds a part?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Leaving {
    /// It holds something, or is not clear of the pedestal.
    Bound,
    /// It holds nothing and is clear.
    Empty,
}

/// How far the table turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Flip {
    /// By the whole flip angle of the object.
    Whole,
    /// By what is left of it.
    Rest,
}

/// The part in the pedestal's hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalLoad {
    /// There is none.
    Free,
    /// It is there, alone or together with the robot.
    HoldsPart,
    /// The hand has gripped and does not tell.
    Unsure,
}

/// Which holster is moved to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskHolster {
    /// That of the attached gripper.
    Own,
    /// That of the wanted gripper.
    Wanted,
}

/// The PED-PARA record of the object (VII.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalData {
    /// There is none, or it is not needed.
    Missing,
    /// It is there.
    Found,
}

/// The process that has the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskRecipient {
    /// Nothing was ordered yet.
    Nothing,
    /// E-move.
    Emove,
    /// The Active Pedestal.
    Pedestal,
    /// Both: they are pausing.
    Both,
}
