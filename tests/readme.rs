//! The `console` blocks of README and tutorials are run as written, one after the other. `...` matches any lines, and
//! at the end of a line its rest. Numbers that depend on the machine are not compared.

use std::{fs, os::unix::fs::symlink, process::Command as Process};

use whole_system_tests::{Scratch, rcs_log, rcs_run, root};

fn comparable(line: &str) -> String {
    let depends = match line.split_once(';') {
        Some((times, _)) if line.starts_with("controller ") => times.len(),
        _ if line.contains(" x real time") => line.len(),
        _ => 0,
    };
    let (times, same) = line.trim_end().split_at(depends.min(line.trim_end().len()));
    times
        .chars()
        .filter(|character| !character.is_ascii_digit() && *character != '.')
        .chain(same.chars())
        .collect()
}

fn assert_shown(command: &str, expected: &[&str], output: &str) {
    let mut lines = output.lines().map(comparable);
    let mut gap = false;
    for sample in expected {
        if *sample == "..." {
            gap = true;
            continue;
        }
        let (sample, is_begun) = sample.strip_suffix("...").map_or((*sample, false), |front| (front, true));
        let sample = comparable(sample);
        let is_it = |line: &String| if is_begun { line.starts_with(&sample) } else { *line == sample };
        let found = if gap { lines.by_ref().find(is_it) } else { lines.next().filter(is_it) };
        assert!(found.is_some(), "`{command}` does not print `{sample}` there, but\n{output}");
        gap = false;
    }
    assert!(gap || lines.next().is_none(), "`{command}` prints more than the sample:\n{output}");
}

/// A text between apostrophes is one word.
fn words(command: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for character in command.chars() {
        match character {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            character => words.last_mut().expect("there is one").push(character),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The process of a command: a program of this workspace, or one of the shell's.
fn process(command: &str) -> Process {
    let Some(rest) = command.strip_prefix("cargo run --release") else {
        let mut shell = Process::new("sh");
        shell.args(["-c", command]);
        return shell;
    };
    let (program, arguments) = match rest.trim().split_once("-- ") {
        Some(("--bin rcs-log ", arguments)) => (rcs_log(), arguments),
        Some(("", arguments)) => (rcs_run(), arguments),
        _ => (rcs_run(), rest),
    };
    let mut process = Process::new("sh"); // both outputs in one stream, as on a terminal
    process.args(["-c", r#"exec "$0" "$@" 2>&1"#]).arg(program).args(words(arguments));
    process
}

/// Runs the samples of a page with the shipped data and viewers. Returns their number.
fn run_samples(page: &str) -> usize {
    let text = fs::read_to_string(root().join(page)).expect("the page is there");
    let scratch = Scratch::new("samples");
    for shipped in ["data", "viewers"] {
        symlink(root().join(shipped), scratch.file(shipped)).expect("there is room for a link");
    }
    let blocks = text.split("```console\n").skip(1).filter_map(|rest| rest.split_once("```"));
    let mut run = 0;
    for (block, _) in blocks {
        for sample in block.split("$ ").skip(1) {
            let (command, expected) = sample.split_once('\n').expect("a command is a line");
            let output =
                process(command).current_dir(scratch.file(".")).output().expect("the program can be started");
            let text = [output.stdout, output.stderr].concat();
            let expected: Vec<&str> = expected.lines().collect();
            assert_shown(command, &expected, &String::from_utf8_lossy(&text));
            run += 1;
        }
    }
    run
}

#[test]
fn samples_of_the_readme_match_the_output() {
    assert_eq!(run_samples("README.md"), 3, "the README shows a run, a failure and why");
}

#[test]
fn samples_of_the_page_about_forks_match_the_output() {
    assert_eq!(run_samples("docs/fork.md"), 6, "the page shows a run, four forks and a comparison");
}

#[test]
fn samples_of_the_first_tutorial_match_the_output() {
    assert_eq!(run_samples("docs/start.md"), 8, "the page shows runs, changes, a failure and a pose");
}

#[test]
fn samples_of_the_tutorial_on_failures_match_the_output() {
    assert_eq!(
        run_samples("docs/explain-a-failure.md"),
        8,
        "the page shows two failures, their causes and a remedy"
    );
}

#[test]
fn samples_of_the_tutorial_on_new_parts_match_the_output() {
    assert_eq!(
        run_samples("docs/teach-a-part.md"),
        16,
        "the page makes a part, shows its data, and breaks them"
    );
}

#[test]
fn sample_of_the_page_about_forms_matches_the_output() {
    assert_eq!(run_samples("docs/forms.md"), 1, "the page shows the path of a command");
}
