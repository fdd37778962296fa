//! The sensors of guarded moves: device words become "the condition holds" or "the sensor is faulty".
//!
//! A guarded move names a sensor (V.1.1, SENSOR-PARA): the tool gripper's force sensor (III.3.8), the proximity
//! sensors of a holster (III.3.4) or the beams between the fingers (III.3.6).
//!
//! A force is the reading less the *bias*, which CAL-SENSOR takes with the robot at rest: strain gages drift, and
//! measure the weight of the held part. Without a bias, or with a reading at an end of its converter, a force is not
//! valid, and the guarded move is refused with `sensor-error`.

use interfaces::{
    device::{
        ADC_FULL_SCALE, DeviceInputs, FORCE_COUNTS_PER_LB, FORCE_ZERO, ForceSensor, HolsterSensors,
        MOMENT_COUNTS_PER_IN_LB,
    },
    prim::FORCE_AXES,
};
use rcs_core::Plain;
use taskdata::files::{SensorPara, SensorSource};

use super::tables::{Guard, Samples};

pub const SAMPLES: u32 = 10; // 0.4 s. ASSUMED
const BEAM_GRIPPER: u8 = 1; // `endeff-id#` of the gripper with the beams
const NEAR: u8 = 0x03; // both large sensors of a holster: the ears are near
const SEATED: u8 = 0x0C; // both small sensors of a holster: the ears are seated

/// Bias of the force sensor, in counts, in the order tool Fx, Fy, Fz, My.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ForceCalibration {
    /// The reading without load; cleared when the sensor loses power.
    pub bias: Option<[f64; FORCE_AXES]>,
    pub sum: [f64; FORCE_AXES],
    pub samples: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardReading {
    pub guard: Guard,
    pub value: f64, // lb or in lb; 1 while a switch is on
}

impl Default for GuardReading {
    fn default() -> Self {
        Self::switch(false)
    }
}

impl GuardReading {
    const FAULTY: Self = Self { guard: Guard::Faulty, value: 0.0 };

    fn switch(on: bool) -> Self {
        if on { Self { guard: Guard::Met, value: 1.0 } } else { Self { guard: Guard::Clear, value: 0.0 } }
    }
}

/// Counts from the middle as tool Fx, Fy, Fz, My: tool X, Y, Z are sensor Z, -Y, X (III.3.8). `None` if the sensor has
/// no power, or an axis is overloaded, since then the other axes are not valid either.
fn tool_axes(force: &ForceSensor) -> Option<[f64; FORCE_AXES]> {
    let sound = |counts: u16| (1..ADC_FULL_SCALE).contains(&counts);
    if !force.valid || ![force.x, force.y, force.z, force.moment].into_iter().all(sound) {
        return None;
    }
    let off = |counts: u16| f64::from(counts) - f64::from(FORCE_ZERO);
    Some([off(force.z), -off(force.y), off(force.x), off(force.moment)])
}

impl ForceCalibration {
    /// Without power the bias is lost.
    pub fn watch_power(&mut self, force: &ForceSensor) {
        if !force.valid {
            *self = Self::default();
        }
    }

    pub fn begin(&mut self) {
        (self.sum, self.samples) = ([0.0; FORCE_AXES], 0);
    }

    #[must_use]
    pub fn progress(&self, force: &ForceSensor) -> Samples {
        if tool_axes(force).is_none() {
            Samples::Faulty
        } else if self.samples < SAMPLES {
            Samples::Wanted
        } else {
            Samples::Complete
        }
    }

    pub fn sample(&mut self, force: &ForceSensor) {
        if let Some(axes) = tool_axes(force) {
            self.sum.iter_mut().zip(axes).for_each(|(sum, axis)| *sum += axis);
            self.samples = self.samples.saturating_add(1);
        }
    }

    pub fn finish(&mut self) {
        if self.samples > 0 {
            self.bias = Some(self.sum.map(|sum| sum / f64::from(self.samples)));
        }
        self.begin();
    }

    /// Force along, or moment about, an axis of the tool: lb or in lb. `None` if it is not valid.
    fn force(&self, axis: usize, counts_per_unit: i32, force: &ForceSensor) -> Option<f64> {
        let counts = *tool_axes(force)?.get(axis)? - *self.bias?.get(axis)?;
        Some(counts / f64::from(counts_per_unit))
    }

    /// `end_effector` is the id of the attached gripper.
    #[must_use]
    pub fn read(
        &self,
        sensor: &SensorPara,
        devices: &DeviceInputs,
        end_effector: Option<u8>,
    ) -> GuardReading {
        let connection = match sensor.source {
            SensorSource::Fx | SensorSource::Fy | SensorSource::Fz | SensorSource::My => devices.field.force,
            SensorSource::Near | SensorSource::Seated => devices.field.holsters,
            SensorSource::Beam => devices.field.grip,
        };
        if connection.is_old() {
            return GuardReading::FAULTY;
        }
        let along = |axis| self.force(axis, FORCE_COUNTS_PER_LB, &devices.force);
        let value = match sensor.source {
            SensorSource::Fx => along(0),
            SensorSource::Fy => along(1),
            SensorSource::Fz => along(2),
            SensorSource::My => self.force(3, MOMENT_COUNTS_PER_IN_LB, &devices.force),
            SensorSource::Near => return holster(&devices.holsters, sensor.which, NEAR),
            SensorSource::Seated => return holster(&devices.holsters, sensor.which, SEATED),
            SensorSource::Beam => return beam(devices.grip.beams, sensor.which, end_effector),
        };
        let Some(value) = value else { return GuardReading::FAULTY };
        let threshold = f64::from(sensor.threshold);
        let met = if threshold < 0.0 { value <= threshold } else { value >= threshold };
        GuardReading { guard: if met { Guard::Met } else { Guard::Clear }, value }
    }
}

fn holster(sensors: &HolsterSensors, which: i32, pair: u8) -> GuardReading {
    match which {
        1 => GuardReading::switch(sensors.right & pair == pair),
        2 => GuardReading::switch(sensors.left & pair == pair),
        3 => GuardReading::switch(sensors.centre & pair == pair),
        _ => GuardReading::FAULTY,
    }
}

/// A beam, 1 to 8, or any (0). Faulty for grippers without beams.
fn beam(beams: u8, which: i32, end_effector: Option<u8>) -> GuardReading {
    let mask = match u32::try_from(which) {
        Ok(0) => u8::MAX,
        Ok(number) => 1_u8.checked_shl(number.saturating_sub(1)).unwrap_or(0),
        Err(_) => 0,
    };
    if mask == 0 || end_effector != Some(BEAM_GRIPPER) {
        return GuardReading::FAULTY;
    }
    GuardReading::switch(beams & mask != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(z: u16) -> ForceSensor {
        ForceSensor { x: 2048, y: 2048, z, moment: 2048, valid: true }
    }

    fn sensor(source: SensorSource, which: i32, threshold: i32) -> SensorPara {
        SensorPara { source, which, threshold, ..SensorPara::default() }
    }

    fn devices(force: ForceSensor) -> DeviceInputs {
        DeviceInputs { force, ..DeviceInputs::default() }
    }

    fn calibrated(at: &ForceSensor) -> ForceCalibration {
        let mut calibration = ForceCalibration::default();
        while calibration.progress(at) == Samples::Wanted {
            calibration.sample(at);
        }
        calibration.finish();
        calibration
    }

    #[test]
    fn forces_are_in_tool_axes_without_the_bias() {
        let rest = ForceSensor { x: 2148, y: 1948, z: 2248, moment: 2088, valid: true };
        let calibration = calibrated(&rest);
        assert_eq!(calibration.bias, Some([200.0, 100.0, 100.0, 40.0]));
        let pushed = ForceSensor { x: 2148 + 160, y: 1948 + 320, z: 2248 - 480, moment: 2088 - 40, ..rest };
        for (source, value) in [
            (SensorSource::Fx, -30.0),
            (SensorSource::Fy, -20.0),
            (SensorSource::Fz, 10.0),
            (SensorSource::My, -10.0),
        ] {
            for (threshold, guard) in [(5, value > 0.0), (-5, value < 0.0), (90, false), (-90, false)] {
                let reading = calibration.read(&sensor(source, 0, threshold), &devices(pushed), Some(3));
                assert_eq!((reading.value, reading.guard == Guard::Met), (value, guard), "{source}");
            }
        }
        // The condition holds at the threshold itself.
        let at = calibration.read(&sensor(SensorSource::Fx, 0, -30), &devices(pushed), Some(3));
        assert_eq!(at.guard, Guard::Met);
    }

    #[test]
    fn invalid_reading_is_faulty() {
        let good = force(2048);
        let watched = sensor(SensorSource::Fx, 0, 25);
        let read = |c: &ForceCalibration, force| c.read(&watched, &devices(force), Some(3)).guard;
        let mut calibration = ForceCalibration::default();
        assert_eq!(read(&calibration, good), Guard::Faulty, "never calibrated");
        calibration = calibrated(&good);
        assert_eq!(read(&calibration, good), Guard::Clear);
        for end in [0, ADC_FULL_SCALE, u16::MAX] {
            assert_eq!(read(&calibration, force(end)), Guard::Faulty);
            assert_eq!(read(&calibration, ForceSensor { y: end, ..good }), Guard::Faulty, "another axis");
            assert_eq!(calibration.progress(&force(end)), Samples::Faulty);
        }
        let off = ForceSensor { valid: false, ..good };
        assert_eq!(read(&calibration, off), Guard::Faulty);
        calibration.watch_power(&good);
        assert_eq!(read(&calibration, good), Guard::Clear);
        calibration.watch_power(&off);
        assert_eq!(read(&calibration, good), Guard::Faulty, "the power was off");
    }

    #[test]
    fn holster_sensor_needs_both_of_a_pair() {
        let calibration = ForceCalibration::default();
        for (which, sensors) in [
            (1, HolsterSensors { right: 0x0F, ..HolsterSensors::default() }),
            (2, HolsterSensors { left: 0x0F, ..HolsterSensors::default() }),
            (3, HolsterSensors { centre: 0x0F, ..HolsterSensors::default() }),
        ] {
            for (source, pair) in [(SensorSource::Near, NEAR), (SensorSource::Seated, SEATED)] {
                let read = |mask: u8, which: i32| {
                    let holsters = HolsterSensors {
                        right: sensors.right & mask,
                        left: sensors.left & mask,
                        centre: sensors.centre & mask,
                    };
                    let devices = DeviceInputs { holsters, ..DeviceInputs::default() };
                    calibration.read(&sensor(source, which, 0), &devices, Some(1)).guard
                };
                assert_eq!(read(pair, which), Guard::Met);
                assert_eq!(read(pair & 0x05, which), Guard::Clear, "one of the two");
                assert_eq!(read(!pair, which), Guard::Clear, "the other pair");
                assert_eq!(read(0xFF, which % 3 + 1), Guard::Clear, "another holster");
                assert_eq!(read(0xFF, 4), Guard::Faulty);
            }
        }
    }

    #[test]
    fn beams_count_from_one_on_the_parts_gripper_only() {
        let mut devices = DeviceInputs::default();
        devices.grip.beams = 0x82;
        let read = |which, id| {
            ForceCalibration::default().read(&sensor(SensorSource::Beam, which, 0), &devices, Some(id)).guard
        };
        for beam in 1..=8 {
            assert_eq!(read(beam, 1), if beam == 2 || beam == 8 { Guard::Met } else { Guard::Clear });
        }
        assert_eq!(read(0, 1), Guard::Met);
        for (which, id) in [(9, 1), (-1, 1), (40, 1), (2, 0), (2, 3)] {
            assert_eq!(read(which, id), Guard::Faulty);
        }
    }
}
