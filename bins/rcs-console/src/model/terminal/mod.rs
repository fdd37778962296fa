//! The terminal of a board (IV.2): words that execute, show and list, and requests in modern words.

pub mod complete;
mod disk;
pub mod editor;
pub mod library;
pub mod pointer;
mod said;
mod screen;
mod teach;
mod words;

use std::path::PathBuf;

use interfaces::{
    ProcessId,
    operator::{BOARDS as RUNNING, Variable},
};
use taskdata::load::{BlockNumber, commands};

use self::{
    editor::{Editor, EditorRequest},
    library::Library,
    teach::PoseLesson,
    words::{Interpreter, is_of_terminal},
};
use super::{Key, Model, Operating, Text, Tone, views::ShowWord};

pub use self::{screen::sections, words::known};

/// The boards of the terminals (IV.2.2).
pub const BOARDS: [u8; 6] = [0, 2, 4, 6, 8, 12];
const KEPT: usize = 100; // number of typed lines that are kept
/// The characters, in addition to digits, that are keys on this screen; all others begin a line.
const KEYS: &str = " !:?[]{}";

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    #[default]
    Run,
    Show,
}

#[derive(Clone, Debug)]
pub struct Board {
    pub number: u8,
    pub mode: Mode,
    /// Offset of the area for LIST and LOAD.
    pub offset: u32,
    pub vocabulary: &'static str,
    pub shown: Option<&'static ShowWord>,
    /// The last variable shown, if it can be written.
    pub variable: Option<Variable>,
}

impl Default for Board {
    /// Board 6, at which commands for Task are entered.
    fn default() -> Self {
        Self {
            number: 6,
            mode: Mode::Run,
            offset: commands::OFFSET,
            vocabulary: "SDEF",
            shown: None,
            variable: None,
        }
    }
}

impl Board {
    pub fn turn_to(&mut self, number: u8) {
        if self.number != number {
            *self = Self { number, offset: self.offset, ..Self::default() };
        }
    }

    pub fn processes(&self) -> impl Iterator<Item = ProcessId> + use<> {
        let number = self.number;
        ProcessId::ALL.iter().copied().filter(move |process| process.board() == number)
    }

    /// The variables of its processes that can be written.
    fn variables(&self) -> impl Iterator<Item = Variable> + use<> {
        let number = self.number;
        Variable::ALL.iter().copied().filter(move |variable| variable.owner().board() == number)
    }

    fn buffers(&self) -> Vec<&'static str> {
        let mut found: Vec<_> = self.processes().map(ProcessId::field).collect();
        match self.number {
            6 => found.extend(["hws", "data_base", "emove.status", "pedestal.status"]),
            2 => found.extend(["subtask.emove", "t3i.status"]),
            4 => found.push("prim.t3i"),
            8 => found.extend(["emove.quick_change", "emove.grip", "emove.v_grip", "emove.tool_grip"]),
            _ => {}
        }
        found
    }
}

#[derive(Clone, Debug)]
struct Typed {
    board: u8,
    line: String,
    said: Vec<Text>,
    after: u64, // number of earlier requests
}

#[derive(Default)]
pub struct BoardTerminal {
    pub board: Board,
    pub library: Library,
    pub editor: Option<Editor>,
    listed: Option<BlockNumber>, // the block that was listed last; F2 opens it
    typed: Vec<Typed>,
}

impl BoardTerminal {
    #[must_use]
    pub fn of(directory: PathBuf) -> Self {
        Self { library: Library::of(directory), ..Self::default() }
    }

    fn note(&mut self, line: &str, said: Vec<Text>, after: u64) {
        if self.typed.len() == KEPT {
            self.typed.remove(0);
        }
        self.typed.push(Typed { board: self.board.number, line: line.to_owned(), said, after });
    }
}

impl Model {
    pub(super) fn enter(&mut self, line: &str) {
        let terminal = &mut self.terminal;
        let sent = self.operating.as_ref().map_or(0, Operating::count);
        // `rcs-run send` also accepts this prefix.
        let line = line.strip_prefix("send ").map_or(line, str::trim_start);
        if !is_of_terminal(line, terminal.board.mode) {
            match &mut self.operating {
                Some(operating) => operating.ask(line),
                None => terminal.note(line, vec![look_only()], sent),
            }
            return;
        }
        let (picture, last) = (self.picture.as_ref(), self.last.as_ref());
        let outcome =
            Interpreter::new(&mut terminal.board, &mut terminal.library, picture, last).interpret(line);
        let mut said = outcome.said;
        match &mut self.operating {
            Some(operating) => outcome.asks.into_iter().for_each(|line| operating.ask(line)),
            None if outcome.asks.is_empty() => {}
            None => said.push(look_only()),
        }
        terminal.listed = outcome.listed.or(terminal.listed);
        let (edits, teaches) = (outcome.edits, outcome.teaches);
        terminal.note(line, said, sent);
        if let Some(number) = edits {
            self.begin_edit(number);
        }
        if let Some(lesson) = teaches {
            self.begin_lesson(&lesson);
        }
    }

    /// The reason why a board's blocks cannot be edited now (IV.2.3).
    fn cannot_edit(&self) -> Option<String> {
        let board = self.terminal.board.number;
        if self.operating.is_none() {
            return Some("this console is read-only: start it with --operate to edit blocks".to_owned());
        }
        if !RUNNING.contains(&board) {
            return Some(format!("board {board} has no processes to stop: Tab turns to the next board"));
        }
        let picture = self.picture.as_ref()?;
        let runs = !picture.external.operator.is_stopped(board);
        runs.then(|| format!("board {board} runs: ^C stops it before its blocks are edited (IV.2.3)"))
    }

    fn begin_edit(&mut self, number: BlockNumber) {
        if let Some(why) = self.cannot_edit() {
            self.answer = Some(why);
            return;
        }
        let library = &mut self.terminal.library;
        library.forget();
        let directory = library.directory().to_owned();
        match Editor::begin(number, &directory, library.sources()) {
            Ok(editor) => self.terminal.editor = Some(editor),
            Err(why) => self.answer = Some(why),
        }
    }

    /// Open the editor with the form of the recorded pose, or show the reason why it cannot be opened.
    fn begin_lesson(&mut self, lesson: &PoseLesson) {
        if let Some(why) = self.cannot_edit() {
            self.answer = Some(why);
            return;
        }
        let Some(picture) = &self.picture else { return };
        let library = &mut self.terminal.library;
        library.forget();
        let directory = library.directory().to_owned();
        match lesson.begin(picture, &directory, library.sources()) {
            Ok(editor) => self.terminal.editor = Some(editor),
            Err(why) => self.answer = Some(why),
        }
    }

    pub(super) fn edit(&mut self, key: Key) -> bool {
        let Some(editor) = self.terminal.editor.as_mut().filter(|_| key != Key::F1) else { return false };
        match editor.key(key) {
            EditorRequest::None => {}
            EditorRequest::Say(what) => self.answer = Some(what.to_owned()),
            EditorRequest::Close => self.terminal.editor = None,
            EditorRequest::Write => self.write_block(),
        }
        true
    }

    fn write_block(&mut self) {
        if let Some(why) = self.cannot_edit() {
            self.answer = Some(why);
            return;
        }
        let Some(editor) = &self.terminal.editor else { return };
        if let Err(why) = editor.write() {
            self.answer = Some(why);
            return;
        }
        let request = editor.request();
        self.terminal.editor = None;
        self.terminal.library.forget();
        if let Some(operating) = &mut self.operating {
            operating.ask(request);
        }
    }

    #[must_use]
    pub fn terminal_prompt(&self) -> String {
        let board = &self.terminal.board;
        match (self.screen, board.mode) {
            (super::Screen::Terminal, Mode::Run) => format!("board {} :R", board.number),
            (super::Screen::Terminal, Mode::Show) => format!("board {} :S", board.number),
            _ => String::new(),
        }
    }

    /// Handle a key that only the terminal has, or begin a line with it. Returns false for other keys.
    pub(super) fn work_the_terminal(&mut self, key: Key, runs: bool) -> bool {
        let is_recording = self.picture.as_ref().is_some_and(|picture| picture.memory.prim.status.recording);
        let board = &mut self.terminal.board;
        let at = BOARDS.iter().position(|number| *number == board.number).unwrap_or_default();
        match key {
            Key::Tab => board.turn_to(BOARDS[(at + 1) % BOARDS.len()]),
            Key::BackTab => board.turn_to(BOARDS[(at + BOARDS.len() - 1) % BOARDS.len()]),
            Key::Char(':') => self.prompt = Some(super::Prompt::Request(String::new())),
            Key::F2 => match self.terminal.listed {
                Some(number) => self.begin_edit(number),
                None => self.answer = Some("n LIST lists a block, F2 edits it; so does n EDIT".to_owned()),
            },
            Key::Interrupt if self.operating.is_some() => self.enter("^C"),
            // The carriage return after the record button (III.3.3).
            Key::Enter if is_recording && board.number == ProcessId::Prim.board() => {
                match &mut self.operating {
                    Some(operating) => operating.ask("joystick resume"),
                    None => return false,
                }
            }
            Key::Esc if board.shown.is_some() => board.shown = None,
            Key::Char('0' | '8' | '9') => {
                self.answer = Some("a line that begins with a number begins with :".to_owned())
            }
            Key::Char(typed) if !KEYS.contains(typed) && !typed.is_ascii_digit() => match &mut self.operating
            {
                Some(operating) if runs && operating.lost.is_none() => {
                    operating.back = 0;
                    self.prompt = Some(super::Prompt::Request(typed.to_string()));
                }
                Some(_) | None => return false,
            },
            _ => return false,
        }
        true
    }
}

fn look_only() -> Text {
    Text::new(Tone::Trouble, "!!this console is read-only: start it with --operate to work on the run")
}
