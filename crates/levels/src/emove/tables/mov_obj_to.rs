//! MOV-OBJ-TO (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-OBJ-TO (V.2.1): move the held object to a destination, like MOV-TO-LOC.
    pub MOV_OBJ_TO: fn mov_obj_to(struct of super::Senses) -> super::Action or () {
        1: held: Nothing | Other | Something  => Fail(NothingHeld);
        2: held: NotKnown                     => Fail(HeldNotKnown);
        3: held: Right                        => consult;
    }
}
