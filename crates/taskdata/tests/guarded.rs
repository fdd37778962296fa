//! Sensors of guarded moves, and relative moves: loading, look-ups, and errors.

use rcs_core::name::{Name10, Name16};
use taskdata::{
    files::{Place, SensorSource, TaskData},
    load::{Source, Store},
};

const CELL: &str = "BLOCK# 600 OFFSET 21000
 5500 -2400 1500 8500 -2400 1500 8500 600 1500 -pose- ... T-P
 3800 -4400 -400 6800 -4400 -400 6800 -1400 -400 -pose- ... R-P
  -pt- TOOL-TRNS T-P ...
  -pt- HOLSTER-R R-P ...
  -pt- HOLSTER-L R-P IN
  -own- HOLSTER -m- lpt HOLSTER-R -m- lpt HOLSTER-L
  1 t 300 0 0 -mtb- IN    1 t -300 0 0 -mtb- OUT
BLOCK# 601 OFFSET 21000
  -sen- INS-FX fx 0 -60
  -sen- HOL-R-NEAR near 1 0
  -sen- BEAM beam 0 0
";

fn load(text: &str) -> Result<Store, String> {
    let source = Source { name: "try.blk".to_owned(), text: text.into() };
    Store::from_sources(vec![source]).map(|(store, _)| store).map_err(|report| report.to_string())
}

fn said(lines: &str) -> Vec<String> {
    let text = format!("{CELL}BLOCK# 602 OFFSET 21000\n{lines}\n");
    let report = load(&text).expect_err("an error was expected");
    let found = report.lines().filter_map(|line| {
        line.split_once(", column ")
            .and_then(|(_, rest)| rest.split_once(": "))
            .map(|(_, message)| message.to_owned())
            .or_else(|| line.trim().strip_prefix("help: ").map(|help| format!("help: {help}")))
    });
    found.collect()
}

fn move_at(data: &TaskData<'_>, name: &str, location: &str) -> Option<(i32, Name10)> {
    let locpt = data.locpt_named(&Name16::clipped(location))?;
    let found = data.relative_move(&Name16::clipped(name), &Place::point(locpt))?;
    Some((data.traj_para(found.para)?.vel_max, found.sensor))
}

#[test]
fn sensors_and_relative_moves_are_found_by_name_and_location() {
    let store = load(&format!(
        "{CELL}BLOCK# 602 OFFSET 21000
  -rel- INS-FAR lpt TOOL-TRNS 4 20 8 0 IN
  -rel- INS-IN   lpt TOOL-TRNS 4 10 8 0 IN   INS-FX
  -rel- QCD-DOWN own HOLSTER   4 12 8 0 IN   HOL-R-NEAR
  -rel- QCD-DOWN lpt HOLSTER-L 4  9 8 0 ...  BEAM
  -rel- QCA-UP   $$$           4 30 8 0 OUT
"
    ))
    .unwrap_or_else(|report| panic!("{report}"));
    let data = store.view();
    let sensor = data.sensor(&Name16::clipped("INS-FX")).unwrap();
    assert_eq!((sensor.source, sensor.which, sensor.threshold), (SensorSource::Fx, 0, -60));
    assert_eq!(data.sensor(&Name16::clipped("HOL-R-NEAR")).unwrap().which, 1);
    assert!(data.sensor(&Name16::clipped("INS-FY")).is_none());
    let named = Name10::clipped;
    assert_eq!(move_at(&data, "INS-FAR", "TOOL-TRNS"), Some((20, Name10::EMPTY)));
    assert_eq!(move_at(&data, "INS-IN", "TOOL-TRNS"), Some((10, named("INS-FX"))));
    assert_eq!(move_at(&data, "QCD-DOWN", "HOLSTER-R"), Some((12, named("HOL-R-NEAR"))), "by its owner");
    assert_eq!(move_at(&data, "QCD-DOWN", "HOLSTER-L"), Some((9, named("BEAM"))), "the exact entry wins");
    assert_eq!(move_at(&data, "QCA-UP", "HOLSTER-L"), Some((30, Name10::EMPTY)), "the wild card");
    assert_eq!(move_at(&data, "QCD-DOWN", "TOOL-TRNS"), None);
    assert_eq!(move_at(&data, "QCD-DOWN-AND-ON", "HOLSTER-L"), None, "no name is that long");
}

#[test]
fn relative_move_names_its_object() {
    assert_eq!(
        said("  -rel- INS-IN lpt TOOL-TRNS 4 10 8 0 IN INS-FY"),
        ["no sensor is named INS-FY", "help: the nearest known name is INS-FX"]
    );
    assert_eq!(
        said("  -rel- INS-IN lpt TOOL-TRN 4 10 8 0 INN INS-FX"),
        [
            "no location point is named TOOL-TRN",
            "help: the nearest known name is TOOL-TRNS",
            "no movetable is named INN",
            "help: the nearest known name is IN",
        ]
    );
    assert_eq!(
        said("  -rel- INS-IN lpt TOOL-TRNS 4 10 8 0 IN\n  -rel- INS-IN lpt TOOL-TRNS 4 10 8 0 OUT"),
        [
            "this relative move at this location is given twice",
            "help: the first is in try.blk, block 602 (offset 21000), line 0",
        ]
    );
    assert_eq!(said("  -rel- INS-IN lpt TOOL-TRNS 4 10 8 IN INS-FX"), ["brk-dst was expected, IN found"]);
}

#[test]
fn sensor_can_trip_and_is_not_always_true() {
    assert_eq!(
        said("  -sen- A fx 0 0"),
        [
            "the threshold of A is 0: it would always hold",
            "help: give the force in lb or the moment in in lb at which the move ends, with its sign",
        ]
    );
    assert_eq!(
        said("  -sen- A mx 0 10"),
        ["source of the sensor (fx, fy, fz, my, near, seated, beam) was expected, mx found"]
    );
    assert_eq!(said("  -sen- A near 4 0"), ["holster is from 1 to 3, 4 found"]);
    assert_eq!(said("  -sen- A beam 9 0"), ["beam is from 0 to 8, 9 found"]);
    assert_eq!(said("  -sen- A fx 1 10"), ["which (nothing to choose for a force) is from 0 to 0, 1 found"]);
    assert_eq!(said("  -sen- A seated 1 5"), ["threshold (a switch has none) is from 0 to 0, 5 found"]);
    assert_eq!(
        said("  -sen- INS-FX fy 0 5"),
        [
            "a sensor of this name is given twice",
            "help: the first is in try.blk, block 601 (offset 21000), line 0",
        ]
    );
}

#[test]
fn misspelt_prefix_is_not_a_sensor() {
    assert_eq!(
        said("  -rel- INS-IN lpt TOOL-TRNS 4 10 8 0 IN\n  -rle- INS-FAR lpt TOOL-TRNS 4 10 8 0 IN"),
        [
            "a compiling word or a number was expected, -rle- found",
            "help: the nearest compiling word is -rel-",
        ]
    );
}

fn warned(lines: &str) -> Vec<String> {
    let text = format!("{CELL}BLOCK# 602 OFFSET 21000\n{lines}\n");
    let source = Source { name: "try.blk".to_owned(), text: text.into() };
    let (_, report) = Store::from_sources(vec![source]).unwrap_or_else(|report| panic!("{report}"));
    report
        .warnings()
        .flat_map(|w| [w.message().to_owned(), w.help().unwrap_or_default().to_owned()])
        .collect()
}

#[test]
fn guarded_move_is_slow_enough_to_stop() {
    assert_eq!(
        warned("  -rel- INS-IN lpt TOOL-TRNS 4 2 8 0 IN INS-FX"),
        [
            "INS-IN at 0.2 in/s against something hard ends at 140 lb; INS-FX overloads at 128 lb",
            "the robot stands 0.2 s after 60 lb: vel-max 1 at most",
        ]
    );
    assert_eq!(warned("  -rel- INS-IN lpt TOOL-TRNS 4 1 8 0 IN INS-FX"), Vec::<String>::new());
    assert_eq!(
        warned("  -sen- STIFF my 0 -500\n  -rel- INS-IN lpt TOOL-TRNS 4 1 8 0 IN STIFF"),
        [
            "INS-IN at 0.1 in/s against something hard ends at 820 in lb; STIFF overloads at 512 in lb",
            "the robot stands 0.2 s after 500 in lb: take a smaller threshold",
        ]
    );
    let switch = warned("  -rel- QCD-DOWN own HOLSTER 4 100 8 0 IN HOL-R-NEAR");
    assert_eq!(switch, Vec::<String>::new(), "a switch is not pressed upon");
}

#[test]
fn relative_moves_equal_those_of_commands() {
    assert_eq!(
        said("  -rel- INS-IN lpt TOOL-TRNS 4 1 8 0 IN"),
        [
            "INS-IN is a guarded move and names no sensor",
            "help: write the name of a sensor (-sen-) after the movetable",
        ]
    );
    assert_eq!(
        warned("  -rel- INS-FAR lpt TOOL-TRNS 4 1 8 0 IN INS-FX"),
        ["INS-FAR is not a guarded move: nothing watches INS-FX", "leave the sensor out"]
    );
    assert_eq!(
        said("  -rel- INS-NEER lpt TOOL-TRNS 4 1 8 0 IN"),
        ["no command looks for a relative move INS-NEER", "help: the nearest known name is INS-NEAR"]
    );
}

#[test]
fn relative_moves_are_checked_from_their_start() {
    let far = "  1 t 0 0 -1500 -mtb- SLIDE   1 t 2500 0 0 -mtb- FAR\n";
    // The slide leads down to the height of the shoulder, from where the arm reaches farther.
    let slide = "  -rel- REL-SLIDE lpt TOOL-TRNS 4 1 8 0 SLIDE INS-FX\n";
    let back = "  -rel- REL-BACK lpt TOOL-TRNS 4 1 8 0 OUT\n";
    assert!(warned(&format!("{far}{slide}{back}")).is_empty());
    assert_eq!(
        said(&format!("{far}  -rel- REL-BACK lpt TOOL-TRNS 4 1 8 0 FAR")).first().map(String::as_str),
        Some("relative move REL-BACK at TOOL-TRNS: out of reach by 13.29 in")
    );
    assert_eq!(
        said(&format!("{far}{slide}  -rel- REL-BACK lpt TOOL-TRNS 4 1 8 0 FAR")).first().map(String::as_str),
        Some("relative move REL-BACK at TOOL-TRNS: out of reach by 12.08 in")
    );
}
