use interfaces::pedestal::PedestalVerb;
use rcs_core::{Actions, Plain, Variables, decision_table};

use super::{PedestalData, PedestalLoad, SubtaskPedestal};

/// Use of the pedestal by Subtask.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Regripping {
    /// Subtask does not use the pedestal.
    No,
    /// A FIX-GRIP is executing, or a command has arrived that may be one.
    Yes,
}

/// The robot relative to the pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum RobotAtPedestal {
    /// The robot is clear of the pedestal.
    Clear,
    /// The robot is at the pedestal, or not known to be clear, and does not hold the part.
    Near,
    /// The robot is at the pedestal and holds the part.
    Grips,
}

/// The person's statement about the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HeldByHand {
    /// The person has not confirmed that they hold the part.
    No,
    /// The person has confirmed that they hold the part.
    Yes,
}

/// A manual order, for [`BY_HAND`].
#[derive(Clone, Copy, Debug, Variables)]
pub struct ManualOrder {
    /// The command.
    pub order: PedestalVerb,
    /// Use of the pedestal by Subtask.
    pub regripping: Regripping,
    /// The result of the last command to the pedestal.
    pub pedestal: SubtaskPedestal,
    /// The PED-PARA record of the object that the order names.
    pub data: PedestalData,
    /// The part in the pedestal's hand.
    pub part: PedestalLoad,
    /// The robot relative to the pedestal.
    pub robot: RobotAtPedestal,
    /// The person's statement about the part.
    pub by_hand: HeldByHand,
}

/// Why an order is not sent to the pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(doc)]
pub enum Refused {
    /// Subtask regrips an object with the pedestal; PAUSE stops it.
    Regripping,
    /// The pedestal executes a command; `pedestal pause` stops the table.
    Moving,
    /// The pedestal does not answer.
    Silent,
    /// The task data do not say how the pedestal takes the object (PED-PARA, VII.7.4).
    NoData,
    /// The hand may hold a part, which PRE-GRIP would drop; RELEASE comes first.
    HoldsPart,
    /// The robot does not hold the part, which would fall; hold it and send `pedestal release by hand`.
    WouldFall,
    /// The robot is not clear of the pedestal; move it away first.
    RobotNear,
}

/// The response to a manual order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Manually {
    /// The order is sent to the pedestal.
    Send,
    /// The order is refused.
    Refuse(Refused),
}

decision_table! {
    /// BY-HAND: a person commands the Active Pedestal (an extension: IV.5 gives terminal 4 no such word). The order
    /// is sent only while Subtask does not use the pedestal. The hand opens on a part only if the robot or the person
    /// holds it. The table turns only if the robot is clear.
    pub BY_HAND: fn by_hand(ManualOrder) -> Manually or () {
        1:  order: None                                      => consult;
        2:  regripping: Yes                                  => Refuse(Regripping);
        3:  pedestal: Silent                                 => Refuse(Silent);
        4:  order: Pause                                     => Send;
        5:  pedestal: Moving                                 => Refuse(Moving);
        6:  order: PreGrip | Grip, data: Missing             => Refuse(NoData);
        7:  order: PreGrip,        part: HoldsPart | Unsure  => Refuse(HoldsPart);
        8:  order: PreGrip | Flip, robot: Near | Grips       => Refuse(RobotNear);
        9:  order: PreGrip | Grip | Flip                     => Send;
        10: order: Release,        part: Free                => Send;
        11: order: Release,        robot: Grips              => Send;
        12: order: Release,        by_hand: Yes              => Send;
        13: order: Release                                   => Refuse(WouldFall);
    }
}
