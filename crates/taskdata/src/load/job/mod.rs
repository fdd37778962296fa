//! Job files: what the workstation controller sends, and what the workstation does in between.
//!
//! A job is a text of lines. `==` begins a Task command with the nine fields of Figure VIII.4, which are the variables of
//! V.4.2 without the serial number (contradiction 25): object, source grip, location and sector, destination grip, location
//! and sector, end-at location and sector; `--` is a null field. The manual's own forms of lines end there: vise, trays and
//! machine belong to the HWSC, not to the robot. Lines that begin with `**` say what they do:
//!
//! ```text
//! ** tray UNIT_1 4 LINKBAR1_BH            a part is delivered into a sector, somewhere (a seed decides)
//! ** tray UNIT_1 4 LINKBAR1_BH 50 -20 1500   or at an x, y (0.01 in) and an angle (0.01 degree) from its centre
//! ** vise partial|close|open PFIXTURE      the jaws of a vise move
//! ** machine LINKBAR1_BH LINKBAR1 PFIXTURE  the blank in a vise becomes the finished part
//! ```
//!
//! Commands are checked against the task data, and so is the way from each to the next: a job which cannot run is refused
//! before the first tick.

mod read;
mod walk;

use std::path::Path;

use rcs_core::{interface::hws::HwsCommand, name::Name16};

use crate::files::Location;

use super::{
    Store,
    report::{Problems, Report},
    source::{At, Line, Source, lines_of, read},
};

/// Input commands of Task (V.4.1).
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

/// How far a vise is to open or close (VIII.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViseOpening {
    /// Far enough to put a blank in, near enough to hold it upright.
    Partial,
    /// On the part.
    Close,
    /// Wide enough to take the part out, or to let it drop onto the ledge.
    Open,
}

/// Where a part lies in its sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// From the centre of the sector along world X, 0.01 in.
    pub x: i32,
    /// From the centre of the sector along world Y, 0.01 in.
    pub y: i32,
    /// Angle about world Z, 0.01 degree.
    pub angle: i32,
}

/// What the workstation itself does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Workstation {
    /// A part is delivered into a sector of a tray.
    Tray {
        /// The sector, resolved for the part.
        location: Location,
        /// The part.
        object: Name16,
        /// Where in the sector; `None` leaves it to the seed of the run.
        offset: Option<Offset>,
    },
    /// A vise moves its jaws.
    Vise {
        /// How far.
        opening: ViseOpening,
        /// The vise.
        location: Location,
    },
    /// A part is machined in a vise.
    Machine {
        /// What goes in.
        blank: Name16,
        /// What comes out.
        part: Name16,
        /// The vise.
        location: Location,
    },
}

/// A step of a job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A command to Task, its number still 0.
    Command(HwsCommand),
    /// Something that the workstation does.
    Workstation(Workstation),
}

/// A step with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct JobLine {
    /// The step.
    pub step: Step,
    /// The line as written, without its comment.
    pub text: String,
    /// Line of the file from 1.
    pub line: u32,
}

/// A job.
#[derive(Clone, Debug)]
pub struct Job {
    /// Name of the job: the file's name without its extension.
    pub name: String,
    /// Its steps in order.
    pub steps: Vec<JobLine>,
    source: Source,
}

impl Job {
    /// Read a job file and check it against the task data.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the job is in it.
    pub fn load(path: &Path, store: &Store) -> Result<(Self, Report), Box<Report>> {
        match read(path, &path.display().to_string()) {
            Ok(source) => Self::from_source(source, store),
            Err(error) => {
                let mut problems = Problems::default();
                problems.unreadable(&path.display().to_string(), &error);
                Err(Box::new(Report::new(problems, &[], 0, Vec::new())))
            }
        }
    }

    /// Check a job that was read elsewhere, such as the attachment of a log.
    ///
    /// # Errors
    /// The report, if it holds an error.
    pub fn from_source(source: Source, store: &Store) -> Result<(Self, Report), Box<Report>> {
        let mut problems = Problems::default();
        let mut reader = read::Reader::new(store.view(), &mut problems);
        let steps = source_lines(&source).filter_map(|line| reader.line(&line)).collect();
        let failed = problems.has_errors();
        let report = Report::new(problems, std::slice::from_ref(&source), 0, Vec::new());
        if failed {
            return Err(Box::new(report));
        }
        let file = Path::new(&source.name).file_stem().map(|s| s.to_string_lossy().into_owned());
        Ok((Self { name: file.unwrap_or_default(), steps, source }, report))
    }

    /// The text that the job was read from.
    #[must_use]
    pub const fn source(&self) -> &Source {
        &self.source
    }
}

fn source_lines(source: &Source) -> impl Iterator<Item = Line<'_>> {
    let short = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
    lines_of(&source.text).enumerate().filter(|(_, (_, text))| !text.starts_with("BLOCK#")).map(
        move |(number, (start, text))| {
            let line = short(number).saturating_add(1);
            let at = At {
                source: 0,
                block: None,
                line,
                column: 1,
                start: short(start),
                length: short(text.len()),
            };
            Line { text, at }
        },
    )
}
