//! The shipped data load, and their targets agree with the manual and the cell.

use std::path::Path;

use geometry::{frame::Frame, units::radians};
use rcs_core::name::Name16;
use taskdata::{
    files::{Location, Place, Target, TaskData},
    load::{Diagnostics, Job, Step, Store, Workstation},
};

fn data_directory() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn load() -> (Store, Diagnostics) {
    Store::load(data_directory()).unwrap_or_else(|report| panic!("{report}"))
}

fn name(text: &str) -> Name16 {
    Name16::new(text).unwrap()
}

fn at(data: &TaskData<'_>, location: &str, sector: i32, object: &str) -> Location {
    data.resolve_location(&name(location), (sector != 0).then_some(sector), Some(&name(object)))
        .unwrap_or_else(|error| panic!("{error}"))
}

fn assert_near(frame: &Frame, position: [f64; 3], tolerance: f64) {
    for (found, expected) in frame.position.iter().zip(position) {
        assert!((found - expected).abs() < tolerance, "{:?} for {position:?}", frame.position);
    }
}

/// `inner` in the axes of `outer`.
fn seen_from(outer: &Frame, inner: &Frame) -> Frame {
    outer.inverse().compose(inner)
}

#[test]
fn only_the_printed_pose_causes_a_warning() {
    let (_, report) = load();
    let warnings: Vec<&str> = report.warnings().map(|w| w.message()).collect();
    assert_eq!(warnings, [""; 0], "TOOL-TRNS is off square, which the data accept");
}

#[test]
fn sectors_agree_with_the_cell() {
    let (store, _) = load();
    let data = store.view();
    let unit_1 = [[-61.25, -0.25], [-61.25, 10.25], [-50.75, -0.25], [-50.75, 10.25]];
    for (sector, [x, y]) in (1..).zip(unit_1) {
        assert_near(&at(&data, "UNIT_1", sector, "LINKBAR1_BH").frame, [x, y, -16.55], 1e-9);
        assert_near(&at(&data, "UNIT_2", sector, "LINKBAR1_BH").frame, [x, y - 25.0, -16.55], 1e-9);
    }
}

fn numbers<const N: usize>(value: &toml::Value) -> [f64; N] {
    let all: Vec<f64> = value.as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    all.try_into().unwrap()
}

#[test]
fn cell_and_task_data_agree() {
    let (store, _) = load();
    let data = store.view();
    let text = std::fs::read_to_string(data_directory().join("cell.toml")).unwrap();
    let cell: toml::Table = text.parse().unwrap();
    let vise = cell["vise"].as_table().unwrap();
    let location = at(&data, vise["location"].as_str().unwrap(), 0, "LINKBAR1_BH");
    assert_near(&location.frame, numbers(&vise["position"]), 1e-9);
    assert!(location.frame.distance(&Frame::identity()).radians < 1e-9, "X into the vise, Y left, Z up");
    let trays = cell["tray"].as_array().unwrap();
    assert_eq!(trays.len(), 2);
    for tray in trays {
        let floor = tray["floor"].as_float().unwrap();
        for (sector, centre) in (1..).zip(tray["sectors"].as_array().unwrap()) {
            let [x, y] = numbers(centre);
            let location = at(&data, tray["unit"].as_str().unwrap(), sector, "LINKBAR1_BH");
            assert_near(&location.frame, [x, y, floor], 1e-9);
        }
    }
}

#[test]
fn blank_is_picked_tilted_and_is_upright_in_the_vise() {
    let (store, _) = load();
    let data = store.view();
    let blank = name("LINKBAR1_BH");
    let sector = at(&data, "UNIT_1", 4, "LINKBAR1_BH");
    let pick = data.grip_frame(&blank, 2, &sector).unwrap();
    // 0.20 in above the floor, 2.10 in along tool Z, which is world -X over a tray (VIII.9.5).
    assert_near(&pick, [-52.85, 10.25, -16.35], 1e-9);
    let vise = at(&data, "PFIXTURE", 0, "LINKBAR1_BH");
    let placed = data.grip_frame(&blank, 2, &vise).unwrap();
    assert_near(&placed, [68.15, -43.81, -3.0], 1e-9);
    assert!((placed.x().z - radians(300).sin()).abs() < 1e-12);

    // The gripper holds the bar as in the tray. At the vise the two tilts cancel.
    let bar = placed.compose(&seen_from(&pick, &sector.frame));
    let in_vise = seen_from(&vise.frame, &bar);
    assert!(in_vise.distance(&Frame::identity()).radians < 1e-12, "{in_vise:?}");
    // X -0.275 .. 0.350: the tray floor, where the part frame is, becomes the rear face.
    assert!((in_vise.position.x - 0.35).abs() < 1e-9, "{in_vise:?}");
    assert!((in_vise.position.y - 0.19).abs() < 1e-9);
    assert!((in_vise.position.z - -1.10).abs() < 1e-9); // z -3.10 .. 0.90: the centroid is 2.00 from each end
}

#[test]
fn finished_part_is_released_just_above_the_tray() {
    let (store, _) = load();
    let data = store.view();
    let part = name("LINKBAR1");
    let vise = at(&data, "PFIXTURE", 0, "LINKBAR1");
    let grasp = data.grip_frame(&part, 2, &vise).unwrap();
    assert_near(&grasp, [68.25, -43.85, -3.0], 1e-9);
    // The rear face is 0.41 in behind the jaw front, 0.16 beyond the fingertips; 0.20 is free under them.
    let rear_beyond_tips = 0.41 - seen_from(&vise.frame, &grasp).position.x;
    let tray = at(&data, "UNIT_1", 1, "LINKBAR1");
    let tips_above_floor = data.grip_frame(&part, 2, &tray).unwrap().position.z - tray.frame.position.z;
    assert!((tips_above_floor - rear_beyond_tips - 0.04).abs() < 1e-9);
}

#[test]
fn hold_and_seat_differ_as_documented() {
    let (store, _) = load();
    let data = store.view();
    let vise = at(&data, "PFIXTURE", 0, "H-LINKBAR1_BH");
    let hold = data.grip_frame(&name("H-LINKBAR1_BH"), 1, &vise).unwrap();
    let seat = data.grip_frame(&name("S-LINKBAR1_BH"), 1, &vise).unwrap();
    assert_near(&seen_from(&vise.frame, &hold), [-0.35, 0.05, -0.90], 1e-9);
    let between = seen_from(&hold, &seat);
    assert_near(&between, [0.15, 0.0, 0.0], 1e-9);
    assert!((hold.y().z - 1.0).abs() < 1e-9); // rolled by 90 degrees: the fingers open along world Z
}

#[test]
fn camera_is_directly_above_the_sector() {
    let (store, _) = load();
    let data = store.view();
    let sector = at(&data, "UNIT_1", 1, "LINKBAR1_BH");
    let (_, vision) = data.view(&name("LINKBAR1_BH"), &sector.place).unwrap();
    assert_eq!((vision.id, vision.range, vision.enabled), (17, 590, true));
    let view = data.moved(&sector.frame, vision.movetable);
    // The camera looks from the image plane at tool (-9, 0, 3) along (cos 3, 0, -sin 3).
    let image = view.shifted(geometry::frame::Vector::new(-9.0, 0.0, 3.0));
    assert!((image.position.x - sector.frame.position.x).abs() < 0.01);
    assert!((image.position.y - sector.frame.position.y).abs() < 1e-9);
    assert!((image.position.z - sector.frame.position.z - 605.0 / 25.4).abs() < 0.01, "{:?}", image.position);
}

#[test]
fn every_leg_of_the_linkbar_has_its_paths() {
    let (store, _) = load();
    let data = store.view();
    let blank = name("LINKBAR1_BH");
    let (unit, vise) =
        (at(&data, "UNIT_1", 4, "LINKBAR1_BH").place, at(&data, "PFIXTURE", 0, "LINKBAR1_BH").place);
    let plain = |text| Place::point(data.locpt_named(&name(text)).unwrap());
    let (home, safe) = (plain("HOME"), plain("SAFE"));
    for (from, to, vias) in [
        (home, unit, 2),
        (safe, unit, 1),
        (unit, vise, 4),
        (vise, home, 1),
        (home, vise, 1),
        (vise, unit, 4),
        (unit, safe, 1),
        (home, safe, 3),
        (safe, vise, 3),
        (vise, safe, 3),
    ] {
        let path = data.trajectory(&from, &to).unwrap();
        assert_eq!(data.path(path).len(), vias, "{from:?} to {to:?}");
    }
    assert!(data.trajectory(&vise, &plain("TOOL-SAFE")).is_none(), "no form has this leg");

    let approach = data.path(data.approach(&blank, 2, &vise).unwrap());
    assert_eq!(approach.len(), 4);
    assert_eq!(approach.last().unwrap().target, Target::Stop);
    let para = data.traj_para(approach[2].para).unwrap();
    assert_eq!((para.acc_fac, para.vel_max, para.smooth, para.brk_dst), (5, 5, 40, 0));
    let hold = data.depart(&name("H-LINKBAR1_BH"), 1, &vise).unwrap();
    assert!(data.path(hold).is_empty(), "the hold is left without a depart point");
    // The finished part has its own entry at UNIT_2 and the wild card elsewhere.
    let finished = name("LINKBAR1");
    let other = at(&data, "UNIT_2", 1, "LINKBAR1").place;
    assert_eq!(data.path(data.approach(&finished, 2, &unit).unwrap()).len(), 3);
    assert_eq!(data.path(data.approach(&finished, 2, &other).unwrap()).len(), 2);
    assert_eq!(data.path(data.view_approach(&blank, 2, &unit).unwrap()).len(), 2);
    assert_eq!(data.path(data.view_approach(&blank, 2, &other).unwrap()).len(), 1);
}

#[test]
fn linkbar_parameters_equal_those_of_the_figures() {
    let (store, _) = load();
    let data = store.view();
    let (_, grip) = data.object(&name("LINKBAR1_BH"), 2).unwrap();
    assert_eq!((grip.appr_size, grip.grasp_size, grip.grasp_force, grip.depart_size), (300, 60, 30, 350));
    let (_, hold) = data.object(&name("H-LINKBAR1_BH"), 1).unwrap();
    assert_eq!((hold.appr_size, hold.grasp_size, hold.grasp_force, hold.depart_size), (10, 10, 40, 10));
    assert!(data.object(&name("LINKBAR1"), 1).is_none());
    let gripper = data.obj_grips(&name("LINKBAR1")).unwrap();
    assert_eq!((gripper.endeff_id, gripper.tray_grip), (1, 2));
    let (_, pedestal) = data.ped_para(&name("LCLEVIS_IH")).unwrap();
    assert_eq!((pedestal.table_pos, pedestal.flip_angle), (-2135, 1835));
}

#[test]
fn job_has_the_six_commands_of_figure_viii_4() {
    let (store, _) = load();
    let (job, report) =
        Job::load(&data_directory().join("jobs/linkbar.job"), &store).unwrap_or_else(|r| panic!("{r}"));
    assert_eq!(report.diagnostics().len(), 0);
    assert_eq!(job.name, "linkbar");
    let commands: Vec<&str> =
        job.steps.iter().filter(|s| matches!(s.step, Step::Command(_))).map(|s| s.text.as_str()).collect();
    assert_eq!(
        commands,
        [
            "== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0",
            "== POSITION H-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0",
            "== POSITION S-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0",
            "== MOVE -- +0 -- 0 +0 HOME 0 -- 0",
            "== ACQUIRE LINKBAR1 +2 PFIXTURE 0 +0 -- 0 -- 0",
            "== TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0",
        ]
    );
    let Step::Command(last) = job.steps.last().unwrap().step else { panic!("the job ends with a command") };
    assert_eq!(
        (last.command, last.object, last.source, last.end_at),
        (name("TRANSFER"), Some(name("LINKBAR1")), Some(name("PFIXTURE")), Some(name("SAFE")))
    );
    assert_eq!((last.source_grip, last.destination_grip, last.destination_sector), (2, 2, Some(1)));
    let Step::Workstation(Workstation::Tray { location, .. }) = job.steps[0].step else {
        panic!("a part comes first")
    };
    assert_eq!(location.sector, Some(4));
}
