//! TURN.

use rcs_core::decision_table;

decision_table! {
    /// TURN: turn to the commanded angle, which counter and potentiometer must both show in the end.
    pub TURN: fn turn(super::Step, super::Situation) -> super::Action {
        any {
            1: motor: Silent     => Lose(TableStuck);
            2: place: There      => Finish;
        }
        Start {
            3: place: Elsewhere  => Turn  -> Turning;
        }
        Turning {
            4: place: Elsewhere  => Lose(TableStuck);
        }
    }
}
