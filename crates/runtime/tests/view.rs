//! The view of a run in other programs.

use std::path::PathBuf;

use closed_loop::account::Kind;
use executive::memory::{Attached, RunName, cell::CellView};
use interfaces::ProcessId;
use levels::ladder::Ladder;
use rcs_core::tick::Tick;
use runtime::{Ending, LogTarget, Run, RunConfig};

fn config(test: &str) -> RunConfig {
    let data = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
    let name = Some(RunName::unique(test));
    RunConfig { log: LogTarget::None, name, ..RunConfig::new(data, "linkbar") }
}

/// Run to a tick; calls `look` after each tick.
fn run(config: RunConfig, last: u64, mut look: impl FnMut(&Run, &Attached)) -> CellView {
    let name = config.name.clone().expect("it has one");
    let mut run = Run::new(config, Box::new(())).expect("the data are sound");
    let reader = Attached::open(&name).expect("the run shows its buffers");
    assert_eq!(reader.cell(), Ok(None));
    while run.last_tick() < Tick(last) {
        assert!(run.step(), "the run has ended in tick {}", run.last_tick());
        look(&run, &reader);
    }
    reader.cell().expect("it is legal").expect("there is a simulated cell")
}

#[test]
fn cell_view_shows_the_state_of_the_cell() {
    let view = run(config("view"), 881, |_, _| {});
    let controller = &view.controller;
    assert_eq!((view.tick, controller.stage.as_str()), (Tick(881), "DEPC"));
    assert!(controller.lamps.power && controller.lamps.hydraulics_on && !controller.lamps.fault_reset);
    assert_eq!((controller.estops, controller.cut.as_str()), ([false; 5], ""));
    assert_eq!(
        (view.job.line.as_str(), view.job.begun, view.job.lines),
        ("== MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0", 3, 13)
    );
    assert_eq!((view.job.phase.as_str(), view.commander.source.as_str()), ("plays", "job"));
    assert!(view.job.began > Tick(70) && view.job.began < Tick(80), "{:?}", view.job);
    assert_eq!((view.gripper, view.part_count), (Some(1), 1));
    let part = &view.parts[0];
    assert_eq!((part.name.as_str(), part.location.as_str(), part.sector), ("LINKBAR1_BH", "UNIT_1", 4));
    assert!(view.tool[0] < -40.0 && view.fingers[0] > 2.5, "{view:?}");
    assert_eq!(view.lateness, Default::default(), "a run in fast clock has no grid");
}

/// A button that is pressed after a tick removes the pressure in the next tick, which the account of the run names.
#[test]
fn tick_of_an_emergency_stop_is_that_of_the_account() {
    let directory = tempfile::tempdir().expect("a directory can be made");
    let job = directory.path().join("stops.job");
    std::fs::write(&job, "** after 60 estop pedestal\n== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n")
        .expect("it can be written");
    let (mut config, mut shown) = (config("estop"), Vec::new());
    config.job = job.display().to_string();
    let name = config.name.clone().expect("it has one");
    let mut run = Run::new(config, Box::new(())).expect("the data are sound");
    let reader = Attached::open(&name).expect("the run shows its buffers");
    while run.step() {
        shown.extend(reader.cell().expect("it is legal").map(|view| (view.tick, view.controller)));
    }
    let (first, pressed) =
        shown.iter().find(|(_, shown)| !shown.cut.as_str().is_empty()).expect("it is pressed");
    assert!(pressed.lamps.fault_reset && pressed.cut.as_str().contains("near the pedestal"), "{pressed:?}");
    assert_eq!(pressed.cut_tick, first.next());
    assert!(shown.iter().all(|(tick, shown)| tick < first || shown.cut_tick == pressed.cut_tick));
    let Ending::Failed(account) = run.finish().ending else { panic!("an emergency stop ends the job") };
    assert_eq!((account.first.kind, account.first.tick), (Kind::EmergencyStop, pressed.cut_tick));
}

#[test]
fn every_header_has_the_row_of_its_values() {
    let (mut seen, mut near) = (Tick::BEFORE_START, 0);
    run(config("rows"), 881, |run, reader| {
        // The longest interval at which a reader loses no tick.
        if !run.last_tick().0.is_multiple_of(250) {
            return;
        }
        for headers in reader.history(seen).expect("it is legal") {
            assert_eq!(headers.tick, seen.next());
            seen = headers.tick;
            for (process, id) in Ladder::processes().iter().zip(ProcessId::ALL) {
                let header = headers.of_process(*id);
                let beside = header.beside.iter().flatten().copied();
                for consulted in header.consulted().into_iter().chain(beside) {
                    let (table, row) = process.row(consulted.decided).expect("it exists");
                    assert_eq!(table.consult(consulted.values), Some(row), "{} {}", process.name, table.name);
                    near += table.near_misses(consulted.values).filter(|miss| miss.row != row).count();
                }
            }
        }
    });
    assert_eq!(seen, Tick(750));
    assert!(near > 1000, "{near}");
}
