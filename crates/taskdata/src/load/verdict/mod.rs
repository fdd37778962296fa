//! The verdict on a command to Task (V.4.1, V.4.2): the task data have its names and records, and its path exists. One
//! verdict, with one text, serves lines of a job, requests of an operator, blocks of commands, the mailbox of a
//! workstation controller and `rcs-run check --explain`. It does not depend on the cell: Task alone decides about
//! conditions such as a lost object.
//!
//! * `names`: object, locations, sectors and grips exist;
//! * `needs`: the fields that the command uses, and the records that it needs;
//! * `path`: trajectories, approaches and departures.
//!
//! PAUSE, STARTUP and SHUTDOWN use no field, and always pass.

mod names;
mod needs;
mod path;

use diagnostics::nearest;
use interfaces::HwsCommand;
use rcs_core::name::{Name10, Name16};

use crate::files::TaskData;

use self::{needs::Needs, path::Route};

pub(super) use names::{LookupProblem, find_location, find_object};
pub use path::Standing;

pub const TASK_COMMANDS: &[&str] = &[
    "TRANSFER",
    "MOVE",
    "POSITION",
    "ACQUIRE",
    "REFIXTURE",
    "PAUSE",
    "INSERT-TOOL",
    "RELEASE-TOOL",
    "ACQUIRE-TOOL",
    "REMOVE-TOOL",
    "STARTUP",
    "SHUTDOWN",
];

const BARE: &[&str] = &["PAUSE", "STARTUP", "SHUTDOWN"]; // Task does not read their fields

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Field {
    Command,
    Object,
    SourceGrip,
    Source,
    SourceSector,
    DestinationGrip,
    Destination,
    DestinationSector,
    EndAt,
    EndAtSector, // of the end-at location
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    pub field: Field,
    pub code: &'static str,                               // stable short name
    pub message: String,                                  // finding and expectation, in one sentence
    pub help: Option<String>,                             // remedy, or nearest known name
    pub(super) unknown: Option<(Name16, Option<String>)>, // the name, and the nearest known one
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Held {
    #[default]
    Nothing,
    Object(Name16),
    Unknown, // after an operator's actions or a failed command
}

/// The known state between two commands. Default: a job starts with an empty gripper at an unknown location.
#[derive(Clone, Copy, Debug, Default)]
pub struct Before {
    held: Held,
    at: Option<Standing>,
}

impl Before {
    /// Makes the verdict independent of the robot's location and load.
    #[must_use]
    pub const fn unknown() -> Self {
        Self { held: Held::Unknown, at: None }
    }
}

#[derive(Clone, Debug)]
pub struct Verdict {
    pub findings: Vec<Finding>, // in the order of the fields; empty: the command passes
    pub after: Before,          // state of the robot after the command
}

impl Verdict {
    /// Does not allocate for a command that passes.
    #[must_use]
    pub fn of(command: &HwsCommand, data: &TaskData<'_>, before: Before) -> Self {
        Self::judge(command, data, before, false)
    }

    /// The command must fail, so it may lack fields and records.
    pub(super) fn of_failing(command: &HwsCommand, data: &TaskData<'_>, before: Before) -> Self {
        Self::judge(command, data, before, true)
    }

    fn judge(command: &HwsCommand, data: &TaskData<'_>, before: Before, fails: bool) -> Self {
        let mut findings = Vec::new();
        let Some(verb) = verb_of(&command.command) else {
            return Self { findings: vec![unknown_command(&command.command)], after: Before::unknown() };
        };
        if BARE.contains(&verb) {
            return Self { findings, after: before };
        }
        let sites = names::look_up(command, data, &mut findings);
        let Some(sites) = sites else { return Self { findings, after: before } };
        let held = if fails {
            Held::Unknown
        } else {
            Needs { command, verb, data, findings: &mut findings }.check(before.held)
        };
        let mut route = Route { data, last: before.at, findings: &mut findings };
        route.command(verb, sites);
        let at = route.last;
        findings.sort_by_key(|finding| finding.field);
        Self { findings, after: Before { held, at } }
    }

    #[must_use]
    pub const fn passes(&self) -> bool {
        self.findings.is_empty()
    }
}

pub(super) fn is_bare(command: &HwsCommand) -> bool {
    verb_of(&command.command).is_some_and(|verb| BARE.contains(&verb))
}

/// Checks only the names, for task data with errors.
pub(super) fn names_of(command: &HwsCommand, data: &TaskData<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    match verb_of(&command.command) {
        None => findings.push(unknown_command(&command.command)),
        Some(verb) if BARE.contains(&verb) => {}
        Some(_) => names::names(command, data, &mut findings),
    }
    findings
}

#[must_use]
pub fn in_words(findings: &[Finding]) -> String {
    let words = |finding: &Finding| with_nearest(&finding.message, finding.help.as_deref());
    findings.iter().map(words).collect::<Vec<_>>().join("; ")
}

pub(super) fn with_nearest(message: &str, help: Option<&str>) -> String {
    match help.filter(|help| help.starts_with("the nearest ")) {
        Some(nearest) => format!("{message} ({nearest})"),
        None => message.to_owned(),
    }
}

/// Compares the whole word, or its first ten characters like all lower processes (SPECNOTES.md, contradiction 22).
fn verb_of(word: &Name16) -> Option<&'static str> {
    let means = |known: &&&str| word.as_str() == **known || word.as_str() == Name10::clipped(known).as_str();
    TASK_COMMANDS.iter().find(means).copied()
}

fn unknown_command(word: &Name16) -> Finding {
    let help = nearest(word.as_str(), TASK_COMMANDS.iter().copied()).map_or_else(
        || format!("there are {}", TASK_COMMANDS.join(", ")),
        |near| format!("the nearest is {near}"),
    );
    let shown = if word.is_empty() { "--" } else { word.as_str() };
    finding(Field::Command, "name.unknown", format!("no command of Task is named {shown}"), Some(help))
}

fn finding(field: Field, code: &'static str, message: String, help: Option<String>) -> Finding {
    Finding { field, code, message, help, unknown: None }
}

#[cfg(test)]
mod tests;
