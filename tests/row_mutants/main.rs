//! Changes rows of the decision tables of `crates/levels`, one at a time, and counts which changes the tests of
//! that crate notice. `cargo-mutants` does not look into `decision_table!`.
//!
//! ```text
//! cargo run --release -p whole-system-tests --bin row-mutants -- --help
//! cargo run --release -p whole-system-tests --bin row-mutants -- --number 60
//! cargo run --release -p whole-system-tests --bin row-mutants -- --own --only levels/src/grip
//! ```
//!
//! All changes that [`mutate`] knows are drawn in an order that the seed gives. One that does not compile is
//! counted and does not stand for a row: the table is not total any more, has a dead row, or the names do not
//! fit. One that compiles is *killed* if a test fails or does not end, and has *survived* otherwise: first the
//! tests of the process whose table it is are run, then all of `levels`. Each of them is printed as a line, a
//! survivor as a difference. The repository is copied to `target/row-mutants/source` first; tests are built
//! with little optimisation, which is sooner done, and draw fewer random cases.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program of the developers, at a terminal")]

mod mutate;

use std::{
    collections::HashMap,
    fs,
    os::unix::process::CommandExt as _,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
    thread,
    time::{Duration, Instant},
};

use clap::Parser;
use mutate::Mutant;
use rustix::process::{Pid, Signal, kill_process_group};
use whole_system_tests::root;

/// Change rows of decision tables one at a time, and count which changes the tests of `levels` notice
#[derive(Parser)]
struct Arguments {
    /// Changed rows that compile to try
    #[arg(long, value_name = "N", default_value_t = 60)]
    number: usize,
    /// Seed of the order in which changes are drawn
    #[arg(long, value_name = "N", default_value_t = 1988)]
    seed: u64,
    /// Only tables in files whose path contains TEXT
    #[arg(long, value_name = "TEXT", default_value = "")]
    only: String,
    /// Run only the tests of the process whose table is changed: survivors may be killed by others
    #[arg(long)]
    own: bool,
}

/// What became of a changed row.
enum Fate {
    Refused,
    Killed,
    Survived,
}

/// A copy of the repository, and where it is built.
struct Copied {
    source: PathBuf,
    target: PathBuf,
    /// What the tests of each process may take, and what all may: three times what they take without a change,
    /// and a minute.
    patience: HashMap<Option<String>, Duration>,
}

impl Copied {
    /// Copy all files that git knows, but only those that differ: what is built already stays fresh.
    fn of(root: &Path) -> std::io::Result<Self> {
        let scratch = root.join("target/row-mutants");
        let copied =
            Self { source: scratch.join("source"), target: scratch.join("target"), patience: HashMap::new() };
        let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root).output()?;
        for name in listed.stdout.split(|byte| *byte == 0).filter(|name| !name.is_empty()) {
            let name = String::from_utf8_lossy(name).into_owned();
            let (from, to) = (root.join(&name), copied.source.join(&name));
            // A file that git knows may have been deleted.
            let Ok(content) = fs::read(from) else { continue };
            if fs::read(&to).ok().as_ref() != Some(&content) {
                fs::create_dir_all(to.parent().unwrap_or(&to))?;
                fs::write(to, content)?;
            }
        }
        Ok(copied)
    }

    fn cargo(&self, more: &[&str]) -> Command {
        let mut command = Command::new("cargo");
        command.args(["test", "--quiet", "--package", "levels"]);
        for package in ["levels", "geometry", "rcs-core", "depc", "interfaces"] {
            let profile = format!("profile.dev.package.{package}");
            command.args(["--config", &format!("{profile}.opt-level=1")]);
            command.args(["--config", &format!("{profile}.debug=false")]);
        }
        command.args(more);
        command.current_dir(&self.source).env("CARGO_TARGET_DIR", &self.target).env("CARGO_INCREMENTAL", "1");
        // The same random cases for each change.
        command.env("PROPTEST_RNG_SEED", "1988").env("PROPTEST_CASES", "16").env("RCS_MOVES", "2000");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn builds(&self) -> std::io::Result<bool> {
        Ok(self.cargo(&["--lib", "--no-run"]).status()?.success())
    }

    /// Do the tests of a process pass in time, or all?
    fn passes(&self, process: Option<&str>) -> std::io::Result<bool> {
        let arguments = process.map_or(vec!["--lib", "--tests"], |process| vec!["--lib", "--", process]);
        let patience = self.patience.get(&process.map(str::to_owned));
        let (mut child, began) = (self.cargo(&arguments).process_group(0).spawn()?, Instant::now());
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok(status.success());
            }
            if patience.is_some_and(|patience| began.elapsed() > *patience) {
                // The test that cargo has started does not end with it.
                let group = Pid::from_child(&child);
                kill_process_group(group, Signal::KILL)?;
                child.wait()?;
                return Ok(false);
            }
            thread::sleep(Duration::from_millis(50));
        }
    }

    fn judge(&self, mutant: &Mutant, own: bool) -> std::io::Result<Fate> {
        let file = self.source.join(&mutant.file);
        let before = fs::read_to_string(&file)?;
        fs::write(&file, mutant.apply(&before))?;
        let fate = if !self.builds()? {
            Fate::Refused
        } else if self.passes(Some(&mutant.process()))? && (own || self.passes(None)?) {
            Fate::Survived
        } else {
            Fate::Killed
        };
        fs::write(&file, before)?;
        Ok(fate)
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let said = |error: std::io::Error| error.to_string();
    let mut copied = Copied::of(root()).map_err(said)?;
    let mutants = mutate::drawn(&copied.source, arguments.seed, &arguments.only).map_err(said)?;
    if mutants.is_empty() {
        return Err(format!("no file with a table has {:?} in its path", arguments.only));
    }
    eprintln!("{} changes of rows are known", mutants.len());
    if !copied.builds().map_err(said)? {
        return Err("levels does not build without a change".to_owned());
    }
    let mut parts: Vec<Option<String>> = mutants.iter().map(|mutant| Some(mutant.process())).collect();
    parts.sort_unstable();
    parts.dedup();
    parts.extend((!arguments.own).then_some(None));
    for part in parts {
        let began = Instant::now();
        if !copied.passes(part.as_deref()).map_err(said)? {
            return Err(format!("tests fail without a change: {}", part.as_deref().unwrap_or("all")));
        }
        copied.patience.insert(part, began.elapsed() * 3 + Duration::from_secs(60));
    }
    let started = Instant::now();
    let [mut refused, mut killed, mut survived] = [0_usize; 3];
    for mutant in &mutants {
        if killed + survived == arguments.number {
            break;
        }
        match copied.judge(mutant, arguments.own).map_err(said)? {
            Fate::Refused => refused += 1,
            Fate::Killed => {
                killed += 1;
                println!("killed    {mutant}");
            }
            Fate::Survived => {
                survived += 1;
                println!("SURVIVED  {mutant}\n  - {}\n  + {}", mutant.before.trim(), mutant.after.trim());
            }
        }
    }
    println!(
        "{} s, seed {}: {} changed rows compile, {killed} killed, {survived} survived; the compiler refused {refused} more",
        started.elapsed().as_secs(),
        arguments.seed,
        killed + survived
    );
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
