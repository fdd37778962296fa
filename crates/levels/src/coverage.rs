//! Which rows of which tables have fired in the tests of a process.

use std::collections::BTreeSet;

use interfaces::{Decided, Header};
use rcs_core::table::Table;

use crate::execution::EXECUTE;

/// Tables and rows that have fired.
#[derive(Debug, Default)]
pub struct Coverage(BTreeSet<(u8, u8)>);

impl Coverage {
    /// Take in what a process has reported.
    pub fn note(&mut self, header: &Header) {
        self.0.extend(header.decided.map(|Decided { table, row }| (table, row)));
    }

    /// Take in what another test has covered.
    pub fn append(&mut self, other: &mut Self) {
        self.0.append(&mut other.0);
    }

    /// Rows that have not fired, as `GET-OBJECT 3`. Rows that no header ever names are left out: those that
    /// pass on to the table below, and those of EXECUTE that do not refuse.
    pub fn missing(&self, tables: &[&Table]) -> Vec<String> {
        let rows = tables.iter().zip(1_u8..).flat_map(|(table, number)| {
            let named =
                |action: &str| action != "consult" && (table.name != EXECUTE.name || action == "Refuse");
            let rows = table.rows.iter().filter(move |row| named(row.action));
            rows.map(move |row| (table.name, number, row.number))
        });
        let missing = rows.filter(|(_, table, row)| !self.0.contains(&(*table, *row)));
        missing.map(|(name, _, row)| format!("{name} {row}")).collect()
    }
}
