//! MOV-TO-HOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// MOV-TO-HOL (V.2.1): move to a holster, like MOV-TO-LOC. An attached gripper moves to the opening of the
    /// holster object on the way, which a gripper that holds an object cannot do. A gripper to be detached must find
    /// its holster empty, because the approach already enters between the cheeks.
    pub MOV_TO_HOL: fn mov_to_hol(struct of super::Senses) -> super::Action or () {
        1: held: Right | Other | Something                      => Fail(AlreadyHolding);
        2: held: NotKnown                                       => Fail(HeldNotKnown);
        3: held: Nothing, mate: Right, holster: Empty           => consult;
        4: held: Nothing, mate: Right, holster: Partial | Full  => Fail(HolsterOccupied);
        5: held: Nothing, mate: None | Wrong                    => consult;
    }
}
