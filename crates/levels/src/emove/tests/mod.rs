//! E-move alone, against test doubles of Prim, Quick Change, the three grippers and vision.

mod bench;
mod doubles;
mod drum;
mod exchange;
mod motion;
mod nonsense;
mod pausing;
mod together;

use std::collections::BTreeSet;

use rcs_core::process::Process;
use taskdata::files::TaskData;

use self::bench::ROWS;
use crate::{emove::Emove, old_execution::EXECUTE};

/// Every row of every table fires in some scenario.
#[test]
fn every_row_fires() {
    let scenarios =
        motion::SCENARIOS.iter().chain(pausing::SCENARIOS).chain(exchange::SCENARIOS).chain(drum::SCENARIOS);
    scenarios.for_each(|scenario| scenario());
    let fired = ROWS.with_borrow(BTreeSet::clone);
    let tables = <Emove as Process<TaskData<'_>>>::TABLES;
    // The upper table belongs to `execution`, which tests it.
    let silent: Vec<String> = tables
        .iter()
        .filter(|table| table.name != EXECUTE.name)
        .flat_map(|table| table.rows.iter().map(|row| (table.name, row)))
        .filter(|(table, row)| !fired.contains(&(*table, row.number)))
        .map(|(table, row)| format!("{table} row {}: {row}", row.number))
        .collect();
    assert!(silent.is_empty(), "rows that never fired:\n{}", silent.join("\n"));
}
