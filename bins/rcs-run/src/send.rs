//! `rcs-run send`: sends requests to a run in progress, as an operator.

use std::process::ExitCode;

use executive::memory::{Attached, SharedMemoryError, operator_socket, starting};
use os_io::{console, stderr_line};
use sessions::{network::connect_operator, operator::Client};

use crate::rcs_run::{
    arguments::SendArguments,
    error::{Error, FAILED},
    status::only_run,
};

/// Open a session with a run of this user, or with one behind a gateway.
fn connect(arguments: &SendArguments) -> Result<Client, Error> {
    let Some(address) = &arguments.connect else {
        let run = arguments.run.clone().map_or_else(only_run, Ok)?;
        if let Some(phase) = starting(&run) {
            return Err(SharedMemoryError::Starting { run, phase }.into());
        }
        let socket = operator_socket(&run);
        if !socket.exists() {
            // A run without operators has no socket: connecting then fails with the reason.
            Attached::open(&run)?;
        }
        return Ok(Client::connect(&socket, &arguments.name)?);
    };
    Ok(Client::over(connect_operator(address)?, &arguments.name)?)
}

/// Send the requests in order, and print the answers. A refused request ends the command with exit status 1.
pub fn send(arguments: &SendArguments) -> Result<ExitCode, Error> {
    let mut client = connect(arguments)?;
    for line in &arguments.lines {
        match client.ask(line)? {
            Ok(answer) => console::answer(&format!("{line}: {answer}\n"))?,
            Err(why) => {
                stderr_line!("rcs-run: `{line}` is refused: {why}");
                return Ok(ExitCode::from(FAILED));
            }
        }
    }
    client.stay(arguments.stay)?;
    Ok(ExitCode::SUCCESS)
}
