//! A client without permission: another user at a socket, a second claimant of a role.

use std::{
    fs,
    os::unix::{fs::PermissionsExt as _, process::CommandExt as _},
    process::Command,
};

use sessions::network::{Peer, Role};
use whole_system_tests::{NOBODY, Scratch, may_become_nobody, rcs_neighbour, rcs_run, root};

use super::bench::{Controller, TIME_LIMIT};

/// Forms of earlier versions.
#[test]
fn addresses_and_keys_of_other_machines_are_refused_with_a_pointer_to_the_gateway() {
    let socket = format!("unix:{}", Scratch::new("removed").file("rcs.sock").display());
    let run = ["--outside", "workstation", "--network"];
    let [tcp, zenoh] = ["tcp:127.0.0.1:0", "zenoh:t3@tcp/127.0.0.1:7447"];
    for (program, arguments) in [
        (rcs_run(), [&run[..], &[tcp]].concat()),
        (rcs_run(), [&run[..], &[zenoh]].concat()),
        (rcs_run(), [&run[..], &[&socket, "--keys", "keys"]].concat()),
        (rcs_run(), [&run[..], &[&socket, "--zenoh-config", "zenoh.json5"]].concat()),
        (rcs_run(), vec!["send", "--connect", tcp, "PAUSE"]),
        (rcs_run(), vec!["send", "--connect", &socket, "--keys", "keys", "PAUSE"]),
        (rcs_neighbour(), vec!["workstation", "--network", tcp]),
        (rcs_neighbour(), vec!["workstation", "--network", &socket, "--keys", "keys"]),
        (rcs_neighbour(), vec!["keys", "cell-keys", "--days", "3"]),
    ] {
        let output = Command::new(program).args(&arguments).current_dir(root()).output();
        let output = output.expect("the program can be started");
        let said = String::from_utf8_lossy(&output.stderr).replace('\n', " ");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        let names_both = said.contains("rcs-gateway") && said.contains("docs/several-machines.md");
        assert!(names_both, "{arguments:?}: {said}");
    }
}

#[test]
fn second_workstation_controller_is_refused() {
    let controller = Controller::start("one", "workstation", &["--clock", "real"]);
    let mut first = controller.connect(Role::Workstation);
    first.receive().expect("it is admitted");
    let told = controller.try_connect(Role::Workstation).err().expect("it is refused").to_string();
    assert_eq!(told, "the controller says: workstation is connected already");
}

/// Skipped without the right to become another user.
#[test]
fn at_a_socket_only_the_same_user_is_admitted() {
    let scratch = Scratch::new("socket");
    if !may_become_nobody(&scratch.file("")) {
        eprintln!("no right to become another user: none to try");
        return;
    }
    let built = rcs_neighbour();
    let more = ["--clock", "real", "--ticks", "100"];
    let controller = Controller::start_at(scratch, None, "workstation", &more);
    let socket = controller.address.path();
    let program = controller.file("rcs-neighbour"); // any user can start the program and read the data
    fs::copy(built, &program).expect("the program can be copied");
    controller.scratch.as_ref().expect("it has one").copy_data();
    let as_nobody = || {
        let output = Command::new(&program)
            .args(["workstation", "--wait", "0", "--network", &controller.address.to_string()])
            .current_dir(controller.file(""))
            .uid(NOBODY)
            .gid(NOBODY)
            .output()
            .expect("the user nobody can start the program");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = as_nobody();
    assert!(told.contains("Permission denied"), "{told}");
    // Both sides check the user at the other end, for any mode of the socket.
    fs::set_permissions(socket, fs::Permissions::from_mode(0o666)).expect("its mode can be set");
    let told = as_nobody();
    assert!(told.contains("user 65534 was expected, found user 0"), "{told}");
    let _own = Peer::connect_within(TIME_LIMIT, &controller.address, Role::Workstation).expect("it waits");
    let ended = controller.end();
    assert!(
        ended.page.contains("a connection was refused: user 0 was expected, found user 65534"),
        "{}",
        ended.page
    );
}
