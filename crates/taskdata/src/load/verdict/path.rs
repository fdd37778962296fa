//! The path of a command: each location must have a trajectory and an approach to the next. Paths to and from the
//! Active Pedestal are not checked; for commands at the tool drum, only the path to the end-at location is checked.

use rcs_core::name::Name16;

use super::{
    Field, Finding, finding,
    needs::{DRUM, approaches_of},
};
use crate::files::{Location, RefType, TaskData};

#[derive(Clone, Copy, Debug)]
pub(super) struct Visit {
    pub location: Location,
    pub object: Option<(Name16, i32)>, // handled there, and grip number
    pub field: Field,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Visits {
    pub source: Option<Visit>,
    pub destination: Option<Visit>,
    pub end_at: Option<Visit>,
}

/// The robot's location between two commands, with object and grip number of the motion there.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    location: Location,
    object: Option<(Name16, i32)>,
}

pub(super) struct Route<'c, 'd> {
    pub data: &'c TaskData<'d>,
    pub last: Option<Standing>, // of the robot, if known
    pub findings: &'c mut Vec<Finding>,
}

impl Route<'_, '_> {
    fn missing(&mut self, field: Field, message: String, help: String) {
        self.findings.push(finding(field, "path.missing", message, Some(help)));
    }

    pub(super) fn command(&mut self, verb: &str, visits: Visits) {
        let Visits { source, destination, end_at } = visits;
        let regrip = match (&source, &destination) {
            (Some(from), Some(to)) => from.object.map(|o| o.1) != to.object.map(|o| o.1),
            _ => false,
        };
        if let Some(visit) = source {
            self.view(&visit, verb);
        }
        match verb {
            "TRANSFER" | "MOVE" | "REFIXTURE" => {
                self.go(source);
                if regrip || verb == "REFIXTURE" {
                    self.last = None;
                }
                self.go(destination);
                // MOVE ignores its end-at location.
                if verb != "MOVE" {
                    self.go(end_at);
                }
            }
            "ACQUIRE" => self.go(source),
            // POSITION moves to an object at its location, or to a location (SPECNOTES.md, contradiction 24).
            "POSITION" => self.go(source.or(destination)),
            "RELEASE-TOOL" | "REMOVE-TOOL" => {
                self.last = self.at_the_drum();
                self.go(end_at);
                self.last = None;
            }
            _ => self.last = None,
        }
    }

    /// Where tool commands end (V.2.1). A missing place, `None`, is reported with the relative moves there.
    fn at_the_drum(&self) -> Option<Standing> {
        let location = self.data.resolve_location::<16, 16>(&Name16::clipped(DRUM), None, None).ok()?;
        Some(Standing { location, object: None })
    }

    fn go(&mut self, visit: Option<Visit>) {
        let Some(Visit { location, object, field }) = visit else { return };
        let (data, last) = (self.data, self.last);
        if let Some((object, grip)) = object
            && data.approach(&object, grip, &location.place).is_none()
        {
            self.missing(
                field,
                format!("nothing says how grip {grip} of {object} is approached at {}", location.name),
                format!(
                    "add an entry -appr obj for this location, or for $$$ (VII.7.7); {}",
                    approaches_of(data, RefType::Object, &object, grip)
                ),
            );
        }
        if let Some(Standing { location: last, object: Some((object, grip)) }) = last
            && data.approach(&object, grip, &last.place).is_some()
            && data.depart(&object, grip, &last.place).is_none()
        {
            let help = "add an entry -dept obj for that location, or for $$$, without points if the robot may go \
                        straight (VII.7.7)";
            let what = format!("nothing says how grip {grip} of {object} is departed from at {}", last.name);
            self.missing(field, what, help.to_owned());
        }
        if let Some(last) = last.map(|last| last.location).filter(|last| !same(last, &location))
            && data.trajectory(&last.place, &location.place).is_none()
        {
            self.missing(
                field,
                format!("no trajectory leads from {} to {}", last.name, location.name),
                "add a trajectory form (VII.6); each leads from its start to its end only".to_owned(),
            );
        }
        self.last = Some(Standing { location, object });
    }

    /// Checks the path to the camera's place, if vision must locate the object.
    fn view(&mut self, visit: &Visit, verb: &str) {
        let (data, place) = (self.data, &visit.location.place);
        let Some((object, _)) = visit.object.filter(|_| matches!(verb, "TRANSFER" | "MOVE" | "ACQUIRE"))
        else {
            return;
        };
        let Some((_, vision)) = data.view(&object, place).filter(|(_, vision)| vision.enabled) else {
            return;
        };
        if data.view_approach(&object, vision.grip, place).is_none() {
            self.missing(
                visit.field,
                format!("nothing says how the view of {object} is approached at {}", visit.location.name),
                format!(
                    "add an entry -appr vu for this location, or for $$$ (VII.7.7); {}",
                    approaches_of(data, RefType::View, &object, vision.grip)
                ),
            );
        }
    }
}

/// Sectors of one tray, for example, need no trajectory between them (docs/design/motion.md "Same location").
fn same(one: &Location, other: &Location) -> bool {
    one.name == other.name
}
