//! The Active Pedestal in another process (VI.7, IX.3) changes no bit of a run. After any failure of the pedestal,
//! robot and hand keep their parts, and the command ends with a message that names the pedestal. In fast clock the
//! controller's time stops while the test, its workstation controller, does not answer.

use std::{
    io::{BufRead as _, BufReader},
    path::Path,
    process::{Child, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

use interfaces::{
    HwsCommand, Reason,
    pedestal::{PedestalReport, PedestalVerb},
};
use neighbours::{
    mailbox::{Mailbox, PEDESTAL_COMMAND, PEDESTAL_SENSORS, PEDESTAL_STATUS},
    pedestal::{System, cell::SensorsLayout, command::CommandLayout, status::Status},
};
use rcs_core::name::Name16;
use sessions::network::{Peer, Received, Role};
use whole_system_tests::{Scratch, rcs_log, rcs_neighbour, rcs_run, root};

use super::bench::{Controller, Ended, Workstation, bare, computed, computed_alone};

const SILENT: &str = "the Active Pedestal does not answer";

/// The robot holds the clevis, to be turned on the pedestal.
const UNTIL_IT_IS_HELD: [&str; 10] = [
    "== PAUSE -- +0 -- 0 +0 -- 0 -- 0",
    "** tray UNIT_1 3 LCLEVIS_BH",
    "** vise partial PFIXTURE CLEVIS",
    "== MOVE LCLEVIS_BH +2 UNIT_1 3 +2 PFIXTURE 0 -- 0",
    "== POSITION S-LCLEVIS_BH +1 PFIXTURE 0 +0 -- 0 -- 0",
    "** vise close PFIXTURE",
    "== MOVE -- +0 -- 0 +0 HOME 0 -- 0",
    "** machine LCLEVIS_BH LCLEVIS_IH PFIXTURE",
    "== ACQUIRE LCLEVIS_IH +1 PFIXTURE 0 +0 -- 0 -- 0",
    "** vise partial PFIXTURE",
];
const REFIXTURE: &str = "== REFIXTURE LCLEVIS_IH +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0";

fn command(number: u32, line: &str) -> HwsCommand {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [_, verb, object, source_grip, source, source_sector, grip, destination, sector, end_at, end_sector] =
        words[..]
    else {
        panic!("{line}")
    };
    let name = |word: &str| (word != "--").then(|| Name16::new(word).expect("a name"));
    let integer = |word: &str| word.parse().expect("an integer");
    let sector_of = |word: &str| Some(integer(word)).filter(|sector| *sector != 0);
    HwsCommand {
        object: name(object),
        source_grip: integer(source_grip),
        source: name(source),
        source_sector: sector_of(source_sector),
        destination_grip: integer(grip),
        destination: name(destination),
        destination_sector: sector_of(sector),
        end_at: name(end_at),
        end_at_sector: sector_of(end_sector),
        ..bare(number, verb)
    }
}

struct Shop {
    controller: Controller,
    workstation: Workstation,
    number: u32,
}

impl Shop {
    fn with_clevis(controller: Controller) -> Self {
        let workstation = Workstation::connect(&controller);
        let mut shop = Self { controller, workstation, number: 0 };
        for line in UNTIL_IT_IS_HELD {
            match line.strip_prefix("** ") {
                Some(line) => shop.workstation.in_cell(line),
                None => assert_eq!(shop.carry_out(line), ("finished".to_owned(), String::new()), "{line}"),
            }
        }
        shop
    }

    fn carry_out(&mut self, line: &str) -> (String, String) {
        self.number += 1;
        self.workstation.carry_out(&command(self.number, line))
    }

    fn fails(&mut self) -> String {
        let (status, reason) = self.carry_out(REFIXTURE);
        assert_eq!(status, "error");
        assert_eq!(self.carry_out("== PAUSE -- +0 -- 0 +0 -- 0 -- 0").0, "finished", "after: {reason}");
        reason
    }

    fn admit(&mut self, fate: Fate) -> Guest {
        let guest = Guest::new(self.controller.connect(Role::Pedestal), fate);
        while !guest.is_there.load(Ordering::Acquire) {
            self.workstation.tick();
        }
        guest
    }

    fn see_off(&mut self, guest: Guest) -> Remains {
        while !guest.serving.is_finished() {
            self.workstation.tick();
        }
        guest.serving.join().expect("it has not panicked")
    }

    fn end(self) -> Ended {
        drop(self.workstation);
        self.controller.end()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    DiesTurning(u32),  // some ticks after the first FLIP
    AnswersForAnother, // answers for another command, and leaves some ticks after the second one
    Babbles,           // its status is invalid; it leaves some ticks after the second command
    Serves(u32),       // for some ticks
}

type Remains = (System, u16); // an ended pedestal, and the counts of its finger potentiometer

struct Guest {
    serving: JoinHandle<Remains>,
    is_there: Arc<AtomicBool>,
}

impl Guest {
    fn new(peer: Peer, fate: Fate) -> Self {
        let is_there = Arc::new(AtomicBool::new(false));
        let theirs = Arc::clone(&is_there);
        Self { serving: thread::spawn(move || serve(peer, fate, &theirs)), is_there }
    }
}

fn serve(mut peer: Peer, fate: Fate, is_there: &AtomicBool) -> Remains {
    let (mut system, mut opening) = (System::default(), 0);
    let mut forged = Mailbox::initialized(PEDESTAL_STATUS);
    let (mut sent, mut numbers, mut ticks, mut turning) = ([0; 4], Vec::new(), 0, 0);
    while let Ok(received) = peer.receive() {
        let Received::Pulse(pulse) = received else { continue };
        is_there.store(true, Ordering::Release);
        let command_box = peer.mailbox(PEDESTAL_COMMAND);
        let number = CommandLayout::decode(command_box.data()).expect("the controller commands").number;
        if !numbers.contains(&number) {
            (numbers, ticks) = ([numbers, vec![number]].concat(), 0);
        }
        ticks += 1;
        let commanded = numbers.len() > 1; // the first command was already there when the pedestal connected
        let sensors_box = peer.mailbox(PEDESTAL_SENSORS);
        opening = SensorsLayout::decode(sensors_box.data()).expect("its devices are there").potentiometer;
        system.step(command_box, sensors_box);
        turning += u32::from(system.command().command == PedestalVerb::Flip);
        let over = match fate {
            Fate::DiesTurning(limit) => turning > limit,
            Fate::Serves(limit) => ticks > limit,
            Fate::AnswersForAnother | Fate::Babbles => numbers.len() > 2 && ticks > 5,
        };
        if over {
            return (system, opening);
        }
        for (mailbox, sent) in system.outgoing().iter().zip(&mut sent) {
            if mailbox.mailgram() == *sent {
                continue;
            }
            *sent = mailbox.mailgram();
            let mut own = mailbox.clone();
            if commanded && mailbox.place() == PEDESTAL_STATUS {
                let mut status = Status::decode(mailbox.data()).expect("a status");
                match fate {
                    Fate::AnswersForAnother => {
                        status.status.echo += 77;
                        forged.write(&status.encode()).expect("it fits");
                        own = forged.clone();
                    }
                    Fate::Babbles => {
                        forged.write(b"DONE").expect("it fits");
                        own = forged.clone();
                    }
                    Fate::DiesTurning(_) | Fate::Serves(_) => {}
                }
            }
            if peer.send(&own).is_err() {
                return (system, opening);
            }
        }
        if peer.pulse(pulse).is_err() {
            return (system, opening);
        }
    }
    (system, opening)
}

fn start_pedestal(program: &Path, controller: &Controller) -> (Child, Arc<AtomicBool>) {
    let mut child = Command::new(program)
        .args(["pedestal", "--wait", "1", "--network", &controller.address.to_string()])
        .stdout(Stdio::piped())
        .spawn()
        .expect("rcs-neighbour can be started");
    let mut stdout = BufReader::new(child.stdout.take().expect("it is piped"));
    let is_there = Arc::new(AtomicBool::new(false));
    let ours = Arc::clone(&is_there);
    // Reads until it ends.
    thread::spawn(move || {
        let mut line = String::new();
        while stdout.read_line(&mut line).is_ok_and(|bytes| bytes > 0) {
            ours.fetch_or(line.starts_with("working since tick "), Ordering::Release);
            line.clear();
        }
    });
    (child, is_there)
}

#[test]
fn external_pedestal_changes_no_bit() {
    // The program is rebuilt before the controller waits for it.
    let (program, alone) = (rcs_neighbour(), computed_alone("clevis", &[]));
    for boards in ["one", "split"] {
        let scratch = Scratch::new(&format!("turned-log-{boards}"));
        let log = scratch.file("run.mcap");
        let more = ["clevis", "--json", "--boards", boards, "--log", log.to_str().expect("a path")];
        let controller = Controller::start(&format!("turned-{boards}"), "pedestal", &more);
        let (mut pedestal, _) = start_pedestal(program, &controller);
        let ended = controller.end();
        assert_eq!(ended.status, Some(0), "{}", ended.said);
        assert_eq!(computed(&log), alone, "--boards {boards}");
        assert_eq!(ended.result["allocations_after_start"], 0);
        assert!(pedestal.wait().expect("a child").success(), "it ends when no run comes");
    }
}

#[test]
fn every_failure_of_the_pedestal_ends_the_command_without_a_drop() {
    let controller = Controller::start("fates", "workstation,pedestal", &["--json", "--wait", "5"]);
    let mut shop = Shop::with_clevis(controller);
    assert_eq!(shop.fails(), SILENT); // it was never connected
    for fate in [Fate::AnswersForAnother, Fate::Babbles] {
        let guest = shop.admit(fate);
        assert_eq!(shop.fails(), SILENT, "{fate:?}");
        shop.see_off(guest);
    }
    let guest = shop.admit(Fate::DiesTurning(25)); // killed with the part in its hand
    assert_eq!(shop.fails(), SILENT);
    let (dead, held) = shop.see_off(guest);
    assert!(dead.memory().hand.status.position > 240, "it held the clevis");
    let guest = shop.admit(Fate::Serves(300)); // its successor does not move the hand without a new command
    let (successor, opening) = shop.see_off(guest);
    let status = successor.memory().pedestal.status;
    assert_eq!((status.report, status.reason), (PedestalReport::Error, Reason::Restarted));
    assert_eq!(successor.memory().hand.valves.bits, 0);
    assert!(opening.abs_diff(held) < 10, "the fingers moved from {held} to {opening} counts");
    let ended = shop.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let [part] = &ended.result["parts"].as_array().expect("parts")[..] else { panic!("{}", ended.result) };
    assert_eq!(part["location"], "PEDESTAL", "{part}");
}

/// Killed with SIGKILL, and replaced.
#[test]
fn restarted_pedestal_turns_the_next_part() {
    let program = rcs_neighbour();
    let controller = Controller::start("killed-pedestal", "workstation,pedestal", &["--json"]);
    let (mut killed, _) = start_pedestal(program, &controller);
    let mut shop = Shop::with_clevis(controller);
    killed.kill().expect("it runs");
    killed.wait().expect("a child");
    assert_eq!(shop.fails(), SILENT);
    let (mut second, is_there) = start_pedestal(program, &shop.controller);
    while !is_there.load(Ordering::Acquire) {
        shop.workstation.tick();
    }
    assert_eq!(shop.carry_out(REFIXTURE), ("finished".to_owned(), String::new()));
    let ended = shop.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert!(second.wait().expect("a child").success());
}

#[test]
fn a_job_without_its_pedestal_is_refused_with_the_reason() {
    let scratch = Scratch::new("no-pedestal");
    let (socket, log) = (scratch.file("rcs.sock"), scratch.file("run.mcap"));
    let output = Command::new(rcs_run())
        .args(["clevis", "--json", "--shared-memory", "off", "--outside", "pedestal", "--wait", "1"])
        .args(["--network", &format!("unix:{}", socket.display()), "--log", &log.display().to_string()])
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("pedestal has not connected; the run begins without it"), "{said}");
    let last = said.lines().last().unwrap_or_default();
    assert!(last.contains(&format!("Subtask: {SILENT}, while it executed FIX-GRIP LCLEVIS_IH")), "{last}");
    let why = Command::new(rcs_log()).arg("why").arg(&log).output().expect("rcs-log can be started");
    let why = String::from_utf8_lossy(&why.stdout).into_owned();
    assert!(why.contains(SILENT) && why.contains("pedestal is Silent"), "{why}");
    let replayed = Command::new(rcs_log()).arg("replay").arg(&log).output().expect("rcs-log can be started");
    assert!(replayed.status.success(), "{}", String::from_utf8_lossy(&replayed.stdout));
}
