//! Result of the last order of a command.

use rcs_core::decision_table;

decision_table! {
    /// ORDERED: the process with the last order is busy with it, or has done it. A failure ends the command;
    /// so does a failure of Prim while the ring turns or the fingers move in a holster, and one of fingers
    /// that open on the way.
    pub ORDERED: fn ordered(super::Orders) -> super::Action or crate::execution::Work {
        1:  ordered: Nothing | All                                                 => consult(Over);
        2:  opening: Failed                                                        => FailGrip;
        3:  ordered: Prim | GoUntil, prim: Error | Joystick | Lost                 => PassUp;
        4:  ordered: QuickChange | GripperInHolster, prim: Error | Joystick | Lost => PassUp;
        5:  ordered: GoUntil, prim: Pending | Executing, contact: Missed           => Fail(NotDetected);
        6:  ordered: Prim | GoUntil, prim: Pending | Executing                     => consult(Busy);
        7:  ordered: Prim | GoUntil, prim: Done                                    => consult(Over);
        8:  ordered: QuickChange, ring: Busy                                       => consult(Busy);
        9:  ordered: QuickChange, ring: Locked | Unlocked                          => consult(Over);
        10: ordered: QuickChange, ring: Faulty                                     => FailRing;
        11: ordered: Gripper | GripperInHolster, gripper: Pending | Executing      => consult(Busy);
        12: ordered: Gripper | GripperInHolster, gripper: Done                     => consult(Over);
        13: ordered: Gripper | GripperInHolster, gripper: Error | Joystick | Lost  => FailGrip;
        14: ordered: Vision, vision: Waiting                                       => consult(Busy);
        15: ordered: Vision, vision: Answered                                      => consult(Over);
        16: ordered: Vision, vision: Silent                                        => Fail(VisionSilent);
    }
}
