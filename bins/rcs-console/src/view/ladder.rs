//! The ladder in columns.

use interfaces::ProcessId;
use ratatui::{style::Modifier, text::Line};

use super::{
    Look, boxes,
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

/// Largest number of additional columns for the command on a wide terminal.
const MORE_COMMAND: usize = 24;
/// Least number of columns for the text of a row.
const LEAST_TEXT: usize = 24;

/// Widths of the columns.
struct Widths {
    command: usize,
    text: usize,
}

impl Widths {
    fn of(width: usize) -> Self {
        let extra = width.saturating_sub(80);
        let command = extra.min(MORE_COMMAND);
        let text = extra - command;
        Self { command: 19 + command, text: if text >= LEAST_TEXT { text } else { 0 } }
    }
}

/// The lines of the screen's body.
pub fn body(
    model: &Model,
    picture: &Picture,
    source: &dyn Source,
    look: Look,
    width: usize,
    room: usize,
) -> Vec<Line<'static>> {
    if width >= boxes::LEAST.0 && room >= boxes::LEAST.1 {
        let drawn = ladder::lines(picture, model.last.as_ref(), source.story());
        let mut lines = boxes::lines(&drawn, model.process, look, width);
        lines.push(look.line(Tone::Plain, rule("", width)));
        let below = explanation(model.process, picture, source, width, room.saturating_sub(lines.len()));
        lines.extend(below.into_iter().map(|text| look.line(Tone::Plain, text)));
        return lines;
    }
    let widths = Widths::of(width);
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
    for line in ladder::lines(picture, model.last.as_ref(), source.story()) {
        let chosen = line.item == Item::Process(model.process);
        let drawn = look.line(line.mark.tone(), row(&widths, &line));
        lines.push(if chosen { drawn.patch_style(Modifier::REVERSED) } else { drawn });
    }
    // In the smallest terminal there is room for two sentences only.
    if room > lines.len() + 2 {
        lines.push(look.line(Tone::Plain, rule("", width)));
    }
    let below = explanation(model.process, picture, source, width, room.saturating_sub(lines.len()));
    lines.extend(below.into_iter().map(|text| look.line(Tone::Plain, text)));
    lines
}

/// The sentences about the process under the cursor, each in at most half of the available lines.
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

/// The first lines; the last one shows that more follow.
fn shortened(mut lines: Vec<String>, share: usize, width: usize) -> Vec<String> {
    lines.truncate(share);
    if let Some(last) = lines.last_mut() {
        *last = fit(&format!("{} …", fit(last, width - 2).trim_end()), width);
    }
    lines
}

fn row(widths: &Widths, line: &ladder::Line) -> String {
    let mark = match line.mark {
        Mark { trouble: true, .. } => "!!".to_owned(),
        Mark { absent, on, changed, .. } => {
            let first = if on {
                '*'
            } else if absent {
                '-'
            } else {
                ' '
            };
            format!("{first}{}", if changed { '>' } else { ' ' })
        }
    };
    let branch = match line.branch {
        Branch::Level => "",
        Branch::Beside => "├ ",
        Branch::Last => "└ ",
        Branch::Below => "  ├ ",
        Branch::LastBelow => "  └ ",
    };
    let name = match line.mark.cause {
        true => format!("{}<= CAUSE", fit(&format!("{branch}{}", line.name), 9)),
        false => format!("{branch}{}", line.name),
    };
    let number = |number: Option<u32>| number.map_or_else(String::new, |number| number.to_string());
    let age = line.age.map_or_else(String::new, |age| match age {
        age if age < 10.0 => format!("{age:.1}"),
        age => format!("{age:.0}"),
    });
    let row = if line.item == Item::Robot { "" } else { &line.row };
    let (no, echo) = (number(line.number), number(line.echo));
    columns(widths, &mark, &name, &line.command, &no, &line.status, &echo, row, &age, &line.text)
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
