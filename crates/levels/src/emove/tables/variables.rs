//! Values of the state variables.

use rcs_core::Plain;

/// Is it known?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Knowledge {
    /// It is.
    Known,
    /// It is not.
    Unknown,
}

pub(in crate::emove) const fn known(known: bool) -> Knowledge {
    if known { Knowledge::Known } else { Knowledge::Unknown }
}

/// `.R` at the terminal of board 2 (IV.3.3 step 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Initialization {
    /// It was not entered, was entered and done, or waits until the pause stands.
    None,
    /// It was entered: Prim is to initialize the link.
    Asked,
    /// Prim has initialized the link, or has failed to.
    Over,
}

/// Is the command E-PAUSE?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pause {
    /// It is another one.
    Other,
    /// The processes below do not pause yet.
    UnderWay,
    /// They do.
    Standing,
}

/// The process that has the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveRecipient {
    /// Nothing was ordered yet.
    Nothing,
    /// Prim. Fingers that open on the way are not waited for here.
    Prim,
    /// Prim, with a GO-UNTIL that may end without contact.
    GoUntil,
    /// Prim, with the GO-WHILE up to the fingers of the drum.
    Nearing,
    /// The attached gripper.
    Gripper,
    /// The attached gripper, in a holster: Prim holds the robot there.
    GripperInHolster,
    /// Quick Change. If the command has moved the robot, Prim holds it.
    QuickChange,
    /// Vision.
    Vision,
    /// All, with a pause: E-PAUSE waits for each of them itself.
    All,
}

/// The condition of a guarded move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveContact {
    /// It has not come.
    Awaited,
    /// It has ended a GO-WHILE.
    Met,
    /// The robot stands at the goal, and the condition has not come for a second.
    Missed,
}

/// The opening of the fingers for the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOpening {
    /// None is needed, or a release must end first.
    Free,
    /// The fingers are at rest at it, and it was not ordered.
    Reached,
    /// It is not ordered yet.
    Due,
    /// It is ordered.
    Sent,
}

/// The departure of the robot from the place that it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Departure {
    /// It is at a known place, and no depart point lies ahead.
    AtPlace,
    /// It is off its path, on the path back, or before the last depart point: the fingers must not move.
    UnderWay,
    /// The robot has left the place.
    Over,
}

/// The release of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ReleaseWork {
    /// No release is under way.
    None,
    /// A release that was begun where the robot stands has not ended.
    UnderWay,
}

/// The calibration of the attached gripper (VI.3.1 UP-INIT).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveCalibration {
    /// The gripper is calibrated, or needs no calibration.
    Done,
    /// The gripper must be calibrated first.
    Missing,
}

/// What was held when the command came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLoad {
    /// It is held still, or nothing was.
    Kept,
    /// It is no longer between the fingers.
    Lost,
    /// The gripper has gone, and it with the gripper.
    GripperGone,
    /// The ring is locked, and the id pins say that the gripper has gone.
    PinsFail,
}

/// What closed fingers have between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Fingers {
    /// Nothing, or nothing of the object's size. So it is if something counts as held and has been half let
    /// go: a release of it has not ended, or the fingers rest and do not feel or press it.
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
    /// The gripper is not calibrated.
    Unknown,
}

/// The DEPC link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLink {
    /// Prim does not command the robot.
    Down,
    /// It does.
    Up,
}

/// Do the fingers do what they were told last?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FingerMotion {
    /// They have done it, or were told nothing that moves them.
    AtRest,
    /// They move.
    Moving,
}

/// Quick change and gripper after the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tooling {
    /// Not read or not calibrated yet.
    Busy,
    /// Read, and calibrated if it must be. The ring may stand half-way.
    Ready,
    /// The quick change reports an error.
    RingFaulty,
    /// The gripper reports an error.
    GripFaulty,
}

/// Is it known where the robot is?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PlaceKnowledge {
    /// It is at a known location.
    Known,
    /// Not all location points have been looked at yet.
    Searching,
    /// It is at none of them.
    Unknown,
}

/// Where the robot is, seen from the location of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum At {
    /// Elsewhere, or at no known location.
    Elsewhere,
    /// At TOOL-SAFE, the location near the tool drum (V.4.1 INSERT-TOOL).
    Before,
    /// There.
    There,
    /// There, with the fingers around a tool in the drum.
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
    /// It turns, or Quick Change has not answered yet.
    Busy,
    /// It is locked.
    Locked,
    /// It is unlocked.
    Unlocked,
    /// It is stuck, its sensors fail, or Quick Change does not answer.
    Faulty,
}

/// Where its two sensors see the locking ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Lock {
    /// Locked.
    Locked,
    /// Unlocked.
    Unlocked,
    /// In between.
    Between,
    /// Both see it, or Quick Change does not answer.
    Faulty,
}

/// Where the robot is in the exchange that the command asks for, by the resolvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ExchangePosition {
    /// Nowhere on it.
    Off,
    /// Above the gripper, clear of the holster: where a bare robot comes from.
    Above,
    /// Between there and the point close to the gripper.
    Out,
    /// Close to the gripper, or between there and the seat.
    Coming,
    /// On the gripper at its seat.
    Seat,
    /// Between the seat and the low point.
    Sliding,
    /// At the low point: the gripper is before its seat, deep in the holster.
    Low,
    /// A distance out of the holster.
    Lifting,
    /// Between there and the upper point.
    Raising,
    /// At the upper point, clear of the holster with a gripper.
    Clear,
}

/// The fingers, for the way through the holster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Shut {
    /// They are at the opening for it.
    Shut,
    /// They are not, or it is not known.
    Open,
    /// They cannot be brought there: the gripper is not calibrated.
    Raw,
}

/// What the four sensors of the command's holster see (V.1.2 hol-R-status …).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveHolster {
    /// Nothing.
    Empty,
    /// Something, but no gripper at its seat.
    Partial,
    /// A gripper at its seat: all four see its ears.
    Full,
}

/// The attached gripper after an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Readiness {
    /// It has done what was ordered.
    Ready,
    /// It has, and must be calibrated: the parts gripper, attached for the first time (VI.3.1 UP-INIT).
    Uncalibrated,
    /// It has not.
    Faulty,
}

/// Has vision answered the last request?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum VisionAnswer {
    /// Not yet.
    Waiting,
    /// It has.
    Answered,
    /// It has not for four seconds.
    Silent,
}

/// What vision has answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sight {
    /// It sees the object.
    Seen,
    /// It sees nothing.
    Missing,
    /// It sees something else.
    Unrecognised,
    /// It says what cannot be, or the robot is not where it was sent.
    Implausible,
}

/// Where the open fingers would be at the object that vision has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveReach {
    /// Within the array of the object's sector, or at a place that is no sector.
    Inside,
    /// Beyond the edge of the array.
    Outside,
}

/// May a picture be taken again?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tries {
    /// Yes, with other parameters.
    Left,
    /// No.
    Spent,
}
