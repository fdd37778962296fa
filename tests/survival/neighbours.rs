use std::{fs, os::unix::process::CommandExt, process::Stdio};

use executive::memory::{layout, prefix};
use whole_system_tests::{
    NOBODY, Scratch,
    bench::{Ended, Running, assert_cleaned, rcs, traces, wait_for},
    may_become_nobody, rcs_run,
};

#[test]
fn parallel_runs_do_not_interfere() {
    let scratch = Scratch::new("beside");
    let start = |log| Running::start(&scratch.file(""), "linkbar", &["--ticks", "2000", "--log", log]);
    // Names of equal length, as the log contains the command line.
    let (one, other) = (start("one.mcap"), start("two.mcap"));
    let names = [one.name.clone(), other.name.clone()];
    let (one, other) = (one.end(), other.end());
    for ended in [&one, &other] {
        ended.assert_shared();
    }
    assert_eq!(one.digest(), other.digest());
    let read = |log| fs::read(scratch.file(log)).expect("a log");
    assert_eq!(read("one.mcap").len(), read("two.mcap").len());
    names.iter().for_each(|name| assert!(traces(name).is_empty(), "an orderly end leaves nothing"));
}

/// Skipped without the right to become another user.
#[test]
fn another_user_runs_in_parallel_and_after_the_first() {
    let scratch = Scratch::new("users");
    if !may_become_nobody(&scratch.file("")) {
        eprintln!("no right to become another user: none to try");
        return;
    }
    let mut first = Running::start(&scratch.file(""), "linkbar", &["--clock", "real", "--log", "none"]);
    drop(first.attach());
    let program = scratch.file("rcs-run"); // the target directory may be private
    fs::copy(rcs_run(), &program).expect("the program can be copied");
    let data = scratch.file("data");
    whole_system_tests::copy(&whole_system_tests::root().join("data"), &data);
    let as_nobody = |arguments: &[&str]| {
        let mut command = std::process::Command::new(&program);
        command.args(arguments).current_dir(scratch.file("")).uid(NOBODY).gid(NOBODY).stdin(Stdio::null());
        Ended::of(&command.output().expect("user nobody can start the program"))
    };
    let data = data.display().to_string();
    let run = ["run", "linkbar", "--ticks", "50", "--json", "--log", "none", "--data", data.as_str()];
    let beside = as_nobody(&run);
    assert_eq!(beside.status, Some(0), "{}", beside.said);
    beside.assert_shared();
    let cleaned = as_nobody(&["clean"]);
    assert_eq!(cleaned.status, Some(0), "{}", cleaned.said);
    assert!(!traces(&first.name).is_empty(), "what belongs to another user is not removed");
    let refused = as_nobody(&["status", first.name.as_str()]);
    assert_eq!(refused.status, Some(2));
    assert!(refused.last_words().contains("there is no run named"), "{}", refused.said);
    first.kill();
    as_nobody(&run).assert_shared(); // also after a killed run
    assert_cleaned(&scratch.file(""), &first.name);
}

#[test]
fn status_shows_a_run() {
    let scratch = Scratch::new("status");
    let mut run = Running::start(&scratch.file(""), "linkbar", &["--clock", "real", "--log", "none"]);
    drop(run.attach());
    let status = |more: &[&str]| {
        let all = [&["status", run.name.as_str()][..], more].concat();
        Ended::of(&rcs(&scratch.file(""), &all).output().expect("rcs-run can be started"))
    };
    let mut seen = serde_json::Value::Null;
    wait_for("Task has its first command", || {
        seen = status(&["--json"]).result;
        seen["processes"][0]["command"] == "PAUSE"
    });
    assert_eq!((&seen["run"], &seen["over"]), (&run.name.as_str().into(), &false.into()));
    assert_eq!(seen["processes"][0]["process"], "Task");
    let place =
        rcs(&scratch.file(""), &["status", run.name.as_str(), "--directory"]).output().expect("a place");
    let place = String::from_utf8(place.stdout).expect("a path");
    let configuration = std::path::Path::new(place.trim()).join("config/iceoryx2.toml");
    let prefix = prefix(&run.name, &layout());
    assert!(fs::read_to_string(configuration).expect("for iox2").contains(&prefix), "{prefix}");
    run.kill();
    assert_cleaned(&scratch.file(""), &run.name);
    let none = rcs(&scratch.file(""), &["status", "no-such-run"]).output().expect("rcs-run can be started");
    assert_eq!(none.status.code(), Some(2));
}
