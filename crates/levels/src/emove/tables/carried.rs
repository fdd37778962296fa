//! The held object during a command.

use rcs_core::decision_table;

decision_table! {
    /// CARRIED: a command fails if the robot loses the held object. Exceptions are commands that release it, and
    /// commands during which the robot only looks or pauses.
    pub CARRIED: fn carried(super::Subordinates) -> super::Action or () {
        1: load: Kept                      => consult;
        2: verb: None | Pause | LocateObj  => consult;
        3: verb: Release | ReleaseTool     => consult;
        4: load: Lost                      => Fail(ObjectLost);
        5: load: GripperGone               => Fail(GripperGone);
        6: load: PinsFail                  => Fail(PinsFail);
    }
}
