//! The hand of the pedestal (III.9.2): "nearly identical" to the parts gripper, so it uses the servo of Grip.

use interfaces::{
    CommonMemory, Reason,
    device::{DeviceInputs, GripSensors, GroupHealth},
    grip::GripCommand,
};

use crate::grip::{Servo, servoed::Servoed, tables::Attachment};

/// The gripper on the rotary table. It has only finger position and force sensors, and is always attached.
#[derive(Clone, Copy, Debug, Default)]
pub struct PedestalHand;

impl Servoed for PedestalHand {
    const NAME: &'static str = "Pedestal Hand";
    const END_EFFECTOR_ID: u8 = 0;

    /// The pedestal's hand is named, to distinguish its failures from those of the robot's grippers.
    fn reason(reason: Reason) -> Reason {
        match reason {
            Reason::GripNotCalibrated => Reason::HandNotCalibrated,
            Reason::GripTimeout => Reason::HandTimeout,
            Reason::GripUnattainable => Reason::HandUnattainable,
            other => other,
        }
    }

    fn command(memory: &CommonMemory) -> &GripCommand {
        &memory.pedestal.hand
    }

    fn sensors(devices: &DeviceInputs) -> (Attachment, GripSensors) {
        let pedestal = &devices.pedestal;
        let sensors = GripSensors {
            potentiometer: pedestal.potentiometer,
            strain_left: pedestal.strain_left,
            strain_right: pedestal.strain_right,
            beams: 0,
        };
        (Attachment::Attached, sensors)
    }

    fn connection(devices: &DeviceInputs) -> GroupHealth {
        devices.field.hand
    }
}

pub type Hand = Servo<PedestalHand>;
