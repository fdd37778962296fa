//! Rows of the tables that fire in the tests of a process.

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
};

use interfaces::{Consulted, Decided, Header, process::Process};
use rcs_core::table::Table;

use crate::{confirm::CONFIRM, execution::EXECUTE};

#[derive(Debug, Default)]
pub struct Coverage(BTreeSet<(u8, u8, u8, u64)>);

impl Coverage {
    /// Record the rows in a header. Each must be the row that the table as text gives for the same values.
    pub fn note(&mut self, tables: &[&Table], header: &Header) {
        let rows = header.consulted().into_iter().chain(header.beside.into_iter().flatten());
        for Consulted { decided: Decided { table, row }, values } in rows {
            if self.0.insert((table, row, values.step, values.variables)) {
                let table = tables[usize::from(table) - 1];
                let read = table.consult(values).map(|row| row.number);
                assert_eq!(read, Some(row), "{} with {values:?}", table.name);
            }
        }
    }

    /// Rows that have not fired, as `GET-OBJECT 3`. Rows that no header names are left out: those that pass on to
    /// the next table, and those of EXECUTE that do not refuse. CONFIRM has rows for all processes; its own tests
    /// cover them.
    pub fn missing(&self, tables: &[&Table]) -> Vec<String> {
        let own = tables.iter().zip(1_u8..).filter(|(table, _)| table.name != CONFIRM.name);
        let rows = own.flat_map(|(table, number)| {
            let named =
                |action: &str| action != "consult" && (table.name != EXECUTE.name || action == "Refuse");
            let rows = table.rows.iter().filter(move |row| named(row.action));
            rows.map(move |row| (table.name, number, row.number))
        });
        let has_fired =
            |table, row| self.0.range((table, row, 0, 0)..=(table, row, u8::MAX, u64::MAX)).next().is_some();
        let missing = rows.filter(|(_, table, row)| !has_fired(*table, *row));
        missing.map(|(name, _, row)| format!("{name} {row}")).collect()
    }
}

thread_local! {
    static FIRED: RefCell<BTreeMap<&'static str, Coverage>> = const { RefCell::new(BTreeMap::new()) };
}

pub fn note(process: &'static str, tables: &[&Table], header: &Header) {
    FIRED.with_borrow_mut(|fired| fired.entry(process).or_default().note(tables, header));
}

pub fn silent<P: Process<Data>, Data>(scenarios: &[fn()]) -> Vec<String> {
    FIRED.take();
    scenarios.iter().for_each(|scenario| scenario());
    FIRED.take().entry(P::NAME).or_default().missing(P::TABLES)
}
