use rcs_core::decision_table;

decision_table! {
    /// VG-GRASP, TG-GRASP (VI.4.1): close the fingers and report where they stop. `commanded-size` is reported as
    /// closed.
    pub GRASP: fn grasp(super::Step, super::Situation) -> super::Action {
        Start {
            1: otherwise        => Close  -> Move;
        }
        Move {
            2: stop: Closed     => Report(Closed);
            3: size: Commanded  => Report(Closed);
            4: stop: Between    => Wrong(Stuck);
            5: stop: Opened     => Wrong(Opened);
        }
    }
}
