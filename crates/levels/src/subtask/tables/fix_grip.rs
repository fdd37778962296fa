//! FIX-GRIP (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// FIX-GRIP (V.3.1): regrip the object with the Active Pedestal; done at once if it is held as it is to be. What is
    /// next depends on who has the part, on the angle of the table and on where the robot is; the step only says what was
    /// ordered last. While anything is wrong with the pedestal the robot stays where it is and keeps its grip. The hand is
    /// opened only when it is empty and the robot is clear of it, or when the robot has the part in the new grip.
    pub FIX_GRIP: fn fix_grip(enum FixGripStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                              => Wait;
            2:  part: Other                                                             => Fail(PedestalHoldsOther);
            3:  part: Unknown                                                           => Fail(UnknownHeld);
            4:  part: NotKnown                                                          => Fail(HeldNotKnown);
            5:  part: Robot, grip: Destination                                          => Finish;
            6:  part: Robot, grip: Neither                                              => Fail(RegripNeeded);
        }
        /// Nothing ordered yet.
        Start {
            7:  part: Nobody                                                            => Fail(NothingHeld);
            8:  part: Robot, grip: Source, robot: Safe | Away                           => PedPreGrip       -> Preparing;
        }
        /// The pedestal opens its hand and turns its table to receive the object.
        Preparing {
            9:  part: Robot, grip: Source, table: Turned | Between                      => Fail(TableStuck);
            10: part: Robot, grip: Source, table: Receive, hand: Narrow                 => Fail(PedestalError);
        }
        /// The pedestal closes its hand on the object.
        Gripping {
            11: part: Robot, grip: Source                                               => Fail(GraspMissed);
        }
        /// The robot's fingers close on the object.
        Grasping {
            12: part: Hand | Touched                                                    => Fail(GraspMissed);
        }
        any {
            13: part: Nobody                                                            => Fail(ObjectLost);
            // The robot has the part.
            14: part: Robot, grip: Source, robot: First | Third, table: Turned | Between => MovToPedSafe    -> Clearing;
            15: part: Robot, grip: Source, robot: First | Third, hand: Narrow           => MovToPedSafe     -> Clearing;
            16: part: Robot, grip: Source, robot: Safe | Away, table: Turned | Between  => PedPreGrip       -> Preparing;
            17: part: Robot, grip: Source, robot: Safe | Away, hand: Narrow             => PedPreGrip       -> Preparing;
            18: part: Robot, grip: Source, robot: First                                 => PedGrip          -> Gripping;
            19: part: Robot, grip: Source, robot: Third | Safe | Away                   => MovObjToPed      -> Bringing;
            // Both have it.
            20: part: Both | Touched, robot: First, table: Receive                      => ReleaseAtPed     -> Releasing;
            21: part: Both, robot: Third, table: Turned                                 => PedRelease       -> LettingGo;
            22: part: Touched, robot: Third, table: Turned                              => GraspObjAtPed    -> Grasping;
            23: part: Both | Touched                                                    => Fail(PartInPedestal);
            // The pedestal has it.
            24: part: Hand, robot: First                                                => MovToPedSafe     -> Clearing;
            25: part: Hand, robot: Third, table: Receive | Between                      => MovToPedSafe     -> Clearing;
            26: part: Hand, robot: Third, table: Turned                                 => GraspObjAtPed    -> Grasping;
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
            27: part: Hand, table: Receive | Between                                    => Fail(TableStuck);
        }
        any {
            28: part: Hand, robot: Away, table: Receive | Between                       => MovToPedSafe     -> Clearing;
            29: part: Hand, robot: Safe, table: Receive                                 => PedFlip(Whole)   -> Flipping;
            30: part: Hand, robot: Safe, table: Between                                 => PedFlip(Rest)    -> Flipping;
            31: part: Hand, robot: Safe | Away, table: Turned                           => MovToObjAtPed    -> Approaching;
        }
    }
}
