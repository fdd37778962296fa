//! The Data System in another process (IV.4.2, IX.2): every update is stored once, whichever process is killed. In
//! fast clock the controller's time stops while the tests check.

use std::{
    path::{Path, PathBuf},
    process::Command,
    thread::{self, JoinHandle},
    time::Duration,
};

use interfaces::HwsCommand;
use neighbours::{
    data_system::{
        Records as _, Server, command,
        status::{Refusal, ServerStatus, Status, Summary},
    },
    mailbox::{DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, Mailbox},
};
use rcs_core::name::Name16;
use sessions::{
    data_system::Store,
    network::{Peer, Received, Role},
};
use whole_system_tests::{Scratch, rcs_neighbour, rcs_run, root};

use super::bench::{Controller, Ended, Workstation, bare};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Answers,
    DiesBefore, // before it has received the update
    DiesAfter,  // after storing the update, before its answer
    Refuses,    // its disk is full
    Dawdles,
}

fn serve(mut peer: Peer, file: PathBuf, fate: Fate) -> JoinHandle<()> {
    thread::spawn(move || {
        let mut server = Server::new(Store::open(&file).expect("a database"));
        let mut status_box = Mailbox::initialized(DATA_SYSTEM_STATUS);
        let mut read = 0;
        while let Ok(received) = peer.receive() {
            let Received::Pulse(pulse) = received else { continue };
            let mailbox = peer.mailbox(DATA_SYSTEM_COMMAND);
            if mailbox.mailgram() != read {
                read = mailbox.mailgram();
                let update = mailbox.data().len() == command::DML;
                if update && fate == Fate::DiesBefore {
                    return;
                }
                let mut status = if update && fate == Fate::Refuses {
                    let command_id = command::decode(mailbox.data()).expect("a command").command_id;
                    Status {
                        command_id,
                        server: ServerStatus::Ready,
                        summary: Summary::Refused(Refusal::Store),
                    }
                } else {
                    server.execute(mailbox.data()).status
                };
                match (update, fate) {
                    (true, Fate::DiesAfter) => return,
                    (true, Fate::Dawdles) => {
                        status.server = ServerStatus::Busy; // first the action, then its result
                        let busy = Status { summary: Summary::None, ..status };
                        status_box.write(&busy.encode()).expect("it fits");
                        peer.send(&status_box).expect("the controller reads");
                        thread::sleep(Duration::from_millis(500));
                        status.server = ServerStatus::Ready;
                    }
                    _ => {}
                }
                status_box.write(&status.encode()).expect("it fits");
                if peer.send(&status_box).is_err() {
                    return;
                }
            }
            if peer.pulse(pulse).is_err() {
                return;
            }
        }
    })
}

struct Shop {
    controller: Controller,
    workstation: Workstation,
    data_system: JoinHandle<()>,
}

impl Shop {
    fn open(scratch: Scratch, file: &Path, fate: Fate) -> Self {
        let outbox = scratch.file("outbox").display().to_string();
        let controller =
            Controller::start_at(scratch, None, "workstation,data-system", &["--json", "--outbox", &outbox]);
        let data_system = serve(controller.connect(Role::DataSystem), file.to_owned(), fate);
        let mut workstation = Workstation::connect(&controller);
        assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
        Self { controller, workstation, data_system }
    }

    /// Command 2 opens the connection.
    fn with_blank(scratch: Scratch, file: &Path, fate: Fate) -> Self {
        let mut shop = Self::open(scratch, file, fate);
        assert_eq!(shop.connect(2).0, "finished");
        shop.workstation.in_cell("tray UNIT_1 4 LINKBAR1_BH");
        shop.workstation.in_cell("vise partial PFIXTURE LINKBAR");
        shop
    }

    fn connect(&mut self, number: u32) -> (String, String) {
        self.workstation.carry_out(&bare(number, "STARTUP"))
    }

    fn end(self) -> Ended {
        drop(self.workstation);
        let ended = self.controller.end();
        self.data_system.join().expect("it has not panicked"); // its connection has ended with the run
        ended
    }
}

fn fetch(number: u32) -> HwsCommand {
    let name = |text| Name16::new(text).expect("a name");
    HwsCommand {
        object: Some(name("LINKBAR1_BH")),
        serial: name("17"),
        source_grip: 2,
        source: Some(name("UNIT_1")),
        source_sector: Some(4),
        destination_grip: 2,
        destination: Some(name("PFIXTURE")),
        ..bare(number, "MOVE")
    }
}

/// The place of item 17, and the number of its changes.
fn books(file: &Path) -> (String, usize) {
    let store = Store::open(file).expect("a database");
    let items = store.items().expect("it can be read");
    let [item] = &items[..] else { panic!("{items:?}") };
    let history = store.history(&item.number).expect("it can be read");
    (format!("{} at {}", item.number, item.position), history.len())
}

#[test]
fn external_data_system_stores_the_items_without_changing_the_run() {
    let program = rcs_neighbour();
    let scratch = Scratch::new("items");
    let job = scratch.file("fetch.job");
    let text = "== STARTUP -- +0 -- 0 +0 -- 0 -- 0\n** tray UNIT_1 4 LINKBAR1_BH\n** vise partial PFIXTURE LINKBAR\n\
                == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0 #17\n";
    std::fs::write(&job, text).expect("a job can be written");
    let (job, file) = (job.display().to_string(), scratch.file("items.db"));
    let outbox = scratch.file("outbox").display().to_string();
    let own = Command::new(rcs_run())
        .args([job.as_str(), "--json", "--log", "none", "--shared-memory", "off"])
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    let own: serde_json::Value = serde_json::from_slice(&own.stdout).expect("a result");
    let more = [job.as_str(), "--json", "--outbox", outbox.as_str()];
    let controller = Controller::start_at(scratch, None, "data-system", &more);
    let mut server = Command::new(program)
        .args(["data-system", "--wait", "1", "--network", &controller.address.to_string()])
        .arg(&file)
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("rcs-neighbour can be started");
    let digest = own["digest"].clone(); // the controller's directory is removed with it
    let ended = controller.end_with(|| assert_eq!(books(&file), ("17 at H_ROBOT".to_owned(), 1)));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["digest"], digest);
    assert!(server.wait().expect("a child").success(), "it ends when no run comes");
}

#[test]
fn last_connecting_data_system_is_connected_in_the_first_tick() {
    let scratch = Scratch::new("last");
    let (file, outbox) = (scratch.file("items.db"), scratch.file("outbox").display().to_string());
    let job = scratch.file("pause.job");
    std::fs::write(&job, "== PAUSE -- +0 -- 0 +0 -- 0 -- 0\n").expect("a job can be written");
    let more = [job.to_str().expect("a path"), "--json", "--outbox", &outbox];
    let controller = Controller::start_at(scratch, None, "data-system", &more);
    let server = serve(controller.connect(Role::DataSystem), file, Fate::Answers);
    let ended = controller.end();
    server.join().expect("it has not panicked");
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let events = ended.result["events"]["first"].as_array().expect("events").iter();
    let connected: Vec<_> = events.filter(|event| event["text"] == "data-system has connected").collect();
    assert_eq!(connected.len(), 1, "{:?}", ended.result["events"]);
    assert_eq!(connected[0]["tick"], 1);
}

#[test]
fn restarted_data_system_receives_the_update_once() {
    for fate in [Fate::DiesBefore, Fate::DiesAfter] {
        let scratch = Scratch::new(&format!("{fate:?}"));
        let file = scratch.file("items.db");
        let mut shop = Shop::with_blank(scratch, &file, fate);
        shop.workstation.send(&fetch(3));
        let mut killed = 0;
        loop {
            shop.workstation.tick();
            let status = shop.workstation.status();
            if status.echo == 3 && status.report.text() == "finished" {
                break;
            }
            assert_ne!(status.report.text(), "error", "{fate:?}: {}", status.reason);
            if shop.data_system.is_finished() {
                killed += 1;
                let peer = shop.controller.connect(Role::DataSystem);
                shop.data_system = serve(peer, file.clone(), Fate::Answers);
            }
        }
        assert_eq!(killed, 1, "{fate:?}");
        assert_eq!(books(&file), ("17 at H_ROBOT".to_owned(), 1), "{fate:?}");
        assert_eq!(shop.end().status, Some(0));
    }
}

#[test]
fn a_killed_controller_sends_pending_updates_after_its_next_startup() {
    for fate in [Fate::DiesBefore, Fate::DiesAfter] {
        let scratch = Scratch::new(&format!("killed-{fate:?}"));
        let file = scratch.file("items.db");
        let mut shop = Shop::with_blank(scratch, &file, fate);
        shop.workstation.send(&fetch(3));
        while !shop.data_system.is_finished() {
            shop.workstation.tick();
        }
        let scratch = shop.controller.kill();
        let mut shop = Shop::open(scratch, &file, Fate::Answers);
        let known = usize::from(fate == Fate::DiesAfter);
        assert_eq!(Store::open(&file).expect("a database").items().expect("it can be read").len(), known);
        assert_eq!(shop.connect(2).0, "finished");
        assert_eq!(books(&file), ("17 at H_ROBOT".to_owned(), 1), "{fate:?}");
        assert_eq!(shop.end().status, Some(0));
    }
}

#[test]
fn refusing_or_slow_data_system_receives_the_update_once() {
    for fate in [Fate::Refuses, Fate::Dawdles] {
        let scratch = Scratch::new(&format!("{fate:?}"));
        let file = scratch.file("items.db");
        let mut shop = Shop::with_blank(scratch, &file, fate);
        let (status, reason) = shop.workstation.carry_out(&fetch(3));
        if fate == Fate::Refuses {
            assert_eq!(
                (status.as_str(), reason.as_str()),
                ("error", "the database does not accept the update")
            );
            let scratch = shop.controller.kill();
            shop.data_system.join().expect("it ends with its line");
            shop = Shop::open(scratch, &file, Fate::Answers);
            assert_eq!(shop.connect(2).0, "finished");
        } else {
            assert_eq!(status, "finished", "{reason}");
        }
        assert_eq!(books(&file), ("17 at H_ROBOT".to_owned(), 1), "{fate:?}");
        assert_eq!(shop.end().status, Some(0));
    }
}

#[test]
fn without_a_data_system_startup_fails_and_the_robot_works() {
    let scratch = Scratch::new("absent");
    let outbox = scratch.file("outbox").display().to_string();
    let more = ["--json", "--outbox", outbox.as_str(), "--wait", "5"];
    let controller = Controller::start_at(scratch, None, "workstation,data-system", &more);
    let mut workstation = Workstation::connect(&controller);
    let outcome = workstation.carry_out(&bare(1, "STARTUP"));
    assert_eq!(outcome, ("error".to_owned(), "the Data System does not answer".to_owned()));
    assert!(workstation.tick > 3 * 250, "it was asked three times, 10 s each");
    assert_eq!(workstation.carry_out(&bare(2, "PAUSE")).0, "finished");
    drop(workstation);
    assert_eq!(controller.end().status, Some(0));
}
