//! Compares openings, forces and view ranges of the forms with the cell (VII.7.1, VII.7.2, VII.7.4, VII.7.6).

use geometry::{frame::Frame, units::Length};
use levels::subtask::aims::GRIPPERS;
use plant::{
    camera::optics::Optics,
    description::{Gripper, PartType, Shape},
};
use taskdata::files::{EndEffPara, RefType, VisionPara};

use super::both::Both;

/// Fingers within this distance of the width of a part are treated as touching it, in: rounding of the forms.
const ROUNDING: f64 = 0.005;
const TOOL_GRIPPER: i32 = 3; // `endeff-id#` of the tool gripper (VII.7.2)
const MM: f64 = 25.4; // millimetres in an inch

fn inches(hundredths: i32) -> f64 {
    f64::from(hundredths) / 100.0
}

pub fn check(both: &mut Both<'_>) {
    for (index, record) in both.data.end_effs.iter().enumerate() {
        grip(both, index, record);
    }
    for (index, record) in both.data.ped_paras.iter().enumerate() {
        let name = both.data.object_name(record.object).to_string();
        let (hand, origins) = (&both.cell.pedestal.hand, &both.store.origins().ped_paras);
        let sizes = [
            ("ped-appr", record.appr),
            ("ped-grasp-size", record.grasp_size),
            ("ped-release-size", record.release_size),
        ];
        let entry = "pedestal.hand.opening";
        let out: Vec<String> = sizes
            .iter()
            .filter_map(|(what, size)| beyond(what, *size, hand.opening, "the pedestal's hand"))
            .collect();
        let force = unfit_force("ped-force", record.force, hand);
        for message in out {
            both.form(origins, Some(index), format!("{name}: {message}"), entry);
        }
        if let Some(message) = force {
            both.form(origins, Some(index), format!("{name}: {message}"), "pedestal.hand.greatest_force");
        }
        let [low, high] = both.cell.pedestal.table.limits;
        let turned = f64::from(record.table_pos.saturating_add(record.flip_angle)) / 10.0;
        let angles = [
            ("ped-table-pos", f64::from(record.table_pos) / 10.0),
            ("ped-table-pos + ped-flip-angle", turned),
        ];
        if let Some((what, angle)) = angles.into_iter().find(|(_, angle)| !(low..=high).contains(angle)) {
            let message =
                format!("{name}: {what} is {angle:.1} degrees, the table turns from {low:.0} to {high:.0}");
            both.form(origins, Some(index), message, "pedestal.table.limits");
        }
    }
    // If a tray is at another place, every range to it is wrong.
    let views = both.data.visions.iter().enumerate().filter(|(_, record)| record.enabled);
    for (index, record) in views.take_while(|_| both.places_agree()).collect::<Vec<_>>() {
        view(both, index, record);
    }
}

fn beyond(what: &str, size: i32, [low, high]: [f64; 2], gripper: &str) -> Option<String> {
    let size = inches(size);
    let outside = size < low - ROUNDING || size > high + ROUNDING;
    outside.then(|| format!("{what} {size:.2} in, {gripper} opens from {low:.2} to {high:.2} in"))
}

/// The message for a force that is greater than the fingers can exert, or too small to hold anything.
fn unfit_force(what: &str, force: i32, gripper: &Gripper) -> Option<String> {
    let greatest = gripper.greatest_force;
    if force <= 0 {
        return Some(format!(
            "{what} {force} lb, 1 to {greatest} lb expected: without force nothing is held"
        ));
    }
    (f64::from(force) > greatest)
        .then(|| format!("{what} {force} lb, the fingers have {greatest} lb at most"))
}

/// The gripper of an `endeff-id#` and its table in the description.
fn gripper<'a>(both: &Both<'a>, id: i32) -> Option<(&'static str, &'static str, &'a Gripper)> {
    let grippers = &both.cell.gripper;
    match id {
        1 => Some(("gripper.parts", "the parts gripper", &grippers.parts)),
        2 => Some(("gripper.v", "the v-gripper", &grippers.v)),
        3 => Some(("gripper.tool", "the tool gripper", &grippers.tool)),
        _ => None,
    }
}

fn grip(both: &mut Both<'_>, index: usize, record: &EndEffPara) {
    let object = both.data.object_name(record.object);
    let origins = &both.store.origins().end_effs;
    let cell = both.cell;
    let part = cell.part.iter().position(|part| part.name == object.as_str());
    let what = format!("grip {:+} of {object}", record.grip);
    // Grippers are objects too, but the arm locks onto them instead of holding them.
    if GRIPPERS.contains(&object.as_str()) {
        return;
    }
    let id = both.data.obj_grips(&object).map(|grips| grips.endeff_id);
    let Some((table, name, gripper)) = id.and_then(|id| gripper(both, id)) else {
        // Objects that are not parts, such as a push of the fingers, are possible with any gripper.
        if let Some(part) = part.filter(|_| id.is_none()) {
            let message = format!("{object} is a part, and no OBJ-GRIPS record names its gripper (VII.7.2)");
            both.form(origins, Some(index), message, &format!("part[{part}].name"));
        } else if let Some(message) = unfit_force("grasp force", record.grasp_force, &cell.gripper.parts) {
            both.form(origins, Some(index), format!("{what}: {message}"), "gripper.parts.greatest_force");
        }
        return;
    };
    let sizes = [
        ("approach size", record.appr_size),
        ("grasp size", record.grasp_size),
        ("depart size", record.depart_size),
    ];
    let out = sizes.into_iter().find_map(|(size, value)| beyond(size, value, gripper.opening, name));
    if let Some(message) = out {
        both.form(origins, Some(index), format!("{what}: {message}"), &format!("{table}.opening"));
        return;
    }
    if let Some(message) = unfit_force("grasp force", record.grasp_force, gripper) {
        both.form(origins, Some(index), format!("{what}: {message}"), &format!("{table}.greatest_force"));
        return;
    }
    let Some((number, part)) = part.and_then(|number| Some((number, cell.part.get(number)?))) else { return };
    // Grooves hold cylinders, and only the tool gripper has enough force for a tool.
    let unfit = gripper.groove.is_some() && part.shape == Shape::Box;
    if unfit || part.tool != (id == Some(TOOL_GRIPPER)) {
        let kind = if part.tool {
            "tool"
        } else if part.shape == Shape::Box {
            "box"
        } else {
            "cylinder"
        };
        let message = format!("{what}: {object} is a {kind}, and OBJ-GRIPS names {name} for it");
        both.form(origins, Some(index), message, &format!("part[{number}].name"));
        return;
    }
    let (grasp, around) = (inches(record.grasp_size), inches(record.appr_size.min(record.depart_size)));
    let widths = widths(both, record, part);
    if !widths.iter().any(|width| grasp <= width + ROUNDING && *width < around) {
        let shown: Vec<String> = widths.iter().map(|width| Length(*width).to_string()).collect();
        let message = format!(
            "{what}: {} between the fingers is not from the grasp size {grasp:.2} in to the approach and depart sizes {:.2} in and {:.2} in",
            shown.join(" or "),
            inches(record.appr_size),
            inches(record.depart_size),
        );
        both.form(origins, Some(index), message, &format!("part[{number}].size"));
    }
    // The other grippers have no force control (VI.4).
    let carried = 2.0 * gripper.friction * f64::from(record.grasp_force);
    if id == Some(1) && carried < part.weight {
        let message = format!(
            "{what}: with {} lb and a friction of {} the fingers carry {carried:.2} lb, the part weighs {} lb",
            record.grasp_force, gripper.friction, part.weight
        );
        both.form(origins, Some(index), message, &format!("part[{number}].weight"));
    }
}

/// Possible widths of a part between the fingers, in. On a tray, X of the part points down, and the movetable of the
/// grip determines the side; elsewhere any side is possible.
fn widths(both: &Both<'_>, record: &EndEffPara, part: &PartType) -> Vec<f64> {
    let on_tray = |kind| matches!(kind, RefType::Any | RefType::Array);
    let grips = both.data.grip_locs.iter().filter(|g| g.object == record.object && g.grip == record.grip);
    let turned =
        grips.filter(|g| on_tray(g.at.kind)).map(|g| both.data.moved(&Frame::identity(), g.movetable));
    let across = |frame: Frame| {
        let y = frame.y();
        [y.x, y.y, y.z].into_iter().zip(part.size).find(|(share, _)| share.abs() > 0.9).map(|(_, size)| size)
    };
    let assigned = both.data.object_locations(record.object).any(|at| at.kind == RefType::Array);
    let mut known: Vec<f64> =
        turned.filter_map(across).filter(|_| assigned && part.shape == Shape::Box).collect();
    if known.is_empty() {
        known.extend(part.size);
    }
    known.sort_by(f64::total_cmp);
    known.dedup();
    known
}

/// Check the range of a view, to the top of the part on the tray: it scales all lengths in the picture.
fn view(both: &mut Both<'_>, index: usize, record: &VisionPara) {
    let object = both.data.object_name(record.object);
    let cell = both.cell;
    let Some(part) = cell.part(object.as_str()) else { return };
    let seen = cell.tray.iter().find_map(|tray| {
        let location = both.location(&tray.unit, 1, Some(object.as_str()))?;
        let (id, _) = both.data.view(&object, &location.place)?;
        let frame = both.data.moved(&location.frame, record.movetable);
        let is_this = id.index() == Some(index) && record.offset_from != RefType::Object;
        is_this.then(|| (Optics::new(&cell.camera).frame(&frame), tray.floor + part.size[0]))
    });
    let Some((camera, top)) = seen else { return };
    let range = (top - camera.position.z) / camera.x().z * MM;
    let off = (f64::from(record.range) - range).abs() / range;
    let longest = part.size.into_iter().fold(0.0, f64::max);
    if !(range > 0.0 && off * longest <= cell.camera.shape_tolerance) {
        let message = format!(
            "the view of {object} has the range {} mm, its top is {range:.0} mm from the camera there",
            record.range
        );
        both.form(&both.store.origins().visions, Some(index), message, "camera.position");
    }
}
