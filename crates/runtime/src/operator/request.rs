//! What an operator can ask of a run, and how it is said.

use interfaces::HwsCommand;
use plant::BoxAction;
use taskdata::load::{
    Store,
    job::{self, Panel, Step, Workstation},
};

use crate::workstation::at_the_box;

/// A request.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// How things stand; changes nothing.
    Status,
    /// The velocity knob to zero.
    Stop,
    /// The velocity knob back to where it was.
    Go,
    /// Another operator may command.
    Leave,
    /// Something that is to stand in the log.
    Note,
    /// The job waits when its line has ended.
    Wait,
    /// The job goes on.
    GoOn,
    /// The job goes on behind the line that was interrupted.
    Skip,
    /// A command for Task, and its line.
    Command(String, HwsCommand),
    /// Something at the operator's own joystick box.
    Box(BoxAction),
    /// Something else in the cell, and its line.
    Cell(Workstation, String),
}

/// How one asks for the status.
pub const STATUS: &str = "status";

/// The requests that are no lines of a job.
const WORDS: &[(&str, Request)] = &[
    (STATUS, Request::Status),
    ("stop", Request::Stop),
    ("go", Request::Go),
    ("leave", Request::Leave),
    ("job wait", Request::Wait),
    ("job go", Request::GoOn),
    ("job skip", Request::Skip),
];

impl Request {
    /// Read a request.
    ///
    /// # Errors
    /// A sentence.
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
        if job::is_command(line) {
            let read = job::own_command(line, store).map_err(|error| error.to_string())?;
            let Step::Command(command) = read.step else { return Err(format!("{line} is no command")) };
            return Ok(Self::Command(read.text, command));
        }
        match job::own_line(line, store).map_err(|error| error.to_string())? {
            Workstation::Joystick(action) => Ok(Self::Box(at_the_box(action))),
            action => Ok(Self::Cell(action, line.to_owned())),
        }
    }

    /// It can only bring something to rest, or changes nothing: every operator may ask for it, also while
    /// another commands.
    pub const fn is_stop(&self) -> bool {
        match self {
            Self::Status
            | Self::Stop
            | Self::Leave
            | Self::Note
            | Self::Wait
            | Self::Box(BoxAction::Hold(_)) => true,
            Self::Cell(action, _) => {
                matches!(
                    action,
                    Workstation::Press(_) | Workstation::Panel(Panel::Hold(true) | Panel::Interrupt)
                )
            }
            Self::Go | Self::GoOn | Self::Skip | Self::Command(..) | Self::Box(_) => false,
        }
    }
}
