//! A client that may not command the robot does not: users at a socket, certificates at a port.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpListener, TcpStream},
    os::unix::{fs::PermissionsExt as _, process::CommandExt as _},
    path::Path,
    process::{Command, Output},
    thread,
    time::Duration,
};

use sessions::network::{Address, NeighbourKeys, Peer, Role};
use whole_system_tests::{NOBODY, Scratch, may_become_nobody, rcs_neighbour, rcs_run, root};

use super::bench::{Controller, PATIENCE, make_keys};

/// A controller at a port, with the directory of its keys.
fn controller(name: &str, more: &[&str]) -> (Controller, std::path::PathBuf) {
    let scratch = Scratch::new(name);
    let keys = make_keys(&scratch, "keys", 1);
    let directory = keys.display().to_string();
    let more = [&["--clock", "real", "--keys", &directory], more].concat();
    (Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more), keys)
}

fn port(controller: &Controller) -> SocketAddr {
    let Address::Tcp(port) = controller.address else { panic!("a port was asked for") };
    port
}

/// Put the certificate of `owner` in the place of that of `role`.
fn pose(keys: &Path, owner: &Path, as_role: &str) {
    for extension in ["pem", "key"] {
        let from = owner.with_extension(extension);
        fs::copy(from, keys.join(as_role).with_extension(extension)).expect("a key can be copied");
    }
}

#[test]
fn a_port_admits_no_certificate_but_that_of_the_role_from_the_own_authority() {
    let (controller, keys) = controller("port", &["--ticks", "100"]);
    let scratch = controller.scratch.as_ref().expect("it has one");
    let posing = |name: &str, owner: &Path| {
        let wrong = scratch.file(name);
        fs::create_dir(&wrong).expect("a directory can be made");
        fs::copy(keys.join("ca.pem"), wrong.join("ca.pem")).expect("it can be copied");
        pose(&wrong, owner, "workstation");
        wrong
    };
    let other = make_keys(scratch, "other", 1);
    // Of the own authority, and expired.
    let expired = scratch.file("expired");
    fs::create_dir(&expired).expect("a directory can be made");
    for file in ["ca.pem", "ca.key"] {
        fs::copy(keys.join(file), expired.join(file)).expect("it can be copied");
    }
    let expired = make_keys(scratch, "expired", 0);
    // It is valid up to the second in which it was made.
    thread::sleep(Duration::from_millis(1100));
    let attempts = [
        (
            "role",
            posing("as-vision", &keys.join("vision")),
            "the certificate is bound to vision, not to workstation",
        ),
        (
            "usage",
            posing("as-server", &keys.join("controller")),
            "does not allow extended key usage for client",
        ),
        (
            "authority",
            posing("as-other", &other.join("workstation")),
            "TLS: invalid peer certificate: BadSignature",
        ),
        (
            "expired",
            posing("as-expired", &expired.join("workstation")),
            "TLS: invalid peer certificate: certificate expired",
        ),
    ];
    for (what, wrong, _) in &attempts {
        let told = controller.try_connect(Role::Workstation, Some(wrong)).err().expect("it is refused");
        assert!(!told.is_passing(), "{what}: {told}");
    }
    let told = controller.try_connect(Role::Workstation, None).err().expect("it has no certificate");
    assert!(told.is_usage() && told.to_string().ends_with("name their directory with --keys"), "{told}");
    // It is there until the end: the run begins with it.
    let _own = controller.connect(Role::Workstation, Some(&keys));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for (what, _, why) in attempts {
        let refused =
            ended.page.lines().any(|line| line.contains("a connection was refused: ") && line.contains(why));
        assert!(refused, "{what}: {}", ended.page);
    }
}

/// The controller's certificate may be as wrong as a neighbour's.
#[test]
fn a_neighbour_believes_no_controller_but_one_of_its_authority_that_is_valid() {
    let scratch = Scratch::new("impostor");
    let (keys, other) = (make_keys(&scratch, "keys", 1), make_keys(&scratch, "other", 1));
    let expired = make_keys(&scratch, "expired", 0);
    thread::sleep(Duration::from_millis(1100));
    let posing = scratch.file("posing");
    fs::create_dir(&posing).expect("a directory can be made");
    fs::copy(keys.join("ca.pem"), posing.join("ca.pem")).expect("it can be copied");
    pose(&posing, &keys.join("workstation"), "controller");
    let cases = [(&other, &keys), (&posing, &keys), (&expired, &expired)];
    for ((served, believed), why) in
        cases.into_iter().zip(["BadSignature", "allows client authentication", "expired"])
    {
        let controller = Controller::start_at(
            Scratch::new("impostor-run"),
            Some("tcp:127.0.0.1:0"),
            "workstation",
            &["--clock", "real", "--keys", &served.display().to_string()],
        );
        let told =
            controller.try_connect(Role::Workstation, Some(believed)).err().expect("it is not believed");
        assert!(told.to_string().contains(why), "{why}: {told}");
    }
    let trap = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = Address::Tcp(trap.local_addr().expect("it is bound"));
    let impostor = thread::spawn(move || {
        let (mut line, _) = trap.accept().expect("a neighbour connects");
        line.write_all(b"RCS2\x03\x00\x00\x00").expect("it reads");
        let mut bytes = Vec::new();
        // It ends with an alert.
        let _ = line.read_to_end(&mut bytes);
        bytes
    });
    let own = NeighbourKeys::load(&keys, Role::Workstation).expect("they can be used");
    let told = Peer::connect(&address, Role::Workstation, Some(&own)).err().expect("it is no controller");
    assert!(told.to_string().contains("TLS: received corrupt message"), "{told}");
    let heard = impostor.join().expect("it ends");
    assert!(!heard.windows(4).any(|bytes| bytes == b"RCS2"), "nothing but TLS leaves the neighbour");
}

#[test]
fn what_is_no_tls_1_3_is_refused_and_a_client_without_certificate_too() {
    let (controller, keys) = controller("no-tls", &["--ticks", "150"]);
    let mut plain = TcpStream::connect(port(&controller)).expect("it waits");
    plain.write_all(b"RCS2\x03\x00\x01\x00").expect("it reads");
    let mut answer = Vec::new();
    plain.read_to_end(&mut answer).expect("it closes");
    // A TLS alert, and nothing of the protocol.
    assert_eq!(answer.first(), Some(&21), "{answer:02X?}");
    let python = |version: &str| -> Option<Output> {
        let script = format!(
            "import socket, ssl\n\
             c = ssl.create_default_context(cafile={:?})\n\
             c.maximum_version = ssl.TLSVersion.{version}\n\
             l = c.wrap_socket(socket.create_connection(('127.0.0.1', {})), server_hostname='controller.rcs2.internal')\n\
             print(l.recv(8))",
            keys.join("ca.pem"),
            port(&controller).port()
        );
        Command::new("python3").arg("-c").arg(script).output().ok()
    };
    let mut expected = vec!["TLS: received corrupt message of type InvalidContentType"];
    match (python("TLSv1_2"), python("TLSv1_3")) {
        (Some(old), Some(bare)) => {
            for (output, alert) in [(old, "PROTOCOL_VERSION"), (bare, "CERTIFICATE_REQUIRED")] {
                let said = String::from_utf8_lossy(&output.stderr).into_owned();
                assert!(!output.status.success() && said.contains(alert), "{alert}: {said}");
            }
            expected.extend(["TLS: peer is incompatible", "TLS: peer sent no certificates"]);
        }
        _ => eprintln!("no python3 here: TLS 1.2 and a client without certificate are not tried"),
    }
    // It is there until the end: the run begins with it.
    let _own = controller.connect(Role::Workstation, Some(&keys));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for why in expected {
        assert!(ended.page.contains(&format!("a connection was refused: {why}")), "{why}: {}", ended.page);
    }
}

/// Clients that send a byte of the handshake now and then keep no other out.
#[test]
fn slow_handshakes_keep_no_other_client_out() {
    let (controller, keys) = controller("slow", &[]);
    let address = port(&controller);
    let slow: Vec<_> = (0..16)
        .map(|_| {
            thread::spawn(move || {
                let Ok(mut line) = TcpStream::connect(address) else { return };
                // A TLS record that says that 512 bytes follow, and then few of them.
                let front = [22, 3, 1, 2, 0, 1];
                for byte in front.iter().chain(std::iter::repeat_n(&0, 200)) {
                    if line.write_all(&[*byte]).is_err() {
                        return;
                    }
                    thread::sleep(Duration::from_millis(100));
                }
            })
        })
        .collect();
    drop(controller.connect(Role::Workstation, Some(&keys)));
    drop(controller);
    slow.into_iter().for_each(|client| client.join().expect("it has not panicked"));
}

/// With a file of roles the fingerprint decides, and neither the authority nor the names in the certificate.
#[test]
fn with_a_file_of_roles_the_fingerprint_decides() {
    let scratch = Scratch::new("roles");
    let keys = make_keys(&scratch, "keys", 1);
    let print = Command::new("openssl")
        .args(["x509", "-noout", "-fingerprint", "-sha256", "-in"])
        .arg(keys.join("vision.pem"))
        .output();
    let Ok(print) = print else {
        eprintln!("no openssl here: fingerprints are not tried");
        return;
    };
    let print = String::from_utf8_lossy(&print.stdout).into_owned();
    let (_, print) = print.trim().split_once('=').expect("a fingerprint");
    fs::write(keys.join("roles"), format!("workstation {print}  # for this test\n")).expect("a file");
    let directory = keys.display().to_string();
    let more = ["--clock", "real", "--keys", directory.as_str()];
    let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), "workstation", &more);
    let told = controller.try_connect(Role::Workstation, Some(&keys)).err().expect("it is not in the file");
    assert!(told.to_string().contains("bound to no neighbour, not to workstation"), "{told}");
    pose(&keys, &keys.join("vision"), "workstation");
    drop(controller.connect(Role::Workstation, Some(&keys)));
}

#[test]
fn a_port_without_keys_is_not_opened() {
    let start = |arguments: &[&str]| {
        let output = Command::new(rcs_run()).args(arguments).current_dir(root()).output();
        let output = output.expect("rcs-run can be started");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).trim_end().to_owned())
    };
    let (status, said) = start(&["--network", "tcp:127.0.0.1:0", "--outside", "workstation"]);
    assert_eq!(status, Some(2));
    assert!(said.ends_with("name their directory with --keys"), "{said}");
    let scratch = Scratch::new("needless");
    let keys = make_keys(&scratch, "keys", 1).display().to_string();
    let socket = format!("unix:{}", scratch.file("rcs.sock").display());
    let (status, said) = start(&["--network", &socket, "--outside", "workstation", "--keys", &keys]);
    assert_eq!(status, Some(2));
    assert!(said.ends_with("keys are for an address that begins with tcp: or zenoh:"), "{said}");
}

#[test]
fn there_is_one_workstation_controller() {
    let controller = Controller::start("one", "workstation", &["--clock", "real"]);
    let mut first = controller.connect(Role::Workstation, None);
    first.receive().expect("it is admitted");
    let told = controller.try_connect(Role::Workstation, None).err().expect("it is refused").to_string();
    assert_eq!(told, "the controller says: workstation is connected already");
}

/// Needs the right to become another user; without it nothing can be tried.
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
    let Address::Unix(socket) = &controller.address else { panic!("a socket was asked for") };
    // The program where any user can start it, and data that any user can read.
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
            .expect("the user nobody can start the program");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = as_nobody();
    assert!(told.contains("Permission denied"), "{told}");
    // Whatever the mode of the socket is, both sides ask for the user at the other end.
    fs::set_permissions(socket, fs::Permissions::from_mode(0o666)).expect("its mode can be set");
    let told = as_nobody();
    assert!(told.contains("user 65534 was expected, found user 0"), "{told}");
    let _own =
        Peer::connect_within(PATIENCE, &controller.address, Role::Workstation, None).expect("it waits");
    let ended = controller.end();
    assert!(
        ended.page.contains("a connection was refused: user 0 was expected, found user 65534"),
        "{}",
        ended.page
    );
}
