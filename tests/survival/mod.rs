//! What survives what: runs, logs, readers and machines are treated badly.
//!
//! `RCS_KILLS` sets how often runs are killed (4 if it is not set); the tests that need more than an ordinary
//! user's rights say so and look at the rest if they do not have them.

mod campaign;
mod damage;
mod kills;
mod neighbours;
mod overruns;
mod readers;
mod storage;
