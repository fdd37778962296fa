//! Points: the words of the devices by name, each as a number.
//!
//! One list serves faults, the mapping of real devices, screens and logs. An [`Input`] is a word of
//! [`DeviceInputs`](super::DeviceInputs), an [`Output`] one of [`DeviceOutputs`](super::DeviceOutputs), a [`Station`]
//! one of the workstation's devices. A name denotes a *connection* at the controller's boards (chapter III): the three
//! grippers share that of the potentiometer (III.3.7).

mod inputs;
mod outputs;
mod station;
mod word;

use core::ops::RangeInclusive;

pub use self::{
    inputs::{Input, Kind},
    outputs::Output,
    station::Station,
};
use word::Word;

/// Devices that are simulated, or connected, together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Parts gripper, and the potentiometer that all grippers share.
    Grip,
    /// v-gripper.
    V,
    /// Tool gripper with its force sensor.
    Tool,
    /// Quick change.
    QuickChange,
    /// Holsters.
    Holsters,
    /// Joystick box.
    Joystick,
    /// Hand of the Active Pedestal.
    Pedestal,
    /// Rotary table of the Active Pedestal.
    Table,
    /// Joint resolvers.
    Resolvers,
    /// Vision system.
    Vision,
    /// Vises of the workstation.
    Vise,
    /// Machine tools of the workstation.
    Machine,
    /// Tool drum.
    Drum,
    /// Presence sensors of the trays.
    Trays,
    /// Air supply and safety circuit.
    Supply,
}

impl Group {
    /// All groups.
    pub const ALL: [Self; 15] = [
        Self::Grip,
        Self::V,
        Self::Tool,
        Self::QuickChange,
        Self::Holsters,
        Self::Joystick,
        Self::Pedestal,
        Self::Table,
        Self::Resolvers,
        Self::Vision,
        Self::Vise,
        Self::Machine,
        Self::Drum,
        Self::Trays,
        Self::Supply,
    ];

    /// Its name in files and messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Grip => "grip",
            Self::V => "v",
            Self::Tool => "tool",
            Self::QuickChange => "quick-change",
            Self::Holsters => "holsters",
            Self::Joystick => "joystick",
            Self::Pedestal => "pedestal",
            Self::Table => "table",
            Self::Resolvers => "resolvers",
            Self::Vision => "vision",
            Self::Vise => "vise",
            Self::Machine => "machine",
            Self::Drum => "drum",
            Self::Trays => "trays",
            Self::Supply => "supply",
        }
    }

    /// The group of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|group| group.name() == name)
    }
}

/// A point of either direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Point<'n> {
    /// A word that the controller reads.
    Input(Input),
    /// A word that the controller writes.
    Output(Output),
    /// A word of a device of the workstation.
    Station(Station<'n>),
}

impl<'n> Point<'n> {
    /// The point of a name that the controller, or the workstation, reads.
    #[must_use]
    pub fn read(name: &'n str) -> Option<Self> {
        let station = || Station::read(name).map(Self::Station);
        Input::named(name).map(Self::Input).or_else(station)
    }

    /// The point of a name that the controller, or the workstation, writes.
    #[must_use]
    pub fn written(name: &'n str) -> Option<Self> {
        let station = || Station::written(name).map(Self::Station);
        Output::named(name).map(Self::Output).or_else(station)
    }

    /// The group of its devices.
    #[must_use]
    pub const fn group(&self) -> Group {
        match self {
            Self::Input(input) => input.group(),
            Self::Output(output) => output.group(),
            Self::Station(station) => station.group(),
        }
    }

    /// Permitted values.
    #[must_use]
    pub const fn range(&self) -> RangeInclusive<i64> {
        match self {
            Self::Input(input) => input.range(),
            Self::Output(output) => output.range(),
            Self::Station(station) => station.range(),
        }
    }

    /// True if the permitted values are 0 and 1.
    #[must_use]
    pub const fn is_bit(&self) -> bool {
        let range = self.range();
        *range.start() == 0 && *range.end() == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_names_are_unique() {
        for group in Group::ALL {
            assert_eq!(Group::named(group.name()), Some(group));
        }
        assert_eq!(Group::named("hand"), None);
    }

    #[test]
    fn points_are_found_by_direction() {
        assert!(matches!(Point::read("grip.potentiometer"), Some(Point::Input(_))));
        assert!(matches!(Point::read("vise.PFIXTURE.clamped"), Some(Point::Station(_))));
        assert!(matches!(Point::written("tool.close"), Some(Point::Output(_))));
        assert!(matches!(Point::written("vise.PFIXTURE.open"), Some(Point::Station(_))));
        assert_eq!(Point::written("grip.potentiometer"), None);
        assert_eq!(Point::read("vise.PFIXTURE.open"), None);
        let bit = |name| Point::read(name).is_some_and(|point| point.is_bit());
        assert!(bit("beam.1") && bit("safety.ok") && !bit("joystick.x") && !bit("drum.tool"));
    }
}
