//! Look-ups in small data sets: order of preference, sectors, and no panic for any input.

use diagnostics::{Severity, Source};
use geometry::frame::Frame;
use proptest::prelude::*;
use rcs_core::name::{Name10, Name16};
use taskdata::{
    files::{LookupError, Place, TaskData},
    load::{Job, Store},
};

fn source(text: &str) -> Source {
    Source { name: "test.blk".to_owned(), text: text.into() }
}

fn folded(text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        let mut width = 0;
        for word in line.split_whitespace() {
            if width + word.len() >= 64 {
                out.push('\n');
                width = 0;
            }
            out.push_str(word);
            out.push(' ');
            width += word.len() + 1;
        }
        out.push('\n');
    }
    out
}

fn store(text: &str) -> Store {
    match Store::from_sources(vec![source(&folded(text))]) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    }
}

fn name(text: &str) -> Name16 {
    Name16::new(text).unwrap()
}

fn given(sector: i32) -> Option<i32> {
    (sector != 0).then_some(sector)
}

fn place(data: &TaskData<'_>, location: &str, sector: i32, object: &str) -> Place {
    data.resolve_location(&name(location), given(sector), Some(&name(object)))
        .unwrap_or_else(|e| panic!("{e}"))
        .place
}

/// Two trays taught with a vertical gripper, a fixture, the printed arrays, and an object for each.
const CELL: &str = "
BLOCK# 600 OFFSET 21000
 -6650 -550 1600  -6650 -550 -1400  -6650 -3550 -1400   -pose- ... A-P
 -6650 -3050 1600  -6650 -3050 -1400  -6650 -6050 -1400 -pose- ... B-P
  3800 -4400 -400   6800 -4400 -400   6800 -1400 -400   -pose- ... F-P
  -pt- A A-P ...
  -pt- B B-P ...
  -pt- F F-P ...
  -own- BOTH -m- lpt A -m- lpt B
  -own- A -m- lpt A -m- arr SECTORS -m- arr TL-SECTORS -m- arr TRNG-SCTRS
  -own- B -m- lpt B -m- arr SECTORS
  -own- FIX -m- pos F-P
BLOCK# 601 OFFSET 21000
  -arr- SECTORS 2 2 2 -1050ty -1050tz 0
  -arr- TL-SECTORS 1 3 -800ty 0
  -arr- TRNG-SCTRS 2 2 4 -840tz 500ty 0
  -ar- SECTORS ... SCT-MTB   -ar- TL-SECTORS ... TL-SCT-MTB   -ar- TRNG-SCTRS ... TRNG-SMTB
  1 t 0 -1050 0 -mtb- -1050ty   1 t 0 0 -1050 -mtb- -1050tz  1 t 0 -800 0 -mtb- -800ty
  1 t 0 0 -840 -mtb- -840tz  1 t 0 500 0 -mtb- 500ty
  1 t 255 -525 -525 -mtb- SCT-MTB
  1 t 0 -250 -1060 ---- 2 ro 0 ---- 3 to -600 0 ---- 4 t -265 0 0 -mtb- TL-SCT-MTB
  1 t 117 -405 -300 ---- 2 ro -9000 ---- 3 to 0 0 0 -mtb- TRNG-SMTB
BLOCK# 1 OFFSET 20000
  -obj- BAR 2 300 60 30 350   -obj- TOOL 1 300 60 30 350   -obj- ROUND 1 300 60 30 350
  -o-loc- BAR arr SECTORS     -o-loc- TOOL arr TL-SECTORS  -o-loc- ROUND arr TRNG-SCTRS
";

#[test]
fn printed_arrays_fit_the_tray_and_count_by_rows() {
    let store = store(CELL);
    let data = store.view();
    let corner = data.resolve_location::<16, 16>(&name("A"), None, None).unwrap().frame;
    for (object, columns, rows) in [("BAR", 2, 2), ("TOOL", 3, 1), ("ROUND", 2, 4)] {
        let mut before: Option<(i32, f64, f64)> = None;
        for sector in 1..=columns * rows {
            let frame = data.resolve_location(&name("A"), Some(sector), Some(&name(object))).unwrap().frame;
            // Seen from the robot, from the upper left corner of the tray, right is world +Y and top is world -X.
            let (right, down) = (frame.position.y - corner.position.y, frame.position.x - corner.position.x);
            assert!(
                (0.0..21.0).contains(&right) && (0.0..21.0).contains(&down),
                "{object} {sector}: {right} {down}"
            );
            let row = (sector - 1) / columns;
            if let Some((last_row, last_right, last_down)) = before {
                if row == last_row {
                    assert!(right > last_right && (down - last_down).abs() < 1e-9, "{object} {sector}");
                } else {
                    assert!(right < last_right + 1e-9 && down > last_down, "{object} {sector}");
                }
            }
            before = Some((row, right, down));
        }
    }
}

#[test]
fn unknown_sector_is_reported_with_the_known_ones() {
    let store = store(CELL);
    let data = store.view();
    let at = |location, sector, object: Option<&str>| {
        data.resolve_location(&name(location), given(sector), object.map(name).as_ref())
            .map_err(|e| e.to_string())
    };
    assert_eq!(at("A", 4, Some("TOOL")).unwrap_err(), "TL-SECTORS at A has sectors 1 to 3, 4 found");
    assert_eq!(at("A", -1, Some("BAR")).unwrap_err(), "SECTORS at A has sectors 1 to 4, -1 found");
    assert_eq!(at("F", 1, Some("BAR")).unwrap_err(), "F has no sectors: 0 was expected, 1 found");
    assert_eq!(
        at("A", 1, None).unwrap_err(),
        "sector 1 of A needs an object, which says how the tray is divided"
    );
    assert_eq!(
        at("B", 1, Some("TOOL")).unwrap_err(),
        "no object location form assigns TOOL to a member of B"
    );
    assert_eq!(at("C", 0, None).unwrap_err(), "no location point, owner or array is named C");
    assert_eq!(at("SECTORS", 1, None).unwrap_err(), "no location point, owner or array is named SECTORS");
    assert_eq!(at("BOTH", 0, None).unwrap_err(), "BOTH only groups locations: name one of its members");
    assert!(at("B", 4, None).is_ok(), "an owner of one array needs no object");
    assert!(matches!(
        data.resolve_location(&name("A"), Some(1), Some(&name("NUT"))),
        Err(LookupError::UnknownObject { .. })
    ));
}

/// The names of tray A in a grip form, most exact first.
const PREFERENCE: [&str; 4] = ["lpt A", "arr SECTORS", "own BOTH", "$$$"];

proptest! {
    #[test]
    fn most_exact_entry_has_priority(present in 1_u8..16) {
        let entries: String = PREFERENCE.iter().enumerate().filter(|(i, _)| present & (1 << i) != 0)
            .map(|(i, at)| format!("-grip- BAR 2 {at} G{i}\n")).collect();
        let tables: String = (0..4).map(|i| format!("1 t -{}0 0 0 ---- 2 to -300 0 -mtb- G{i}\n", i + 1)).collect();
        let store = store(&format!("{CELL}\nBLOCK# 2 OFFSET 20000\n{entries}\nBLOCK# 602 OFFSET 21000\n{tables}"));
        let data = store.view();
        let found = data.grip_movetable(&name("BAR"), 2, &place(&data, "A", 1, "BAR"));
        let expected = present.trailing_zeros();
        prop_assert_eq!(found, data.movetable_named(&name(&format!("G{expected}"))));
        let fixture = place(&data, "F", 0, "BAR"); // only the wild card applies; another grip has no entry
        let wild = if present & 8 != 0 { data.movetable_named(&name("G3")) } else { None };
        prop_assert_eq!(data.grip_movetable(&name("BAR"), 2, &fixture), wild);
        prop_assert_eq!(data.grip_movetable(&name("BAR"), 1, &fixture), None);
    }

    #[test]
    fn loader_does_not_panic_for_any_text(text in "[ -~\n]{0,400}") {
        let _ = Store::from_sources(vec![source(&text)]);
        let _ = Store::from_sources(vec![source(&format!("BLOCK# 1 OFFSET 20000\n{text}"))]);
    }

    #[test]
    fn loader_does_not_panic_for_any_order_of_words(words in prop::collection::vec(0_usize..36, 0..80)) {
        let known = ["-pose-", "----", "-mtb-", "-pt-", "-arr-", "-ar-", "-own-", "-m-", "-traj", "-ppt", "-obj-", "-o-loc-",
            "-grip-", "-vu-", "-appr", "-dept", ":S", ":R", ">FILE", "<=", "OBJ-GRIPS", "\"object\"", "load", "stop", "lpt",
            "arr", "own", "$$$", "obj", "1", "2", "-300", "99999999999", "A", "BAR", "\n"];
        let text: Vec<&str> = words.iter().map(|i| known[*i]).collect();
        let text = folded(&format!("{CELL}\nBLOCK# 3 OFFSET 20000\n{}", text.join(" ")));
        if let Err(report) = Store::from_sources(vec![source(&text)]) {
            prop_assert!(report.errors().all(|e| e.severity() == Severity::Error && !e.message().is_empty()));
            prop_assert!(!report.render(true).is_empty());
        }
    }

    #[test]
    fn reader_does_not_panic_for_any_job_line(text in "(==|\\*\\*) [ -~\n]{0,120}") {
        let _ = Job::from_source(source(&text), &store(CELL));
    }
}

#[test]
fn trajectories_apply_to_owners_and_forward_only() {
    let store = store(&format!(
        "{CELL}
BLOCK# 850 OFFSET 21000
  -traj F-BOTH lpt F own BOTH -ppt 4 100 8 300 pos F-P
  -traj F-A    lpt F lpt A    -ppt 4 100 8 300 pos F-P -ppt 4 100 8 300 pos F-P
  -traj BOTH-BOTH own BOTH own BOTH
  -traj FIX-B  own FIX lpt B  -ppt 4 100 8 300 lpt F -ppt 4 100 8 300 lpt F -ppt 4 100 8 300 lpt F
"
    ));
    let data = store.view();
    let points = |from: &Place, to: &Place| data.trajectory(from, to).map(|path| data.path(path).len());
    let (a, b, f) = (place(&data, "A", 1, "BAR"), place(&data, "B", 0, "BAR"), place(&data, "F", 0, "BAR"));
    assert_eq!(points(&f, &a), Some(2), "the exact names come before the owner");
    assert_eq!(points(&f, &b), Some(1), "the start is exact before it is an owner");
    assert_eq!(points(&a, &b), Some(0));
    assert_eq!(points(&a, &f), None, "the way back is not written");
    assert_eq!(data.place_named(&name("A"), Some(&name("BAR"))), Some(a));
    assert_eq!(data.place_named(&name("F"), Some(&name("BAR"))), Some(f));
    assert_eq!(data.place_named::<16, 16>(&name("G"), None), None);
}

fn said(text: &str) -> Vec<String> {
    let sources = vec![source(&folded(text))];
    let report = Store::from_sources(sources).map_or_else(|report| *report, |(_, report)| report);
    report.diagnostics().iter().map(|d| format!("{}: {d}", d.severity().text())).collect()
}

#[test]
fn tray_corner_may_be_vertical_but_a_via_point_may_not() {
    let via = "BLOCK# 850 OFFSET 21000\n -traj F-A lpt F lpt A -ppt 4 100 8 300 pos B-P";
    assert_eq!(said(CELL), Vec::<String>::new());
    assert_eq!(
        said(&format!("{CELL}\n{via}")),
        ["warning: trajectory F-A, B-P: the gripper is 0.0 degrees from vertical"]
    );
    let plain = CELL.replace("-own- B -m- lpt B -m- arr SECTORS", "");
    assert_eq!(said(&plain), ["warning: location point B: the gripper is 0.0 degrees from vertical"]);
}

#[test]
fn a_file_has_an_end() {
    let lines: String = (0..=100_000).map(|i| format!("1 t 0 0 0 -mtb- M{i}\n")).collect();
    let blocks: Vec<&str> = lines.split_inclusive('\n').collect();
    let text: String = blocks
        .chunks(16)
        .enumerate()
        .map(|(i, c)| format!("BLOCK# {} OFFSET {}\n{}", i % 1000, 30_000 + i / 1000 * 1000, c.concat()))
        .collect();
    assert_eq!(said(&text), ["error: FILE FULL: MOVTAB holds 100000 records, 100001 found"]);
}

#[test]
fn owner_by_pose_replaces_its_location_points() {
    let store = store(&format!(
        "{CELL}\nBLOCK# 850 OFFSET 21000\n-traj FIX-B own FIX lpt B -ppt 4 100 8 300 lpt F\n"
    ));
    let data = store.view();
    let (b, f) = (place(&data, "B", 0, "BAR"), place(&data, "F", 0, "BAR"));
    assert!(data.trajectory(&f, &b).is_some());
}

#[test]
fn static_array_starts_at_its_own_pose() {
    let store = store(
        "BLOCK# 1 OFFSET 21000
 3800 -4400 -400  6800 -4400 -400  6800 -1400 -400 -pose- ... F-P
 -arr- RACK 1 4 step 0  -ar- RACK F-P first
 1 t 0 100 0 -mtb- step   1 rw 0 0 50 -mtb- first",
    );
    let data = store.view();
    let third = data.resolve_location::<16, 16>(&name("RACK"), Some(3), None).unwrap();
    let expected = [68.0, -42.0, -3.5];
    assert!(third.frame.position.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{third:?}");
    assert_eq!(third.name, Name10::new("RACK").unwrap());
    assert!(data.resolve_location::<16, 16>(&name("RACK"), Some(5), None).is_err());
    assert!(data.approach_location(&third.place).is_none());
}

#[test]
fn movetables_correct_poses_and_location_points() {
    let store = store(
        "BLOCK# 1 OFFSET 21000
 3800 -4400 -400  6800 -4400 -400  6800 -1400 -400 -pose- up F-P   -pt- F F-P in   -pt- G F-P ...
 1 rw 0 0 50 -mtb- up   1 t 25 0 0 -mtb- in
 -appr lpt F -ppt 4 10 8 100 mtb in -ppt 4 10 8 0 stop    -dept $$$ -ppt 4 10 8 100 mtb up",
    );
    let data = store.view();
    let near = |frame: &Frame, to: [f64; 3]| frame.position.iter().zip(to).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(near(&data.pose(data.pose_named(&name("F-P")).unwrap()).unwrap().frame, [68.0, -44.0, -3.5]));
    let (f, g) = (place(&data, "F", 0, "X"), place(&data, "G", 0, "X"));
    assert!(near(&data.locpt(f.locpt).unwrap().frame, [68.25, -44.0, -3.5]));
    assert_eq!(data.path(data.approach_location(&f).unwrap()).len(), 2);
    assert!(data.approach_location(&g).is_none());
    assert_eq!(data.depart_location(&g), data.depart_location(&f));
}
