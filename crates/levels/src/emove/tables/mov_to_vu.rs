//! MOV-TO-VU (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-TO-VU (V.2.1): move to the place of the pictures, like MOV-TO-LOC. The gripper opens fully on the way,
    /// which a gripper that holds an object cannot do.
    pub MOV_TO_VU: fn mov_to_vu(struct of super::Senses) -> super::Action or () {
        1: held: Right | Other | Something  => Fail(AlreadyHolding);
        2: held: NotKnown                   => Fail(HeldNotKnown);
        3: held: Nothing                    => consult;
    }
}
