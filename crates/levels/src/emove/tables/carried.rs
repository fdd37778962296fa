//! What a command carries.

use rcs_core::decision_table;

decision_table! {
    /// CARRIED: what the robot carries must not be lost while it moves. Commands that let go of it, and those
    /// during which the robot only looks or pauses, do not fail for that.
    pub CARRIED: fn carried(super::Subordinates) -> super::Action or () {
        1: load: Kept                      => consult;
        2: verb: None | Pause | LocateObj  => consult;
        3: verb: Release | ReleaseTool     => consult;
        4: load: Lost                      => Fail(ObjectLost);
        5: load: GripperGone               => Fail(GripperGone);
        6: load: PinsFail                  => Fail(PinsFail);
    }
}
