//! Checks that bodies are at their places in the task data: trays, vise, pedestal, drum, nests and holsters.

use geometry::frame::{Frame, Rotation, Vector};
use plant::{
    CellDescription,
    description::{Nest, PartType, Shape},
    scene::vise_frame,
};
use rcs_core::name::Name16;
use taskdata::files::Location;

use super::both::Both;

/// Greatest distance of a body from its place, inches and degrees: less than the clearances of the nests (SPECNOTES).
const INCHES: f64 = 0.25;
const DEGREES: f64 = 2.0;

/// Locations of the holsters (V.2.1 MOV-TO-HOL), and their entries.
const HOLSTERS: [(&str, &str); 3] =
    [("HOLSTER-R", "holsters.right"), ("HOLSTER-L", "holsters.left"), ("HOLSTER-C", "holsters.centre")];

/// A body of the cell at a location: its entry in the cell description, the name of the location, and its frame.
pub type Body<'a> = (&'static str, &'a str, Frame);

pub fn bodies(cell: &CellDescription) -> impl Iterator<Item = Body<'_>> {
    let pedestal = &cell.pedestal;
    let radial = Rotation::from_axis_angle(&Vector::z_axis(), pedestal.azimuth.to_radians());
    let pedestal_frame = Frame { position: Vector::from(pedestal.position), rotation: radial };
    let holsters = [&cell.holsters.right, &cell.holsters.left, &cell.holsters.centre];
    let points = HOLSTERS.into_iter().zip(holsters).map(|((name, entry), points)| (entry, name, points));
    let points = points.chain([("drum.pose", cell.drum.location.as_str(), &cell.drum.pose)]);
    let framed = points.filter_map(|(entry, name, points)| Some((entry, name, points.frame()?)));
    [
        ("vise.position", cell.vise.location.as_str(), vise_frame(&cell.vise)),
        ("pedestal.position", pedestal.location.as_str(), pedestal_frame),
    ]
    .into_iter()
    .chain(framed)
}

pub fn check(both: &mut Both<'_>) {
    for (entry, name, frame) in bodies(both.cell) {
        stands(both, entry, name, &frame);
    }
    trays(both);
    nests(both);
}

fn stands(both: &mut Both<'_>, entry: &str, name: &str, body: &Frame) {
    let Some(location) = both.location(name, 0, None) else { return };
    if let Some(apart) = apart(body, &location.frame) {
        let form = both.origin(&location);
        both.entry(entry, format!("{apart}, from {name} in the task data"), form);
    }
}

fn trays(both: &mut Both<'_>) {
    let cell = both.cell;
    let loose = |part: &&PartType| !cell.nest.iter().any(|nest| nest.takes(part));
    for (number, tray) in cell.tray.iter().enumerate() {
        let found = (1..=tray.sectors.len()).find_map(|sector| {
            let sector = u16::try_from(sector).ok()?;
            let here = |part: &PartType| both.location(&tray.unit, sector, Some(&part.name));
            let location = cell.part.iter().filter(loose).find_map(here)?;
            Some((sector, location, apart(&tray.sector(sector)?, &location.frame)?))
        });
        if let Some((sector, location, apart)) = found {
            let form = both.origin(&location);
            let entry = format!("tray[{number}].sectors[{}]", sector - 1);
            both.entry(
                &entry,
                format!("{apart}, from sector {sector} of {} in the task data", tray.unit),
                form,
            );
        }
    }
}

fn nests(both: &mut Both<'_>) {
    let cell = both.cell;
    for (number, nest) in cell.nest.iter().enumerate() {
        let mut parts = cell.part.iter().filter(|part| nest.takes(part));
        if let Some((location, message)) = parts.find_map(|part| beside(both, number, part)) {
            let form = both.origin(&location);
            both.entry(&format!("nest[{number}].seat"), message, form);
        }
    }
}

/// Checks that the tool point of a grip is inside the part, and at the same point of the part in all nests. For a
/// cylinder only the position along the axis matters. Returns the first wrong grip, and the reason.
fn beside(both: &Both<'_>, number: usize, part: &PartType) -> Option<(Location, String)> {
    let (name, data) = (Name16::clipped(&part.name), both.data);
    let nest = both.cell.nest.get(number)?;
    let first = both.cell.nest.iter().take(number).find(|other| other.takes(part));
    let of_part = data.end_effs.iter().filter(|record| data.object_name(record.object) == name);
    of_part.map(|record| record.grip).find_map(|grip| {
        let (location, seen) = grip_in(both, nest, &name, grip)?;
        let beyond = |(at, size): (f64, f64)| (at.abs() - size / 2.0).max(0.0);
        let outside = [seen.x, seen.y, seen.z].into_iter().zip(part.size).map(beyond).fold(0.0, f64::max);
        let other = first.and_then(|first| grip_in(both, first, &name, grip));
        let moved = other.map_or(0.0, |(_, other)| match part.shape {
            Shape::Box => (seen - other).norm(),
            Shape::CylinderX => (seen.x - other.x).abs(),
            Shape::CylinderZ => (seen.z - other.z).abs(),
        });
        let how = if outside > INCHES {
            format!("{outside:.2} in beside the part in the nest")
        } else if moved > INCHES {
            format!("{moved:.2} in from where it is in the first nest of the part")
        } else {
            return None;
        };
        let sector = location.sector.map_or(String::new(), |sector| format!(" sector {sector}"));
        let at = location.name;
        Some((
            location,
            format!("grip {grip:+} of {name} at {at}{sector} is {how}, {INCHES} at most expected"),
        ))
    })
}

fn grip_in(both: &Both<'_>, nest: &Nest, part: &Name16, grip: i32) -> Option<(Location, Vector)> {
    let location = both.location(&nest.location, nest.sector, Some(part.as_str()))?;
    let frame = both.data.grip_frame(part, grip, &location).ok()?;
    Some((location, nest.frame().inverse().compose(&frame).position))
}

/// The distance between two frames as text, if it exceeds the tolerance.
fn apart(one: &Frame, other: &Frame) -> Option<String> {
    let distance = (one.position - other.position).norm();
    let degrees = one.rotation.angle_to(&other.rotation).to_degrees();
    if distance > INCHES {
        Some(format!("{distance:.2} in away, {INCHES} at most expected"))
    } else if degrees > DEGREES {
        Some(format!("{degrees:.1} degrees away, {DEGREES} at most expected"))
    } else {
        None
    }
}
