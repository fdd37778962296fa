//! What is shown, without a terminal: keys and pictures in, a choice of screen, tick and process out.

pub mod buffers;
pub mod cell;
pub mod drawing;
pub mod frames;
mod keys;
pub mod ladder;
pub mod link;
pub mod operating;
pub mod panels;
pub mod procedures;
pub mod process;
mod take_over;
pub mod terminal;
pub mod text_of;
pub mod units;
pub mod views;

use interfaces::{ProcessId, device::JoystickBox};

use self::{
    drawing::Drawing,
    procedures::{Begun, Sight},
};

pub use self::{
    keys::{Effect, Key},
    operating::Operating,
    procedures::Progress,
    take_over::{TakeOver, sections as take_over_sections},
    terminal::BoardTerminal,
};
use crate::{
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
    /// All screens, in the order of their keys.
    pub const ALL: [Self; 7] =
        [Self::Ladder, Self::Process, Self::Link, Self::Cell, Self::Terminal, Self::Panels, Self::Procedures];

    /// The name in the first line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ladder => "Ladder",
            Self::Process => "Process",
            Self::Link => "Link",
            Self::Cell => "Cell",
            Self::Terminal => "Terminal",
            Self::Panels => "Panels",
            Self::Procedures => "Procedures",
        }
    }
}

/// A pane of the process screen. The one that has the keys has the most lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pane {
    /// The decision table.
    #[default]
    Table,
    /// The rows that fired.
    Rows,
    /// The buffers.
    Buffers,
}

impl Pane {
    /// All panes, from the top.
    pub const ALL: [Self; 3] = [Self::Table, Self::Rows, Self::Buffers];
}

/// The tick that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The last one there is, as it goes on.
    Last,
    /// This one.
    At(u64),
}

/// How a line of text is meant. The text says the same in words or marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// As any other.
    #[default]
    Plain,
    /// Trouble.
    Trouble,
    /// The row that fired, or a value that is new.
    Marked,
    /// What stands for nothing now.
    Faint,
}

/// A line of text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text {
    /// How it is meant.
    pub tone: Tone,
    /// What it says.
    pub text: String,
}

impl Text {
    /// A line.
    #[must_use]
    pub fn new(tone: Tone, text: impl Into<String>) -> Self {
        Self { tone, text: text.into() }
    }

    /// A line as any other.
    #[must_use]
    pub fn plain(text: impl Into<String>) -> Self {
        Self::new(Tone::Plain, text)
    }
}

/// Lines under a title.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Section {
    /// The title.
    pub title: String,
    /// The lines.
    pub lines: Vec<Text>,
    /// The line that must be seen, if the section does not fit.
    pub at: usize,
}

impl Section {
    /// A section that is read from its first line.
    #[must_use]
    pub fn new(title: impl Into<String>, lines: Vec<Text>) -> Self {
        Self { title: title.into(), lines, at: 0 }
    }
}

/// What is being typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Prompt {
    /// Text that a line of the process screen must hold.
    Filter(String),
    /// A tick to go to.
    Tick(String),
    /// A request to the run, or words of a board's terminal.
    Request(String),
    /// A field or buffer to watch, or to watch no more.
    Watch(String),
    /// Why a step of a procedure is left out.
    Reason(String),
}

/// The state of the screen.
pub struct Model {
    /// The screen.
    pub screen: Screen,
    /// The page with the keys is shown over it.
    pub help: bool,
    /// The process under the cursor.
    pub process: ProcessId,
    /// The pane that has the keys.
    pub pane: Pane,
    /// First line of the pane that is shown, counted from where it stands by itself.
    pub scroll: isize,
    /// Text that a line of a table or buffer must hold; empty for all lines.
    pub filter: String,
    /// What is being typed.
    pub prompt: Option<Prompt>,
    /// The tick that is shown.
    pub place: Place,
    /// Messages up to this tick have been acknowledged.
    pub acknowledged: u64,
    /// The answer to the last key, where it did nothing else.
    pub answer: Option<String>,
    /// How far the procedures have come.
    pub procedures: Progress,
    /// The robot is at a port, and its E-stops with it.
    pub robot_elsewhere: bool,
    /// What an operator asks for; none on a console that looks only.
    pub operating: Option<Operating>,
    /// The terminal of a board.
    pub terminal: BoardTerminal,
    /// Fields and buffers that are watched.
    pub watch: Vec<String>,
    /// The process screen shows them in the place of the buffers.
    pub shows_watch: bool,
    /// The cell screen shows the cell drawn.
    pub drawing: Option<Drawing>,
    /// It shows the table as it stands in the code.
    pub shows_source: bool,
    /// The picture.
    pub picture: Option<Picture>,
    /// The picture before it on the screen.
    pub last: Option<Picture>,
}

impl Model {
    /// The first screen.
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

    /// Show a tick of another source: nothing of the one before stays on the screen.
    pub fn show(&mut self, place: Place, process: Option<ProcessId>) {
        *self = Self { place, process: process.unwrap_or(self.process), ..Self::new(self.screen) };
    }

    /// Take the picture that is to be shown from the source.
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

    /// What a picture shows of the procedures: only what goes on, not what is looked at again.
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

    /// The tick that is shown; 0 before there is one.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.picture.as_ref().map_or(0, |picture| picture.tick.0)
    }

    /// A person is asked whether this console takes the command over.
    #[must_use]
    pub fn taking_over(&self) -> Option<TakeOver> {
        self.operating.as_ref()?.take_over
    }

    /// The joystick box as the controller reads it.
    #[must_use]
    pub fn joystick(&self) -> JoystickBox {
        self.picture.as_ref().map_or_else(JoystickBox::default, |picture| picture.external.devices.joystick)
    }

    /// The picture does not go on with the run.
    #[must_use]
    pub fn is_frozen(&self, source: &dyn Source) -> bool {
        self.place != Place::Last && source.about().state != State::Log
    }
}
