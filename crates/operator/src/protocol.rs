//! The lines of a session, as text.
//!
//! | direction | line | meaning |
//! |---|---|---|
//! | to the run | `hello NAME` | first line: name of the operator, 1 to 24 letters, digits, `-`, `_` and `.` |
//! | to the run | `NUMBER LINE` | a request; the number comes back with its answer |
//! | to the run | an empty line | the operator is still present |
//! | from the run | `rcs-operator 1 RUN` | answer to `hello` |
//! | from the run | `NUMBER ok TEXT` | the request was executed in the tick that TEXT begins with |
//! | from the run | `NUMBER refused TEXT` | the request was refused; TEXT is the reason |
//!
//! A line ends with a line feed and has at most [`LINE`] bytes of printable UTF-8 before it. A line that breaks these
//! rules ends the session.

use std::{fmt, str::FromStr, time::Duration};

/// Greatest length of a line without its line feed, bytes.
pub const LINE: usize = 240;
/// First word of the run's first line, and the version of the protocol.
pub const GREETING: &str = "rcs-operator 1";
/// A session that holds a stick or a button must send something within this time, or both are released.
pub const SILENCE: Duration = Duration::from_millis(250);
/// Greatest length of a name, bytes.
const NAME: usize = 24;

/// The name of a session.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Name(String);

impl Name {
    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name with the prefix `origin`, truncated to the greatest length; all characters of a name are ASCII.
    pub(crate) fn from(self, origin: &str) -> Self {
        let mut whole = format!("{origin}{self}");
        whole.truncate(NAME);
        Self(whole)
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Error of a name that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the name of an operator has 1 to {NAME} letters, digits, -, _ and .; found {0:?}")]
pub struct NameError(String);

impl FromStr for Name {
    type Err = NameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let legal = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let fits = (1..=NAME).contains(&text.len());
        if fits && text.chars().all(legal) {
            Ok(Self(text.to_owned()))
        } else {
            Err(NameError(text.to_owned()))
        }
    }
}

/// An event of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The session has begun.
    Connected,
    /// The session has sent a line.
    Line(String),
    /// Nothing has arrived for [`SILENCE`].
    Silent,
    /// The session has ended.
    Disconnected,
}

/// Log texts of the events that are not lines; no line of a session begins like these.
const CONNECTED: &str = "(connected)";
const SILENT: &str = "(silent)";
const DISCONNECTED: &str = "(disconnected)";

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Connected => CONNECTED,
            Self::Line(line) => line,
            Self::Silent => SILENT,
            Self::Disconnected => DISCONNECTED,
        })
    }
}

impl From<&str> for Event {
    fn from(text: &str) -> Self {
        match text {
            CONNECTED => Self::Connected,
            SILENT => Self::Silent,
            DISCONNECTED => Self::Disconnected,
            line => Self::Line(line.to_owned()),
        }
    }
}

/// The answer to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Number of the request.
    pub number: u32,
    /// Tick and text if the request was executed, else the reason of the refusal.
    pub verdict: Result<String, String>,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, text) = match &self.verdict {
            Ok(text) => ("ok", text),
            Err(text) => ("refused", text),
        };
        // A refusal can quote received text, and a report can have several lines.
        let text = text.replace(|c: char| c.is_control(), " ");
        let line = format!("{} {word} {}", self.number, text.trim_end());
        if line.len() <= LINE {
            return f.write_str(&line);
        }
        let end = (0..=LINE - CUT.len()).rev().find(|at| line.is_char_boundary(*at)).unwrap_or_default();
        write!(f, "{}{CUT}", line.get(..end).unwrap_or_default())
    }
}

/// End of an answer that was too long for a line; the log has all of it.
const CUT: &str = "...";

/// Violations of the protocol.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProtocolError {
    /// The first line is not `hello NAME`.
    #[error("hello NAME was expected as the first line; found {0:?}")]
    NoHello(String),
    /// The name of the session is not allowed.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A request has no number or no text.
    #[error("a number and a line were expected, as in `7 stop`; found {0:?}")]
    NoRequest(String),
    /// A line is too long or does not end.
    #[error("a line of at most {LINE} bytes was expected")]
    TooLong,
    /// A line is not printable UTF-8.
    #[error("printable UTF-8 was expected")]
    NoText,
    /// An answer does not have the form of a run's answer.
    #[error("an answer of a run was expected; found {0:?}")]
    NoAnswer(String),
}

/// Parses the first line of a session; returns its name.
///
/// # Errors
/// [`ProtocolError`] if the line is not `hello NAME`, or the name is not allowed.
pub fn hello(line: &str) -> Result<Name, ProtocolError> {
    let name = line.strip_prefix("hello ").ok_or_else(|| ProtocolError::NoHello(line.to_owned()))?;
    Ok(name.parse()?)
}

/// Parses a request; returns its number and text, or `None` for an empty line.
///
/// # Errors
/// [`ProtocolError::NoRequest`] if number or text is missing.
pub fn request(line: &str) -> Result<Option<(u32, &str)>, ProtocolError> {
    if line.is_empty() {
        return Ok(None);
    }
    let request = line.split_once(' ').and_then(|(number, text)| Some((number.parse().ok()?, text.trim())));
    request
        .filter(|(_, text)| !text.is_empty() && !text.starts_with('('))
        .map(Some)
        .ok_or_else(|| ProtocolError::NoRequest(line.to_owned()))
}

/// Parses an answer.
///
/// # Errors
/// [`ProtocolError::NoAnswer`] if the line is not an answer.
pub fn answer(line: &str) -> Result<Answer, ProtocolError> {
    let unknown = || ProtocolError::NoAnswer(line.to_owned());
    let mut words = line.splitn(3, ' ');
    let number = words.next().and_then(|number| number.parse().ok()).ok_or_else(unknown)?;
    let word = words.next().ok_or_else(unknown)?;
    let text = words.next().unwrap_or_default().to_owned();
    let verdict = match word {
        "ok" => Ok(text),
        "refused" => Err(text),
        _ => return Err(unknown()),
    };
    Ok(Answer { number, verdict })
}

/// Splits a stream of bytes into lines.
#[derive(Debug, Default)]
pub struct Lines {
    bytes: Vec<u8>,
}

impl Lines {
    /// Adds bytes of the stream.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Returns the next complete line without its line feed; `None` if there is none yet.
    ///
    /// # Errors
    /// [`ProtocolError::TooLong`] or [`ProtocolError::NoText`]; the rest of the stream cannot be read then.
    pub fn next_line(&mut self) -> Result<Option<String>, ProtocolError> {
        let end = self.bytes.iter().position(|byte| *byte == b'\n');
        if end.unwrap_or(self.bytes.len()) > LINE {
            return Err(ProtocolError::TooLong);
        }
        let Some(end) = end else { return Ok(None) };
        let rest = self.bytes.split_off(end.saturating_add(1));
        let mut line = std::mem::replace(&mut self.bytes, rest);
        line.truncate(end);
        line.pop_if(|byte| *byte == b'\r');
        let line = String::from_utf8(line).map_err(|_| ProtocolError::NoText)?;
        if line.chars().any(char::is_control) {
            return Err(ProtocolError::NoText);
        }
        Ok(Some(line))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn answer_longer_than_a_line_is_cut() {
        for text in ["x".repeat(500), "é".repeat(200)] {
            let line = Answer { number: 7, verdict: Err(text) }.to_string();
            assert!(
                (LINE - 3..=LINE).contains(&line.len()) && line.ends_with("..."),
                "{}: {line}",
                line.len()
            );
        }
        let whole = Answer { number: 7, verdict: Err("x".repeat(LINE - 10)) }.to_string();
        assert_eq!((whole.len(), whole.ends_with('x')), (LINE, true));
    }

    #[test]
    fn a_session_line_by_line() {
        assert_eq!(hello("hello console-1").map(|name| name.to_string()), Ok("console-1".into()));
        assert_eq!(hello("7 stop"), Err(ProtocolError::NoHello("7 stop".into())));
        for wrong in ["hello ", "hello a b", "hello é", "hello 1234567890123456789012345"] {
            assert!(matches!(hello(wrong), Err(ProtocolError::Name(_))), "{wrong}");
        }
        assert_eq!(request("7 joystick velocity 0"), Ok(Some((7, "joystick velocity 0"))));
        assert_eq!(request(""), Ok(None));
        for wrong in ["stop", "7", "7 ", "-1 stop", "4294967296 stop", "7 (connected)", "7 (silent)"] {
            assert_eq!(request(wrong), Err(ProtocolError::NoRequest(wrong.into())));
        }
    }

    #[test]
    fn answers_come_back_on_one_line() {
        for verdict in [Ok("tick 7".to_owned()), Err("no".to_owned()), Ok(String::new())] {
            let given = Answer { number: 9, verdict };
            assert_eq!(answer(&given.to_string()).as_ref(), Ok(&given));
        }
        let long = Answer { number: 1, verdict: Err("one\ntwo\u{1b}[2J".into()) };
        assert_eq!(long.to_string(), "1 refused one two [2J");
        for wrong in ["", "7", "x ok", "7 maybe"] {
            assert!(answer(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn events_stand_in_a_log_and_come_back() {
        for event in [Event::Connected, Event::Line("stop".into()), Event::Silent, Event::Disconnected] {
            assert_eq!(Event::from(event.to_string().as_str()), event);
        }
    }

    #[test]
    fn a_stream_is_cut_wherever_it_is_torn() {
        let mut lines = Lines::default();
        for byte in b"hello a\r\n\n7 stop\n" {
            lines.push(&[*byte]);
        }
        let read: Vec<_> = std::iter::from_fn(|| lines.next_line().unwrap()).collect();
        assert_eq!(read, ["hello a", "", "7 stop"]);
        lines.push(&[b'x'; LINE + 1]);
        assert_eq!(lines.next_line(), Err(ProtocolError::TooLong));
        for wrong in [&b"\xff\n"[..], b"7 st\x1bop\n"] {
            let mut lines = Lines::default();
            lines.push(wrong);
            assert_eq!(lines.next_line(), Err(ProtocolError::NoText));
        }
    }

    proptest! {
        #[test]
        fn no_bytes_panic(chunks in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..300), 0..6)) {
            let mut lines = Lines::default();
            for chunk in chunks {
                lines.push(&chunk);
                while let Ok(Some(line)) = lines.next_line() {
                    prop_assert!(line.len() <= LINE);
                    let _ = (hello(&line), request(&line), answer(&line));
                }
            }
        }
    }
}
