use rcs_core::Plain;

/// The grip of the commanded object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GripHeld {
    /// The grip for the source location.
    Source,
    /// The grip for the destination location, which may be the same.
    Destination,
    /// Neither of the two grips, or the object is not held.
    Neither,
}

/// The need to find the object by vision (VII.7.6, en).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskVision {
    /// The location of the object is known well enough.
    #[text = "not needed"]
    NotNeeded,
    /// The object must be found.
    Needed,
    /// The object was found, and nothing has moved it since.
    Done,
}

/// A place, compared with the location of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Where {
    /// At the location of the command, in its grip.
    There,
    /// Elsewhere, or nowhere.
    Elsewhere,
}

/// An interrupted exchange of grippers: the robot is in a holster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskExchange {
    /// None: the robot is clear of the holsters.
    None,
    /// In the holster of the wanted gripper.
    Wanted,
    /// In the holster of another gripper.
    Other,
}

/// End effector state (V.3.1): right, wrong, none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskGripper {
    /// No gripper is attached.
    None,
    /// The gripper for the object is attached.
    Right,
    /// Another gripper is attached.
    Wrong,
}

/// The kind of name of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Named {
    /// The location alone.
    Location,
    /// An object, real or virtual, at the location.
    Object,
}

/// Pedestal status (V.3.1): the result of the last command to the Active Pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskPedestal {
    /// Hand or table are moving, or the command is not echoed yet.
    Moving,
    /// The command is done.
    Done,
    /// The command cannot be executed.
    #[text = "can't-do"]
    Cannot,
    /// An error prevents it from finishing.
    #[text = "error"]
    Faulty,
    /// The pedestal does not answer.
    Silent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskDrum {
    /// The fingers are around a tool in the drum.
    Inside,
    /// The robot is at a place outside.
    Outside,
    /// The robot is at no known place; it may be moving into the drum or out of it.
    Unplaced,
}

/// The holder of the part during a regrip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskPart {
    /// The robot.
    Robot,
    /// Both robot and pedestal.
    Both,
    /// The pedestal. The robot's fingers may hold the part too: they hold something unknown, or give no result.
    Touched,
    /// The pedestal.
    Hand,
    /// Neither robot nor pedestal.
    Neither,
    /// The pedestal has another object.
    Other,
    /// The pedestal has nothing, and the robot has something unknown.
    Unknown,
    /// The robot's gripper gives no result, and the pedestal does not have the object.
    NotKnown,
    /// The pedestal's hand gives no result.
    Unsure,
}

/// The angle of the rotary table.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HandOpening {
    /// Wide enough for the object to enter.
    Open,
    /// Too narrow.
    Narrow,
}

/// The robot's place, for FIX-GRIP.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskRobot {
    /// At the pedestal, for the source grip.
    First,
    /// At the pedestal, for the destination grip.
    Third,
    /// At PED-SAFE.
    Safe,
    /// Elsewhere, or moving.
    Away,
}

/// Whether the robot may leave while the pedestal holds a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Leaving {
    /// The robot must stay: it holds something, or is not clear of the pedestal.
    Bound,
    /// The robot may leave: it holds nothing and is clear.
    Empty,
}

/// The angle by which the table turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Flip {
    /// By the whole flip angle of the object.
    Whole,
    /// By the remaining angle.
    Rest,
}

/// The part in the pedestal's hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalLoad {
    /// The hand has no part.
    Free,
    /// The hand has a part. The robot may hold it too.
    HoldsPart,
    /// The hand has gripped, and its sensors give no result.
    Unsure,
}

/// The holster to which the robot moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskHolster {
    /// The holster of the attached gripper.
    Own,
    /// The holster of the wanted gripper.
    Wanted,
}

/// The PED-PARA record of the object (VII.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PedestalData {
    /// Missing, or not needed.
    Missing,
    /// Found.
    Found,
}

/// The recipient of the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum SubtaskRecipient {
    /// No order was sent yet.
    Nothing,
    /// E-move.
    Emove,
    /// The Active Pedestal.
    Pedestal,
    /// Both, while they pause.
    Both,
}
