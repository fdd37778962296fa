//! The workstation controller in another process (V.4.2, IX.1).

use std::process::Command;

use interfaces::{HwsCommand, Reason};
use neighbours::{
    mailbox::HWSC_COMMAND,
    workstation::{
        cell::{self, Trouble},
        command,
    },
};
use rcs_core::name::Name16;
use rustix::process::{Pid, Signal, kill_process};
use whole_system_tests::{rcs_neighbour, root};

use super::bench::{Controller, Workstation, bare, run_alone};

#[test]
fn a_job_from_another_process_has_the_same_bits() {
    let own = run_alone(&["linkbar"]);
    let program = rcs_neighbour(); // rebuilt before the controller waits for it
    let controller = Controller::start("bits", "workstation", &["--json"]);
    let played = Command::new(program)
        .args(["workstation", "--network", &controller.address.to_string(), "linkbar"])
        .current_dir(root())
        .output()
        .expect("rcs-neighbour can be started");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["digest"], own["digest"]);
    assert_eq!(ended.result["parts"], own["parts"]);
    let texts = |result: &serde_json::Value| {
        let commands = result["commands"].as_array().expect("commands").clone();
        commands
            .iter()
            .map(|command| (command["status"].clone(), command["ticks"].clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(texts(&ended.result), texts(&own));
}

#[test]
fn boards_are_commanded_from_another_process() {
    let controller = Controller::start("boards", "workstation", &["--json", "--boards", "split"]);
    let mut workstation = Workstation::connect(&controller);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
}

/// `what` follows a PAUSE. Returns the digest of 200 ticks.
fn digest_with(name: &str, what: impl FnOnce(&mut Workstation)) -> String {
    let controller = Controller::start(name, "workstation", &["--json"]);
    let mut workstation = Workstation::connect(&controller);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    what(&mut workstation);
    workstation.run_to(200);
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.result["ticks"], 200, "a run in fast clock ends with its workstation controller");
    ended.result["digest"].as_str().expect("a digest").to_owned()
}

/// No buffer differs from a run without the refused commands.
#[test]
fn refused_commands_report_the_reason_and_cause_no_motion() {
    let quiet = digest_with("quiet", |_| {});
    let disturbed = digest_with("disturbed", |workstation| {
        let good = command::encode(&bare(2, "MOVE")).expect("it fits");
        let mut garbled = good;
        garbled[21] = 0x9C;
        let other = HwsCommand { source_sector: Some(3), ..bare(1, "PAUSE") };
        let cases: [(&[u8], &str); 6] = [
            (&garbled, "for command-16, found 9C at byte 21"),
            (&good[..60], "a command of 126 bytes was expected, found 60"),
            (&[good.as_slice(), b"more"].concat(), "a command of 126 bytes was expected, found 130"),
            (
                &command::encode(&other).expect("it fits"),
                "command 1 was given before with other fields; 2 comes next",
            ),
            (&command::encode(&bare(7, "MOVE")).expect("it fits"), "command 2 comes next, found 7"),
            (&command::encode(&bare(0, "MOVE")).expect("it fits"), "found 0"),
        ];
        for (data, why) in cases {
            workstation.write(data);
            workstation.tick();
            workstation.tick();
            let status = workstation.status();
            assert!(status.verdict != 0 && status.reason.ends_with(why), "{why}: {status:?}");
            assert_eq!((status.echo, status.report.text()), (1, "finished"));
        }
        workstation.send(&bare(1, "PAUSE")); // not new
        workstation.tick();
        workstation.tick();
        assert_eq!((workstation.status().verdict, workstation.status().report.text()), (0, "finished"));
    });
    assert_eq!(disturbed, quiet);
}

#[test]
fn command_that_fails_its_check_is_refused_with_the_reason_of_a_job_line() {
    let controller = Controller::start("verdict", "workstation", &["--json"]);
    let mut workstation = Workstation::connect(&controller);
    assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
    let name = |text| Some(Name16::clipped(text));
    let to_sector = HwsCommand {
        object: name("LINKBAR1_BH"),
        source_grip: 2,
        source: name("UNIT_1"),
        source_sector: Some(4),
        destination_grip: 2,
        destination: name("UNIT_1"),
        destination_sector: Some(3),
        end_at: name("UNIT_1"),
        end_at_sector: Some(2),
        ..bare(2, "TRANSFER")
    };
    let (report, _) = workstation.carry_out(&to_sector);
    let status = workstation.status();
    assert_eq!((report.as_str(), status.echo, status.verdict), ("error", 2, 0));
    assert_eq!(status.reason, "sector 2 of UNIT_1 needs an object, which says how the tray is divided");
    assert_eq!(status.code, Reason::CheckFailed);
    let home = HwsCommand { destination: name("HOME"), ..bare(3, "MOVE") };
    assert_eq!(workstation.carry_out(&home).0, "finished");
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
}

/// Refused lines open no file.
#[test]
fn refusals_of_cell_lines_name_number_and_reason() {
    const LOAD: &str = "load OFFSET BLOCK was expected, such as load 21000 610; load FILE is for the controller's \
                        own jobs";
    let controller = Controller::start("lines", "workstation", &[]);
    let mut workstation = Workstation::connect(&controller);
    let line = |number, text| cell::encode_line(number, text).to_vec();
    let mut garbled = line(20, "vise close PFIXTURE");
    garbled[9] = 0xC3;
    let cases: [(Vec<u8>, u16, &str); 14] = [
        (line(0, "vise close PFIXTURE"), 0, "a number of at least 1 was expected, found 0"),
        (line(9, "load README.md"), 9, LOAD),
        (line(10, "load data/no-such-file.blk"), 10, LOAD),
        (line(11, "( aside ) load /dev"), 11, LOAD),
        (line(12, "load"), 12, LOAD),
        (
            line(13, "after 5 load README.md"),
            13,
            "after is for jobs only: the workstation controller counts the ticks, and sends the line then",
        ),
        (
            line(14, "wait 30"),
            14,
            "wait is for jobs only: the workstation controller counts the ticks itself",
        ),
        (line(15, "dance"), 15, "no line for the cell is named dance"),
        (line(16, ""), 16, "a line for the cell was expected, such as vise close PFIXTURE; found none"),
        (
            garbled,
            20,
            "printable characters and blanks after them were expected for line, found C3 at byte 9",
        ),
        (line(21, "vise close PFIXTURE")[..100].to_vec(), 21, "a line of 242 bytes was expected, found 100"),
        (vec![22, 0], 22, "a line of 242 bytes was expected, found 2"),
        (vec![7], 22, "the data end before number does"),
        (Vec::new(), 22, "the data end before number does"),
    ];
    for (data, number, why) in cases {
        workstation.write_cell(&data);
        workstation.tick();
        workstation.tick();
        let status = workstation.cell();
        assert_eq!((status.echo, status.trouble, status.text), (number, Trouble::Refused, why));
        assert!(!status.busy);
    }
    workstation.write_cell(&line(23, "vise close PFIXTURE"));
    workstation.tick();
    workstation.tick();
    assert_eq!((workstation.cell().echo, workstation.cell().trouble), (23, Trouble::None));
    drop(workstation);
    assert_eq!(controller.end().status, Some(0));
}

#[test]
fn unknown_command_fails_and_the_next_one_is_executed() {
    let controller = Controller::start("unknown", "workstation", &["--json"]);
    let mut workstation = Workstation::connect(&controller);
    let outcome = workstation.carry_out(&bare(1, "FROBNICATE"));
    assert_eq!(outcome, ("error".to_owned(), "no command of Task is named FROBNICATE".to_owned()));
    let lost = HwsCommand { object: HwsCommand::default().object, ..bare(2, "TRANSFER") };
    let outcome = workstation.carry_out(&lost);
    assert_eq!(outcome.0, "error");
    assert_eq!(workstation.carry_out(&bare(3, "PAUSE")).0, "finished");
    drop(workstation);
    let ended = controller.end();
    let statuses: Vec<_> =
        ended.result["commands"].as_array().expect("commands").iter().map(|c| &c["status"]).collect();
    assert_eq!(statuses, ["error", "error", "finished"]);
}

/// On the 40 ms grid the controller continues alone; numbers are synchronized on connection (IX.1).
#[test]
fn a_reconnected_workstation_controller_continues_from_the_echo() {
    let controller = Controller::start("again", "workstation", &["--json", "--clock", "real"]);
    let mut first = Workstation::connect(&controller);
    assert_eq!(first.carry_out(&bare(1, "PAUSE")).0, "finished");
    let last = first.tick;
    drop(first);
    let mut second = Workstation::connect(&controller);
    assert!(second.tick > last, "the ticks continued");
    assert_eq!((second.status().echo, second.status().verdict), (1, 0));
    // A workstation controller that has lost its state starts with number 1 again.
    second.send(&HwsCommand { source_sector: Some(1), ..bare(1, "PAUSE") });
    while second.status().verdict == 0 {
        second.tick();
    }
    assert_eq!(second.status().reason, "command 1 was given before with other fields; 2 comes next");
    second.send(&bare(2, "PAUSE"));
    while second.status().echo != 2 {
        second.tick();
    }
    let pid = Pid::from_child(&controller.child);
    kill_process(pid, Signal::TERM).expect("it runs");
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "a requested end is not a failure: {}", ended.said);
    assert_eq!(ended.result["commands"].as_array().map(Vec::len), Some(2));
    assert_eq!(ended.result["allocations_after_start"], 0);
}

#[test]
fn connection_with_invalid_frames_is_closed() {
    let controller = Controller::start("nonsense", "workstation", &["--clock", "real"]);
    let mut workstation = Workstation::connect(&controller);
    let mut status = neighbours::mailbox::Mailbox::initialized(neighbours::mailbox::HWSC_STATUS);
    status.write(b"finished").expect("it fits");
    workstation.peer.send(&status).expect("the controller reads");
    let why = loop {
        match workstation.peer.receive() {
            Ok(_) => {}
            Err(error) => break error.to_string(),
        }
    };
    let expected = format!("the address of {HWSC_COMMAND}");
    assert!(why.contains(&expected) && why.ends_with("found F6200"), "{why}");
    drop(Workstation::connect(&controller));
}
