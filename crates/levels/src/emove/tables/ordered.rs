//! Result of the last order of a command.

use rcs_core::decision_table;

decision_table! {
    /// ORDERED: the process with the last order executes it, or has done it. A failure ends the command, including a
    /// failure of Prim while the ring turns or the fingers move in a holster, and a failure of fingers that open
    /// during a motion. Contact of the held tool before the fingers of the drum means that the drum is occupied.
    pub ORDERED: fn ordered(super::Subordinates) -> super::Action or crate::execution::Work {
        1:  ordered: Nothing | All                                                  => consult(Over);
        2:  opening: Sent, gripper: Error | Joystick | Lost                         => FailGrip;
        3:  ordered: Nearing, prim: Error, contact: Met                             => Fail(DrumOccupied);
        4:  ordered: Prim | GoUntil | Nearing, prim: Error | Joystick | Lost        => PassUp;
        5:  ordered: QuickChange | GripperInHolster, prim: Error | Joystick | Lost  => PassUp;
        6:  ordered: GoUntil, prim: Pending | Executing, contact: Missed            => Fail(NotDetected);
        7:  ordered: Prim | GoUntil | Nearing, prim: Pending | Executing            => consult(Busy);
        8:  ordered: Prim | GoUntil | Nearing, prim: Done                           => consult(Over);
        9:  ordered: QuickChange, ring: Busy                                        => consult(Busy);
        10: ordered: QuickChange, ring: Locked | Unlocked                           => consult(Over);
        11: ordered: QuickChange, ring: Faulty                                      => FailRing;
        12: ordered: Gripper | GripperInHolster, gripper: Pending | Executing       => consult(Busy);
        13: ordered: Gripper | GripperInHolster, gripper: Done                      => consult(Over);
        14: ordered: Gripper | GripperInHolster, gripper: Error | Joystick | Lost   => FailGrip;
        15: ordered: Vision, vision: Waiting                                        => consult(Busy);
        16: ordered: Vision, vision: Answered                                       => consult(Over);
        17: ordered: Vision, vision: Silent                                         => Fail(VisionSilent);
    }
}
