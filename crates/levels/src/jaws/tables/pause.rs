use rcs_core::decision_table;

decision_table! {
    /// VG-PAUSE, TG-PAUSE (VI.4.1): the valves stay as they are; the potentiometer is read for the status. Without
    /// the gripper no reading exists.
    pub PAUSE: fn pause(super::Situation) -> super::Action {
        1: gripper: Detached  => Report(Idle);
        2: motion: Moving     => Wait;
        3: stop: Closed       => Report(Closed);
        4: stop: Opened       => Report(Opened);
        5: size: Commanded    => Report(AtPosition);
        6: size: Other        => Wrong(Stuck);
    }
}
