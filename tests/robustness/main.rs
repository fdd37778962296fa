//! Attacks logs, shared memory, readers, signals and disks, and judges each case.
//!
//! ```text
//! cargo run --release -p whole-system-tests --bin robustness -- --help
//! cargo run --release -p whole-system-tests --bin robustness -- --markdown runs/robustness.md
//! ```
//!
//! It prints the number of cases by outcome, and each finding on standard error; with a finding the exit status is 1.
//! The tests `survival::campaign` run a sample; docs/evidence.md has the sums. All attacks take place in a separate
//! `/dev/shm` and `RCS_RUNS`.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program of the developers, at a terminal")]

mod disks;
mod logs;
mod memory;
mod processes;
mod readers;
mod runs;
mod signals;
mod table;

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
    sync::{Arc, atomic::AtomicBool},
    time::Instant,
};

use clap::{Parser, ValueEnum};
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGQUIT},
    flag,
};
use whole_system_tests::Scratch;

use crate::{
    processes::Process,
    table::{Extent, Row},
};

/// Treat logs, shared memory, readers, signals and disks badly, and count how the programs take it
#[derive(Parser)]
struct Arguments {
    /// Parts to try; all if none is named
    #[arg(value_enum)]
    parts: Vec<Part>,
    /// Try a few cases of each row, as the ordinary tests do
    #[arg(long)]
    sample: bool,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1988)]
    seed: u64,
    /// Write the table to FILE as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Be one of the processes that attack a run
    #[arg(long, hide = true, value_enum)]
    process: Option<Process>,
    /// The run that is attacked
    #[arg(long, hide = true, default_value = "")]
    run: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Damaged logs, within 1 GB of memory
    Logs,
    /// Garbage in the shared memory of runs
    Memory,
    /// Readers that are killed or stopped
    Readers,
    /// Signals in all phases of a run
    Signals,
    /// Disks and shared memory that fill, limits of files
    Disks,
}

impl Part {
    fn rows(self, extent: Extent) -> Vec<Row> {
        match self {
            Self::Logs => logs::rows(extent),
            Self::Memory => memory::rows(extent),
            Self::Readers => readers::rows(extent),
            Self::Signals => signals::rows(extent),
            Self::Disks => disks::rows(extent),
        }
    }

    /// Other runs of this user, or the machine, would be harmed.
    const fn needs_private_memory(self) -> bool {
        matches!(self, Self::Memory | Self::Readers | Self::Disks)
    }
}

const PRIVATE: &str = "RCS_PRIVATE_MEMORY"; // set in a process with its own `/dev/shm`
/// Shell commands before a program.
const MOUNT: &str = "mount -t tmpfs -o size=512m,mode=1777 tmpfs /dev/shm && exec \"$@\"";

fn private_memory(scratch: &Scratch) -> Option<Command> {
    let command = |flags: &[&str], program: &Path| {
        let mut command = Command::new("unshare");
        command.args(flags).args(["sh", "-c", MOUNT, "sh"]).arg(program);
        command
    };
    let ways: [&[&str]; 2] = [&["--mount"], &["--mount", "--map-root-user"]];
    let works = |flags: &&[&str]| {
        let tried = command(flags, Path::new("true")).output();
        tried.is_ok_and(|output| output.status.success())
    };
    let flags = ways.into_iter().find(works)?;
    let own = env::current_exe().expect("a program has a path");
    let mut command = command(flags, &own);
    command.args(env::args_os().skip(1)).env(PRIVATE, "1").env("RCS_RUNS", scratch.file(""));
    Some(command)
}

/// Children inherit ignored signals, as under `nohup`, but not handlers. These act like the default.
fn hear_signals() {
    for signal in [SIGHUP, SIGINT, SIGQUIT] {
        let always = Arc::new(AtomicBool::new(true));
        flag::register_conditional_default(signal, always).expect("a handler can be installed");
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    hear_signals();
    if let Some(process) = arguments.process {
        return process.be(&arguments.run);
    }
    let private = env::var_os(PRIVATE).is_some();
    if !private {
        let scratch = Scratch::new("robustness");
        if let Some(mut command) = private_memory(&scratch) {
            let status = command.status().expect("it could be started before");
            return if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
        }
    }
    let extent = Extent { sample: arguments.sample, seed: arguments.seed };
    let asked = if arguments.parts.is_empty() { Part::value_variants() } else { &arguments.parts };
    // A panic of the judge becomes a finding.
    std::panic::set_hook(Box::new(|_| {}));
    let (mut rows, began) = (Vec::new(), Instant::now());
    for part in asked {
        if part.needs_private_memory() && !private {
            println!("{part:?}: skipped, this user can have no /dev/shm of its own (unshare --mount)");
            continue;
        }
        eprintln!("{part:?} ... {} s", began.elapsed().as_secs());
        rows.extend(part.rows(extent));
    }
    print!("{}", table::plain(&rows));
    if let Some(file) = &arguments.markdown
        && let Err(error) = fs::write(file, table::markdown(&rows))
    {
        eprintln!("{}: {error}", file.display());
        return ExitCode::from(2);
    }
    let findings: Vec<&String> = rows.iter().flat_map(|row| &row.findings).collect();
    findings.iter().for_each(|finding| eprintln!("not held: {finding}"));
    if findings.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
