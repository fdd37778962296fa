//! The end of a run that another process commands.

use std::{
    thread,
    time::{Duration, Instant},
};

use executive::memory::Attached;
use interfaces::HwsCommand;
use neighbours::{
    mailbox::{HWSC_STATUS, Mailbox},
    workstation::cell::Trouble,
};
use rcs_core::name::Name16;
use rustix::process::{Pid, Signal, kill_process};
use sessions::network::{Received, Role};

use super::bench::{Controller, Ended, TIME_LIMIT, Workstation, attend, bare};

const TOO_LONG: [&str; 3] = ["--json", "--ticks", "20000"]; // for runs that continue by mistake

const FAILED: Option<i32> = Some(1);
const STOPPED: Option<i32> = Some(3);

fn start(name: &str) -> (Controller, Workstation) {
    let controller = Controller::start(name, "workstation", &TOO_LONG);
    let workstation = Workstation::connect(&controller);
    (controller, workstation)
}

fn to_safe(number: u32) -> HwsCommand {
    HwsCommand { destination: Some(Name16::clipped("SAFE")), ..bare(number, "MOVE") }
}

fn start_moving(name: &str) -> (Controller, Workstation) {
    let (controller, mut workstation) = start(name);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    workstation.send(&to_safe(2));
    workstation.run_to(workstation.tick + 30);
    assert_eq!((workstation.status().echo, workstation.status().report.text()), (2, "executing"));
    (controller, workstation)
}

fn last_words(ended: &Ended) -> &str {
    ended.said.lines().last().unwrap_or_default()
}

fn assert_ended(ended: &Ended, status: Option<i32>, why: &str) {
    assert_eq!(ended.status, status, "{}", ended.said);
    assert!(last_words(ended).contains(why), "{why}: {}", ended.said);
    let failure = ended.result["failure"]["text"].as_str().expect("a failure");
    assert!(failure.contains(why), "{why}: {failure}");
}

#[test]
fn a_neighbour_that_leaves_before_its_answer_ends_the_run_in_its_first_tick() {
    for answers in 0..3 {
        let controller = Controller::start("early", "workstation", &TOO_LONG);
        let mut peer = controller.connect(Role::Workstation);
        for answer in 0..=answers {
            let tick = loop {
                if let Received::Pulse(tick) = peer.receive().expect("the controller continues") {
                    break tick;
                }
            };
            if answer < answers {
                peer.pulse(tick).expect("the controller reads");
            }
        }
        drop(peer);
        let ended = controller.end();
        assert_eq!(ended.status, Some(0), "{}", ended.said);
        assert_eq!(ended.result["ticks"], answers + 1);
    }
}

#[test]
fn a_neighbour_that_leaves_during_the_wait_ends_the_run_in_its_first_tick() {
    let controller = Controller::start("earlier", "workstation,pedestal", &TOO_LONG);
    drop(controller.connect(Role::Workstation));
    let pedestal = controller.connect(Role::Pedestal);
    let pedestal = thread::spawn(move || attend(pedestal));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["ticks"], 1);
    let events = ended.result["events"]["first"].as_array().expect("events").iter();
    let texts: Vec<_> = events.map(|event| event["text"].as_str().expect("a text")).collect();
    assert!(texts.iter().any(|text| text.starts_with("workstation has disconnected: ")), "{texts:?}");
    pedestal.join().expect("it has not panicked");
}

#[test]
fn a_neighbour_that_leaves_between_commands_has_finished() {
    let (controller, mut workstation) = start("between");
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    assert_eq!(workstation.carry_out(&bare(2, "FROBNICATE")).0, "error");
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert!(ended.result.get("failure").is_none());
}

#[test]
fn a_neighbour_that_leaves_during_a_motion_has_not_finished() {
    let (controller, workstation) = start_moving("amid");
    drop(workstation);
    let ended = controller.end();
    assert_ended(&ended, FAILED, "HWSC: the workstation controller has gone while MOVE was not finished");
    assert!(last_words(&ended).contains("in `== MOVE"), "{}", ended.said);
    assert_eq!(ended.result["failure"]["process"], "HWSC");
}

#[test]
fn a_neighbour_disconnected_for_a_protocol_error_has_not_finished() {
    let (controller, mut workstation) = start("violation");
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    let mut status = Mailbox::initialized(HWSC_STATUS);
    status.write(b"finished").expect("it fits");
    workstation.peer.send(&status).expect("the controller reads");
    while workstation.peer.receive().is_ok() {}
    let ended = controller.end();
    assert_ended(&ended, FAILED, "HWSC: the workstation controller was disconnected: the address of");
}

#[test]
fn an_unreset_emergency_stop_ends_the_run_when_the_arm_rests() {
    let (controller, mut workstation) = start("estop");
    workstation.begin_in_cell("estop terminals");
    while workstation.cell().trouble != Trouble::Emergency {
        workstation.tick();
    }
    drop(workstation);
    let ended = controller.end();
    assert_ended(&ended, STOPPED, "the E-stop near the terminals was pressed");
    assert_eq!(ended.result["emergency_stop"]["at_rest"], true);
}

#[test]
fn an_unreset_emergency_stop_is_a_failure_on_the_grid_too() {
    let controller = Controller::start("standing", "workstation", &["--json", "--clock", "real"]);
    let mut workstation = Workstation::connect(&controller);
    workstation.begin_in_cell("estop joystick-box");
    while workstation.cell().trouble != Trouble::Emergency {
        workstation.tick();
    }
    drop(workstation);
    kill_process(Pid::from_child(&controller.child), Signal::TERM).expect("it runs");
    assert_ended(&controller.end(), STOPPED, "the E-stop on the joystick box was pressed");
}

#[test]
fn robot_without_power_is_a_lost_link() {
    let (controller, mut workstation) = start("off");
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    workstation.in_cell("panel power off");
    workstation.run_to(workstation.tick + 50);
    drop(workstation);
    assert_ended(&controller.end(), STOPPED, "the controller has no power");
}

const BY_HAND: [&str; 6] = [
    "panel hydraulics disable",
    "panel hydraulics enable",
    "panel manual on",
    "panel align",
    "panel auto",
    "panel cycle-start",
];

/// After a replaced command the robot continues from its position, or the operator moves it to HOME.
#[test]
fn a_robot_stopped_on_its_way_continues_or_is_moved_back_by_hand() {
    let (controller, mut workstation) = start_moving("by-hand");
    assert_eq!(workstation.carry_out(&bare(3, "PAUSE")).0, "finished");
    for line in BY_HAND {
        workstation.in_cell(line);
    }
    assert_eq!(workstation.carry_out(&bare(4, "PAUSE")).0, "finished");
    workstation.send(&to_safe(5));
    workstation.run_to(workstation.tick + 30);
    assert_eq!(workstation.carry_out(&to_safe(6)), ("finished".to_owned(), String::new()));
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
}

#[test]
fn motion_by_hand_ends_with_the_workstation_controller_that_commands_it() {
    let name = format!("by-hand-{}", std::process::id());
    let controller = Controller::start("by-hand", "workstation", &["--clock", "20x", "--run", &name]);
    let mut workstation = Workstation::connect(&controller);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    let run = Attached::open(&name.parse().expect("a name")).expect("it runs");
    let shown = || {
        let joystick = run.external().expect("buffers").devices.joystick;
        (joystick.frame != 0, joystick.x, joystick.y)
    };
    workstation.in_cell("joystick velocity 100");
    workstation.in_cell("joystick frame WORLD");
    workstation.begin_in_cell("joystick stick 0 300 36000");
    let begun = Instant::now();
    while shown() != (true, 0, 300) {
        assert!(begun.elapsed() < TIME_LIMIT, "{:?}", shown());
        workstation.tick();
    }
    drop(workstation);
    while shown() != (false, 0, 0) {
        assert!(begun.elapsed() < TIME_LIMIT, "{:?}", shown());
        thread::sleep(Duration::from_millis(10));
    }
    controller.kill();
}
