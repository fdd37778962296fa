//! The lines of a session, as text.
//!
//! | direction | line | meaning |
//! |---|---|---|
//! | to the run | `hello NAME` | first line: name of the operator, 1 to 24 letters, digits, `-`, `_` and `.` |
//! | to the run | `NUMBER @LIMIT LINE` | a request; the number is repeated in its answer |
//! | to the run | an empty line | the operator is still present |
//! | from the run | `rcs-operator 2 RUN NAME @TIME` | answer to `hello`: the name of the session, which no other has |
//! | from the run | `NUMBER @TIME ok TEXT` | the request was executed in the tick that TEXT begins with |
//! | from the run | `NUMBER @TIME refused TEXT` | the request was refused; TEXT is the reason |
//!
//! TIME is the run's clock, ms. LIMIT is the time after which the sender no longer waits: the run then discards the
//! request unless it is a stop. Only a stop, and a request that changes nothing, may lack `@LIMIT`.
//!
//! A line ends with a line feed and has at most [`LINE`] bytes of printable UTF-8; any other line ends the session.

use std::{fmt, str::FromStr, time::Duration};

use crate::operator::clock::RunTime;

pub const LINE: usize = 260; // greatest length of a line without its line feed, bytes
pub const TEXT: usize = 224; // greatest length of a request without number and limit, bytes
pub const GREETING: &str = "rcs-operator 2"; // and the version of the protocol
/// Longest silence of a session that commands motion by hand. After it, the motion ends.
pub const SILENCE: Duration = Duration::from_millis(250);
/// Time for which a client waits for an answer. The run answers between two ticks, of which a second has 25.
pub const ANSWER_LIMIT: Duration = Duration::from_secs(1);
pub const LONGEST: Duration = Duration::from_secs(10); // from now to the limit of a request
const NAME: usize = 24; // greatest length of a name, bytes

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Name(String);

impl Name {
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

    /// The name, followed by `-2`, `-3` and so on if it is taken.
    pub(crate) fn unlike(self, is_taken: impl Fn(&Self) -> bool) -> Self {
        let mut name = self.clone();
        for number in 2_u32.. {
            if !is_taken(&name) {
                break;
            }
            let end = format!("-{number}");
            let mut text = self.0.clone();
            text.truncate(NAME.saturating_sub(end.len()));
            name = Self(text + &end);
        }
        name
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

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

/// Why a request is too late for its sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Late {
    GivenUp,
    Ended,
    /// It has no usable time limit, so it is unknown whether its sender still waits.
    Unlimited,
}

impl Late {
    const ALL: [Self; 3] = [Self::GivenUp, Self::Ended, Self::Unlimited];

    /// Beginning of the text of a late request in a log. No line of a session can begin with it.
    const fn mark(self) -> &'static str {
        match self {
            Self::GivenUp => "(given up) ",
            Self::Ended => "(session ended) ",
            Self::Unlimited => "(no limit) ",
        }
    }
}

impl fmt::Display for Late {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::GivenUp => f.write_str(
                "it arrived after its sender had stopped waiting, and nothing is done: send it again",
            ),
            Self::Ended => {
                f.write_str("its session ended before it was carried out, and nothing is done: send it again")
            }
            Self::Unlimited => write!(
                f,
                "a time limit was expected, as in `7 @LIMIT PAUSE`: the run's time now, plus your wait in ms, {} at most",
                LONGEST.as_millis()
            ),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    Connected,
    Line(String),
    /// The session has sent a line whose sender no longer waits.
    Late(Late, String),
    /// Nothing has arrived for [`SILENCE`].
    Silent,
    Disconnected,
}

impl Event {
    /// The line that the session has sent, if the event has one.
    #[must_use]
    pub fn line(&self) -> Option<&str> {
        match self {
            Self::Line(line) | Self::Late(_, line) => Some(line),
            Self::Connected | Self::Silent | Self::Disconnected => None,
        }
    }
}

/// Log texts of the events without a line. Lines of a session cannot begin like these.
const CONNECTED: &str = "(connected)";
const SILENT: &str = "(silent)";
const DISCONNECTED: &str = "(disconnected)";

impl fmt::Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Connected => f.write_str(CONNECTED),
            Self::Line(line) => f.write_str(line),
            Self::Late(late, line) => write!(f, "{}{line}", late.mark()),
            Self::Silent => f.write_str(SILENT),
            Self::Disconnected => f.write_str(DISCONNECTED),
        }
    }
}

impl From<&str> for Event {
    fn from(text: &str) -> Self {
        let late = |late: Late| Some(Self::Late(late, text.strip_prefix(late.mark())?.to_owned()));
        match text {
            CONNECTED => Self::Connected,
            SILENT => Self::Silent,
            DISCONNECTED => Self::Disconnected,
            line => Late::ALL.into_iter().find_map(late).unwrap_or_else(|| Self::Line(line.to_owned())),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    pub number: u32,
    pub time: RunTime,
    /// Tick and text if the request was executed, otherwise the reason of the refusal.
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
        let line = format!("{} @{} {word} {}", self.number, self.time.0, text.trim_end());
        if line.len() <= LINE {
            return f.write_str(&line);
        }
        let end = (0..=LINE - CUT.len()).rev().find(|at| line.is_char_boundary(*at)).unwrap_or_default();
        write!(f, "{}{CUT}", line.get(..end).unwrap_or_default())
    }
}

/// End of an answer that was too long for a line. The log has all of it.
const CUT: &str = "...";

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProtocolError {
    #[error("hello NAME was expected as the first line; found {0:?}")]
    NoHello(String),
    #[error(transparent)]
    Name(#[from] NameError),
    #[error("a number and a line were expected, as in `7 stop` or `8 @15230 PAUSE`; found {0:?}")]
    NoRequest(String),
    #[error("a line of at most {LINE} bytes was expected")]
    TooLong,
    #[error("printable UTF-8 was expected")]
    NoText,
    #[error("an answer of a run was expected; found {0:?}")]
    NoAnswer(String),
}

/// Parses the first line of a session, `hello NAME`.
pub fn hello(line: &str) -> Result<Name, ProtocolError> {
    let name = line.strip_prefix("hello ").ok_or_else(|| ProtocolError::NoHello(line.to_owned()))?;
    Ok(name.parse()?)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'a> {
    pub number: u32,
    /// The time of the run's clock after which its sender no longer waits.
    pub limit: Option<RunTime>,
    pub text: &'a str,
}

impl Request<'_> {
    /// Why the request is too late; `None` if its sender waits. `is_open` is false if its session has ended.
    #[must_use]
    pub fn late(&self, now: RunTime, is_open: bool) -> Option<Late> {
        match self.limit {
            _ if !is_open => Some(Late::Ended),
            None => Some(Late::Unlimited),
            Some(limit) if limit < now => Some(Late::GivenUp),
            Some(limit) if limit > now.after(LONGEST) => Some(Late::Unlimited),
            Some(_) => None,
        }
    }
}

/// Parses a request. Returns `None` for an empty line.
pub fn request(line: &str) -> Result<Option<Request<'_>>, ProtocolError> {
    if line.is_empty() {
        return Ok(None);
    }
    let parse = || {
        let (number, rest) = line.split_once(' ')?;
        let (limit, text) = match rest.trim_start().strip_prefix('@') {
            Some(rest) => {
                let (limit, text) = rest.split_once(' ')?;
                (Some(RunTime(limit.parse().ok()?)), text)
            }
            None => (None, rest),
        };
        let text = text.trim();
        let is_text = !text.is_empty() && !text.starts_with('(');
        is_text.then_some(Request { number: number.parse().ok()?, limit, text })
    };
    parse().map(Some).ok_or_else(|| ProtocolError::NoRequest(line.to_owned()))
}

/// The run's first line in a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Greeting {
    pub run: String,
    pub name: Name, // unique in the run
    pub time: RunTime,
}

impl fmt::Display for Greeting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{GREETING} {} {} @{}", self.run, self.name, self.time.0)
    }
}

/// Parses the run's first line; `None` for another line.
#[must_use]
pub fn greeting(line: &str) -> Option<Greeting> {
    let mut words = line.strip_prefix(GREETING)?.split_whitespace();
    let (run, name, time) = (words.next()?, words.next()?, words.next()?);
    let time = RunTime(time.strip_prefix('@')?.parse().ok()?);
    Some(Greeting { run: run.to_owned(), name: name.parse().ok()?, time })
}

pub fn answer(line: &str) -> Result<Answer, ProtocolError> {
    let unknown = || ProtocolError::NoAnswer(line.to_owned());
    let mut words = line.splitn(4, ' ');
    let number = words.next().and_then(|number| number.parse().ok()).ok_or_else(unknown)?;
    let time = words.next().and_then(|time| time.strip_prefix('@')?.parse().ok()).ok_or_else(unknown)?;
    let word = words.next().ok_or_else(unknown)?;
    let text = words.next().unwrap_or_default().to_owned();
    let verdict = match word {
        "ok" => Ok(text),
        "refused" => Err(text),
        _ => return Err(unknown()),
    };
    Ok(Answer { number, time: RunTime(time), verdict })
}

#[derive(Debug, Default)]
pub struct Lines {
    bytes: Vec<u8>,
}

impl Lines {
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// The next line without its line feed. After an error, the rest of the stream is unreadable.
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
            let line = Answer { number: 7, time: RunTime(0), verdict: Err(text) }.to_string();
            assert!(
                (LINE - 3..=LINE).contains(&line.len()) && line.ends_with("..."),
                "{}: {line}",
                line.len()
            );
        }
        let whole = Answer { number: 7, time: RunTime(0), verdict: Err("x".repeat(LINE - 13)) }.to_string();
        assert_eq!((whole.len(), whole.ends_with('x')), (LINE, true));
    }

    #[test]
    fn session_lines_parse_in_order() {
        assert_eq!(hello("hello console-1").map(|name| name.to_string()), Ok("console-1".into()));
        assert_eq!(hello("7 stop"), Err(ProtocolError::NoHello("7 stop".into())));
        for wrong in ["hello ", "hello a b", "hello é", "hello 1234567890123456789012345"] {
            assert!(matches!(hello(wrong), Err(ProtocolError::Name(_))), "{wrong}");
        }
        let unlimited = Request { number: 7, limit: None, text: "joystick velocity 0" };
        assert_eq!(request("7 joystick velocity 0"), Ok(Some(unlimited)));
        let limited = Request { limit: Some(RunTime(15_230)), ..unlimited };
        assert_eq!(request("7 @15230  joystick velocity 0 "), Ok(Some(limited)));
        assert_eq!(request(""), Ok(None));
        for wrong in [
            "stop",
            "7",
            "7 ",
            "-1 stop",
            "4294967296 stop",
            "7 (connected)",
            "7 @5 (silent)",
            "7 @5",
            "7 @x stop",
        ] {
            assert_eq!(request(wrong), Err(ProtocolError::NoRequest(wrong.into())));
        }
    }

    #[test]
    fn answer_has_one_line() {
        for verdict in [Ok("tick 7".to_owned()), Err("no".to_owned()), Ok(String::new())] {
            let given = Answer { number: 9, time: RunTime(77), verdict };
            assert_eq!(answer(&given.to_string()).as_ref(), Ok(&given));
        }
        let long = Answer { number: 1, time: RunTime(0), verdict: Err("one\ntwo\u{1b}[2J".into()) };
        assert_eq!(long.to_string(), "1 @0 refused one two [2J");
        for wrong in ["", "7", "x @1 ok", "7 @1 maybe", "7 ok tick 1", "7 @x ok"] {
            assert!(answer(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn greeting_has_run_session_and_time() {
        let sent = Greeting { run: "linkbar-1".into(), name: Name("send-2".into()), time: RunTime(40) };
        assert_eq!(sent.to_string(), "rcs-operator 2 linkbar-1 send-2 @40");
        assert_eq!(greeting(&sent.to_string()), Some(sent));
        for wrong in ["rcs-operator 1 linkbar-1", "rcs-operator 2 linkbar-1 send-2", "0 @0 refused no"] {
            assert_eq!(greeting(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn request_is_late_after_its_limit_or_session() {
        let request = |limit| Request { number: 1, limit, text: "PAUSE" };
        let limited = request(Some(RunTime(5000)));
        assert_eq!(limited.late(RunTime(4000), true), None);
        assert_eq!(limited.late(RunTime(5000), true), None);
        assert_eq!(limited.late(RunTime(5001), true), Some(Late::GivenUp));
        assert_eq!(limited.late(RunTime(4000), false), Some(Late::Ended));
        assert_eq!(request(None).late(RunTime(0), true), Some(Late::Unlimited));
        let far = request(Some(RunTime(u64::MAX)));
        assert_eq!(far.late(RunTime(0), true), Some(Late::Unlimited), "nobody waits so long");
    }

    #[test]
    fn taken_name_gets_a_number() {
        let name = |text: &str| Name(text.to_owned());
        let taken = [name("send"), name("send-2"), name("a23456789012345678901234")];
        let unlike = |text: &str| name(text).unlike(|name| taken.contains(name));
        assert_eq!(unlike("anna"), name("anna"));
        assert_eq!(unlike("send"), name("send-3"));
        assert_eq!(unlike("a23456789012345678901234"), name("a234567890123456789012-2"));
    }

    #[test]
    fn events_round_trip_through_a_log() {
        let late = Late::ALL.map(|late| Event::Late(late, "PAUSE".into()));
        let others = [Event::Connected, Event::Line("stop".into()), Event::Silent, Event::Disconnected];
        for event in others.into_iter().chain(late) {
            assert_eq!(Event::from(event.to_string().as_str()), event);
        }
    }

    #[test]
    fn torn_stream_is_split_into_lines() {
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
                    let _ = (hello(&line), request(&line), answer(&line), greeting(&line));
                }
            }
        }
    }
}
