//! A line from another process or an operator during the run. Its meaning depends only on its words and the task data.
//! It opens no file: that could take any time, and show connected systems which files exist. The run itself handles
//! `load OFFSET BLOCK` earlier.

use std::fmt;

use diagnostics::{At, Diagnostics, Problems, Source};

use super::{
    super::{
        Store,
        lex::words_of_line,
        source::SourceLine,
        verdict::{TASK_COMMANDS, with_nearest},
    },
    JobLine, Step, Workstation,
    fields::Fields,
    read::Reader,
};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OwnLineError {
    Nothing,            // an empty line
    Load,     // `load FILE` is possible only in a job, whose blocks are checked before its first tick
    Wait,     // only in a job, whose ticks it counts
    After,    // only in a job, whose ticks it counts
    HandOver, // `workstation`: only in a job
    Unreadable(String), // the message
}

impl fmt::Display for OwnLineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nothing => "a line for the cell was expected, such as vise close PFIXTURE; found none",
            Self::Load => {
                "load OFFSET BLOCK was expected, such as load 21000 610; load FILE is for the controller's own jobs"
            }
            Self::Wait => "wait is for jobs only: the workstation controller counts the ticks itself",
            Self::After => {
                "after is for jobs only: the workstation controller counts the ticks, and sends the line then"
            }
            Self::HandOver => "workstation is for the controller's own jobs only: they hand over",
            Self::Unreadable(why) => why,
        })
    }
}

impl std::error::Error for OwnLineError {}

const SOURCE: &str = "the line"; // in messages

/// Reads a command as in a job, with or without `==`, without checks of the robot's position and held object.
pub fn own_command(text: &str, store: &Store) -> Result<JobLine, OwnLineError> {
    reported_command(text, store).map_err(|report| unreadable(&report))
}

/// Like [`own_command`], with places and remedies of all findings.
pub fn reported_command(text: &str, store: &Store) -> Result<JobLine, Box<Diagnostics>> {
    let mut text = text.trim().trim_start_matches("==").trim_start().to_owned();
    if ["PAUSE", "STARTUP", "SHUTDOWN"].contains(&text.as_str()) {
        text += " -- 0 -- 0 0 -- 0 -- 0";
    }
    let text = format!("== {text}");
    let line = source_line(&text);
    let mut problems = Problems::default();
    let mut reader = Reader::new(store.view(), Vec::new(), &mut problems);
    reader.forget();
    let read = reader.line(1, &line);
    match read.filter(|_| !problems.has_errors()) {
        Some(line) if matches!(line.step, Step::Command(_)) => Ok(line),
        _ => Err(Box::new(report(&text, problems))),
    }
}

#[must_use]
pub fn is_command(text: &str) -> bool {
    let text = text.trim_start();
    let verb = text.split_whitespace().next().unwrap_or_default();
    text.starts_with("==") || TASK_COMMANDS.contains(&verb)
}

fn source_line(text: &str) -> SourceLine<'_> {
    SourceLine { text, at: At { source: 0, start: 0, length: u32::try_from(text.len()).unwrap_or(u32::MAX) } }
}

fn report(text: &str, problems: Problems) -> Diagnostics {
    Diagnostics::of_file(problems, &Source { name: SOURCE.into(), text: text.into() })
}

fn unreadable(report: &Diagnostics) -> OwnLineError {
    let errors: Vec<_> = report.errors().map(|error| with_nearest(error.message(), error.help())).collect();
    OwnLineError::Unreadable(errors.join("; "))
}

pub fn own_line(text: &str, store: &Store) -> Result<Workstation, OwnLineError> {
    let words = words_of_line(&source_line(text));
    match words.first().map(|word| word.text) {
        None => return Err(OwnLineError::Nothing),
        Some("load") => return Err(OwnLineError::Load),
        Some("wait") => return Err(OwnLineError::Wait),
        Some("after") => return Err(OwnLineError::After),
        Some("workstation") => return Err(OwnLineError::HandOver),
        Some(_) => {}
    }
    let mut problems = Problems::default();
    let read = Reader::new(store.view(), Vec::new(), &mut problems).own_line(&mut Fields::new(&words));
    match read.filter(|_| !problems.has_errors()) {
        Some(action) => Ok(action),
        None => Err(unreadable(&report(text, problems))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn job_words_are_refused_outside_a_job() {
        let Ok((store, _)) = Store::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data")))
        else {
            panic!("the shipped data do not load")
        };
        let why = |line: &str| own_line(line, &store).unwrap_err();
        assert_eq!(why(""), OwnLineError::Nothing);
        assert_eq!(why("% vise"), OwnLineError::Nothing);
        for file in ["/etc/passwd", "/nowhere", "", "a b"] {
            assert_eq!(why(&format!("load {file}")), OwnLineError::Load);
            assert_eq!(why(&format!("( aside ) load {file}")), OwnLineError::Load);
        }
        assert_eq!(why("wait 30"), OwnLineError::Wait);
        assert_eq!(why("workstation"), OwnLineError::HandOver);
        assert_eq!(why("after 5 load /etc/passwd"), OwnLineError::After);
        assert_eq!(
            own_line("vise partial PFIXTURE", &store)
                .map(|action| matches!(action, Workstation::Vise { .. })),
            Ok(true)
        );
        let OwnLineError::Unreadable(why_not) = why("** vise open PFIXTURE") else {
            panic!("it is not a line")
        };
        assert_eq!(why_not, "no line for the cell is named **");
        let command = |line: &str| own_command(line, &store).map(|line| line.text);
        let pause = Ok("== PAUSE -- 0 -- 0 0 -- 0 -- 0".to_owned());
        assert_eq!((command("PAUSE"), command(" == PAUSE")), (pause.clone(), pause));
        let position = "== POSITION LINKBAR1_BH +2 PFIXTURE 0 0 -- 0 -- 0";
        assert_eq!(command(position), Ok(position.to_owned()), "the held object is unknown");
        let Err(OwnLineError::Unreadable(why_not)) = command("MOVE LINKBAR9 +2") else {
            panic!("it is not a command")
        };
        assert!(why_not.contains("was expected, the line ends"), "{why_not}");
        let OwnLineError::Unreadable(why_not) = why("estop terminals now") else {
            panic!("it is not a line")
        };
        assert_eq!(why_not, "the line should end before now");
    }
}
