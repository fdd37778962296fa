//! The ladder: in columns or, on a large terminal, as the hierarchy next to the process at the cursor.

use interfaces::ProcessId;
use ratatui::{
    style::Modifier,
    text::{Line, Span},
};

use super::{
    Look, panes,
    text::{fit, rule, wrap},
};
use crate::rcs_console::{
    model::{
        Model, Tone,
        ladder::{self, Branch, Item, Mark},
    },
    picture::Picture,
    source::Source,
};

const LEAST_TEXT: usize = 24; // least number of columns for the text of a row
const COMMAND: usize = 19; // columns for a command on the smallest terminal
/// Smallest body with both hierarchy and process, as columns and lines. Each process or neighbour takes two lines.
const SIDE_COLUMNS: (usize, usize) = (120, 33);
const HIERARCHY: usize = 43; // columns of the hierarchy without the row, if the process is shown too
const ROW: (usize, usize) = (15, 30); // least and most columns for its row

struct Widths {
    command: usize,
    text: usize,
}

impl Widths {
    /// Commands are truncated only without room. The text of the rows gets the rest.
    fn of(width: usize, ladder: &[ladder::Line]) -> Self {
        let extra = width.saturating_sub(80);
        let longest = ladder.iter().map(|line| line.command.chars().count()).max().unwrap_or_default();
        let command = (longest + 1).clamp(COMMAND, COMMAND + extra);
        let text = COMMAND + extra - command;
        Self { command, text: if text >= LEAST_TEXT { text } else { 0 } }
    }
}

pub fn body(
    model: &Model,
    picture: &Picture,
    source: &dyn Source,
    look: Look,
    width: usize,
    room: usize,
) -> Vec<Line<'static>> {
    let ladder = ladder::lines(picture, model.last.as_ref(), source.story());
    if width >= SIDE_COLUMNS.0 && room >= SIDE_COLUMNS.1 {
        return beside(&ladder, model, picture, source, look, width, room);
    }
    let widths = Widths::of(width, &ladder);
    let head = columns(
        &widths,
        "  ",
        "process",
        "command",
        "no",
        "status",
        "no",
        "table, row",
        "s",
        "what the row says",
    );
    let mut lines = vec![look.line(Tone::Plain, head)];
    for line in ladder {
        let chosen = line.item == Item::Process(model.process);
        let drawn = look.line(line.mark.tone(), row(&widths, &line));
        lines.push(if chosen { drawn.patch_style(Modifier::REVERSED) } else { drawn });
    }
    // The smallest terminal has room for only one sentence.
    if room > lines.len() + 2 {
        lines.push(look.line(Tone::Plain, rule("", width)));
    }
    let below = explanation(model.process, picture, source, width, room.saturating_sub(lines.len()));
    lines.extend(below.into_iter().map(|text| look.line(Tone::Plain, text)));
    lines
}

/// The hierarchy at the left with uncut commands, and the process at the cursor at the right.
fn beside(
    ladder: &[ladder::Line],
    model: &Model,
    picture: &Picture,
    source: &dyn Source,
    look: Look,
    width: usize,
    room: usize,
) -> Vec<Line<'static>> {
    let row = (width / 2).saturating_sub(HIERARCHY).clamp(ROW.0, ROW.1);
    let left_width = HIERARCHY + row;
    let left = ladder.iter().flat_map(|line| {
        let chosen = line.item == Item::Process(model.process);
        let lines = entry(line, row, left_width);
        lines.into_iter().map(move |text| {
            let drawn = look.line(line.mark.tone(), fit(&text, left_width));
            if chosen { drawn.patch_style(Modifier::REVERSED) } else { drawn }
        })
    });
    let empty = || look.line(Tone::Plain, " ".repeat(left_width));
    let left = left.chain(std::iter::repeat_with(empty));
    let (right, _) = panes::process(model, picture, source, look, width - left_width - 2, room);
    let right = right.into_iter().chain(std::iter::repeat(Line::default()));
    let separator = look.signs("│ ".to_owned());
    left.zip(right)
        .take(room)
        .map(|(left, right)| {
            let separator = [Span::raw(separator.clone())];
            Line::from(spans(left).chain(separator).chain(spans(right)).collect::<Vec<_>>())
        })
        .collect()
}

fn spans(line: Line<'static>) -> impl Iterator<Item = Span<'static>> {
    let style = line.style;
    line.spans.into_iter().map(move |span| {
        let style = style.patch(span.style);
        span.style(style)
    })
}

/// A process or neighbour in two or more lines: status and row, then the whole command.
fn entry(line: &ladder::Line, row: usize, width: usize) -> Vec<String> {
    let (mark, name) = (mark(&line.mark), name(line));
    let shown = if line.item == Item::Robot { "" } else { &line.row };
    let (echo, age) = (number(line.echo), age(line.age));
    let first =
        format!("{mark}{}{} {echo:>4} {}{age:>5}", fit(&name, 18), fit(&line.status, 12), fit(shown, row));
    let indent = match line.branch {
        Branch::Level => 0,
        Branch::Beside | Branch::Last => 2,
        Branch::Below | Branch::LastBelow => 4,
    };
    let command = format!("{}{:>7} {}", " ".repeat(indent), number(line.number), line.command);
    let command = if line.command.is_empty() { Vec::new() } else { wrap(&command, width) };
    std::iter::once(first).chain(command).collect()
}

/// The sentences about the process at the cursor, each in at most half of the available lines.
fn explanation(
    process: ProcessId,
    picture: &Picture,
    source: &dyn Source,
    width: usize,
    room: usize,
) -> Vec<String> {
    let share = (room / 2).max(1);
    let sentences = ladder::explanation(process, picture, source.story());
    sentences
        .into_iter()
        .flat_map(|sentence| {
            let text = format!(" {sentence}");
            let lines = wrap(&text, width);
            if lines.len() <= share { lines } else { shortened(lines, share, width) }
        })
        .collect()
}

/// The first lines. The last one shows that more follow.
fn shortened(mut lines: Vec<String>, share: usize, width: usize) -> Vec<String> {
    lines.truncate(share);
    if let Some(last) = lines.last_mut() {
        *last = fit(&format!("{} …", fit(last, width - 2).trim_end()), width);
    }
    lines
}

fn row(widths: &Widths, line: &ladder::Line) -> String {
    let row = if line.item == Item::Robot { "" } else { &line.row };
    let (no, echo) = (number(line.number), number(line.echo));
    columns(
        widths,
        &mark(&line.mark),
        &name(line),
        &line.command,
        &no,
        &line.status,
        &echo,
        row,
        &age(line.age),
        &line.text,
    )
}

fn mark(mark: &Mark) -> String {
    match *mark {
        Mark { trouble: true, .. } => "!!".to_owned(),
        Mark { absent, on, changed, .. } => {
            let first = match (on, absent) {
                (true, _) => '*',
                (false, true) => '-',
                (false, false) => ' ',
            };
            format!("{first}{}", if changed { '>' } else { ' ' })
        }
    }
}

/// The name in its branch of the hierarchy.
fn name(line: &ladder::Line) -> String {
    let branch = match line.branch {
        Branch::Level => "",
        Branch::Beside => "├ ",
        Branch::Last => "└ ",
        Branch::Below => "  ├ ",
        Branch::LastBelow => "  └ ",
    };
    match line.mark.cause {
        true => format!("{}<= CAUSE", fit(&format!("{branch}{}", line.name), 9)),
        false => format!("{branch}{}", line.name),
    }
}

fn number(number: Option<u32>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

fn age(age: Option<f64>) -> String {
    match age {
        None => String::new(),
        Some(age) if age < 10.0 => format!("{age:.1}"),
        Some(age) => format!("{age:.0}"),
    }
}

#[expect(clippy::too_many_arguments, reason = "one argument a column")]
fn columns(
    widths: &Widths,
    mark: &str,
    name: &str,
    command: &str,
    number: &str,
    status: &str,
    echo: &str,
    row: &str,
    age: &str,
    text: &str,
) -> String {
    let line = format!(
        "{mark}{}{}{number:>5} {}{echo:>5} {}{age:>4}",
        fit(name, 18),
        fit(command, widths.command),
        fit(status, 12),
        fit(row, 13),
    );
    if widths.text == 0 { line } else { format!("{line}  {}", fit(text, widths.text - 2)) }
}
