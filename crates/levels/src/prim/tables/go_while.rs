//! GO-WHILE (V.1.1).

use rcs_core::decision_table;

decision_table! {
    /// GO-WHILE (V.1.1): move to a point and stop, as GOTO-PT does, while the condition does not come. If it
    /// comes, or the sensor cannot tell, the robot ramps down and the move has failed; so it has if it came
    /// while the link was restarted.
    pub GO_WHILE: fn go_while(super::Situation) -> super::Action or () {
        1: guard: Faulty  => Fail(SensorError);
        2: guard: Met     => Fail(Detected);
        3: guard: Clear   => consult;
    }
}
