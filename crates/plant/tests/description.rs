//! Messages for a cell description with errors: all errors at once, each with the text that causes it.

use diagnostics::Diagnostic;
use plant::{Cell, CellDescription};

const TEXT: &str = include_str!("../../../data/cell.toml");

/// The errors of the shipped description after some replacements.
fn faults(edits: &[(&str, &str)]) -> (String, Vec<Diagnostic>) {
    let mut text = TEXT.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "the description has no {from:?}");
        text = text.replacen(from, to, 1);
    }
    match CellDescription::from_toml(&text) {
        Ok(_) => (text, Vec::new()),
        Err(report) => (text, report.diagnostics().to_vec()),
    }
}

fn only(from: &str, to: &str) -> (String, String, Option<String>) {
    let (text, faults) = faults(&[(from, to)]);
    let [fault] = &faults[..] else { panic!("{faults:#?}") };
    let start = fault.at().expect("a fault of a text has a place").start as usize;
    let line = text[..start].matches('\n').count() + 1;
    assert_eq!(fault.line(), Some(line as u32), "{fault}");
    assert!(text[start..].starts_with(fault.text()), "{fault}");
    (fault.text().to_owned(), fault.message().to_owned(), fault.nearest().map(str::to_owned))
}

fn said(from: &str, to: &str) -> [String; 2] {
    let (underlined, message, _) = only(from, to);
    [underlined, message]
}

#[test]
fn shipped_description_has_no_faults() {
    assert!(faults(&[]).1.is_empty());
}

#[test]
fn misspelt_key_is_one_fault_with_the_right_name() {
    let (underlined, message, nearest) = only("servo_lag_s = ", "servo_lags = ");
    assert_eq!(underlined, "servo_lags");
    assert!(message.starts_with("robot has no key servo_lags; expected one of servo_lag_s, "), "{message}");
    assert_eq!(nearest.as_deref(), Some("servo_lag_s"));
}

#[test]
fn unknown_key_is_a_fault_in_a_complete_file() {
    let (underlined, message, nearest) = only("jaw_speed = 2.0", "colour = 3\njaw_speed = 2.0");
    assert_eq!((underlined.as_str(), nearest), ("colour", None));
    assert!(message.starts_with("gripper has no key colour; expected one of weight, jaw_speed"), "{message}");
}

#[test]
fn missing_key_is_reported_at_its_table() {
    let told =
        said("stiffness = 2000.0                             # lb/in at the fingers, all of the arm", "# lb");
    assert_eq!(told, ["robot", "robot has no key stiffness, which it needs"]);
    let told = said("ledge = -1.00\n", "");
    assert_eq!(told, ["[[vise.program]]", "vise.program[1] has no key ledge, which it needs"]);
}

#[test]
fn value_of_another_kind_is_underlined() {
    let told = said("radius = 3.0", "radius = \"3.0\"");
    assert_eq!(told, ["\"3.0\"", "quick_change.radius: expected a number, found \"3.0\""]);
    let told = said("substeps = 16 ", "substeps = 16.5 ");
    assert_eq!(told[0], "16.5");
    assert!(
        told[1].starts_with("physics.substeps: expected a whole number from 0 to 4294967295"),
        "{}",
        told[1]
    );
    let told = said("size = [28.0, 28.0, 40.0]", "size = [28.0, 28.0]");
    assert_eq!(told, ["[28.0, 28.0]", "fixture[1].size: expected an array of 3, found an array of 2"]);
    let (_, faults) = faults(&[("sector = 7\n", "sector = -7\n")]);
    assert_eq!(faults[0].message(), "nest[0].sector: expected a whole number from 0 to 65535, found -7");
}

#[test]
fn unknown_word_is_reported_with_the_nearest_valid_one() {
    let (underlined, message, nearest) = only("mounted = \"parts\"", "mounted = \"part\"");
    assert_eq!(underlined, "\"part\"");
    assert_eq!(message, "quick_change.mounted: expected one of none, parts, v, tool, found \"part\"");
    assert_eq!(nearest.as_deref(), Some("parts"));
}

#[test]
fn value_out_of_range_is_reported_with_the_range() {
    let told = said("start = [-90.0, 45.0,", "start = [-90.0, 145.0,");
    assert_eq!(
        told,
        ["145.0", "robot.start[1]: expected the shoulder angle from 0 to 90 degrees, found 145"]
    );
    let told = said("friction = 0.05  ", "friction = 5.0  ");
    assert_eq!(told, ["5.0", "drum.friction: expected 0 to 2, found 5"]);
    let told = said("weight = 1.75\n", "weight = -1.75\n");
    assert_eq!(told, ["-1.75", "part[2].weight: expected more than 0, found -1.75"]);
    let told = said("[-61.25, -0.25]", "[-81.25, -0.25]");
    assert_eq!(
        told,
        [
            "[-81.25, -0.25]",
            "tray[1].sectors[0]: expected a point in the tray, within 10.50 in of -56.00, 5.00 in, found [-81.25, -0.25]"
        ]
    );
}

#[test]
fn duplicate_name_is_reported_at_its_second_place() {
    let told = said("name = \"LINKBAR1\"", "name = \"LINKBAR1_BH\"");
    assert_eq!(
        told,
        [
            "\"LINKBAR1_BH\"",
            "part[1].name: expected another name than that of part[0].name, found LINKBAR1_BH"
        ]
    );
}

#[test]
fn part_without_a_fitting_tray_is_reported() {
    let told = said("size = [1.73, 2.56, 4.00]", "size = [1.73, 2.56, 24.00]");
    assert_eq!(told[0], "[1.73, 2.56, 24.00]");
    assert!(
        told[1].contains("expected a part that has a nest, or lies in a tray 21.00 in wide"),
        "{}",
        told[1]
    );
}

#[test]
fn unknown_names_in_contacts_and_nests_are_reported() {
    let (underlined, message, nearest) =
        only("obstacle = [\"strike_plates\"]", "obstacle = [\"strike_plats\"]");
    assert_eq!(underlined, "\"strike_plats\"");
    assert_eq!(
        message,
        "contact[7].obstacle[0]: expected a name or a group of what can be an obstacle, found strike_plats"
    );
    assert!(nearest.is_some_and(|name| name.starts_with("strike_plate")));
    let (underlined, _, nearest) = only("\"RELEASE-TOOL\", ", "\"RELEASE-TOLL\", ");
    assert_eq!((underlined.as_str(), nearest.as_deref()), ("\"RELEASE-TOLL\"", Some("RELEASE-TOOL")));
    let (underlined, _, nearest) =
        only("parts = [\"SHAFT_BH\", \"SHAFT\"]", "parts = [\"SHAFT_BH\", \"SHAFTS\"]");
    assert_eq!((underlined.as_str(), nearest.as_deref()), ("\"SHAFTS\"", Some("SHAFT")));
}

#[test]
fn invalid_toml_is_reported_with_its_line() {
    let (text, faults) = faults(&[("tilt = 3.0  ", "tilt = = 3.0  ")]);
    let line = text[..text.find("tilt = = 3.0").unwrap()].matches('\n').count() + 1;
    assert!(!faults.is_empty());
    assert!(faults.iter().all(|fault| fault.code() == "cell.syntax"), "{faults:#?}");
    assert_eq!(faults[0].line(), Some(line as u32));
    assert!(faults[0].message().starts_with("this is not TOML: "), "{}", faults[0].message());
}

#[test]
fn all_faults_are_reported_at_once_in_the_order_of_the_text() {
    let (_, faults) = faults(&[
        ("servo_lag_s = ", "servo_lags = "),
        ("speed = 0.5 ", "speed = -0.5 "),
        ("length = 3.0 ", "length = 4.0 "),
        ("radius = 3.0", "radius = true"),
        ("name = \"LINKBAR1\"", "name = \"LINKBAR1_BH\""),
        ("vision_id = 14\n", "vision_id = 14\ncolour = \"red\"\n"),
    ]);
    let entries: Vec<&str> = faults.iter().filter_map(Diagnostic::entry).collect();
    assert_eq!(
        entries,
        [
            "robot.servo_lags",
            "quick_change.radius",
            "gripper.parts.body[0]",
            "gripper.v.body[0]",
            "gripper.tool.body[0]",
            "vise.speed",
            "part[1].name",
            "part[2].colour",
        ]
    );
    assert!(faults[2].message().ends_with("the tool length of the arm, 12.00 in, found 13"), "{}", faults[2]);
}

#[test]
fn values_relative_to_an_unreadable_value_are_not_judged() {
    for (from, to, entry) in [
        ("jaw = [6.0, 3.0, 3.25]", "jaw = [6.0, 3.0]", "vise.jaw"),
        ("inside = 21.0", "inside = \"21.0\"", "tray_shape.inside"),
        ("limits = [-345.0, 0.0]", "limits = [-345.0, \"0.0\"]", "pedestal.table.limits[1]"),
        ("stop_force = 100.0", "stop_force = true", "drum.stop_force"),
        ("pins_reach = 0.65", "pins_reach = [0.65]", "quick_change.pins_reach"),
        ("opening_open = 2.760", "opening_open = \"\"", "vise.program[1].opening_open"),
        ("opening = [0.50, 3.50]", "opening = [0.50]", "gripper.v.opening"),
    ] {
        let (_, faults) = faults(&[(from, to)]);
        let entries: Vec<&str> = faults.iter().filter_map(Diagnostic::entry).collect();
        assert_eq!(entries, [entry]);
    }
    let told = said("detent_length = 0.30", "detent_length = 3.0");
    assert_eq!(told, ["3.0", "drum.detent_length: expected 0 to the 1.4 of drum.finger_reach, found 3"]);
}

#[test]
fn box_around_the_robot_at_the_start_is_reported() {
    let text = TEXT.replacen("centre = [-23.26, -63.90, -36.0]", "centre = [0.0, -63.90, -16.0]", 1);
    let description = CellDescription::from_toml(&text).expect("its numbers are sound");
    let error = Cell::new(&description, 1).err().expect("the robot overlaps the table").to_string();
    assert!(error.starts_with("robot.start: ") && error.contains(" runs into table, "), "{error}");
}
