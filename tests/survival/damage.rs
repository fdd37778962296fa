//! Shared memory that other programs damage, runs under other directories, and other users: later runs and `clean` are
//! unharmed.

use std::{
    env, fs,
    io::{Seek, SeekFrom, Write},
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use rustix::process::geteuid;
use whole_system_tests::{Scratch, rcs_run};

use crate::bench::{Ended, ONE_AT_A_TIME, Running, assert_cleaned, job, rcs, traces, wait_for};

/// A user that owns nothing.
const STRANGER: u32 = 65_534;

fn count(variable: &str, usual: u64) -> u64 {
    env::var(variable).map_or(usual, |text| text.parse().unwrap_or_else(|_| panic!("{variable} is a number")))
}

/// A stream of numbers, the same in every run.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// All files of a run, also those in its directory.
fn files(path: PathBuf) -> Vec<PathBuf> {
    match fs::read_dir(&path) {
        Ok(entries) => entries.flatten().flat_map(|entry| files(entry.path())).collect(),
        Err(_) => vec![path],
    }
}

/// Write garbage into a file, or make it shorter, or leave it.
fn damage(path: &Path, numbers: &mut Numbers) {
    let kind = numbers.below(5);
    let Ok(mut file) = fs::File::options().write(true).open(path) else { return };
    let length = file.metadata().map_or(0, |found| found.len());
    match kind {
        0 => file.set_len(0).expect("it can be emptied"),
        1 => file.set_len(length / 2).expect("it can be cut"),
        2 | 3 => {
            // All of it, or some places.
            let (places, bytes) = if kind == 2 { (1, length) } else { (16, 8.min(length)) };
            for _ in 0..places {
                let at = numbers.below(length - bytes + 1);
                let garbage: Vec<u8> = (0..bytes).map(|_| numbers.below(256) as u8).collect();
                file.seek(SeekFrom::Start(at))
                    .and_then(|_| file.write_all(&garbage))
                    .expect("it can be written");
            }
        }
        _ => {}
    }
}

#[test]
fn damaged_memory_of_a_run_harms_no_later_run() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("damage");
    let directory = scratch.file("");
    for case in 0..count("RCS_DAMAGE", 8) {
        let mut numbers = Numbers(case);
        let mut run = Running::start(&directory, "linkbar", &["--clock", "real", "--log", "none"]);
        drop(run.attach());
        // While it runs, or after it was killed.
        if numbers.below(2) == 0 {
            run.kill();
        }
        traces(&run.name).into_iter().flat_map(files).for_each(|path| damage(&path, &mut numbers));
        // It may have ended already by what was done to it.
        thread::sleep(Duration::from_millis(50));
        if run.child.try_wait().expect("a child").is_none() {
            run.kill();
        }
        let next = Ended::run(&directory, "linkbar", &["--ticks", "30", "--log", "none"]);
        assert_eq!((next.status, next.number("ticks")), (Some(0), 30), "case {case}: {}", next.said);
        next.assert_shared();
        assert_cleaned(&directory, &run.name);
    }
}

#[test]
fn clean_leaves_a_run_of_the_same_name_under_another_directory_alone() {
    let _alone = ONE_AT_A_TIME.lock();
    let scratch = Scratch::new("same-name");
    let arguments = job("linkbar");
    let start = |place: &str, ticks: &str| {
        let tmp = scratch.file(place);
        fs::create_dir_all(&tmp).expect("a directory");
        let more = ["--run", "same-name", "--clock", "real", "--log", "none", "--ticks", ticks];
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
        let mut command = rcs(&tmp, &all);
        command.env("TMPDIR", &tmp).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
    };
    let status = |place: &str| {
        let tmp = scratch.file(place);
        rcs(&tmp, &["status", "same-name"]).env("TMPDIR", &tmp).output().expect("it starts").status.success()
    };
    let (first, mut second) = (start("first", "100"), start("second", "10000"));
    wait_for("both runs show their buffers", || status("first") && status("second"));
    second.kill().and_then(|()| second.wait()).expect("it can be killed");
    let tmp = scratch.file("second");
    let cleaned = rcs(&tmp, &["clean"]).env("TMPDIR", &tmp).output().expect("it starts");
    assert_eq!(cleaned.status.code(), Some(0), "{}", String::from_utf8_lossy(&cleaned.stderr));
    assert!(String::from_utf8_lossy(&cleaned.stdout).contains("removed same-name"));
    assert!(status("first"), "it lives on");
    Ended::of(&first.wait_with_output().expect("it ends")).assert_shared();
}

#[test]
#[ignore = "not a test but a process that a test of this file starts as another user"]
fn empties_what_it_can_open() {
    loop {
        for entry in fs::read_dir("/dev/shm").into_iter().flatten().flatten() {
            if let Ok(file) = fs::File::options().write(true).open(entry.path()) {
                file.set_len(0).expect("what is open can be emptied");
                println!("opened {}", entry.path().display());
            }
        }
    }
}

/// In a `/dev/shm` of its own another user opens and empties what it can, while runs begin and end.
#[test]
fn another_user_opens_nothing_of_a_run_and_keeps_none_from_starting() {
    if !geteuid().is_root() {
        eprintln!("only root can start a process of another user: not tried");
        return;
    }
    let scratch = Scratch::new("stranger");
    // Another user may not come to where this program lies.
    fs::copy(env::current_exe().expect("a test has a path"), scratch.file("attacker"))
        .expect("it can be copied");
    let place = scratch.file("");
    fs::set_permissions(&place, fs::Permissions::from_mode(0o755)).expect("it is ours");
    let script = format!(
        "mount -t tmpfs -o size=64m,mode=1777 tmpfs /dev/shm || exit 9
         setpriv --reuid {STRANGER} --clear-groups ./attacker --exact damage::empties_what_it_can_open \
             --ignored --nocapture > attack.log 2>&1 &
         until grep -q running attack.log; do sleep 0.1; done
         for run in $(seq 1 {}); do
             \"$@\" > run.json 2> run.log || {{ cat run.log >&2; kill $!; exit 1; }}
             if grep -e 'nobody can look on' -e 'not mirrored' run.log >&2; then kill $!; exit 2; fi
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
        .env("TMPDIR", &place)
        .output();
    let output = match output {
        Ok(output) if output.status.code() != Some(9) => output,
        _ => {
            eprintln!("no right to mount: another user cannot be tried");
            return;
        }
    };
    let said = String::from_utf8_lossy(&output.stderr);
    let attack = fs::read_to_string(scratch.file("attack.log")).expect("the attacker says what it does");
    assert!(!attack.contains("opened"), "{attack}");
    assert_eq!(output.status.code(), Some(0), "{said}\n{attack}");
}

#[test]
fn a_program_that_stopped_with_the_lock_holds_no_run_up() {
    let scratch = Scratch::new("stopped");
    let tmp = scratch.file("");
    let arguments = job("linkbar");
    let more = ["--ticks", "30", "--log", "none"];
    let run = || {
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
        Ended::of(&rcs(&tmp, &all).env("TMPDIR", &tmp).output().expect("it starts"))
    };
    run().assert_shared();
    let lock = scratch.file(&format!("rcs-runs-{}/lock", geteuid().as_raw()));
    let held = fs::File::open(lock).expect("the lock of the runs");
    held.lock().expect("it is free");
    let ended = run();
    assert_eq!((ended.status, ended.number("ticks")), (Some(0), 30), "{}", ended.said);
    assert!(ended.said.contains("took longer than"), "{}", ended.said);
}
