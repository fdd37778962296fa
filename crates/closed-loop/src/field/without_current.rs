//! Grippers of the simulated cell while their coupler has lost its controller.
//!
//! The grippers of the AMRF keep their air then (`trapped-air`). A mapping may say that a gripper closes by a spring,
//! or that nothing holds its fingers: after the coupler's fallback, and until its release, they close or open.

use couplers::{Emulated, Report, State};
use field::{Holds, Mapping};
use interfaces::{
    DeviceOutputs,
    point::{Group, Output},
};

/// Grippers with the outputs that close and open them.
const GRIPPERS: [(Group, [&[&str]; 2]); 4] = [
    (Group::Grip, [&["grip.supply", "grip.close-coarse"], &["grip.supply", "grip.open-coarse"]]),
    (Group::V, [&["v.close"], &["v.open"]]),
    (Group::Tool, [&["tool.close"], &["tool.open"]]),
    (
        Group::Pedestal,
        [&["pedestal.supply", "pedestal.close-coarse"], &["pedestal.supply", "pedestal.open-coarse"]],
    ),
];

/// Whether a coupler's outputs are those of its fallback, or the safe ones until a release.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Power {
    fallbacks: u32, // number of fallbacks while its session was running
    is_off: bool,
}

impl Power {
    pub(super) fn note(&mut self, coupler: &Emulated, report: &Report) {
        if report.state == State::Running {
            self.fallbacks = coupler.fallbacks();
        }
        self.is_off = matches!(report.state, State::Tripped(_)) || coupler.fallbacks() != self.fallbacks;
    }
}

/// Moves the fingers of grippers without current, as their valves do.
pub(super) fn fall_back(mapping: &Mapping, power: &[Power], outputs: &mut DeviceOutputs) {
    for (group, holds) in &mapping.holds {
        let Some((_, [closing, opening])) = GRIPPERS.iter().find(|(known, _)| known == group) else {
            continue;
        };
        let device = mapping.outputs.iter().find(|point| point.is_of(*group)).map(field::OutPoint::device);
        let is_off = device.and_then(|device| power.get(device)).is_some_and(|power| power.is_off);
        let on = match holds {
            Holds::Spring => closing,
            Holds::Nothing => opening,
            Holds::TrappedAir | Holds::CheckValve | Holds::Bistable => continue,
        };
        for output in on.iter().filter(|_| is_off).filter_map(|name| Output::named(name)) {
            output.write(outputs, 1);
        }
    }
}
