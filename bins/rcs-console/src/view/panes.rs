//! Draws sections one above the other, in panes that share the height or in one scrolled column.

use interfaces::CommonStatus;
use ratatui::text::Line;

use super::{
    Look, Reach,
    text::{rule, wrap},
};
use crate::rcs_console::{
    model::{Model, Pane, Section, Text, Tone, buffers, process, text_of, views},
    picture::Picture,
    source::Source,
};

const LEAST: usize = 2; // least number of lines of a pane without the keyboard focus

/// The process screen: table, rows, buffers. The pane with the keyboard focus gets the most lines.
pub fn process(
    model: &Model,
    picture: &Picture,
    source: &dyn Source,
    look: Look,
    width: usize,
    room: usize,
) -> (Vec<Line<'static>>, Reach) {
    let command = picture.command(model.process);
    let command = if command.is_empty() { "no command".to_owned() } else { command };
    let CommonStatus { report, unconfirmed, .. } = picture.memory.said(model.process);
    let (name, number) = (model.process, picture.command_number(model.process));
    let head = format!("{name}: {command}, number {number}, {report}{}", unconfirmed.suffix());
    let filter =
        if model.filter.is_empty() { String::new() } else { format!("  (lines with {:?})", model.filter) };
    let head = wrap(&format!(" {head}{filter}"), width);
    let mut lines: Vec<_> = head.into_iter().map(|text| look.line(Tone::Plain, text)).collect();
    let room = room.saturating_sub(lines.len());
    let (last, story) = (model.last.as_ref(), source.story());
    let sections = [
        if model.shows_source {
            text_of::section(model.process, picture, &model.filter)
        } else {
            process::table(model.process, picture, &model.filter)
        },
        process::rows(model.process, picture, story),
        if model.shows_watch {
            views::watched(&model.watch, picture, last)
        } else {
            buffers::section(model.process, picture, last, &model.filter)
        },
    ];
    let text = room.saturating_sub(Pane::ALL.len());
    let small = (text / 5).max(LEAST);
    let mut reach = Reach::default();
    for (pane, section) in Pane::ALL.into_iter().zip(&sections) {
        let chosen = pane == model.pane;
        let height = if chosen { text.saturating_sub(2 * small) } else { small };
        let body = body(section, width);
        let at = at(section, width).saturating_sub(1).min(body.len().saturating_sub(height));
        let start = if chosen { scrolled(at, model.scroll, body.len(), height, &mut reach) } else { at };
        let mark = if chosen { "> " } else { "" };
        let more = more(start, body.len(), height);
        lines.push(look.line(Tone::Plain, rule(&format!("{mark}{}{more}", section.title), width)));
        let shown: Vec<_> = body.into_iter().skip(start).take(height).collect();
        let missing = height - shown.len();
        lines.extend(shown.into_iter().map(|Text { tone, text }| look.line(tone, text)));
        lines.extend(std::iter::repeat_n(Line::default(), missing));
    }
    (lines, reach)
}

pub fn column(
    sections: &[Section],
    model: &Model,
    look: Look,
    width: usize,
    room: usize,
) -> (Vec<Line<'static>>, Reach) {
    let mut all = Vec::new();
    for section in sections {
        all.push(Text::plain(rule(&section.title, width)));
        all.extend(body(section, width));
    }
    let mut reach = Reach::default();
    let height = if all.len() > room { room - 1 } else { room };
    let start = scrolled(0, model.scroll, all.len(), height, &mut reach);
    let length = all.len();
    let shown = all.into_iter().skip(start).take(height);
    let mut lines: Vec<_> = shown.map(|Text { tone, text }| look.line(tone, text)).collect();
    if length > room {
        let below = length.saturating_sub(start + height);
        let text =
            format!(" lines {} to {} of {length}; {below} more below", start + 1, length.min(start + height));
        lines.push(look.line(Tone::Faint, text));
    }
    (lines, reach)
}

/// Sections, scrolled so that the line that must be visible stays on the screen.
pub fn list(sections: &[Section], look: Look, width: usize, room: usize) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    for section in sections {
        let (body, at) = (body(section, width), at(section, width));
        let height = room.saturating_sub(lines.len() + 1);
        // The details of that line follow it, so most of the space is below it.
        let start = at.saturating_sub(height / 3).min(body.len().saturating_sub(height));
        let more = more(start, body.len(), height);
        lines.push(look.line(Tone::Plain, rule(&format!("{}{more}", section.title), width)));
        let shown = body.into_iter().skip(start).take(height);
        lines.extend(shown.map(|Text { tone, text }| look.line(tone, text)));
    }
    lines
}

fn body(section: &Section, width: usize) -> Vec<Text> {
    let wrapped = |line: &Text| {
        let tone = line.tone;
        wrap(&line.text, width).into_iter().map(move |text| Text { tone, text }).collect::<Vec<_>>()
    };
    section.lines.iter().flat_map(wrapped).collect()
}

/// Index of the line that must be visible, after wrapping.
fn at(section: &Section, width: usize) -> usize {
    section.lines.iter().take(section.at).map(|line| wrap(&line.text, width).len()).sum()
}

/// The first visible line of a pane whose default position shows the line `at`.
fn scrolled(at: usize, scroll: isize, length: usize, height: usize, reach: &mut Reach) -> usize {
    let most = length.saturating_sub(height).max(at);
    *reach = Reach { up: at, down: most - at };
    at.saturating_add_signed(scroll).min(most)
}

/// Text with the number of hidden lines of a pane.
fn more(start: usize, length: usize, height: usize) -> String {
    match (start, length.saturating_sub(start + height)) {
        (0, 0) => String::new(),
        (above, below) => format!(" ({above} above, {below} below)"),
    }
}
