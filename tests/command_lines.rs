//! The installed programs: they need no other files, and their pages follow from their definitions.

use std::{
    env, fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;
use whole_system_tests::{Scratch, rcs_cell, rcs_console, rcs_log, rcs_neighbour, rcs_run, root};

const TOP: &str = "# Command lines\n\n\
    This page is made from the definitions of the programs. Each program prints its own part with `--help`;\n\
    `PROGRAM --generate DIR` writes manual pages and shell completions ([install](install.md)).\n\n";

fn in_directory(program: &Path, directory: &Path, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).current_dir(directory).output().expect("the program can be started")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_page_of_the_command_lines_matches_the_programs() {
    let mut page = TOP.to_owned();
    for program in [rcs_run(), rcs_log(), rcs_console(), rcs_cell(), rcs_neighbour()] {
        let scratch = Scratch::new("pages");
        let made = in_directory(program, &scratch.file("."), &["--generate", "pages"]);
        assert!(made.status.success(), "{}", text(&made.stderr));
        let name = program.file_name().expect("a program has a name").to_string_lossy().into_owned();
        let read =
            |file: String| fs::read_to_string(scratch.file("pages").join(file)).expect("the file is made");
        assert!(read(format!("man/{name}.1")).contains(".TH"), "{name} has a manual page");
        assert!(read(format!("completions/{name}.bash")).contains("COMPREPLY"), "{name} has completions");
        // The page has one title; each program is a section.
        for line in read(format!("{name}.md")).lines() {
            page += &if line.starts_with('#') { format!("#{line}\n") } else { format!("{line}\n") };
        }
    }
    let file = root().join("docs/cli.md");
    if env::var_os("RCS_PAGES").is_some() {
        fs::write(&file, &page).expect("the page can be written");
    }
    let kept = fs::read_to_string(&file).expect("the page is there");
    assert!(
        kept == page,
        "docs/cli.md is old: RCS_PAGES=write cargo test --release -p whole-system-tests --test runs command_lines"
    );
}

#[test]
fn a_program_runs_in_an_empty_directory() {
    let scratch = Scratch::new("empty");
    let run = |arguments: &[&str]| in_directory(rcs_run(), &scratch.file("."), arguments);
    for boards in ["one", "split"] {
        let short = run(&["--ticks", "100", "--log", "none", "--boards", boards, "--json"]);
        assert_eq!(short.status.code(), Some(0), "{}", text(&short.stderr));
    }
    let checked = run(&["check"]);
    assert_eq!(checked.status.code(), Some(0), "{}{}", text(&checked.stdout), text(&checked.stderr));
    let failed = run(&["--faults", "data/faults/blank-missing.toml"]);
    assert_eq!(failed.status.code(), Some(1), "{}", text(&failed.stderr));
    assert!(text(&failed.stderr).contains("vision sees no object"), "{}", text(&failed.stderr));
    assert!(!scratch.file("data").exists());
    assert!(text(&failed.stdout).contains("data       built into the program, "), "{}", text(&failed.stdout));
    let info = in_directory(rcs_log(), &scratch.file("."), &["info", "runs/linkbar.mcap"]);
    assert!(text(&info.stdout).contains("data       built into the program, "), "{}", text(&info.stdout));
    let why = in_directory(rcs_log(), &scratch.file("."), &["why", "runs/linkbar.mcap"]);
    assert!(text(&why.stdout).contains("LOCATE-OBJ"), "{}", text(&why.stdout));
}

#[test]
fn named_directory_must_exist() {
    let scratch = Scratch::new("named");
    let run = in_directory(rcs_run(), &scratch.file("."), &["--data", "elsewhere"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(text(&run.stderr).contains("there is no task data directory elsewhere"), "{}", text(&run.stderr));
}

#[test]
fn built_in_data_are_used_if_named_or_without_a_directory() {
    let scratch = Scratch::new("built-in");
    let run = |arguments: &[&str]| in_directory(rcs_run(), &scratch.file("."), arguments);
    let short = |more: &[&str]| {
        let output = run(&[&["--ticks", "3", "--log", "none", "--json"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).expect("a result")["data"].take()
    };
    assert_eq!(short(&[])["directory"], Value::Null);
    let refused = run(&["--data", "data"]); // a directory given as an option must exist, also the default one
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("no task data directory data; built-in names"));
    let at_port = ["--robot", "serial:/dev/null", "--clock", "real"]; // a robot at a port is in its own cell
    let refused = run(&at_port);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("with --data built-in"), "{}", text(&refused.stderr));
    let named = run(&[&at_port[..], &["--data", "built-in"]].concat());
    assert!(text(&named.stderr).contains("is not a terminal device"), "{}", text(&named.stderr));
    let made = run(&["init", "."]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let own = short(&[]);
    assert!(own["directory"].as_str().is_some_and(|path| path.starts_with('/') && path.ends_with("/data")));
    let built_in = short(&["--data", "built-in"]);
    assert_eq!((&built_in["directory"], &built_in["files"]), (&Value::Null, &own["files"]));
}

#[test]
fn completions_know_jobs_faults_robots_and_interruptions() {
    let scratch = Scratch::new("completions");
    let made = in_directory(rcs_run(), &scratch.file("."), &["--generate", "pages"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    for shell in ["rcs-run.bash", "_rcs-run", "rcs-run.fish"] {
        let completions =
            fs::read_to_string(scratch.file("pages/completions").join(shell)).expect("the file is made");
        for name in ["turned-part", "lock-ring-stuck", "irb6700", "answer-late", "fault:lock-ring-stuck"] {
            // Shells need escapes.
            assert!(completions.replace('\\', "").contains(name), "{name} in {shell}");
        }
    }
}

#[test]
fn option_data_has_the_same_words_in_all_commands() {
    let commands: [(&Path, &[&str]); 8] = [
        (rcs_run(), &["check"]),
        (rcs_run(), &["jobs"]),
        (rcs_run(), &["pose"]),
        (rcs_run(), &["campaign"]),
        (rcs_run(), &["new", "part"]),
        (rcs_run(), &["new", "tray"]),
        (rcs_cell(), &[]),
        (rcs_neighbour(), &["workstation"]),
    ];
    for (program, words) in commands {
        let help = text(&in_directory(program, root(), &[words, &["--help"]].concat()).stdout);
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        let expected =
            "--data <DIR> Directory with task data, cell.toml, jobs, faults and robots [default: data;";
        assert!(help.contains(expected), "{words:?}: {help}");
    }
}

#[test]
fn a_copy_of_the_data_can_be_changed() {
    let scratch = Scratch::new("init");
    let run = |arguments: &[&str]| in_directory(rcs_run(), &scratch.file("."), arguments);
    let made = run(&["init", "."]);
    assert!(text(&made.stdout).ends_with("check them with rcs-run check\n"), "{}", text(&made.stdout));
    let outside = run(&["check", "."]);
    assert_eq!(outside.status.code(), Some(2));
    let near = ". has no cell.toml, ./data has one: name ./data";
    assert!(text(&outside.stderr).contains(near), "{}", text(&outside.stderr));
    let job = scratch.file("data/jobs/linkbar.job");
    let changed = fs::read_to_string(&job).expect("the job is written").replace("LINKBAR1_BH", "LINKBAR9_BH");
    fs::write(&job, changed).expect("the job can be changed");
    let refused = run(&["--log", "none"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("LINKBAR9_BH"), "{}", text(&refused.stderr));
    let again = run(&["init", "."]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("already exists"), "{}", text(&again.stderr));
}

#[test]
fn each_program_prints_its_version() {
    for program in [rcs_run(), rcs_log(), rcs_console(), rcs_cell(), rcs_neighbour()] {
        let said = text(&in_directory(program, root(), &["--version"]).stdout);
        assert!(said.contains(env!("CARGO_PKG_VERSION")), "{said}");
    }
}

#[test]
fn a_mistyped_word_or_path_is_named_once_with_its_nearest_name() {
    let place = Scratch::new("mistyped");
    let (here, log) = (place.file("."), place.file("run.mcap"));
    let run = in_directory(
        rcs_run(),
        &here,
        &["vise-and-back", "--ticks", "3", "--shared-memory", "off", "--log", &log.to_string_lossy()],
    );
    assert!(run.status.success(), "{}", text(&run.stderr));
    for (program, arguments, wrong, near) in [
        (rcs_log(), &["inof"] as &[&str], "'inof'", "similar subcommand exists: 'info'"),
        (rcs_run(), &["sned", "stop"], "'sned'", "similar subcommand exists: 'send'"),
        (rcs_run(), &["chekc", "--all"], "--all", "similar subcommand exists: 'check'"),
        (rcs_neighbour(), &["workstaton"], "'workstaton'", "similar subcommand exists: 'workstation'"),
        (
            rcs_neighbour(),
            &["workstation", "--network", "unix:/nowhere", "linkbra"],
            "there is no job linkbra",
            "the nearest is linkbar",
        ),
        (rcs_log(), &["info", "rnu.mcap"], "rnu.mcap: No such file", "the nearest log is run.mcap"),
        (
            rcs_console(),
            &["--log", "rnu.mcap", "--once", "ladder"],
            "rnu.mcap: No such",
            "the nearest log is run.mcap",
        ),
        (rcs_run(), &["--seed", "abc"], "'abc' for '--seed <N>'", "a whole number was expected"),
        (rcs_run(), &["--robot", "egm:sim,robto=same"], "no option robto", "the nearest is robot"),
        (rcs_log(), &["replay", "rnu.mcap"], "rnu.mcap: No such file", "the nearest log is run.mcap"),
        (rcs_log(), &["serve", "nowhere/x.mcap"], "nowhere/x.mcap: No such file", "os error 2"),
        (
            rcs_neighbour(),
            &["workstation", "--network", "unix:/nowhere", "--wait", "3"],
            "waiting for a controller, 3 s at most",
            "unix:/nowhere: No such file",
        ),
        (rcs_run(), &["send", "--stay", "1m", "stop"], "--stay", "seconds from 0 to 86400 were expected"),
        (
            rcs_run(),
            &["send", "--stay", "1.5", "--run", "none", "status"],
            "there is no run named none",
            "named none: ",
        ),
    ] {
        let output = in_directory(program, &here, arguments);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_ne!(output.status.code(), Some(0), "{arguments:?}");
        for expected in [wrong, near] {
            assert!(said.contains(expected), "{arguments:?}: {said}");
        }
        if arguments.len() < 3 {
            assert_eq!((said.matches(wrong).count(), said.matches(near).count()), (1, 1), "{said}");
        }
    }
}
