use rcs_core::decision_table;

decision_table! {
    /// >POSITION (V.3.1): move to a position with the parameters of an object, which may be virtual.
    pub POSITION: fn position(enum PositionStep, super::Situation) -> super::Action {
        any {
            1: work: Busy       => Wait;
        }
        /// Nothing done yet.
        Start {
            2: named: Object    => MovToObj  -> Moving;
            3: named: Location  => MovToLoc  -> Moving;
        }
        /// The robot moves to the position.
        Moving {
            4: otherwise        => Finish;
        }
    }
}
