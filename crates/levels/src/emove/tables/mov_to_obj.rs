//! MOV-TO-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-TO-OBJ (V.2.1): like MOV-TO-LOC, with the fingers opened for the goal. A robot that
    /// holds the object is at it; one that holds anything else, or may hold it, must not open the fingers.
    pub MOV_TO_OBJ: fn mov_to_obj(super::Situation) -> super::Action or () {
        1: held: Right              => Finish;
        2: held: Other | Something  => Fail(AlreadyHolding);
        3: held: NotKnown           => Fail(HeldNotKnown);
        4: held: Nothing            => consult;
    }
}
