//! Lines of a job that devices of the workstation execute, if the mapping has them, and the simulated devices behind
//! the emulated couplers.
//!
//! ```text
//!   `** vise close PFIXTURE` ──► field::Lines ──outputs──► couplers ──► plant's Devices ──► vise of the cell
//!                                          ◄───inputs───          ◄──            ◄──
//! ```

use std::sync::Arc;

use field::{Failure, Lines, Mapping, Presence, Seen, Sequence, Setting, outputs_after};
use interfaces::{point::Group, station::ViseOpening};
use plant::{
    CellDescription,
    devices::{DeviceError, Devices, Programs},
};
use taskdata::load::job::{Drum, Workstation as Action};

/// Omits the place of a part in a tray, which vision determines. `None` if no device executes the line.
#[must_use]
pub fn device_line(action: &Action) -> Option<String> {
    Some(match action {
        Action::Tray { location, object, .. } => {
            format!("tray {} {} {object}", location.name, location.sector.unwrap_or_default())
        }
        Action::Vise { opening, location, program } => {
            let opening = match opening {
                ViseOpening::Partial => "partial",
                ViseOpening::Close => "close",
                ViseOpening::Open => "open",
            };
            let line = format!("vise {opening} {}", location.name);
            program.map_or(line.clone(), |program| format!("{line} {program}"))
        }
        Action::Machine { blank, part, location } => format!("machine {blank} {part} {}", location.name),
        Action::Drum(Drum::Grip) => "drum grip".to_owned(),
        Action::Drum(Drum::Release) => "drum release".to_owned(),
        Action::Drum(Drum::Tool(tool)) => format!("drum tool {tool}"),
        Action::Joystick(_)
        | Action::Press(_)
        | Action::Release(_)
        | Action::Panel(_)
        | Action::Table(_)
        | Action::Resolvers(_)
        | Action::Load { .. }
        | Action::Wait { .. }
        | Action::HandOver => return None,
    })
}

#[must_use]
pub const fn group(action: &Action) -> Option<Group> {
    match action {
        Action::Tray { .. } => Some(Group::Trays),
        Action::Vise { .. } => Some(Group::Vise),
        Action::Machine { .. } => Some(Group::Machine),
        Action::Drum(_) => Some(Group::Drum),
        Action::Joystick(_) => Some(Group::Joystick),
        Action::Table(_) => Some(Group::Table),
        Action::Resolvers(_) => Some(Group::Resolvers),
        Action::Press(_)
        | Action::Release(_)
        | Action::Panel(_)
        | Action::Load { .. }
        | Action::Wait { .. }
        | Action::HandOver => None,
    }
}

/// Why a mapping cannot execute an action of a job; `None` if it can, or if the cell executes it.
#[must_use]
pub fn refusal(mapping: &Mapping, action: &Action) -> Option<String> {
    let group = group(action)?;
    match mapping.presence(group) {
        Presence::Simulated => None,
        Presence::Absent => Some(format!("the mapping says that there is no {}", group.name())),
        Presence::Mapped | Presence::Fixed => {
            let Some(line) = device_line(action) else {
                return Some(format!("{} is a real device: operate it by hand", group.name()));
            };
            let has_entry = mapping.lines.iter().any(|sequence| sequence.line == line);
            (!has_entry).then(|| format!("the mapping has no [[line]] with line = \"{line}\""))
        }
    }
}

/// The entry of an action that devices behind couplers execute; `None` if the cell executes it.
#[must_use]
pub fn sequence<'m>(mapping: &'m Mapping, action: &Action) -> Option<&'m Sequence> {
    group(action).filter(|group| mapping.presence(*group) != Presence::Simulated)?;
    let line = device_line(action)?;
    mapping.lines.iter().find(|sequence| sequence.line == line)
}

/// The values that the outputs of the workstation may have after these actions and during the present one.
#[must_use]
pub fn outputs_of<'a>(
    mapping: &Mapping,
    actions: impl IntoIterator<Item = &'a Action>,
    present: Option<&Action>,
) -> Vec<Vec<i64>> {
    let line = |action: &Action| sequence(mapping, action).map(|sequence| sequence.line.as_str());
    outputs_after(mapping, actions.into_iter().filter_map(line), present.and_then(line))
}

#[must_use]
pub fn programs(mapping: &Mapping) -> Programs {
    let mut programs = Programs::default();
    for Sequence { line, sets, .. } in &mapping.lines {
        let number = |name: &str| {
            let named = |setting: &&Setting| {
                mapping.outputs.get(setting.output).is_some_and(|point| point.name == name)
            };
            sets.iter().find(named).map(|setting| setting.value).filter(|value| *value != 0)
        };
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["vise", _, location, program] => {
                let number = number(&format!("vise.{location}.program"));
                programs.vise.extend(number.map(|number| (number, program.to_owned())));
            }
            ["machine", blank, part, location] => {
                let number = number(&format!("machine.{location}.program"));
                let words = [location, blank, part].map(str::to_owned);
                programs.machine.extend(number.map(|number| (number, words)));
            }
            ["drum", "tool", tool] => {
                programs.drum.extend(number("drum.tool").map(|number| (number, tool.to_owned())));
            }
            _ => {}
        }
    }
    programs
}

/// Fails for a point or a program of a device that the cell does not have.
pub fn simulated(mapping: &Mapping, cell: &CellDescription) -> Result<Devices, DeviceError> {
    let outputs = mapping.outputs.iter().map(|point| point.name.as_str());
    let inputs = mapping.inputs.iter().map(|point| point.name.as_str());
    Devices::new(cell, programs(mapping), outputs, inputs)
}

#[derive(Clone, Debug)]
pub struct StationLines {
    mapping: Arc<Mapping>,
    lines: Lines,
    asked: bool, // line whose request to the operator was reported
}

impl StationLines {
    #[must_use]
    pub fn new(mapping: Arc<Mapping>) -> Self {
        let lines = Lines::new(&mapping);
        Self { mapping, lines, asked: false }
    }

    /// True if the devices of an action are behind couplers: the cell does not execute it.
    #[must_use]
    pub fn executes(&self, action: &Action) -> bool {
        group(action).is_some_and(|group| self.mapping.presence(group) != Presence::Simulated)
    }

    pub fn begin(&mut self, action: &Action) -> Result<(), String> {
        if let Some(refusal) = refusal(&self.mapping, action) {
            return Err(refusal);
        }
        let line = device_line(action).unwrap_or_default();
        self.asked = false;
        self.lines.begin(&self.mapping, &line).map_err(|failure| failure.to_string())
    }

    pub fn step(&mut self, devices: &[Seen]) {
        self.lines.step(&self.mapping, devices);
    }

    /// Takes over the value of an output that an earlier run has set.
    pub fn adopt(&mut self, output: usize, value: i64) {
        self.lines.adopt(output, value);
    }

    /// One value for each output of the mapping: see [`Mapping::collect_station`].
    #[must_use]
    pub fn outputs(&self) -> &[i64] {
        self.lines.outputs()
    }

    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.lines.is_busy()
    }

    #[must_use]
    pub const fn failure(&self) -> Option<&Failure> {
        self.lines.failure()
    }

    /// The request to the operator, once per line.
    pub fn news(&mut self) -> Option<String> {
        let asks = self.lines.asks(&self.mapping)?;
        (!std::mem::replace(&mut self.asked, true)).then(|| asks.to_owned())
    }
}
