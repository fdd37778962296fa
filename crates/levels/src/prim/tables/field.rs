//! The devices on field I/O.

use rcs_core::decision_table;

decision_table! {
    /// FIELD (extension): the robot moves only while all devices answer, since one may hold a part and another open
    /// a fixture. If a device is late by less than a second, the robot waits at rest, with the velocity knob at 0.
    pub FIELD: fn field(super::Devices) -> super::Action or () {
        1: position: NotNeeded        => consult;
        2: connection: Tripped        => Fail(DeviceTripped);
        3: connection: Lost           => Fail(DeviceSilent);
        4: connection: Fresh | Stale  => consult;
    }
}
