//! Ends the console when its terminal disappears: a closed window, a lost connection, `tmux kill-session`.
//!
//! The library that reads keys would try again forever, so a thread waits for the hang-up.

use std::{
    fs::File,
    io::{self, IsTerminal},
    os::fd::AsFd,
    process, thread,
};

use rustix::{
    event::{PollFd, PollFlags, poll},
    io::Errno,
};

const NO_TERMINAL: i32 = 1; // exit status of a console whose terminal has disappeared

/// End this program at once when the keyboard's terminal disappears. A run detects the end of the session.
pub fn end_with_terminal() -> io::Result<()> {
    // The library that reads keys selects the terminal in the same way.
    let keyboard =
        if io::stdin().is_terminal() { None } else { Some(File::options().read(true).open("/dev/tty")?) };
    let wait = move || {
        let gone = match &keyboard {
            Some(file) => wait_for_hang_up(file),
            None => wait_for_hang_up(io::stdin()),
        };
        if gone.is_ok() {
            // The terminal cannot be restored, and nobody can read a message.
            process::exit(NO_TERMINAL);
        }
    };
    thread::Builder::new().name("hang-up".into()).spawn(wait).map(drop)
}

/// Wait until the other end of a terminal is closed.
fn wait_for_hang_up(terminal: impl AsFd) -> io::Result<()> {
    loop {
        // Without requested events, only hang-ups and errors are reported.
        let mut polled = [PollFd::new(&terminal, PollFlags::empty())];
        match poll(&mut polled, None) {
            Ok(_) => return Ok(()),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
