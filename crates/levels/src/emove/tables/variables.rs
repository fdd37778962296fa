//! Values of the state variables.

use rcs_core::Plain;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Knowledge {
    /// The fact is known.
    Known,
    /// The fact is not known.
    Unknown,
}

pub(in crate::emove) const fn known(known: bool) -> Knowledge {
    if known { Knowledge::Known } else { Knowledge::Unknown }
}

/// `.R` at the terminal of board 2 (IV.3.3 step 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Initialization {
    /// The operator did not enter it, it is done, or it waits until the pause is done.
    None,
    /// The operator entered it: Prim must initialize the link.
    Asked,
    /// Prim has initialized the link, or has failed to.
    Over,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pause {
    /// The command is another one.
    Other,
    /// The processes below do not pause yet.
    UnderWay,
    /// The processes below pause.
    Standing,
}

/// The process that has the last order of the current command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveRecipient {
    /// None: no order yet.
    Nothing,
    /// Prim. No row waits here for fingers that open on the way.
    Prim,
    /// Prim, with a GO-UNTIL that may end without contact.
    GoUntil,
    /// Prim, with the GO-WHILE up to the fingers of the drum.
    Nearing,
    /// The attached gripper.
    Gripper,
    /// The attached gripper, in a holster where Prim holds the robot.
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
    /// The condition has not occurred.
    Awaited,
    /// The condition has ended a GO-WHILE.
    Met,
    /// The robot is at rest at the goal, and the condition has not occurred within a second.
    Missed,
}

/// The opening of the fingers for the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOpening {
    /// No opening is needed, or a release must end first.
    Free,
    /// The fingers are at rest at the opening without an order.
    Reached,
    /// The opening is not ordered yet.
    Due,
    /// The opening is ordered.
    Sent,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Departure {
    /// The robot is at a known place, and no depart point is left.
    AtPlace,
    /// The robot is off its path, on the path back, or before the last depart point: the fingers must not move.
    UnderWay,
    /// The robot has left the place.
    Over,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ReleaseWork {
    /// No release is under way.
    None,
    /// A release that began at the robot's place has not ended.
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

/// The held object, compared with that at the start of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLoad {
    /// The object is still held, or none was held.
    Kept,
    /// The object is no longer between the fingers.
    Lost,
    /// The gripper is gone, with the object.
    GripperGone,
    /// The ring is locked, but the id pins report no gripper.
    PinsFail,
}

/// The contents of closed fingers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Fingers {
    /// Nothing, or nothing of the object's size. Also if a held object is partly released: its release has not ended,
    /// or fingers at rest neither detect nor press it.
    Empty,
    /// An object.
    Gripping,
}

/// The opening of the fingers, compared with the one after a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Spread {
    /// The fingers are less open.
    Narrow,
    /// The fingers are as wide open, or the robot has none.
    Open,
    /// The gripper is not calibrated.
    Unknown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveLink {
    /// Prim does not command the robot.
    Down,
    /// Prim commands the robot.
    Up,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FingerMotion {
    /// The fingers have executed their last order, or it required no motion.
    AtRest,
    /// The fingers are moving.
    Moving,
}

/// Quick change and gripper after the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tooling {
    /// Not read or not calibrated yet.
    Busy,
    /// Read, and calibrated if required. The ring may be between its ends.
    Ready,
    /// Quick Change reports an error.
    RingFaulty,
    /// The gripper reports an error.
    GripFaulty,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum PlaceKnowledge {
    /// The robot is at a known location.
    Known,
    /// The search has not checked all location points.
    Searching,
    /// The robot is at no known location.
    Unknown,
}

/// The robot's place, relative to the location of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum At {
    /// Elsewhere, or at no known location.
    Elsewhere,
    /// At TOOL-SAFE, the location near the tool drum (V.4.1 INSERT-TOOL).
    Before,
    /// At the location.
    There,
    /// At the location, with the fingers around a tool in the drum.
    InDrum,
}

/// The gripper mated with the quick change, compared with that of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Mate {
    /// No gripper.
    None,
    /// The gripper of the command.
    Right,
    /// Another gripper.
    Wrong,
}

/// The locking ring, by the answer of Quick Change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Ring {
    /// The ring turns, or Quick Change has not answered yet.
    Busy,
    /// The ring is locked.
    Locked,
    /// The ring is unlocked.
    Unlocked,
    /// The ring is stuck, its sensors fail, or Quick Change does not answer.
    Faulty,
}

/// The locking ring, by its two sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Lock {
    /// Locked.
    Locked,
    /// Unlocked.
    Unlocked,
    /// Between both ends.
    Between,
    /// Both sensors respond, or Quick Change does not answer.
    Faulty,
}

/// The robot's position in the exchange of the command, by the resolvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ExchangePosition {
    /// Not in the exchange.
    Off,
    /// Above the gripper, clear of the holster: the start of a bare robot.
    Above,
    /// Between that point and the point close to the gripper.
    Out,
    /// Close to the gripper, or between that point and the seat.
    Coming,
    /// On the gripper at its seat.
    Seat,
    /// Between the seat and the low point.
    Sliding,
    /// At the low point: the gripper is before its seat, deep in the holster.
    Low,
    /// A distance out of the holster.
    Lifting,
    /// Between that point and the upper point.
    Raising,
    /// At the upper point, clear of the holster with a gripper.
    Clear,
}

/// The fingers, compared with the opening for the path through the holster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Shut {
    /// The fingers are at that opening.
    Shut,
    /// The fingers are at another opening, or it is unknown.
    Open,
    /// The gripper is not calibrated, so that the fingers cannot move to that opening.
    Raw,
}

/// Reading of the four sensors of the command's holster (V.1.2 hol-R-status …).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveHolster {
    /// No sensor responds.
    Empty,
    /// Some sensors respond: no gripper is at its seat.
    Partial,
    /// All four sensors detect the ears of a gripper at its seat.
    Full,
}

/// The attached gripper after an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Readiness {
    /// The gripper has executed the order.
    Ready,
    /// The gripper has executed the order, and must be calibrated: the parts gripper, attached for the first time
    /// (VI.3.1 UP-INIT).
    Uncalibrated,
    /// The gripper has not executed the order.
    Faulty,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum VisionAnswer {
    /// No answer yet.
    Waiting,
    /// Vision has answered.
    Answered,
    /// Vision has not answered for four seconds.
    Silent,
}

/// The content of the answer from vision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sight {
    /// Vision sees the object.
    Seen,
    /// Vision sees nothing.
    Missing,
    /// Vision sees another object.
    Unrecognised,
    /// The answer is impossible, or the robot is not at its commanded place.
    Implausible,
}

/// The open fingers at the object found by vision, relative to its array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveReach {
    /// Within the array of the object's sector, or at a place without sectors.
    Inside,
    /// Beyond the edge of the array.
    Outside,
}

/// The attempts left for a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Tries {
    /// Another picture with other parameters is allowed.
    Left,
    /// No other picture is allowed.
    Spent,
}
