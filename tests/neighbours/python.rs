//! The neighbours in Python that the documentation shows. Against a controller that lies they mask what it says,
//! and end with a sentence.

use std::{
    io::{Read as _, Write as _},
    net::Shutdown,
    os::unix::net::UnixListener,
    process::{Command, Stdio},
    thread,
};

use whole_system_tests::Scratch;

use super::bench::{Controller, example, make_keys};

const EXAMPLES: [&str; 2] = ["hwsc.py", "vision.py"];
/// Mark, version 3, and the clock, which the examples do not read.
const HELLO: &[u8] = b"RCS2\x03\x00\x01\x00";
/// Address and length of a frame without data.
const WELCOME: &[u8] = &[2, 0, 0, 0, 8, 0, 0, 0, 0, 0, 0, 0];

/// True if python3 can be started; else the tests say that they try nothing.
#[expect(clippy::print_stderr, reason = "a test that tries nothing says so")]
fn has_python() -> bool {
    let version =
        Command::new("python3").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = version.is_ok_and(|status| status.success());
    if !found {
        eprintln!("no python3 here: its examples are not tried");
    }
    found
}

/// What an example says, and its exit status, if the controller sends these bytes and goes.
fn against(name: &str, example_name: &str, sent: &[u8]) -> (String, Option<i32>) {
    let scratch = Scratch::new(name);
    let socket = scratch.file("rcs.sock");
    let listener = UnixListener::bind(&socket).expect("the socket can be made");
    let sent = sent.to_vec();
    let controller = thread::spawn(move || {
        let (mut line, _) = listener.accept().expect("the example connects");
        line.write_all(&sent).expect("the example reads");
        line.shutdown(Shutdown::Write).expect("the example is there");
        // What the example says is read, so that the end of the line is not a reset.
        let _ = line.read_to_end(&mut Vec::new());
    });
    let output = Command::new("python3")
        .arg("-B")
        .arg(example(example_name))
        .arg(format!("unix:{}", socket.display()))
        .output()
        .expect("python3 can be started");
    controller.join().expect("the controller ends");
    (String::from_utf8_lossy(&output.stderr).into_owned(), output.status.code())
}

/// A disconnect frame with a reason.
fn disconnect(reason: &[u8]) -> Vec<u8> {
    let length = u16::try_from(8 + reason.len()).expect("a short reason");
    [&1_u32.to_le_bytes()[..], &length.to_le_bytes(), &[0; 6], reason].concat()
}

/// The client in another language that the documentation shows, with TLS and strict verification of certificates.
#[test]
fn hwsc_py_transfers_a_part() {
    if !has_python() {
        return;
    }
    let scratch = Scratch::new("python");
    let keys = make_keys(&scratch, "keys", 1).display().to_string();
    let more = ["--json", "--keys", keys.as_str()];
    let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more);
    let output = Command::new("python3")
        .arg(example("hwsc.py"))
        .args([&controller.address.to_string(), &keys])
        .output()
        .expect("python3 can be started");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.ends_with("TRANSFER 2: executing\nTRANSFER 2: finished\n"), "{said}");
    let ended = controller.end();
    assert_eq!(ended.result["parts"][0]["location"], "PFIXTURE", "{}", ended.said);
}

/// The vision system in another language that the documentation shows: it has nothing but the bytes in common
/// with the other one.
#[test]
fn vision_py_locates_a_part() {
    if !has_python() {
        return;
    }
    let controller = Controller::start("python-vision", "vision", &["linkbar", "--json", "--seed", "5"]);
    let output = Command::new("python3")
        .arg("-B")
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
fn control_characters_of_a_controller_are_masked() {
    if !has_python() {
        return;
    }
    let bytes = [HELLO, WELCOME, &disconnect(b"\x1b[31mred\x07 \xc2\x9b2J\r\n\xff end")].concat();
    for name in EXAMPLES {
        let (said, status) = against("python-masked", name, &bytes);
        assert_eq!(said, "the controller says: ?[31mred? ?2J??\u{fffd} end\n", "{name}");
        assert_eq!(status, Some(1), "{name}");
    }
}

#[test]
fn whatever_a_controller_does_the_examples_end_with_a_sentence() {
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
        (&[short.as_slice(), WELCOME].concat(), "the controller has closed the connection"),
    ];
    for name in EXAMPLES {
        for (bytes, expected) in cases {
            let (said, status) = against("python-lies", name, bytes);
            assert!(said.contains(expected), "{name}, {bytes:02X?}: {said}");
            assert_eq!((said.lines().count(), status), (1, Some(1)), "{name}, {bytes:02X?}: {said}");
        }
    }
}
