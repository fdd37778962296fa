//! Attacked runs, and the checks after each.

use std::{fs, path::Path};

use executive::memory::RunName;
use whole_system_tests::bench::{Ended, Running, assert_cleaned, traces, wait_for};

use crate::table::Outcome;

pub const BOARDS: [(&str, &str); 2] = [("one", "one process"), ("split", "five boards")];

pub fn start(directory: &Path, boards: &str, ticks: &str, log: &str) -> Running {
    Running::start(
        directory,
        "linkbar",
        &["--clock", "real", "--boards", boards, "--ticks", ticks, "--log", log],
    )
}

pub fn end(mut run: Running) -> Ended {
    wait_for("the run ends", || run.child.try_wait().expect("a child").is_some());
    wait_for("the boards end", || !lives(&run.name));
    run.end()
}

/// `rcs-run board N --run NAME`.
fn lives(run: &RunName) -> bool {
    let is_board = |line: Vec<u8>| {
        let words: Vec<&[u8]> = line.split(|byte| *byte == 0).collect();
        words.get(1) == Some(&&b"board"[..]) && words.contains(&run.as_str().as_bytes())
    };
    let processes = fs::read_dir("/proc").expect("the system says what runs").flatten();
    processes.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok()).any(is_board)
}

pub fn judge(ended: &Ended) -> Outcome {
    assert!(!ended.said.contains("panicked"), "{}", ended.said);
    match ended.status {
        Some(0) => Outcome::WentOn,
        Some(3) if ended.last_words().contains("was stopped by the user") => Outcome::InOrder,
        Some(1..=3) if ended.last_words().starts_with("rcs-run: ") => Outcome::InWords,
        None => Outcome::BySignal,
        other => panic!("status {other:?}: {}", ended.said),
    }
}

/// With garbage, the set-up must end with a message. In later phases and destructors iceoryx2 may panic.
pub fn judge_damaged(ended: &Ended) -> Outcome {
    let mut panics = ended.said.lines().filter(|line| line.contains("panicked at"));
    let Some(first) = panics.next() else { return judge(ended) };
    assert!(first.contains("/iceoryx2-"), "{}", ended.said);
    match ended.status {
        Some(1..=3) if ended.last_words().starts_with("rcs-run: ") => Outcome::InWords,
        _ => Outcome::BySignal,
    }
}

/// The next run starts and is visible; the remains of the attacked one are gone, and `clean` finds nothing.
pub fn assert_no_harm(directory: &Path, run: &RunName) {
    let next = Ended::run(directory, "linkbar", &["--ticks", "30", "--log", "none"]);
    assert_eq!((next.status, next.number("ticks")), (Some(0), 30), "the next run: {}", next.said);
    next.assert_shared();
    assert_eq!(traces(run), Vec::<std::path::PathBuf>::new(), "the next run removes all remains");
    assert_cleaned(directory, run);
}
