//! The source text of the last deciding table, with the fired row.

use interfaces::ProcessId;
use levels::ladder::Ladder;

use super::{Section, Text, Tone};
use crate::rcs_console::picture::Picture;

static FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/tables.rs"));

#[must_use]
pub fn section(process: ProcessId, picture: &Picture, filter: &str) -> Section {
    let info = &Ladder::processes()[process.position()];
    let decided = picture.memory.header(process).decided;
    let Some((table, fired)) = decided.and_then(|decided| info.row(decided)) else {
        return Section::new("source", vec![Text::new(Tone::Faint, "  no row has decided yet")]);
    };
    let title = format!("{}:{}, table {}, row {}", table.file, table.line, table.name, fired.number);
    let Some((_, text)) = FILES.iter().find(|(file, _)| *file == table.file) else {
        return Section::new(title, vec![Text::new(Tone::Faint, "  the text is not in this program")]);
    };
    let head = format!("{}:", fired.number);
    let first = usize::try_from(table.line).unwrap_or(1);
    let mut lines = Vec::new();
    let mut at = 0;
    for (number, line) in (1..).zip(text.lines()).skip(first.saturating_sub(1)) {
        let is_fired = line.trim_start().starts_with(&head);
        let line = shortened(line);
        if line.to_lowercase().contains(&filter.to_lowercase()) {
            if is_fired {
                at = lines.len();
            }
            let (mark, tone) = if is_fired { ('>', Tone::Marked) } else { (' ', Tone::Plain) };
            lines.push(Text::verbatim(tone, format!("{mark}{number:>4} {line}")));
        }
        if line.trim_end() == "}" {
            break;
        }
    }
    Section { title, lines, at }
}

/// The line without alignment blanks, and without the indentation of the macro.
fn shortened(line: &str) -> String {
    let text = line.trim_start();
    let indent = (line.len() - text.len()).saturating_sub(4);
    let words: Vec<&str> = text.split_whitespace().collect();
    format!("{}{}", " ".repeat(indent), words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, Decided, ExternalInputs};
    use rcs_core::tick::Tick;

    #[test]
    fn source_text_contains_every_row_of_every_table() {
        for (process, info) in ProcessId::ALL.iter().zip(Ladder::processes()) {
            for (number, table) in (1..).zip(info.tables) {
                for row in table.rows {
                    let mut memory = CommonMemory::default();
                    memory.header_mut(*process).decided = Some(Decided { table: number, row: row.number });
                    let external = ExternalInputs::default();
                    let picture = Picture { tick: Tick(1), external, memory, timing: None };
                    let section = section(*process, &picture, "");
                    let marked: Vec<_> =
                        section.lines.iter().filter(|line| line.tone == Tone::Marked).collect();
                    assert_eq!(marked.len(), 1, "{}", section.title);
                    assert_eq!(section.lines.get(section.at), Some(marked[0]));
                    // A row may continue in the next lines.
                    let rest = section.lines.get(section.at..).unwrap_or_default();
                    let end = rest.iter().position(|line| line.text.ends_with(';')).unwrap_or(0);
                    let row_text: String = rest[..=end].iter().map(|line| line.text.as_str()).collect();
                    assert!(row_text.contains(row.action), "{}: {row_text}", section.title);
                }
            }
        }
    }
}
