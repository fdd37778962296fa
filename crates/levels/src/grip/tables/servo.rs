//! What POSITION, OPEN-GRIP and CLOSE-GRIP have in common.

use rcs_core::decision_table;

decision_table! {
    /// SERVO: the fingers are moved only while the gripper is there and time is left; once the valves are
    /// off, the readings settle before they count.
    pub SERVO: fn servo(super::Step, super::Situation) -> super::Action or () {
        any {
            1: gripper: Detached  => Fail(WrongGripper);
            2: clock: Expired     => Fail(GripTimeout);
        }
        Settle {
            3: rest: Waiting      => Stop;
            4: rest: Rested       => consult;
        }
        Start | Move {
            5: otherwise          => consult;
        }
    }
}
