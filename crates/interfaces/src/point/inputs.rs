//! The words that the controller reads.

use core::ops::RangeInclusive;

use Group::{Grip, Holsters, Joystick, Pedestal, QuickChange, Resolvers, Table, Tool, Vision};
use Kind::{Cable, Camera, Contact, Converter, Force, Knob, Number, Resolver, Supply, Switch};

use super::{
    Group,
    Word::{self, Answer, Bits, Count, Flag, Long, Short, Signed},
};
use crate::device::{ADC_FULL_SCALE, DeviceInputs, KNOB_FULL, RESOLVER_COUNTS, joystick_frame, single_step};

/// A word that the controller reads.
#[derive(Clone, Copy, Debug)]
pub struct Input(&'static Row);

/// Origin of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Resolver of a joint; wraps around.
    Resolver,
    /// Potentiometer or strain gage on a 12-bit converter.
    Converter,
    /// Axis of the force sensor, on a 12-bit converter.
    Force,
    /// Proximity, reflectance or limit switch, light beam.
    Switch,
    /// Push-button, switch of a panel, id pin.
    Contact,
    /// Potentiometer of the joystick box.
    Knob,
    /// A number from another controller.
    Number,
    /// Power of several sensors.
    Supply,
    /// Cable of several sensors. It is a name for faults, not a separate point.
    Cable,
    /// The vision system, which answers in messages. A fault can only switch it off.
    Camera,
}

/// Name, group, kind, values and word.
type Row = (&'static str, Group, Kind, RangeInclusive<i64>, fn(&mut DeviceInputs) -> Word<'_>);

const BIT: RangeInclusive<i64> = 0..=1;
#[expect(clippy::as_conversions, reason = "widens, in a constant")]
const FULL: RangeInclusive<i64> = 0..=ADC_FULL_SCALE as i64;
#[expect(clippy::as_conversions, reason = "widens, in a constant")]
const TURN: RangeInclusive<i64> = 0..=RESOLVER_COUNTS as i64 - 1;
#[expect(clippy::as_conversions, reason = "widens, in a constant")]
const KNOB: RangeInclusive<i64> = 0..=KNOB_FULL as i64;
#[expect(clippy::as_conversions, reason = "widens, in a constant")]
const STICK: RangeInclusive<i64> = -(KNOB_FULL as i64)..=KNOB_FULL as i64;
const COUNT: RangeInclusive<i64> = -0x8000_0000..=0x7FFF_FFFF;
const NUMBER: RangeInclusive<i64> = 0..=0xFFFF_FFFF; // of an order
/// `endeff-id#` that two id pins can show.
const ID: RangeInclusive<i64> = 0..=3;
/// The four sensors of a holster together.
const HOLSTER: RangeInclusive<i64> = 0..=0x0F;
const ALL: u8 = u8::MAX;

static INPUTS: [Row; 76] = [
    ("resolvers", Resolvers, Supply, BIT, |d| Flag(&mut d.resolvers.valid)),
    ("resolver.base", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[0])),
    ("resolver.shoulder", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[1])),
    ("resolver.elbow", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[2])),
    ("resolver.pitch", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[3])),
    ("resolver.yaw", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[4])),
    ("resolver.roll", Resolvers, Resolver, TURN, |d| Long(&mut d.resolvers.counts[5])),
    ("grip.potentiometer", Grip, Converter, FULL, |d| Short(&mut d.grip.potentiometer)),
    ("grip.strain-left", Grip, Converter, FULL, |d| Short(&mut d.grip.strain_left)),
    ("grip.strain-right", Grip, Converter, FULL, |d| Short(&mut d.grip.strain_right)),
    ("beam.1", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x01)),
    ("beam.2", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x02)),
    ("beam.3", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x04)),
    ("beam.4", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x08)),
    ("beam.5", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x10)),
    ("beam.6", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x20)),
    ("beam.7", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x40)),
    ("beam.8", Grip, Switch, BIT, |d| Bits(&mut d.grip.beams, 0x80)),
    ("quick-change.locked", QuickChange, Switch, BIT, |d| Flag(&mut d.quick_change.locked)),
    ("quick-change.unlocked", QuickChange, Switch, BIT, |d| Flag(&mut d.quick_change.unlocked)),
    ("quick-change.id", QuickChange, Cable, ID, |d| Bits(&mut d.quick_change.end_effector_id, ALL)),
    ("quick-change.id.0", QuickChange, Contact, BIT, |d| Bits(&mut d.quick_change.end_effector_id, 0x01)),
    ("quick-change.id.1", QuickChange, Contact, BIT, |d| Bits(&mut d.quick_change.end_effector_id, 0x02)),
    ("holster.right", Holsters, Cable, HOLSTER, |d| Bits(&mut d.holsters.right, ALL)),
    ("holster.right.large-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.right, 0x01)),
    ("holster.right.large-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.right, 0x02)),
    ("holster.right.small-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.right, 0x04)),
    ("holster.right.small-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.right, 0x08)),
    ("holster.left", Holsters, Cable, HOLSTER, |d| Bits(&mut d.holsters.left, ALL)),
    ("holster.left.large-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.left, 0x01)),
    ("holster.left.large-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.left, 0x02)),
    ("holster.left.small-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.left, 0x04)),
    ("holster.left.small-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.left, 0x08)),
    ("holster.centre", Holsters, Cable, HOLSTER, |d| Bits(&mut d.holsters.centre, ALL)),
    ("holster.centre.large-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.centre, 0x01)),
    ("holster.centre.large-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.centre, 0x02)),
    ("holster.centre.small-1", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.centre, 0x04)),
    ("holster.centre.small-2", Holsters, Switch, BIT, |d| Bits(&mut d.holsters.centre, 0x08)),
    ("force", Tool, Supply, BIT, |d| Flag(&mut d.force.valid)),
    ("force.x", Tool, Force, FULL, |d| Short(&mut d.force.x)),
    ("force.y", Tool, Force, FULL, |d| Short(&mut d.force.y)),
    ("force.z", Tool, Force, FULL, |d| Short(&mut d.force.z)),
    ("force.moment", Tool, Force, FULL, |d| Short(&mut d.force.moment)),
    ("joystick.velocity", Joystick, Knob, KNOB, |d| Short(&mut d.joystick.velocity)),
    ("joystick.x", Joystick, Knob, STICK, |d| Signed(&mut d.joystick.x)),
    ("joystick.y", Joystick, Knob, STICK, |d| Signed(&mut d.joystick.y)),
    ("joystick.up", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.up)),
    ("joystick.down", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.down)),
    ("joystick.roll-plus", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.roll_plus)),
    ("joystick.roll-minus", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.roll_minus)),
    ("joystick.open", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.open)),
    ("joystick.close", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.close)),
    ("joystick.frame.world", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.frame, joystick_frame::WORLD)),
    ("joystick.frame.tool", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.frame, joystick_frame::TOOL)),
    ("joystick.frame.tool-origin", Joystick, Contact, BIT, |d| {
        Bits(&mut d.joystick.frame, joystick_frame::TOOL_ORIGIN)
    }),
    ("joystick.frame.wrist-origin", Joystick, Contact, BIT, |d| {
        Bits(&mut d.joystick.frame, joystick_frame::WRIST_ORIGIN)
    }),
    ("joystick.record", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.record)),
    ("joystick.resume", Joystick, Contact, BIT, |d| Flag(&mut d.joystick.resume)),
    ("joystick.hold.task", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.hold, single_step::TASK)),
    ("joystick.hold.subtask", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.hold, single_step::SUBTASK)),
    ("joystick.hold.e-move", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.hold, single_step::EMOVE)),
    ("joystick.hold.prim", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.hold, single_step::PRIM)),
    ("joystick.step.task", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.single_step, single_step::TASK)),
    ("joystick.step.subtask", Joystick, Contact, BIT, |d| {
        Bits(&mut d.joystick.single_step, single_step::SUBTASK)
    }),
    ("joystick.step.e-move", Joystick, Contact, BIT, |d| {
        Bits(&mut d.joystick.single_step, single_step::EMOVE)
    }),
    ("joystick.step.prim", Joystick, Contact, BIT, |d| Bits(&mut d.joystick.single_step, single_step::PRIM)),
    ("pedestal.potentiometer", Pedestal, Converter, FULL, |d| Short(&mut d.pedestal.potentiometer)),
    ("pedestal.strain-left", Pedestal, Converter, FULL, |d| Short(&mut d.pedestal.strain_left)),
    ("pedestal.strain-right", Pedestal, Converter, FULL, |d| Short(&mut d.pedestal.strain_right)),
    ("table.potentiometer", Table, Converter, FULL, |d| Short(&mut d.pedestal.table_potentiometer)),
    ("table.limit-plus", Table, Switch, BIT, |d| Flag(&mut d.pedestal.limit_plus)),
    ("table.limit-minus", Table, Switch, BIT, |d| Flag(&mut d.pedestal.limit_minus)),
    ("table.echo", Table, Number, NUMBER, |d| Long(&mut d.pedestal.motor_echo)),
    ("table.moving", Table, Number, BIT, |d| Flag(&mut d.pedestal.motor_moving)),
    ("table.counter", Table, Number, COUNT, |d| Count(&mut d.pedestal.motor_counter)),
    ("camera", Vision, Camera, BIT, |d| Answer(&mut d.vision)),
];

impl Input {
    /// The input of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|input| input.name() == name)
    }

    /// All inputs.
    pub fn all() -> impl Iterator<Item = Self> {
        INPUTS.iter().map(Self)
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.0.0
    }

    /// The group of its devices.
    #[must_use]
    pub const fn group(self) -> Group {
        self.0.1
    }

    /// Its origin.
    #[must_use]
    pub const fn kind(self) -> Kind {
        self.0.2
    }

    /// True for the vision system.
    #[must_use]
    pub const fn is_camera(self) -> bool {
        matches!(self.kind(), Camera)
    }

    /// Permitted values.
    #[must_use]
    pub const fn range(self) -> RangeInclusive<i64> {
        RangeInclusive::new(*self.0.3.start(), *self.0.3.end())
    }

    /// Its present value.
    #[must_use]
    pub fn read(self, inputs: &DeviceInputs) -> i64 {
        let mut copy = *inputs;
        (self.0.4)(&mut copy).read()
    }

    /// Set it to the nearest permitted value. A resolver wraps around.
    pub fn write(self, inputs: &mut DeviceInputs, value: i64) {
        let range = self.range();
        let value = match self.kind() {
            Resolver => value.checked_rem_euclid(i64::from(RESOLVER_COUNTS)).unwrap_or(0),
            _ => value.clamp(*range.start(), *range.end()),
        };
        (self.0.4)(inputs).write(value);
    }
}

impl PartialEq for Input {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.0, other.0)
    }
}

impl Eq for Input {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::VisionResponse;

    #[test]
    fn every_input_has_its_own_word() {
        for input in Input::all() {
            assert_eq!(Input::named(input.name()), Some(input));
            if input.is_camera() {
                continue;
            }
            let mut inputs = DeviceInputs::default();
            let most = *input.range().end();
            input.write(&mut inputs, most);
            assert_eq!(input.read(&inputs), most, "{}", input.name());
            let others = Input::all().filter(|other| *other != input && !other.is_camera());
            let shown = others.filter(|other| other.read(&inputs) != 0);
            for other in shown {
                let shared = input.name().starts_with(other.name()) || other.name().starts_with(input.name());
                let cable = [input.kind(), other.kind()].contains(&Cable);
                assert!(shared && cable, "{} also shows in {}", input.name(), other.name());
            }
            input.write(&mut inputs, 0);
            assert_eq!(inputs, DeviceInputs::default(), "{}", input.name());
        }
        assert_eq!(Input::named("grip.strain"), None);
    }

    #[test]
    fn converters_saturate_and_resolvers_wrap_around() {
        let mut inputs = DeviceInputs::default();
        let (gage, resolver) = (Input::named("grip.strain-left"), Input::named("resolver.roll"));
        let (gage, resolver, stick) = (gage.unwrap(), resolver.unwrap(), Input::named("joystick.x").unwrap());
        gage.write(&mut inputs, 9_999);
        assert_eq!(inputs.grip.strain_left, ADC_FULL_SCALE);
        gage.write(&mut inputs, -5);
        assert_eq!(inputs.grip.strain_left, 0);
        resolver.write(&mut inputs, -1);
        assert_eq!(inputs.resolvers.counts[5], RESOLVER_COUNTS - 1);
        stick.write(&mut inputs, -5_000);
        assert_eq!(inputs.joystick.x, -1000);
    }

    #[test]
    fn switched_off_camera_does_not_answer() {
        let mut inputs = DeviceInputs::default();
        inputs.vision.echo = 7;
        let camera = Input::named("camera").unwrap();
        camera.write(&mut inputs, 1);
        assert_eq!(inputs.vision.echo, 7);
        camera.write(&mut inputs, 0);
        assert_eq!(inputs.vision, VisionResponse::default());
    }
}
