//! `rcs-run campaign` as a program: the branch without interruption is the ordinary run, and the output is complete.

use std::{path::Path, process::Command};

use serde_json::Value;

const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn rcs_run(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_rcs-run"))
        .current_dir(Path::new(WORKSPACE))
        .args(arguments)
        .output()
        .expect("rcs-run runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("the output is text")
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&rcs_run(arguments)).expect("the output is JSON")
}

/// The undisturbed run, and a branch that an operator plays to its end, have the same digest.
#[test]
fn uninterrupted_branch_equals_the_ordinary_run() {
    for job in ["linkbar", "turned-part"] {
        let run = json(&["run", job, "--log", "none", "--shared-memory", "off", "--json"]);
        let campaign =
            json(&["campaign", job, "--at", "15,1400", "--interrupt", "none", "--judge", "job", "--json"]);
        assert_eq!((&campaign["ticks"], &campaign["digest"]), (&run["ticks"], &run["digest"]), "{job}");
        let branches = campaign["branches"].as_array().expect("branches are listed");
        assert_eq!(branches.len(), 2);
        for branch in branches {
            assert_eq!(branch["verdict"], "done", "{job}: {branch}");
            assert_eq!(
                (&branch["until"], &branch["digest"]),
                (&run["ticks"], &run["digest"]),
                "{job}: {branch}"
            );
        }
    }
}

#[test]
fn single_branch_is_printed_row_by_row() {
    let text = rcs_run(&["campaign", "linkbar", "--at", "60", "--interrupt", "refused"]);
    assert!(text.starts_with("refused after tick 60, in `PAUSE`"), "{text}");
    for expected in ["the operator sends MOVE to NOWHERRE", "Task", "row", "Done at tick"] {
        assert!(text.contains(expected), "{expected} is missing in {text}");
    }
}

#[test]
fn campaign_table_is_written_as_markdown() {
    let directory = tempfile::tempdir().expect("there is room");
    let file = directory.path().join("table.md");
    let name = file.to_str().expect("the path is text");
    let campaign = ["--at", "20,40", "--interrupt", "pause,held:task", "--markdown", name];
    rcs_run(&[&["campaign", "linkbar", "clevis"], &campaign[..]].concat());
    rcs_run(&[&["campaign", "linkbar"], &campaign[..]].concat());
    let table = std::fs::read_to_string(&file).expect("the table is written");
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert_eq!(rows, ["| pause | 2/2 | 2/2 |", "| held:task | 2/2 | 2/2 |"], "{table}");
    assert!(table.contains("| interruption | linkbar | clevis |"), "{table}");
}

/// Branches that were hurt in earlier campaigns (docs/evidence.md "Series").
#[test]
fn branches_hurt_in_earlier_campaigns_are_done() {
    for (job, tick, kind) in [
        ("turned-part", "1564", "fault:id-pins-bad"),
        ("turned-part", "2528", "fault:air-lost+1:replaced"),
        ("turned-part", "2553", "fault:id-pins-bad"),
        ("turned-part", "3632,3633", "replaced"),
        ("turned-part", "3642", "replaced+1:fault:air-lost"),
        ("turned-part", "2553,2554", "replaced+1:fault:air-lost"),
        ("turned-part", "2556", "fault:air-lost"),
        ("clevis", "1054", "pause+9:answer-late"),
        ("clevis", "2456", "replaced"),
        ("clevis", "6128", "restart:hand"),
        ("tool-change", "4917", "fault:air-lost+1:replaced"),
    ] {
        let campaign = json(&["campaign", job, "--at", tick, "--interrupt", kind, "--json"]);
        for branch in campaign["branches"].as_array().expect("branches are listed") {
            assert_ne!(branch["verdict"], "hurt", "{job}: {branch}");
        }
    }
}

/// Interruptions after which a job must continue in 97 of 100 branches, without harm.
const REQUIRED: &str =
    "pause,pause-twice,refused,replaced,answer-lost,answer-late,answer-damaged,hold,nudge,held,restart,power";

/// A sample of the campaign: all jobs, all required kinds and the E-stop. The number of the job determines the ticks.
#[test]
fn campaign_sample_recovers_without_damage() {
    let count = |row: &Value, name: &str| row[name].as_u64().expect("counts are numbers");
    let (mut branches, mut done) = (0, 0);
    for (number, job) in ["linkbar", "clevis", "turned-part", "tool-change"].into_iter().enumerate() {
        let ticks = (2_600 + 170 * number).to_string();
        let kinds = format!("none,{REQUIRED},estop");
        let sample = json(&["campaign", job, "--ticks", &ticks, "--interrupt", &kinds, "--json"]);
        for branch in sample["branches"].as_array().expect("branches are listed") {
            assert_ne!(branch["verdict"], "hurt", "{job}: {branch}");
            let explained = branch["verdict"] == "done" || branch["detail"] != "";
            assert!(explained, "{job}: {branch}");
        }
        for row in sample["rows"].as_array().expect("there are rows") {
            let judged = ["done", "stranded", "apart", "hurt", "false"].map(|name| count(row, name));
            assert_eq!(judged.iter().sum::<u64>(), count(row, "branches"), "{job}: {row}");
            match row["interruption"].as_str() {
                // A branch without interruption has no findings.
                Some("none") => assert_eq!(count(row, "done"), count(row, "branches"), "{job}: {row}"),
                Some("estop") => {}
                _ => {
                    branches += count(row, "branches");
                    done += count(row, "done");
                }
            }
        }
    }
    println!("{done} of {branches} branches are done");
    assert!(branches > 200, "{branches} branches are too few");
    assert!(100 * done >= 97 * branches, "{done} of {branches} branches are done");
}

/// A draw gives the same branches with any number of threads, and one command line repeats each branch.
#[test]
fn drawn_disturbances_repeat_alone_and_together() {
    let draw = |threads: &str| {
        json(&["campaign", "linkbar", "--truth", "6", "--draw", "3", "--threads", threads, "--json"])
    };
    let one = draw("1");
    assert_eq!(one["branches"], draw("2")["branches"]);
    let branches = one["branches"].as_array().expect("branches are listed");
    assert_eq!(branches.len(), 6);
    for branch in branches {
        let judged = branch["judged"].as_u64().expect("it is counted");
        assert!(judged > 0, "no confirmation was judged: {branch}");
        assert_eq!(
            branch["verdict"] == "false",
            branch["untrue"].to_string().contains("\"false\""),
            "{branch}"
        );
    }
    let first = &branches[0];
    let (at, kind) = (first["at"].to_string(), first["interruption"].as_str().expect("it has a name"));
    let alone = json(&["campaign", "linkbar", "--at", &at, "--interrupt", kind, "--json"]);
    assert_eq!(alone["branches"][0]["verdict"], first["verdict"]);
    assert_eq!(alone["branches"][0]["state"], first["state"], "{kind} at {at}");
}

/// The pressure fails while a part is grasped or has just been released, and while a gripper is attached.
#[test]
fn lost_pressure_causes_no_false_confirmation() {
    for (job, at) in [
        ("clevis", "1190,1270,9080,9118,9130"),
        ("turned-part", "1570,1572,4800,5920"),
        ("tool-change", "1470,1490,3500,4940"),
    ] {
        for kind in ["estop", "fault:hydraulics-lost"] {
            let campaign = json(&["campaign", job, "--at", at, "--interrupt", kind, "--json"]);
            for branch in campaign["branches"].as_array().expect("branches are listed") {
                assert!(branch["judged"].as_u64().expect("it is counted") > 0, "{job} {kind}: {branch}");
                assert!(!branch["untrue"].to_string().contains("\"false\""), "{job} {kind}: {branch}");
            }
        }
    }
}

/// A person pushes an object with the empty robot, and moves the robot while the jaws hold a tool, which is lost.
#[test]
fn jog_causes_no_false_confirmation() {
    for (job, at, jog) in [
        ("shift", "11734", "jog:-96:36:-165"),
        ("shift", "16317", "jog:-62:-3:-337"),
        ("tool-change", "2494", "jog:2:5:6"),
    ] {
        let campaign = json(&["campaign", job, "--at", at, "--interrupt", jog, "--json"]);
        let branch = &campaign["branches"][0];
        assert!(branch["judged"].as_u64().expect("it is counted") > 0, "{jog}: {branch}");
        assert!(!branch["untrue"].to_string().contains("\"false\""), "{jog}: {branch}");
    }
}

/// A part is removed before its picture. The command fails correctly, and continues when the part is back.
#[test]
fn job_continues_after_the_remedy_of_its_error() {
    let campaign =
        json(&["campaign", "linkbar", "--at", "300", "--interrupt", "take:1", "--judge", "job", "--json"]);
    let branch = &campaign["branches"][0];
    assert_eq!((&branch["verdict"], &branch["remedied"]), (&"done".into(), &true.into()), "{branch}");
    let ended = branch["ended"].to_string();
    assert!(ended.contains("vision sees no object"), "{ended}");
}
