use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a new command is refused if one of its records is missing or unusable.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1: asked: Before                           => consult;
        2: missing: Command                        => Fail(UnknownCommand);
        3: missing: Sensor                         => Fail(UnknownSensor);
        4: missing: Pose | Movetable | Parameters  => Fail(BadRecord);
        5: missing: Limits                         => Fail(BadParameters);
        6: missing: Nothing                        => consult;
    }
}
