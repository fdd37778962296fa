//! Rows common to POSITION, OPEN-GRIP and CLOSE-GRIP.

use rcs_core::decision_table;

decision_table! {
    /// SERVO: the fingers move only while the gripper is attached and the time limit is not over. Once the valves
    /// are off, the readings settle before they count. Without new readings the valves are off.
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
