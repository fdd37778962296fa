//! Coverage of the control processes in branches: rows of the decision tables, and states.

use std::collections::BTreeSet;

use levels::{
    execution::EXECUTE,
    ladder::{Ladder, ProcessId},
};
use rcs_core::{digest::Digest, tick::Tick};
use serde::{Deserialize, Serialize};

use super::{branch::Branch, parent, trial::Observer};

#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Coverage {
    /// Fired rows: index of the process in [`ProcessId::ALL`], of the table, and of the row.
    rows: BTreeSet<(u8, u8, u8)>,
    /// Digests of states: the step of each process, and the row that it fired last.
    #[serde(default)]
    states: BTreeSet<u64>,
}

impl Coverage {
    /// Merge the coverage of another branch. Returns the part of it that is new.
    pub fn take_in(&mut self, other: Self) -> Self {
        let Self { rows, states } = other;
        Self {
            rows: rows.into_iter().filter(|row| self.rows.insert(*row)).collect(),
            states: states.into_iter().filter(|state| self.states.insert(*state)).collect(),
        }
    }

    #[cfg(test)]
    pub fn of_states(states: impl IntoIterator<Item = u64>) -> Self {
        Self { states: states.into_iter().collect(), ..Self::default() }
    }

    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        (self.rows.len(), self.states.len())
    }

    /// Number of all rows, and the names of the rows that have not fired, such as `Prim: GOTO-PT 3`.
    #[must_use]
    pub fn missing(&self) -> (usize, Vec<String>) {
        let (mut count, mut missing) = (0, Vec::new());
        for (id, process) in (0_u8..).zip(Ladder::processes()) {
            for (table, number) in process.tables.iter().zip(1_u8..) {
                for row in table.rows.iter().filter(|row| is_named(table.name, row.action)) {
                    count += 1;
                    if !self.rows.contains(&(id, number, row.number)) {
                        missing.push(format!("{}: {} {}", process.name, table.name, row.number));
                    }
                }
            }
        }
        (count, missing)
    }
}

/// True if a header can name a row with this action. It names no row that passes on, or accepts in EXECUTE.
fn is_named(table: &str, action: &str) -> bool {
    action != "consult" && (table != EXECUTE.name || action == "Refuse")
}

impl Observer for Coverage {
    fn tick(&mut self, branch: &Branch<'_>) {
        let memory = branch.memory();
        for (id, process) in (0_u8..).zip(ProcessId::ALL) {
            let header = memory.header(*process);
            let rows = header.consulted().into_iter().chain(header.beside.into_iter().flatten());
            self.rows.extend(rows.map(|row| (id, row.decided.table, row.decided.row)));
        }
        let mut digest = Digest::new();
        for (step, decided) in parent::state(memory) {
            digest.add(step.as_ref().map_or(&[], |step| step.as_str().as_bytes()));
            let (table, row) = decided.map_or((0, 0), |decided| (decided.table, decided.row));
            digest.add(&[table, row]);
        }
        self.states.insert(digest.value());
    }

    fn say(&mut self, _: Tick, _: &str) {}
}
