//! Checks the positions of the parts: each must be where the last command that moved it should have left it.
//!
//! A command moves a part if the gripper holds it meanwhile. Its verb determines the place (V.4.1): TRANSFER puts the
//! part down at the destination, RELEASE-TOOL leaves it in the drum, POSITION releases it at the robot's place or keeps
//! it, and all others keep it. A failed command determines no place. The part is checked in each tick until another
//! command moves it; the position at the end of the run decides, as a tilted part may be pushed to its place later.

use std::collections::{BTreeMap, BTreeSet};

use crate::{account::Kind, failure::Failure};
use geometry::units::Length;
use interfaces::{
    HwsCommand,
    hws::{HwsReport, HwsStatus},
};
use plant::{CellDescription, PartState, description::Nest};
use rcs_core::{name::Name16, tick::Tick};

/// A location and its sector, 0 for none.
type Place = (String, u16);

#[derive(Clone, Debug, PartialEq)]
enum Goal {
    Gripper,
    /// At a place; `None` if the robot's place at the release is unknown.
    At(Option<Place>),
}

#[derive(Clone, Debug)]
struct Moved {
    goal: Goal,
    command: String,
    let_go: [f64; 3],        // last position in the hand, world coordinates, in
    misplaced: Option<Tick>, // first tick off its place; `None` while at its place
}

#[derive(Clone, Copy, Debug)]
struct InHand {
    at: [f64; 3], // its position, world coordinates, in
    last: Tick,
}

/// A command that moves parts, and its failed attempts.
#[derive(Clone, Debug, Default)]
struct Attempt {
    command: HwsCommand,
    /// Numbers of the parts that the gripper has held since the command was first sent.
    moved: BTreeSet<u32>,
    is_over: bool,
}

#[derive(Clone, Debug)]
pub struct PlacementCheck {
    tolerance: f64, // greatest distance of a part from the middle of its place, in
    number: u32,
    attempt: Attempt,
    stands_at: Option<Place>,
    moved: BTreeMap<u32, Moved>,
    in_hand: BTreeMap<u32, InHand>,
    empty: Option<(Tick, String)>, // the first command that finished without its object
}

impl PlacementCheck {
    #[must_use]
    pub fn new(cell: &CellDescription) -> Self {
        Self {
            tolerance: cell.placing_tolerance,
            number: 0,
            attempt: Attempt { is_over: true, ..Attempt::default() },
            stands_at: None,
            moved: BTreeMap::new(),
            in_hand: BTreeMap::new(),
            empty: None,
        }
    }

    /// Check a finished tick: Task's command and status, and the positions of the parts.
    pub fn look(
        &mut self,
        tick: Tick,
        hws: &HwsCommand,
        task: &HwsStatus,
        cell: &CellDescription,
        parts: &[PartState],
    ) {
        if hws.number != self.number {
            self.number = hws.number;
            self.begin(hws);
        }
        for part in parts.iter().filter(|part| part.held) {
            self.in_hand.insert(part.id, InHand { at: part.position, last: tick });
            if !self.attempt.is_over {
                self.attempt.moved.insert(part.id);
            }
        }
        if !self.attempt.is_over
            && (task.echo, task.report) == (self.attempt.command.number, HwsReport::Finished)
        {
            self.conclude(tick, cell, parts);
        }
        let open = if self.attempt.is_over { None } else { Some(&self.attempt.moved) };
        for part in parts.iter().filter(|part| open.is_none_or(|moved| !moved.contains(&part.id))) {
            let Some(moved) = self.moved.get_mut(&part.id) else { continue };
            if is_there(&moved.goal, moved.let_go, self.tolerance, cell, part) {
                moved.misplaced = None;
            } else if moved.misplaced.is_none() {
                moved.misplaced = Some(tick);
            }
        }
    }

    /// Begin a command. PAUSE and similar commands move no part, and a repeated command continues.
    fn begin(&mut self, hws: &HwsCommand) {
        if matches!(hws.command.as_str(), "PAUSE" | "STARTUP" | "SHUTDOWN") {
            return;
        }
        let again = HwsCommand { number: self.attempt.command.number, ..*hws } == self.attempt.command;
        if again && !self.attempt.is_over {
            self.attempt.command.number = hws.number;
            return;
        }
        if !self.attempt.is_over {
            // The effect of the last command on its parts is unknown.
            self.moved.retain(|id, _| !self.attempt.moved.contains(id));
        }
        self.attempt = Attempt { command: *hws, ..Attempt::default() };
    }

    /// End of a command: set the required places of the parts that it moved.
    fn conclude(&mut self, tick: Tick, cell: &CellDescription, parts: &[PartState]) {
        let attempt = std::mem::take(&mut self.attempt);
        let command = attempt.command.in_words().to_string();
        let destination = place(attempt.command.destination, attempt.command.destination_sector);
        if attempt.moved.is_empty()
            && takes_object(&attempt.command)
            && !was_done_before(&attempt.command, destination.as_ref(), parts)
            && self.empty.is_none()
        {
            self.empty = Some((tick, command.clone()));
        }
        for part in parts.iter().filter(|part| attempt.moved.contains(&part.id)) {
            let goal = match attempt.command.command.as_str() {
                "TRANSFER" => Goal::At(destination.clone()),
                "RELEASE-TOOL" => Goal::At(
                    Some((cell.drum.location.clone(), 0)).filter(|(location, _)| !location.is_empty()),
                ),
                "POSITION" if !part.held => Goal::At(self.stands_at.clone()),
                _ => Goal::Gripper,
            };
            let InHand { at, last } =
                self.in_hand.get(&part.id).copied().unwrap_or(InHand { at: part.position, last: tick });
            let misplaced = (!is_there(&goal, at, self.tolerance, cell, part)).then_some(last);
            self.moved.insert(part.id, Moved { goal, command: command.clone(), let_go: at, misplaced });
        }
        let source = place(attempt.command.source, attempt.command.source_sector);
        if attempt.command.command.as_str() == "POSITION" {
            // A command may push other parts there intentionally.
            for (id, moved) in
                self.moved.iter_mut().filter(|(_, moved)| moved.goal == Goal::At(source.clone()))
            {
                moved.let_go =
                    parts.iter().find(|part| part.id == *id).map_or(moved.let_go, |part| part.position);
            }
        }
        self.stands_at = destination.or(source);
        self.attempt.is_over = true;
    }

    /// The failure of a finished job: the first part off its place, if any.
    #[must_use]
    pub fn verdict(&self, parts: &[PartState]) -> Option<Failure> {
        let misplaced = parts.iter().filter_map(|part| {
            let moved = self.moved.get(&part.id)?;
            let tick = moved.misplaced?;
            let place = match &moved.goal {
                Goal::Gripper => "in the gripper".to_owned(),
                Goal::At(Some((location, 0))) => format!("at {location}, within {}", Length(self.tolerance)),
                Goal::At(Some((location, sector))) => {
                    format!("at {location} sector {sector}, within {}", Length(self.tolerance))
                }
                Goal::At(None) => format!("within {} of where the fingers opened", Length(self.tolerance)),
            };
            let text = format!("{}; {} was to leave it {place}", part, moved.command);
            Some((tick, text))
        });
        let empty = self.empty.iter().map(|(tick, command)| {
            (*tick, format!("{command} has finished, but the gripper has had no part meanwhile"))
        });
        let (tick, text) = misplaced.chain(empty).min_by_key(|(tick, _)| *tick)?;
        Some(Failure::outside(tick, Kind::Misplaced, "cell", text))
    }
}

fn takes_object(command: &HwsCommand) -> bool {
    command.object.is_some() && !matches!(command.command.as_str(), "POSITION" | "RELEASE-TOOL")
}

/// True for a repeated TRANSFER that was interrupted after it had put its object down.
fn was_done_before(command: &HwsCommand, destination: Option<&Place>, parts: &[PartState]) -> bool {
    let source = place(command.source, command.source_sector);
    let lies_at = |place: Option<&Place>| {
        parts.iter().any(|part| {
            !part.held
                && command.object.is_some_and(|object| object.as_str() == part.name)
                && place.is_some_and(|(location, sector)| {
                    *location == part.location && (*sector == 0 || *sector == part.sector)
                })
        })
    };
    command.command.as_str() == "TRANSFER" && lies_at(destination) && !lies_at(source.as_ref())
}

fn place(location: Option<Name16>, sector: Option<i32>) -> Option<Place> {
    let sector = sector.and_then(|sector| u16::try_from(sector).ok()).unwrap_or(0);
    Some((location?.to_string(), sector))
}

/// At a place of the cell description a part must be near the middle; elsewhere, and in trays, it must not have moved
/// since its release.
fn is_there(goal: &Goal, let_go: [f64; 3], tolerance: f64, cell: &CellDescription, part: &PartState) -> bool {
    let place = match goal {
        Goal::Gripper => return part.held,
        Goal::At(place) => place.as_ref().filter(|place| has_place(cell, place, &part.name)),
    };
    if part.held {
        return false;
    }
    let moved = part.position.iter().zip(let_go).map(|(is, was)| (is - was).powi(2)).sum::<f64>().sqrt();
    match place {
        None => moved <= tolerance,
        Some((location, sector)) => {
            let near = part.error.is_none_or(|error| error <= tolerance) && moved <= tolerance;
            (&part.location, part.sector) == (location, *sector) && (near || *location == cell.vise.location)
        }
    }
}

pub(super) fn has_place(cell: &CellDescription, (location, sector): &Place, part: &str) -> bool {
    let in_tray =
        |unit: &str, sectors: usize| unit == location && (1..=sectors).contains(&usize::from(*sector));
    let in_nest = |nest: &Nest| {
        (&nest.location, nest.sector) == (location, *sector) && nest.parts.iter().any(|kind| kind == part)
    };
    cell.tray.iter().any(|tray| in_tray(&tray.unit, tray.sectors.len()))
        || cell.nest.iter().any(in_nest)
        || [&cell.vise.location, &cell.drum.location, &cell.pedestal.location].contains(&location)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(verb: &str) -> HwsCommand {
        let name = |text| Some(Name16::clipped(text));
        HwsCommand {
            command: Name16::clipped(verb),
            object: name("BLOCK"),
            source: name("TRAY"),
            source_sector: Some(2),
            destination: name("VISE"),
            ..HwsCommand::default()
        }
    }

    fn block(location: &str, sector: u16, held: bool) -> PartState {
        PartState {
            id: 1,
            name: "BLOCK".to_owned(),
            location: location.to_owned(),
            sector,
            held,
            clamped: false,
            position: [0.0; 3],
            error: None,
        }
    }

    fn is_done(verb: &str, parts: &[PartState]) -> bool {
        let command = command(verb);
        was_done_before(&command, place(command.destination, command.destination_sector).as_ref(), parts)
    }

    #[test]
    fn transfer_with_its_only_object_at_the_destination_was_done_before() {
        let (there, here) = (block("VISE", 0, false), block("TRAY", 2, false));
        assert!(is_done("TRANSFER", std::slice::from_ref(&there)));
        assert!(
            is_done("TRANSFER", &[there.clone(), block("TRAY", 3, false)]),
            "the one of another sector stays"
        );
        assert!(!is_done("TRANSFER", &[there.clone(), here.clone()]));
        assert!(!is_done("TRANSFER", &[here]));
        assert!(!is_done("TRANSFER", &[block("VISE", 0, true)]));
        assert!(!is_done("TRANSFER", &[PartState { name: "PLATE".to_owned(), ..there.clone() }]));
        assert!(!is_done("ACQUIRE", &[there]), "it ends with its object in the gripper");
    }
}
