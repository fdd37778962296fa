use rcs_core::decision_table;

decision_table! {
    /// GRIP (VI.7.1): grasp the object with `grasp-force`; no command to the table. A hand that closes without an
    /// object is an error, since the robot is about to release it.
    pub GRIP: fn grip(enum GripStep, super::Situation) -> super::Action {
        /// No command sent yet.
        Start {
            1: otherwise            => Close  -> Closing;
        }
        /// The hand closes.
        Closing {
            2: object: Held         => Finish;
            3: object: None | Lost  => Lose(HandMissed);
            4: object: NotKnown     => Fail(HandUncertain);
        }
    }
}
