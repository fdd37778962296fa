//! WITHDRAW (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// WITHDRAW (V.2.1): a DELTA-MOVE commanded by Subtask.
    pub WITHDRAW: fn withdraw(enum WithdrawStep, struct of super::Senses) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => DeltaMove(Withdraw)  -> Moving;
        }
        /// The robot is moving.
        Moving {
            3: otherwise   => Stand;
        }
    }
}
