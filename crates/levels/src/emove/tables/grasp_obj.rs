//! GRASP-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// GRASP-OBJ (V.2.1): close the gripper on the object; done at once if it is held and between the
    /// fingers. An object that the fingers sense is grasped again: it may be half gripped. So is what
    /// counts as held since a release of it has not ended well. A robot that a person has moved off its place goes
    /// back there first, and one that is lost closes on nothing.
    pub GRASP_OBJ: fn grasp_obj(enum GraspObjStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                        => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right, fingers: Gripping                    => Finish;
        }
        /// The robot is going back to its place.
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
