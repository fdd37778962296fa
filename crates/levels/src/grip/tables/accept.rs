use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a command that moves the fingers needs its gripper, and an opening and a force within reach. A
    /// calibration in progress continues during a refusal.
    pub ACCEPT: fn accept(super::Request) -> crate::execution::Refusal or () {
        1: asked: Before      => consult;
        2: verb: None         => Fail(UnknownCommand);
        3: verb: Pause        => consult;
        4: addressee: Other   => Fail(WrongGripper);
        5: gripper: Detached  => Fail(WrongGripper);
        6: reach: Beyond      => Fail(GripUnattainable);
        7: reach: Within      => consult;
    }
}
