//! `rcs-run`: the RCS-II/T3 controller with its simulated cell.
//!
//! One thread runs the ticks: controller, log hand-off, cell, workstation controller, in this order ([`run`]). With
//! `--boards split` several processes share the controller's work ([`board`]). [`link_test`] tests the line to a robot.
//! The other subcommands check and print task data and decision tables, or clean up after killed runs.

#![deny(unsafe_code)]

mod board;
mod campaign;
mod check;
mod clean;
mod cli;
mod clock;
mod console;
mod error;
mod explain;
mod init;
mod interrupt;
mod jobs;
mod last_lines;
mod latency;
mod link_test;
mod memory_fault;
mod new;
mod page;
mod pose;
mod programs;
mod progress;
mod reach;
mod run;
mod send;
mod status;
mod tables;
mod ways;

use std::process::ExitCode;

use crate::{
    cli::{Cli, Command},
    error::Error,
};
use os_io::{console::stderr_drawn, stderr_line};

// Counts the allocations of the controller; the result of every run contains the count.
#[global_allocator]
static ALLOCATOR: executive::alloc::Counting = executive::alloc::Counting;

fn main() -> ExitCode {
    cli_pages::shipped::carry();
    let cli: Cli = cli_pages::parse();
    let outcome =
        memory_fault::explain().and_then(|()| memory_fault::survive_file_limit()).and_then(|()| execute(cli));
    match outcome {
        Ok(code) => code,
        Err(error) => {
            // The reason is the last line on standard error, after any details.
            let details = error.details();
            if !details.is_empty() {
                stderr_drawn(details.trim_end());
            }
            stderr_line!("rcs-run: {error}");
            ExitCode::from(error.status())
        }
    }
}

/// Print an answer: as one line of JSON, or as text.
fn answer<T: serde::Serialize + std::fmt::Display>(answer: &T, json: bool) -> Result<(), Error> {
    if json {
        let text = serde_json::to_string(answer).map_err(std::io::Error::from)?;
        return Ok(os_io::console::json(&(text + "\n"))?);
    }
    Ok(os_io::console::answer(&answer.to_string())?)
}

/// Print a long answer as JSON on several lines.
fn answer_long_json(answer: &impl serde::Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(answer).map_err(std::io::Error::from)?;
    Ok(os_io::console::json(&(text + "\n"))?)
}

fn execute(cli: Cli) -> Result<ExitCode, Error> {
    match cli.command {
        None => run::run(&cli.run),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Board(arguments)) => board::board(&arguments),
        Some(Command::LinkTest(arguments)) => link_test::link_test(&arguments),
        Some(Command::Check(arguments)) => check::check(&arguments),
        Some(Command::Jobs(arguments)) => jobs::jobs(&arguments),
        Some(Command::Tables) => tables::tables(),
        Some(Command::Latency(arguments)) => latency::latency(&arguments),
        Some(Command::Status(arguments)) => status::status(&arguments),
        Some(Command::Campaign(arguments)) => campaign::campaign(&arguments),
        Some(Command::Send(arguments)) => send::send(&arguments),
        Some(Command::Pose(arguments)) => pose::pose(&arguments),
        Some(Command::Init(arguments)) => init::init(&arguments),
        Some(Command::New(arguments)) => new::new(&arguments),
        Some(Command::Clean) => clean::clean(),
    }
}
