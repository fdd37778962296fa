//! Sensors by name: every word that the controller reads from its sensors can be read and changed as a number.
//!
//! A name stands for a *connection* at the controller's boards (chapter III): the three grippers have their
//! potentiometer on the same one (III.3.7), so `grip.potentiometer` is that of the attached gripper. A fault of a
//! sensor, a cable or a converter changes only this word, so the fault injector acts here ([`crate::fault`]).

use std::ops::RangeInclusive;

use interfaces::device::{ADC_FULL_SCALE, DeviceInputs, RESOLVER_COUNTS};
use serde::{Deserialize, Serialize};

use super::word::Word::{self, Answer, Bits, Flag, Long, Short};
use Group::{Converter, Force, Other, Resolver, Switch};

/// A sensor: its index in the list of all.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Sensor(u8);

/// Kinds of sensors with common electronics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Resolvers of the joints.
    Resolver,
    /// Potentiometers and strain gages of the fingers and of the table.
    Converter,
    /// The force sensor.
    Force,
    /// Proximity, reflectance, limit switches, light beams.
    Switch,
    /// Supplies, the vision system, and names for several sensors.
    Other,
}

/// Name, group, greatest value and word of a sensor. The least value is 0.
type Row = (&'static str, Group, i64, fn(&mut DeviceInputs) -> Word<'_>);

/// The vision system, which answers in messages and not in a word: it can only be off.
const CAMERA: &str = "camera";
/// Greatest count of a resolver, which wraps around.
const TURN: i64 = RESOLVER_COUNTS as i64 - 1;
/// Greatest count of a converter.
const FULL: i64 = ADC_FULL_SCALE as i64;
/// The greatest `endeff-id#` that two id pins can show.
const ID: i64 = 3;
/// The four sensors of a holster together: their cable.
const HOLSTER: i64 = 0x0F;
/// All bits of a byte.
const ALL: u8 = u8::MAX;

/// All sensors.
const SENSORS: [Row; 48] = [
    ("resolvers", Other, 1, |inputs| Flag(&mut inputs.resolvers.valid)),
    ("resolver.base", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[0])),
    ("resolver.shoulder", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[1])),
    ("resolver.elbow", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[2])),
    ("resolver.pitch", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[3])),
    ("resolver.yaw", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[4])),
    ("resolver.roll", Resolver, TURN, |inputs| Long(&mut inputs.resolvers.counts[5])),
    ("grip.potentiometer", Converter, FULL, |inputs| Short(&mut inputs.grip.potentiometer)),
    ("grip.strain-left", Converter, FULL, |inputs| Short(&mut inputs.grip.strain_left)),
    ("grip.strain-right", Converter, FULL, |inputs| Short(&mut inputs.grip.strain_right)),
    ("beam.1", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x01)),
    ("beam.2", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x02)),
    ("beam.3", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x04)),
    ("beam.4", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x08)),
    ("beam.5", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x10)),
    ("beam.6", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x20)),
    ("beam.7", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x40)),
    ("beam.8", Switch, 1, |inputs| Bits(&mut inputs.grip.beams, 0x80)),
    ("quick-change.locked", Switch, 1, |inputs| Flag(&mut inputs.quick_change.locked)),
    ("quick-change.unlocked", Switch, 1, |inputs| Flag(&mut inputs.quick_change.unlocked)),
    ("quick-change.id", Other, ID, |inputs| Bits(&mut inputs.quick_change.end_effector_id, ALL)),
    ("holster.right.large-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.right, 0x01)),
    ("holster.right.large-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.right, 0x02)),
    ("holster.right.small-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.right, 0x04)),
    ("holster.right.small-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.right, 0x08)),
    ("holster.left.large-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.left, 0x01)),
    ("holster.left.large-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.left, 0x02)),
    ("holster.left.small-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.left, 0x04)),
    ("holster.left.small-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.left, 0x08)),
    ("holster.centre.large-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.centre, 0x01)),
    ("holster.centre.large-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.centre, 0x02)),
    ("holster.centre.small-1", Switch, 1, |inputs| Bits(&mut inputs.holsters.centre, 0x04)),
    ("holster.centre.small-2", Switch, 1, |inputs| Bits(&mut inputs.holsters.centre, 0x08)),
    ("force", Other, 1, |inputs| Flag(&mut inputs.force.valid)),
    ("force.x", Force, FULL, |inputs| Short(&mut inputs.force.x)),
    ("force.y", Force, FULL, |inputs| Short(&mut inputs.force.y)),
    ("force.z", Force, FULL, |inputs| Short(&mut inputs.force.z)),
    ("force.moment", Force, FULL, |inputs| Short(&mut inputs.force.moment)),
    ("pedestal.potentiometer", Converter, FULL, |inputs| Short(&mut inputs.pedestal.potentiometer)),
    ("pedestal.strain-left", Converter, FULL, |inputs| Short(&mut inputs.pedestal.strain_left)),
    ("pedestal.strain-right", Converter, FULL, |inputs| Short(&mut inputs.pedestal.strain_right)),
    ("table.potentiometer", Converter, FULL, |inputs| Short(&mut inputs.pedestal.table_potentiometer)),
    ("table.limit-plus", Switch, 1, |inputs| Flag(&mut inputs.pedestal.limit_plus)),
    ("table.limit-minus", Switch, 1, |inputs| Flag(&mut inputs.pedestal.limit_minus)),
    (CAMERA, Other, 1, |inputs| Answer(&mut inputs.vision)),
    ("holster.right", Other, HOLSTER, |inputs| Bits(&mut inputs.holsters.right, ALL)),
    ("holster.left", Other, HOLSTER, |inputs| Bits(&mut inputs.holsters.left, ALL)),
    ("holster.centre", Other, HOLSTER, |inputs| Bits(&mut inputs.holsters.centre, ALL)),
];

impl Sensor {
    /// The sensor with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|sensor| sensor.name() == name)
    }

    /// All sensors.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..).take(SENSORS.len()).map(Self)
    }

    const fn row(self) -> &'static Row {
        &SENSORS[self.0 as usize]
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// The kind of sensor.
    #[must_use]
    pub const fn group(self) -> Group {
        self.row().1
    }

    /// True for the vision system.
    #[must_use]
    pub fn is_camera(self) -> bool {
        self.name() == CAMERA
    }

    /// Range of the word: counts of a converter, or 0 and 1.
    #[must_use]
    pub const fn range(self) -> RangeInclusive<i64> {
        0..=self.row().2
    }

    /// Its present value.
    #[must_use]
    pub fn read(self, inputs: &DeviceInputs) -> i64 {
        let (.., word) = self.row();
        word(&mut inputs.clone()).read()
    }

    /// Set it to the nearest possible value. A resolver wraps around.
    pub fn write(self, inputs: &mut DeviceInputs, value: i64) {
        let (_, group, greatest, word) = self.row();
        let value = match group {
            Resolver => value.rem_euclid(greatest + 1),
            _ => value.clamp(0, *greatest),
        };
        word(inputs).write(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::device::VisionResponse;

    #[test]
    fn every_sensor_is_found_by_its_name_and_has_its_own_word() {
        for sensor in Sensor::all() {
            assert_eq!(Sensor::named(sensor.name()), Some(sensor));
            if sensor.is_camera() {
                continue;
            }
            let mut inputs = DeviceInputs::default();
            let most = *sensor.range().end();
            sensor.write(&mut inputs, most);
            assert_eq!(sensor.read(&inputs), most, "{}", sensor.name());
            let others = Sensor::all().filter(|other| *other != sensor && !other.is_camera());
            let shown: Vec<&str> =
                others.filter(|other| other.read(&inputs) != 0).map(Sensor::name).collect();
            let parts = sensor.name().split('.').count();
            let related = |name: &&str| {
                sensor.name().starts_with("holster") && name.starts_with(&sensor.name()[..11]) && parts >= 2
            };
            assert!(shown.iter().all(related), "{} also shows in {shown:?}", sensor.name());
            sensor.write(&mut inputs, 0);
            assert_eq!(inputs, DeviceInputs::default(), "{}", sensor.name());
        }
        assert_eq!(Sensor::named("grip.strain"), None);
    }

    #[test]
    fn converters_saturate_and_resolvers_go_round() {
        let mut inputs = DeviceInputs::default();
        let (gage, resolver) = (Sensor::named("grip.strain-left"), Sensor::named("resolver.roll"));
        let (gage, resolver) = (gage.unwrap(), resolver.unwrap());
        gage.write(&mut inputs, 9_999);
        assert_eq!(inputs.grip.strain_left, ADC_FULL_SCALE);
        gage.write(&mut inputs, -5);
        assert_eq!(inputs.grip.strain_left, 0);
        resolver.write(&mut inputs, -1);
        assert_eq!(inputs.resolvers.counts[5], RESOLVER_COUNTS - 1);
    }

    #[test]
    fn a_camera_that_is_off_does_not_answer() {
        let mut inputs = DeviceInputs::default();
        inputs.vision.echo = 7;
        let camera = Sensor::named("camera").unwrap();
        camera.write(&mut inputs, 1);
        assert_eq!(inputs.vision.echo, 7);
        camera.write(&mut inputs, 0);
        assert_eq!(inputs.vision, VisionResponse::default());
    }
}
