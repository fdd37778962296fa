//! GRASP-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// GRASP-OBJ (V.2.1): close the gripper on the object; done at once if it is held.
    pub GRASP_OBJ: fn grasp_obj(enum GraspObjStep, super::Situation) -> super::Action {
        any {
            1: work: Busy        => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right       => Finish;
            3: held: Other       => Fail(AlreadyHolding);
            4: held: Nothing     => Close -> Closing;
        }
        /// The gripper is closing.
        Closing {
            5: fingers: Gripping => Grasped;
            6: fingers: Empty    => Fail(GraspMissed);
        }
    }
}
