//! E-move alone, against test doubles of Prim, Quick Change, the three grippers and vision.

mod bench;
mod doubles;
mod drum;
mod exchange;
mod motion;
mod nonsense;
mod pausing;
mod together;

use self::bench::ROWS;
use super::tables::TABLES;

/// Every row of every table fires in some scenario.
#[test]
fn every_row_fires() {
    let scenarios =
        motion::SCENARIOS.iter().chain(pausing::SCENARIOS).chain(exchange::SCENARIOS).chain(drum::SCENARIOS);
    scenarios.for_each(|scenario| scenario());
    let mut silent = ROWS.with_borrow(|rows| rows.missing(TABLES));
    // Of these two no header tells: tests of their own consult them.
    silent.retain(|row| !row.starts_with("ATTEND") && !row.starts_with("SEARCH"));
    assert_eq!(silent, [""; 0]);
}
