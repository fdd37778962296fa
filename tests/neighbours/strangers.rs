//! Who may not command the robot does not.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    os::unix::fs::PermissionsExt as _,
    os::unix::process::CommandExt as _,
    process::Command,
    thread,
};

use neighbours::{
    mailbox::{HWSC_COMMAND, Mailbox},
    network::{
        Address, Peer, Role,
        frame::{Frame, LAST_WORDS},
        hello::{ANSWER, Challenge, ClockKind, HELLO, check_welcome},
        seal::SEAL,
    },
};
use whole_system_tests::{NOBODY, Scratch, may_become_nobody, rcs_neighbour};

use crate::bench::{Controller, PATIENCE, bare, secret};

#[test]
fn at_a_port_only_who_knows_the_secret_is_let_in() {
    let scratch = Scratch::new("port");
    let (ours, file) = secret(&scratch, "ours", "the key under the third flower pot");
    let (guessed, _) = secret(&scratch, "guessed", "the key under the second flower pot");
    let more = ["--clock", "real", "--secret", file.as_str(), "--ticks", "25"];
    let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more);
    for wrong in [None, Some(&guessed)] {
        let told = controller.try_connect(Role::Workstation, wrong).err().expect("he is not let in");
        let why = "the controller says: the proof of the secret is wrong";
        // Where no secret is named, nothing is ever proved.
        let mark = " (unverified: it has not proved that it knows the secret)";
        assert_eq!(told.to_string(), format!("{why}{}", if wrong.is_some() { mark } else { "" }));
    }
    let _friend = controller.connect(Role::Workstation, Some(&ours));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let refused = ended.page.matches("a connection was refused: the proof of the secret is wrong").count();
    assert_eq!(refused, 2, "{}", ended.page);
}

/// Who sits on the line and knows no secret can listen, but not speak.
#[test]
fn a_frame_that_another_has_put_on_the_line_moves_nothing() {
    let scratch = Scratch::new("forged");
    let (ours, file) = secret(&scratch, "ours", "the key under the third flower pot");
    let more = ["--clock", "real", "--secret", file.as_str(), "--ticks", "250"];
    let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more);
    let Address::Tcp(port) = controller.address else { panic!("a port was asked for") };
    let mut line = TcpStream::connect(port).expect("it waits");
    let mut hello = [0; HELLO];
    line.read_exact(&mut hello).expect("a hello");
    let challenge = Challenge::from_bytes(hello).expect("a hello");
    let (answer, agreement) = challenge.answer(Role::Workstation, Some(&ours)).expect("random bytes");
    line.write_all(&answer).expect("it listens");
    let welcome = Frame::read(&mut line).expect("a welcome");
    check_welcome(welcome.data(), agreement.as_ref()).expect("it is the controller");
    let command = neighbours::workstation::command::encode(&bare(1, "PAUSE")).expect("it fits");
    let mut mailbox = Mailbox::initialized(HWSC_COMMAND);
    mailbox.write(&command).expect("it fits");
    let (mut theirs, guessed) = (agreement.expect("there is a secret").down(), [0x5A; SEAL]);
    line.write_all(&[Frame::of(&mailbox).bytes(), &guessed].concat()).expect("it listens");
    let last = loop {
        let frame = Frame::read(&mut line).expect("last words");
        let mut seal = [0; SEAL];
        line.read_exact(&mut seal).expect("a seal");
        theirs.open(frame.bytes(), &seal).expect("it is the controller's");
        if frame.address() == LAST_WORDS {
            break String::from_utf8_lossy(frame.data()).into_owned();
        }
    };
    assert_eq!(last, "the seal of frame 1 is wrong: it was forged, damaged, or is not the next");
    let _friend = controller.connect(Role::Workstation, Some(&ours));
    let ended = controller.end();
    assert!(ended.page.contains(&format!("workstation has gone: {last}")), "{}", ended.page);
    assert!(!ended.page.contains("PAUSE"), "{}", ended.page);
}

#[test]
fn who_poses_as_the_controller_is_given_nothing() {
    let scratch = Scratch::new("impostor");
    let (ours, _) = secret(&scratch, "ours", "the key under the third flower pot");
    let trap = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = Address::Tcp(trap.local_addr().expect("it is bound"));
    let impostor = thread::spawn(move || {
        let (mut line, _) = trap.accept().expect("somebody comes");
        line.write_all(Challenge::new(ClockKind::Real).expect("random bytes").bytes()).expect("he listens");
        let mut answer = [0; ANSWER];
        line.read_exact(&mut answer).expect("he believes it");
        line.write_all(Frame::welcome(&answer[HELLO..]).bytes()).expect("he listens");
    });
    let told = Peer::connect(&address, Role::Workstation, Some(&ours)).err().expect("he is not taken in");
    impostor.join().expect("it ends");
    assert_eq!(
        told.to_string(),
        format!("{address}: the controller does not know the secret: somebody else answers in its place")
    );
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
    let told = controller.try_connect(Role::Workstation, None).err().expect("he is sent away").to_string();
    assert_eq!(told, "the controller says: workstation is connected already");
}

/// Needs the right to become another user; without it nothing can be tried.
#[test]
fn at_a_socket_only_the_same_user_is_let_in() {
    let scratch = Scratch::new("socket");
    if !may_become_nobody(&scratch.file("")) {
        eprintln!("no right to become another user: none to try");
        return;
    }
    let built = rcs_neighbour();
    let more = ["--clock", "real", "--ticks", "25"];
    let controller = Controller::start_at(scratch, None, "workstation", &more);
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
