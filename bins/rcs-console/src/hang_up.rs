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
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
};

use crate::rcs_console::error::ConsoleError;

const NO_TERMINAL: i32 = 1; // exit status of a console whose terminal has disappeared

/// End this program at once when the keyboard's terminal disappears. A run detects the end of the session.
pub fn end_with_terminal() -> io::Result<()> {
    let keyboard = Keyboard::open()?;
    let wait = move || {
        if keyboard.has_hung_up(None).is_ok_and(|gone| gone) {
            // The terminal cannot be restored, and nobody can read a message.
            process::exit(NO_TERMINAL);
        }
    };
    thread::Builder::new().name("hang-up".into()).spawn(wait).map(drop)
}

/// The error of a terminal operation, for the user. If the terminal has disappeared, this program ends at once: the
/// library that draws would print a second error there, and abort.
pub fn terminal_error(error: io::Error) -> ConsoleError {
    let now = Some(&Timespec::default());
    if Keyboard::open().and_then(|keyboard| keyboard.has_hung_up(now)).unwrap_or(true) {
        process::exit(NO_TERMINAL);
    }
    ConsoleError::Terminal(error)
}

/// The terminal of the keys, selected as the library that reads keys selects it.
enum Keyboard {
    Input,
    Controlling(File),
}

impl Keyboard {
    fn open() -> io::Result<Self> {
        if io::stdin().is_terminal() {
            return Ok(Self::Input);
        }
        File::options().read(true).open("/dev/tty").map(Self::Controlling)
    }

    /// Wait until the other end of the terminal is closed, at most for `limit`; tell whether it is closed.
    fn has_hung_up(&self, limit: Option<&Timespec>) -> io::Result<bool> {
        let input = io::stdin();
        let terminal = match self {
            Self::Input => input.as_fd(),
            Self::Controlling(file) => file.as_fd(),
        };
        loop {
            // Without requested events, only hang-ups and errors are reported.
            let mut polled = [PollFd::new(&terminal, PollFlags::empty())];
            match poll(&mut polled, limit) {
                Ok(count) => return Ok(count > 0),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }
}
