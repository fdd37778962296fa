use rcs_core::decision_table;

decision_table! {
    /// TURN: turn to the commanded angle. Counter and potentiometer must both show it at the end.
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
