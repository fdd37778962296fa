//! Dead time: words that arrive some ticks late.

use std::collections::VecDeque;

use interfaces::{
    device::DeviceInputs,
    point::{Input, Kind},
};
use serde::{Deserialize, Serialize};

use crate::description::SensorModels;

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct DelayLine(VecDeque<i64>);

impl DelayLine {
    /// Append a word, and return the word from `ticks` ago, or the oldest one while the line fills.
    pub fn pass(&mut self, word: i64, ticks: u16) -> i64 {
        self.0.push_back(word);
        if self.0.len() > usize::from(ticks) + 1 {
            self.0.pop_front();
        }
        self.0.front().copied().unwrap_or(word)
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }
}

#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct DeadTimes(Vec<Late>);

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Late {
    #[serde(with = "crate::named")]
    sensor: Input,
    ticks: u16,
    line: DelayLine,
}

impl DeadTimes {
    #[must_use]
    pub fn new(models: &SensorModels) -> Self {
        let ticks = |sensor: Input| match sensor.kind() {
            Kind::Resolver => models.resolver_delay,
            Kind::Converter => models.converter_delay,
            Kind::Force => models.force_delay,
            Kind::Switch => models.switch_delay,
            Kind::Contact | Kind::Knob | Kind::Number | Kind::Supply | Kind::Cable | Kind::Camera => 0,
        };
        let late =
            Input::all().map(|sensor| Late { sensor, ticks: ticks(sensor), line: DelayLine::default() });
        Self(late.filter(|late| late.ticks > 0).collect())
    }

    pub fn hold_back(&mut self, inputs: &mut DeviceInputs) {
        for Late { sensor, ticks, line } in &mut self.0 {
            let word = line.pass(sensor.read(inputs), *ticks);
            sensor.write(inputs, word);
        }
    }

    /// Keeps the words that were shown last: time advances only in [`Self::hold_back`].
    pub fn keep(&self, last: &DeviceInputs, inputs: &mut DeviceInputs) {
        for Late { sensor, .. } in &self.0 {
            sensor.write(inputs, sensor.read(last));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delayed_words_are_unchanged() {
        let mut line = DelayLine::default();
        assert_eq!([1, 2, 3, 4, 5].map(|word| line.pass(word, 2)), [1, 1, 1, 2, 3]);
        let mut none = DelayLine::default();
        assert_eq!([1, 2, 3].map(|word| none.pass(word, 0)), [1, 2, 3]);
    }

    #[test]
    fn only_the_sensors_of_a_group_are_late() {
        let models = SensorModels { force_delay: 1, ..SensorModels::default() };
        let mut delays = DeadTimes::new(&models);
        assert_eq!(delays.0.len(), 4, "the four axes");
        let shown = [100, 200].map(|x| {
            let mut inputs = DeviceInputs::default();
            (inputs.force.x, inputs.grip.potentiometer) = (x, x);
            delays.hold_back(&mut inputs);
            (inputs.force.x, inputs.grip.potentiometer)
        });
        assert_eq!(shown, [(100, 100), (100, 200)]);
    }
}
