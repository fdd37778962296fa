//! FIX-GRIP (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// FIX-GRIP (V.3.1): regrip the object with the Active Pedestal; done at once if it is held as it is to
    /// be. What is next depends on who has the part, on the angle of the table and on where the robot is; the
    /// step only says what was ordered last. While anything is wrong with the pedestal the robot stays where
    /// it is and keeps its grip. The hand is opened only when it is empty and the robot is clear of it, or
    /// when the robot has the part in the new grip.
    pub FIX_GRIP: fn fix_grip(enum FixGripStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                  => Wait;
            2:  part: Other                                                 => Fail(PedestalHoldsOther);
            3:  part: Unknown                                               => Fail(UnknownHeld);
            4:  part: NotKnown                                              => Fail(HeldNotKnown);
            5:  part: Unsure                                                => Fail(HandUncertain);
            6:  part: Robot, grip: Destination                              => Finish;
            7:  part: Robot, grip: Neither                                  => Fail(RegripNeeded);
        }
        /// Nothing ordered yet.
        Start {
            8:  part: Neither                                               => Fail(NothingHeld);
            9:  part: Robot, robot: Safe | Away                             => PedPreGrip     -> Preparing;
        }
        /// The pedestal opens its hand and turns its table to receive the object.
        Preparing {
            10: part: Robot, table: Turned | Between | Unknown              => Fail(TableStuck);
            11: part: Robot, hand: Narrow                                   => Fail(PedestalError);
        }
        /// The pedestal closes its hand on the object.
        Gripping {
            12: part: Robot                                                 => Fail(GraspMissed);
        }
        /// The robot's fingers close on the object.
        Grasping {
            13: part: Hand | Touched                                        => Fail(GraspMissed);
        }
        any {
            14: part: Neither                                               => Fail(ObjectLost);
            // The robot has the part.
            15: part: Robot, robot: First, table: Receive, hand: Open       => PedGrip        -> Gripping;
            16: part: Robot, robot: Third, table: Receive, hand: Open       => MovObjToPed    -> Bringing;
            17: part: Robot, robot: First | Third                           => MovToPedSafe   -> Clearing;
            18: part: Robot, robot: Safe | Away, table: Receive, hand: Open => MovObjToPed    -> Bringing;
            19: part: Robot, robot: Safe | Away                             => PedPreGrip     -> Preparing;
            // Both have it.
            20: part: Both | Touched, robot: First, table: Receive          => ReleaseAtPed   -> Releasing;
            21: part: Both, robot: Third, table: Turned                     => PedRelease     -> LettingGo;
            22: part: Touched, robot: Third, table: Turned                  => GraspObjAtPed  -> Grasping;
            23: part: Both | Touched                                        => Fail(PartInPedestal);
            // The pedestal has it.
            24: part: Hand, robot: Third, table: Turned                     => GraspObjAtPed  -> Grasping;
            25: part: Hand, robot: First | Third                            => MovToPedSafe   -> Clearing;
        }
        /// The object is on its way to the pedestal.
        Bringing {}
        /// The robot lets go.
        Releasing {}
        /// The robot is on its way out of the pedestal's way.
        Clearing {}
        /// The robot is on its way back to the object.
        Approaching {}
        /// The pedestal lets go.
        LettingGo {}
        /// The pedestal turns the object.
        Flipping {
            26: part: Hand, table: Receive | Between | Unknown              => Fail(TableStuck);
        }
        any {
            27: part: Hand, table: Turned                                   => MovToObjAtPed  -> Approaching;
            28: part: Hand, robot: Away                                     => MovToPedSafe   -> Clearing;
            29: part: Hand, table: Receive                                  => PedFlip(Whole) -> Flipping;
            30: part: Hand, table: Between                                  => PedFlip(Rest)  -> Flipping;
            31: part: Hand, table: Unknown                                  => Fail(TableAngleUnknown);
        }
    }
}
