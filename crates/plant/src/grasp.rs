//! Decides when fingers grip, keep and release a part, from its geometry ([`crate::squeeze`]) and the air's force.

use rapier3d_f64::math::{Pose, Real, Vector};

use crate::{
    convert::{inches, metres},
    description::Gripper,
    gripper::Air,
    jaws::Supply,
    part::segment_meets_box,
    squeeze::{Pads, Squeeze},
};

const LEAST_FORCE: f64 = 0.25; // least force of a finger that holds a part, lb
const TOUCHING: Real = 1e-4; // greatest distance between a pad and a face in contact, m
/// A part between the fingers is nearer to the fingertips than this distance plus its own radius, m.
const REACH: Real = 0.2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grasp {
    Empty,
    Take,
    Keep,
    Release,
}

/// The decision after the air has moved the fingers; `stop` is the opening at which a part between them stops them, in.
#[must_use]
pub fn decide(holds: bool, stop: Option<f64>, air: &Air) -> Grasp {
    let presses = air.force() >= LEAST_FORCE;
    match (holds, stop) {
        (true, Some(_)) if presses => Grasp::Keep,
        (true, _) => Grasp::Release,
        (false, Some(stop)) if presses && air.opening() <= stop + 1e-6 => Grasp::Take,
        (false, _) => Grasp::Empty,
    }
}

/// Move the fingers by their air supply for `dt` seconds, up to the opening at which a part stops them, in.
pub fn drive(air: &mut Air, dt: f64, supply: Supply, stop: Option<f64>, holds: bool) {
    if let (Some(stop), true) = (stop, holds)
        && (stop - air.opening()).abs() > 1e-5
        && air.force() >= LEAST_FORCE
    {
        // The two fingers are coupled: a part pushed off the middle spreads them, and they follow it when it returns.
        air.spread(stop);
    }
    air.advance(dt, supply, stop);
}

/// True if a part with its centre at this distance from the fingertips, and this radius, may be between the fingers, m.
#[must_use]
pub fn is_near(distance: Real, radius: Real) -> bool {
    distance < REACH + radius
}

/// The widest of the parts that fit between open fingers; `opening` in inches.
pub fn widest(opening: f64, parts: impl Iterator<Item = (usize, Squeeze)>) -> Option<(usize, Squeeze)> {
    let opening = metres(opening);
    parts
        .filter(|(_, squeeze)| squeeze.width <= opening + TOUCHING && squeeze.centre.abs() < opening / 2.0)
        .max_by(|(_, a), (_, b)| a.width.total_cmp(&b.width))
}

/// Opening at which a part stops the fingers, in. A part that another device holds is `fast`. It stops
/// the nearer finger, and so the other finger too.
#[must_use]
pub fn stop(squeeze: &Squeeze, fast: bool) -> f64 {
    let aside = if fast { 2.0 * squeeze.centre.abs() } else { 0.0 };
    inches(squeeze.width + aside)
}

/// Pose in the tool frame of a free part that fingers have closed on, m: its face on the pads, in the middle.
#[must_use]
pub fn drawn(squeeze: &Squeeze) -> Pose {
    let mut flush = squeeze.flush;
    flush.translation.y = 0.0;
    flush
}

/// The pads of a gripper in its tool frame.
#[must_use]
pub fn pads(gripper: &Gripper) -> Pads {
    let [length, _, width] = gripper.fingers.map(metres);
    let groove = gripper.groove.map(metres);
    Pads { x: [-length, 0.0], z: [-width / 2.0, width / 2.0], groove }
}

/// The light beams that parts interrupt, one bit each; `opening` in inches, `parts` with pose and half size, m.
pub fn broken_beams(opening: f64, parts: impl Iterator<Item = (Pose, Vector)>) -> u8 {
    let near: Vec<_> =
        parts.filter(|(pose, half)| is_near(pose.translation.length(), half.length())).collect();
    let broken = beams(opening)
        .map(|(from, to)| near.iter().any(|(pose, half)| segment_meets_box(from, to, pose, *half)));
    broken.enumerate().fold(0, |bits, (beam, is_broken)| bits | (u8::from(is_broken) << beam))
}

/// The light beams in the tool frame, as end points on the pads, m. ASSUMED: two columns of four, 0.5 in to either side
/// of the middle of a finger, 0.10 to 1.20 in behind the tips.
fn beams(opening: f64) -> impl Iterator<Item = (Vector, Vector)> {
    let half = metres(opening / 2.0);
    let columns = [metres(-0.5), metres(0.5)];
    columns.into_iter().flat_map(move |z| {
        [0.10, 0.30, 0.60, 1.20].map(move |behind| {
            let x = -metres(behind);
            (Vector::new(x, -half, z), Vector::new(x, half, z))
        })
    })
}
