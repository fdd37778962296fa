//! `rcs-run`: the RCS-II/T3 controller with its simulated cell.
//!
//! [`cli`] is the command line; each subcommand is a module. `run` carries out a run of the library `runtime`; with
//! `--boards split` processes of `board` share the work. `link_test` tests the line to a robot, [`campaign`]
//! interrupts a job at many ticks, [`new`] makes data for a new part, tool, place or tray.

#![deny(unsafe_code)]

mod answer;
mod arguments;
mod board;
pub mod campaign;
mod check;
mod clean;
pub mod cli;
mod clock;
mod console;
pub mod error;
mod explain;
mod init;
mod interrupt;
mod io;
mod jobs;
mod last_lines;
mod latency;
mod link_test;
pub mod memory_fault;
pub mod new;
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

use self::{
    cli::{Cli, Command},
    error::Error,
};

/// Fails if the command could not begin, or its answer could not be written.
pub fn execute(cli: Cli) -> Result<ExitCode, Error> {
    match cli.command {
        None => run::run(&cli.run),
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Board(arguments)) => board::board(&arguments),
        Some(Command::LinkTest(arguments)) => link_test::link_test(&arguments),
        Some(Command::IoTest(arguments)) => io::test(&arguments),
        Some(Command::IoRelease(arguments)) => io::release(&arguments),
        Some(Command::IoCalibrate(arguments)) => io::calibrate(&arguments),
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
