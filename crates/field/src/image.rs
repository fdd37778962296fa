//! Converts between the records of the controller and the words of the devices.

use couplers::{InWords, OutWords};
use interfaces::{
    device::{DeviceInputs, DeviceOutputs, FieldHealth, GroupHealth},
    point::{Group, Input},
};

use crate::{
    mapping::{InPoint, Mapping, Origin, OutPoint, Slot, Target},
    scale::Format,
};

#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub words: InWords,      // the words that were read last
    pub age_ms: Option<u32>, // their age, ms; `None` if none were read yet
    pub is_tripped: bool,    // its outputs are safe until an operator releases them
}

impl Seen {
    fn connection(&self, stale_ms: u16) -> GroupHealth {
        match self.age_ms {
            Some(age) if age <= u32::from(stale_ms) => {
                if self.is_tripped {
                    GroupHealth::Tripped
                } else {
                    GroupHealth::Fresh
                }
            }
            Some(age) if age <= LOST_MS => GroupHealth::Stale,
            Some(_) | None => GroupHealth::Lost,
        }
    }
}

pub const SAFETY: &str = "safety.ok";

pub const LOST_MS: u32 = 1000; // age after which a device is lost, ms: 25 ticks

impl Mapping {
    /// Converts the words of the devices, in their order, to inputs of the controller. The inputs of a device that does
    /// not answer keep their last values, except those with `then`. While any device is not fresh, the velocity knob is
    /// at 0 and the robot ramps to rest.
    pub fn apply(&self, devices: &[Seen], inputs: &mut DeviceInputs) {
        let mut health = FieldHealth::default();
        // The id pins come first, because the line of the potentiometer depends on the gripper.
        for point in self.inputs.iter().filter(|point| point.group == Group::QuickChange) {
            point.apply(devices, inputs, &mut health);
        }
        for point in self.inputs.iter().filter(|point| point.group != Group::QuickChange) {
            point.apply(devices, inputs, &mut health);
        }
        for (seen, device) in devices.iter().zip(&self.devices) {
            // A device without inputs is monitored by its answers.
            let stale_ms = device.plan.stale_ms.min(u16::MAX - 1);
            health.any = health.any.max(seen.connection(stale_ms));
        }
        if health.resolvers.is_old() {
            inputs.resolvers.valid = false;
        }
        if health.any != GroupHealth::Fresh {
            inputs.joystick.velocity = 0;
        }
        inputs.field = health;
    }

    /// Outputs of the workstation get their safe value; [`collect_station`](Self::collect_station) writes them.
    pub fn collect(&self, outputs: &DeviceOutputs, images: &mut [OutWords]) {
        for point in &self.outputs {
            let Some(image) = images.get_mut(point.slot.device) else { continue };
            let value = match point.target {
                Target::Word(output) => output.read(outputs),
                Target::Station => point.safe,
            };
            point.slot.put(&mut image.words, value);
        }
    }

    /// The inverse of [`collect`](Self::collect): converts the words of the devices to the states of the valves.
    pub fn spread(&self, images: &[OutWords], outputs: &mut DeviceOutputs) {
        for point in &self.outputs {
            if let (Target::Word(output), Some(image)) = (point.target, images.get(point.slot.device)) {
                output.write(outputs, point.slot.get(&image.words));
            }
        }
    }

    /// The inverse of [`apply`](Self::apply): converts the states of the sensors to the words of the devices.
    pub fn sample(&self, inputs: &DeviceInputs, images: &mut [InWords]) {
        let gripper = inputs.quick_change.end_effector_id;
        for point in &self.inputs {
            let (Target::Word(input), Origin::Slot(slot)) = (point.target, point.from) else { continue };
            let Some(image) = images.get_mut(slot.device) else { continue };
            let counts = input.read(inputs);
            let raw = point.line_of(gripper).map_or(counts, |line| line.raw(counts));
            slot.put(&mut image.words, raw);
        }
    }

    /// Converts outputs of the workstation. `values` has one for each output of the mapping; other outputs are ignored.
    pub fn collect_station(&self, values: &[i64], images: &mut [OutWords]) {
        for (point, value) in self.outputs.iter().zip(values).filter(|(point, _)| point.is_station()) {
            if let Some(image) = images.get_mut(point.slot.device) {
                point.slot.put(&mut image.words, *value);
            }
        }
    }

    /// The inverse of [`collect_station`](Self::collect_station).
    pub fn spread_station(&self, images: &[OutWords], values: &mut [i64]) {
        for (point, value) in self.outputs.iter().zip(values).filter(|(point, _)| point.is_station()) {
            if let Some(image) = images.get(point.slot.device) {
                *value = point.slot.get(&image.words);
            }
        }
    }

    /// Converts inputs of the workstation. `values` has one for each input of the mapping.
    pub fn sample_station(&self, values: &[i64], images: &mut [InWords]) {
        for (point, value) in self.inputs.iter().zip(values).filter(|(point, _)| point.is_station()) {
            if let Origin::Slot(slot) = point.from
                && let Some(image) = images.get_mut(slot.device)
            {
                slot.put(&mut image.words, *value);
            }
        }
    }

    /// The value of an input of the workstation; `None` while it is older than its `stale_ms`.
    #[must_use]
    pub fn station_value(&self, input: usize, devices: &[Seen]) -> Option<i64> {
        let point = self.inputs.get(input)?;
        match point.from {
            Origin::Fixed(value) => Some(value),
            Origin::Slot(slot) => {
                let seen = devices.get(slot.device)?;
                let is_old = seen.connection(point.stale_ms).is_old();
                if is_old { point.then } else { Some(slot.get(&seen.words.words)) }
            }
        }
    }

    /// True if `safety.ok` is mapped and off. A late input does not open the circuit: its device trips if it is lost.
    #[must_use]
    pub fn is_safety_open(&self, devices: &[Seen]) -> bool {
        let point = self.inputs.iter().find(|point| point.name == SAFETY);
        point.is_some_and(|point| {
            let seen = point.device().and_then(|device| devices.get(device));
            let fresh = seen.filter(|seen| !seen.connection(point.stale_ms).is_old());
            match point.from {
                Origin::Fixed(value) => value == 0,
                Origin::Slot(slot) => fresh.is_some_and(|seen| slot.get(&seen.words.words) == 0),
            }
        })
    }

    /// The outputs of a device that are not safe in its image.
    pub fn outputs_not_safe<'m>(
        &'m self,
        device: usize,
        image: &'m OutWords,
    ) -> impl Iterator<Item = &'m OutPoint> {
        let is_on = move |point: &&OutPoint| point.device() == device && point.get(image) != point.safe;
        self.outputs.iter().filter(is_on)
    }

    /// The outputs of a device that are not safe in its image and may not be on while nothing moves.
    pub fn outputs_on<'m>(
        &'m self,
        device: usize,
        image: &'m OutWords,
    ) -> impl Iterator<Item = &'m OutPoint> {
        self.outputs_not_safe(device, image).filter(|point| !point.rest)
    }
}

impl InPoint {
    fn apply(&self, devices: &[Seen], inputs: &mut DeviceInputs, health: &mut FieldHealth) {
        let (connection, raw) = match self.from {
            Origin::Fixed(value) => (GroupHealth::Fresh, value),
            Origin::Slot(slot) => {
                let Some(seen) = devices.get(slot.device) else { return };
                (seen.connection(self.stale_ms), slot.get(&seen.words.words))
            }
        };
        self.note(connection, health);
        let Target::Word(input) = self.target else { return };
        let value = match (self.then, self.from) {
            (Some(then), _) if connection.is_old() => then,
            (_, Origin::Fixed(value)) => value,
            _ => self.value(input, raw, inputs.quick_change.end_effector_id),
        };
        input.write(inputs, value);
    }

    fn value(&self, input: Input, raw: i64, gripper: u8) -> i64 {
        let range = input.range();
        let value = self.line_of(gripper).map_or(raw, |line| line.counts(raw, self.ends()));
        value.clamp(*range.start(), *range.end())
    }

    fn line_of(&self, gripper: u8) -> Option<crate::scale::Line> {
        let own = usize::from(gripper).checked_sub(1).and_then(|index| *self.by_gripper.get(index)?);
        own.or(self.line)
    }

    /// The age of a group is that of its oldest point.
    fn note(&self, connection: GroupHealth, health: &mut FieldHealth) {
        health.any = health.any.max(connection);
        let group = match self.group {
            Group::Grip => &mut health.grip,
            Group::Tool => &mut health.force,
            Group::QuickChange => &mut health.quick_change,
            Group::Holsters => &mut health.holsters,
            Group::Joystick => &mut health.joystick,
            Group::Pedestal => &mut health.hand,
            Group::Table => &mut health.table,
            Group::Resolvers => &mut health.resolvers,
            Group::V
            | Group::Vision
            | Group::Vise
            | Group::Machine
            | Group::Drum
            | Group::Trays
            | Group::Supply => return,
        };
        *group = (*group).max(connection);
    }
}

impl Slot {
    pub(crate) fn get(&self, image: &[u16]) -> i64 {
        let word = |offset: usize| image.get(self.word + offset).copied().unwrap_or_default();
        let wide = || {
            let (high, low) = if self.low_first { (word(1), word(0)) } else { (word(0), word(1)) };
            u32::from(high) << 16 | u32::from(low)
        };
        match (self.format, self.bit) {
            (Format::Bit, bit) => (word(0) >> bit.unwrap_or(0) & 1 == 1) as i64 ^ i64::from(self.invert),
            (Format::U16, _) => word(0).into(),
            (Format::I16, _) => word(0).cast_signed().into(),
            (Format::U32, _) => wide().into(),
            (Format::I32, _) => wide().cast_signed().into(),
        }
    }

    pub(crate) fn put(&self, image: &mut [u16], value: i64) {
        let range = self.format.range();
        let value = value.clamp(*range.start(), *range.end());
        if self.format == Format::Bit {
            let mask = 1 << self.bit.unwrap_or(0);
            let on = (value != 0) != self.invert;
            if let Some(word) = image.get_mut(self.word) {
                *word = *word & !mask | if on { mask } else { 0 };
            }
            return;
        }
        let [.., high, low] = be_words(value);
        let words = match (self.format.registers(), self.low_first) {
            (1, _) => [low, 0],
            (_, true) => [low, high],
            (_, false) => [high, low],
        };
        let there = image.iter_mut().skip(self.word).take(self.format.registers().into());
        there.zip(words).for_each(|(word, value)| *word = value);
    }

    pub(crate) fn mark(&self, image: &mut [u16]) {
        let mask = self.bit.map_or(u16::MAX, |bit| 1 << bit);
        let there = image.iter_mut().skip(self.word).take(self.format.registers().into());
        there.for_each(|word| *word |= mask);
    }
}

/// The words of a number, the highest first.
const fn be_words(value: i64) -> [u16; 4] {
    let [a, b, c, d, e, f, g, h] = value.to_be_bytes();
    [
        u16::from_be_bytes([a, b]),
        u16::from_be_bytes([c, d]),
        u16::from_be_bytes([e, f]),
        u16::from_be_bytes([g, h]),
    ]
}

#[cfg(test)]
mod tests;
