//! Who may not command the robot does not.

use std::{fs, os::unix::fs::PermissionsExt as _, os::unix::process::CommandExt as _, process::Command};

use neighbours::network::{Address, Peer, Role, Secret};
use rustix::process::geteuid;
use whole_system_tests::{Scratch, rcs_neighbour};

use crate::bench::{Controller, PATIENCE};

/// A user who owns nothing, on every system.
const NOBODY: u32 = 65_534;

fn secret(scratch: &Scratch, name: &str, text: &str) -> (Secret, String) {
    let file = scratch.file(name);
    fs::write(&file, text).expect("a file can be written");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).expect("its mode can be set");
    (Secret::load(&file).expect("it is long enough"), file.display().to_string())
}

#[test]
fn at_a_port_only_who_knows_the_secret_is_let_in() {
    let scratch = Scratch::new("port");
    let (ours, file) = secret(&scratch, "ours", "the key under the third flower pot");
    let (guessed, _) = secret(&scratch, "guessed", "the key under the second flower pot");
    let more = ["--clock", "real", "--secret", file.as_str(), "--ticks", "25"];
    let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more);
    for wrong in [None, Some(&guessed)] {
        let mut stranger = controller.connect(Role::Workstation, wrong);
        let told = stranger.receive().expect_err("he is not let in").to_string();
        assert_eq!(told, "the controller says: the proof of the secret is wrong");
    }
    let _friend = controller.connect(Role::Workstation, Some(&ours));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let refused = ended.page.matches("a connection was refused: the proof of the secret is wrong").count();
    assert_eq!(refused, 2, "{}", ended.page);
}

#[test]
fn a_port_without_a_secret_is_not_opened() {
    let output = Command::new(whole_system_tests::rcs_run())
        .args(["--network", "tcp:127.0.0.1:0", "--outside", "workstation"])
        .current_dir(whole_system_tests::root())
        .output()
        .expect("rcs-run can be started");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.trim_end().ends_with("name a file with --secret"), "{said}");
}

#[test]
fn there_is_one_workstation_controller() {
    let controller = Controller::start("one", "workstation", &["--clock", "real"]);
    let mut first = controller.connect(Role::Workstation, None);
    first.receive().expect("he is let in");
    let mut second = controller.connect(Role::Workstation, None);
    let told = second.receive().expect_err("he is not let in").to_string();
    assert_eq!(told, "the controller says: workstation is connected already");
}

/// Needs the right to become another user; without it nothing can be tried.
#[test]
fn at_a_socket_only_the_same_user_is_let_in() {
    if !geteuid().is_root() {
        eprintln!("not root: no other user to try");
        return;
    }
    let built = rcs_neighbour();
    let controller = Controller::start("socket", "workstation", &["--clock", "real", "--ticks", "25"]);
    let Address::Unix(socket) = &controller.address else { panic!("a socket was asked for") };
    // The program where anybody can start it, and data that anybody can read.
    let program = controller.file("rcs-neighbour");
    fs::copy(built, &program).expect("the program can be copied");
    controller.scratch.as_ref().expect("it has one").copy_data();
    let as_nobody = || {
        let output = Command::new(&program)
            .args(["workstation", "--wait", "0", "--network", &controller.address.to_string()])
            .current_dir(controller.file(""))
            .uid(NOBODY)
            .gid(NOBODY)
            .output()
            .expect("nobody can start the program");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = as_nobody();
    assert!(told.contains("Permission denied"), "{told}");
    // Even if somebody opens the door.
    fs::set_permissions(socket, fs::Permissions::from_mode(0o666)).expect("its mode can be set");
    let told = as_nobody();
    assert!(told.contains("user 0 was expected, found user 65534"), "{told}");
    let _friend =
        Peer::connect_within(PATIENCE, &controller.address, Role::Workstation, None).expect("it waits");
    let ended = controller.end();
    assert!(ended.page.contains("a connection was refused: user 0 was expected"), "{}", ended.page);
}
