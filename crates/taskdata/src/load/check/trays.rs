//! Checks that the sectors of arrays are within their trays (VII.4).

use geometry::frame::Frame;

use crate::files::{ArrayId, RefType, Reference, TaskData};

use super::{Findings, Origins, at_point, origin, owners_of};

/// Inches. ASSUMED: the printed arrays fill a square of 21.00 with equal margins (VIII.6; SPECNOTES).
const TRAY: f64 = 21.0;
const ROUNDING: f64 = 0.01;

pub(super) fn check(data: &TaskData<'_>, origins: &Origins, findings: &mut Findings) {
    for (i, array) in data.arrays.iter().enumerate() {
        let reference = Reference::array(ArrayId::at(i));
        // An array is the same at all its trays.
        let corner = owners_of(data, reference)
            .filter_map(|owner| data.members_of(owner).first())
            .find(|member| member.member.kind == RefType::LocationPoint)
            .and_then(|member| at_point(data, member.member));
        let Some(corner) = corner else { continue };
        for sector in 1..=array.sectors() {
            let Some(frame) = data.sector_frame(array, &corner.frame, sector) else { continue };
            let outside = outside(&corner.frame, &frame);
            if outside > ROUNDING {
                findings.error(
                    "array.tray",
                    origin(&origins.arrays, i),
                    format!("sector {sector} of {} is {outside:.2} in outside its tray", array.name),
                    format!(
                        "a tray is {TRAY:.2} in square; its corner is {}, columns lead along tool -Y and rows along -Z",
                        corner.name
                    ),
                );
            }
        }
    }
}

/// Distance beyond the tray at a corner, in; negative inside. The corner's tool frame points down; the tray extends
/// along its -Y and -Z (VIII.6).
fn outside(corner: &Frame, sector: &Frame) -> f64 {
    let seen = corner.inverse().compose(sector).position;
    let beyond = |along: f64| (along - TRAY).max(-along);
    beyond(-seen.y).max(beyond(-seen.z))
}
