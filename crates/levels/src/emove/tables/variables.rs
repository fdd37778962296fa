//! The state variables that the tables look up, and the steps that the motion commands share.

use rcs_core::{Plain, handshake::Lower, interface::prim::JoystickGrip};

use crate::emove::route::Ahead;

/// Steps of a motion command: the reference action of all MOV-… commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Motion {
    /// Nothing commanded yet.
    Start,
    /// On the way through points.
    Moving,
    /// On the final motion.
    Stopping,
}

/// The opening of the fingers for the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Opening {
    /// As it should be, or it does not matter.
    Set,
    /// Not yet: the next point is a depart point.
    Departing,
    /// To be commanded now.
    Due,
    /// The fingers are moving.
    Moving,
    /// The gripper reports an error.
    Failed,
}

/// Is the object of the command held?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Held {
    /// The gripper holds nothing.
    Nothing,
    /// It holds the object of the command.
    Right,
    /// It holds another object.
    Other,
}

/// What was held when the command came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Load {
    /// It is held still, or nothing was.
    Kept,
    /// It is held no more.
    Lost,
}

/// What closed fingers have between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Fingers {
    /// Nothing, or nothing of the object's size.
    Empty,
    /// Something.
    Gripping,
}

/// Are the fingers as wide open as letting go of the object would leave them?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Spread {
    /// They are not.
    Narrow,
    /// They are, or there are none.
    Open,
}

/// The DEPC link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Link {
    /// Prim does not command the robot.
    Down,
    /// It does.
    Up,
}

/// Quick change and gripper after the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tooling {
    /// Not read or not calibrated yet.
    Busy,
    /// Read, and calibrated if it must be.
    Ready,
    /// The quick change reports an error.
    #[text = "ring faulty"]
    RingFaulty,
    /// The gripper reports an error.
    #[text = "grip faulty"]
    GripFaulty,
}

/// Is it known where the robot is?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Whereabouts {
    /// It is at a known location.
    Known,
    /// The location points are being looked through.
    Searching,
    /// It is at none of them.
    Unknown,
}

/// Where the robot is, seen from the location of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Station {
    /// Elsewhere, or nobody knows.
    Elsewhere,
    /// There.
    There,
    /// There, with the fingers around a tool in the drum.
    #[text = "in drum"]
    InDrum,
}

/// What is mated with the quick change, seen from the gripper of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Mate {
    /// Nothing.
    None,
    /// That gripper.
    Right,
    /// Another one.
    Wrong,
}

/// What Quick Change says of its locking ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ring {
    /// It turns, or has not answered yet.
    Busy,
    /// It is locked.
    Locked,
    /// It is unlocked.
    Unlocked,
    /// It is stuck, its sensors fail, or nobody answers.
    Faulty,
}

/// What the four sensors of the command's holster see (V.1.2 hol-R-status …).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Holster {
    /// Nothing.
    Empty,
    /// Something, but no gripper at its seat.
    Partial,
    /// A gripper at its seat: all four see its ears.
    Full,
}

/// How the last motion stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Travel {
    /// The robot is on its way, or Prim has not answered yet.
    #[text = "under way"]
    UnderWay,
    /// It stands at the goal of a GO-UNTIL, and the condition has not come for a second.
    Missed,
    /// It has come to its end.
    Over,
    /// It was given up.
    Failed,
}

/// The attached gripper after an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Readiness {
    /// It has not done what was ordered yet.
    Busy,
    /// It has.
    Ready,
    /// It has, and must be calibrated: the parts gripper, attached for the first time (VI.3.1 UP-INIT).
    Raw,
    /// It cannot.
    Faulty,
}

/// What vision says to the last request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sight {
    /// Nothing yet.
    Waiting,
    /// It sees the object.
    Seen,
    /// It sees nothing.
    Missing,
    /// It sees something else.
    Unrecognised,
    /// It says what cannot be.
    Implausible,
    /// It does not answer.
    Silent,
}

/// May a picture be taken again?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tries {
    /// Yes, with other parameters.
    Left,
    /// No.
    Spent,
}

/// The state variables of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// What lies ahead on the route.
    pub ahead: Ahead,
    /// Status of Prim; `Done` as long as the current command has sent it nothing.
    pub prim: Lower,
    /// The same, with a GO-UNTIL that is in vain.
    pub travel: Travel,
    /// Status of the attached gripper.
    pub gripper: Lower,
    /// The same, with its calibration.
    pub readiness: Readiness,
    /// The opening of the fingers.
    pub opening: Opening,
    /// Is the object held?
    pub held: Held,
    /// Is still held what was held?
    pub load: Load,
    /// What the fingers have between them.
    pub fingers: Fingers,
    /// Are they wide open?
    pub spread: Spread,
    /// A gripper button of the joystick box that has just been pressed.
    pub button: JoystickGrip,
    /// The link.
    pub link: Link,
    /// Quick change and gripper.
    pub tooling: Tooling,
    /// What is mated.
    pub mate: Mate,
    /// The locking ring.
    pub ring: Ring,
    /// The holster.
    pub holster: Holster,
    /// Is it known where the robot is?
    pub whereabouts: Whereabouts,
    /// Is it at the command's location?
    pub station: Station,
    /// What vision says.
    pub sight: Sight,
    /// May a picture be taken again?
    pub tries: Tries,
}
