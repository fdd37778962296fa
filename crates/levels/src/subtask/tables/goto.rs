use rcs_core::decision_table;

decision_table! {
    /// GOTO-ENDPT, GOTO-DEST (V.3.1): move to the end-at location, or to the destination.
    pub GOTO: fn goto(enum GotoStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => MovToLoc  -> Moving;
        }
        /// The robot moves to the location.
        Moving {
            3: otherwise   => Finish;
        }
    }
}
