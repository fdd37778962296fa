//! Rows and columns of decision tables in the sources. [`aligned`] arranges the number, the conditions, `=>` with the
//! action, and `->` with the next step in columns. Adjacent rows that test the same variables have these in columns
//! too. A line has at most [`WIDEST`] columns. If a row becomes wider, variables are not aligned; then the rows with
//! the longest conditions leave the columns. A still wider row has its action in a second line.

use std::{
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

pub const WIDEST: usize = 110;
pub const OTHERWISE: &str = "otherwise"; // a row without conditions
/// First line of a table.
const BEGIN: &str = "decision_table! {";

/// `4: held: Right | Wrong, work: Over => Release -> Releasing;`
#[derive(Clone, Debug)]
pub struct Row {
    pub lines: Range<usize>, // in the file, from 0
    pub text: String,        // in one line
    pub indent: String,
    pub group: usize,              // the rows between two braces
    pub only_step: Option<String>, // of the group, if there is one
    pub number: String,
    pub conditions: Vec<(String, Vec<String>)>, // alternatives of each state variable
    pub action: String,                         // with its argument
    pub next: Option<String>,                   // if it changes
}

impl Row {
    fn read(lines: Range<usize>, text: &str, group: usize, only_step: Option<&String>) -> Option<Self> {
        let digit = text.find(|character: char| character.is_ascii_digit())?;
        let (indent, row) = text.split_at(digit);
        let (number, rest) = row.trim_end().split_once(':')?;
        if !number.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let (conditions, result) = rest.strip_suffix(';')?.split_once("=>")?;
        let (action, next) = match result.split_once("->") {
            Some((action, next)) => (action, Some(next.trim().to_owned())),
            None => (result, None),
        };
        let read = |condition: &str| {
            let (name, values) = condition.split_once(':')?;
            let values = values.split('|').map(|value| value.trim().to_owned()).collect();
            Some((name.trim().to_owned(), values))
        };
        let named = conditions.split(',').map(str::trim);
        let named = named.filter(|condition| !condition.is_empty() && *condition != OTHERWISE);
        Some(Self {
            lines,
            text: text.to_owned(),
            indent: indent.to_owned(),
            group,
            only_step: only_step.cloned(),
            number: number.to_owned(),
            conditions: named.map(read).collect::<Option<_>>()?,
            action: action.trim().to_owned(),
            next,
        })
    }

    #[must_use]
    pub fn write(&self) -> String {
        let next = self.next.as_ref().map_or_else(String::new, |next| format!(" -> {next}"));
        format!("{}{}: {} => {}{next};", self.indent, self.number, conditions(self), self.action)
    }
}

fn condition((name, values): &(String, Vec<String>)) -> String {
    format!("{name}: {}", values.join(" | "))
}

#[derive(Debug)]
pub struct Table {
    pub file: PathBuf,
    pub name: String,        // `MOV_TO_LOC`
    pub lines: Range<usize>, // from `decision_table! {` to the closing brace, from 0
    pub head: usize,
    pub rows: Vec<Row>,
    pub steps: Vec<String>, // as named by the groups of rows
}

impl Table {
    /// All tables of a text, including those in comments and in code blocks of a page.
    #[must_use]
    pub fn read(file: &Path, text: &str) -> Vec<Self> {
        let mut tables = Vec::<Self>::new();
        let (mut before, mut group, mut of_group) = (None, 0, Vec::new());
        let mut row: Option<(usize, String)> = None;
        for (line, text) in text.lines().enumerate() {
            let Some(prefix) = before else {
                if let Some(prefix) = text.strip_suffix(BEGIN) {
                    before = Some(prefix);
                    tables.push(Self::new(file, line));
                }
                continue;
            };
            let (Some(inside), Some(table)) = (text.strip_prefix(prefix), tables.last_mut()) else {
                continue;
            };
            let trimmed = inside.trim();
            if inside == "}" {
                table.lines.end = line + 1;
                before = None;
            } else if let Some((first, begun)) = &mut row {
                *begun += &format!(" {trimmed}");
                if trimmed.ends_with(';') {
                    table.rows.extend(Row::read(*first..line + 1, begun, group, only(&of_group)));
                    row = None;
                }
            } else if trimmed.starts_with("//") {
            } else if let Some((name, _)) = trimmed.split_once(": fn ") {
                name.trim_start_matches("pub ").clone_into(&mut table.name);
                table.head = line;
            } else if let Some(steps) = trimmed.strip_suffix(" {").or(trimmed.strip_suffix(" {}")) {
                group += 1;
                of_group = steps.split('|').map(|step| step.trim().to_owned()).collect();
                for step in of_group.iter().filter(|step| *step != "any") {
                    if !table.steps.contains(step) {
                        table.steps.push(step.clone());
                    }
                }
            } else if trimmed.ends_with(';') {
                table.rows.extend(Row::read(line..line + 1, text, group, only(&of_group)));
            } else if trimmed.starts_with(|first: char| first.is_ascii_digit()) {
                row = Some((line, text.trim_end().to_owned()));
            }
        }
        tables
    }

    fn new(file: &Path, line: usize) -> Self {
        let (file, lines) = (file.to_owned(), line..line);
        Self { file, name: String::new(), lines, head: line, rows: Vec::new(), steps: Vec::new() }
    }
}

fn only(steps: &[String]) -> Option<&String> {
    let [step] = steps else { return None };
    Some(step).filter(|step| *step != "any")
}

pub fn files(directory: &Path, extension: &str, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            files(&path, extension, found)?;
        } else if path.extension().is_some_and(|found| found == extension) {
            found.push(path);
        }
    }
    Ok(())
}

#[must_use]
pub fn aligned(text: &str) -> String {
    let tables = Table::read(Path::new(""), text);
    if tables.is_empty() {
        return text.to_owned();
    }
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for table in tables.iter().rev() {
        for (row, after) in table.rows.iter().zip(in_columns(&table.rows)).rev() {
            lines.splice(row.lines.clone(), after);
        }
    }
    lines.join("\n") + "\n"
}

fn in_columns(rows: &[Row]) -> Vec<Vec<String>> {
    let in_one_line: Vec<String> = rows.iter().map(conditions).collect();
    let mut in_variables = vec![String::new(); rows.len()];
    let mut first = 0;
    for group in rows.chunk_by(|one, next| one.group == next.group) {
        align_variables(group, 0, &mut in_variables[first..first + group.len()]);
        first += group.len();
    }
    let full = in_variables.iter().map(String::len).max().unwrap_or_default();
    let mut narrower: Vec<usize> = in_one_line.iter().map(String::len).collect();
    narrower.sort_unstable_by(|one, other| other.cmp(one));
    narrower.dedup();
    let shapes = narrower.iter().map(|column| (&in_one_line, *column));
    let mut shapes = [(&in_variables, full)].into_iter().chain(shapes);
    let fits = |lines: &Vec<Vec<String>>| lines.iter().flatten().all(|line| line.chars().count() <= WIDEST);
    let is_possible = |rows: &Vec<Vec<String>>| fits(rows) && rows.iter().all(|lines| lines.len() == 1);
    let possible =
        shapes.find_map(|(conditions, column)| Some(written(rows, conditions, column)).filter(is_possible));
    possible.unwrap_or_else(|| {
        let mut shapes = narrower.iter().map(|column| written(rows, &in_one_line, *column));
        shapes.find(fits).unwrap_or_else(|| written(rows, &in_one_line, 0))
    })
}

fn conditions(row: &Row) -> String {
    if row.conditions.is_empty() {
        return OTHERWISE.to_owned();
    }
    row.conditions.iter().map(condition).collect::<Vec<_>>().join(", ")
}

/// Appends the conditions from `at` on. Adjacent rows that have tested the same variables so far have their
/// next variable in a column.
fn align_variables(rows: &[Row], at: usize, texts: &mut [String]) {
    let name = |row: &Row| row.conditions.get(at).map(|(name, _)| name.clone());
    let mut first = 0;
    for run in rows.chunk_by(|one, next| name(one) == name(next)) {
        let texts = &mut texts[first..first + run.len()];
        first += run.len();
        if name(&run[0]).is_none() {
            for text in texts.iter_mut().filter(|text| text.is_empty()) {
                OTHERWISE.clone_into(text);
            }
            continue;
        }
        let has_next = |row: &Row| row.conditions.len() > at + 1;
        for (row, text) in run.iter().zip(&mut *texts) {
            text.push_str(&condition(&row.conditions[at]));
            text.push_str(if has_next(row) { "," } else { "" });
        }
        let width =
            run.iter().zip(&*texts).filter(|(row, _)| has_next(row)).map(|(_, text)| text.len()).max();
        for (row, text) in run.iter().zip(&mut *texts) {
            if has_next(row) {
                *text = format!("{text:0$} ", width.unwrap_or_default());
            }
        }
        align_variables(run, at + 1, texts);
    }
}

/// Actions begin after `column` characters; beyond that, the action leaves the columns or has its own line.
fn written(rows: &[Row], conditions: &[String], column: usize) -> Vec<Vec<String>> {
    let number = rows.iter().map(|row| row.number.len() + 1).max().unwrap_or_default();
    let continued = rows.iter().filter(|row| row.next.is_some());
    let action = continued.map(|row| row.action.len()).max().unwrap_or_default();
    let lines = rows.iter().zip(conditions).map(|(row, conditions)| {
        let effect = |action: usize, gap: &str| match &row.next {
            Some(next) => format!("=> {:action$}{gap}-> {next};", row.action),
            None => format!("=> {};", row.action),
        };
        let begin = format!("{}{:number$} ", row.indent, format!("{}:", row.number));
        let in_columns = || format!("{begin}{conditions:column$}  {}", effect(action, "  "));
        let alone = || format!("{begin}{conditions} {}", effect(0, " "));
        if conditions.len() <= column {
            vec![in_columns()]
        } else if alone().chars().count() <= WIDEST {
            vec![alone()]
        } else {
            let second = format!("{:1$}  {2}", "", begin.chars().count() + column, effect(action, "  "));
            vec![format!("{begin}{conditions}"), second]
        }
    });
    lines.collect()
}
