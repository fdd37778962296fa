//! Memory and disks that are full, removed, or contain foreign files.

use std::{
    fs::{self, Permissions},
    os::unix::fs::PermissionsExt as _,
    path::Path,
};

use rustix::process::geteuid;
use whole_system_tests::{
    Scratch,
    bench::{Ended, Running, apart, job, rcs},
};

fn assert_goes_on(ended: &Ended, sentence: &str) {
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.number("ticks"), 500);
    assert!(ended.said.contains(sentence), "{}", ended.said);
}

#[test]
fn without_shared_memory_the_run_continues_unobserved() {
    let scratch = Scratch::new("no-memory");
    let full = "mount -t tmpfs -o size=64k tmpfs /dev/shm";
    let Some(ended) = apart(&scratch.file(""), full, &["--ticks", "500", "--log", "none"]) else {
        eprintln!("no right to mount: a full /dev/shm cannot be tried");
        return;
    };
    assert_goes_on(
        &ended,
        "other programs cannot watch the run, shared memory is not available: /dev/shm has ",
    );
    // The memory is enough for the start. Then another process fills it.
    let fills = "mount -t tmpfs -o size=8m tmpfs /dev/shm && \
                 { (until ls /dev/shm/rcs-*data; do sleep 0.1; done; sleep 2; \
                    head -c 16M /dev/zero > /dev/shm/filler) > /dev/null 2>&1 & }";
    let more = ["--clock", "real", "--ticks", "150", "--log", "none"];
    let ended = apart(&scratch.file(""), fills, &more).expect("as before");
    ended.assert_shared();
    assert_eq!((ended.number("ticks"), ended.number("allocations_after_start")), (150, 0));
}

#[test]
fn memory_lost_during_the_start_is_reported() {
    let scratch = Scratch::new("race");
    // The memory is enough for the start. It is filled when the first object exists.
    let fills = "mount -t tmpfs -o size=2200k tmpfs /dev/shm && \
                 { (i=0; until ls /dev/shm/rcs-*_* || [ $((i += 1)) -gt 3000 ]; do :; done; \
                    head -c 4M /dev/zero > /dev/shm/filler) > /dev/null 2>&1 & }";
    for _ in 0..5 {
        let Some(ended) = apart(&scratch.file(""), fills, &["--ticks", "50", "--log", "none"]) else {
            eprintln!("no right to mount: a full /dev/shm cannot be tried");
            return;
        };
        // The end is random, but it always has a message.
        match ended.status {
            Some(0) => assert_eq!(ended.number("ticks"), 50),
            Some(3) => assert!(ended.last_words().contains("/dev/shm is full"), "{}", ended.said),
            other => panic!("{other:?}: {}", ended.said),
        }
    }
}

#[test]
fn directory_of_another_user_is_not_used() {
    let scratch = Scratch::new("not-ours");
    let place = scratch.file(&format!("rcs-runs-{}", geteuid().as_raw()));
    fs::write(&place, "in the way").expect("a file can be written");
    let arguments = job("linkbar");
    let more = ["--ticks", "500", "--log", "none"];
    let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
    let mut command = rcs(&scratch.file(""), &all);
    let ended = Ended::of(&command.env("RCS_RUNS", scratch.file("")).output().expect("it starts"));
    assert_goes_on(&ended, "must belong to this user only (it is not a directory)");
}

#[test]
fn stale_and_strange_files_do_not_disturb_and_are_removed() {
    let scratch = Scratch::new("stale");
    let (tmp, user) = (scratch.file(""), geteuid().as_raw());
    let root = scratch.file(&format!("rcs-runs-{user}"));
    // A killed run of an older version, with a layout that no present program uses.
    fs::create_dir_all(root.join("old-1@00c0ffee/nodes")).expect("a directory");
    // Objects of a killed run without its directory.
    let prefix = format!("/dev/shm/rcs-{:08x}_", std::process::id());
    let objects = ["alive.rcs-run", "x.blackboard"].map(|name| format!("{prefix}{name}"));
    objects.iter().for_each(|object| fs::write(object, "old").expect("an object"));
    objects
        .iter()
        .for_each(|object| fs::set_permissions(object, Permissions::from_mode(0o600)).expect("it is ours"));
    fs::write(root.join("file-1@00c0ffee"), "a file").expect("a file"); // looks like a run; the next does not
    std::os::unix::fs::symlink("/nowhere", root.join("link-1@00c0ffee")).expect("a link");
    fs::create_dir_all(root.join("no run at all")).expect("a directory");
    let run = |arguments: &[&str]| {
        Ended::of(&rcs(&tmp, arguments).env("RCS_RUNS", &tmp).output().expect("rcs-run can be started"))
    };
    let arguments = job("linkbar");
    let more = ["--ticks", "30", "--log", "none"];
    let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more).collect();
    run(&all).assert_shared();
    assert_eq!(run(&["clean"]).status, Some(0));
    assert!(objects.iter().all(|object| !Path::new(object).exists()));
    let left = fs::read_dir(&root).expect("the directory of runs").flatten().map(|entry| entry.file_name());
    let mut left: Vec<_> = left.map(|name| name.to_string_lossy().into_owned()).collect();
    left.sort();
    assert_eq!(left, ["lock", "no run at all", "salt"], "only directories of runs are removed");
}

#[test]
fn a_full_disk_ends_the_log_and_not_the_run() {
    let scratch = Scratch::new("full-disk");
    let ended = Ended::run(&scratch.file(""), "linkbar", &["--ticks", "500", "--log", "small/run.mcap"]);
    assert_eq!(ended.status, Some(0), "the directory of a log is made: {}", ended.said);
    let mount = "mkdir -p tiny && mount -t tmpfs -o size=512k tmpfs tiny";
    let more = ["--ticks", "2000", "--log", "tiny/run.mcap"];
    let Some(ended) = apart(&scratch.file(""), mount, &more) else {
        eprintln!("no right to mount: a full disk cannot be tried");
        return;
    };
    assert_eq!((ended.status, ended.number("ticks")), (Some(0), 2000), "{}", ended.said);
    assert!(ended.said.contains("the log ended before the run did"), "{}", ended.said);
}

#[test]
fn truncated_log_is_reported_and_does_not_end_the_run() {
    let scratch = Scratch::new("cut-log");
    let more = ["--clock", "real", "--ticks", "100", "--log", "run.mcap"];
    let mut run = Running::start(&scratch.file(""), "linkbar", &more);
    let reader = run.attach();
    run.reach(&reader, 40);
    let log = fs::File::options().write(true).open(scratch.file("run.mcap")).expect("the log is there");
    let length = log.metadata().expect("a file").len();
    assert!(length > 1_000, "{length} bytes after 40 ticks");
    log.set_len(length / 2).expect("it can be cut");
    drop(reader);
    let ended = run.end();
    assert_eq!((ended.status, ended.number("ticks")), (Some(0), 100), "{}", ended.said);
    let cut = format!("another program cut the file to {} bytes", length / 2);
    for words in ["the log ended before the run did", &cut] {
        assert!(ended.said.contains(words), "{words}: {}", ended.said);
    }
}

#[test]
fn removed_log_is_reported_and_does_not_end_the_run() {
    let scratch = Scratch::new("removed");
    let more = ["--clock", "real", "--ticks", "100", "--log", "logs/run.mcap"];
    let mut run = Running::start(&scratch.file(""), "linkbar", &more);
    let reader = run.attach();
    run.reach(&reader, 20);
    fs::remove_dir_all(scratch.file("logs")).expect("it can be removed");
    drop(reader);
    let ended = run.end();
    assert_eq!((ended.status, ended.number("ticks")), (Some(0), 100), "{}", ended.said);
    assert!(ended.said.contains("the log ended before the run did"), "{}", ended.said);
}
