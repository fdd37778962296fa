//! `rcs-gateway`: carries the mailboxes of a controller between machines, over Zenoh with TLS. See README.md.
//!
//! ```text
//!   neighbour -- Unix -- rcs-gateway connect == TLS, direct == rcs-gateway serve -- Unix -- rcs-run
//! ```

#![forbid(unsafe_code)]

mod address;
mod budget;
mod cli;
mod config;
mod connect;
mod end;
mod error;
mod inbox;
mod keys;
mod keyspace;
mod lines;
mod log;
mod monitor;
mod pace;
mod page;
mod person;
mod refusal;
mod relay;
mod router;
mod sample;
mod serve;
mod signals;
mod status;

use std::process::ExitCode;

use clap::Parser as _;
use os_io::stderr_line;

use crate::cli::{Cli, Command};

/// Unless compiled with this variable, Zenoh accepts no connection for 100 ms after each failed handshake.
const _: () = assert!(
    matches!(option_env!("TLS_ACCEPT_THROTTLE_TIME"), Some(time) if matches!(time.as_bytes(), b"0")),
    "build inside the repository, so that cargo reads .cargo/config.toml: it sets TLS_ACCEPT_THROTTLE_TIME=0"
);

const UNUSABLE: u8 = 2; // exit status of a usage error, or of keys and addresses that cannot be used

fn main() -> ExitCode {
    let cli = Cli::parse();
    log::log_zenoh_warnings();
    let result = match &cli.command {
        Command::Serve(arguments) => serve::serve(arguments),
        Command::Connect(arguments) => connect::connect(arguments),
        Command::Router(arguments) => router::route(arguments),
        Command::Monitor(arguments) => monitor::monitor(arguments),
        Command::Page(arguments) => page::page(arguments),
        Command::Person(command) => person::run(command),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            stderr_line!("rcs-gateway: {error}");
            ExitCode::from(UNUSABLE)
        }
    }
}
