//! Requests of an operator, and their text form.

use std::collections::BTreeSet;

use diagnostics::nearest;
use interfaces::{
    HwsCommand,
    station::{BoxAction, Key, LineVerb},
};
use taskdata::load::{
    BlockNumber, Store,
    job::{self, Step, Workstation},
    verdict::TASK_COMMANDS,
};

use super::terminals::Entry;
use crate::loads;

#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    Status, // read the status; changes nothing
    Data,   // read the directory of the task data; changes nothing
    Pedestal,
    Field,
    Point(String),
    Knowledge,
    NameLine(usize), // the present line of a resumed job
    Release(String),
    MakeSafe(String), // make the outputs of a device safe until it is released
    Stop,
    Go,
    Leave, // give up the command, so that another operator may take it
    Note,
    Wait, // make the job wait at the end of its line
    GoOn,
    Skip, // continue the job after the interrupted line
    Command(String, HwsCommand),
    Box(BoxAction), // an action at the operator's own joystick box
    Terminal(Entry),
    Load(BlockNumber),
    Play(String), // play a job of the data directory instead of the rest of the present one
    /// Take over from a workstation controller in another process.
    StandAlone {
        now: bool, // also in the middle of a command
    },
    Workstation,
    Cell(Workstation, String), // another action in the cell, and its text
}

/// Requests that change nothing and are not logged.
const QUESTIONS: [&str; 5] = [STATUS, DATA, PEDESTAL, FIELD, RESUME];
const SHOW: &str = "io show "; // begin of the request for the state of a point

/// True if a request changes nothing, so that it is not logged.
#[must_use]
pub fn is_question(line: &str) -> bool {
    QUESTIONS.contains(&line) || line.starts_with(SHOW)
}

const STATUS: &str = "status";
const DATA: &str = "data";
const PEDESTAL: &str = "pedestal";

const RESUME: &str = "resume";

const FIELD: &str = "io";

/// The requests that are not lines of a job.
const WORDS: &[(&str, Request)] = &[
    (STATUS, Request::Status),
    (DATA, Request::Data),
    (PEDESTAL, Request::Pedestal),
    (FIELD, Request::Field),
    (RESUME, Request::Knowledge),
    ("stop", Request::Stop),
    ("go", Request::Go),
    ("leave", Request::Leave),
    ("job wait", Request::Wait),
    ("job go", Request::GoOn),
    ("job skip", Request::Skip),
    ("stand-alone", Request::StandAlone { now: false }),
    ("stand-alone now", Request::StandAlone { now: true }),
    ("workstation", Request::Workstation),
];

/// First words of the requests with arguments, except the lines for the cell.
const OTHER_WORDS: [&str; 12] = [
    "note",
    "io",
    "job",
    "board",
    "execute",
    "robot-init",
    "db-done",
    "write",
    "confirm",
    "line-load",
    "load",
    "run",
];

impl Request {
    /// Read a request. Errors: a message about the error.
    pub fn read(line: &str, store: &Store) -> Result<Self, String> {
        let line = line.trim().trim_start_matches("**").trim_start();
        let words = line.split_whitespace().collect::<Vec<_>>().join(" ");
        if let Some((_, request)) = WORDS.iter().find(|(word, _)| *word == words) {
            return Ok(request.clone());
        }
        if words.strip_prefix("note").is_some_and(|text| text.starts_with(' ')) {
            return Ok(Self::Note);
        }
        if words == "job" || words.starts_with("job ") {
            return Err(format!("job wait, job go or job skip was expected; found {words}"));
        }
        let each: Vec<&str> = words.split(' ').collect();
        if let ["io", rest @ ..] = &each[..] {
            return match rest {
                ["go", device] => Ok(Self::Release((*device).to_owned())),
                ["show", point] => Ok(Self::Point((*point).to_owned())),
                ["safe", device] => Ok(Self::MakeSafe((*device).to_owned())),
                _ => Err(format!(
                    "io, io show POINT, io go DEVICE or io safe DEVICE was expected; found {words}"
                )),
            };
        }
        if let ["resume", "line", line] = each[..] {
            let number = line.parse().map(Self::NameLine);
            return number.map_err(|_| format!("resume line NUMBER was expected; found {words}"));
        }
        if let Some(entry) = Entry::read(&each) {
            return entry.map(Self::Terminal);
        }
        if let Some(block) = loads::asked(&each) {
            return block.map(Self::Load);
        }
        if let Some(request) = line_load(&each, store).or_else(|| play(&each)) {
            return request;
        }
        let first = each.first().copied().unwrap_or_default();
        // The commands of Task have capital letters, the lines for the cell small ones.
        if job::is_command(line) || first.starts_with(|first: char| first.is_ascii_uppercase()) {
            let read = job::own_command(line, store).map_err(|error| error.to_string())?;
            let Step::Command(command) = read.step else { return Err(format!("{line} is not a command")) };
            return Ok(Self::Command(read.text, command));
        }
        if !first.is_empty() && LineVerb::from_text(first).is_none() {
            return Err(unknown(first));
        }
        match job::own_line(line, store).map_err(|error| error.to_string())? {
            Workstation::Joystick(action) => Ok(Self::Box(action)),
            action => Ok(Self::Cell(action, line.to_owned())),
        }
    }

    /// True if it can only stop a motion, or changes nothing. Every operator may send it, also while another commands.
    pub const fn is_stop(&self) -> bool {
        match self {
            Self::Status
            | Self::Data
            | Self::Pedestal
            | Self::Field
            | Self::Point(_)
            | Self::Knowledge
            | Self::Stop
            | Self::Leave
            | Self::Note
            | Self::Wait
            | Self::Box(BoxAction::Hold(_)) => true,
            Self::Cell(action, _) => {
                matches!(action, Workstation::Press(_) | Workstation::Panel(Key::Hold(true) | Key::Interrupt))
            }
            Self::Terminal(entry) => entry.is_stop(),
            Self::Load(_)
            | Self::Play(_)
            | Self::StandAlone { .. }
            | Self::Workstation
            | Self::Go
            | Self::GoOn
            | Self::Skip
            | Self::NameLine(_)
            | Self::Release(_)
            | Self::MakeSafe(_)
            | Self::Command(..)
            | Self::Box(_) => false,
        }
    }

    /// True if it sends a command to Task at once.
    pub const fn needs_the_robot(&self) -> bool {
        matches!(self, Self::GoOn | Self::Skip | Self::Command(..) | Self::Play(_))
    }

    /// True if it sends a command to Task.
    pub const fn is_of_the_job(&self) -> bool {
        matches!(
            self,
            Self::GoOn
                | Self::Skip
                | Self::Command(..)
                | Self::Play(_)
                | Self::Workstation
                | Self::StandAlone { .. }
        )
    }
}

fn first() -> impl Iterator<Item = &'static str> {
    let known = WORDS.iter().filter_map(|(words, _)| words.split(' ').next());
    known.chain(OTHER_WORDS).chain(LineVerb::ALL.iter().map(|verb| verb.text()))
}

/// Whole requests without arguments, the first words of the others, and the commands of Task.
#[must_use]
pub fn first_words() -> Vec<&'static str> {
    let whole = WORDS.iter().map(|(words, _)| *words);
    let lines = LineVerb::ALL.iter().filter(|verb| !matches!(verb, LineVerb::Wait | LineVerb::After));
    let begun = OTHER_WORDS.into_iter().filter(|word| *word != "job").chain(lines.map(|verb| verb.text()));
    let words: BTreeSet<&str> = whole.chain(begun).chain(TASK_COMMANDS.iter().copied()).collect();
    words.into_iter().collect()
}

fn unknown(word: &str) -> String {
    match nearest(word, first()) {
        Some(near) => format!("no request is named {word}: the nearest is {near}"),
        None => format!("no request is named {word}: docs/operator.md lists the requests"),
    }
}

/// Reads `line-load BLOCK LINE LINE` (IV.3.3); `None` if the words begin another request.
fn line_load(words: &[&str], store: &Store) -> Option<Result<Request, String>> {
    let ["line-load", numbers @ ..] = words else { return None };
    let expected = || "line-load BLOCK LINE LINE was expected, such as line-load 863 12 12".to_owned();
    let parsed: Option<Vec<u32>> = numbers.iter().map(|number| number.parse().ok()).collect();
    let Some(&[block, from, to]) = parsed.as_deref() else { return Some(Err(expected())) };
    let line = |number: u32| usize::try_from(number).unwrap_or(usize::MAX);
    let read = store.line_load(block, line(from), line(to)).map_err(|error| error.to_string());
    Some(read.and_then(|read| match read.step {
        Step::Command(command) => Ok(Request::Command(read.text, command)),
        _ => Err(expected()),
    }))
}

/// Read `run JOB`; `None` if the words begin another request.
fn play(words: &[&str]) -> Option<Result<Request, String>> {
    match words {
        ["run", job] => Some(Ok(Request::Play((*job).to_owned()))),
        ["run", ..] => Some(Err("run JOB was expected, such as run linkbar".to_owned())),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn mistyped_request_is_answered_with_the_nearest_name() {
        let Ok((store, _)) = Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data")))
        else {
            panic!("the shipped data do not load")
        };
        let refused = |line: &str| Request::read(line, &store).unwrap_err();
        assert_eq!(refused("bord 2 stop"), "no request is named bord: the nearest is board");
        assert_eq!(refused("joystik hold PRIM"), "no request is named joystik: the nearest is joystick");
        assert_eq!(refused("zzz"), "no request is named zzz: docs/operator.md lists the requests");
        assert!(refused("MVOE -- +0 -- 0 +0 HOME 0 -- 0").contains("(the nearest is MOVE)"));
        assert!(refused("MOVE -- +0 -- 0 +0 HOMME 0 -- 0").contains("(the nearest known name is HOME)"));
        for line in ["vise open PFIXTURE", "board 2 stop", "run linkbar", "write task.ledger NONE"] {
            assert!(Request::read(line, &store).is_ok(), "{line}");
        }
    }
}
