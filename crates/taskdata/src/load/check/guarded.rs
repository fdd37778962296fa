//! Relative moves: each has a command, guarded ones a sensor and a speed that lets the robot stop in time.

use diagnostics::nearest;
use interfaces::device::{ADC_FULL_SCALE, FORCE_COUNTS_PER_LB, FORCE_ZERO, MOMENT_COUNTS_PER_IN_LB};

use rcs_core::name::Name16;

use crate::files::{RelativeMove, SensorSource, TaskData};

use super::{
    super::guarded::{RELATIVE_MOVES, relative_move_named},
    Findings, Origins, origin,
};

const HALT: f64 = 0.2; // s, from condition to rest (docs/design/motion.md "Guarded speed")
const STIFFNESS: f64 = 2000.0; // lb/in of a hard object: the arm's stiffness (ASSUMED)
const LEVER: f64 = 8.0; // in, tool point to force sensor (ASSUMED, `data/cell.toml`)
/// in/s per count of `vel-max` (ASSUMED, as in `levels::prim::motion::limits`; docs/design/motion.md "Units").
const VELOCITY_COUNT: f64 = 0.1;

/// Greatest readable force or moment, lb or in lb. An overload stops the move with an error.
fn overload(source: SensorSource) -> f64 {
    let counts = f64::from(i32::from(ADC_FULL_SCALE) - FORCE_ZERO);
    match source {
        SensorSource::My => counts / f64::from(MOMENT_COUNTS_PER_IN_LB),
        _ => counts / f64::from(FORCE_COUNTS_PER_LB),
    }
}

/// Increase of the reading while the robot stops, lb or in lb, for each in/s of its speed.
fn growth(source: SensorSource) -> f64 {
    let force = HALT * STIFFNESS;
    if source == SensorSource::My { force * LEVER } else { force }
}

pub(super) fn check(data: &TaskData<'_>, origins: &Origins, findings: &mut Findings) {
    for (i, record) in data.relative_moves.iter().enumerate() {
        let at = origin(&origins.relative_moves, i);
        let name = record.name;
        let Some(known) = relative_move_named(name.as_str()) else {
            let near = nearest(name.as_str(), RELATIVE_MOVES.iter().map(|m| m.name));
            findings.error(
                "relative.unused",
                at,
                format!("no command looks for a relative move {name}"),
                near.map_or_else(
                    || "V.2.1 QC-DETACH to REMOVE-TOOL name what they look for".to_owned(),
                    |near| format!("the nearest known name is {near}"),
                ),
            );
            continue;
        };
        match (known.guarded, record.sensor.is_empty()) {
            (true, true) => findings.error(
                "relative.sensor",
                at,
                format!("{name} is a guarded move and names no sensor"),
                "write the name of a sensor (-sen-) after the movetable".to_owned(),
            ),
            (false, false) => findings.warning(
                "relative.sensor",
                at,
                format!("{name} is not a guarded move: nothing watches {}", record.sensor),
                "leave the sensor out".to_owned(),
            ),
            _ => {}
        }
        holster(data, record, at, findings);
        speed(data, record, at, findings);
    }
}

/// Reports a sensor of another holster: the holster of gripper n has the number n.
fn holster(data: &TaskData<'_>, record: &RelativeMove, at: super::At, findings: &mut Findings) {
    let of_holster = |source| matches!(source, SensorSource::Near | SensorSource::Seated);
    let Some(sensor) = data.sensor(&record.sensor).filter(|sensor| of_holster(sensor.source)) else { return };
    let is_here = |number: &i32| {
        let gripper = data.object_named(&Name16::clipped(&format!("GRIPPER-{number}")));
        gripper.is_some_and(|gripper| data.object_locations(gripper).any(|place| place == record.at))
    };
    if let Some(number) = (1..=3).find(is_here).filter(|number| *number != sensor.which) {
        findings.error(
            "relative.holster",
            at,
            format!("{} watches holster {}, and goes to that of GRIPPER-{number}", sensor.name, sensor.which),
            format!("name a sensor of holster {number}"),
        );
    }
}

/// Warns if the force sensor overloads before the robot stops.
fn speed(data: &TaskData<'_>, record: &RelativeMove, at: super::At, findings: &mut Findings) {
    let (Some(sensor), Some(para)) = (data.sensor(&record.sensor), data.traj_para(record.para)) else {
        return;
    };
    if !sensor.source.is_force() {
        return;
    }
    let threshold = f64::from(sensor.threshold).abs();
    let velocity = f64::from(para.vel_max) * VELOCITY_COUNT;
    let (most, growth) = (overload(sensor.source), growth(sensor.source));
    let reached = threshold + velocity * growth;
    if reached <= most {
        return;
    }
    let unit = if sensor.source == SensorSource::My { "in lb" } else { "lb" };
    let slow = ((most - threshold) / growth / VELOCITY_COUNT).floor();
    let help = if slow >= 1.0 {
        format!("the robot stands {HALT} s after {threshold:.0} {unit}: vel-max {slow:.0} at most")
    } else {
        format!("the robot stands {HALT} s after {threshold:.0} {unit}: take a smaller threshold")
    };
    findings.warning(
        "relative.speed",
        at,
        format!(
            "{} at {velocity:.1} in/s against something hard ends at {reached:.0} {unit}; {} overloads at {most:.0} {unit}",
            record.name, sensor.name
        ),
        help,
    );
}
