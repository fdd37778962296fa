//! The path of the robot through a job: from each location to the next there must be a trajectory and an approach.
//!
//! The position of the robot before the first command is not known here. The path of a command that uses the Active
//! Pedestal or the tool drum is not checked; the check continues at its end.

use diagnostics::{At, Problems};
use rcs_core::name::Name16;

use crate::files::{Location, RefType, TaskData};

use super::needs::approaches_of;

/// A location that a command leads to.
pub(super) struct Visit {
    pub location: Location,
    /// The object that is handled there, and its grip number.
    pub object: Option<(Name16, i32)>,
    pub at: At,
}

/// The locations of a command.
pub(super) struct Visits {
    pub source: Option<Visit>,
    pub destination: Option<Visit>,
    pub end_at: Option<Visit>,
}

/// The location of the robot between two commands.
#[derive(Default)]
pub(super) struct Walk {
    /// The location, with object and grip number of the motion to it; `None` if it is not known.
    last: Option<(Location, Option<(Name16, i32)>)>,
}

impl Walk {
    /// Something other than a command moves the robot: its location is then unknown.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }

    /// Check the path of a command (V.4.1).
    pub(super) fn command(
        &mut self,
        data: &TaskData<'_>,
        problems: &mut Problems,
        verb: &str,
        visits: Visits,
    ) {
        let Visits { source, destination, end_at } = visits;
        let regrip = match (&source, &destination) {
            (Some(from), Some(to)) => from.object.map(|o| o.1) != to.object.map(|o| o.1),
            _ => false,
        };
        if let Some(visit) = &source {
            view(data, problems, visit, verb);
        }
        match verb {
            "TRANSFER" | "MOVE" | "REFIXTURE" => {
                self.go(data, problems, source);
                if regrip || verb == "REFIXTURE" {
                    self.last = None;
                }
                self.go(data, problems, destination);
                // MOVE ignores its end-at location.
                if verb != "MOVE" {
                    self.go(data, problems, end_at);
                }
            }
            "ACQUIRE" => self.go(data, problems, source),
            // POSITION goes to an object at its location, or to a location (SPECNOTES.md, contradiction 24).
            "POSITION" => self.go(data, problems, source.or(destination)),
            "PAUSE" => {}
            _ => self.last = None,
        }
    }

    fn go(&mut self, data: &TaskData<'_>, problems: &mut Problems, visit: Option<Visit>) {
        let Some(Visit { location, object, at }) = visit else { return };
        if let Some((object, grip)) = object
            && data.approach(&object, grip, &location.place).is_none()
        {
            problems.error_help(
                "path.missing",
                at,
                format!("nothing says how grip {grip} of {object} is approached at {}", location.name),
                format!(
                    "add an entry -appr obj for this location, or for $$$ (VII.7.7); {}",
                    approaches_of(data, RefType::Object, &object, grip)
                ),
            );
        }
        if let Some((last, Some((object, grip)))) = self.last
            && data.approach(&object, grip, &last.place).is_some()
            && data.depart(&object, grip, &last.place).is_none()
        {
            problems.error_help(
                "path.missing",
                at,
                format!("nothing says how grip {grip} of {object} is departed from at {}", last.name),
                "add an entry -dept obj for that location, or for $$$, without points if the robot may go straight (VII.7.7)",
            );
        }
        if let Some((last, _)) = self.last.filter(|(last, _)| !same(last, &location))
            && data.trajectory(&last.place, &location.place).is_none()
        {
            problems.error_help(
                "path.missing",
                at,
                format!("no trajectory leads from {} to {}", last.name, location.name),
                "add a trajectory form (VII.6); each is flown from its start to its end only",
            );
        }
        self.last = Some((location, object));
    }
}

/// Check the path to the place of the camera, if vision has to locate the object.
fn view(data: &TaskData<'_>, problems: &mut Problems, visit: &Visit, verb: &str) {
    let Some((object, _)) = visit.object.filter(|_| matches!(verb, "TRANSFER" | "MOVE" | "ACQUIRE")) else {
        return;
    };
    let Some((_, vision)) = data.view(&object, &visit.location.place).filter(|(_, vision)| vision.enabled)
    else {
        return;
    };
    if data.view_approach(&object, vision.grip, &visit.location.place).is_none() {
        problems.error_help(
            "path.missing",
            visit.at,
            format!("nothing says how the view of {object} is approached at {}", visit.location.name),
            format!(
                "add an entry -appr vu for this location, or for $$$ (VII.7.7); {}",
                approaches_of(data, RefType::View, &object, vision.grip)
            ),
        );
    }
}

/// True if both are one location, such as sectors of one tray: a motion between them needs no trajectory
/// (docs/design/motion.md "Same location").
fn same(one: &Location, other: &Location) -> bool {
    one.name == other.name
}
