//! Checks of claims about parts that the camera searches for.

use geometry::frame::{Frame, Vector, rotation_by};
use plant::{Cell, PartState};
use rcs_core::name::Name16;
use taskdata::files::MovtabId;

use super::{
    NotSensed, Scene,
    contradiction::{Contradiction, expect},
    history::History,
    parts::is_alike,
    robot::is_at,
    tolerance::{SEEN_DEGREES, SEEN_INCHES},
};

/// A movetable, resolved: the motion from a reference frame to the goal, in the axes of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement(pub MovtabId);

/// Greatest distance of a part from the centre of its sector, in: half the distance of two sectors.
const SECTOR_INCHES: f64 = 5.25;

/// The nearest part of a name within half a sector of a point.
pub fn nearest(cell: &Cell, object: &str, near: &Vector) -> Option<PartState> {
    let beside = |part: &PartState| {
        let [x, y, _] = part.position;
        (x - near.x).hypot(y - near.y)
    };
    let parts = cell.parts().into_iter().filter(|part| part.name == object && !part.held);
    let nearest = parts.min_by(|a, b| beside(a).total_cmp(&beside(b)))?;
    (beside(&nearest) <= SECTOR_INCHES).then_some(nearest)
}

/// The nearest part with the object's name within half a sector. If there is none, the part with this name that the
/// camera saw at the place that E-move reports.
fn meant(scene: &Scene<'_>, object: &str, near: &Vector, reported: Option<&Frame>) -> Option<PartState> {
    let is_reported = |part: &PartState| {
        reported.is_some_and(|reported| {
            seen(scene.cell, part).iter().any(|frame| frame.distance(reported).inches <= SEEN_INCHES)
        })
    };
    let there = |part: &PartState| part.name == object && !part.held && is_reported(part);
    nearest(scene.cell, object, near).or_else(|| scene.cell.parts().into_iter().find(there))
}

/// The frame of a part found by the camera, as E-move reports it.
fn report(scene: &Scene<'_>) -> Option<Frame> {
    scene.memory.emove.estimates.located.and_then(|located| located.pose.to_frame().ok())
}

/// Frames that the camera may report for a part in a tray: the part may be turned by half a turn.
pub fn seen(cell: &Cell, part: &PartState) -> Vec<Frame> {
    let (Some(frame), Some(kind)) = (cell.part_frame(part.id), cell.part_kind(part.id)) else {
        return Vec::new();
    };
    let down = Vector::new(0.0, 0.0, -kind.size[0] / 2.0);
    let lying = Frame { position: frame.position + down, ..frame };
    let half_turn = rotation_by(&Vector::new(core::f64::consts::PI, 0.0, 0.0));
    vec![lying, lying.turned(&half_turn)]
}

pub fn at_part(
    scene: &Scene<'_>,
    history: &History,
    object: &str,
    near: &Frame,
    Movement(movetable): Movement,
) -> Result<(), Contradiction> {
    let changed = history.is_any_changed_since_look(object).then_some(NotSensed::ChangedAfterLook);
    let found = meant(scene, object, &near.position, report(scene).as_ref());
    let checked = match &found {
        None => {
            let other = looks_like(scene, object, near, SECTOR_INCHES);
            let text = format!("{} lies there, no {object}", other.as_deref().unwrap_or("nothing"));
            let not_sensed = other.map(|_| NotSensed::EqualPart);
            return Err(Contradiction { text, not_sensed: not_sensed.or(changed) });
        }
        Some(part) => {
            let goals: Vec<_> =
                seen(scene.cell, part).iter().map(|base| scene.data.moved(base, movetable)).collect();
            is_at(scene.cell, &goals, object, SEEN_INCHES, SEEN_DEGREES)
        }
    };
    checked.map_err(|contradiction| Contradiction { not_sensed: changed, ..contradiction })
}

pub fn is_located(
    scene: &Scene<'_>,
    history: &History,
    object: &Name16,
    near: &Frame,
) -> Result<(), Contradiction> {
    let Some(reported) = report(scene) else {
        return Err(Contradiction::sensed(format!("E-move reports no place of {object}")));
    };
    let Some(part) = meant(scene, object.as_str(), &near.position, Some(&reported)) else {
        let looks_like = looks_like(scene, object.as_str(), &reported, SEEN_INCHES);
        let text = match &looks_like {
            Some(other) => format!("{other} lies there, no {object}"),
            None => format!("no {object} lies there"),
        };
        let equal = looks_like.is_some().then_some(NotSensed::EqualPart);
        let changed = history.is_any_changed_since_look(object.as_str());
        let not_sensed = equal.or_else(|| changed.then_some(NotSensed::ChangedAfterLook));
        return Err(Contradiction { text, not_sensed });
    };
    let far = seen(scene.cell, &part)
        .iter()
        .map(|frame| frame.distance(&reported))
        .map(|distance| (distance.inches, distance.radians.to_degrees()))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let best = seen(scene.cell, &part).iter().any(|frame| {
        let distance = frame.distance(&reported);
        distance.inches <= SEEN_INCHES && distance.radians.to_degrees() <= SEEN_DEGREES
    });
    expect(best, || {
        let (inches, degrees) = far.unwrap_or_default();
        format!("{object} is {inches:.3} in and {degrees:.2} degrees from where E-move reports it")
    })
}

/// A part near a place, within some inches, that looks like another one to the camera.
pub fn looks_like(scene: &Scene<'_>, object: &str, at: &Frame, within: f64) -> Option<String> {
    let description = scene.cell.description();
    let asked = description.part(object)?;
    let tolerance = description.camera.shape_tolerance;
    let parts = scene.cell.parts();
    let other = parts.iter().filter(|part| !part.held).find(|part| {
        let [x, y, _] = part.position;
        (x - at.position.x).hypot(y - at.position.y) <= within
    })?;
    let kind = scene.cell.part_kind(other.id)?;
    is_alike(asked, kind, tolerance).then(|| other.name.clone())
}
