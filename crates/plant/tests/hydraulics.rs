//! The arm without pressure: how it sags, its contacts, and its return under pressure.

use crate::rig::{FIX_V1, FX1, Rig, UNIT_V1, description};
use depc::{controller::ControllerState, wire::Report};
use geometry::{
    frame::{Frame, Vector},
    kinematics::T3,
};
use interfaces::device::DeviceOutputs;
use plant::{Cell, CellDescription, CellEvent, Cut, EStop, Key, SagReport, WorkstationAction, t3::Stage};

const LONGEST: u32 = 3000; // ticks within which an arm comes to rest on any obstacle

const SAFE: [f64; 6] = [-132.0, 45.0, -89.9, -0.1, 0.0, 0.0]; // SAFE of the cell proposal, degrees

fn starting_at(start: [f64; 6]) -> CellDescription {
    let mut description = description();
    description.robot.start = start;
    description
}

fn settle(rig: &mut Rig) -> SagReport {
    for _ in 0..LONGEST {
        rig.tick();
        if let Some(droop) = rig.cell.droop().filter(|droop| droop.at_rest) {
            return droop.clone();
        }
    }
    panic!("the arm still sinks: {:?}", rig.cell.droop());
}

fn stop(rig: &mut Rig, site: EStop) -> SagReport {
    rig.cell.press(Key::Press(site)).unwrap();
    settle(rig)
}

/// The keys of III.6 and IV.3.3, each as soon as the previous one has taken effect.
fn start_up(rig: &mut Rig, keys: &[Key]) {
    for key in keys {
        rig.cell.press(*key).unwrap_or_else(|refusal| panic!("{key:?}: {refusal}"));
        loop {
            rig.tick();
            if !rig.cell.workstation_busy() {
                break;
            }
        }
    }
}

const PRESSURE: [Key; 3] = [Key::FaultReset, Key::Hydraulics(true), Key::Manual(true)];
const PROGRAM: [Key; 3] = [Key::Align(None), Key::Auto, Key::CycleStart];

fn hand(rig: &Rig) -> Vector {
    T3.forward(&rig.cell.joints()).position
}

fn contacts(rig: &Rig) -> Vec<&CellEvent> {
    rig.log.iter().filter(|event| matches!(event, CellEvent::Contact(_))).collect()
}

#[test]
fn sagging_arm_at_home_or_safe_touches_no_body() {
    for start in [description().robot.start, SAFE] {
        let mut rig = Rig::new(&starting_at(start), 1);
        let droop = stop(&mut rig, EStop::ControlPanel);
        assert_eq!(droop.cause, Cut::EStop(EStop::ControlPanel));
        assert!(droop.on_shot_pin && droop.touched.is_empty(), "from {start:?}: {:?}", droop.touched);
        assert_eq!(contacts(&rig), [] as [&CellEvent; 0], "from {start:?}");
        let sunk = Vector::from(droop.position) - hand(&rig);
        assert!(sunk.z > 15.0, "it has sagged by {sunk}");
        // With the shot pin of data/cell.toml the fingertips stop 13 in above the floor.
        assert!((hand(&rig).z + 37.0).abs() < 2.0, "{}", hand(&rig));
    }
}

#[test]
fn sagging_arm_over_the_vise_reports_its_contact() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.vise(WorkstationAction::VisePartial);
    rig.pick(0.0, 0.0, 0.0, 40.0);
    rig.carry();
    rig.insert();
    assert_eq!(contacts(&rig), [] as [&CellEvent; 0]);
    let droop = stop(&mut rig, EStop::JoystickBox);
    let hit: Vec<&str> = droop.touched.iter().map(|contact| contact.obstacle.as_str()).collect();
    assert!(hit.iter().any(|name| name.ends_with("_jaw") || *name == "vise_body"), "{droop:?}");
    assert!(droop.touched[0].depth > 0.01 && droop.touched[0].depth < 1.0, "{:?}", droop.touched);
    let said = rig.log.last().unwrap().to_string();
    assert!(said.contains("has come to rest") && said.contains("has run into things: "), "{said}");
    let lost = rig.log.iter().any(|event| event.to_string() == "LINKBAR1_BH is lost from the fingers");
    assert!(lost || rig.part().held, "{:?}", rig.part());
}

#[test]
fn fingers_keep_their_part_during_sagging() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 40.0);
    rig.carry();
    let before = hand(&rig);
    let droop = stop(&mut rig, EStop::JoystickBox);
    assert!((hand(&rig) - before).norm() > 2.0, "{droop:?}");
    assert!(rig.part().held, "air remains: {:?}", rig.part());
}

#[test]
fn sagging_arm_over_a_tray_hits_its_contents() {
    let mut rig = Rig::new(&description(), 1);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.go_and_stop(rig.grip_frame(4, 0.0, 0.0, 0.0, 4.0), 10.0);
    let droop = stop(&mut rig, EStop::Pedestal);
    assert!(droop.touched.iter().any(|contact| contact.obstacle.starts_with("UNIT_1_")), "{droop:?}");
    let reported = contacts(&rig);
    assert!(!reported.is_empty(), "{:?}", rig.log);
    let before = hand(&rig);
    rig.ticks(25);
    assert!((hand(&rig) - before).norm() < 0.3, "{}", hand(&rig) - before);
}

#[test]
fn sagging_arm_does_not_pass_through_its_support() {
    let mut rig = Rig::new(&description(), 1);
    rig.go_and_stop(FIX_V1.to_frame().unwrap(), 10.0);
    rig.go_and_stop(Rig::fixture(&FX1, 4.0, 0.0), 10.0);
    let droop = stop(&mut rig, EStop::Terminals);
    for contact in &droop.touched {
        assert!(contact.depth < 1.0, "{contact:?}");
    }
}

#[test]
fn pressure_lifts_the_arm_by_about_ten_inches() {
    let mut rig = Rig::new(&description(), 1);
    rig.cell.press(Key::Press(EStop::TeachPendant)).unwrap();
    rig.ticks(500);
    rig.cell.press(Key::Release(EStop::TeachPendant)).unwrap();
    start_up(&mut rig, &PRESSURE[..2]);
    let before = hand(&rig);
    start_up(&mut rig, &PRESSURE[2..]);
    let jump = hand(&rig) - before;
    assert!(jump.z > 2.0 && (jump.norm() - 10.0).abs() < 2.0, "{jump}");
    assert_eq!(rig.cell.droop(), None);
    let said: Vec<String> = rig.log.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.contains("the hand has jumped by ")), "{said:?}");
}

#[test]
fn start_up_restores_the_link_after_an_emergency_stop() {
    for site in EStop::ALL.iter().copied() {
        let mut rig = Rig::new(&description(), 1);
        rig.tick();
        assert!(rig.inputs.link_ready);
        rig.outputs.link_tx.extend(&[0x05]);
        rig.tick();
        assert!(Report::parse(rig.inputs.link_rx.as_slice()).is_ok());
        rig.cell.press(Key::Press(site)).unwrap();
        rig.tick();
        assert!(!rig.inputs.link_ready && rig.inputs.link_rx.length == 0, "a restart is not answered");
        rig.outputs = DeviceOutputs::default();
        assert!(rig.cell.press(Key::FaultReset).is_err(), "latched");
        rig.cell.press(Key::Release(site)).unwrap();
        start_up(&mut rig, &PRESSURE);
        start_up(&mut rig, &PROGRAM);
        assert_eq!((rig.cell.t3().stage(), rig.cell.depc()), (Stage::Depc, ControllerState::Running));
        assert!(rig.inputs.link_ready);
        let home = T3.forward(&geometry::kinematics::HOME_JOINTS);
        assert!(home.distance(&Frame { ..T3.forward(&rig.cell.joints()) }).inches < 0.01);
    }
}

#[test]
fn hydraulics_failure_is_a_fault_until_repair() {
    let mut rig = Rig::new(&description(), 1);
    rig.ticks(5);
    rig.cell.fail_hydraulics();
    let droop = settle(&mut rig);
    assert_eq!(droop.cause, Cut::PressureLost);
    assert_eq!(rig.cell.t3().stage(), Stage::Faulted);
    start_up(&mut rig, &PRESSURE);
    assert_eq!(rig.cell.t3().stage(), Stage::Faulted, "no pressure comes");
    rig.cell.repair_hydraulics();
    start_up(&mut rig, &PRESSURE);
    start_up(&mut rig, &PROGRAM);
    assert_eq!(rig.cell.t3().stage(), Stage::Depc);
}

#[test]
fn sagging_is_repeatable() {
    let run = || {
        let mut rig = Rig::new(&description(), 3);
        rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
        rig.cell.press(Key::Press(EStop::Pedestal)).unwrap();
        rig.ticks(200);
        rig.cell.joints().map(f64::to_bits)
    };
    assert_eq!(run(), run());
}

#[test]
fn arm_without_pressure_refuses_external_motion() {
    let mut cell = Cell::new(&description(), 1).unwrap();
    cell.press(Key::Press(EStop::Terminals)).unwrap();
    let refused = cell.drive(&T3.forward_plate(&cell.joints())).unwrap_err();
    assert_eq!(refused.to_string(), "the arm has no hydraulic pressure");
}
