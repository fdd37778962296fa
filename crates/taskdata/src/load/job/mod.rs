//! Job files: commands of the workstation controller, and actions of the workstation between them.
//!
//! A line that begins with `==` is a Task command with the nine fields of Figure VIII.4, the variables of V.4.2
//! without the serial number (SPECNOTES.md, contradiction 25): object, source grip, location and sector, destination
//! grip, location and sector, end-at location and sector; `--` is a null field. Extensions: a serial number, `#17`,
//! and `expect error` for a command that must fail. Lines that begin with `**` are actions of the workstation, which
//! the manual leaves to the HWSC:
//!
//! ```text
//! ** tray UNIT_1 4 LINKBAR1_BH            a part is delivered into a sector, at a random position (seed of the run)
//! ** tray UNIT_1 4 LINKBAR1_BH 50 -20 1500   or at an x, y (0.01 in) and an angle (0.01 degree) from its centre
//! ** vise partial|close|open PFIXTURE [CLEVIS]  the jaws of a vise move, from here on with a program
//! ** machine LINKBAR1_BH LINKBAR1 PFIXTURE  the blank in a vise or a nest becomes the finished part
//! ** drum grip|release                     the tool drum closes or opens its fingers
//! ** drum tool ENDMILL-1                   a tool is put into the drum
//! ** joystick frame WORLD|TOOL|TOOL-ORIGIN|WRIST-ORIGIN|OFF
//! ** joystick stick 1000 -500 25           X, Y (-1000 to 1000) for 25 ticks
//! ** joystick up|down|roll+|roll-|open|close 25   a button, for 25 ticks
//! ** joystick velocity 500                 the knob (0 to 1000)
//! ** joystick record, ** joystick resume   the record button, and the carriage return after it
//! ** joystick hold|free EMOVE              a process is suspended, or continues
//! ** joystick step EMOVE [3]               a suspended process runs once, or 3 times
//! ** estop joystick-box                    an emergency stop is pressed: control-panel, teach-pendant, terminals,
//!                                          joystick-box, pedestal
//! ** release joystick-box                  it is pulled out again
//! ** panel fault-reset                     a key of the robot controller: power on|off, fault-reset, hydraulics
//!                                          enable|disable, manual on|off, align [AXIS], auto, cycle-start,
//!                                          interrupt, cancel, enter, hold on|off
//! ** wait 50                               the job waits for 50 ticks
//! ** load more.blk                         blocks are loaded, which take effect with the next command
//! ** after 50 joystick hold PRIM           any of these, 50 ticks after the next command was sent
//! ```
//!
//! Commands and their paths are checked against the task data ([`verdict`](super::verdict)): a job that cannot run is
//! refused before the first tick.

mod action;
mod fields;
mod own_line;
mod panels;
mod read;
mod reload;
mod workstation;

use std::path::Path;

use diagnostics::{At, Diagnostics, Places, Problems, Source, lines_of};
use interfaces::hws::HwsCommand;

pub use own_line::{OwnLineError, is_command, own_command, own_line, reported_command};
pub use reload::Reload;

pub use action::{Drum, Offset, Workstation};
pub use interfaces::station::ViseOpening;

use super::{
    Part, Store,
    source::{SourceLine, read},
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    Command(HwsCommand), // with number 0
    Workstation(Workstation),
    After {
        ticks: u32, // after that command is sent
        action: Workstation,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub struct JobLine {
    pub step: Step,
    pub text: String, // as written, without its comment
    pub line: u32,    // from 1
    /// The line ends with `expect error`: its command must fail, or its blocks must not fit the cell.
    pub expects_error: bool,
}

#[derive(Clone, Debug)]
pub struct Job {
    pub name: String,         // file name without its extension
    pub steps: Vec<JobLine>,  // in order
    pub reloads: Vec<Reload>, // of the lines `** load`, in order
    source: Source,
}

impl Job {
    /// Reads a job file and checks it against the task data. Errors: the report with every error of the job.
    pub fn load(path: &Path, store: &Store) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        match read(path, &path.display().to_string()) {
            Ok(source) => Self::from_source(source, store).and_then(Self::with_a_line),
            Err(error) => {
                let mut problems = Problems::default();
                problems.unreadable(&path.display().to_string(), &error);
                Err(Box::new(Diagnostics::without_text(problems)))
            }
        }
    }

    /// Checks a job against data with errors: each line by itself, and misspelt names.
    #[must_use]
    pub fn check_part(path: &Path, part: &Part) -> Diagnostics {
        let mut problems = Problems::default();
        let source = match read(path, &path.display().to_string()) {
            Ok(source) => source,
            Err(error) => {
                problems.unreadable(&path.display().to_string(), &error);
                return Diagnostics::without_text(problems);
            }
        };
        let mut reader = read::Reader::new(part.store.view(), Vec::new(), &mut problems).among(part);
        let steps = source_lines(&source).filter_map(|(number, line)| reader.line(number, &line)).count();
        reader.end();
        if steps == 0 && !problems.has_errors() {
            empty(&mut problems);
        }
        Diagnostics::of_file(problems, &source)
    }

    fn with_a_line((job, report): (Self, Diagnostics)) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        if !job.steps.is_empty() {
            return Ok((job, report));
        }
        let mut problems = Problems::default();
        empty(&mut problems);
        let sources = std::slice::from_ref(&job.source);
        Err(Box::new(report.with(Diagnostics::new(problems, Places::in_lines(sources), 0, Vec::new()))))
    }

    /// Checks a job from another source, such as the attachment of a log.
    pub fn from_source(source: Source, store: &Store) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let mut problems = Problems::default();
        let reloads = reload::reloads(&source, store, &mut problems);
        let views = reloads.iter().map(|reload| reload.store.view()).collect();
        let mut reader = read::Reader::new(store.view(), views, &mut problems);
        let steps = source_lines(&source).filter_map(|(number, line)| reader.line(number, &line)).collect();
        reader.end();
        let failed = problems.has_errors();
        let report = Diagnostics::of_file(problems, &source);
        if failed {
            return Err(Box::new(report));
        }
        let file = Path::new(&source.name).file_stem().map(|s| s.to_string_lossy().into_owned());
        Ok((Self { name: file.unwrap_or_default(), steps, reloads, source }, report))
    }

    #[must_use]
    pub fn reload(&self, number: u32) -> Option<&Reload> {
        self.reloads.get(usize::try_from(number).ok()?.checked_sub(1)?)
    }

    #[must_use]
    pub const fn source(&self) -> &Source {
        &self.source
    }
}

fn empty(problems: &mut Problems) {
    let help = "a line with == sends a command, a line with ** says what the workstation does";
    problems.error_help("job.empty", At::default(), "the job has no line", help);
}

fn source_lines(source: &Source) -> impl Iterator<Item = (u32, SourceLine<'_>)> {
    let short = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
    let line = move |(start, text): (usize, _)| SourceLine {
        text,
        at: At { source: 0, start: short(start), length: short(text.len()) },
    };
    (1..)
        .zip(lines_of(&source.text))
        .filter(|(_, (_, text))| !text.starts_with("BLOCK#"))
        .map(move |(number, found)| (number, line(found)))
}
