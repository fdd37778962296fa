//! Checks of claims about parts in the fingers, in their places and in the drum.

use geometry::frame::{Frame, Vector};
use plant::{Cell, PartState, description::PartType};
use rcs_core::name::Name16;

use super::{
    NotSensed, Scene,
    contradiction::{Contradiction, expect},
    history::{History, apart},
    tolerance::{GRIP_INCHES, WIDTH_INCHES},
};

pub fn named<'p>(parts: &'p [PartState], object: &'p str) -> impl Iterator<Item = &'p PartState> {
    parts.iter().filter(move |part| part.name == object)
}

/// True if two kinds have the same outline from above within a tolerance, in. The camera does not measure heights.
pub fn is_alike(one: &PartType, other: &PartType, tolerance: f64) -> bool {
    let outlines = one.size.iter().zip(other.size).skip(1);
    one.shape == other.shape && outlines.into_iter().all(|(a, b)| (a - b).abs() <= tolerance)
}

pub fn is_held(
    scene: &Scene<'_>,
    history: &History,
    object: &Name16,
    place: &[Frame],
    unseen: bool,
) -> Result<(), Contradiction> {
    let cell = scene.cell;
    let Some(id) = cell.held() else {
        return Err(Contradiction::sensed(format!("the robot does not hold {object}: it holds nothing")));
    };
    let (Some(kind), Some(frame)) = (cell.part_kind(id), cell.part_frame(id)) else { return Ok(()) };
    if kind.name != object.as_str() {
        let text = format!("the robot holds {}, not {object}", kind.name);
        let asked = cell.description().part(object.as_str());
        let same_width = asked.is_some_and(|asked| same_width(asked, kind));
        let same_picture =
            asked.is_some_and(|asked| is_alike(asked, kind, cell.description().camera.shape_tolerance));
        let not_sensed = if same_width && (unseen || same_picture) {
            Some(NotSensed::EqualPart)
        } else if same_width && history.is_any_changed_since_look(object.as_str()) {
            Some(NotSensed::ChangedAfterLook)
        } else {
            None
        };
        return Err(Contradiction { text, not_sensed });
    }
    let Some(meant) = place.first() else { return Ok(()) };
    let is = cell.t3().arm().tool().inverse().compose(&frame).position;
    // The fingers centre the part along tool Y. The grips of a long part differ along its axis.
    let off = (is.x - meant.position.x).hypot(is.z - meant.position.z);
    if off <= GRIP_INCHES {
        return Ok(());
    }
    let text = format!("{object} is {off:.2} in from its place in the fingers, {GRIP_INCHES} in allowed");
    let not_sensed = if unseen && history.is_changed(id) {
        Some(NotSensed::NoPicture)
    } else if history.is_any_changed_since_look(object.as_str()) || history.is_any_changed_since_grasp() {
        Some(NotSensed::ChangedAfterLook)
    } else {
        history.displaced(id).or_else(|| history.occupied(cell, id))
    };
    Err(Contradiction { text, not_sensed })
}

/// True if the fingers cannot distinguish two kinds: they have a width in common.
pub fn same_width(one: &PartType, other: &PartType) -> bool {
    one.size.iter().any(|a| other.size.iter().any(|b| (a - b).abs() <= WIDTH_INCHES))
}

pub fn is_held_alone(cell: &Cell) -> Result<(), Contradiction> {
    let both = cell.held().and_then(|id| cell.holders(id)).is_some_and(|holders| holders.pedestal);
    expect(!both, || "the pedestal still holds the part, too".to_owned())
}

pub fn holds_nothing(cell: &Cell) -> Result<(), Contradiction> {
    let held = cell.held().and_then(|id| cell.part_kind(id));
    expect(held.is_none(), || {
        format!("the robot still holds {}", held.map_or("something", |kind| kind.name.as_str()))
    })
}

pub fn is_placed(cell: &Cell, history: &History, object: &Name16, goal: &Frame) -> Result<(), Contradiction> {
    // Without a release since the start of the judge, Task's claim about the location decides.
    let Some(released) = history.released() else { return Ok(()) };
    let parts = cell.parts();
    let changed = history.is_changed_since(released.id, released.tick);
    let not_sensed = changed
        .then_some(NotSensed::ChangedAfterLook)
        .or_else(|| history.displaced(released.id))
        .or_else(|| history.occupied(cell, released.id));
    let Some(part) = parts.iter().find(|part| part.id == released.id) else {
        return Err(Contradiction { text: format!("{object} is not in the cell"), not_sensed });
    };
    if part.name != object.as_str() {
        return Ok(());
    }
    let tolerance = cell.description().placing_tolerance;
    let off = apart(&released.tool.position, &goal.position);
    if off > tolerance {
        let text = format!("{object} was released {off:.2} in from its goal, {tolerance} in allowed");
        return Err(Contradiction::sensed(text));
    }
    let moved = apart(&Vector::from(part.position), &released.part.position);
    if moved > tolerance {
        let text = format!(
            "{object} is {moved:.2} in from where the fingers have released it, {tolerance} in allowed"
        );
        return Err(Contradiction { text, not_sensed });
    }
    Ok(())
}

pub fn lies_at(
    cell: &Cell,
    history: &History,
    object: &Name16,
    (location, sector): &(String, u16),
) -> Result<(), Contradiction> {
    let parts = cell.parts();
    let there = |part: &&PartState| !part.held && part.location == *location && part.sector == *sector;
    if named(&parts, object.as_str()).any(|part| there(&part)) {
        return Ok(());
    }
    let place = if *sector == 0 { location.clone() } else { format!("{location} {sector}") };
    let where_it_is = |part: &PartState| match part.sector {
        0 => part.location.clone(),
        sector => format!("{} {sector}", part.location),
    };
    let found: Vec<String> = named(&parts, object.as_str()).map(where_it_is).collect();
    let text = match &found[..] {
        [] => format!("no {object} is at {place}, nor anywhere else"),
        found => format!("no {object} is at {place}, but at {}", found.join(" and ")),
    };
    let released = history.released();
    let other = released.and_then(|released| cell.part_kind(released.id)).is_some_and(|kind| {
        kind.name != object.as_str()
            && cell.description().part(object.as_str()).is_some_and(|asked| same_width(asked, kind))
    });
    let changed = released.is_some_and(|released| history.is_changed_since(released.id, released.tick));
    let not_sensed = if changed {
        Some(NotSensed::ChangedAfterLook)
    } else if other {
        Some(NotSensed::EqualPart)
    } else {
        released.and_then(|released| {
            history.displaced(released.id).or_else(|| history.occupied(cell, released.id))
        })
    };
    Err(Contradiction { text, not_sensed })
}

/// Distance of the nearest part of a name from its place in the drum, in: along the axis, and across it.
pub fn from_drum(cell: &Cell, object: &Name16) -> Option<(u32, f64, f64)> {
    let parts = cell.parts();
    let of = |part: &PartState| {
        let entering = cell.at_drum(part.id)?;
        Some((part.id, entering.left, entering.aside))
    };
    named(&parts, object.as_str()).filter_map(of).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

pub fn is_in_drum(cell: &Cell, history: &History, object: &Name16) -> Result<(), Contradiction> {
    let seated = cell.description().drum.seated;
    let (text, id) = match from_drum(cell, object) {
        Some((_, left, aside)) if left.abs() <= seated && aside <= seated => return Ok(()),
        Some((id, left, aside)) => {
            let text =
                format!("{object} is {left:.2} in before and {aside:.2} in beside its place in the drum");
            (text, Some(id))
        }
        None => (format!("{object} is not in the drum"), history.released().map(|released| released.id)),
    };
    let since = history.released().map(|released| released.tick);
    let changed = id.zip(since).is_some_and(|(id, since)| history.is_changed_since(id, since));
    Err(Contradiction { text, not_sensed: changed.then_some(NotSensed::ChangedAfterLook) })
}

pub fn is_out_of_drum(cell: &Cell, object: &Name16) -> Result<(), Contradiction> {
    let length = cell.description().drum.detent_length;
    let inside = from_drum(cell, object).filter(|(_, left, _)| *left <= length);
    expect(inside.is_none(), || format!("{object} is still in the drum"))
}
