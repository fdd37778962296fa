//! Routes of E-move over the linkbar's data: the points of Figures VIII.22 to VIII.28 in their order, and refusals.

use std::{path::Path, sync::OnceLock};

use interfaces::emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip, RobotPlace};
use levels::{
    emove::motion::route::{Ahead, EmoveGoal, LegGoal, Planning, Route},
    places::robot_at,
};
use rcs_core::name::{Name10, Name16};
use taskdata::{
    files::{EndEffId, Location, MovtabId, TaskData, VisionId},
    load::Store,
};

fn data() -> TaskData<'static> {
    static STORE: OnceLock<Store> = OnceLock::new();
    let store = STORE.get_or_init(|| {
        match Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))) {
            Ok((store, _)) => store,
            Err(report) => panic!("{report}"),
        }
    });
    store.view()
}

fn location(name: &str, sector: i32, object: &str) -> Location {
    let object = Name16::new(object).unwrap();
    let object = (!object.is_empty()).then_some(&object);
    data().resolve_location(&Name16::new(name).unwrap(), (sector != 0).then_some(sector), object).unwrap()
}

fn command(verb: EmoveVerb, object: &str, grip: i32, at: &Location) -> EmoveCommand {
    let object = Name16::new(object).unwrap();
    EmoveCommand {
        number: 1,
        command: verb,
        object: Some(object).filter(|object| !object.is_empty()),
        grip,
        object_parameters: data().object(&object, grip).map_or(EndEffId::NULL, |(id, _)| id),
        object_vision: data().view(&object, &at.place).map_or(VisionId::NULL, |(id, _)| id),
        site: at.site(),
        ..EmoveCommand::default()
    }
}

fn gripped(object: &str, grip: i32) -> ObjectGrip {
    ObjectGrip { object: Name16::new(object).unwrap(), grip }
}

/// The whole route as text: `departure A/D-8`, `UNIT-V1`, `goal A/D-10`, `goal`, each with the velocity of its
/// segment.
fn legs(mut route: Route) -> Vec<(String, i32)> {
    let data = data();
    (route.departure, route.goal) = (1_000_001, 1_000_002);
    let mut all = Vec::new();
    while route.ahead(&data) != Ahead::Nothing {
        let leg = route.leg(&data).unwrap();
        let name = |id: MovtabId| id.of(data.movetables).map_or(String::new(), |m| format!(" {}", m.name));
        let text = match leg.at {
            LegGoal::Record { pose: 1_000_001, movetable } => format!("departure{}", name(movetable)),
            LegGoal::Record { pose: 1_000_002, movetable: MovtabId::NULL } => "goal".to_owned(),
            LegGoal::Record { pose: 1_000_002, movetable } => format!("goal{}", name(movetable)),
            LegGoal::Record { pose, .. } => data.poses[pose as usize - 1].name.to_string(),
            LegGoal::Computed(_) => "computed".to_owned(),
        };
        all.push((text, data.traj_para(leg.parameters).unwrap().vel_max));
        route.advance(&data);
    }
    all
}

fn planned(
    verb: EmoveVerb,
    object: &str,
    grip: i32,
    to: &Location,
    from: Option<&RobotPlace>,
) -> Result<Vec<(String, i32)>, Planning> {
    let command = command(verb, object, grip, to);
    let goal = EmoveGoal::new(&command, &to.frame, &data())?;
    let from = from.ok_or(Planning::NoStart)?;
    Ok(legs(Route::between(from, &goal.place(&command), &data())?))
}

fn texts(expected: &[(&str, i32)]) -> Vec<(String, i32)> {
    expected.iter().map(|(text, velocity)| ((*text).to_owned(), *velocity)).collect()
}

#[test]
fn blank_moves_from_the_tray_into_the_vise() {
    let tray = location("UNIT_1", 4, "LINKBAR1_BH");
    let vise = location("PFIXTURE", 0, "");
    let held = data().grip_frame(&Name16::new("LINKBAR1_BH").unwrap(), 2, &tray).unwrap();
    let from = robot_at(GoneTo::Object(gripped("LINKBAR1_BH", 2)), &tray, &held);
    let route = planned(EmoveVerb::MovObjTo, "LINKBAR1_BH", 2, &vise, Some(&from)).unwrap();
    assert_eq!(
        route,
        texts(&[
            ("departure A/D-8", 40),
            ("UNIT-V1", 100),
            ("HOM-SAF-3", 100),
            ("HOM-SAF-1", 100),
            ("FIX-V1", 100),
            ("goal A/D-10", 30),
            ("goal A/D-5", 10),
            ("goal D/A+.25rwz", 5),
            ("goal", 5),
        ])
    );
}

#[test]
fn departure_reverses_the_approach() {
    let (nest, home) = (location("V-VFIXTURE", 0, ""), location("HOME", 0, ""));
    let shaft = gripped("SHAFT_BH", 1);
    let held = data().grip_frame(&shaft.object, shaft.grip, &nest).unwrap();
    let leave = |gone_to| {
        let from = robot_at(gone_to, &nest, &held);
        planned(EmoveVerb::MovToLoc, "", 0, &home, Some(&from)).unwrap()
    };
    let (empty, brought) = (leave(GoneTo::Object(shaft)), leave(GoneTo::Brought(shaft)));
    assert_eq!(empty[..1], texts(&[("departure A/D-8", 20)]));
    // The approach in reverse, each segment with the lower velocity of its two ends.
    assert_eq!(brought[..2], texts(&[("departure D/A+1.5rwz", 5), ("departure A/D-10+1.5", 10)]));
    assert_eq!(brought[2..], empty[1..], "the same trajectory");
}

#[test]
fn hold_then_seat_needs_no_trajectory_and_no_depart() {
    let vise = location("PFIXTURE", 0, "");
    let hold = data().grip_frame(&Name16::new("H-LINKBAR1_BH").unwrap(), 1, &vise).unwrap();
    let from = robot_at(GoneTo::Object(gripped("H-LINKBAR1_BH", 1)), &vise, &hold);
    assert_eq!(
        planned(EmoveVerb::MovToObj, "S-LINKBAR1_BH", 1, &vise, Some(&from)).unwrap(),
        texts(&[("goal", 5)])
    );
    // A robot at its goal has no route.
    assert_eq!(legs(Route::here(&from, &from, None)), []);
}

#[test]
fn view_at_unit_1_is_approached_from_above() {
    let (home, tray) = (location("HOME", 0, ""), location("UNIT_1", 4, "LINKBAR1_BH"));
    let from = robot_at(GoneTo::Location, &home, &home.frame);
    let route = planned(EmoveVerb::MovToVu, "LINKBAR1_BH", 2, &tray, Some(&from)).unwrap();
    assert_eq!(route, texts(&[("HOM-SAF-3", 100), ("UNIT-V1", 100), ("goal D/A+10rwz", 40), ("goal", 40)]));
    let command = command(EmoveVerb::MovToVu, "LINKBAR1_BH", 2, &tray);
    let goal = EmoveGoal::new(&command, &tray.frame, &data()).unwrap();
    assert_eq!(goal.opening, Some(500));
    let view = data().movetable_named(&Name10::new("GR-PIC").unwrap()).unwrap();
    assert_ne!(view, MovtabId::NULL);
    assert!(data().moved(&tray.frame, view).distance(&goal.frame).inches < 1e-9);
}

#[test]
fn missing_data_have_a_reason() {
    let (home, vise) = (location("HOME", 0, ""), location("PFIXTURE", 0, ""));
    let tray = location("UNIT_1", 4, "LINKBAR1_BH");
    let known = robot_at(GoneTo::Location, &home, &home.frame);
    assert_eq!(planned(EmoveVerb::MovToLoc, "", 0, &vise, None), Err(Planning::NoStart));
    assert_eq!(
        planned(EmoveVerb::MovToLoc, "", 0, &location("UT-1-TEST", 0, ""), Some(&known)),
        Err(Planning::NoTrajectory)
    );
    assert_eq!(planned(EmoveVerb::MovToObj, "LINKBAR1_BH", 7, &tray, Some(&known)), Err(Planning::NoSizes));
    assert_eq!(planned(EmoveVerb::MovToVu, "LINKBAR1", 2, &tray, Some(&known)), Err(Planning::NoView));
}
