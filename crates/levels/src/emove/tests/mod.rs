mod bench;
mod confirmed;
mod doubles;
mod drum;
mod exchange;
mod exchange_again;
mod futile;
mod motion;
mod nonsense;
mod pausing;
mod recovery;
mod returning;
mod together;
mod written;

use taskdata::files::TaskData;

use crate::{coverage::silent, emove::Emove};

#[test]
fn every_row_fires() {
    let scenarios = [
        motion::SCENARIOS,
        pausing::SCENARIOS,
        exchange::SCENARIOS,
        drum::SCENARIOS,
        recovery::SCENARIOS,
        returning::SCENARIOS,
        exchange_again::SCENARIOS,
    ];
    let mut silent = silent::<Emove, TaskData<'_>>(&scenarios.concat());
    // Headers do not name these rows; their own tests consult them.
    let elsewhere = ["ATTEND", "SEARCH", "RESUME", "DRUM", "RETURN", "TRACK", "STANCE"];
    silent.retain(|row| !elsewhere.iter().any(|name| row.starts_with(name)));
    assert_eq!(silent, [""; 0]);
}
