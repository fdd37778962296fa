//! Lines on standard output and standard error. Nothing here panics.
//!
//! | for | call | if the reader has gone | if the write fails otherwise |
//! |---|---|---|---|
//! | a message | [`stderr_line!`](crate::stderr_line) | lost | lost |
//! | a line of a process that goes on working | [`stdout_line!`](crate::stdout_line) | lost | lost |
//! | the answer of a tool, the result of a run | [`answer`] | no error: it has read enough | an error |

use std::{
    fmt::Arguments,
    io::{self, ErrorKind, Write},
};

/// Write a formatted line to standard error. A line that cannot be written is lost.
#[macro_export]
macro_rules! stderr_line {
    ($($message:tt)*) => { $crate::console::stderr_line(::std::format_args!($($message)*)) };
}

/// Write a formatted line to standard output. A line that cannot be written is lost: the process goes on working.
#[macro_export]
macro_rules! stdout_line {
    ($($message:tt)*) => { $crate::console::stdout_line(::std::format_args!($($message)*)) };
}

/// What [`stderr_line!`](crate::stderr_line) calls.
pub fn stderr_line(message: Arguments<'_>) {
    // There is no other place to report it to.
    let _ = line(&mut io::stderr().lock(), message);
}

/// What [`stdout_line!`](crate::stdout_line) calls.
pub fn stdout_line(message: Arguments<'_>) {
    let mut out = io::stdout().lock();
    // The line is lost, as the documentation of the macro says.
    let _ = line(&mut out, message).and_then(|()| out.flush());
}

/// Write text to standard output, all of it. A reader that has closed the pipe, such as `head`, is no error.
///
/// # Errors
/// What the system says, for example that the disk is full.
pub fn answer(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    answered(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// One call of `write` a line: lines of several processes on one terminal do not mix.
fn line(out: &mut impl Write, message: Arguments<'_>) -> io::Result<()> {
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

    /// Counts the calls.
    struct Calls(Vec<Vec<u8>>);

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
        line(&mut calls, format_args!("{} of {}", 1, "two")).unwrap();
        assert_eq!(calls.0, [b"1 of two\n"]);
    }

    #[test]
    fn only_a_closed_pipe_is_no_error() {
        let failed = |kind: ErrorKind| Err(io::Error::from(kind));
        assert!(answered(failed(ErrorKind::BrokenPipe)).is_ok());
        assert_eq!(answered(failed(ErrorKind::StorageFull)).unwrap_err().kind(), ErrorKind::StorageFull);
    }
}
