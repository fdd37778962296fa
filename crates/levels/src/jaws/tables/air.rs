//! Rows common to the commands that move the fingers.

use rcs_core::decision_table;

decision_table! {
    /// AIR: the command waits until fingers with air stop. It fails without the gripper, or if the fingers never
    /// stop; then the air is off.
    pub AIR: fn air(super::Step, super::Situation) -> super::Action or () {
        any {
            1: gripper: Detached    => Refuse(WrongGripper);
            2: connection: Tripped  => Fail(DeviceTripped);
            3: connection: Lost     => Fail(DeviceSilent);
        }
        Start {
            4: otherwise            => consult;
        }
        Move {
            5: motion: Moving       => Wait;
            6: motion: Endless      => Fail(JawsStuck);
            7: motion: Stopped      => consult;
        }
    }
}
