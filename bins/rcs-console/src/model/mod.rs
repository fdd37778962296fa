//! The state of the console without a terminal. Keys and pictures change it; it selects screen, tick and process.

pub mod band;
pub mod buffers;
pub mod cell;
pub mod drawing;
pub mod frames;
mod keys;
pub mod ladder;
pub mod link;
mod operating;
pub mod panels;
pub mod points;
pub mod procedures;
pub mod process;
pub mod session;
mod take_over;
pub mod terminal;
pub mod text_of;
pub mod units;
pub mod views;

use std::borrow::Cow;

use interfaces::{ProcessId, device::JoystickBox};
use os_io::units::shown;

use self::{
    drawing::Drawing,
    procedures::{Begun, Sight},
};

pub use self::{
    keys::{Effect, Key},
    procedures::Progress,
    session::Operating,
    take_over::{TakeOver, sections as take_over_sections},
    terminal::BoardTerminal,
};
use crate::rcs_console::{
    picture::Picture,
    source::{Cell, Source, State},
};

/// A screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Screen {
    /// All processes with commands, status and rows (VI.6)
    Ladder,
    /// One process: its table, its last rows, its buffers
    Process,
    /// The link to the robot, and the times of the ticks
    Link,
    /// The points of field I/O, and their couplers
    Points,
    /// Joints, sensors and parts
    Cell,
    /// Requests to the run, and its answers (IV.2)
    Terminal,
    /// Joystick box, robot controller, emergency stops (III.3.3, IV.3.3)
    Panels,
    /// Checklists of chapter IV
    Procedures,
}

impl Screen {
    /// The screens with a number. The points are a view of the link's.
    pub const ALL: [Self; 7] =
        [Self::Ladder, Self::Process, Self::Link, Self::Cell, Self::Terminal, Self::Panels, Self::Procedures];

    /// The numbered screen that shows it.
    #[must_use]
    pub const fn tab(self) -> Self {
        match self {
            Self::Points => Self::Link,
            screen => screen,
        }
    }

    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ladder => "Ladder",
            Self::Process => "Process",
            Self::Link => "Link",
            Self::Points => "Points",
            Self::Cell => "Cell",
            Self::Terminal => "Terminal",
            Self::Panels => "Panels",
            Self::Procedures => "Procedures",
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pane {
    #[default]
    Table,
    Rows,
    Buffers,
}

impl Pane {
    pub const ALL: [Self; 3] = [Self::Table, Self::Rows, Self::Buffers];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The last available tick.
    Last,
    /// A fixed tick.
    At(u64),
}

/// Emphasis of a line. Words or marks in the text have the same meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    #[default]
    Plain,
    Trouble,
    /// The row that fired, or a changed value.
    Marked,
    /// A value without meaning at present.
    Faint,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text {
    pub tone: Tone,
    pub text: String,
}

impl Text {
    /// A line, with its quantities in the user's units.
    #[must_use]
    pub fn new(tone: Tone, text: impl Into<String>) -> Self {
        let text = text.into();
        let text = match shown(&text) {
            Cow::Borrowed(_) => text,
            Cow::Owned(shown) => shown,
        };
        Self { tone, text }
    }

    /// A line of a file or a buffer, in the units of the data.
    #[must_use]
    pub fn verbatim(tone: Tone, text: impl Into<String>) -> Self {
        Self { tone, text: text.into() }
    }

    #[must_use]
    pub fn plain(text: impl Into<String>) -> Self {
        Self::new(Tone::Plain, text)
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    pub title: String,
    pub lines: Vec<Text>,
    pub at: usize, // the line that must be visible if the section does not fit
}

impl Section {
    /// A section that is shown from its first line.
    #[must_use]
    pub fn new(title: impl Into<String>, lines: Vec<Text>) -> Self {
        Self { title: title.into(), lines, at: 0 }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Prompt {
    /// Filter for the lines of the process screen.
    Filter(String),
    Tick(String),
    /// A request to the run, or words of a board's terminal.
    Request(String),
    /// Field or buffer to watch, or to stop watching.
    Watch(String),
    /// Reason for skipping a step of a procedure.
    Reason(String),
}

pub struct Model {
    pub screen: Screen,
    pub help: bool, // the help page covers the screen
    pub process: ProcessId,
    pub pane: Pane, // with the keyboard focus
    /// First visible line of the pane, relative to its default position.
    pub scroll: isize,
    pub filter: String,         // for lines of a table or buffer; empty for all
    pub prompt: Option<Prompt>, // the present text input
    pub place: Place,           // the tick on the screen
    /// Last tick whose messages have been acknowledged.
    pub acknowledged: u64,
    /// Answer to the last key, if it had no other effect.
    pub answer: Option<String>,
    pub procedures: Progress,
    /// True if a port connects the robot and its E-stops, so that they are not simulated.
    pub robot_elsewhere: bool,
    /// True if the run ends when this console quits (`rcs-run --console`).
    pub ends_run: bool,
    pub operating: Option<Operating>, // `None` without `--operate`
    pub terminal: BoardTerminal,
    pub watch: Vec<String>,
    /// True if the process screen shows the watched fields instead of the buffers.
    pub shows_watch: bool,
    pub drawing: Option<Drawing>, // of the cell screen, if it is on
    /// True if the process screen shows the table's source text.
    pub shows_source: bool,
    pub picture: Option<Picture>,
    pub last: Option<Picture>, // the previous picture on the screen
}

impl Model {
    #[must_use]
    pub fn new(screen: Screen) -> Self {
        Self {
            screen,
            help: false,
            process: ProcessId::Task,
            pane: Pane::default(),
            scroll: 0,
            filter: String::new(),
            prompt: None,
            place: Place::Last,
            acknowledged: 0,
            answer: None,
            procedures: Progress::default(),
            robot_elsewhere: false,
            ends_run: false,
            operating: None,
            terminal: BoardTerminal::default(),
            watch: Vec::new(),
            shows_watch: false,
            drawing: None,
            shows_source: false,
            picture: None,
            last: None,
        }
    }

    /// Show a tick of another source, and discard the state of the previous source.
    pub fn show(&mut self, place: Place, process: Option<ProcessId>) {
        *self = Self { place, process: process.unwrap_or(self.process), ..Self::new(self.screen) };
    }

    pub fn take(&mut self, source: &dyn Source) {
        let Some((first, last)) = source.range() else { return };
        let wanted = match self.place {
            Place::Last => last,
            Place::At(tick) => tick.clamp(first, last),
        };
        let known = self.picture.as_ref().map(|picture| picture.tick.0);
        if known == Some(wanted) {
            return;
        }
        let Some(picture) = source.picture(wanted) else { return };
        if known != Some(picture.tick.0) {
            self.last = self.picture.replace(picture);
            self.look_at_procedures(source);
        }
    }

    /// Update the procedures from a picture, unless it is one of the past.
    fn look_at_procedures(&mut self, source: &dyn Source) {
        if let (Some(picture), Place::Last) = (&self.picture, self.place) {
            let cell = source.cell(picture.tick.0);
            self.robot_elsewhere = matches!(cell, Cell::NotPublished);
            if let Some(operating) = &mut self.operating {
                operating.look(picture);
            }
            let (operating, begun) = (self.operating.as_ref(), Begun::default());
            self.procedures.look(&Sight { picture, cell: &cell, operating, begun });
        }
    }

    #[must_use]
    pub fn tick(&self) -> u64 {
        self.picture.as_ref().map_or(0, |picture| picture.tick.0)
    }

    #[must_use]
    pub fn operates(&self) -> bool {
        self.operating.as_ref().is_some_and(|operating| operating.lost.is_none())
    }

    /// True if the job waits for an operator. A viewer cannot detect this.
    #[must_use]
    pub fn job_waits(&self) -> bool {
        self.operates() && self.operating.as_ref().is_some_and(Operating::job_waits)
    }

    /// The open question whether to take the command over, if any.
    #[must_use]
    pub fn taking_over(&self) -> Option<TakeOver> {
        self.operating.as_ref()?.take_over
    }

    #[must_use]
    pub fn joystick(&self) -> JoystickBox {
        self.picture.as_ref().map_or_else(JoystickBox::default, |picture| picture.external.devices.joystick)
    }

    /// True if the picture does not follow the run.
    #[must_use]
    pub fn is_frozen(&self, source: &dyn Source) -> bool {
        self.place != Place::Last && source.about().state != State::Log
    }
}
