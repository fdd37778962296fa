//! Sensors by name: every word that the controller reads from its sensors can be read and changed as a number.
//!
//! A name stands for a *connection* at the controller's boards (chapter III): the three grippers have their
//! potentiometer on the same one (III.3.7), so `grip.potentiometer` is that of the attached gripper. A fault of a
//! sensor, a cable or a converter changes only this word, so the fault injector acts here ([`crate::fault`]).

use core::ops::RangeInclusive;

use interfaces::device::{ADC_FULL_SCALE, DeviceInputs, HolsterSensors, RESOLVER_COUNTS, VisionResponse};
use serde::{Deserialize, Serialize};

/// A sensor: its index in the list of all.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Sensor(u8);

/// The word that a name stands for.
#[derive(Clone, Copy)]
enum Word {
    /// Power of the resolver box.
    Resolvers,
    Resolver(usize),
    GripPotentiometer,
    GripStrainLeft,
    GripStrainRight,
    Beam(u8),
    Locked,
    Unlocked,
    GripperId,
    /// A sensor of a holster: 0 right, 1 left, 2 centre, and its bit.
    Holster(usize, u8),
    /// Power of the conditioners of the force sensor.
    Force,
    ForceX,
    ForceY,
    ForceZ,
    Moment,
    HandPotentiometer,
    HandStrainLeft,
    HandStrainRight,
    TablePotentiometer,
    LimitPlus,
    LimitMinus,
    Camera,
}

/// All sensors.
const SENSORS: [(&str, Word); 48] = [
    ("resolvers", Word::Resolvers),
    ("resolver.base", Word::Resolver(0)),
    ("resolver.shoulder", Word::Resolver(1)),
    ("resolver.elbow", Word::Resolver(2)),
    ("resolver.pitch", Word::Resolver(3)),
    ("resolver.yaw", Word::Resolver(4)),
    ("resolver.roll", Word::Resolver(5)),
    ("grip.potentiometer", Word::GripPotentiometer),
    ("grip.strain-left", Word::GripStrainLeft),
    ("grip.strain-right", Word::GripStrainRight),
    ("beam.1", Word::Beam(0)),
    ("beam.2", Word::Beam(1)),
    ("beam.3", Word::Beam(2)),
    ("beam.4", Word::Beam(3)),
    ("beam.5", Word::Beam(4)),
    ("beam.6", Word::Beam(5)),
    ("beam.7", Word::Beam(6)),
    ("beam.8", Word::Beam(7)),
    ("quick-change.locked", Word::Locked),
    ("quick-change.unlocked", Word::Unlocked),
    ("quick-change.id", Word::GripperId),
    ("holster.right.large-1", Word::Holster(0, 0)),
    ("holster.right.large-2", Word::Holster(0, 1)),
    ("holster.right.small-1", Word::Holster(0, 2)),
    ("holster.right.small-2", Word::Holster(0, 3)),
    ("holster.left.large-1", Word::Holster(1, 0)),
    ("holster.left.large-2", Word::Holster(1, 1)),
    ("holster.left.small-1", Word::Holster(1, 2)),
    ("holster.left.small-2", Word::Holster(1, 3)),
    ("holster.centre.large-1", Word::Holster(2, 0)),
    ("holster.centre.large-2", Word::Holster(2, 1)),
    ("holster.centre.small-1", Word::Holster(2, 2)),
    ("holster.centre.small-2", Word::Holster(2, 3)),
    ("force", Word::Force),
    ("force.x", Word::ForceX),
    ("force.y", Word::ForceY),
    ("force.z", Word::ForceZ),
    ("force.moment", Word::Moment),
    ("pedestal.potentiometer", Word::HandPotentiometer),
    ("pedestal.strain-left", Word::HandStrainLeft),
    ("pedestal.strain-right", Word::HandStrainRight),
    ("table.potentiometer", Word::TablePotentiometer),
    ("table.limit-plus", Word::LimitPlus),
    ("table.limit-minus", Word::LimitMinus),
    ("camera", Word::Camera),
    ("holster.right", Word::Holster(0, WHOLE)),
    ("holster.left", Word::Holster(1, WHOLE)),
    ("holster.centre", Word::Holster(2, WHOLE)),
];

/// Bit value for all four sensors of a holster together: their cable.
const WHOLE: u8 = u8::MAX;
/// Bits of the four sensors of a holster.
const HOLSTER_BITS: u8 = 0x0F;
/// The greatest `endeff-id#` that two id pins can show.
const GREATEST_ID: i64 = 3;

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

impl Sensor {
    /// The kind of sensor.
    #[must_use]
    pub const fn group(self) -> Group {
        match self.entry().1 {
            Word::Resolver(_) => Group::Resolver,
            Word::GripPotentiometer
            | Word::GripStrainLeft
            | Word::GripStrainRight
            | Word::HandPotentiometer
            | Word::HandStrainLeft
            | Word::HandStrainRight
            | Word::TablePotentiometer => Group::Converter,
            Word::ForceX | Word::ForceY | Word::ForceZ | Word::Moment => Group::Force,
            Word::Holster(_, WHOLE) | Word::Resolvers | Word::Force | Word::GripperId | Word::Camera => {
                Group::Other
            }
            Word::Beam(_)
            | Word::Locked
            | Word::Unlocked
            | Word::Holster(..)
            | Word::LimitPlus
            | Word::LimitMinus => Group::Switch,
        }
    }

    /// The sensor with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let at = SENSORS.iter().position(|(known, _)| *known == name)?;
        u8::try_from(at).ok().map(Self)
    }

    /// All sensors.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..).take(SENSORS.len()).map(Self)
    }

    const fn entry(self) -> &'static (&'static str, Word) {
        &SENSORS[self.0 as usize]
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.entry().0
    }

    /// True for the vision system, which answers in messages and not in a word: it can only be off.
    #[must_use]
    pub const fn is_camera(self) -> bool {
        matches!(self.entry().1, Word::Camera)
    }

    /// Range of the word: counts of a converter, or 0 and 1.
    #[must_use]
    pub fn range(self) -> RangeInclusive<i64> {
        match self.entry().1 {
            Word::Resolver(_) => 0..=i64::from(RESOLVER_COUNTS) - 1,
            Word::GripPotentiometer
            | Word::GripStrainLeft
            | Word::GripStrainRight
            | Word::ForceX
            | Word::ForceY
            | Word::ForceZ
            | Word::Moment
            | Word::HandPotentiometer
            | Word::HandStrainLeft
            | Word::HandStrainRight
            | Word::TablePotentiometer => 0..=i64::from(ADC_FULL_SCALE),
            Word::GripperId => 0..=GREATEST_ID,
            Word::Holster(_, WHOLE) => 0..=i64::from(HOLSTER_BITS),
            Word::Resolvers
            | Word::Beam(_)
            | Word::Locked
            | Word::Unlocked
            | Word::Holster(..)
            | Word::Force
            | Word::LimitPlus
            | Word::LimitMinus
            | Word::Camera => 0..=1,
        }
    }

    /// Its present value.
    #[must_use]
    pub fn read(self, inputs: &DeviceInputs) -> i64 {
        match self.entry().1 {
            Word::Resolvers => inputs.resolvers.valid.into(),
            Word::Resolver(joint) => inputs.resolvers.counts[joint].into(),
            Word::GripPotentiometer => inputs.grip.potentiometer.into(),
            Word::GripStrainLeft => inputs.grip.strain_left.into(),
            Word::GripStrainRight => inputs.grip.strain_right.into(),
            Word::Beam(bit) => i64::from(inputs.grip.beams >> bit & 1),
            Word::Locked => inputs.quick_change.locked.into(),
            Word::Unlocked => inputs.quick_change.unlocked.into(),
            Word::GripperId => inputs.quick_change.end_effector_id.into(),
            Word::Holster(which, WHOLE) => holster(&inputs.holsters, which).into(),
            Word::Holster(which, bit) => i64::from(holster(&inputs.holsters, which) >> bit & 1),
            Word::Force => inputs.force.valid.into(),
            Word::ForceX => inputs.force.x.into(),
            Word::ForceY => inputs.force.y.into(),
            Word::ForceZ => inputs.force.z.into(),
            Word::Moment => inputs.force.moment.into(),
            Word::HandPotentiometer => inputs.pedestal.potentiometer.into(),
            Word::HandStrainLeft => inputs.pedestal.strain_left.into(),
            Word::HandStrainRight => inputs.pedestal.strain_right.into(),
            Word::TablePotentiometer => inputs.pedestal.table_potentiometer.into(),
            Word::LimitPlus => inputs.pedestal.limit_plus.into(),
            Word::LimitMinus => inputs.pedestal.limit_minus.into(),
            Word::Camera => 1,
        }
    }

    /// Set it to the nearest possible value. A resolver wraps around.
    pub fn write(self, inputs: &mut DeviceInputs, value: i64) {
        let range = self.range();
        let value = match self.entry().1 {
            Word::Resolver(_) => value.rem_euclid(range.end() + 1),
            _ => value.clamp(*range.start(), *range.end()),
        };
        let (on, byte, word) = (value != 0, value as u8, value as u16);
        match self.entry().1 {
            Word::Resolvers => inputs.resolvers.valid = on,
            Word::Resolver(joint) => inputs.resolvers.counts[joint] = value as u32,
            Word::GripPotentiometer => inputs.grip.potentiometer = word,
            Word::GripStrainLeft => inputs.grip.strain_left = word,
            Word::GripStrainRight => inputs.grip.strain_right = word,
            Word::Beam(bit) => set_bit(&mut inputs.grip.beams, bit, on),
            Word::Locked => inputs.quick_change.locked = on,
            Word::Unlocked => inputs.quick_change.unlocked = on,
            Word::GripperId => inputs.quick_change.end_effector_id = byte,
            Word::Holster(which, WHOLE) => *holster_mut(&mut inputs.holsters, which) = byte,
            Word::Holster(which, bit) => set_bit(holster_mut(&mut inputs.holsters, which), bit, on),
            Word::Force => inputs.force.valid = on,
            Word::ForceX => inputs.force.x = word,
            Word::ForceY => inputs.force.y = word,
            Word::ForceZ => inputs.force.z = word,
            Word::Moment => inputs.force.moment = word,
            Word::HandPotentiometer => inputs.pedestal.potentiometer = word,
            Word::HandStrainLeft => inputs.pedestal.strain_left = word,
            Word::HandStrainRight => inputs.pedestal.strain_right = word,
            Word::TablePotentiometer => inputs.pedestal.table_potentiometer = word,
            Word::LimitPlus => inputs.pedestal.limit_plus = on,
            Word::LimitMinus => inputs.pedestal.limit_minus = on,
            Word::Camera if !on => inputs.vision = VisionResponse::default(),
            Word::Camera => {}
        }
    }
}

const fn holster(sensors: &HolsterSensors, which: usize) -> u8 {
    match which {
        0 => sensors.right,
        1 => sensors.left,
        _ => sensors.centre,
    }
}

const fn holster_mut(sensors: &mut HolsterSensors, which: usize) -> &mut u8 {
    match which {
        0 => &mut sensors.right,
        1 => &mut sensors.left,
        _ => &mut sensors.centre,
    }
}

const fn set_bit(bits: &mut u8, bit: u8, on: bool) {
    *bits = if on { *bits | 1 << bit } else { *bits & !(1 << bit) };
}

#[cfg(test)]
mod tests {
    use super::*;

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
