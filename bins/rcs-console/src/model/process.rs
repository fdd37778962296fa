//! The process screen: the decision table consulted last, the rows that fired before, and their meaning.

use interfaces::{Consulted, Header, ProcessId};
use levels::ladder::{Ladder, ProcessInfo};
use rcs_core::{
    plain::EnumSchema,
    table::{Fired, Row, Table, Values},
    tick::TICK_S,
};

use super::{Section, Text, Tone};
use crate::rcs_console::{
    picture::Picture,
    story::{ProcessState, Story},
};

/// The table that decided last, with the fired row marked and its conditions. Lines without the filter's text are
/// omitted.
#[must_use]
pub fn table(process: ProcessId, picture: &Picture, filter: &str) -> Section {
    let info = &Ladder::processes()[process.position()];
    let header = picture.memory.header(process);
    let Some((table, fired)) = header.decided.and_then(|decided| info.row(decided)) else {
        let tables: Vec<_> = info.tables.iter().map(|table| table.name).collect();
        let text = format!("  no row has decided yet; tables: {}", tables.join(", "));
        return Section::new("no table", vec![Text::new(Tone::Faint, text)]);
    };
    let number = header.decided.map_or(0, |decided| decided.table);
    let step = header.step.unwrap_or_default();
    let after = if step.is_empty() { String::new() } else { format!(", then {step}") };
    let consulted = header.consulted();
    let values = consulted.map(|consulted| consulted.values);
    let mut lines: Vec<Text> = Vec::new();
    let mut at = 0;
    for row in table.rows {
        if row.number == fired.number {
            at = lines.len();
            lines.push(Text::new(Tone::Marked, format!("> {:>3}  {row}", row.number)));
            lines.extend(values.map(|values| Text::plain(asked(table, values))));
            lines.extend(meaning(table, row).into_iter().map(|text| Text::plain(format!("       {text}"))));
            lines.extend(beside(info, header));
        } else {
            let near = values.and_then(|values| near(table, row, values));
            let mark = if near.is_some() { '~' } else { ' ' };
            lines.push(Text::plain(format!("{mark} {:>3}  {row}{}", row.number, near.unwrap_or_default())));
        }
    }
    let filter = filter.to_lowercase();
    let shown = |line: &Text| line.text.to_lowercase().contains(&filter);
    let at = lines.iter().take(at).filter(|line| shown(line)).count();
    lines.retain(shown);
    let when = match header.age() {
        Some(0) => " fired".to_owned(),
        Some(ticks) => format!(" fired {:.2} s ago", ticks as f64 * TICK_S),
        None => " was the last".to_owned(),
    };
    let title = format!("table {number} {}, row {}{when}{after}", table.name, fired.number);
    Section { title, lines, at }
}

/// Values of the variables in the table's conditions at the last decision.
fn asked(table: &Table, values: Values) -> String {
    let asked: Vec<&str> = table.asked().map(|variable| variable.name).collect();
    let known = table.values(values).filter(|(variable, _)| asked.contains(&variable.name));
    let step = table.step(values).map(|step| format!("step {}", step.name));
    let values = known.map(|(variable, value)| format!("{} {}", variable.name, value.name));
    format!("       values: {}", step.into_iter().chain(values).collect::<Vec<_>>().join(", "))
}

/// The single changes of a variable with which a row would have fired, if any.
fn near(table: &Table, row: &Row, values: Values) -> Option<String> {
    let misses = table.near_misses(values).filter(|miss| miss.row.number == row.number);
    let misses: Vec<String> =
        misses.map(|miss| format!("{} {}", miss.variable.name, miss.value.name)).collect();
    (!misses.is_empty()).then(|| format!("   [with {}]", misses.join(" or ")))
}

/// The rows of other tables that fired in addition to the deciding one.
fn beside(info: &ProcessInfo, header: &Header) -> Vec<Text> {
    let rows = header.beside.iter().flatten().filter_map(|Consulted { decided, values }| {
        let (table, row) = info.row(*decided)?;
        Some(Fired { table, row, values: Some(*values) })
    });
    rows.map(|fired| Text::plain(format!("       beside: {fired}"))).collect()
}

/// The meaning of a row from its doc comments: each condition, the action, the next step.
#[must_use]
pub fn meaning(table: &Table, row: &Row) -> Vec<String> {
    let mut lines = Vec::new();
    let documented = |schema: &EnumSchema, name: &str| {
        schema.variants.iter().find(|variant| variant.name == name).map_or("", |variant| variant.doc)
    };
    for condition in row.when {
        let Some(variable) = table.variables.iter().find(|variable| variable.name == condition.variable)
        else {
            continue;
        };
        for value in condition.values {
            lines.push(sentence("because", condition.variable, value, documented(variable.values, value)));
        }
    }
    if let Some(action) = table.actions.iter().find(|action| action.name == row.action) {
        lines.push(sentence("does", action.name, "", action.doc));
        if let (Some(schema), Some(argument)) = (action.argument, row.argument) {
            lines.push(sentence("with", argument, "", documented(schema, argument)));
        }
    }
    if let (Some(schema), Some(next)) = (table.steps, row.next) {
        lines.push(sentence("then", next, "", documented(schema, next)));
    }
    lines
}

fn sentence(word: &str, name: &str, value: &str, doc: &str) -> String {
    let what = format!("{word} {name} {value}");
    match doc.trim() {
        "" => what.trim_end().to_owned(),
        doc => format!("{}: {doc}", what.trim_end()),
    }
}

/// The rows that fired before, newest first: start, duration, row.
#[must_use]
pub fn rows(process: ProcessId, picture: &Picture, story: &Story) -> Section {
    let info = &Ladder::processes()[process.position()];
    let rows = story.rows(process, picture.tick.0);
    let ends = rows.iter().skip(1).map(|row| row.tick).chain([picture.tick.0 + 1]);
    let mut lines: Vec<Text> = rows.iter().zip(ends).map(|(row, end)| row_line(info, row, end)).collect();
    lines.reverse();
    Section::new("rows that fired, newest first", lines)
}

fn row_line(info: &ProcessInfo, doing: &ProcessState, end: u64) -> Text {
    let lasted = end.saturating_sub(doing.tick) as f64 * TICK_S;
    let row = doing.decided.and_then(|decided| info.row(decided));
    let text = row.map_or_else(
        || "no row yet".to_owned(),
        |(table, row)| {
            let next = row.next.map_or_else(String::new, |next| format!(" -> {next}"));
            format!("{} {}: {}{next}", table.name, row.number, row.call())
        },
    );
    Text::plain(format!("  {:>7} {lasted:>8.2} s  {text}", doing.tick))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, Decided, ExternalInputs};
    use rcs_core::tick::Tick;

    fn picture(tick: u64, row: u8) -> Picture {
        let mut memory = CommonMemory::default();
        memory.grip.header.decided = Some(Decided { table: 1, row });
        Picture { tick: Tick(tick), external: ExternalInputs::default(), memory, timing: None }
    }

    #[test]
    fn fired_row_is_marked_and_explained() {
        let section = table(ProcessId::Grip, &picture(1, 2), "");
        let marked: Vec<_> = section.lines.iter().filter(|line| line.tone == Tone::Marked).collect();
        assert_eq!(marked.len(), 1);
        assert!(marked[0].text.starts_with(">   2  "), "{}", marked[0].text);
        assert_eq!(section.lines.get(section.at), Some(marked[0]));
        let action = section.lines.get(section.at + 1..).unwrap_or_default();
        assert!(action.iter().any(|line| line.text.trim_start().starts_with("does ")), "{section:?}");
        let rows = Ladder::processes()[ProcessId::Grip.position()].tables[0].rows.len();
        assert!(section.lines.len() > rows);
    }

    #[test]
    fn filter_omits_lines() {
        let all = table(ProcessId::Grip, &picture(1, 2), "").lines;
        let some = table(ProcessId::Grip, &picture(1, 2), "DOES").lines;
        assert!(!some.is_empty() && some.len() < all.len());
    }

    #[test]
    fn process_without_a_row_lists_its_tables() {
        let mut picture = picture(1, 1);
        picture.memory.grip.header.decided = None;
        let section = table(ProcessId::Grip, &picture, "");
        assert!(section.lines[0].text.contains("POSITION"), "{section:?}");
    }

    #[test]
    fn rows_have_their_times() {
        let mut story = Story::new(usize::MAX);
        let pictures = [picture(1, 1), picture(2, 2), picture(3, 2), picture(4, 3)];
        story.note(&pictures[0], &pictures[0]);
        for pair in pictures.windows(2) {
            story.note(&pair[0], &pair[1]);
        }
        let lines = rows(ProcessId::Grip, &pictures[3], &story).lines;
        let front =
            |at: usize| lines.get(at).map(|line: &Text| line.text.chars().take(21).collect::<String>());
        assert_eq!(lines.len(), 3);
        assert_eq!(front(0).as_deref(), Some("        4     0.04 s "));
        assert_eq!(front(1).as_deref(), Some("        2     0.08 s "));
    }
}
