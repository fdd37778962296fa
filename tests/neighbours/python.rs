//! The Python package and its examples, against a run and against wrong bytes.

use std::{
    io::{Read as _, Write as _},
    net::Shutdown,
    os::unix::net::UnixListener,
    process::{Command, Stdio},
    thread,
};

use whole_system_tests::{Scratch, root};

use super::bench::{Controller, example};

const EXAMPLES: [&str; 2] = ["hwsc.py", "vision.py"];
/// Magic number, version 3, and the clock, which the examples do not read.
const HELLO: &[u8] = b"RCS2\x03\x00\x01\x00";
const WELCOME: &[u8] = &[2, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0]; // address and length

fn python() -> Command {
    let mut command = Command::new("python3");
    command.arg("-B").env("PYTHONPATH", root().join("python/src")).current_dir(root());
    command
}

/// Without python3 the tests report that they check nothing.
#[expect(clippy::print_stderr, reason = "a test that checks nothing must say so")]
fn has_python() -> bool {
    let version =
        Command::new("python3").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = version.is_ok_and(|status| status.success());
    if !found {
        eprintln!("python3 is not installed: its package and examples are not tested");
    }
    found
}

/// Messages and exit status of an example, if the controller sends these bytes and closes the connection.
fn against(name: &str, example_name: &str, sent: &[u8]) -> (String, Option<i32>) {
    let scratch = Scratch::new(name);
    let socket = scratch.file("rcs.sock");
    let listener = UnixListener::bind(&socket).expect("the socket can be made");
    let sent = sent.to_vec();
    let controller = thread::spawn(move || {
        let (mut line, _) = listener.accept().expect("the example connects");
        line.write_all(&sent).expect("the example reads");
        line.shutdown(Shutdown::Write).expect("the example is there");
        let _ = line.read_to_end(&mut Vec::new()); // read, so that the end of the connection is not a reset
    });
    let output = python()
        .arg(example(example_name))
        .arg(format!("unix:{}", socket.display()))
        .output()
        .expect("python3 can be started");
    controller.join().expect("the controller ends");
    (String::from_utf8_lossy(&output.stderr).into_owned(), output.status.code())
}

fn disconnect(reason: &[u8]) -> Vec<u8> {
    let length = u16::try_from(8 + reason.len()).expect("a short reason");
    [&1_u32.to_le_bytes()[..], &length.to_le_bytes(), &[0; 6], reason].concat()
}

#[test]
fn hwsc_py_transfers_a_part() {
    if !has_python() {
        return;
    }
    let controller = Controller::start("python", "workstation", &["--json"]);
    let output = python()
        .arg(example("hwsc.py"))
        .arg(controller.address.to_string())
        .output()
        .expect("python3 can be started");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.ends_with("TRANSFER 2: executing\nTRANSFER 2: finished\n"), "{said}");
    let ended = controller.end();
    assert_eq!(ended.result["parts"][0]["location"], "PFIXTURE", "{}", ended.said);
}

/// This vision system shares only the byte format with the other one.
#[test]
fn vision_py_locates_a_part() {
    if !has_python() {
        return;
    }
    let controller = Controller::start("python-vision", "vision", &["linkbar", "--json", "--seed", "5"]);
    let output = python()
        .arg(example("vision.py"))
        .arg(controller.address.to_string())
        .output()
        .expect("python3 can be started");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.ends_with("the controller says: the run is over\n"), "{said}");
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["parts"][0]["name"], "LINKBAR1", "{}", ended.said);
}

#[test]
fn the_python_package_passes_its_own_tests() {
    if !has_python() {
        return;
    }
    let output = python().args(["-W", "error", "-m", "unittest", "discover", "python/tests"]).output();
    let output = output.expect("python3 can be started");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// An answer, a refusal, and the end of the run.
#[test]
fn an_operator_in_python_commands_a_run() {
    const SESSION: &str = "
import sys
from rcs_t3 import Operator, Refused
with Operator(sys.argv[1], 'anna') as operator:
    print(operator.request('status'))
    try:
        operator.request('MOVE -- +0 -- 0 +0 NOWHERE 0 -- 0')
    except Refused as refused:
        print(refused)
    print(operator.request('stop'))
";
    if !has_python() {
        return;
    }
    let more =
        ["linkbar", "--clock", "real", "--operator", "network", "--ticks", "400", "--run", "python-operator"];
    let controller = Controller::start("python-operator", "", &more);
    let output = python().args(["-c", SESSION, &controller.address.to_string()]).output();
    let output = output.expect("python3 can be started");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let lines: Vec<&str> = said.lines().collect();
    assert!(lines[0].starts_with("tick ") && lines[2].starts_with("tick "), "{said}");
    assert!(lines[1].starts_with("MOVE -- +0 -- 0 +0 NOWHERE 0 -- 0 is refused: "), "{said}");
    controller.end();
}

#[test]
fn control_characters_of_a_controller_are_masked() {
    if !has_python() {
        return;
    }
    let bytes = [HELLO, WELCOME, &disconnect(b"\x1b[31mred\x07 \xc2\x9b2J\r\n\xff end")].concat();
    for name in EXAMPLES {
        let (said, status) = against("python-masked", name, &bytes);
        assert!(said.ends_with(": the controller says: ?[31mred? ?2J??\u{fffd} end\n"), "{name}: {said}");
        assert_eq!(status, Some(1), "{name}");
    }
}

#[test]
fn wrong_bytes_of_a_controller_end_the_examples_with_one_message() {
    if !has_python() {
        return;
    }
    let short = [HELLO, &[2, 0, 0, 0, 0, 0][..]].concat();
    let other = [HELLO, &[0, 0, 4, 0, 8, 0, 0, 0, 0, 0, 0, 0][..]].concat();
    let cases: [(&[u8], &str); 6] = [
        (b"", "the controller has closed the connection"),
        (b"HTTP/1.1 400", "version 3 of the protocol was expected"),
        (&HELLO[..5], "the controller has closed the connection"),
        (&[HELLO, &WELCOME[..7]].concat(), "the controller has closed the connection"),
        (&other, "a welcome was expected, found a frame with the address 40000"),
        (&[short.as_slice(), WELCOME].concat(), "a length of 8 to 4096 was expected"),
    ];
    for name in EXAMPLES {
        for (bytes, expected) in cases {
            let (said, status) = against("python-lies", name, bytes);
            assert!(said.contains(expected), "{name}, {bytes:02X?}: {said}");
            assert_eq!((said.lines().count(), status), (1, Some(1)), "{name}, {bytes:02X?}: {said}");
        }
    }
}
