//! What POSITION, OPEN-GRIP and CLOSE-GRIP have in common.

use rcs_core::decision_table;

decision_table! {
    /// SERVO: the fingers are moved only while the gripper is there and time is left; once the valves are
    /// off, the readings settle before they count. Without new readings the valves are off.
    pub SERVO: fn servo(super::Step, super::Situation) -> super::Action or () {
        any {
            1: gripper: Detached  => Fail(WrongGripper);
            2: sensors: Tripped   => Fail(DeviceTripped);
            3: sensors: Lost      => Fail(DeviceSilent);
            4: sensors: Stale     => Stop;
            5: clock: Expired     => Fail(GripTimeout);
        }
        Settle {
            6: rest: Waiting      => Stop;
            7: rest: Rested       => consult;
        }
        Start | Move {
            8: otherwise          => consult;
        }
    }
}
