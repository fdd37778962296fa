use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a command that moves the fingers needs its gripper. A refusal leaves the air as it is.
    pub ACCEPT: fn accept(super::Request) -> super::Action or () {
        1: asked: Before      => consult;
        2: verb: None         => Refuse(UnknownCommand);
        3: verb: Pause        => consult;
        4: addressee: Other   => Refuse(WrongGripper);
        5: gripper: Detached  => Refuse(WrongGripper);
        6: gripper: Attached  => consult;
    }
}
