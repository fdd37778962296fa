use closed_loop::account::Account;
use interfaces::ProcessId;

use super::{Model, Pane, Place, Prompt, Screen, buffers, drawing::Drawing, ladder, views::fields_named};
use crate::rcs_console::{
    source::{Source, State},
    story::process_named,
};

const SECOND: u64 = 25;
const PAGE: usize = 8;

/// A key, independent of the terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    Char(char),
    Enter,
    Esc,
    Tab,
    BackTab,
    Up,
    Down,
    Left,
    Right,
    PageUp,
    PageDown,
    Home,
    End,
    Backspace,
    F1,
    F2,
    Interrupt,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    Draw,
    Quit,
    /// Open the log of this run at the first cause of its failure.
    OpenLog,
}

impl Model {
    pub fn key(&mut self, key: Key, source: &dyn Source) -> Effect {
        self.answer = None;
        if self.screen == Screen::Terminal && self.prompt.is_none() && self.edit(key) {
            return Effect::Draw;
        }
        if key == Key::Interrupt && !(self.screen == Screen::Terminal && self.operating.is_some()) {
            return Effect::Quit;
        }
        if let Some(prompt) = self.prompt.take() {
            self.type_on(prompt, key, source);
        } else if self.help {
            self.help = false;
            if matches!(key, Key::Char(' ' | '!') | Key::F1) {
                self.operate(key);
            }
        } else if !self.take_over(key)
            && !self.is_of_the_terminal(key, source)
            && !self.operate(key)
            && !self.is_of_a_procedure(key, source)
        {
            return self.command(key, source);
        }
        Effect::Draw
    }

    fn is_of_the_terminal(&mut self, key: Key, source: &dyn Source) -> bool {
        let runs = !matches!(source.about().state, State::Over | State::Log);
        self.screen == Screen::Terminal && self.work_the_terminal(key, runs)
    }

    fn is_of_a_procedure(&mut self, key: Key, source: &dyn Source) -> bool {
        self.screen == Screen::Procedures && self.work_a_procedure(key, source)
    }

    fn command(&mut self, key: Key, source: &dyn Source) -> Effect {
        match key {
            Key::Char('q') => return Effect::Quit,
            Key::Char('o') => return Effect::OpenLog,
            Key::Char('?') => self.help = true,
            Key::Char(digit @ '1'..='7') => {
                let at = digit.to_digit(10).and_then(|digit| usize::try_from(digit).ok());
                self.turn_to(Screen::ALL[at.map_or(0, |at| at - 1)]);
            }
            Key::Char('/') => self.prompt = Some(Prompt::Filter(self.filter.clone())),
            Key::Char('g') => self.prompt = Some(Prompt::Tick(String::new())),
            Key::Char('a') => self.acknowledged = self.tick(),
            Key::Char('v') if self.screen == Screen::Cell => self.draw_or_not(source),
            Key::Char('v') if self.screen == Screen::Link => self.turn_to(Screen::Points),
            Key::Char('v') if self.screen == Screen::Points => self.turn_to(Screen::Link),
            Key::Char('s') if self.screen == Screen::Process => {
                (self.pane, self.scroll) = (Pane::Table, 0);
                self.shows_source = !self.shows_source;
            }
            Key::Char('v') if self.screen == Screen::Process => self.turn_to_watch(),
            Key::Char('w') if self.screen == Screen::Process => {
                self.prompt = Some(Prompt::Watch(String::new()));
            }
            Key::Char('p') => self.freeze(source),
            Key::Char('[') => self.go(self.tick().saturating_sub(1), source),
            Key::Char(']') => self.go(self.tick() + 1, source),
            Key::Char('{') => self.go(self.tick().saturating_sub(SECOND), source),
            Key::Char('}') => self.go(self.tick() + SECOND, source),
            Key::Home => self.go(0, source),
            Key::End => self.place = Place::Last,
            Key::Char('n') => self.go_to_change(true, source),
            Key::Char('N') => self.go_to_change(false, source),
            Key::Char('t') => self.go_to_trouble(true, source),
            Key::Char('T') => self.go_to_trouble(false, source),
            Key::Char('c') => self.go_to_cause(source),
            Key::Char('j') | Key::Down => self.down(1),
            Key::Char('k') | Key::Up => self.up(1),
            Key::PageDown => self.down(PAGE),
            Key::PageUp => self.up(PAGE),
            Key::Tab => self.pane(1),
            Key::BackTab => self.pane(Pane::ALL.len() - 1),
            Key::Enter if self.screen == Screen::Ladder => self.turn_to(Screen::Process),
            Key::Esc if !self.filter.is_empty() => self.filter.clear(),
            Key::Esc => self.turn_to(Screen::Ladder),
            _ => self.answer = Some("this key does nothing here; ? lists the keys".to_owned()),
        }
        Effect::Draw
    }

    pub fn limit_scroll(&mut self, up: usize, down: usize) {
        let least = 0_isize.saturating_sub_unsigned(up);
        self.scroll = self.scroll.clamp(least, 0_isize.saturating_add_unsigned(down));
    }

    fn turn_to(&mut self, screen: Screen) {
        (self.screen, self.scroll) = (screen, 0);
    }

    fn pane(&mut self, by: usize) {
        let at = Pane::ALL.iter().position(|pane| *pane == self.pane).unwrap_or_default();
        (self.pane, self.scroll) = (Pane::ALL[(at + by) % Pane::ALL.len()], 0);
    }

    fn down(&mut self, by: usize) {
        match self.screen {
            Screen::Ladder => self.process = ladder::neighbour(self.process, by, true),
            _ => self.scroll = self.scroll.saturating_add_unsigned(by),
        }
    }

    fn up(&mut self, by: usize) {
        match self.screen {
            Screen::Ladder => self.process = ladder::neighbour(self.process, by, false),
            _ => self.scroll = self.scroll.saturating_sub_unsigned(by),
        }
    }

    fn draw_or_not(&mut self, source: &dyn Source) {
        self.scroll = 0;
        if self.drawing.take().is_some() {
            return;
        }
        let drawing = match source.cell_text() {
            Some(text) => Drawing::of(text),
            None => Drawing::load(self.terminal.library.directory()),
        };
        match drawing {
            Ok(drawing) => self.drawing = Some(drawing),
            Err(why) => self.answer = Some(format!("the cell cannot be drawn: {why}")),
        }
    }

    fn turn_to_watch(&mut self) {
        (self.pane, self.scroll, self.shows_watch) = (Pane::Buffers, 0, !self.shows_watch);
    }

    fn watch_or_not(&mut self, name: &str) {
        let mut found: Vec<String> = fields_named(name, &[]).into_iter().map(str::to_owned).collect();
        if buffers::paths().any(|path| buffers::is_within(path, name)) {
            found = vec![name.to_owned()];
        }
        if found.is_empty() {
            self.answer = Some(format!("no field and no buffer is named {name}; screen 2 has their names"));
            return;
        }
        let known = found.iter().all(|path| self.watch.contains(path));
        self.watch.retain(|path| !found.contains(path));
        if !known {
            self.watch.append(&mut found);
        }
        (self.pane, self.scroll, self.shows_watch) = (Pane::Buffers, 0, true);
    }

    fn freeze(&mut self, source: &dyn Source) {
        if source.about().state == State::Log {
            self.answer = Some("a log does not run: [ ] moves a tick, { } a second".to_owned());
        } else {
            self.place = match self.place {
                Place::Last => Place::At(self.tick()),
                Place::At(_) => Place::Last,
            };
        }
    }

    fn go(&mut self, tick: u64, source: &dyn Source) {
        let Some((first, last)) = source.range() else { return };
        self.answer = match tick {
            tick if tick < first && self.tick() == first => Some(format!("tick {first} is the first one")),
            tick if tick > last && self.tick() == last => Some(format!("tick {last} is the last one")),
            _ => None,
        };
        self.place = Place::At(tick.clamp(first, last));
    }

    /// Go to the next or previous change: of this process on the process screen, otherwise of any process.
    fn go_to_change(&mut self, forward: bool, source: &dyn Source) {
        let processes = match self.screen {
            Screen::Process => std::slice::from_ref(&self.process),
            _ => ProcessId::ALL,
        };
        match source.story().change(processes, self.tick(), forward) {
            Some(tick) => self.go(tick, source),
            None => self.answer = Some(nothing("change", forward)),
        }
    }

    fn go_to_trouble(&mut self, forward: bool, source: &dyn Source) {
        match source.story().trouble(self.tick(), forward) {
            Some((tick, process)) => {
                self.go(tick, source);
                self.process = process.unwrap_or(self.process);
            }
            None => self.answer = Some(nothing("trouble", forward)),
        }
    }

    /// Go to the first cause of the last failure, and to the process that reports it.
    fn go_to_cause(&mut self, source: &dyn Source) {
        match source.story().account() {
            Some(Account { first, .. }) => {
                self.go(source.story().shown_at(&first), source);
                self.process = process_named(&first.process).unwrap_or(self.process);
            }
            None => self.answer = Some("nothing has gone wrong that stops the work".to_owned()),
        }
    }

    /// Handle a key while text is typed: only Enter, Esc, Control-C and F1 end the input.
    fn type_on(&mut self, mut prompt: Prompt, key: Key, source: &dyn Source) {
        if key == Key::F1 {
            self.operate(key);
            return;
        }
        let text = match &mut prompt {
            Prompt::Filter(text) | Prompt::Tick(text) | Prompt::Reason(text) | Prompt::Watch(text) => text,
            Prompt::Request(text) => return self.type_request(std::mem::take(text), key),
        };
        match key {
            Key::Char(typed) => text.push(typed),
            Key::Backspace => drop(text.pop()),
            Key::Enter => return self.typed(prompt, source),
            Key::Esc | Key::Interrupt => return,
            _ => {}
        }
        self.prompt = Some(prompt);
    }

    fn typed(&mut self, prompt: Prompt, source: &dyn Source) {
        match prompt {
            Prompt::Filter(text) => (self.filter, self.scroll) = (text, 0),
            Prompt::Request(_) => {}
            Prompt::Reason(reason) => self.leave_out(reason),
            Prompt::Watch(name) => self.watch_or_not(name.trim()),
            Prompt::Tick(text) => match text.trim().parse() {
                Ok(tick) => self.go(tick, source),
                Err(_) => self.answer = Some(format!("a tick is a number such as 623; found {text:?}")),
            },
        }
    }
}

fn nothing(what: &str, forward: bool) -> String {
    format!("there is no {what} {}", if forward { "after this tick" } else { "before this tick" })
}
