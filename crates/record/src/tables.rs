//! The decision tables that explain a log: the tables in the log, or the tables of this program.
//!
//! A log names rows by numbers, which change when a row is added. So the tables attached to the log
//! ([`crate::explanation`]) are used. A program that reads a log ends soon, so they are never freed.

use levels::ladder::{Ladder, PROCESS_COUNT, ProcessInfo};
use rcs_core::{
    plain::{EnumSchema, VariantSchema},
    table::{Condition, Row, Table, Variable},
};
use serde_json::Value;

use crate::{
    Log,
    explanation::{self, TABLES},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    Same, // the log has the tables of this program
    Log,  // the log has other tables, which are used
    /// The attachment is missing or damaged, so the tables of this program are used.
    Program,
}

impl Origin {
    /// Remark for readers of the explanation; `None` if the tables are the same.
    #[must_use]
    pub const fn remark(self) -> Option<&'static str> {
        match self {
            Self::Same => None,
            Self::Log => {
                Some("its decision tables differ from those of this program: it is explained with its own")
            }
            Self::Program => Some(
                "an older program wrote it without decision tables: it is explained with those of this program",
            ),
        }
    }
}

#[must_use]
pub fn of_log(log: &Log) -> (&'static [ProcessInfo; PROCESS_COUNT], Origin) {
    let own = (Ladder::processes(), Origin::Program);
    let Some(attached) = explanation::of_log(log, TABLES) else { return own };
    if rules(&attached) == rules(&explanation::tables()) {
        return (Ladder::processes(), Origin::Same);
    }
    read(&attached).map_or(own, |processes| (processes, Origin::Log))
}

/// Tables without comments and source lines, which do not affect decisions.
fn rules(tables: &Value) -> Value {
    match tables {
        Value::Array(list) => list.iter().map(rules).collect(),
        Value::Object(map) => {
            let decides = |key: &str| !matches!(key, "doc" | "source");
            let kept = map.iter().filter(|(key, _)| decides(key));
            kept.map(|(key, value)| (key.clone(), rules(value))).collect()
        }
        other => other.clone(),
    }
}

/// The processes of this program with attached tables; `None` if the attachment has other processes.
fn read(attached: &Value) -> Option<&'static [ProcessInfo; PROCESS_COUNT]> {
    let read: Option<Vec<ProcessInfo>> = Ladder::processes()
        .iter()
        .zip(attached.as_array()?)
        .map(|(known, shown)| {
            let tables: Option<Vec<&'static Table>> = list(shown, "tables").iter().map(table).collect();
            let is_known = text(shown, "process") == known.name;
            let info =
                ProcessInfo { name: known.name, tables: Box::leak(tables?.into()), goals: known.goals };
            is_known.then_some(info)
        })
        .collect();
    let processes: Box<[ProcessInfo; PROCESS_COUNT]> = read?.into_boxed_slice().try_into().ok()?;
    Some(Box::leak(processes))
}

fn table(shown: &Value) -> Option<&'static Table> {
    let (file, line) = text(shown, "source").rsplit_once(':')?;
    let steps = list(shown, "steps");
    let rows: Option<Vec<Row>> =
        (1..).zip(list(shown, "rows")).map(|(number, shown)| row(number, shown)).collect();
    Some(Box::leak(Box::new(Table {
        name: kept(text(shown, "name")),
        doc: Box::leak(Box::new([kept(text(shown, "doc"))])),
        variables: Box::leak(variables(shown).into()),
        actions: &[],
        steps: (!steps.is_empty()).then(|| schema(steps.iter().map(|step| (code(step), step)))),
        rows: Box::leak(rows?.into()),
        file: kept(file),
        line: line.parse().ok()?,
    })))
}

/// All variables of a table, in the order of their digits. Variables that no row tests have no named values. Without
/// the list, the values of a decision are unknown.
fn variables(shown: &Value) -> Vec<Variable> {
    let asked = list(shown, "variables");
    let variable = |digit: &Value| {
        let name = text(digit, "name");
        let named = asked.iter().find(|variable| text(variable, "name") == name);
        let count = digit.get("values").and_then(Value::as_u64).and_then(|count| u8::try_from(count).ok());
        let values = match named {
            Some(variable) => schema((0..).zip(list(variable, "values"))),
            None => schema((0..count.unwrap_or_default()).map(|code| (code, &Value::Null))),
        };
        let doc = named.map_or("", |variable| text(variable, "doc"));
        Variable { name: kept(name), doc: kept(doc), values }
    };
    list(shown, "digits").iter().map(variable).collect()
}

fn schema<'a>(values: impl Iterator<Item = (u8, &'a Value)>) -> &'static EnumSchema {
    let variants = values.map(|(code, value)| {
        let name = kept(text(value, "name"));
        VariantSchema { code, name, text: name, doc: kept(text(value, "doc")) }
    });
    Box::leak(Box::new(EnumSchema { name: "", variants: Box::leak(variants.collect()) }))
}

fn row(number: u8, shown: &Value) -> Option<Row> {
    let call = text(shown, "action");
    let (action, argument) = match call.split_once('(') {
        Some((action, argument)) => (action, argument.strip_suffix(')')),
        None => (call, None),
    };
    let when = shown.get("when")?.as_object()?;
    let when = when.iter().map(|(name, values)| Condition { variable: kept(name), values: words(values) });
    Some(Row {
        number,
        steps: words(shown.get("steps")?),
        when: Box::leak(when.collect()),
        action: kept(action),
        argument: argument.map(kept),
        next: shown.get("next")?.as_str().map(kept),
    })
}

fn words(list: &Value) -> &'static [&'static str] {
    let words = list.as_array().into_iter().flatten().filter_map(Value::as_str);
    Box::leak(words.map(kept).collect())
}

fn kept(text: &str) -> &'static str {
    Box::leak(text.into())
}

fn code(step: &Value) -> u8 {
    step.get("code").and_then(Value::as_u64).and_then(|code| u8::try_from(code).ok()).unwrap_or(u8::MAX)
}

fn list<'a>(of: &'a Value, key: &str) -> &'a [Value] {
    of.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn text<'a>(of: &'a Value, key: &str) -> &'a str {
    of.get(key).and_then(Value::as_str).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::table::Values;

    /// Every row and every value of the attachment equals that of its source table.
    #[test]
    fn attached_tables_decide_and_name_their_values_as_the_program_does() {
        let attached = explanation::tables();
        let read = read(&attached).expect("they are of this program");
        for (own, read) in Ladder::processes().iter().zip(read) {
            assert_eq!((own.name, own.tables.len()), (read.name, read.tables.len()));
            for (own, read) in own.tables.iter().zip(read.tables) {
                assert_eq!((own.name, own.file, own.line), (read.name, read.file, read.line));
                let rows = |table: &Table| {
                    table.rows.iter().map(|row| (row.number, row.steps, row.next)).collect::<Vec<_>>()
                };
                assert_eq!(rows(own), rows(read), "{}", own.name);
                let calls =
                    |table: &Table| table.rows.iter().map(|row| row.call().to_string()).collect::<Vec<_>>();
                assert_eq!(calls(own), calls(read), "{}", own.name);
                let all = Variable::combinations(own.variables).unwrap();
                let steps: Vec<u8> =
                    own.steps.map_or(vec![0], |steps| steps.variants.iter().map(|it| it.code).collect());
                for step in steps {
                    for variables in (0..all).step_by(usize::try_from(all / 50 + 1).unwrap()) {
                        let values = Values { step, variables };
                        let row = |table: &'static Table| table.consult(values).map(|row| row.number);
                        assert_eq!(row(own), row(read), "{} {values:?}", own.name);
                        let text = crate::rows::values_text;
                        assert_eq!(text(own, values), text(read, values), "{} {values:?}", own.name);
                    }
                }
            }
        }
    }

    #[test]
    fn comments_and_lines_are_no_difference_and_rows_are() {
        let own = explanation::tables();
        let mut other = own.clone();
        other[0]["tables"][0]["doc"] = "reworded".into();
        other[0]["tables"][0]["source"] = "moved.rs:1".into();
        assert_eq!(rules(&own), rules(&other));
        other[0]["tables"][0]["rows"][0]["action"] = "Renamed".into();
        assert_ne!(rules(&own), rules(&other));
    }
}
