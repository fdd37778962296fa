//! FIX-GRIP (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// FIX-GRIP (V.3.1): regrip the object with the Active Pedestal; done at once if it is held as it is to be. While anything is wrong with
    /// the pedestal the robot stays where it is and keeps its grip.
    pub FIX_GRIP: fn fix_grip(enum FixGripStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Nothing | Other                    => Fail(NothingHeld);
            3: held: Right, grip: Destination           => Finish;
            4: held: Right, grip: Neither               => Fail(RegripNeeded);
            5: held: Right, grip: Source | Unknown      => PedPreGrip       -> Preparing;
        }
        /// The pedestal opens its hand and turns its table to receive the object.
        Preparing {
            6: held: Right                              => MovObjToPed      -> Bringing;
            7: held: Nothing | Other                    => Fail(ObjectLost);
        }
        /// The object is on its way to the pedestal.
        Bringing {
            8: held: Right                              => PedGrip          -> Gripping;
            9: held: Nothing | Other                    => Fail(ObjectLost);
        }
        /// The pedestal closes its hand on the object.
        Gripping {
            10: hand: Gripping                          => ReleaseAtPed     -> Releasing;
            11: hand: Empty                             => Fail(GraspMissed);
        }
        /// The robot lets go.
        Releasing {
            12: work: Over                              => MovToPedSafe     -> Clearing;
        }
        /// The robot is on its way out of the pedestal's way.
        Clearing {
            13: work: Over                              => PedFlip          -> Flipping;
        }
        /// The pedestal turns the object.
        Flipping {
            14: hand: Gripping                          => MovToObjAtPed    -> Approaching;
            15: hand: Empty                             => Fail(ObjectLost);
        }
        /// The robot is on its way back to the object.
        Approaching {
            16: work: Over                              => GraspObjAtPed    -> Grasping;
        }
        /// The robot's fingers are closing.
        Grasping {
            17: held: Right                             => PedRelease       -> LettingGo;
            18: held: Nothing | Other                   => Fail(GraspMissed);
        }
        /// The pedestal lets go.
        LettingGo {
            19: held: Right                             => Finish;
            20: held: Nothing | Other                   => Fail(ObjectLost);
        }
    }
}
