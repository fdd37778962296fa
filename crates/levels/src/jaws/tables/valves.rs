//! Air of the fingers, with and without a command. No header names the rows.

use interfaces::device::GroupHealth;
use rcs_core::{Actions, Plain, Variables, decision_table};

/// The gripper on the ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum AttachedGripper {
    /// The gripper may be that of this process: id pins without contact on a locked ring do not identify the gripper.
    Possible,
    /// The ring is not locked, or on another gripper.
    Gone,
}

/// Air to the fingers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Air {
    /// The valves stay as they are.
    Keep,
    /// Both sides are off.
    Off,
    /// To the side that closes.
    Close,
    /// To the side that opens.
    Open,
}

/// The side that has air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Side {
    /// The side that opens.
    Opening,
    /// The side that closes, or none.
    Other,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Supply {
    /// The gripper on the ring.
    pub mated: AttachedGripper,
    /// The connection with the gripper.
    pub connection: GroupHealth,
    /// The side that has air.
    pub side: Side,
    /// The air that the row of the command sets.
    pub set: Air,
}

decision_table! {
    /// VALVES: air stays on after the end of a command, because a part is held only while the fingers press.
    /// Without the gripper the air is off. An operator can release a tripped device only without the air that opens.
    pub VALVES: fn valves(self::Supply) -> self::Air {
        1: mated: Gone                                    => Off;
        2: set: Keep, connection: Tripped, side: Opening  => Off;
        3: set: Keep                                      => Keep;
        4: set: Off                                       => Off;
        5: set: Close                                     => Close;
        6: set: Open                                      => Open;
    }
}
