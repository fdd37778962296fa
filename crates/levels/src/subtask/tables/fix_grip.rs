use rcs_core::{Plain, decision_table};

/// Steps of FIX-GRIP, named after the last order.
///
/// ```text
///   FIX-GRIP (robot has the part):     Start -> Preparing -> Bringing -> Gripping
///                                                                           |
///   AT-PEDESTAL (pedestal has it):     Flipping <- Clearing <- Releasing <--'
///                                         '-> Approaching -> Grasping -> LettingGo -> done
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FixGripStep {
    /// No order yet.
    Start,
    /// The pedestal opens its hand and turns its table to receive the object.
    Preparing,
    /// The pedestal closes its hand around the object.
    Gripping,
    /// The robot's fingers close on the object.
    Grasping,
    /// The robot moves the object to the pedestal.
    Bringing,
    /// The robot releases the object.
    Releasing,
    /// The robot moves away from the pedestal.
    Clearing,
    /// The robot moves back to the object.
    Approaching,
    /// The pedestal releases the object.
    LettingGo,
    /// The pedestal turns the object.
    Flipping,
}

decision_table! {
    /// AT-PEDESTAL: second part of FIX-GRIP (V.3.1), with the part in the pedestal's hand. The robot releases the
    /// part and moves to PED-SAFE, the table turns, the robot grasps it again, and the hand opens. The next action
    /// depends on the holder of the part, the table angle and the robot's place.
    pub AT_PEDESTAL: fn at_pedestal(self::FixGripStep, super::Situation) -> super::Action or () {
        any {
            1:  work: Busy                                          => Wait;
            2:  part: Robot | Neither | Other | Unknown | NotKnown | Unsure => consult;
        }
        Grasping {
            3:  part: Hand | Touched                                => Fail(GraspMissed);
        }
        any {
            4:  part: Both | Touched, robot: First, table: Receive  => ReleaseAtPed    -> Releasing;
            5:  part: Both, robot: Third, table: Turned             => PedRelease      -> LettingGo;
            6:  part: Hand | Touched, robot: Third, table: Turned   => GraspObjAtPed   -> Grasping;
            7:  part: Both | Touched                                => Fail(PartInPedestal);
            // Only the pedestal has the part.
            8:  robot: First | Third                                => MovToPedSafe    -> Clearing;
        }
        Flipping {
            9:  table: Receive | Between | Unknown                  => Fail(TableStuck);
        }
        any {
            10: table: Turned                                       => MovToObjAtPed   -> Approaching;
            11: robot: Away                                         => MovToPedSafe    -> Clearing;
            12: table: Receive                                      => PedFlip(Whole)  -> Flipping;
            13: table: Between                                      => PedFlip(Rest)   -> Flipping;
            14: table: Unknown                                      => Fail(TableAngleUnknown);
        }
    }
}

decision_table! {
    /// FIX-GRIP (V.3.1): regrip the object with the Active Pedestal. The command finishes at once if the object is
    /// already held in the new grip. The next action depends on the holder of the part, the table angle and the
    /// robot's place; the step only records the last order. During a pedestal fault the robot stays in place and
    /// keeps its grip. The hand opens only when it is empty and the robot is clear of it, or when the robot has the
    /// part in the new grip. This table brings the part to the pedestal. AT-PEDESTAL, which is consulted first, does
    /// the rest once the hand has the part.
    pub FIX_GRIP: fn fix_grip(self::FixGripStep, super::Situation) -> super::Action {
        any {
            1:  part: Other                                             => Fail(PedestalHoldsOther);
            2:  part: Unknown                                           => Fail(UnknownHeld);
            3:  part: NotKnown                                          => Fail(HeldNotKnown);
            4:  part: Unsure                                            => Fail(HandUncertain);
        }
        Start {
            5:  part: Neither                                           => Fail(NothingHeld);
        }
        any {
            6:  part: Neither                                           => Fail(ObjectLost);
            // The robot has the part.
            7:  grip: Destination                                       => Finish;
            8:  grip: Neither                                           => Fail(RegripNeeded);
        }
        Start {
            9:  robot: Safe | Away                                      => PedPreGrip    -> Preparing;
        }
        Preparing {
            10: table: Turned | Between | Unknown                       => Fail(TableStuck);
            11: hand: Narrow                                            => Fail(PedestalError);
        }
        Gripping {
            12: otherwise                                               => Fail(GraspMissed);
        }
        any {
            13: robot: First,               table: Receive, hand: Open  => PedGrip       -> Gripping;
            14: robot: Third | Safe | Away, table: Receive, hand: Open  => MovObjToPed   -> Bringing;
            15: robot: First | Third                                    => MovToPedSafe  -> Clearing;
            16: robot: Safe | Away                                      => PedPreGrip    -> Preparing;
        }
    }
}
