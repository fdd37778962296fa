//! The devices behind field I/O.

use rcs_core::decision_table;

decision_table! {
    /// FIELD (extension): the robot moves only while all devices answer, since a part may be held by one and a
    /// fixture opened by another. A device that is late for less than a second is waited for at rest, with the
    /// velocity knob at 0.
    pub FIELD: fn field(super::Devices) -> super::Action or () {
        1: position: NotNeeded        => consult;
        2: connection: Tripped        => Fail(DeviceTripped);
        3: connection: Lost           => Fail(DeviceSilent);
        4: connection: Fresh | Stale  => consult;
    }
}
