//! MOV-TO-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-TO-OBJ (V.2.1): like MOV-TO-LOC, with the fingers opened for the goal. A robot that holds the object at
    /// the goal is done. A robot that holds the object elsewhere, or holds or may hold another object, must not open
    /// the fingers.
    pub MOV_TO_OBJ: fn mov_to_obj(struct of super::Senses) -> super::Action or () {
        1: held: Nothing                                 => consult;
        2: held: Other | Something                       => Fail(AlreadyHolding);
        3: held: NotKnown                                => Fail(HeldNotKnown);
        4: held: Right, work: Busy                       => consult;
        5: held: Right, ahead: Rejoin                    => consult;
        6: held: Right, ahead: Nothing                   => Finish;
        7: held: Right, ahead: Through | Stop | Missing  => Fail(AlreadyHolding);
    }
}
