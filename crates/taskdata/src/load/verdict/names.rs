//! The names of a command: object, locations with sectors, and grips there.

use diagnostics::nearest;
use interfaces::HwsCommand;
use rcs_core::name::Name16;

use super::{
    Field, Finding, finding,
    needs::{assigned_to, grips_of, places_of},
    path::{Visit, Visits},
};
use crate::files::{Location, LookupError, TaskData};

pub(in crate::load) struct LookupProblem {
    pub code: &'static str,
    pub message: String,
    pub help: Option<String>,
    pub near: Option<String>,
    pub is_sector: bool, // the sector is wrong, not the name
}

pub(in crate::load) fn find_object(data: &TaskData<'_>, name: &Name16) -> Result<(), LookupProblem> {
    if data.object_named(name).is_some() {
        return Ok(());
    }
    let known: Vec<String> = data.objects.iter().map(|object| object.name.to_string()).collect();
    let near = nearest(name.as_str(), known.iter().map(String::as_str)).map(str::to_owned);
    let shown = if name.is_empty() { "--" } else { name.as_str() };
    Err(LookupProblem {
        code: "name.unknown",
        message: format!("no object is named {shown}"),
        help: near.as_ref().map(|near| format!("the nearest known name is {near}")),
        near,
        is_sector: false,
    })
}

pub(in crate::load) fn find_location(
    data: &TaskData<'_>,
    name: &Name16,
    sector: Option<i32>,
    object: Option<&Name16>,
) -> Result<Location, LookupProblem> {
    data.resolve_location(name, sector, object).map_err(|error| {
        let near = match error {
            LookupError::UnknownLocation { .. } => near_location(data, name),
            _ => None,
        };
        let help = match error {
            LookupError::NotAssigned { object, .. } => Some(assigned_to(data, &object)),
            _ => near.as_ref().map(|near| format!("the nearest known name is {near}")),
        };
        let is_sector = matches!(error, LookupError::SectorRange { .. } | LookupError::NoSectors { .. });
        LookupProblem { code: "job.location", message: error.to_string(), help, near, is_sector }
    })
}

fn near_location(data: &TaskData<'_>, name: &Name16) -> Option<String> {
    let points = data.locpts.iter().map(|point| point.name.to_string());
    let known: Vec<String> = points.chain(data.owners.iter().map(|owner| owner.name.to_string())).collect();
    nearest(name.as_str(), known.iter().map(String::as_str)).map(str::to_owned)
}

impl LookupProblem {
    fn of(self, name: &Name16, [field, sector]: [Field; 2]) -> Finding {
        let Self { code, message, help, near, is_sector } = self;
        let field = if is_sector { sector } else { field };
        Finding { unknown: Some((*name, near)), ..finding(field, code, message, help) }
    }
}

/// `None` for an unknown object, which prevents further checks.
pub(super) fn look_up(
    command: &HwsCommand,
    data: &TaskData<'_>,
    findings: &mut Vec<Finding>,
) -> Option<Visits> {
    if let Some(object) = &command.object
        && let Err(unfound) = find_object(data, object)
    {
        findings.push(unfound.of(object, [Field::Object; 2]));
        return None;
    }
    let mut names = Names { data, findings };
    let [source, destination, end_at] = named_locations(command);
    Some(Visits {
        source: names.visit(&source),
        destination: names.visit(&destination),
        end_at: names.visit(&end_at),
    })
}

pub(super) fn names(command: &HwsCommand, data: &TaskData<'_>, findings: &mut Vec<Finding>) {
    if let Some(object) = &command.object
        && let Err(unfound) = find_object(data, object)
    {
        findings.push(unfound.of(object, [Field::Object; 2]));
    }
    let mut names = Names { data, findings };
    for named in named_locations(command) {
        names.location(&named);
    }
}

struct NamedLocation {
    name: Option<Name16>,
    sector: Option<i32>,
    object: Option<Name16>,
    grip: i32,
    fields: [Field; 3], // of name, sector and grip
}

fn named_locations(command: &HwsCommand) -> [NamedLocation; 3] {
    [
        NamedLocation {
            name: command.source,
            sector: command.source_sector,
            object: command.object,
            grip: command.source_grip,
            fields: [Field::Source, Field::SourceSector, Field::SourceGrip],
        },
        NamedLocation {
            name: command.destination,
            sector: command.destination_sector,
            object: command.object,
            grip: command.destination_grip,
            fields: [Field::Destination, Field::DestinationSector, Field::DestinationGrip],
        },
        // The robot ends there without the object.
        NamedLocation {
            name: command.end_at,
            sector: command.end_at_sector,
            object: None,
            grip: 0,
            fields: [Field::EndAt, Field::EndAtSector, Field::EndAt],
        },
    ]
}

struct Names<'c, 'd> {
    data: &'c TaskData<'d>,
    findings: &'c mut Vec<Finding>,
}

impl Names<'_, '_> {
    fn location(&mut self, named: &NamedLocation) -> Option<Location> {
        let [field, of_sector, _] = named.fields;
        let Some(name) = &named.name else {
            if let Some(sector) = named.sector {
                let message = format!("sector {sector} of no location");
                self.findings.push(finding(of_sector, "job.sector", message, None));
            }
            return None;
        };
        match find_location(self.data, name, named.sector, named.object.as_ref()) {
            Ok(location) => Some(location),
            Err(unfound) => {
                self.findings.push(unfound.of(name, [field, of_sector]));
                None
            }
        }
    }

    /// The visit contains the object if its grip is known there.
    fn visit(&mut self, named: &NamedLocation) -> Option<Visit> {
        let location = self.location(named)?;
        let [field, _, of_grip] = named.fields;
        let given = named.object.filter(|_| named.grip != 0);
        let object = given.filter(|object| self.has_grip(object, named.grip, &location, of_grip));
        Some(Visit { location, object: object.map(|object| (object, named.grip)), field })
    }

    fn has_grip(&mut self, object: &Name16, grip: i32, location: &Location, field: Field) -> bool {
        let data = self.data;
        let (message, help) = if data.object(object, grip).is_none() {
            (format!("{object} has no grip {grip} in an object form"), grips_of(data, object))
        } else if let Err(error) = data.grip_frame(object, grip, location) {
            (error.to_string(), places_of(data, object, grip))
        } else {
            return true;
        };
        self.findings.push(finding(field, "grip.unknown", message, Some(help)));
        false
    }
}
