use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.3.1): the valves stay as they are, and the command waits until the fingers are at rest. Without
    /// the gripper the valves are off.
    pub PAUSE: fn pause(super::Step, super::Situation) -> super::Action {
        any {
            1: gripper: Detached  => Finish;
            2: motion: Still      => Pause;
        }
        Start {
            3: otherwise          => Keep  -> Move;
        }
        Move | Settle {
            4: clock: Running     => Keep;
            5: clock: Expired     => Pause;
        }
    }
}
