//! A run switches from stand-alone command to a workstation controller and back (IV.4.1).

use std::fs;

use interfaces::HwsCommand;
use rcs_core::name::Name16;
use whole_system_tests::Scratch;

use super::bench::{Controller, Ended, Workstation, bare};

const NOTHING: &str = "-- +0 -- 0 +0"; // a command without object

fn start(name: &str, lines: &[String], outside: &str, more: &[&str]) -> Controller {
    let scratch = Scratch::new(name);
    let (job, outbox) = (scratch.file("own.job"), scratch.file("outbox"));
    fs::write(&job, lines.join("\n")).expect("a job can be written");
    let (job, outbox) = (job.display().to_string(), outbox.display().to_string());
    let all = [&[job.as_str(), "--stand-alone", "--outbox", &outbox, "--json"], more].concat();
    Controller::start_at(scratch, None, outside, &all)
}

fn go(place: &str) -> String {
    format!("== MOVE {NOTHING} {place} 0 -- 0")
}

fn pause() -> String {
    format!("== PAUSE {NOTHING} -- 0 -- 0")
}

fn hand_over() -> String {
    "** workstation".to_owned()
}

fn next(workstation: &mut Workstation, verb: &str, destination: &str) -> String {
    let number = u32::from(workstation.status().echo) + 1;
    let command = HwsCommand { destination: Some(Name16::clipped(destination)), ..bare(number, verb) };
    let (report, reason) = workstation.carry_out(&command);
    assert_eq!(u32::from(workstation.status().echo), number);
    format!("{verb} {destination}: {report}{reason}")
}

#[test]
fn the_workstation_commands_between_lines_of_the_job() {
    let lines = [hand_over(), go("SAFE"), go("HOME"), pause(), hand_over()];
    let controller = start("switching", &lines, "workstation", &[]);
    let mut first = Workstation::connect(&controller);
    let echo = first.status().echo;
    assert_ne!(echo, 0, "the number of the job's PAUSE");
    assert_eq!(next(&mut first, "PAUSE", ""), "PAUSE : finished");
    assert_eq!(next(&mut first, "MOVE", "SAFE"), "MOVE SAFE: finished");
    let last = first.status().echo;
    drop(first);
    // The second controller waits for its turn, and has missed the numbers of PAUSE, MOVE, MOVE and PAUSE.
    let mut second = Workstation::connect(&controller);
    assert_eq!(second.status().echo, last + 4, "one sequence of numbers");
    assert_eq!(next(&mut second, "PAUSE", ""), "PAUSE : finished");
    drop(second);
    let ended = controller.end();
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let commands = ended.result["commands"].as_array().cloned().unwrap_or_default();
    let verbs: Vec<_> = commands
        .iter()
        .map(|command| {
            assert_eq!(command["status"], "finished", "{command}");
            command["text"].as_str().and_then(|text| text.split(' ').next()).unwrap_or_default()
        })
        .collect();
    let expected = ["PAUSE", "PAUSE", "MOVE", "PAUSE", "MOVE", "MOVE", "PAUSE", "PAUSE", "PAUSE"];
    assert_eq!(verbs, expected);
}

#[test]
fn workstation_leaving_during_a_command_ends_the_run() {
    let controller = start("amid", &[hand_over(), go("SAFE")], "workstation", &[]);
    let mut workstation = Workstation::connect(&controller);
    let number = u32::from(workstation.status().echo) + 1;
    workstation.send(&HwsCommand { destination: Some(Name16::clipped("SAFE")), ..bare(number, "MOVE") });
    for _ in 0..20 {
        workstation.tick();
    }
    drop(workstation);
    let ended = controller.end();
    assert_eq!(ended.status, Some(1), "{}", ended.said);
    assert!(ended.said.contains("has gone while MOVE was not finished"), "{}", ended.said);
}

#[test]
fn missing_prerequisites_are_reported() {
    let refused = |name: &str, lines: &[String], outside: &str| -> Ended {
        let controller = start(name, lines, outside, &["--wait", "1"]);
        let ended = controller.end();
        assert_eq!(ended.status, Some(1), "{}", ended.said);
        ended
    };
    let last_line = |ended: &Ended| ended.said.lines().last().unwrap_or_default().to_owned();
    let cases: [(&str, &[String], &str, &str); 4] = [
        (
            "away",
            &[go("SAFE"), hand_over()],
            "workstation",
            "with the robot at HOME, it is at SAFE: move it there",
        ),
        (
            "moved",
            &[go("HOME"), hand_over()],
            "workstation",
            "with PAUSE as the last command, it was MOVE: send it",
        ),
        (
            "books",
            &[hand_over()],
            "workstation,data-system",
            "the Data System is connected before the workstation",
        ),
        ("nobody", &[hand_over()], "workstation", "no workstation controller has connected within 1 s"),
    ];
    for (name, lines, outside, why) in cases {
        let ended = refused(name, lines, outside);
        let line = last_line(&ended);
        assert!(line.contains("in `** workstation`") && line.contains(why), "{name}: {line}");
    }
}
