//! The processes in one tick: command, row with its conditions, and step.

use std::fmt;

use closed_loop::{
    chain::{Processes, because, conditions, effect},
    failure,
};
use levels::ladder::ProcessId;
use record::rows::{beside, values_text};
use serde::Serialize;

use crate::story::Moment;

#[derive(Debug, Serialize)]
pub struct Rung {
    process: String,
    command: String,
    held: bool,             // the process was not executed, because it was dormant or held
    old: Option<u64>,       // tick in which the row fired, if the process has not decided since
    values: Option<String>, // values of the state variables of the table when the row fired
    /// Rows of other tables that fired in the same execution of the process, with their values.
    beside: Vec<String>,
    table: Option<String>,
    row: Option<u8>,
    /// Conditions of the row: its step and state variables, with the values for which it fired.
    conditions: Vec<String>,
    action: Option<String>, // action of the row, with its parameters
    next: Option<String>,   // next step, if the row changes it
    step: String,           // step of the command after the row; empty for none
    #[serde(skip)]
    effect: String, // action and next step as text
}

pub fn all(moment: &Moment, processes: Processes) -> Vec<Rung> {
    let rungs = processes.iter().zip(ProcessId::ALL).map(|(process, id)| {
        let header = moment.after.header(*id);
        let command = failure::command(*id, &moment.external.hws, &moment.before);
        let fired = process.fired(header);
        let row = fired.map(|fired| fired.row);
        let step = header.step.unwrap_or_default();
        Rung {
            process: process.name.to_owned(),
            command,
            held: header.republished,
            old: header.basis.filter(|_| header.age() > Some(0)).map(|basis| basis.tick.0),
            values: fired.and_then(|fired| Some(values_text(fired.table, fired.values?))),
            beside: beside(process, header).collect(),
            table: fired.map(|fired| fired.table.name.to_owned()),
            row: row.map(|row| row.number),
            conditions: fired.as_ref().map_or_else(Vec::new, conditions),
            action: row.map(|row| row.call().to_string()),
            next: row.and_then(|row| row.next).map(str::to_owned),
            step: step.to_string(),
            effect: row.map_or_else(String::new, |row| effect(row, step.as_str())),
        }
    });
    rungs.collect()
}

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let command = if self.command.is_empty() { "nothing" } else { &self.command };
        let held = if self.held { " (not stepped: dormant or held)" } else { "" };
        writeln!(f, "  {:<14} executes {command}{held}", self.process)?;
        let (Some(table), Some(row)) = (&self.table, self.row) else { return Ok(()) };
        let old = self.old.map_or_else(String::new, |tick| format!("no row since tick {tick}, when it was "));
        writeln!(f, "  {:<14} {old}{table} row {row}: {}, {}", "", self.effect, because(&self.conditions))?;
        if let Some(values) = self.values.as_ref().filter(|values| !values.is_empty()) {
            writeln!(f, "  {:<14} values: {values}", "")?;
        }
        self.beside.iter().try_for_each(|row| writeln!(f, "  {:<14} also {row}", ""))
    }
}
