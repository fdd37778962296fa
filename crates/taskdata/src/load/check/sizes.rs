//! Object forms: openings in order, tray grips with an object form, flip angles other than 0 (VII.7.1, VII.7.2,
//! VII.7.4).

use crate::files::TaskData;

use super::{Findings, Origins, origin};

pub(super) fn check(data: &TaskData<'_>, origins: &Origins, findings: &mut Findings) {
    for (i, record) in data.end_effs.iter().enumerate() {
        let what = format!("grip {:+} of {}", record.grip, data.object_name(record.object));
        let sizes = [("approach", record.appr_size), ("depart", record.depart_size)];
        in_order(&what, record.grasp_size, sizes, origin(&origins.end_effs, i), findings);
    }
    // An unknown object is reported by its name.
    for (i, record) in data.ped_paras.iter().enumerate().filter(|(_, record)| !record.object.is_null()) {
        let what = format!("the pedestal with {}", data.object_name(record.object));
        let sizes = [("approach", record.appr), ("release", record.release_size)];
        let at = origin(&origins.ped_paras, i);
        in_order(&what, record.grasp_size, sizes, at, findings);
        if record.flip_angle == 0 {
            let help = "give the angle that turns the object from one grip to the other (VII.7.4)".to_owned();
            findings.error_once("pedestal.flip", at, format!("{what}: ped-flip-angle is 0"), help);
        }
    }
}

pub(super) fn tray_grips(data: &TaskData<'_>, origins: &Origins, findings: &mut Findings) {
    for (i, record) in data.obj_grips.iter().enumerate() {
        let object = data.object_name(record.object);
        if data.object(&object, record.tray_grip).is_none() {
            let message =
                format!("tray-grip# of {object} is {}, and no object form has that grip", record.tray_grip);
            let grips = data.end_effs.iter().filter(|e| e.object == record.object);
            let grips: Vec<String> = grips.map(|e| e.grip.to_string()).collect();
            let help = format!("{object} has grip {}", grips.join(", "));
            findings.error_once("grip.tray", origin(&origins.obj_grips, i), message, help);
        }
    }
}

/// Reports an opening before or after a grasp that is smaller than the grasp size.
fn in_order(what: &str, grasp: i32, sizes: [(&str, i32); 2], at: super::At, findings: &mut Findings) {
    let narrow: Vec<String> = sizes
        .into_iter()
        .filter(|(_, size)| *size < grasp)
        .map(|(name, size)| format!("{name} size {size}"))
        .collect();
    if !narrow.is_empty() {
        let message =
            format!("{what}: the {} is smaller than the grasp size {grasp}", narrow.join(" and the "));
        let help = "the fingers are open before and after a grasp (VII.7.1); sizes are in 0.01 in".to_owned();
        findings.error_once("size.order", at, message, help);
    }
}
