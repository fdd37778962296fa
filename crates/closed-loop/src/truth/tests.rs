//! Each verdict, with a cell made for it.

use std::path::Path;

use geometry::frame::{Frame, Vector, rotation_by};
use interfaces::{
    CommonMemory, HwsCommand, StatusReport, Unconfirmed,
    device::Picture,
    emove::EmoveVerb,
    hws::HwsReport,
    prim::{PrimReport, PrimVerb},
};
use plant::{Cell, CellDescription, Placement, WorkstationAction};
use rcs_core::{name::Name16, tick::Tick};
use taskdata::load::Store;

use super::{
    Claim, Confirmation, Contradiction, Level, NotSensed, Scene, TruthCheck, Verdict,
    history::{History, Released},
};

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
const TICK: Tick = Tick(100);

struct Bench {
    store: Store,
    cell: Cell,
    memory: CommonMemory,
    hws: HwsCommand,
    history: History,
}

impl Bench {
    fn new() -> Self {
        let data = Path::new(DATA);
        let Ok((store, _)) = Store::load(data) else { panic!("the shipped data do not load") };
        let description = CellDescription::load(&data.join("cell.toml")).expect("the cell is shipped");
        let cell = Cell::new(&description, 1).expect("the cell is sound");
        Self {
            store,
            cell,
            memory: CommonMemory::default(),
            hws: HwsCommand::default(),
            history: History::default(),
        }
    }

    fn description(&self) -> &CellDescription {
        self.cell.description()
    }

    fn tool(&self) -> Frame {
        self.cell.t3().arm().tool()
    }

    fn put(&mut self, part: &str, unit: &str, sector: u16) -> u32 {
        let placement = Placement::At { x: 0.0, y: 0.0, angle: 0.0 };
        let place = WorkstationAction::Place { part: part.into(), unit: unit.into(), sector, placement };
        let id = self.cell.next_part_number();
        self.cell.workstation(&place).expect("the sector is free");
        id
    }

    fn release(&mut self, id: u32) {
        let part = self.cell.part_frame(id).expect("the part is in the cell");
        self.history.released = Some(Released { id, tick: TICK, tool: self.tool(), part });
    }

    fn check(&self, claim: &Claim) -> Result<(), Contradiction> {
        let data = &self.store.view();
        let scene = Scene { tick: TICK, hws: &self.hws, memory: &self.memory, data, cell: &self.cell };
        claim.check(&scene, &self.history)
    }

    /// The reason why an untrue claim is not sensed; `None` if it is false.
    fn not_sensed(&self, claim: &Claim) -> Option<NotSensed> {
        self.check(claim).expect_err("it is untrue").not_sensed
    }

    fn look(&self, check: &mut TruthCheck, tick: u64) -> Vec<Confirmation> {
        let data = &self.store.view();
        let tick = Tick(tick);
        check.look(&Scene { tick, hws: &self.hws, memory: &self.memory, data, cell: &self.cell })
    }
}

fn name(text: &str) -> Name16 {
    Name16::clipped(text)
}

#[test]
fn a_goal_beyond_the_tolerance_is_untrue() {
    let bench = Bench::new();
    let at = |inches: f64, degrees: f64| {
        let turn = rotation_by(&Vector::new(0.0, 0.0, degrees.to_radians()));
        let tool = bench.tool();
        let position = tool.position + Vector::new(0.0, inches, 0.0);
        let goal = Frame { position, rotation: turn * tool.rotation };
        bench.check(&Claim::At { goal, name: "HOME".into() })
    };
    assert_eq!((at(0.0, 0.0), at(0.03, 0.1)), (Ok(()), Ok(())));
    let Contradiction { text, not_sensed } = at(0.05, 0.0).expect_err("it is 0.05 in away");
    assert!(text.contains("0.050 in") && text.contains("from HOME") && not_sensed.is_none(), "{text}");
    assert!(at(0.0, 0.2).is_err());
}

#[test]
fn gripper_on_the_robot_and_those_in_their_holsters_are_seen() {
    let bench = Bench::new();
    assert_eq!(bench.check(&Claim::Wears(1)), Ok(()));
    assert!(bench.check(&Claim::Wears(2)).is_err());
    assert!(bench.check(&Claim::WearsNone(Some(1))).is_err());
    assert!(!bench.cell.is_holstered(1) && bench.cell.is_holstered(2) && bench.cell.is_holstered(3));
}

#[test]
fn a_robot_without_object_holds_and_releases_none() {
    let bench = Bench::new();
    assert_eq!(bench.check(&Claim::HoldsNothing), Ok(()));
    let held = Claim::Holds { object: name("LINKBAR1"), place: Vec::new(), unseen: false };
    assert_eq!(bench.not_sensed(&held), None);
    for still in [Claim::RobotStops, Claim::FingersStill, Claim::PedestalStill] {
        assert_eq!(bench.check(&still), Ok(()), "{still:?}");
    }
    assert!(bench.check(&Claim::Touches).is_err());
}

#[test]
fn a_part_in_another_sector_does_not_lie_at_its_place() {
    let mut bench = Bench::new();
    bench.put("LINKBAR1_BH", "UNIT_1", 4);
    let at = |sector| Claim::LiesAt { object: name("LINKBAR1_BH"), place: ("UNIT_1".into(), sector) };
    assert_eq!(bench.check(&at(4)), Ok(()));
    let Contradiction { text, not_sensed } = bench.check(&at(1)).expect_err("it is in another sector");
    assert_eq!((text.as_str(), not_sensed), ("no LINKBAR1_BH is at UNIT_1 1, but at UNIT_1 4", None));
}

#[test]
fn part_taken_after_its_release_is_not_sensed() {
    let mut bench = Bench::new();
    let id = bench.put("LINKBAR1_BH", "UNIT_1", 4);
    bench.release(id);
    let placed = Claim::Placed { object: name("LINKBAR1_BH"), goal: bench.tool() };
    let lies = Claim::LiesAt { object: name("LINKBAR1_BH"), place: ("UNIT_1".into(), 4) };
    assert_eq!((bench.check(&placed), bench.check(&lies)), (Ok(()), Ok(())));
    bench.cell.take_part(id).expect("nothing holds it");
    assert_eq!(bench.not_sensed(&placed), None, "nobody has taken it");
    bench.history.note_changed(TICK, [id]);
    for claim in [placed, lies] {
        assert_eq!(bench.not_sensed(&claim), Some(NotSensed::ChangedAfterLook));
    }
}

#[test]
fn a_part_released_away_from_its_goal_is_not_placed() {
    let mut bench = Bench::new();
    let id = bench.put("LINKBAR1_BH", "UNIT_1", 4);
    bench.release(id);
    let tool = bench.tool();
    let beside = |inches: f64| Claim::Placed {
        object: name("LINKBAR1_BH"),
        goal: Frame { position: tool.position + Vector::new(inches, 0.0, 0.0), ..tool },
    };
    assert_eq!(bench.check(&beside(0.2)), Ok(()));
    assert_eq!(bench.not_sensed(&beside(0.3)), None);
}

#[test]
fn part_next_to_an_added_one_is_not_sensed() {
    let mut bench = Bench::new();
    let id = bench.put("LINKBAR1_BH", "UNIT_1", 4);
    bench.release(id);
    let tool = bench.tool();
    let goal = Frame { position: tool.position + Vector::new(0.3, 0.0, 0.0), ..tool };
    let placed = Claim::Placed { object: name("LINKBAR1_BH"), goal };
    assert_eq!(bench.not_sensed(&placed), None, "the robot was not at its goal");
    let placed = Claim::Placed { object: name("LINKBAR1_BH"), goal: tool };
    bench.history.released.as_mut().expect("it was released").part.position.x += 1.0;
    assert_eq!(bench.not_sensed(&placed), None, "nobody has put anything there");
    let far = bench.put("LINKBAR1", "UNIT_1", 1);
    bench.history.note_changed(Tick(1), [far]);
    assert_eq!(bench.not_sensed(&placed), None, "the other part is out of reach");
    let other = bench.cell.next_part_number();
    let frame = bench.cell.part_frame(id).expect("it is in the cell");
    let above = Frame { position: frame.position + Vector::new(0.0, 0.0, 3.0), ..frame };
    let put = WorkstationAction::Put { part: "LINKBAR1".into(), frame: above };
    bench.cell.workstation(&put).expect("the place is free");
    bench.history.note_changed(Tick(1), [other]);
    assert_eq!(bench.not_sensed(&placed), Some(NotSensed::Occupied));
}

#[test]
fn part_grasped_off_its_place_keeps_the_unsensed_reason() {
    let mut bench = Bench::new();
    let id = bench.put("LINKBAR1_BH", "UNIT_1", 4);
    bench.release(id);
    bench.history.released.as_mut().expect("it was released").part.position.x += 1.0;
    let placed = Claim::Placed { object: name("LINKBAR1_BH"), goal: bench.tool() };
    assert_eq!(bench.not_sensed(&placed), None);
    bench.history.note_displaced(&bench.cell, NotSensed::NoPicture);
    assert_eq!(bench.not_sensed(&placed), Some(NotSensed::NoPicture));
    // A picture shows the place of the part.
    bench.memory.subtask.emove.command = EmoveVerb::LocateObj;
    bench.memory.subtask.emove.object = Some(name("LINKBAR1_BH"));
    bench.memory.emove.vision.number = 1;
    bench.memory.emove.vision.picture = Picture::Precise;
    let mut history = bench.history.clone();
    let data = &bench.store.view();
    history.look(&Scene { tick: TICK, hws: &bench.hws, memory: &bench.memory, data, cell: &bench.cell });
    assert_eq!(history.displaced(id), None);
    assert_eq!(history.looked, Some((TICK, "LINKBAR1_BH".to_owned())));
}

#[test]
fn failures_younger_than_a_reading_are_not_sensed() {
    let mut bench = Bench::new();
    bench.history.is_up = true;
    assert!(!bench.history.has_just_failed(Tick(1), Level::Prim), "nothing has failed");
    (bench.history.up, bench.history.is_up) = (Tick(0), false);
    let ages = [(Level::Prim, 2), (Level::Emove, 3), (Level::Subtask, 4), (Level::Task, 5)];
    for (level, age) in ages {
        assert!(bench.history.has_just_failed(Tick(age), level), "{level}");
        assert!(!bench.history.has_just_failed(Tick(age + 1), level), "{level}");
    }
}

#[test]
fn an_unconfirmed_place_in_the_fingers_covers_its_consequences() {
    let place = ("UNIT_1".into(), 4);
    let claims = [
        Claim::Holds { object: name("LINKBAR1"), place: Vec::new(), unseen: false },
        Claim::LiesAt { object: name("LINKBAR1"), place },
        Claim::InDrum(name("DRILL-2")),
    ];
    for claim in claims {
        assert!(claim.is_covered(Unconfirmed::PartInFingers, true), "{claim:?}");
    }
    for claim in [Claim::HoldsNothing, Claim::Wears(1), Claim::HoldsAlone] {
        assert!(!claim.is_covered(Unconfirmed::PartInFingers, true), "{claim:?}");
    }
}

/// Jaws without a force sensor do not show whether they press. That does not excuse a misplaced part between them.
#[test]
fn unconfirmed_grasp_force_covers_only_a_lost_part() {
    let held = Claim::Holds { object: name("SHAFT"), place: Vec::new(), unseen: true };
    assert!(held.is_covered(Unconfirmed::GraspForce, false), "the fingers are empty");
    assert!(!held.is_covered(Unconfirmed::GraspForce, true), "it is held elsewhere");
    assert!(!Claim::HoldsNothing.is_covered(Unconfirmed::GraspForce, false));
}

/// An arm without pressure has pushed the part, and the camera finds it outside its sector.
#[test]
fn part_found_by_the_camera_outside_its_sector_is_located() {
    let mut bench = Bench::new();
    bench.put("LINKBAR1_BH", "UNIT_1", 4);
    let sector = bench.description().tray("UNIT_1").and_then(|tray| tray.sector(4)).expect("it is a sector");
    let near = Frame { position: sector.position + geometry::frame::Vector::new(8.0, 0.0, 0.0), ..sector };
    let located = |frame: &Frame| {
        Some(interfaces::emove::Located {
            object: name("LINKBAR1_BH"),
            pose: geometry::pose::Pose::from_frame(frame),
            ..interfaces::emove::Located::default()
        })
    };
    let claim = Claim::Located { object: name("LINKBAR1_BH"), near };
    bench.memory.emove.estimates.located = located(&sector);
    assert_eq!(bench.check(&claim), Ok(()));
    bench.memory.emove.estimates.located = located(&near);
    assert!(bench.check(&claim).is_err(), "nothing lies where it is reported");
}

#[test]
fn part_moved_before_its_picture_is_false_and_after_it_not_sensed() {
    let mut bench = Bench::new();
    bench.put("LINKBAR1_BH", "UNIT_1", 4);
    let near = bench.description().tray("UNIT_1").and_then(|tray| tray.sector(4)).expect("it is a sector");
    let claim = Claim::Located { object: name("LINKBAR1_BH"), near };
    assert_eq!(bench.not_sensed(&claim), None, "no part was located");
    let away = Claim::Located { object: name("LINKBAR1"), near };
    bench.memory.emove.estimates.located = Some(interfaces::emove::Located {
        object: name("LINKBAR1"),
        pose: geometry::pose::Pose::from_frame(&near),
        ..interfaces::emove::Located::default()
    });
    assert_eq!(bench.check(&claim), Ok(()));
    bench.history.looked = Some((TICK, "LINKBAR1_BH".into()));
    bench.history.note_changed(TICK, [9]);
    assert!(bench.check(&away).is_err());
    // There is no part at the reported place.
    let nowhere = Frame::identity();
    bench.memory.emove.estimates.located = Some(interfaces::emove::Located {
        object: name("LINKBAR1"),
        pose: geometry::pose::Pose::from_frame(&nowhere),
        ..interfaces::emove::Located::default()
    });
    let gone = Claim::Located { object: name("LINKBAR1_BH"), near: nowhere };
    assert_eq!(bench.not_sensed(&gone), Some(NotSensed::ChangedAfterLook));
}

#[test]
fn a_tool_in_the_drum_is_seen() {
    let mut bench = Bench::new();
    let tool = |text: &str| WorkstationAction::DrumTool { part: text.into() };
    bench.cell.workstation(&tool("DRILL-2")).expect("the drum is empty");
    let (drill, mill) = (name("DRILL-2"), name("ENDMILL-1"));
    assert_eq!(bench.check(&Claim::InDrum(drill)), Ok(()));
    assert_eq!(bench.not_sensed(&Claim::InDrum(mill)), None);
    assert!(bench.check(&Claim::OutOfDrum(drill)).is_err());
    assert_eq!(bench.check(&Claim::OutOfDrum(mill)), Ok(()));
    assert!(Claim::InDrum(mill).is_covered(Unconfirmed::ToolInDrum, true));
    assert!(!Claim::HoldsNothing.is_covered(Unconfirmed::ToolInDrum, true));
}

/// A bench whose E-move executes MOV-TO-LOC to a location of the task data.
fn going_to(location: &str, number: u32) -> Bench {
    let mut bench = Bench::new();
    let data = bench.store.view();
    let found = data
        .resolve_location::<16, 16>(&name(location), None, None)
        .expect("the location is in the task data");
    let record = data.locpt(found.place.locpt).expect("it is a location point");
    let command = &mut bench.memory.subtask.emove;
    (command.number, command.command, command.site) = (number, EmoveVerb::MovToLoc, found.site());
    command.pose = Some(record.pose.number());
    bench
}

#[test]
fn a_status_is_judged_in_the_tick_in_which_it_becomes_finished() {
    let mut bench = going_to("HOME", 5);
    let mut check = TruthCheck::default();
    assert_eq!(bench.look(&mut check, 1), []);
    bench.memory.emove.status.echo = 5;
    bench.memory.emove.status.report = StatusReport::Done;
    assert_eq!((bench.look(&mut check, 2), check.result().judged), (Vec::new(), 1));
    assert_eq!((bench.look(&mut check, 3), check.result().judged), (Vec::new(), 1));
}

#[test]
fn a_false_confirmation_fails_the_run_with_its_level_and_command() {
    let mut bench = going_to("SAFE", 5);
    let mut check = TruthCheck::default();
    bench.look(&mut check, 1);
    // The next command arrives in the same tick: the status belongs to the previous command.
    let command = &mut bench.memory.subtask.emove;
    (command.number, command.command) = (6, EmoveVerb::Release);
    (bench.memory.emove.status.echo, bench.memory.emove.status.report) = (5, StatusReport::Done);
    let found = bench.look(&mut check, 2);
    let [Confirmation { tick: 2, level: Level::Emove, command, verdict: Verdict::False, truth }] = &found[..]
    else {
        panic!("{found:?}")
    };
    assert!(command.starts_with("MOV-TO-LOC") && truth.contains("from SAFE"), "{command}: {truth}");
    let failure = check.verdict().expect("the run has failed");
    assert_eq!(failure.tick, Tick(2));
    assert!(
        failure.text.starts_with("a confirmation is false: E-move reports MOV-TO-LOC"),
        "{}",
        failure.text
    );
}

#[test]
fn each_level_is_judged_by_its_own_commands() {
    let mut bench = Bench::new();
    let mut check = TruthCheck::default();
    bench.hws = HwsCommand { number: 1, command: name("PAUSE"), ..HwsCommand::default() };
    let prim = &mut bench.memory.emove.prim;
    (prim.number, prim.command) = (2, PrimVerb::Pause);
    let subtask = &mut bench.memory.task.subtask;
    (subtask.number, subtask.command) = (3, interfaces::subtask::SubtaskVerb::GetEndeff);
    subtask.end_effector_id = Some(2);
    bench.look(&mut check, 1);
    (bench.memory.task.status.echo, bench.memory.task.status.report) = (1, HwsReport::Finished);
    (bench.memory.prim.status.echo, bench.memory.prim.status.report) = (2, PrimReport::Done);
    (bench.memory.subtask.status.echo, bench.memory.subtask.status.report) = (3, StatusReport::Done);
    let found = bench.look(&mut check, 2);
    assert_eq!(check.result().judged, 3);
    assert_eq!(found.iter().map(|one| one.level).collect::<Vec<_>>(), [Level::Subtask]);
    assert_eq!(found[0].truth, "gripper 1 is on the robot, not 2");
}
