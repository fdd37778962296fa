use rcs_core::decision_table;

decision_table! {
    /// VG-RELEASE, VGRIP-POSE, TG-RELEASE, TGRIP-POSE (VI.4.1): open the fingers and report where they stop.
    /// `commanded-size` is reported as opened.
    pub RELEASE: fn release(super::Step, super::Situation) -> super::Action {
        Start {
            1: otherwise        => Open  -> Move;
        }
        Move {
            2: stop: Opened     => Report(Opened);
            3: size: Commanded  => Report(Opened);
            4: stop: Between    => Wrong(Stuck);
            5: stop: Closed     => Wrong(Closed);
        }
    }
}
