//! SIGSTOP stops a run in real time: skipped slots are counted, attributed, and handled by the selected policy.

use std::{path::Path, thread, time::Duration};

use record::replay;
use rustix::process::{Signal, WaitOptions, waitpid};
use whole_system_tests::{
    Scratch,
    bench::{Ended, Running},
};

const TICKS: &str = "300"; // long enough for a second of punctual ticks, also in parallel with other runs
const STOPPED: Duration = Duration::from_millis(1_000);
const SKIPPED: u64 = 24; // the awaited slot may still be in time

fn stopped_for_a_second(directory: &Path, more: &[&str]) -> Ended {
    let all = [&["--clock", "real", "--ticks", TICKS][..], more].concat();
    let mut run = Running::start(directory, "linkbar", &all);
    let reader = run.attach();
    run.reach(&reader, 40);
    drop(reader);
    run.signal(Signal::STOP);
    let pid = rustix::process::Pid::from_child(&run.child);
    waitpid(Some(pid), WaitOptions::UNTRACED).expect("it is stopped"); // stopped from here on
    thread::sleep(STOPPED);
    run.signal(Signal::CONT);
    run.end()
}

#[test]
fn skipped_slots_are_counted_and_have_no_other_effect() {
    let scratch = Scratch::new("stopped");
    let ended = stopped_for_a_second(&scratch.file(""), &["--log", "none"]);
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let (ticks, skipped) = (ended.number("ticks"), ended.number("overruns"));
    assert!(skipped >= SKIPPED, "{skipped} slots skipped in a second");
    // The grid is unchanged; the result's time is slightly longer.
    let elapsed = ended.result["wall_s"].as_f64().expect("a time");
    assert!((ticks + skipped) as f64 * 0.040 <= elapsed + 0.040, "{}", ended.result);
    let blamed = ended.result["overruns_by"].as_object().expect("a part is to blame");
    assert_eq!(blamed.values().filter_map(serde_json::Value::as_u64).sum::<u64>(), skipped, "{blamed:?}");
    assert!(ended.said.contains("slots of 40 ms skipped: "), "{}", ended.said);
    // In real time the robot ramps down after the last tick.
    let fast = Ended::run(&scratch.file(""), "linkbar", &["--ticks", TICKS, "--log", "none"]);
    assert_eq!(ended.result["digest_before_ramp"], fast.digest(), "the clock changes no bit");
    assert_eq!((fast.number("ramp_ticks"), ended.number("ramp_ticks") > 0), (0, true));
    assert_eq!((fast.number("overruns"), &fast.result["overruns_by"]), (0, &serde_json::Value::Null));
}

#[test]
fn the_robot_holds_and_resumes_and_the_log_replays() {
    let scratch = Scratch::new("holds");
    let ended = stopped_for_a_second(&scratch.file(""), &["--overrun", "hold:5", "--log", "held.mcap"]);
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert!(ended.number("overruns") >= SKIPPED);
    for words in ["the robot holds until 25 ticks in a row were punctual", "punctual again"] {
        assert!(ended.said.contains(words), "{words}: {}", ended.said);
    }
    let report = replay(&scratch.file("held.mcap")).expect("the log can be read");
    assert!(report.is_same(), "holding is an input like any other");
    assert_eq!(report.digest.to_string(), ended.digest());
}

#[test]
fn overrun_policy_stop_ends_the_run_with_status_3() {
    let scratch = Scratch::new("stops");
    let ended = stopped_for_a_second(&scratch.file(""), &["--overrun", "stop:5", "--log", "none"]);
    assert_eq!(ended.status, Some(3), "{}", ended.said);
    assert!(ended.number("ticks") < 150, "{}", ended.result);
    let words = ended.last_words();
    assert!(words.contains("slots of 40 ms skipped") && words.contains("--overrun stop:5"), "{words}");
    assert_eq!(ended.result["failure"]["process"], "executive");
}
