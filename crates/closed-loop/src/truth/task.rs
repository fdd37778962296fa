//! Goals of Task's commands (V.4.1).

use geometry::frame::Frame;
use interfaces::HwsCommand;
use plant::CellDescription;
use rcs_core::name::Name16;
use taskdata::files::Location;

use super::{
    Scene,
    claim::{Claim, at, grip_goal, holds},
};

pub fn claims(command: &HwsCommand, scene: &Scene<'_>) -> Vec<Claim> {
    let object = command.object;
    let resolve = |name: Option<Name16>, sector: Option<i32>, object: Option<&Name16>| {
        scene.data.resolve_location(&name?, sector, object).ok()
    };
    let source = resolve(command.source, command.source_sector, object.as_ref());
    let destination = resolve(command.destination, command.destination_sector, object.as_ref());
    let end = resolve(command.end_at, command.end_at_sector, None);
    let goal = |grip: i32, location: &Option<Location>| -> Option<Frame> {
        let location = location.as_ref()?;
        grip_goal(scene.data, Some(location.frame), object.as_ref(), grip, &location.place)
    };
    let held = |grip: i32| holds(object, grip, source.as_ref().map(|location| &location.place), scene);
    let at_end = || end.as_ref().and_then(|end| at(Some(end.frame), end.name));
    let to = command.destination_grip;
    let there = || destination.as_ref().and_then(|location| at(goal(to, &destination), location.name));
    let found = match command.command.as_str() {
        "PAUSE" => super::subtask::pause(scene),
        "TRANSFER" => vec![
            Some(Claim::HoldsNothing),
            lies_at(command, scene.cell.description()),
            object.zip(goal(to, &destination)).map(|(object, goal)| Claim::Placed { object, goal }),
            at_end(),
        ],
        "MOVE" if object.is_none() => {
            vec![destination.as_ref().and_then(|location| at(Some(location.frame), location.name))]
        }
        "MOVE" | "REFIXTURE" => vec![held(to), Some(Claim::HoldsAlone), there()],
        "POSITION" => {
            let (named, grip) = match &source {
                Some(_) => (&source, command.source_grip),
                None => (&destination, to),
            };
            let frame = named.as_ref().map(|location| location.frame);
            let goal = if object.is_some() { goal(grip, named) } else { frame };
            vec![Some(Claim::HoldsNothing), named.as_ref().and_then(|location| at(goal, location.name))]
        }
        "ACQUIRE" => vec![held(command.source_grip)],
        "INSERT-TOOL" => vec![held(to), object.map(Claim::InDrum)],
        "ACQUIRE-TOOL" => vec![held(command.source_grip), object.map(Claim::InDrum)],
        "RELEASE-TOOL" => vec![Some(Claim::HoldsNothing), object.map(Claim::InDrum), at_end()],
        "REMOVE-TOOL" => vec![held(to), object.map(Claim::OutOfDrum), at_end()],
        // STARTUP and SHUTDOWN concern the Data System, not the cell.
        _ => vec![],
    };
    found.into_iter().flatten().collect()
}

/// The claim that the object is at the destination, if the cell has such a place.
fn lies_at(command: &HwsCommand, cell: &CellDescription) -> Option<Claim> {
    let (object, location) = (command.object?, command.destination?.to_string());
    let sector = command.destination_sector.and_then(|sector| u16::try_from(sector).ok()).unwrap_or(0);
    let place = (location, sector);
    super::placement::has_place(cell, &place, object.as_str()).then_some(Claim::LiesAt { object, place })
}
