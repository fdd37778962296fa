//! Mailboxes over Zenoh: the same run to the bit, and no stranger in the network commands.
//!
//! Each test has an address of its own on this machine (127.0.0.0/8); there is no multicast.

use std::{
    fs,
    hash::{BuildHasher as _, RandomState},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::OnceLock,
    thread,
    time::{Duration, Instant},
};

use sessions::network::{Address, NeighbourKeys, Peer, Role};
use whole_system_tests::{Scratch, rcs_neighbour, rcs_run, root};
use zenoh::{Config, Session, Wait as _};

use super::bench::{Controller, Workstation, bare, make_keys, run_alone};

/// An endpoint that no other test has, nor another run of them on this machine.
fn endpoint(test: u8) -> String {
    static RUN: OnceLock<u64> = OnceLock::new();
    let [high, low, ..] = RUN.get_or_init(|| RandomState::new().hash_one(0)).to_le_bytes();
    format!("tcp/127.{high}.{low}.{test}:7447")
}

/// A controller in a Zenoh network, and the directory of the keys.
fn controller(test: u8, outside: &str, more: &[&str]) -> (Controller, PathBuf) {
    let scratch = Scratch::new(&format!("zenoh-{test}"));
    let keys = make_keys(&scratch, "keys", 1);
    let (outbox, directory) = (scratch.file("outbox").display().to_string(), keys.display().to_string());
    let more = [more, &["--keys", &directory, "--outbox", &outbox]].concat();
    let address = format!("zenoh:t3@{}", endpoint(test));
    (Controller::start_at(scratch, Some(&address), outside, &more), keys)
}

/// A session of a stranger in the network.
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

fn neighbour(controller: &Controller, arguments: &[&str], keys: &Path) -> Command {
    let mut command = Command::new(rcs_neighbour());
    command
        .args(arguments)
        .args(["--network", &controller.address.to_string(), "--keys"])
        .arg(keys)
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

#[test]
fn a_job_from_another_machine_has_the_same_bits() {
    let own = run_alone(&["linkbar"]);
    // Brought up to date before the controller waits for it.
    let _ = rcs_neighbour();
    let (controller, keys) = controller(1, "workstation", &["--json"]);
    let played = neighbour(&controller, &["workstation", "linkbar"], &keys).output().expect("it starts");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["digest"], own["digest"]);
    assert_eq!(ended.result["parts"], own["parts"]);
}

/// What a stranger publishes moves nothing: under keys of no connection it is not read; under those of one it is no TLS of the
/// other side, and the session ends. Bytes of a connection of the stranger's own are refused.
#[test]
fn a_stranger_in_the_network_can_cut_a_connection_and_command_nothing() {
    let (controller, keys) = controller(3, "workstation", &["--clock", "real", "--ticks", "400"]);
    let mut workstation = Workstation::connect_with(&controller, Some(&keys));
    let stranger = stranger(3);
    let id = "00112233445566778899aabbccddeeff";
    stranger.put("rcs2/t3/F6000", "MOVE").wait().expect("it may publish");
    let replies = stranger.get("rcs2/t3/open").payload(id).wait().expect("a query");
    replies.recv().expect("the controller answers").result().expect("a reply");
    stranger
        .put(format!("rcs2/t3/{id}/up"), b"RCS2\x03\x00\x01\x00".as_slice())
        .wait()
        .expect("it may publish");
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    stranger.put("rcs2/t3/*/up", "forged").wait().expect("it may publish");
    while workstation.peer.receive().is_ok() {}
    let mut workstation = Workstation::connect_with(&controller, Some(&keys));
    assert_eq!(workstation.carry_out(&bare(2, "PAUSE")).0, "finished");
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for event in [
        "a connection was refused: TLS: received corrupt message",
        "workstation has disconnected: received corrupt message",
    ] {
        assert!(ended.page.contains(event), "{event}: {}", ended.page);
    }
}

#[test]
fn a_neighbour_of_another_authority_is_refused() {
    let (controller, keys) = controller(4, "workstation", &["--clock", "real", "--ticks", "250"]);
    let other = make_keys(controller.scratch.as_ref().expect("it has one"), "other", 1);
    let told = controller.try_connect(Role::Workstation, Some(&other)).err().expect("it is refused");
    assert!(told.to_string().contains("TLS: invalid peer certificate"), "{told}");
    let told = controller.try_connect(Role::Workstation, None).err().expect("it does not even try");
    assert!(told.to_string().ends_with("name their directory with --keys"), "{told}");
    // It is there until the end: the run begins with it.
    let _own = controller.connect(Role::Workstation, Some(&keys));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert!(ended.page.contains("a connection was refused: TLS: "), "{}", ended.page);
}

#[test]
fn there_is_one_workstation_controller_and_one_controller() {
    let (controller, keys) = controller(5, "workstation", &["--json"]);
    let mut first = Workstation::connect_with(&controller, Some(&keys));
    let told = controller.try_connect(Role::Workstation, Some(&keys)).err().expect("it is refused");
    assert_eq!(told.to_string(), "the controller says: workstation is connected already");
    assert_eq!(first.carry_out(&bare(1, "PAUSE")).0, "finished");
    // Another run of the same name, which can see this one.
    let config = controller.file("config.json5");
    fs::write(&config, format!("{{ connect: {{ endpoints: [\"{}\"] }} }}", endpoint(5))).expect("a file");
    let second = Command::new(rcs_run())
        .args(["--network", &format!("zenoh:t3@{}", endpoint(6)), "--keys"])
        .arg(&keys)
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
fn a_neighbour_that_is_killed_can_connect_again() {
    let (controller, keys) = controller(7, "workstation,data-system", &[]);
    let items = controller.file("items.db").display().to_string();
    let data_system = || {
        let command = neighbour(&controller, &["data-system", "--wait", "120", &items], &keys).spawn();
        command.expect("rcs-neighbour can be started")
    };
    let end = |mut child: Child| {
        child.kill().expect("it runs");
        child.wait().expect("a child");
    };
    let killed = data_system();
    let mut workstation = Workstation::connect_with(&controller, Some(&keys));
    assert_eq!(workstation.carry_out(&bare(1, "STARTUP")).0, "finished");
    end(killed);
    // Time goes on as soon as the controller has noticed.
    workstation.run_to(workstation.tick + 50);
    assert_eq!(workstation.carry_out(&bare(2, "STARTUP")).0, "error", "no Data System is connected");
    let again = data_system();
    let mut number = 3;
    while workstation.carry_out(&bare(number, "STARTUP")).0 != "finished" {
        number += 1;
    }
    drop(workstation);
    let ended = controller.end_with(|| end(again));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.page.matches("data-system has connected").count(), 2, "{}", ended.page);
    assert!(ended.page.contains("data-system has disconnected: the connection was cut"), "{}", ended.page);
}

#[test]
fn a_neighbour_that_finds_no_controller_says_so() {
    let scratch = Scratch::new("zenoh-absent");
    let keys = make_keys(&scratch, "keys", 1);
    let keys = NeighbourKeys::load(&keys, Role::Workstation).expect("they can be used");
    let address: Address = format!("zenoh:t3@{}", endpoint(8)).parse().expect("an address");
    let told = Peer::connect(&address, Role::Workstation, Some(&keys)).err().expect("there is no controller");
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
    let (with, _) = controller(9, "workstation", &["--clock", "real"]);
    // A thread gives itself its name, which takes a while on a busy machine.
    let deadline = Instant::now() + Duration::from_secs(30);
    while !threads(&with.child).iter().any(of_zenoh) {
        assert!(Instant::now() < deadline, "{:?}", threads(&with.child));
        thread::sleep(Duration::from_millis(20));
    }
    let without = Controller::start("zenoh-without", "workstation", &["--clock", "real"]);
    let threads_without = threads(&without.child);
    assert!(!threads_without.iter().any(of_zenoh), "{threads_without:?}");
}
