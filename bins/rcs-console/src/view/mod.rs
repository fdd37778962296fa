//! Draws the model as a frame of text.
//!
//! Line 1 shows the screens, lines 2 to 4 the state band. The last line shows the keys, and the line above
//! it the news.

mod band;
mod help;
mod keys;
mod ladder;
mod panes;
mod text;
mod waiting;

use std::borrow::Cow;

use interfaces::device::DeviceInputs;
use os_io::{text::plain, units};
use ratatui::{
    Frame,
    style::{Color, Modifier, Style},
    text::{Line, Span},
    widgets::Paragraph,
};
use record::Level;

use crate::rcs_console::{
    model::{
        Model, Operating, Prompt, Screen, Tone, band::band as band_of, cell, ladder as lines, link, panels,
        points, procedures, take_over_sections, terminal,
    },
    source::{About, Source, State},
};
use text::fit;
pub use waiting::Waiting;

/// Smallest size of a terminal: columns and lines.
pub const LEAST: (u16, u16) = (80, 24);
const BAND: usize = 3;
const FRAME: usize = BAND + 3; // lines above and below the body

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    pub colour: bool,
    pub ascii: bool,
}

impl Look {
    fn style(self, tone: Tone) -> Style {
        let colour = match tone {
            _ if !self.colour => return Style::default(),
            Tone::Plain => return Style::default(),
            Tone::Trouble => Color::Red,
            Tone::Marked => Color::Cyan,
            Tone::Faint => Color::DarkGray,
        };
        Style::default().fg(colour)
    }

    fn line(self, tone: Tone, text: impl Into<String>) -> Line<'static> {
        Line::styled(self.signs(text.into()), self.style(tone))
    }

    /// The text in the characters of the terminal, without control characters.
    fn signs(self, text: String) -> String {
        let text = match plain(&text) {
            Cow::Borrowed(_) => text,
            Cow::Owned(plain) => plain,
        };
        let sign = |sign: char| match sign {
            '─' => '-',
            '│' => '|',
            '├' | '└' | '┌' | '┐' | '┘' | '┤' | '┬' | '┴' => '+',
            '…' => '~',
            '·' => '.',
            other if other.is_ascii() => other,
            _ => '?',
        };
        if self.ascii { text.chars().map(sign).collect() } else { text }
    }
}

/// Number of lines by which the body can be scrolled from its default position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    pub up: usize,
    pub down: usize,
}

pub enum Scene<'a> {
    Source(&'a Model, &'a dyn Source),
    Waiting(&'a Waiting),
}

pub fn draw(frame: &mut Frame<'_>, scene: &Scene<'_>, look: Look) -> Reach {
    let area = frame.area();
    let (lines, reach) = compose(scene, look, area.width.into(), area.height.into());
    frame.render_widget(Paragraph::new(lines), area);
    reach
}

#[must_use]
pub fn compose(scene: &Scene<'_>, look: Look, width: usize, height: usize) -> (Vec<Line<'static>>, Reach) {
    let (columns, rows) = (usize::from(LEAST.0), usize::from(LEAST.1));
    if width < columns || height < rows {
        let text =
            format!("rcs-console needs {columns} x {rows} characters; this terminal has {width} x {height}");
        return (
            text::wrap(&text, width.max(1)).into_iter().map(|line| look.line(Tone::Plain, line)).collect(),
            Reach::default(),
        );
    }
    match scene {
        Scene::Waiting(waiting) => (waiting.compose(look, width, height), Reach::default()),
        Scene::Source(model, source) => screen(model, *source, look, width, height),
    }
}

fn screen(
    model: &Model,
    source: &dyn Source,
    look: Look,
    width: usize,
    height: usize,
) -> (Vec<Line<'static>>, Reach) {
    let about = source.about();
    let mut all = vec![tabs(model.screen, look, width)];
    // A block of 16 lines with its remarks fits only if the line of the next step is free.
    let is_editing = model.screen == Screen::Terminal && model.terminal.editor.is_some();
    let saved = usize::from(is_editing);
    all.extend(band::lines(&band_of(model, source), look, width).into_iter().take(BAND - saved));
    let room = height - FRAME + saved;
    let (body, reach) = match (&model.picture, model.help) {
        (_, true) => (help::lines(model, look), Reach::default()),
        (None, false) => {
            (vec![look.line(Tone::Plain, " The run has published no tick yet.")], Reach::default())
        }
        (Some(picture), false) if model.taking_over().is_some() => {
            let asked = model.taking_over().map(|state| take_over_sections(state, picture));
            panes::column(&asked.unwrap_or_default(), model, look, width, room)
        }
        (Some(picture), false) => match model.screen {
            Screen::Ladder => (ladder::body(model, picture, source, look, width, room), Reach::default()),
            Screen::Process => panes::process(model, picture, source, look, width, room),
            Screen::Link => {
                let cell = source.cell(picture.tick.0);
                panes::column(&link::sections(picture, source.story(), &cell), model, look, width, room)
            }
            Screen::Points => {
                let sections = points::sections(source.field(picture).as_deref(), &model.filter, width);
                panes::column(&sections, model, look, width, room)
            }
            Screen::Cell if model.drawing.is_some() => {
                let drawn =
                    model.drawing.iter().flat_map(|drawing| cell::drawn(picture, drawing, width, room));
                panes::column(&drawn.collect::<Vec<_>>(), model, look, width, room)
            }
            Screen::Cell => {
                let cell = source.cell(picture.tick.0);
                panes::column(&cell::sections(picture, &cell), model, look, width, room)
            }
            Screen::Terminal if model.terminal.editor.is_some() => {
                let sections = model.terminal.editor.iter().flat_map(|editor| editor.sections());
                (panes::list(&sections.collect::<Vec<_>>(), look, width, room), Reach::default())
            }
            Screen::Terminal => {
                let (operating, last) = (model.operating.as_ref(), model.last.as_ref());
                let said = terminal::sections(&model.terminal, operating, picture, last);
                panes::column(&said, model, look, width, room)
            }
            Screen::Procedures => {
                let cell = source.cell(picture.tick.0);
                let (operating, begun) = (model.operating.as_ref(), procedures::Begun::default());
                let sight = procedures::Sight { picture, cell: &cell, operating, begun };
                (
                    panes::list(&procedures::sections(&model.procedures, &sight), look, width, room),
                    Reach::default(),
                )
            }
            Screen::Panels => {
                let devices = DeviceInputs { joystick: model.joystick(), ..picture.external.devices };
                let cell = source.cell(picture.tick.0);
                let sections = panels::sections(&devices, &picture.memory, &cell, model.operating.as_ref());
                panes::column(&sections, model, look, width, room)
            }
        },
    };
    all.extend(body.into_iter().take(room));
    all.resize(height - 2, Line::default());
    all.push(news(model, source, &about, look, width));
    all.push(look.line(Tone::Plain, keys::line(model, about.state, width)));
    (all, reach)
}

fn tabs(screen: Screen, look: Look, width: usize) -> Line<'static> {
    let mut spans = Vec::new();
    let mut used = 0;
    for (number, tab) in (1..).zip(Screen::ALL) {
        let is_shown = tab == screen.tab();
        let mark = if is_shown { '>' } else { ' ' };
        let text = format!("{mark}{number} {} ", tab.name());
        used += text.chars().count();
        let style = if is_shown { Style::default().add_modifier(Modifier::BOLD) } else { Style::default() };
        spans.push(Span::styled(look.signs(text), style));
    }
    let right = if width > 90 { "?=help  q=quit " } else { "?=help " };
    spans.push(Span::raw(format!("{right:>rest$}", rest = width.saturating_sub(used))));
    Line::from(spans)
}

/// The news line: text input, answer to a key, alarm, or ending of the run.
fn news(model: &Model, source: &dyn Source, about: &About<'_>, look: Look, width: usize) -> Line<'static> {
    let line = |tone, text: &str| look.line(tone, fit(&units::shown(text), width));
    match &model.prompt {
        Some(Prompt::Filter(text)) => {
            return line(Tone::Marked, &format!(" show lines with: {text}_   Enter  Esc"));
        }
        Some(Prompt::Request(text)) => {
            let said = model.answer.as_deref().unwrap_or("Enter  Tab  Esc");
            let at = model.terminal_prompt();
            return line(Tone::Marked, &format!(" {at}: {text}_   {said}"));
        }
        Some(Prompt::Watch(text)) => {
            return line(Tone::Marked, &format!(" watch, or stop watching: {text}_   Enter  Esc"));
        }
        Some(Prompt::Reason(text)) => {
            return line(Tone::Marked, &format!(" skip the step, because: {text}_   Enter  Esc"));
        }
        Some(Prompt::Tick(text)) => return line(Tone::Marked, &format!(" go to tick: {text}_   Enter  Esc")),
        None => {}
    }
    if let Some(answer) = &model.answer {
        return line(Tone::Marked, &format!(" {answer}"));
    }
    if let Some((tone, text)) = model.operating.as_ref().and_then(last_answer) {
        return line(tone, &text);
    }
    let tick = model.tick();
    let said = source.story().lines(tick);
    let alarm =
        said.iter().rev().find(|line| line.level >= Level::Warning && line.tick.0 > model.acknowledged);
    if let Some(alarm) = alarm {
        return line(Tone::Trouble, &link::message(alarm).text);
    }
    if let Some(damage) = &about.damage {
        return line(Tone::Trouble, &format!("!! {damage}"));
    }
    let is_last = source.range().is_some_and(|(_, last)| tick == last);
    match (about.result, about.state) {
        (Some(result), _) if is_last => line(Tone::Plain, &format!(" the run ended: {result}")),
        (None, State::Over) => line(Tone::Plain, &format!(" the run ended: {}", ending(model))),
        (None, State::Log) if is_last => line(Tone::Trouble, "!! the log has no end: its program was killed"),
        _ => {
            let text = said.iter().rev().find(|line| line.level >= Level::Info).map(link::message);
            line(Tone::Plain, &text.unwrap_or_default().text)
        }
    }
}

/// The result of the last request if it was refused or the connection is lost.
fn last_answer(operating: &Operating) -> Option<(Tone, String)> {
    if let Some(lost) = &operating.lost {
        return Some((Tone::Trouble, format!("!!{lost}")));
    }
    let newest = operating.exchanges.last()?;
    match newest.answer.as_ref()? {
        Err(why) => Some((Tone::Trouble, format!("!!{}: {why}", newest.line))),
        Ok(text) => Some((Tone::Plain, format!(" {}: {text}", newest.line))),
    }
}

fn ending(model: &Model) -> String {
    let Some(picture) = &model.picture else { return "before its first tick".to_owned() };
    let status = &picture.memory.task.status;
    let commands = lines::present_commands(picture);
    format!("Task says {}{}; {commands}", status.report, status.unconfirmed.suffix())
}
