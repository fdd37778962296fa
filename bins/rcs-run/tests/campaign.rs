//! `rcs-run campaign` as a program: a branch that is not interrupted is the ordinary run, and what is printed.

use std::{path::Path, process::Command};

use serde_json::Value;

/// Directory of the workspace, whose data are used.
const WORKSPACE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

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

/// The same number of ticks and the same digest: of the undisturbed run, and of a branch that an operator plays to its end.
#[test]
fn a_branch_that_is_not_interrupted_is_the_ordinary_run_bit_for_bit() {
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
fn a_single_branch_is_told_row_by_row() {
    let text = rcs_run(&["campaign", "linkbar", "--at", "60", "--interrupt", "refused"]);
    assert!(text.starts_with("refused after tick 60, in `PAUSE`"), "{text}");
    for expected in ["the operator sends MOVE to NOWHERRE", "Task", "row", "Done at tick"] {
        assert!(text.contains(expected), "{expected} is missing in {text}");
    }
}

#[test]
fn the_table_is_written_as_markdown() {
    let directory = tempfile::tempdir().expect("there is room");
    let file = directory.path().join("table.md");
    let name = file.to_str().expect("the path is text");
    rcs_run(&["campaign", "linkbar", "--at", "20,40", "--interrupt", "pause,held:task", "--markdown", name]);
    let table = std::fs::read_to_string(&file).expect("the table is written");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 4, "{table}");
    assert!(rows[2].starts_with("| linkbar | pause | 2 |") && rows[3].contains("held:task"), "{table}");
}

/// Nothing is found where nothing was interrupted, and every branch is judged: a sample of all jobs.
#[test]
fn a_sample_of_a_campaign_judges_every_branch() {
    for job in ["linkbar", "clevis", "turned-part", "tool-change"] {
        let sample = json(&["campaign", job, "--ticks", "2100", "--interrupt", "none,pause,estop", "--json"]);
        let rows = sample["rows"].as_array().expect("there are rows");
        let count = |row: &Value, name: &str| row[name].as_u64().expect("counts are numbers");
        let [none, pause, estop] = &rows[..] else { panic!("{rows:?}") };
        assert_eq!(count(none, "done"), count(none, "branches"), "{job}: {}", sample["branches"]);
        for row in [pause, estop] {
            let judged = ["done", "stranded", "apart", "hurt"].map(|name| count(row, name));
            assert_eq!(judged.iter().sum::<u64>(), count(none, "branches"), "{job}: {row}");
        }
        for branch in sample["branches"].as_array().expect("branches are listed") {
            let explained = branch["verdict"] == "done" || branch["detail"] != "";
            assert!(explained, "{job}: {branch}");
        }
    }
}
