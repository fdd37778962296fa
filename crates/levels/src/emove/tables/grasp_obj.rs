//! GRASP-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// GRASP-OBJ (V.2.1): close the gripper on the object; done at once if it is held and between the fingers. An
    /// object detected by the fingers is grasped again, because it may be half gripped. The same applies to a held
    /// object whose release has failed. A robot moved off its place by the operator returns there first. A robot at
    /// an unknown place does not close.
    pub GRASP_OBJ: fn grasp_obj(enum GraspObjStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                        => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right, fingers: Gripping                    => Finish;
        }
        /// The robot is returning to its place.
        Correcting {}
        Start | Correcting {
            3:  held: Other                                       => Fail(AlreadyHolding);
        }
        Start {
            4:  held: Something, at: Elsewhere | Before | InDrum  => Fail(AlreadyHolding);
            5:  held: NotKnown,  at: Elsewhere | Before | InDrum  => Fail(HeldNotKnown);
            6:  place: Searching | Unknown                        => Fail(UnknownStart);
            7:  ahead: Rejoin                                     => GotoPt  -> Correcting;
        }
        Start | Correcting {
            8:  held: Right | Nothing | Something | NotKnown      => Close   -> Closing;
        }
        /// The gripper is closing.
        Closing {
            9:  fingers: Gripping                                 => Grasped;
            10: fingers: Empty                                    => Fail(GraspMissed);
        }
    }
}
