//! Checks of linked data: errors that would otherwise stop a command during its motion.
//!
//! * [`trays`]: sectors within their trays;
//! * [`sizes`]: openings in order, tray grips, flips;
//! * [`routes`]: trajectories that no command can reach;
//! * [`guarded`]: sensors and speeds of relative moves;
//! * [`reach`]: the arm reaches every target of a command. It can be left out; its time grows with the number of
//!   targets, so it uses all processors.

mod arm;
mod guarded;
mod reach;
mod routes;
mod sizes;
mod trays;

use std::collections::HashMap;

use crate::files::{
    ArrayId, Location, LocptId, ObjectId, OwnerId, Place, RefType, Reference, TaskData, index::reference_key,
};
use diagnostics::{At, Problems, Severity};
use interfaces::location::LocationKind;

use super::origins::Origins;

pub(super) use reach::check as reach;

/// All checks except the reach. Unless `whole`, names are missing, so only single objects are checked.
pub(super) fn check(data: &TaskData<'_>, origins: &Origins, whole: bool, problems: &mut Problems) {
    let mut findings = Findings::default();
    if whole {
        trays::check(data, origins, &mut findings);
    }
    sizes::check(data, origins, &mut findings);
    if whole {
        sizes::tray_grips(data, origins, &mut findings);
        routes::check(data, origins, &mut findings);
        guarded::check(data, origins, &mut findings);
    }
    findings.report(problems);
}

#[derive(Debug)]
struct Finding {
    severity: Severity,
    code: &'static str,
    at: At,
    message: String,
    help: String,
    more: Option<usize>, // further locations; `None`: does not depend on one
}

/// Findings in order of discovery. A wild card can be wrong at every sector, but is listed only once.
#[derive(Debug, Default)]
struct Findings {
    list: Vec<Finding>,
    known: HashMap<(u32, u32, &'static str), usize>, // position in `list` by source, first byte and code
}

impl Findings {
    fn error(&mut self, code: &'static str, at: At, message: String, help: String) {
        self.add(Finding { severity: Severity::Error, code, at, message, help, more: Some(0) });
    }

    fn warning(&mut self, code: &'static str, at: At, message: String, help: String) {
        self.add(Finding { severity: Severity::Warning, code, at, message, help, more: Some(0) });
    }

    fn add(&mut self, finding: Finding) {
        let next = self.list.len();
        let position = *self.known.entry((finding.at.source, finding.at.start, finding.code)).or_insert(next);
        match self.list.get_mut(position) {
            Some(first) => first.more = first.more.zip(finding.more).map(|(one, other)| one + other + 1),
            None => self.list.push(finding),
        }
    }

    fn error_once(&mut self, code: &'static str, at: At, message: String, help: String) {
        self.add(Finding { severity: Severity::Error, code, at, message, help, more: None });
    }

    fn merge(&mut self, later: Self) {
        for finding in later.list {
            self.add(finding);
        }
    }

    fn report(self, problems: &mut Problems) {
        for finding in self.list {
            let mut help = finding.help;
            if let Some(more) = finding.more.filter(|more| *more > 0) {
                let places = if more == 1 { "place" } else { "places" };
                help = format!("{help}; the same at {more} more {places}");
            }
            problems.push(finding.severity, finding.code, finding.at, finding.message, Some(help));
        }
    }
}

fn origin(list: &[At], position: usize) -> At {
    list.get(position).copied().unwrap_or_default()
}

fn shown(location: &Location) -> String {
    match location.sector {
        None => location.name.to_string(),
        Some(sector) => format!("{} sector {sector}", location.name),
    }
}

fn at_point(data: &TaskData<'_>, at: Reference) -> Option<Location> {
    let id = LocptId::new(at.number);
    let point = data.locpt(id).filter(|_| at.kind == RefType::LocationPoint)?;
    Some(Location { name: point.name, place: Place::point(id), sector: None, frame: point.frame })
}

fn owners_of<'a>(data: &TaskData<'a>, member: Reference) -> impl Iterator<Item = OwnerId> + use<'a> {
    data.indexes.members.all(reference_key(member)).iter().map(|&number| OwnerId::new(number))
}

fn sectors(data: &TaskData<'_>, owner: OwnerId, array_id: ArrayId) -> Vec<Location> {
    let corner = data.members_of(owner).first().and_then(|m| at_point(data, m.member));
    let (Some(array), Some(corner)) = (data.array(array_id), corner) else { return Vec::new() };
    let place = Place { kind: LocationKind::Owner, array: array_id, ..corner.place };
    let sector = |n| {
        let frame = data.sector_frame(array, &corner.frame, n)?;
        Some(Location { name: corner.name, place, sector: Some(n), frame })
    };
    (1..=array.sectors()).filter_map(sector).collect()
}

fn static_sectors(data: &TaskData<'_>, array_id: ArrayId) -> Vec<Location> {
    let Some((array, pose)) = data.array(array_id).and_then(|a| Some((a, data.pose(a.pose)?))) else {
        return Vec::new();
    };
    let place = Place { kind: LocationKind::Array, locpt: LocptId::NULL, array: array_id };
    let sector = |n| {
        let frame = data.sector_frame(array, &pose.frame, n)?;
        Some(Location { name: array.name, place, sector: Some(n), frame })
    };
    (1..=array.sectors()).filter_map(sector).collect()
}

/// The locations of an entry without an object: points, members of an owner, sectors.
fn locations(data: &TaskData<'_>, at: Reference) -> Vec<Location> {
    match at.kind {
        RefType::LocationPoint => at_point(data, at).into_iter().collect(),
        RefType::Owner => {
            let members = data.members_of(OwnerId::new(at.number)).iter();
            members.flat_map(|m| locations_of_member(data, OwnerId::new(at.number), m.member)).collect()
        }
        RefType::Array => {
            let id = ArrayId::new(at.number);
            let used = owners_of(data, at).flat_map(|owner| sectors(data, owner, id));
            used.chain(static_sectors(data, id)).collect()
        }
        _ => Vec::new(),
    }
}

fn locations_of_member(data: &TaskData<'_>, owner: OwnerId, member: Reference) -> Vec<Location> {
    match member.kind {
        RefType::Array => sectors(data, owner, ArrayId::new(member.number)),
        _ => at_point(data, member).into_iter().collect(),
    }
}

/// The sectors and location points to which the object is assigned, or else those that the entry names.
fn locations_of(data: &TaskData<'_>, object: ObjectId, at: Reference) -> Vec<Location> {
    let mut found = Vec::new();
    for assigned in data.object_locations(object) {
        found.extend(at_point(data, assigned));
        if assigned.kind == RefType::Array {
            let id = ArrayId::new(assigned.number);
            found.extend(owners_of(data, assigned).flat_map(|owner| sectors(data, owner, id)));
            found.extend(static_sectors(data, id));
        }
    }
    found
        .retain(|location| at.kind == RefType::Any || data.aliases(&location.place).any(|alias| alias == at));
    if found.is_empty() && at.kind != RefType::Array {
        let mut named = locations(data, at);
        // At an owner of arrays, an unassigned object is at the location point.
        named.retain(|location| location.sector.is_none());
        found = named;
    }
    found
}
