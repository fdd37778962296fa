//! `rcs-run tables`: every decision table as Markdown, with explanations of its names.
//!
//! Each table is followed by its steps, and by the state variables and actions that only this table has. Those of
//! several tables are explained once, under *Values* at the end of the process. A table of an earlier process is not
//! printed again.

#[cfg(test)]
mod tests;

use std::{fmt::Write as _, process::ExitCode};

use levels::{
    goal::Declared,
    ladder::{Ladder, ProcessInfo},
};
use os_io::console;
use rcs_core::{
    plain::{EnumSchema, VariantSchema},
    table::{ActionText, Row, Table, Variable},
};
use record::journal::DOUBT;

use crate::rcs_run::error::Error;

const HEAD: &str = "\
# Decision tables

Once a tick a process looks its state variables up in its tables (II.2.2.2). Rows are read from the top: the
first one that fits decides. A row fits if the command is in one of the row's steps (`any`: in whatever step),
and if each variable that the row names has one of the values behind it; `otherwise` fits always. It names one
action, and the next step where the step changes.

`consult` is not a decision: the process continues with another table, with the value in brackets, until a row
decides. First come the tables that all commands have in common, then those of the command: at most three, for
what it shares with other commands and for its phases. Their comments say which one is consulted first.

The goals of a process stand before its tables: what must hold at the end of a command, the sensors that confirm
it, the tolerance, the greatest age of a reading in ticks, and what no sensor confirms. CONFIRM compares them.

The log, `rcs-run status` and the sentence about a failure name a row by table and number, and write a step
in small letters: `letting-go` for `LettingGo`.
";

pub fn tables() -> Result<ExitCode, Error> {
    console::answer(&(page(Ladder::processes()) + &of_resume()))?;
    Ok(ExitCode::SUCCESS)
}

fn page(processes: &'static [ProcessInfo]) -> String {
    let mut text = HEAD.to_owned();
    text.push('\n');
    for process in processes {
        let names: Vec<_> = process.tables.iter().map(|table| table.name).collect();
        let _ = writeln!(text, "- {}: {}", link(process.name), names.join(", "));
    }
    for (index, process) in processes.iter().enumerate() {
        let earlier = processes.get(..index).unwrap_or_default();
        append_process(&mut text, process, earlier);
    }
    text
}

/// The table that no process consults.
fn of_resume() -> String {
    let head = "\n## Resume\n\nConsulted before the first tick of a resumed run.\n\n### 1. ";
    let mut text = format!("{head}{}\n\n", DOUBT.name);
    append_table(&mut text, &DOUBT, &[&DOUBT]);
    text
}

fn link(heading: &str) -> String {
    format!("[{heading}](#{})", heading.to_lowercase().replace(' ', "-"))
}

fn append_process(text: &mut String, process: &ProcessInfo, earlier: &[ProcessInfo]) {
    let _ = write!(text, "\n## {}\n", process.name);
    let printed = |table: &Table| {
        let number_in = |other: &ProcessInfo| {
            (1..).zip(other.tables).find(|(_, known)| std::ptr::eq(**known, table)).map(|(number, _)| number)
        };
        earlier.iter().find_map(|other| Some((other.name, number_in(other)?)))
    };
    let own: Vec<&'static Table> =
        process.tables.iter().copied().filter(|table| printed(table).is_none()).collect();
    if own.is_empty() {
        text.push('\n');
    }
    append_goals(text, process.goals);
    for (number, table) in (1..).zip(process.tables) {
        let heading = format!("{number}. {}", table.name);
        let _ = match printed(table) {
            Some((other, at)) if own.is_empty() => writeln!(text, "{heading}: table {at} of {}", link(other)),
            Some((other, at)) => write!(text, "\n### {heading}\n\nTable {at} of {}.\n", link(other)),
            None => write!(text, "\n### {heading}\n\n"),
        };
        if printed(table).is_none() {
            append_table(text, table, &own);
        }
    }
    let shared = Groups::of(&own, |tables| tables > 1);
    if !shared.is_empty() {
        text.push_str("\n### Values\n\nWhat several tables of the process share.\n");
        shared.append(text);
    }
}

fn append_goals(text: &mut String, goals: &[Declared]) {
    let rows = goals.iter().filter(|declared| !declared.command.is_empty()).map(|declared| {
        let goal = declared.goal;
        let sensors: Vec<_> = goal.sensors.iter().map(|sensor| sensor.text()).collect();
        let unconfirmed: Vec<_> = goal.unconfirmed.iter().map(|what| what.text()).collect();
        [
            declared.command.to_owned(),
            goal.holds.to_owned(),
            sensors.join(", "),
            goal.tolerance.to_owned(),
            goal.age.to_string(),
            unconfirmed.join(", "),
        ]
    });
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        text.push_str("\nGoals:\n\n");
        grid(text, ["command", "what must hold", "sensors", "tolerance", "age", "unconfirmed"], rows);
    }
}

/// Append a table, with the state variables and actions that only it has.
fn append_table(text: &mut String, table: &'static Table, own: &[&'static Table]) {
    for line in table.doc {
        let _ = writeln!(text, "{}", prose(line));
    }
    let _ = writeln!(text, "\nSource: `{}:{}`\n", table.file, table.line);
    let mut last: Option<&Row> = None;
    let rows = table.rows.iter().map(|row| {
        // Print the step only where it changes, as in the source.
        let steps = match (last.replace(row), row.steps) {
            (Some(before), steps) if before.steps == steps => String::new(),
            (_, []) => "any".to_owned(),
            (_, steps) => steps.join(" or "),
        };
        let [when, next] = [conditions(row), row.next.unwrap_or_default().to_owned()];
        [row.number.to_string(), steps, when, row.call().to_string(), next]
    });
    let rows: Vec<_> = rows.collect();
    let has_steps = table.rows.iter().any(|row| !row.steps.is_empty() || row.next.is_some());
    if has_steps {
        grid(text, ["row", "step", "when", "action", "next"], rows);
    } else {
        let rows = rows.into_iter().map(|[row, _, when, action, _]| [row, when, action]).collect();
        grid(text, ["row", "when", "action"], rows);
    }
    if let Some(steps) = table.steps {
        let named = |name: &str| {
            table
                .rows
                .iter()
                .any(|row| row.steps.contains(&name) || row.next.is_some_and(|next| next == name))
        };
        text.push_str("\nSteps:\n\n");
        append_values(text, "", steps.variants.iter().filter(|step| named(step.name)), meaning);
    }
    let alone = Groups::of(own, |tables| tables == 1);
    alone.only(table).append(text);
}

/// Conditions of a row: `held: Nothing or Other, vision: Needed`.
fn conditions(row: &Row) -> String {
    let asked = row.when.iter().map(|asked| format!("{}: {}", asked.variable, asked.values.join(" or ")));
    let asked: Vec<String> = asked.collect();
    if asked.is_empty() { "otherwise".to_owned() } else { asked.join(", ") }
}

/// State variables with the tables that test them, and groups of tables with the same actions.
struct Groups {
    variables: Vec<(&'static Variable, Vec<&'static Table>)>,
    actions: Vec<Vec<&'static Table>>,
}

impl Groups {
    /// The groups whose number of tables is `wanted`.
    fn of(tables: &[&'static Table], wanted: impl Fn(usize) -> bool) -> Self {
        let mut variables: Vec<(&'static Variable, Vec<&'static Table>)> = Vec::new();
        let mut actions: Vec<Vec<&'static Table>> = Vec::new();
        for &table in tables {
            for variable in table.asked() {
                match variables.iter_mut().find(|(known, _)| *known == variable) {
                    Some((_, group)) => group.push(table),
                    None => variables.push((variable, vec![table])),
                }
            }
            match actions.iter_mut().find(|group| group.iter().any(|other| other.actions == table.actions)) {
                Some(group) => group.push(table),
                None => actions.push(vec![table]),
            }
        }
        variables.retain(|(_, group)| wanted(group.len()));
        actions.retain(|group| wanted(group.len()));
        Self { variables, actions }
    }

    fn only(mut self, table: &Table) -> Self {
        let holds = |group: &Vec<&'static Table>| group.iter().any(|other| std::ptr::eq(*other, table));
        self.variables.retain(|(_, group)| holds(group));
        self.actions.retain(holds);
        self
    }

    fn is_empty(&self) -> bool {
        self.variables.is_empty() && !self.actions.iter().any(|group| actions(group).next().is_some())
    }

    /// Append the explanation of variables, actions, and the arguments of actions.
    fn append(&self, text: &mut String) {
        append_variables(text, &self.variables);
        for group in &self.actions {
            append_actions(text, group);
        }
    }
}

fn rows(tables: &[&'static Table]) -> impl Iterator<Item = &'static Row> {
    tables.iter().flat_map(|table| table.rows)
}

/// The actions that the rows of a group of tables use.
fn actions(tables: &[&'static Table]) -> impl Iterator<Item = &'static ActionText> {
    let all = tables.first().map_or(&[][..], |table| table.actions);
    all.iter().filter(move |action| rows(tables).any(|row| row.action == action.name))
}

fn append_variables(text: &mut String, variables: &[(&'static Variable, Vec<&'static Table>)]) {
    if !variables.is_empty() {
        text.push_str("\nState variables:\n\n");
    }
    for (variable, tables) in variables {
        let asked = |value: &str| {
            let mut all = rows(tables).flat_map(|row| row.when);
            all.any(|asked| asked.variable == variable.name && asked.values.contains(&value))
        };
        let _ = writeln!(text, "- `{}`: {}", variable.name, prose(variable.doc));
        append_values(text, "  ", variable.values.variants.iter().filter(|value| asked(value.name)), meaning);
    }
}

fn append_actions(text: &mut String, tables: &[&'static Table]) {
    let carriers = |of: &EnumSchema| {
        let carries = |action: &&ActionText| action.argument.is_some_and(|argument| argument == of);
        actions(tables).filter(carries).map(|action| action.name).collect::<Vec<_>>()
    };
    let carried = |by: &[&str], of: &'static EnumSchema| {
        let named: Vec<&str> =
            rows(tables).filter(|row| by.contains(&row.action)).filter_map(|row| row.argument).collect();
        of.variants.iter().filter(move |variant| named.contains(&variant.name))
    };
    let mut several: Vec<&'static EnumSchema> = Vec::new();
    for (position, action) in actions(tables).enumerate() {
        if position == 0 {
            text.push_str("\nActions:\n\n");
        }
        let _ = writeln!(text, "- `{}`: {}", action.name, prose(action.doc));
        let Some(argument) = action.argument else { continue };
        match carriers(argument).as_slice() {
            [only] => append_values(text, "  ", carried(&[only], argument), sentence),
            _ if !several.contains(&argument) => several.push(argument),
            _ => {}
        }
    }
    for argument in several {
        let by = carriers(argument);
        let _ = write!(text, "\n{}, which `{}` carry:\n\n", argument.name, by.join("` and `"));
        append_values(text, "", carried(&by, argument), sentence);
    }
}

fn append_values(
    text: &mut String,
    indent: &str,
    values: impl Iterator<Item = &'static VariantSchema>,
    meaning: fn(&VariantSchema) -> String,
) {
    for value in values {
        let _ = writeln!(text, "{indent}- `{}`: {}", value.name, meaning(value));
    }
}

/// The meaning of a value: its doc comment.
fn meaning(value: &VariantSchema) -> String {
    prose(value.doc)
}

/// The meaning of an argument: its printed text if that is a sentence, else its doc comment.
fn sentence(value: &VariantSchema) -> String {
    if value.text.contains(' ') { value.text.to_owned() } else { meaning(value) }
}

/// A doc comment without links into the sources: ``[`Pose`](crate::rcs_run::pose)`` becomes `Pose`.
fn prose(doc: &str) -> String {
    let (mut text, mut rest) = (String::new(), doc.trim());
    while let Some((before, bracket)) = rest.split_once('[') {
        text += before;
        let link = bracket.split_once(']').and_then(|(name, after)| {
            let target = after.strip_prefix('(').and_then(|target| target.split_once(')'));
            let is_link = target.is_some() || name.starts_with('`');
            is_link.then_some((name, target.map_or(after, |(_, after)| after)))
        });
        match link {
            Some((name, after)) => {
                text += name;
                rest = after;
            }
            None => {
                text.push('[');
                rest = bracket;
            }
        }
    }
    text + rest
}

/// A Markdown table with aligned columns in the source. The column of row numbers is aligned to the right.
fn grid<const N: usize>(text: &mut String, head: [&str; N], rows: Vec<[String; N]>) {
    let cells = |row: [String; N]| row.map(|cell| cell.replace('|', "\\|"));
    let rows: Vec<[String; N]> = rows.into_iter().map(cells).collect();
    let lengths = |column: usize| rows.iter().map(move |row| row[column].chars().count());
    let widths: [usize; N] =
        std::array::from_fn(|column| lengths(column).chain([head[column].len()]).max().unwrap_or_default());
    let mut line = |cells: [&str; N]| {
        for (column, (cell, width)) in cells.iter().zip(widths).enumerate() {
            let _ = match is_number(head[column]) {
                true => write!(text, "| {cell:>width$} "),
                false => write!(text, "| {cell:<width$} "),
            };
        }
        text.push_str("|\n");
    };
    line(head);
    let rule = |column: usize| {
        let dashes = "-".repeat(widths[column]);
        if is_number(head[column]) { format!("{}:", &dashes[1..]) } else { dashes }
    };
    let rules: [String; N] = std::array::from_fn(rule);
    line(rules.each_ref().map(String::as_str));
    for row in &rows {
        line(row.each_ref().map(String::as_str));
    }
}

fn is_number(head: &str) -> bool {
    head == "row"
}
