//! A line of the workstation that stands in no job: another process says it while the robot runs.
//!
//! It is read from its words and the task data alone. No file is opened for it, since that could take any
//! time, and would tell the connected system which files there are.

use std::fmt;

use super::{
    super::{
        Store,
        lex::words_of_line,
        places::Places,
        report::{Diagnostics, Problems},
        source::{At, Source, SourceLine},
    },
    Workstation,
    fields::Fields,
    read::Reader,
};

/// Why a line is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OwnLineError {
    /// It says nothing.
    Nothing,
    /// A job's blocks are read and checked before its first tick.
    Load,
    /// The ticks of a job are those of its player.
    Wait,
    /// So are those behind a command.
    After,
    /// The workstation controller commands already.
    HandOver,
    /// It is no line, or speaks of what the task data do not have.
    Unreadable(String),
}

impl fmt::Display for OwnLineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nothing => "a line for the cell was expected, such as vise close PFIXTURE; found none",
            Self::Load => {
                "load stands in the controller's own jobs only, whose blocks are read before the first tick"
            }
            Self::Wait => "wait stands in jobs only: the workstation controller counts the ticks by itself",
            Self::After => {
                "after stands in jobs only: the workstation controller counts the ticks, and sends the line then"
            }
            Self::HandOver => "workstation stands in the controller's own jobs only: they hand over",
            Self::Unreadable(why) => why,
        })
    }
}

impl std::error::Error for OwnLineError {}

/// Read a line as it stands in a job, without its asterisks.
///
/// # Errors
/// [`OwnLineError`].
pub fn own_line(text: &str, store: &Store) -> Result<Workstation, OwnLineError> {
    let length = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let words = words_of_line(&SourceLine { text, at: At { source: 0, start: 0, length } });
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
        None => {
            let source = Source { name: String::new(), text: text.into() };
            let places = Places::in_lines(std::slice::from_ref(&source));
            let report = Diagnostics::new(problems, places, 0, Vec::new());
            let errors: Vec<_> = report.errors().map(|error| error.message().to_owned()).collect();
            Err(OwnLineError::Unreadable(errors.join("; ")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn what_belongs_to_a_job_is_refused_by_its_words() {
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
        let OwnLineError::Unreadable(why_not) = why("** vise open PFIXTURE") else { panic!("it is no line") };
        assert_eq!(why_not, "no line for the cell is named **");
        let OwnLineError::Unreadable(why_not) = why("estop terminals now") else { panic!("it is no line") };
        assert_eq!(why_not, "the line should end before now");
    }
}
