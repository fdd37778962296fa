use interfaces::{
    CommonMemory, Reason,
    device::{DeviceInputs, GripSensors, GroupHealth},
    grip::GripCommand,
};

use super::tables::Attachment;

/// A gripper with a servo. The hand of the Active Pedestal is nearly identical to the parts gripper (III.9.2).
pub trait Servoed {
    const NAME: &'static str;
    /// `endeff-id#` of the gripper; 0 if it is never on the quick change.
    const END_EFFECTOR_ID: u8;

    #[must_use]
    fn reason(reason: Reason) -> Reason {
        reason
    }
    fn command(memory: &CommonMemory) -> &GripCommand;
    fn sensors(devices: &DeviceInputs) -> (Attachment, GripSensors);
    fn connection(devices: &DeviceInputs) -> GroupHealth;
}

/// The parts gripper, end effector 1, on the quick change (III.3.6).
#[derive(Clone, Copy, Debug, Default)]
pub struct PartsGripper;

impl Servoed for PartsGripper {
    const NAME: &'static str = "Grip";
    const END_EFFECTOR_ID: u8 = 1;

    fn command(memory: &CommonMemory) -> &GripCommand {
        &memory.emove.grip
    }

    fn sensors(devices: &DeviceInputs) -> (Attachment, GripSensors) {
        let quick_change = &devices.quick_change;
        let locked = quick_change.locked && !quick_change.unlocked;
        let attached = locked && quick_change.end_effector_id == Self::END_EFFECTOR_ID;
        (if attached { Attachment::Attached } else { Attachment::Detached }, devices.grip)
    }

    fn connection(devices: &DeviceInputs) -> GroupHealth {
        devices.field.grip
    }
}
