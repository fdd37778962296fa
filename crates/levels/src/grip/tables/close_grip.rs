use rcs_core::decision_table;

decision_table! {
    /// CLOSE-GRIP (VI.3.1): close until both fingers touch, then servo the force to `sforce`. Also done if no
    /// object is between the fingers; E-move distinguishes the two by the opening.
    pub CLOSE_GRIP: fn close_grip(super::Step, super::Situation) -> super::Action {
        Start | Move {
            1:  grasp: Far                            => Close(Coarse)  -> Move;
            2:  grasp: Near | Loose                   => Close(Medium)  -> Move;
            3:  grasp: OneFinger                      => AwaitFinger    -> Move;
            4:  grasp: Weak                           => Close(Fine)    -> Move;
            5:  grasp: Firm | Missed                  => Stop           -> Settle;
            6:  grasp: Strong                         => Open(Fine)     -> Move;
            7:  grasp: Crushing                       => Open(Medium)   -> Move;
        }
        Settle {
            8:  grasp: Firm | Missed, felt: NotKnown  => Stop;
            9:  grasp: Firm | Missed                  => Finish;
            10: otherwise                             => Stop           -> Move;
        }
    }
}
