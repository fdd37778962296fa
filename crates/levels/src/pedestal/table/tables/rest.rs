//! Rows common to TURN and PAUSE.

use rcs_core::decision_table;

decision_table! {
    /// REST: wait until the motor has taken its order and is at rest. A table that already turns is stopped first.
    pub REST: fn rest(super::Step, super::Situation) -> super::Action or () {
        any {
            1: motor: Standing | Silent   => consult;
            2: clock: Expired             => Lose(TableStuck);
            3: motor: Pending | Settling  => Wait;
        }
        Start {
            4: motor: Turning             => Stop;
        }
        Turning {
            5: motor: Turning             => Wait;
        }
    }
}
