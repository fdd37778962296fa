//! Field I/O of a run: the mapping, and the run's messages about it.

mod port;
mod view;

use std::{borrow::Borrow, path::Path};

use closed_loop::devices;
use diagnostics::{FIELDS, Source};
use executive::egm::Peer;
use field::{Mapping, Presence};
use interfaces::point::Group;
use os_io::files;
use plant::fault::{FaultPlan, FaultSubject};
use record::Log;

use sessions::network::Role;
use taskdata::load::{Job, Step};

pub use self::{
    port::{FieldPort, hindrance},
    view::{view_of_log, view_of_run},
};
use crate::{
    config::{FieldConfig, RobotKind, RunConfig},
    error::StartError,
    log::MAPPING,
};

/// Reads the mapping of a run. Also returns its text. Errors: [`StartError`], with all errors of the file.
pub fn load(config: &FieldConfig, data: &Path) -> Result<(Mapping, String), StartError> {
    read_with_text(&FIELDS.find(&config.mapping, data)?)
}

/// Reads a mapping. Errors: [`StartError`], with all errors of the file.
pub fn read(path: &Path) -> Result<Mapping, StartError> {
    read_with_text(path).map(|(mapping, _)| mapping)
}

/// The mapping of a log. `None` for a run without field I/O, and if this program cannot read the mapping.
#[must_use]
pub fn of_log(log: &Log) -> Option<Mapping> {
    let text = String::from_utf8_lossy(&log.attachment(MAPPING)?.data).into_owned();
    Mapping::parse(&Source { name: MAPPING.to_owned(), text: text.into() }).ok()
}

fn read_with_text(path: &Path) -> Result<(Mapping, String), StartError> {
    let text = files::read_text(path).map_err(|source| StartError::Read { path: path.to_owned(), source })?;
    let source = Source { name: path.display().to_string(), text: text.clone().into() };
    let what = || format!("the mapping {}", path.display());
    let mapping = Mapping::parse(&source)
        .map_err(|report| StartError::Data { what: what(), report: Box::new(report) })?;
    Ok((mapping, text))
}

/// Checks that the devices whose connection a fault plan cuts exist. Errors: [`StartError::NoSuchDevice`].
pub fn check_cuts(
    faults: &FaultPlan,
    config: &RunConfig,
    mapping: Option<&Mapping>,
) -> Result<(), StartError> {
    let cut = faults.faults.iter().filter_map(|fault| match &fault.what {
        FaultSubject::FieldCut(device) => Some(device),
        _ => None,
    });
    for device in cut {
        let Some(mapping) = mapping else {
            let expected = "a run with couplers: add --field sim:NAME".to_owned();
            return Err(StartError::NoSuchDevice { device: device.clone(), expected });
        };
        if config.has_real_devices() {
            return Err(StartError::CutOverTcp(device.clone()));
        }
        if mapping.device(device).is_none() {
            let names: Vec<&str> = mapping.devices.iter().map(|device| device.name.as_str()).collect();
            let expected = format!("a device of the mapping, one of {}", names.join(", "));
            return Err(StartError::NoSuchDevice { device: device.clone(), expected });
        }
    }
    Ok(())
}

/// The lines of a job that a mapping cannot execute, with the reasons.
#[must_use]
pub fn refused_lines(mapping: &Mapping, job: &Job) -> Vec<String> {
    let refused = job.steps.iter().filter_map(|line| {
        let (Step::Workstation(action) | Step::After { action, .. }) = &line.step else { return None };
        devices::refusal(mapping, action).map(|why| format!("`{}`: {why}", line.text))
    });
    refused.collect()
}

/// Checks that the mapping of a run can execute all lines of its job. Errors: [`StartError::LinesWithoutDevices`].
pub fn check_job(mapping: &Mapping, job: &Job) -> Result<(), StartError> {
    let refused = refused_lines(mapping, job);
    if refused.is_empty() { Ok(()) } else { Err(StartError::LinesWithoutDevices(refused)) }
}

#[must_use]
pub fn simulated(config: &RunConfig, mapping: &Mapping) -> Vec<&'static str> {
    let is_emulated = !config.has_real_devices();
    let is_simulated = |group: &Group| match group {
        Group::Vision => !config.outside.contains(&Role::Vision),
        group => is_emulated || !carries(mapping, *group),
    };
    let robot = matches!(&config.robot.kind, RobotKind::Sim)
        || matches!(&config.robot.kind, RobotKind::Egm(options) if options.peer == Peer::Simulated);
    let groups = Group::ALL.into_iter().filter(is_simulated).map(Group::name);
    robot.then_some("robot").into_iter().chain(groups).collect()
}

fn carries(mapping: &Mapping, group: Group) -> bool {
    mapping.presence(group) != Presence::Simulated
}

#[must_use]
pub fn introduction(config: &RunConfig, mapping: &Mapping) -> Vec<String> {
    let (through, beside): (Vec<Group>, Vec<Group>) =
        Group::ALL.into_iter().partition(|group| carries(mapping, *group));
    let name = |group: &Group| match mapping.presence(*group) {
        presence @ (Presence::Fixed | Presence::Absent) => format!("{} ({})", group.name(), presence.name()),
        Presence::Mapped | Presence::Simulated => group.name().to_owned(),
    };
    let names = |groups: &[Group]| listed(&groups.iter().map(name).collect::<Vec<_>>());
    let (through, beside) = (names(&through), names(&beside));
    if !config.has_real_devices() {
        let devices: Vec<&str> = mapping.devices.iter().map(|device| device.name.as_str()).collect();
        return vec![format!(
            "field I/O with emulated couplers: {}; through them: {through}; not through them: {beside}; \
             simulated: all devices",
            devices.join(", "),
        )];
    }
    let at = |device: &field::Device| format!("{} at {}", device.name, device.address);
    let devices: Vec<String> = mapping.devices.iter().map(at).collect();
    let simulated = listed(&simulated(config, mapping));
    vec![
        format!("field I/O over TCP: {}; real: {through}; simulated: {simulated}", devices.join(", ")),
        "the devices are real, and the cell of this program is only a model: places of parts, contacts and \
         confirmations are not judged, and finished means that all lines have ended"
            .to_owned(),
    ]
}

fn listed<T: Borrow<str>>(names: &[T]) -> String {
    if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
}
