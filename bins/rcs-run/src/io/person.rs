//! The person at the terminal: questions on standard error, answers on standard input.

use std::{
    io::{self, BufRead as _, Write as _},
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    thread,
    time::Duration,
};

/// Reads standard input in a thread, so that a program can exchange data with devices during a question.
pub struct Person {
    lines: Receiver<String>,
}

/// An answer, or the lack of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typed {
    /// A line without white space at its ends, in lower case.
    Line(String),
    /// Nothing yet.
    Nothing,
    /// The input has ended.
    Ended,
}

impl Person {
    pub fn new() -> Self {
        let (sender, lines) = channel();
        thread::spawn(move || {
            let typed = io::stdin().lock().lines().map_while(Result::ok);
            // The receiver is gone when the program ends.
            let _ = typed.map(|line| line.trim().to_lowercase()).try_for_each(|line| sender.send(line));
        });
        Self { lines }
    }

    /// Asks a question. Anything but `y` or `yes` is a no, also the end of the input.
    pub fn ask(&self, question: &str) -> io::Result<bool> {
        prompt(&format!("{question} [y/N] "))?;
        Ok(matches!(self.lines.recv().as_deref(), Ok("y" | "yes")))
    }

    /// Asks for the Enter key. Returns false at the end of the input.
    pub fn wait_for_enter(&self, text: &str) -> io::Result<bool> {
        prompt(&format!("{text}, then press Enter: "))?;
        Ok(self.lines.recv().is_ok())
    }

    /// The next line, if it is typed within `time`.
    pub fn typed_within(&self, time: Duration) -> Typed {
        match self.lines.recv_timeout(time) {
            Ok(line) => Typed::Line(line),
            Err(RecvTimeoutError::Timeout) => Typed::Nothing,
            Err(RecvTimeoutError::Disconnected) => Typed::Ended,
        }
    }
}

/// Writes a text without an end of line on standard error.
pub fn prompt(text: &str) -> io::Result<()> {
    let mut terminal = io::stderr();
    write!(terminal, "{text}")?;
    terminal.flush()
}
