//! Inserting tools into the tool drum and taking them out with guarded moves; arm and valves are driven directly.

use crate::rig::{self, FIX_V1, Rig};
use geometry::{
    frame::{Frame, Vector},
    pose::Pose,
};
use interfaces::device::{FORCE_COUNTS_PER_LB, ForceSensor, JawValves, MOMENT_COUNTS_PER_IN_LB};
use plant::{CellEvent, WorkstationAction, WorkstationError};

const TOOL_V1: Pose =
    Pose { wrist: [2757, -2683, 2321], tool: [5597, -3497, 1800], finger: [5987, -1052, 105] };
const TOOL_SAFE: Pose =
    Pose { wrist: [5298, -2322, 1559], tool: [8296, -2431, 1585], finger: [8357, -1417, -1238] };

fn description() -> plant::CellDescription {
    let text = rig::CELL.replace("mounted = \"parts\"", "mounted = \"tool\"")
        + "\n[[part]]\nname = \"MILL\"\nsize = [3.30, 1.75, 1.75]\nweight = 6.0\ntool = true\n";
    plant::CellDescription::from_toml(&text).unwrap()
}

fn at(x: f64, z: f64) -> Frame {
    description().drum.pose.frame().unwrap().shifted(Vector::new(x, 0.0, z))
}

/// Forces along tool X, Y, Z (lb) and moment about Y (in·lb), relative to the reading `zero`.
fn since(zero: &ForceSensor, now: &ForceSensor) -> [f64; 4] {
    let change = |now: u16, zero: u16, unit: i32| (f64::from(now) - f64::from(zero)) / f64::from(unit);
    [
        change(now.z, zero.z, FORCE_COUNTS_PER_LB),
        -change(now.y, zero.y, FORCE_COUNTS_PER_LB),
        change(now.x, zero.x, FORCE_COUNTS_PER_LB),
        change(now.moment, zero.moment, MOMENT_COUNTS_PER_IN_LB),
    ]
}

fn before_drum() -> Rig {
    let mut rig = Rig::new(&description(), 3);
    for via in [FIX_V1, TOOL_V1, TOOL_SAFE] {
        rig.go(via.to_frame().unwrap(), 10.0);
    }
    rig
}

fn jaws(rig: &mut Rig, open: bool) {
    rig.outputs.tool_grip = JawValves { open, close: !open };
    rig.ticks(60);
    rig.outputs.tool_grip = JawValves::default();
    rig.ticks(5);
}

/// Move straight towards `to` until the forces relative to the start satisfy the condition.
fn until(
    rig: &mut Rig,
    from: (f64, f64),
    to: (f64, f64),
    speed: f64,
    stop: impl Fn([f64; 4]) -> bool,
) -> ((f64, f64), [f64; 4]) {
    rig.go_and_stop(at(from.0, from.1), 2.0);
    let zero = rig.inputs.force;
    assert!(zero.valid);
    let way = libm::hypot(to.0 - from.0, to.1 - from.1);
    let steps = (way / (speed * 0.04)).ceil();
    let mut place = from;
    for step in 1..=steps as u32 {
        let share = f64::from(step) / steps;
        place = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
        rig.go(at(place.0, place.1), speed * 1.01);
        let forces = since(&zero, &rig.inputs.force);
        if stop(forces) {
            return (place, forces);
        }
    }
    (place, since(&zero, &rig.inputs.force))
}

/// ACQUIRE-TOOL: move to the strike plate, along it to the tool, grasp.
fn acquire(rig: &mut Rig) {
    jaws(rig, true);
    rig.go_and_stop(at(-3.0, -1.65), 4.0);
    let (struck, forces) = until(rig, (-0.30, -1.65), (0.25, -1.65), 0.1, |[x, ..]| x < -25.0);
    assert!((0.04..0.12).contains(&struck.0), "the front of the plate at 0.06: {struck:?} {forces:?}");
    assert!(forces[1].abs() < 5.0 && forces[2].abs() < 8.0, "{forces:?}");
    rig.go_and_stop(at(struck.0 - 0.03, -1.65), 0.5);
    let (slid, forces) =
        until(rig, (struck.0 - 0.03, -1.65), (struck.0 - 0.03, 0.5), 0.2, |[.., m]| m > 150.0);
    assert!((0.03..0.12).contains(&slid.1), "the left shoulders at 0.05: {slid:?} {forces:?}");
    assert!(forces[2] < -10.0, "they push along tool -Z: {forces:?}");
    rig.go_and_stop(at(0.0, 0.0), 0.5);
    jaws(rig, false);
    assert!((rig.cell.fingers().0 - 1.75).abs() < 0.03, "{:?}", rig.cell.fingers());
    assert!(rig.part().held);
}

fn removed() -> Rig {
    let mut rig = before_drum();
    rig.cell.workstation(&WorkstationAction::DrumTool { part: "MILL".into() }).unwrap();
    acquire(&mut rig);
    rig.cell.workstation(&WorkstationAction::DrumRelease).unwrap();
    rig.ticks(10);
    let (_, forces) = until(&mut rig, (0.0, 0.0), (-6.0, 0.0), 0.5, |[x, ..]| x.abs() > 60.0);
    assert!(forces[0].abs() < 5.0, "clear of the drum nothing pulls: {forces:?}");
    rig
}

#[test]
fn tool_is_removed_from_the_drum_against_its_detents() {
    let mut rig = before_drum();
    rig.cell.workstation(&WorkstationAction::DrumTool { part: "MILL".into() }).unwrap();
    rig.ticks(10);
    assert_eq!((rig.part().location.as_str(), rig.part().held), ("TOOL-TRNS", false));
    acquire(&mut rig);
    assert_eq!(rig.part().location, "TOOL-TRNS");
    rig.cell.workstation(&WorkstationAction::DrumRelease).unwrap();
    rig.ticks(10);
    let (_, early) = until(&mut rig, (0.0, 0.0), (-0.05, 0.0), 0.1, |_| false);
    assert!((8.0..25.0).contains(&early[0]), "the detents hold the tool back: {early:?}");
    let (_, late) = until(&mut rig, (-0.05, 0.0), (-6.0, 0.0), 0.5, |[x, ..]| x.abs() > 60.0);
    assert!(late[0].abs() < 20.0, "{late:?}");
    assert_eq!((rig.part().location.as_str(), rig.part().held), ("gripper", true));
    assert_eq!(rig.log, []);
}

#[test]
fn closed_drum_fingers_keep_the_tool() {
    let mut rig = before_drum();
    rig.cell.workstation(&WorkstationAction::DrumTool { part: "MILL".into() }).unwrap();
    acquire(&mut rig);
    let (place, forces) = until(&mut rig, (0.0, 0.0), (-1.0, 0.0), 0.2, |[x, ..]| x > 60.0);
    assert!(forces[0] > 60.0 && place.0 > -0.2, "{place:?} {forces:?}");
    rig.go_and_stop(at(-1.0, 0.0), 0.5);
    assert!(rig.log.iter().any(|event| matches!(event, CellEvent::Slipped { .. })), "{:?}", rig.log);
    assert_eq!(rig.part().location, "TOOL-TRNS", "it has slid in the fingers");
}

#[test]
fn tool_inserted_with_force_stays_in_the_closed_drum() {
    let mut rig = removed();
    let (_, forces) = until(&mut rig, (-2.0, 0.0), (0.0, 0.0), 0.5, |[x, ..]| x < -60.0);
    assert!((-40.0..-15.0).contains(&forces[0]), "{forces:?}");
    rig.ticks(20);
    rig.cell.workstation(&WorkstationAction::DrumGrip).unwrap();
    jaws(&mut rig, true);
    assert_eq!((rig.part().location.as_str(), rig.part().held), ("TOOL-TRNS", false));
    let (slid, forces) = until(&mut rig, (0.0, 0.0), (0.0, -2.2), 0.2, |[.., m]| m < -150.0);
    assert!((-1.85..-1.70).contains(&slid.1), "the right shoulder: {slid:?} {forces:?}");
    rig.go_and_stop(at(-5.0, slid.1 + 0.05), 2.0);
    assert_eq!(rig.part().location, "TOOL-TRNS");
    assert!(rig.part().error.unwrap() < 0.005, "centred: {:?}", rig.part());
    assert_eq!(rig.log, []);
}

#[test]
fn tool_stays_in_the_detents_of_an_open_drum() {
    let mut rig = removed();
    until(&mut rig, (-2.0, 0.0), (0.0, 0.0), 0.5, |[x, ..]| x < -60.0);
    rig.ticks(20);
    jaws(&mut rig, true);
    rig.go_and_stop(at(-5.0, 0.0), 2.0);
    assert_eq!((rig.part().location.as_str(), rig.part().held), ("TOOL-TRNS", false));
    assert_eq!(rig.log, []);
}

#[test]
fn empty_drum_grips_no_tool() {
    let mut rig = removed();
    let error = rig.cell.workstation(&WorkstationAction::DrumGrip).unwrap_err();
    assert!(matches!(error, WorkstationError::NothingToGrip), "{error}");
    assert!(!rig.cell.drum_closed());
}

#[test]
fn drum_grips_only_a_tool_in_its_place() {
    let mut rig = removed();
    until(&mut rig, (-2.0, 0.0), (-0.40, 0.0), 0.5, |_| false);
    rig.ticks(20);
    let error = rig.cell.workstation(&WorkstationAction::DrumGrip).unwrap_err();
    let WorkstationError::NotInPlace { tool, distance, .. } = error else { panic!("{error}") };
    assert!(tool == "MILL" && (distance - 0.40).abs() < 0.05, "{distance}");
    assert!(!rig.cell.drum_closed());
}

#[test]
fn tool_released_before_the_drum_falls() {
    let mut rig = removed();
    until(&mut rig, (-2.0, 0.0), (-0.60, 0.0), 0.5, |_| false);
    jaws(&mut rig, true);
    rig.ticks(50);
    let part = rig.part();
    assert!(!part.held && part.location == "elsewhere", "{part:?}");
    assert!(
        part.position[2] < at(0.0, 0.0).position.z - 1.0,
        "it lies on the strike plate or below: {part:?}"
    );
}

#[test]
fn force_sensor_measures_weights_and_torques() {
    let mut rig = removed();
    let held = rig.inputs.force;
    jaws(&mut rig, true);
    let free = rig.inputs.force;
    // The tool weighs 6 lb; at TOOL-TRNS world up is tool (0.01, -0.94, 0.34).
    let tool = since(&free, &held);
    assert!(tool[0].abs() < 1.0 && (tool[1] - 5.6).abs() < 1.0 && (tool[2] + 2.0).abs() < 1.0, "{tool:?}");
    let other = Rig::new(&rig::description(), 3);
    assert!(!other.inputs.force.valid, "the parts gripper has none");
}
