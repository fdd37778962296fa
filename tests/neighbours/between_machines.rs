//! Mailboxes over Zenoh: the same run to the bit, whoever is there, and nobody else commands.
//!
//! Each test has an address of its own on this machine (127.0.0.0/8), and nobody looks for anybody on the network.

use std::{
    fs,
    hash::{BuildHasher as _, RandomState},
    process::{Child, Command, Stdio},
    sync::OnceLock,
};

use neighbours::{
    mailbox::{HWSC_COMMAND, Mailbox},
    network::{
        Address, Peer, Role, Secret,
        frame::Frame,
        hello::{Challenge, HELLO, check_welcome},
        seal::Seal,
    },
    workstation::command,
};
use whole_system_tests::{Scratch, rcs_neighbour, rcs_run, root};
use zenoh::{Config, Session, Wait as _, qos::CongestionControl};

use crate::bench::{Controller, Workstation, bare, run_alone, secret};

/// The key of the workstation controller's commands.
const COMMANDS: &str = "rcs2/t3/F6000";
/// Where he says hello.
const HELLOS: &str = "rcs2/t3/workstation/hello";

/// An endpoint that no other test has, nor another run of them on this machine.
fn endpoint(test: u8) -> String {
    static RUN: OnceLock<u64> = OnceLock::new();
    let [high, low, ..] = RUN.get_or_init(|| RandomState::new().hash_one(0)).to_le_bytes();
    format!("tcp/127.{high}.{low}.{test}:7447")
}

/// A controller in a Zenoh network, and the secret.
fn controller(test: u8, outside: &str, more: &[&str]) -> (Controller, Secret, String) {
    let scratch = Scratch::new(&format!("zenoh-{test}"));
    let (ours, file) = secret(&scratch, "ours", "the key under the third flower pot");
    let outbox = scratch.file("outbox").display().to_string();
    let more = [more, &["--secret", &file, "--outbox", &outbox]].concat();
    let address = format!("zenoh:t3@{}", endpoint(test));
    (Controller::start_at(scratch, Some(&address), outside, &more), ours, file)
}

/// Somebody else in the network.
fn stranger(test: u8) -> Session {
    let mut config = Config::default();
    let place = format!("[\"{}\"]", endpoint(test));
    for (key, value) in [
        ("connect/endpoints", place.as_str()),
        ("listen/endpoints", "[]"),
        ("scouting/multicast/enabled", "false"),
    ] {
        config.insert_json5(key, value).expect("a key of Zenoh's configuration");
    }
    zenoh::open(config).wait().expect("a session")
}

/// Ask at the hello of the workstation controller. Zenoh keeps the order: when the answer is there, all that the session published
/// before has been read.
fn ask(session: &Session, said: Vec<u8>) -> Vec<u8> {
    let replies = session.get(HELLOS).payload(said).wait().expect("a query");
    let reply = replies.recv().expect("the controller answers");
    reply.result().expect("a reply").payload().to_bytes().into_owned()
}

fn neighbour(controller: &Controller, arguments: &[&str], secret: &str) -> Command {
    let mut command = Command::new(rcs_neighbour());
    command
        .args(arguments)
        .args(["--network", &controller.address.to_string(), "--secret", secret])
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// Behind a reason that comes before the secret was proved.
const UNVERIFIED: &str = " (unverified: it has not proved that it knows the secret)";

#[test]
fn a_job_from_another_machine_has_the_same_bits() {
    let own = run_alone(&["linkbar"]);
    // Brought up to date before the controller waits for it.
    let _ = rcs_neighbour();
    let (controller, _, file) = controller(1, "workstation", &["--json"]);
    let played = neighbour(&controller, &["workstation", "linkbar"], &file).output().expect("it starts");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["digest"], own["digest"]);
    assert_eq!(ended.result["parts"], own["parts"]);
}

/// A run of 150 ticks with a PAUSE, and what `meanwhile` does behind it; its digest and its events.
fn run_with(test: u8, meanwhile: impl FnOnce(&mut Workstation, &Session)) -> (String, String) {
    let (controller, ours, _) = controller(test, "workstation", &[]);
    let session = stranger(test);
    let mut workstation = Workstation::connect_with(&controller, Some(&ours));
    meanwhile(&mut workstation, &session);
    workstation.run_to(150);
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let digest = ended.page.lines().find(|line| line.starts_with("digest")).expect("a digest").to_owned();
    (digest, ended.page)
}

fn envelope(seal: &mut Seal, verb: &str) -> Vec<u8> {
    let mut mailbox = Mailbox::initialized(HWSC_COMMAND);
    mailbox.write(&command::encode(&bare(2, verb)).expect("it fits")).expect("it fits");
    let frame = Frame::of(&mailbox);
    let (number, end) = seal.close_numbered(frame.bytes());
    [number.to_le_bytes().as_slice(), frame.bytes(), &end].concat()
}

#[test]
fn what_a_stranger_publishes_moves_nothing_and_stands_among_the_events() {
    let pause = |workstation: &mut Workstation| {
        assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    };
    let (quiet, events) = run_with(2, |workstation, _| pause(workstation));
    assert!(!events.contains("refused"), "{events}");
    let (disturbed, events) = run_with(3, |workstation, session| {
        pause(workstation);
        let mut guessed = Seal::new([0x5A; 32]);
        for forged in [b"MOVE".to_vec(), envelope(&mut guessed, "MOVE"), envelope(&mut guessed, "MOVE")] {
            session.put(COMMANDS, forged).wait().expect("he may publish");
        }
        session.delete(COMMANDS).wait().expect("he may publish");
        ask(session, Vec::new());
    });
    assert_eq!(disturbed, quiet);
    for why in [
        "24 bytes or more were expected, found 4",
        "its seal is wrong",
        "24 bytes or more were expected, found 0",
    ] {
        assert!(events.contains(&format!("a frame was refused: {COMMANDS}: {why}")), "{why}: {events}");
    }
}

#[test]
fn who_does_not_know_the_secret_is_not_let_in_and_is_logged() {
    let (controller, ours, _) = controller(4, "workstation", &["--clock", "real", "--ticks", "250"]);
    let scratch = controller.scratch.as_ref().expect("it has one");
    let (guessed, _) = secret(scratch, "guessed", "the key under the second flower pot");
    let told = controller.try_connect(Role::Workstation, Some(&guessed)).err().expect("he is not let in");
    assert_eq!(
        told.to_string(),
        format!("the controller says: the proof of the secret is wrong{UNVERIFIED}")
    );
    let told = controller.try_connect(Role::Workstation, None).err().expect("he does not even try");
    assert!(told.to_string().ends_with("name a file with --secret"), "{told}");
    let session = stranger(4);
    session.put(COMMANDS, "MOVE").wait().expect("he may publish");
    let last_words = |said: Vec<u8>| {
        let frame = Frame::from_bytes(&ask(&session, said)).expect("a frame");
        String::from_utf8_lossy(frame.data()).into_owned()
    };
    let bytes: [u8; HELLO] = ask(&session, Vec::new()).try_into().expect("a challenge");
    let challenge = Challenge::from_bytes(bytes).expect("a challenge");
    let (bare, _) = challenge.answer(Role::Workstation, None).expect("random bytes");
    let said = [bytes.as_slice(), &bare].concat();
    assert_eq!(last_words(said.clone()), "the proof of the secret is wrong");
    assert_eq!(last_words(said), "the answer is to no challenge of this run", "each is good for one answer");
    let wrong = "a challenge and its answer, 112 bytes, were expected, found 4 bytes";
    assert_eq!(last_words(b"open".to_vec()), wrong);
    let _friend = controller.connect(Role::Workstation, Some(&ours));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let refused = ended.page.matches("a connection was refused: the proof of the secret is wrong").count();
    assert_eq!(refused, 2, "{}", ended.page);
    let stray = format!("a frame was refused: {COMMANDS}: nobody is connected who may write it");
    assert!(ended.page.contains(&stray), "{}", ended.page);
}

/// A neighbour with nothing but Zenoh: what it says once more is refused, and what it leaves out ends its connection.
#[test]
fn frames_count_once_and_none_is_left_out() {
    let (controller, ours, _) = controller(10, "workstation", &["--clock", "real", "--ticks", "250"]);
    let session = stranger(10);
    let bytes: [u8; HELLO] = ask(&session, Vec::new()).try_into().expect("a challenge");
    let challenge = Challenge::from_bytes(bytes).expect("a challenge");
    let (answer, agreement) = challenge.answer(Role::Workstation, Some(&ours)).expect("random bytes");
    let welcome = Frame::from_bytes(&ask(&session, [bytes.as_slice(), &answer].concat())).expect("a frame");
    check_welcome(welcome.data(), agreement.as_ref()).expect("it is the controller");
    let mut seal = agreement.expect("there is a secret").up();
    let first = envelope(&mut seal, "PAUSE");
    let _lost = envelope(&mut seal, "PAUSE");
    let third = envelope(&mut seal, "PAUSE");
    for sent in [first.clone(), first, third] {
        session.put(COMMANDS, sent).congestion_control(CongestionControl::Block).wait().expect("it is there");
    }
    ask(&session, Vec::new());
    let _friend = controller.connect(Role::Workstation, Some(&ours));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for event in [
        format!("a frame was refused: {COMMANDS}: it repeats frame 1"),
        "workstation has gone: frame 2 was expected, found 3: some were lost".to_owned(),
    ] {
        assert!(ended.page.contains(&event), "{event}: {}", ended.page);
    }
}

#[test]
fn there_is_one_workstation_controller_and_one_controller() {
    let (controller, ours, file) = controller(5, "workstation", &["--json"]);
    let mut first = Workstation::connect_with(&controller, Some(&ours));
    let told = controller.try_connect(Role::Workstation, Some(&ours)).err().expect("he is not let in");
    assert_eq!(
        told.to_string(),
        format!("the controller says: workstation is connected already{UNVERIFIED}")
    );
    assert_eq!(first.carry_out(&bare(1, "PAUSE")).0, "finished");
    // Another run of the same name, which can see this one.
    let config = controller.file("config.json5");
    fs::write(&config, format!("{{ connect: {{ endpoints: [\"{}\"] }} }}", endpoint(5))).expect("a file");
    let second = Command::new(rcs_run())
        .args(["--network", &format!("zenoh:t3@{}", endpoint(6)), "--secret", &file])
        .arg("--zenoh-config")
        .arg(&config)
        .args(["--outside", "workstation"])
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    let said = String::from_utf8_lossy(&second.stderr);
    assert!(said.trim_end().ends_with("another run waits for its neighbours there"), "{said}");
    assert_eq!(second.status.code(), Some(2));
    drop(first);
    assert_eq!(controller.end().status, Some(0));
}

#[test]
fn a_neighbour_that_is_killed_can_come_again() {
    let (controller, ours, file) = controller(7, "workstation,data-system", &[]);
    let items = controller.file("items.db").display().to_string();
    let data_system = || {
        let command = neighbour(&controller, &["data-system", "--wait", "120", &items], &file).spawn();
        command.expect("rcs-neighbour can be started")
    };
    let end = |mut child: Child| {
        child.kill().expect("it runs");
        child.wait().expect("a child");
    };
    let killed = data_system();
    let mut workstation = Workstation::connect_with(&controller, Some(&ours));
    assert_eq!(workstation.carry_out(&bare(1, "STARTUP")).0, "finished");
    end(killed);
    // Time goes on as soon as the controller has noticed.
    workstation.run_to(workstation.tick + 50);
    assert_eq!(workstation.carry_out(&bare(2, "STARTUP")).0, "error", "nobody keeps the books");
    let again = data_system();
    let mut number = 3;
    while workstation.carry_out(&bare(number, "STARTUP")).0 != "finished" {
        number += 1;
    }
    drop(workstation);
    let ended = controller.end_with(|| end(again));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.page.matches("data-system has connected").count(), 2, "{}", ended.page);
    assert!(ended.page.contains("data-system has gone: the connection was closed"), "{}", ended.page);
}

#[test]
fn who_finds_no_controller_says_so() {
    let scratch = Scratch::new("zenoh-absent");
    let (ours, _) = secret(&scratch, "ours", "the key under the third flower pot");
    let address: Address = format!("zenoh:t3@{}", endpoint(8)).parse().expect("an address");
    let told = Peer::connect(&address, Role::Workstation, Some(&ours)).err().expect("nobody is there");
    assert_eq!(told.to_string(), format!("{address}: no controller answers"));
    assert!(told.is_passing());
}

/// The names of a process's threads.
fn threads(child: &Child) -> Vec<String> {
    let tasks = fs::read_dir(format!("/proc/{}/task", child.id())).expect("it runs");
    // One may end while they are counted.
    let name = |task: fs::DirEntry| fs::read_to_string(task.path().join("comm")).ok();
    tasks.filter_map(|task| name(task.expect("a task"))).map(|name| name.trim_end().to_owned()).collect()
}

#[test]
fn without_it_nothing_of_zenoh_is_started() {
    // As Zenoh calls its threads.
    let fronts = ["app-", "acc-", "net-", "rx-", "tx-"];
    let of_zenoh = |name: &String| fronts.iter().any(|front| name.starts_with(front));
    let (with, _, _) = controller(9, "workstation", &["--clock", "real"]);
    let threads_with = threads(&with.child);
    assert!(threads_with.iter().any(of_zenoh), "{threads_with:?}");
    let without = Controller::start("zenoh-without", "workstation", &["--clock", "real"]);
    let threads_without = threads(&without.child);
    assert!(!threads_without.iter().any(of_zenoh), "{threads_without:?}");
}
