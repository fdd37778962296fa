//! Writes lines to standard output and standard error. No function here panics.
//!
//! | for | call | if the reader has closed the pipe or the terminal | if the write fails otherwise |
//! |---|---|---|---|
//! | a message | [`stderr_line!`](crate::stderr_line) | lost | lost |
//! | a line of a process that continues | [`stdout_line!`](crate::stdout_line) | lost | lost |
//! | the answer of a tool, the result of a run | [`answer`] | no error: the reader has read enough | an error |
//! | an answer for programs | [`json`] | likewise | an error |
//!
//! [`shown`] replaces control characters ([`crate::text`]) and converts quantities to the person's units
//! ([`crate::units`]). A report drawn with colours is already converted, so [`drawn`] and [`stderr_drawn`] write it
//! unchanged.

use std::{
    borrow::Cow,
    fmt::Arguments,
    fs::File,
    io::{self, ErrorKind, Write},
    os::{fd::AsFd as _, unix::fs::FileTypeExt as _},
};

use crate::{
    text::{escaped_json, plain},
    units,
};

const EIO: i32 = 5; // Linux: the terminal has no other end

/// Writes a formatted line to standard error. If the write fails, the line is lost.
#[macro_export]
macro_rules! stderr_line {
    ($($message:tt)*) => { $crate::console::stderr_line(::std::format_args!($($message)*)) };
}

/// Writes a formatted line to standard output. If the write fails, the line is lost and the process continues.
#[macro_export]
macro_rules! stdout_line {
    ($($message:tt)*) => { $crate::console::stdout_line(::std::format_args!($($message)*)) };
}

/// Function behind [`stderr_line!`](crate::stderr_line).
pub fn stderr_line(message: Arguments<'_>) {
    // The error cannot be reported anywhere.
    let _ = line(&mut io::stderr().lock(), &shown(&message.to_string()));
}

/// Writes a report that was drawn for a terminal to standard error, as a line. If the write fails, it is lost.
pub fn stderr_drawn(report: &str) {
    let _ = line(&mut io::stderr().lock(), report); // nowhere is left to report the error to
}

/// Function behind [`stdout_line!`](crate::stdout_line).
pub fn stdout_line(message: Arguments<'_>) {
    let mut out = io::stdout().lock();
    // An error loses the line, as documented at the macro.
    let _ = line(&mut out, &shown(&message.to_string())).and_then(|()| out.flush());
}

/// A text as a person reads it: without control characters, in the units of this process.
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
    match plain(text) {
        Cow::Borrowed(text) => units::shown(text),
        Cow::Owned(text) => Cow::Owned(units::shown(&text).into_owned()),
    }
}

/// Writes a text for a person to standard output. A closed pipe or terminal is not an error; a full disk is.
pub fn answer(text: &str) -> io::Result<()> {
    drawn(&shown(text))
}

/// Writes a report that was drawn for a terminal to standard output, unchanged. Fails like [`answer`].
pub fn drawn(report: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let written = answered(out.write_all(report.as_bytes()).and_then(|()| out.flush()));
    if matches!(&written, Err(error) if error.raw_os_error() == Some(EIO)) && is_device() {
        return Ok(());
    }
    written
}

/// Writes JSON to standard output, with escapes for control characters. Fails like [`answer`].
pub fn json(text: &str) -> io::Result<()> {
    drawn(&escaped_json(text))
}

/// True for a device, such as a terminal, and false for a file.
fn is_device() -> bool {
    let file = io::stdout().as_fd().try_clone_to_owned().map(File::from);
    file.and_then(|file| file.metadata()).is_ok_and(|found| found.file_type().is_char_device())
}

/// Writes a line with one call of `write`, so that lines of several processes on one terminal do not mix.
fn line(out: &mut impl Write, message: &str) -> io::Result<()> {
    out.write_all(format!("{message}\n").as_bytes())
}

fn answered(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Calls(Vec<Vec<u8>>); // each call of `write`

    impl Write for Calls {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.push(bytes.to_vec());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_line_is_one_write() {
        let mut calls = Calls(Vec::new());
        line(&mut calls, "1 of two").unwrap();
        assert_eq!(calls.0, [b"1 of two\n"]);
    }

    #[test]
    fn only_a_closed_pipe_is_not_an_error() {
        let failed = |kind: ErrorKind| Err(io::Error::from(kind));
        assert!(answered(failed(ErrorKind::BrokenPipe)).is_ok());
        assert_eq!(answered(failed(ErrorKind::StorageFull)).unwrap_err().kind(), ErrorKind::StorageFull);
    }
}
