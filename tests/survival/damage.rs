//! Foreign directories, stopped programs and other users harm neither runs nor `clean`.

use std::{
    env, fs,
    os::unix::fs::PermissionsExt as _,
    process::{Command, Output, Stdio},
};

use rustix::process::geteuid;
use whole_system_tests::{
    Scratch,
    bench::{Ended, job, rcs, wait_for},
    rcs_run,
};

const STRANGER: u32 = 65_534;

fn count(variable: &str, usual: u64) -> u64 {
    env::var(variable).map_or(usual, |text| text.parse().unwrap_or_else(|_| panic!("{variable} is a number")))
}

#[test]
fn clean_leaves_a_run_of_the_same_name_under_another_directory_alone() {
    let scratch = Scratch::new("same-name");
    let arguments = job("linkbar");
    let start = |place: &str, ticks: &str| {
        let tmp = scratch.file(place);
        fs::create_dir_all(&tmp).expect("a directory");
        let more = ["--run", "same-name", "--clock", "real", "--log", "none", "--ticks", ticks];
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
        let mut command = rcs(&tmp, &all);
        command
            .env("RCS_RUNS", &tmp)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts")
    };
    let status = |place: &str| {
        let tmp = scratch.file(place);
        rcs(&tmp, &["status", "same-name"])
            .env("RCS_RUNS", &tmp)
            .output()
            .expect("it starts")
            .status
            .success()
    };
    let (first, mut second) = (start("first", "100"), start("second", "10000"));
    wait_for("both runs show their buffers", || status("first") && status("second"));
    second.kill().and_then(|()| second.wait()).expect("it can be killed");
    let tmp = scratch.file("second");
    let cleaned = rcs(&tmp, &["clean"]).env("RCS_RUNS", &tmp).output().expect("it starts");
    assert_eq!(cleaned.status.code(), Some(0), "{}", String::from_utf8_lossy(&cleaned.stderr));
    assert!(String::from_utf8_lossy(&cleaned.stdout).contains("removed same-name"));
    assert!(status("first"), "it lives on");
    Ended::of(&first.wait_with_output().expect("it ends")).assert_shared();
}

/// In a separate `/dev/shm`, another user empties every accessible object while runs start and end.
#[test]
fn another_user_cannot_open_or_block_a_run() {
    if !geteuid().is_root() {
        eprintln!("only root can start a process of another user: not tried");
        return;
    }
    let scratch = Scratch::new("stranger");
    // Another user may have no access to this program's directory.
    fs::copy(env!("CARGO_BIN_EXE_robustness"), scratch.file("attacker")).expect("it can be copied");
    let place = scratch.file("");
    fs::set_permissions(&place, fs::Permissions::from_mode(0o755)).expect("it is ours");
    let script = format!(
        "mount -t tmpfs -o size=64m,mode=1777 tmpfs /dev/shm || exit 9
         setpriv --reuid {STRANGER} --clear-groups ./attacker --process stranger > attack.log 2>&1 &
         until grep -q 'at work' attack.log; do sleep 0.1; done
         for run in $(seq 1 {}); do
             \"$@\" > run.json 2> run.log || {{ cat run.log >&2; kill $!; exit 1; }}
             if grep -e 'cannot be watched' -e 'not mirrored' run.log >&2; then kill $!; exit 2; fi
         done
         kill $! || exit 3",
        count("RCS_STRANGER", 5)
    );
    let arguments = job("linkbar");
    let output = Command::new("unshare")
        .args(["--mount", "sh", "-c", &script, "sh"])
        .arg(rcs_run())
        .args(arguments.iter().map(String::as_str).chain(["--ticks", "30", "--log", "none"]))
        .current_dir(&place)
        .env("RCS_RUNS", &place)
        .output();
    // `unshare` itself fails in a changed root that is not a mount point.
    let refused = |output: &Output| output.status.code() == Some(9) || output.stderr.starts_with(b"unshare:");
    let output = match output {
        Ok(output) if !refused(&output) => output,
        _ => {
            eprintln!("no right to mount: another user cannot be tried");
            return;
        }
    };
    let said = String::from_utf8_lossy(&output.stderr);
    let attack = fs::read_to_string(scratch.file("attack.log")).expect("the attacker writes a log");
    assert!(!attack.contains("opened"), "{attack}");
    assert_eq!(output.status.code(), Some(0), "{said}\n{attack}");
}

#[test]
fn stopped_program_with_the_lock_blocks_no_run() {
    let scratch = Scratch::new("stopped");
    let tmp = scratch.file("");
    let arguments = job("linkbar");
    let more = ["--ticks", "30", "--log", "none"];
    let run = || {
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
        Ended::of(&rcs(&tmp, &all).env("RCS_RUNS", &tmp).output().expect("it starts"))
    };
    run().assert_shared();
    let lock = scratch.file(&format!("rcs-runs-{}/lock", geteuid().as_raw()));
    let held = fs::File::open(lock).expect("the lock of the runs");
    held.lock().expect("it is free");
    let ended = run();
    assert_eq!((ended.status, ended.number("ticks")), (Some(0), 30), "{}", ended.said);
    assert!(ended.said.contains("took longer than"), "{}", ended.said);
}
