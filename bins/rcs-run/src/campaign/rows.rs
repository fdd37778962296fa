//! The rows of the decision tables that have fired in branches.

use std::collections::BTreeSet;

use levels::{
    execution::EXECUTE,
    ladder::{Ladder, ProcessId},
};
use rcs_core::tick::Tick;
use serde::{Deserialize, Serialize};

use super::{branch::Branch, trial::Observer};

/// The fired rows of all processes.
///
/// A journal stores each row as three numbers: index of the process in [`ProcessId::ALL`], of the table, and of the
/// row.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(transparent)]
pub struct RowsFired(BTreeSet<(u8, u8, u8)>);

impl RowsFired {
    /// Merge the rows of another branch. Returns the rows that are new.
    pub fn take_in(&mut self, other: Self) -> Self {
        Self(other.0.into_iter().filter(|row| self.0.insert(*row)).collect())
    }

    /// Number of all rows, and the names of the rows that have not fired, such as `Prim: GOTO-PT 3`.
    #[must_use]
    pub fn missing(&self) -> (usize, Vec<String>) {
        let (mut count, mut missing) = (0, Vec::new());
        for (id, process) in (0_u8..).zip(Ladder::processes()) {
            for (table, number) in process.tables.iter().zip(1_u8..) {
                for row in table.rows.iter().filter(|row| is_named(table.name, row.action)) {
                    count += 1;
                    if !self.0.contains(&(id, number, row.number)) {
                        missing.push(format!("{}: {} {}", process.name, table.name, row.number));
                    }
                }
            }
        }
        (count, missing)
    }
}

/// True if a header can name a row with this action. Headers do not name rows that pass on to the next table, nor rows
/// of EXECUTE that do not refuse.
fn is_named(table: &str, action: &str) -> bool {
    action != "consult" && (table != EXECUTE.name || action == "Refuse")
}

impl Observer for RowsFired {
    fn tick(&mut self, branch: &Branch<'_>) {
        let memory = branch.memory();
        for (id, process) in (0_u8..).zip(ProcessId::ALL) {
            let header = memory.header(*process);
            let rows = header.consulted().into_iter().chain(header.beside.into_iter().flatten());
            self.0.extend(rows.map(|row| (id, row.decided.table, row.decided.row)));
        }
    }

    fn say(&mut self, _: Tick, _: &str) {}
}
