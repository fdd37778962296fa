//! Survival under attack. `RCS_KILLS` sets the number of killed runs (default 4). Tests that need more than an
//! ordinary user's rights say so, and skip that part without them.

mod campaign;
mod damage;
mod kills;
mod neighbours;
mod overruns;
mod readers;
mod storage;
