//! Field I/O of a run: the mapping, and the run's messages about it.

use std::path::Path;

use diagnostics::{FIELDS, Source};
use field::{Mapping, Presence};
use interfaces::point::Group;
use os_io::files;
use plant::fault::{FaultPlan, What};

use crate::{config::FieldConfig, error::StartError};

/// Groups that a mapping can have, but that this version executes only in the simulated cell.
const ONLY_SIMULATED: [Group; 5] = [Group::Vise, Group::Machine, Group::Drum, Group::Trays, Group::Supply];

/// Reads the mapping of a run.
///
/// # Errors
/// [`StartError`], with all errors of the file.
pub fn load(config: &FieldConfig, data: &Path) -> Result<Mapping, StartError> {
    read(&FIELDS.find(&config.mapping, data)?)
}

/// Reads a mapping.
///
/// # Errors
/// [`StartError`], with all errors of the file.
pub fn read(path: &Path) -> Result<Mapping, StartError> {
    let text = files::read_text(path).map_err(|source| StartError::Read { path: path.to_owned(), source })?;
    let source = Source { name: path.display().to_string(), text: text.into() };
    let what = || format!("the mapping {}", path.display());
    Mapping::parse(&source).map_err(|report| StartError::Data { what: what(), report: Box::new(report) })
}

/// Checks that the devices whose connection a fault plan cuts exist.
///
/// # Errors
/// [`StartError::NoSuchDevice`].
pub fn check_cuts(faults: &FaultPlan, mapping: Option<&Mapping>) -> Result<(), StartError> {
    let cut = faults.faults.iter().filter_map(|fault| match &fault.what {
        What::FieldCut(device) => Some(device),
        _ => None,
    });
    for device in cut {
        let Some(mapping) = mapping else {
            let expected = "a run with couplers: add --field sim:NAME".to_owned();
            return Err(StartError::NoSuchDevice { device: device.clone(), expected });
        };
        if mapping.device(device).is_none() {
            let names: Vec<&str> = mapping.devices.iter().map(|device| device.name.as_str()).collect();
            let expected = format!("a device of the mapping, one of {}", names.join(", "));
            return Err(StartError::NoSuchDevice { device: device.clone(), expected });
        }
    }
    Ok(())
}

/// Message of a run with emulated couplers at its start.
#[must_use]
pub fn introduction(mapping: &Mapping) -> String {
    let devices: Vec<&str> = mapping.devices.iter().map(|device| device.name.as_str()).collect();
    let carries =
        |group: &Group| mapping.presence(*group) != Presence::Simulated && !ONLY_SIMULATED.contains(group);
    let through: Vec<&str> = Group::ALL.into_iter().filter(carries).map(Group::name).collect();
    let beside: Vec<&str> = Group::ALL.into_iter().filter(|group| !carries(group)).map(Group::name).collect();
    format!(
        "field I/O with emulated couplers: {}; through them: {}; not through them: {}; simulated: all devices",
        devices.join(", "),
        listed(&through),
        listed(&beside)
    )
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
