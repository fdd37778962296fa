use rcs_core::decision_table;

decision_table! {
    /// RELEASE (V.3.1): open the gripper and release the held object.
    pub RELEASE: fn release(enum ReleaseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => Release  -> Releasing;
        }
        /// The gripper is opening.
        Releasing {
            3: otherwise   => Finish;
        }
    }
}
