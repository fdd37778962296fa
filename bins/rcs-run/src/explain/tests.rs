use std::path::Path;

use interfaces::HwsCommand;
use rcs_core::name::Name16;
use taskdata::load::Store;

use super::{Explanation, command_of, explained};

fn store() -> Store {
    let sound = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/taskdata/tests/sound"));
    Store::load(sound).map_or_else(|report| panic!("{report}"), |(store, _)| store)
}

fn explanation(text: &str, from: &str) -> Explanation {
    let store = store();
    let command = command_of(text, &store).unwrap_or_else(|report| panic!("{report}"));
    explained(&store, &command, text, from).unwrap_or_else(|error| panic!("{error}"))
}

/// The points of a phase: part of the motion and name of the point.
fn points(explanation: &Explanation, phase: usize) -> Vec<(&'static str, &str)> {
    explanation.phases[phase].legs.iter().map(|leg| (leg.part, leg.point.as_str())).collect()
}

fn whats(explanation: &Explanation) -> Vec<&str> {
    explanation.phases.iter().map(|phase| phase.what.as_str()).collect()
}

#[test]
fn transfer_is_explained_point_by_point() {
    let found = explanation("TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0", "HOME");
    assert_eq!(
        whats(&found),
        [
            "MOV-TO-OBJ LINKBAR1 with grip +2 at PFIXTURE",
            "GRASP-OBJ LINKBAR1 with grip +2: to 0.60 in with 30 lb",
            "MOV-OBJ-TO LINKBAR1 with grip +2 at UNIT_1 sector 1",
            "RELEASE LINKBAR1: to 3.50 in",
            "MOV-TO-LOC SAFE",
        ]
    );
    assert_eq!(found.gripper, Some(1));
    assert!(found.phases.iter().all(|phase| phase.missing.is_none()));
    assert_eq!(points(&found, 0).last(), Some(&("goal", "stop")));
    let place = points(&found, 2);
    assert_eq!(place.iter().filter(|(part, _)| *part == "trajectory").count(), 4);
    assert_eq!(place.first().map(|p| p.0), Some("depart"));
    // VIII.9.5: the finished bar is acquired at (68.25, -43.85, -3.00), with the fingers opened 3.00 in before.
    let goal = found.phases[0].legs.last().unwrap();
    assert!(goal.position_in.iter().zip([68.25, -43.85, -3.0]).all(|(a, b)| (a - b).abs() < 1e-9));
    assert_eq!((goal.acc_fac, goal.vel_max, goal.smooth, goal.brk_dst), (4, 5, 40, 0));
    assert_eq!(found.phases[0].opening_in, Some(3.0));
    assert!(goal.margin_deg.is_some_and(|margin| margin > 0.0));
}

#[test]
fn every_entry_has_its_place() {
    let found = explanation("ACQUIRE LINKBAR1 +2 PFIXTURE 0 +0 -- 0 -- 0", "HOME");
    let entries: Vec<(&str, &str)> =
        found.phases[0].entries.iter().map(|entry| (entry.what, entry.at.as_str())).collect();
    assert_eq!(
        entries,
        [
            ("location", "locations.blk, block 721 (offset 21000), line 7"),
            ("pose", "poses.blk, block 632 (offset 21000), line 3"),
            ("grip", "objects/linkbar.blk, block 260 (offset 20000), line 13"),
            ("sizes", "objects/linkbar.blk, block 253 (offset 20000), line 7"),
            ("trajectory", "trajectories.blk, block 853 (offset 21000), line 5"),
            ("approach", "objects/linkbar.blk, block 267 (offset 20000), line 3"),
        ]
    );
    for leg in &found.phases[0].legs {
        assert!(leg.entry.is_some(), "{leg:?}");
    }
}

#[test]
fn vision_precedes_an_object_in_a_tray() {
    let found = explanation("== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0", "HOME");
    assert_eq!(
        whats(&found)[..3],
        [
            "MOV-TO-VU LINKBAR1_BH with grip +2 at UNIT_1 sector 4",
            "LOCATE-OBJ: taken to be found in the middle of its place",
            "MOV-TO-OBJ LINKBAR1_BH with grip +2 at UNIT_1 sector 4",
        ]
    );
    // A motion within a location uses no trajectory: only the departure from the view, if any, and the approach.
    assert!(points(&found, 2).iter().all(|(part, _)| *part != "trajectory"));
    assert_eq!(found.phases.last().unwrap().what, "MOV-OBJ-TO LINKBAR1_BH with grip +2 at PFIXTURE");
}

#[test]
fn times_are_those_of_the_motion() {
    let found = explanation("MOVE -- +0 -- 0 +0 SAFE 0 -- 0", "HOME");
    let legs = &found.phases[0].legs;
    assert_eq!(points(&found, 0).iter().filter(|(part, _)| *part == "trajectory").count(), 3);
    // At most 10 in/s (VII.6: 100 counts), and every point costs time.
    let mut way = 0.0;
    let mut before = [0.0, -71.45, -14.83];
    for leg in legs {
        assert!(leg.ticks > 0, "{leg:?}");
        let squares: f64 = leg.position_in.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum();
        way += squares.sqrt();
        before = leg.position_in;
    }
    assert!(found.motion_s > way / 10.0, "{way} in in {} s", found.motion_s);
    assert!(found.motion_s < way / 10.0 + 20.0, "{way} in in {} s", found.motion_s);
    let slower = explanation("MOVE -- +0 -- 0 +0 HOME 0 -- 0", "HOME");
    assert_eq!((slower.phases[0].legs.len(), slower.motion_s), (0, 0.0), "the robot is there");
}

#[test]
fn missing_path_is_named_and_the_rest_explained() {
    let found = explanation("MOVE -- +0 -- 0 +0 SAFE 0 -- 0", "PFIXTURE");
    assert_eq!(
        found.phases[0].missing.as_deref(),
        Some("from PFIXTURE: no trajectory from the present location to the destination")
    );
}

#[test]
fn regrip_uses_the_pedestal() {
    let name = Name16::clipped;
    let command = HwsCommand {
        command: name("TRANSFER"),
        object: Some(name("LCLEVIS_IH")),
        source: Some(name("PFIXTURE")),
        source_grip: -1,
        destination: Some(name("PFIXTURE")),
        destination_grip: 1,
        ..HwsCommand::default()
    };
    let found = explained(&store(), &command, "", "HOME").unwrap();
    assert_eq!(
        whats(&found),
        [
            "MOV-TO-OBJ LCLEVIS_IH with grip -1 at PFIXTURE",
            "GRASP-OBJ LCLEVIS_IH with grip -1: to 2.50 in with 40 lb",
            "pedestal PRE-GRIP",
            "MOV-OBJ-TO LCLEVIS_IH with grip -1 at PEDESTAL",
            "pedestal GRIP",
            "RELEASE LCLEVIS_IH: to 3.70 in",
            "MOV-TO-LOC PED-SAFE",
            "pedestal FLIP",
            "MOV-TO-OBJ LCLEVIS_IH with grip +1 at PEDESTAL",
            "GRASP-OBJ LCLEVIS_IH with grip +1: to 2.50 in with 50 lb",
            "pedestal RELEASE",
            "MOV-OBJ-TO LCLEVIS_IH with grip +1 at PFIXTURE",
            "RELEASE LCLEVIS_IH: to 4.00 in",
        ]
    );
    // These data have no approaches of the clevis. The explanation names each missing one and continues.
    let missing: Vec<&str> = found.phases.iter().filter_map(|phase| phase.missing.as_deref()).collect();
    assert_eq!(missing.first(), Some(&"from HOME: no approach trajectory for the object at the location"));
    assert_eq!(missing.len(), 5, "{missing:?}");
}

#[test]
fn unreadable_input_is_refused() {
    let store = store();
    let report = command_of("TRANSFER LINKBAR9 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0", &store).unwrap_err();
    assert!(report.to_string().contains("LINKBAR9"), "{report}");
    let command = command_of("MOVE -- +0 -- 0 +0 SAFE 0 -- 0", &store).unwrap();
    let error = explained(&store, &command, "", "NOWHERE").unwrap_err();
    assert_eq!(
        error.to_string(),
        "nothing can be explained: --from NOWHERE: no location point, owner or array is named NOWHERE"
    );
}

#[test]
fn text_has_every_point_and_the_sum() {
    let found = explanation("TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0", "HOME");
    let text = found.to_string();
    for phase in &found.phases {
        assert!(text.contains(&phase.what));
        for leg in &phase.legs {
            assert!(text.contains(&leg.point));
        }
    }
    assert!(
        text.starts_with(
            "TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0\nfrom HOME, gripper 1 attached\n"
        )
    );
    assert!(text.contains(&format!("\n{:.1} s (motion alone", found.motion_s)), "{text}");
}
