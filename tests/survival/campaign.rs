//! A sample of the robustness campaign: the same program as for all of it.

use std::process::Command;

use whole_system_tests::bench::ONE_AT_A_TIME;

/// The table of a sample of a part, which has no finding. It says what was skipped.
fn sample(part: &str) -> String {
    let _alone = ONE_AT_A_TIME.lock();
    let output = Command::new(env!("CARGO_BIN_EXE_robustness"))
        .args([part, "--sample"])
        .output()
        .expect("the campaign can be started");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_damaged_log_is_answered_or_refused_in_words() {
    println!("{}", sample("logs"));
}

#[test]
fn garbage_in_shared_memory_harms_no_later_run_and_without_boards_no_bit() {
    println!("{}", sample("memory"));
}

#[test]
fn a_reader_that_dies_or_hangs_changes_nothing() {
    println!("{}", sample("readers"));
}

#[test]
fn a_signal_ends_a_run_in_order_or_leaves_nothing_that_disturbs() {
    println!("{}", sample("signals"));
}

#[test]
fn a_disk_or_memory_that_fills_is_said_and_ends_no_run_in_silence() {
    println!("{}", sample("disks"));
}
