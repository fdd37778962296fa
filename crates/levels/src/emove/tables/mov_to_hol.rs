//! MOV-TO-HOL and MOV-TO-VU (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-TO-HOL, MOV-TO-VU (V.2.1): move to a holster or to where pictures are taken, like MOV-TO-LOC; the
    /// gripper, if one is attached, is brought to an opening on the way: the value of the holster object, or
    /// fully open. A gripper that holds an object cannot do that.
    pub MOV_TO_HOL: fn mov_to_hol(super::Situation) -> super::Action or () {
        1: held: Right | Other | Something  => Fail(AlreadyHolding);
        2: held: NotKnown                   => Fail(HeldNotKnown);
        3: held: Nothing                    => consult;
    }
}
