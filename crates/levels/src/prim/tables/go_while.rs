use rcs_core::decision_table;

decision_table! {
    /// GO-WHILE (V.1.1): move to a point and stop, like GOTO-PT, while the condition does not hold. If it holds, or
    /// the sensor is faulty, the robot ramps down and the move fails; also if it holds during a restart of the
    /// link.
    pub GO_WHILE: fn go_while(super::Situation) -> super::Action or () {
        1: guard: Faulty  => Fail(SensorError);
        2: guard: Met     => Fail(Detected);
        3: guard: Clear   => consult;
    }
}
